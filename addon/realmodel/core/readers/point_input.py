# SPDX-License-Identifier: GPL-3.0-or-later
"""Points from files; the format follows from the content."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from ..base.errors import HeightsMissing, InputRefused, counted
from ..base.mapped_arrays import JoinPieces, in_memory
from ..base.text import Step, no_step
from ..base.units import MODEL_UNIT, factor, other_units
from ..settings.data_files import MapLayer, PointFile, list_of
from .formats import ARRAY, OBJECTS, RASTER, SHAPES, TABLE, FileFormat, format_of
from .map_input import map_companions, read_shapes
from .maps.shapes import Heights
from .object_input import read_object
from .objects.geo_object import HOLE, LINES, POINTS, SURFACE, GeoObject
from .rasters.geotiff import world_file
from .rasters.raster import Raster
from .tables.table_layout import names_shown


def read_map_points(
    given: PointFile, step: Step = no_step, gather: JoinPieces = in_memory
) -> tuple[np.ndarray, list[str]]:
    """(P, 3) float64, in the file's unit: its points, and the corners of its lines and polygons; and
    warnings, sentences. gather: where the points are kept. Raises InputRefused naming the file and the
    feature."""
    file = Path(given.file)
    missing = [float(value) for value in given.nodata_values if not isinstance(value, str)]
    shapes = read_shapes(MapLayer(file, given.layer, given.where), step=step, heights=Heights(given.height))
    places = [point[None] for _, point in shapes.points] + [line for _, line in shapes.lines]
    places += [ring for polygon in shapes.polygons for ring in polygon.rings]
    if not sum(map(len, places)):
        raise InputRefused("there are no points in it", file=file)
    positions = np.concatenate(places)
    with_height = positions[np.isfinite(positions[:, 2]) & ~np.isin(positions[:, 2], missing)]
    points = gather([with_height], np.empty((0, 3)))
    if not len(points):
        what = "its positions have no height"
        if given.height is not None:
            what = f"attribute '{given.height}' has no heights"
        advice = 'name the attribute with the height: height = "ELEVATION"'
        raise HeightsMissing(what, file=file, advice=advice if given.height is None else None)
    left_out = len(positions) - len(points)
    warnings = [f"{file}: left out: {counted(left_out, 'point')} without a value"] if left_out else []
    return points, warnings


OF_POINTS = (POINTS, LINES, SURFACE, HOLE)


def read_object_points(given: PointFile, gather: JoinPieces) -> tuple[np.ndarray, list[str]]:
    """(P, 3) float64, in the file's unit, and warnings, sentences. gather: where the points are kept. Raises
    InputRefused naming the file and the object."""
    file = Path(given.file)
    obj = read_object(file, given.layer, OF_POINTS)
    label = f"object '{obj.name}'"
    places = np.array(obj.vertices, np.float64)
    if given.height is not None:
        heights = _attribute(obj, given.height, file)
        if heights.dtype.kind not in "iufb":
            raise InputRefused(f"its attribute '{given.height}' has texts, no heights", file=file, item=label)
        places[:, 2] = heights
    chosen = np.ones(len(places), bool)
    for name, wanted in given.where.items():
        chosen &= _equal(_attribute(obj, name, file), list_of(wanted))
    if not chosen.any():
        what = "it has no points" if not len(places) else f"no point of it has {_shown(given.where)}"
        raise InputRefused(what, file=file, item=label, advice=_values_there(obj, given))
    places = places[chosen]
    missing = [float(value) for value in given.nodata_values if not isinstance(value, str)]
    if not np.isfinite(places[:, :2]).all():
        raise InputRefused("a place in plan is not finite", file=file, item=label)
    has_height = np.isfinite(places[:, 2]) & ~np.isin(places[:, 2], missing)
    if not has_height.any():
        raise InputRefused("none of its points has a value", file=file, item=label)
    left_out = int((~has_height).sum())
    warnings = [f"{file}: left out: {counted(left_out, 'point')} without a value"] if left_out else []
    return gather([places[has_height]], np.empty((0, 3))), warnings


def _attribute(obj: GeoObject, name: str, file: Path) -> np.ndarray:
    columns = obj.columns
    if name not in columns:
        advice = f"it has {names_shown(list(columns))}" if columns else "its points have none"
        what = f"it has no attribute '{name}'"
        raise InputRefused(what, file=file, item=f"object '{obj.name}'", advice=advice)
    return columns[name]


def _equal(column: np.ndarray, wanted: list) -> np.ndarray:
    """(N,) bool: where values are one of some; numbers as numbers, others as texts."""
    if column.dtype.kind in "iufb":
        numbers = [float(value) for value in wanted if not isinstance(value, str)]
        return np.isin(np.asarray(column, np.float64), numbers)
    return np.isin(column.astype(str), [str(value) for value in wanted])


def _shown(where: Any) -> str:
    return " and ".join(f"{name} = {value!r}" for name, value in where.items())


def _values_there(obj: GeoObject, source: PointFile) -> str | None:
    for name in source.where:
        values = list(dict.fromkeys(str(value) for value in obj.columns[name].tolist()))
        return f"{name} is {names_shown(values)}"
    return None


# Values that many programs write for "no data".


OFTEN_NO_VALUE = (
    -9999.0,
    -99999.0,
    -999.0,
    -999.25,
    -32768.0,
    9999.0,
    99999.0,
    999.25,
    9999900.0,
    1e30,
    -1e30,
)


def read_point_file(
    given: PointFile, model_unit: str = MODEL_UNIT, step: Step = no_step, gather: JoinPieces = in_memory
) -> tuple[np.ndarray, list[str]]:
    """(P, 3) float64 points in the model's unit, and warnings, sentences. gather: where the points are kept.

    Raises InputRefused naming the file, and the line where it has lines.
    """
    file = Path(given.file)
    gather_in_model = _InModel(given, model_unit, gather)
    file_format = format_of(file, RASTER, ARRAY, OBJECTS, SHAPES, TABLE)
    assert file_format is not None
    if file_format.holds == RASTER:
        points, warnings = _raster_points(given, file, file_format, step, gather, gather_in_model)
    elif file_format.holds == ARRAY:
        chosen = ["where"] if given.where else []
        refuse_keys(file, "is an array", [*given.only_for_tables, *chosen, *given.only_for_shapes])
        points, warnings = file_format.read(file, gather_in_model), []
    elif file_format.holds == OBJECTS:
        refuse_keys(file, "has objects", given.only_for_tables)
        points, warnings = read_object_points(given, gather_in_model)
    elif file_format.holds == SHAPES:
        refuse_keys(file, "has shapes", given.only_for_tables)
        points, warnings = read_map_points(given, step, gather_in_model)
    else:
        refuse_keys(file, "is a table", given.only_for_shapes)
        rows = file_format.read(given, step, gather_in_model)
        points, warnings = rows.points, _other_units(given, file, rows.columns, model_unit)
        if rows.taken_for_xyz:
            names = ", ".join(f"'{name}'" for name in rows.taken_for_xyz)
            warnings.append(
                f"{file}: no column is named x, y or z: the first three, {names}, are used; if that "
                'is wrong, set columns = ["X", "Y", "Z"]'
            )
        if rows.missing:
            warnings.append(f"{file}: left out: {counted(rows.missing, 'point')} without a value")
    warnings += [f"{file}: {text}" for text in gather_in_model.heights.like_no_value()]
    return points, warnings


def _other_units(source: PointFile, file: Path, columns: Sequence[str], model_unit: str) -> list[str]:
    """The warnings about units in the header of a table. columns: the names of x, y and z, if it has them."""
    units = (source.plan_unit, source.plan_unit, source.height_unit)
    return other_units(file, dict(zip(columns, units, strict=True)) if columns else {}, model_unit)


class _InModel:
    """Gathers points of a file in the model's unit. heights: of the file, examined on the way."""

    def __init__(self, given: PointFile, model_unit: str, gather: JoinPieces):
        self._given, self._unit, self._gather = given, model_unit, gather
        self.heights = _Heights()

    def __call__(self, pieces: Iterable[np.ndarray], empty: np.ndarray) -> np.ndarray:
        self.heights = _Heights()
        return self._gather(map(self._converted, pieces), empty)

    def _converted(self, points: np.ndarray) -> np.ndarray:
        self.heights.add(points[:, 2])
        return in_model(points, self._given, self._unit)


def in_model(points: np.ndarray, given: PointFile, model_unit: str) -> np.ndarray:
    """Points (P, 3) of a file in the model's unit, z upward."""
    points = np.array(points, np.float64, order="C")
    for columns, unit in ((slice(0, 2), given.plan_unit), (slice(2, 3), given.height_unit)):
        if (scale := factor(unit, model_unit)) != 1.0:
            points[:, columns] *= scale
    if given.z_axis == "down":
        points[:, 2] *= -1.0
    return points


class _Heights:
    """Looks among heights, piece by piece, for values that programs write for no data."""

    def __init__(self) -> None:
        self._count = 0
        self._of_value = dict.fromkeys(OFTEN_NO_VALUE, 0)
        self._low, self._high = np.inf, -np.inf  # of the others

    def add(self, z: np.ndarray) -> None:
        self._count += len(z)
        often = np.isin(z, OFTEN_NO_VALUE)
        if often.any():
            for value in OFTEN_NO_VALUE:
                self._of_value[value] += int((z == value).sum())
            z = z[~often]
        if len(z):
            self._low, self._high = min(self._low, float(z.min())), max(self._high, float(z.max()))

    def like_no_value(self) -> list[str]:
        """Warnings about such heights where no other height is near. Their points are not left out: the
        heights may be real."""
        said = []
        for value, count in self._of_value.items():
            if not count or count == self._count or self._low > self._high:
                continue
            near = min(abs(value - self._low), abs(value - self._high))
            if near > max(self._high - self._low, 0.5 * abs(value)):
                number = "1 point has" if count == 1 else f"{count} points have"
                said.append(
                    f"{number} the height {value:g}, far from all others, which often means no data: if so, "
                    f"set nodata = {value:g}"
                )
        return said


def refuse_keys(file: Path, what: str, keys: list[str]) -> None:
    """Refuses options that have no effect on a file."""
    if keys:
        raise InputRefused(f"it {what}, so '{keys[0]}' has no effect", file=file, advice="take it out")


def companions(file: Path) -> list[Path]:
    """Other files that are read with a file of points."""
    if file.suffix.lower() == ".shp":
        return map_companions(file)
    beside = world_file(file) if file.suffix.lower() in (".tif", ".tiff") else None
    return [] if beside is None else [beside]


def read_raster_heights(
    given: PointFile, plan: np.ndarray, model_unit: str = MODEL_UNIT
) -> np.ndarray | None:
    """(N,) heights of a raster at places in plan (N, 2), in the model's unit, NaN where there are none; None:
    the file is no raster. Raises InputRefused."""
    file = Path(given.file)
    file_format = format_of(file, RASTER)
    if file_format is None:
        return None
    raster = _raster(given, file, file_format, no_step, in_memory)
    z = raster.heights_at(plan / factor(given.plan_unit, model_unit))
    return in_model(np.column_stack([plan, z]), replace(given, units={"z": given.height_unit}), model_unit)[
        :, 2
    ]


def _raster(source: PointFile, file: Path, file_format: FileFormat, step: Step, gather: JoinPieces) -> Raster:
    chosen = ["where"] if source.where else []
    refuse_keys(file, "is a raster", [*source.only_for_tables, *chosen, *source.only_for_shapes])
    nodata = [value for value in source.nodata_values if not isinstance(value, str)]
    return file_format.read(file, nodata, step, gather)


def _raster_points(
    source: PointFile,
    file: Path,
    file_format: FileFormat,
    step: Step,
    gather: JoinPieces,
    gather_in_model: JoinPieces,
) -> tuple[np.ndarray, list[str]]:
    raster = _raster(source, file, file_format, step, gather)
    warnings = [] if source.units else [f"{file}: {text}" for text in raster.warnings]
    return raster.points(file, gather_in_model), warnings
