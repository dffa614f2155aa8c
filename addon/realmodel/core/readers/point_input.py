# SPDX-License-Identifier: GPL-3.0-or-later
"""Points from files; the format follows from the content."""

from __future__ import annotations

from collections.abc import Container, Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from ..base.errors import HeightsMissing, InputRefused, UsageError, counted
from ..base.mapped_arrays import JoinPieces, Rows, in_memory, in_pieces
from ..base.no_value import OFTEN_NO_VALUE
from ..base.text import Step, no_step
from ..base.units import MODEL_UNIT, factor, stated_units
from ..settings.data_files import MapLayer, PointFile, checked_unit, list_of
from ..settings.method_options import OptionRefused
from ..settings.setting import settings_of
from .formats import ARRAY, MESH, OBJECTS, RASTER, SHAPES, STICKS, TABLE, FileFormat, format_of
from .map_input import map_companions, read_shapes
from .maps.shapes import Heights
from .object_input import read_object
from .objects.geo_object import HOLE, LINES, POINTS, SURFACE, GeoObject, object_units
from .rasters.geotiff import world_file
from .rasters.raster import Raster
from .tables.points import PointRows, other_columns
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
        with_attributes = Heights(with_attributes=True)
        rows = read_shapes(MapLayer(file, given.layer, given.where), heights=with_attributes).attributes or {}
        names = list(dict.fromkeys(str(name) for row in rows.values() for name in row))
        what = "its positions have no elevation"
        if given.height is not None:
            what = f"attribute '{given.height}' has no elevations"
        advice = 'name the attribute with the elevation: height = "..."'
        advice += f"; it has {names_shown(names)}" if names else ""
        raise HeightsMissing(what, file=file, advice=advice)
    left_out = len(positions) - len(points)
    warnings = [f"{file}: left out: {counted(left_out, 'point')} without a value"] if left_out else []
    return points, warnings


_END_OF_LINE = 999.0  # in all three columns, of IRAP's points
_BY_CHANCE = 1e-3  # of all points
_LOOKED_FOR = (*OFTEN_NO_VALUE, _END_OF_LINE)
OF_POINTS = (POINTS, LINES, SURFACE, HOLE)


def read_object_points(
    given: PointFile, obj: GeoObject, gather: JoinPieces, columns: dict[str, np.ndarray] | None = None
) -> tuple[np.ndarray, list[str]]:
    """(P, 3) float64, in the file's unit, and warnings, sentences. gather: where the points are kept.
    columns: where its attributes go, if they are wanted. Raises InputRefused naming the file and the
    object."""
    file = Path(given.file)
    label = f"object '{obj.name}'"
    places = np.array(obj.vertices, np.float64)
    if given.height is not None:
        heights = _attribute(obj, given.height, file)
        if heights.dtype.kind not in "iufb":
            raise InputRefused(f"its attribute '{given.height}' has texts", file=file, item=label)
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
    if columns is not None:
        columns |= {name: values[chosen][has_height] for name, values in obj.columns.items()}
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


@dataclass(frozen=True, eq=False)
class PointData:
    """What read_points gives. xyz: (N, 3) float64 in the model's unit, z upward. columns: (N,) of each
    other column of a table or attribute of an object, by name: numbers (NaN: none) or texts. warnings:
    sentences."""

    xyz: np.ndarray
    columns: dict[str, np.ndarray] = field(default_factory=dict)
    warnings: list[str] = field(default_factory=list)


def read_points(
    file: str | Path, units: str = MODEL_UNIT, *, file_units: str | Mapping | None = None, **keys: Any
) -> PointData:
    """The points of a file in any format of points, as a project reads them.

    units: of the model. file_units: of the file, "ft", or {"xy": "m", "z": "ft"}, where the file does not
    state them or is wrong; None: what it states, or else those of the model. keys: those of PointFile:
    columns, where, separator, decimal, nodata, height, layer, z_axis. Raises UsageError for an unknown
    unit or key, InputRefused naming the file, and the line where it has lines.
    """
    given = reading_keys(PointFile, file, units, file_units, keys)
    columns: dict[str, np.ndarray] = {}
    points, warnings = _read(given, units, no_step, in_memory, columns)
    return PointData(points, columns, warnings)


def reading_keys(of: type, file: Any, units: str, file_units: Any, keys: Mapping[str, Any]) -> Any:
    """A PointFile, MeshFile or Boreholes with the reading keys of a call. Raises UsageError."""
    known = [key for key in settings_of(of) if key not in ("file", "units")]
    if unknown := [key for key in keys if key not in known]:
        raise UsageError(f"there is no key '{unknown[0]}'; there are {', '.join([*known, 'file_units'])}")
    try:
        checked_unit("units", units)
        given = of(file=file, units=file_units, **keys)
        given.check()
    except OptionRefused as error:
        raise UsageError(str(error)) from error
    return given


def read_point_file(
    given: PointFile, model_unit: str = MODEL_UNIT, step: Step = no_step, gather: JoinPieces = in_memory
) -> tuple[np.ndarray, list[str]]:
    """(P, 3) float64 points in the model's unit, and warnings, sentences. gather: where the points are kept.

    Raises InputRefused naming the file, and the line where it has lines.
    """
    return _read(given, model_unit, step, gather, None)


def _read(
    given: PointFile, model_unit: str, step: Step, gather: JoinPieces, columns: dict[str, np.ndarray] | None
) -> tuple[np.ndarray, list[str]]:
    """As read_point_file. columns: where other columns go, if they are wanted."""
    file = Path(given.file)
    values = _Values(gather, file, given)
    file_format = format_of(file, RASTER, ARRAY, OBJECTS, SHAPES, STICKS, MESH, TABLE)
    assert file_format is not None
    if file_format.holds == RASTER:
        raster = _raster(given, file, file_format, step, gather)
        stated = [("x and y", raster.units[0], given.plan_unit), ("z", raster.units[1], given.height_unit)]
        (plan, height), warnings = stated_units(file, stated, model_unit)
        units = (plan, height)
        warnings += [] if given.units else [f"{file}: {text}" for text in raster.warnings]
        points = raster.points(file, values)
    elif file_format.holds == TABLE:
        refuse_keys(file, "is a table", given.only_for_shapes, ("layer",) if file_format.layers else ())
        rows = file_format.read(given, step, values)
        points = rows.points
        units, warnings = _table_units(given, file, rows, model_unit)
        warnings += [f"{file}: {text}" for text in rows.doubts]
        if columns is not None:
            columns |= other_columns(given, rows)
        values.nodata = rows.table.layout.nodata
        if rows.missing:
            warnings.append(f"{file}: left out: {counted(rows.missing, 'point')} without a value")
    elif file_format.holds == OBJECTS:
        refuse_keys(file, "has objects", given.only_for_tables)
        obj = read_object(file, given.layer, OF_POINTS, step)
        units, warnings = object_units(given, obj, model_unit)
        points, more = read_object_points(given, obj, values, columns)
        warnings = [*(f"{file}: {text}" for text in obj.warnings), *warnings, *more]
    else:
        units = (given.plan_unit, given.height_unit)
        points, warnings = _others(given, file, file_format, step, values, columns)
    points = values.without_often_none(points, columns)
    return in_model(points, units, given.z_axis, model_unit, gather), [*warnings, *values.warnings]


def _others(
    given: PointFile,
    file: Path,
    file_format: FileFormat,
    step: Step,
    gather: JoinPieces,
    columns: dict[str, np.ndarray] | None,
) -> tuple[np.ndarray, list[str]]:
    """(P, 3) points of arrays, shapes, polylines and meshes, in the file's unit, and warnings."""
    chosen = ["where"] if given.where else []
    if file_format.holds == ARRAY:
        refuse_keys(file, "is an array", [*given.only_for_tables, *chosen, *given.only_for_shapes])
        return file_format.read(file, gather), []
    if file_format.holds == SHAPES:
        refuse_keys(file, "has shapes", given.only_for_tables)
        return read_map_points(given, step, gather)
    refuse_keys(file, f"is {file_format.label}", [*given.only_for_tables, *chosen, *given.only_for_shapes])
    if file_format.holds == STICKS:
        sticks = file_format.read(file, step)
        if columns is not None:
            columns["stick"] = np.repeat(np.arange(1.0, len(sticks) + 1), [len(stick) for stick in sticks])
        return gather(sticks, np.empty((0, 3))), []
    return gather([file_format.read(file, step, Rows).vertices], np.empty((0, 3))), []


def _table_units(
    given: PointFile, file: Path, rows: PointRows, model_unit: str
) -> tuple[tuple[str | None, str | None], list[str]]:
    """The units of x and y, and of z, and warnings."""
    of_key = (given.plan_unit, given.plan_unit, given.height_unit)
    stated = zip(rows.columns or ("x", "y", "z"), rows.units, of_key, strict=True)
    (x, y, z), warnings = stated_units(file, list(stated), model_unit)
    if (x or model_unit) != (y or model_unit):
        what = f"x is in {x or 'no unit'} and y in {y or 'no unit'}, by the names of their columns"
        raise InputRefused(what, file=file, advice='set units = { xy = "m" } or correct the names')
    return (x, z), warnings


def in_model(
    points: np.ndarray,
    units: tuple[str | None, str | None],
    z_axis: str,
    model_unit: str,
    gather: JoinPieces = in_memory,
) -> np.ndarray:
    """Points (P, 3) of a file in the model's unit, z upward. units: of x and y, and of z."""
    scale = np.array([factor(units[0], model_unit)] * 2 + [factor(units[1], model_unit)])
    scale[2] *= -1.0 if z_axis == "down" else 1.0
    if (scale == 1.0).all():
        return points
    return gather((piece * scale for piece in in_pieces(points)), np.empty((0, 3)))


class _Values:
    """Gathers points, and looks among their coordinates, piece by piece, for values that programs write
    for no data. nodata: the one of the file's format. warnings: sentences."""

    def __init__(self, gather: JoinPieces, file: Path, given: PointFile):
        self._gather, self._file, self._given = gather, file, given
        self.nodata: float | None = None
        self.warnings: list[str] = []
        self._clear()

    def __call__(self, pieces: Iterable[np.ndarray], empty: np.ndarray) -> np.ndarray:
        self._clear()
        return self._gather(map(self._looked_at, pieces), empty)

    def _clear(self) -> None:
        self._count = 0
        self._counts: list[dict[float, int]] = [{}, {}, {}]  # of such values among x, y, z
        self._low, self._high = np.full(3, np.inf), np.full(3, -np.inf)  # of the others

    def _looked_at(self, points: np.ndarray) -> np.ndarray:
        self._count += len(points)
        for axis in range(3 if len(points) else 0):
            column = points[:, axis]
            low, high = column.min(), column.max()
            if any(low <= value <= high for value in _LOOKED_FOR):
                often = np.isin(column, _LOOKED_FOR)
                counts = self._counts[axis]
                for value, count in zip(*np.unique(column[often], return_counts=True), strict=True):
                    counts[float(value)] = counts.get(float(value), 0) + int(count)
                column = column[~often]
                low, high = (column.min(), column.max()) if len(column) else (np.inf, -np.inf)
            self._low[axis], self._high[axis] = min(self._low[axis], low), max(self._high[axis], high)
        return points

    def without_often_none(self, points: np.ndarray, columns: dict[str, np.ndarray] | None) -> np.ndarray:
        """The points without those that have such a value far from all others, and without the rows 999 999
        999 that end lines; and the columns without theirs."""
        if self._given.nodata_values:
            return points
        ends = [counts.pop(_END_OF_LINE, 0) for counts in self._counts]
        far = [self.none_of(axis) for axis in range(3)]
        has_ends = all(ends) and not self._low[0] <= _END_OF_LINE <= self._high[0]
        if not any(far) and not has_ends:
            return points

        def is_known(piece: np.ndarray) -> np.ndarray:
            unknown = np.any([np.isin(piece[:, axis], far[axis]) for axis in range(3)], axis=0)
            return ~(unknown | (has_ends & (piece == _END_OF_LINE).all(axis=1)))

        for name, values in (columns or {}).items():
            assert columns is not None
            columns[name] = values[is_known(points)]
        return self._gather((piece[is_known(piece)] for piece in in_pieces(points)), np.empty((0, 3)))

    def none_of(self, axis: int) -> list[float]:
        """The values of an axis that stand for none."""
        low, high, name = self._low[axis], self._high[axis], "xyz"[axis]
        called = "height" if axis == 2 else name
        values = []
        for value, count in self._counts[axis].items():
            number = "1 point has" if count == 1 else f"{count} points have"
            what = f"{self._file}: {number} the {called} {value:.9g}"
            near = min(abs(value - low), abs(value - high))
            has_others = low <= high
            is_far = has_others and near > max(high - low, 0.5 * abs(value)) and not low <= value <= high
            # among others such a number comes by chance, where there are many of them
            is_rare = low <= value <= high and count <= _BY_CHANCE * self._count
            if has_others and (is_far or value == self.nodata or (value % 1 and not is_rare)):
                values.append(value)
                self.warnings.append(
                    f"{what}, {'far from all others, ' if is_far else ''}which often means no data, and left "
                    'out: if it is a value, set nodata = "none"'
                )
            elif not has_others or value % 1 or (count > 1 and not is_rare):
                self.warnings.append(
                    f"{what}, which often means no data: it is used; if it is none, set nodata = {value:g}"
                )
        return values


def refuse_keys(file: Path, what: str, keys: Iterable[str], but: Container[str] = ()) -> None:
    """Refuses options that have no effect on a file. but: those that do."""
    if keys := [key for key in keys if key not in but]:
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
    stated = [("x and y", raster.units[0], given.plan_unit), ("z", raster.units[1], given.height_unit)]
    (of_plan, of_height), _ = stated_units(file, stated, model_unit)
    if not given.nodata_values:
        heights = raster.z[np.isfinite(raster.z)]
        values = _Values(in_memory, file, given)
        values([np.column_stack([heights] * 3)], np.empty((0, 3)))
        raster.z[np.isin(raster.z, values.none_of(2))] = np.nan
    z = raster.heights_at(plan / factor(of_plan, model_unit))
    points = np.column_stack([plan, z])
    return in_model(points, (None, of_height), given.z_axis, model_unit)[:, 2]


def _raster(source: PointFile, file: Path, file_format: FileFormat, step: Step, gather: JoinPieces) -> Raster:
    chosen = ["where"] if source.where else []
    refuse_keys(file, "is a raster", [*source.only_for_tables, *chosen, *source.only_for_shapes])
    nodata = [value for value in source.nodata_values if not isinstance(value, str)]
    return file_format.read(file, nodata, step, gather)
