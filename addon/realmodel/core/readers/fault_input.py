# SPDX-License-Identifier: GPL-3.0-or-later
"""Faults from files: sticks, scattered points, and traces with the attributes that say how the fault dips."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from ..base.errors import InputRefused
from ..base.no_value import OFTEN_NO_VALUE
from ..base.text import Step, no_step, read_bytes
from ..base.units import MODEL_UNIT
from ..settings.data_files import MapLayer, PointFile
from ..settings.directions import checked_direction
from ..settings.method_options import OptionRefused
from ..settings.setting import settings_of
from .formats import OBJECTS, RASTER, SHAPES, STICKS, format_of
from .map_input import read_shapes
from .maps.shapes import Heights, Shapes
from .maps.wkt import parse_wkt
from .point_input import in_model, read_point_file, read_points, refuse_keys
from .tables.points import body_rows, table_of
from .tables.sticks import begins_as_sticks, read_sticks
from .tables.table_layout import names_shown, plain_name

_COLUMN = "stick"  # the column of a stick's name or number, where none is given


def read_fault_points(
    given: PointFile, stick: str | int | None = None, model_unit: str = MODEL_UNIT, step: Step = no_step
) -> tuple[list[np.ndarray] | np.ndarray, list[str]]:
    """Sticks, a list of (N, 3) float64 each, or scattered points (P, 3), in the model's unit, and warnings.

    A file of polylines has x y z in each line, and 999 999 999 ends a stick. stick: the column of a table, by
    name or by number from 1, with one value for each stick; default: the column named "stick", and without
    such a column the points are scattered. Lines of an object of a file are sticks, too. Raises InputRefused
    naming the file, and the line where it has lines.
    """
    file = Path(given.file)
    if format_of(file, RASTER, SHAPES):
        if stick is not None:
            raise InputRefused("it is no table, so 'stick' has no effect", file=file, advice="take it out")
        return read_point_file(given, model_unit, step)
    if format_of(file, OBJECTS):
        return _object_sticks(given, stick, model_unit)
    if format_of(file, STICKS) or begins_as_sticks(read_bytes(file)):  # the first stick may be long
        units = given.plan_unit, given.height_unit
        sticks = [in_model(points, units, given.z_axis, model_unit) for points in read_sticks(file, step)]
        return sticks, []
    column = _stick_column(given, stick)
    if column is None:
        return read_point_file(given, model_unit, step)
    return _table_sticks(given, file, column, model_unit)


def _object_sticks(
    given: PointFile, stick: str | int | None, model_unit: str
) -> tuple[list[np.ndarray] | np.ndarray, list[str]]:
    keys = {key: getattr(given, key) for key in settings_of(PointFile) if key not in ("file", "units")}
    data = read_points(given.file, model_unit, file_units=given.units, **keys)
    column = data.columns.get(str(stick or _COLUMN))
    if column is None and stick is not None:
        advice = f"its points have {names_shown(list(data.columns))}" if data.columns else None
        raise InputRefused(f"it has no attribute '{stick}'", file=given.file, advice=advice)
    if column is None:
        return data.xyz, data.warnings
    return [data.xyz[column == name] for name in dict.fromkeys(column.tolist())], data.warnings


def _stick_column(source: PointFile, stick: str | int | None) -> str | None:
    """The column of sticks as `where` of a PointFile names it; None where there is none."""
    wanted = () if stick is None else (stick,)
    table = table_of(source, *wanted)
    if stick is not None:
        return str(table.column(stick) + 1)
    names = [plain_name(name) for name in table.layout.names or ()]
    return str(names.index(_COLUMN) + 1) if _COLUMN in names else None


def _table_sticks(
    source: PointFile, file: Path, column: str, model_unit: str
) -> tuple[list[np.ndarray], list[str]]:
    table = table_of(source)
    at = int(column) - 1
    names = dict.fromkeys(row[at] for row in body_rows(table) if at < len(row))
    sticks, warnings = [], []
    for name in names:
        points, texts = read_point_file(replace(source, where={**source.where, column: name}), model_unit)
        sticks.append(points)
        warnings += texts
    return sticks, list(dict.fromkeys(warnings))


_NOT_LETTERS = re.compile(r"[^a-z]")
_DIP, _DIRECTION, _STRIKE = re.compile("dip(angle)?"), re.compile("dip(dir|az).*"), re.compile("strike.*")


@dataclass(frozen=True)
class FaultLines:
    """lines: (N, 3) float64 each, z NaN where there is none. attributes: of the features that they are of, by
    the names of these in messages; missing: numbers in them that mean no value."""

    lines: list[np.ndarray]
    file: Path | None = None
    attributes: dict[str, Mapping] = field(default_factory=dict)
    missing: Sequence[float] = ()

    def dip(self) -> float | None:
        """The dip in degrees that the attributes of all features say alike; None where they say none. Raises
        InputRefused naming the feature."""
        return self._value("dip", _dip)

    def dip_direction(self) -> float | str | None:
        """As dip: degrees, or a point of the compass, of `dip_direction` (`dip_dir`, `dip_azimuth`, ...) or
        `strike` (the fault dips to the right of it), in upper or lower case."""
        return self._value("dip_direction", _direction)

    def _value(self, key: str, read: Callable[[Mapping, Sequence[float]], Any]) -> Any:
        features: dict[object, str] = {}
        for feature, attributes in self.attributes.items():
            try:
                value = read(attributes, self.missing)
            except OptionRefused as error:
                raise InputRefused(
                    error.what, file=self.file, item=feature or None, advice=error.advice
                ) from error
            if value is not None:
                features.setdefault(value, feature)
        if len(features) > 1:
            (one, first), (other, second) = list(features.items())[:2]
            raise InputRefused(
                f"its lines differ in '{key}': it is {one} in {first} and {other} in {second}",
                file=self.file,
                advice=f"set {key} = ..., or choose the lines of one fault with where = {{ ... }}",
            )
        return next(iter(features), None)


def read_fault_trace(
    given: PointFile | str, model_unit: str = MODEL_UNIT, step: Step = no_step
) -> FaultLines:
    """The lines of a file of outlines and lines, or of a well-known text, in the model's unit. Raises
    InputRefused naming the file."""
    if isinstance(given, str):
        return FaultLines(_lines(parse_wkt(given, None, True), None))
    file = Path(given.file)
    refuse_keys(file, "has lines", given.only_for_tables)
    layer = MapLayer(file, given.layer, given.where)
    shapes = read_shapes(layer, step=step, heights=Heights(given.height, with_attributes=True))
    missing = [float(value) for value in given.nodata_values if not isinstance(value, str)]
    lines = _lines(shapes, file)
    for line in lines:
        line[np.isin(line[:, 2], missing), 2] = np.nan
    all_attributes = shapes.attributes or {}
    attributes = {
        name: all_attributes.get(name, {})
        for name in (_feature(all_attributes, line_name) for line_name, _ in shapes.lines)
    }
    lines = [in_model(line, (given.plan_unit, given.height_unit), given.z_axis, model_unit) for line in lines]
    return FaultLines(lines, file, attributes, (*missing, *OFTEN_NO_VALUE))


def _lines(shapes: Shapes, file: Path | None) -> list[np.ndarray]:
    lines = [line for _, line in shapes.lines if len(line)]
    if not lines:
        has = " (it has polygons)" if shapes.polygons else " (it has points)" if shapes.points else ""
        raise InputRefused(
            f"there are no lines in it{has}", file=file, advice="draw the trace of the fault as a line"
        )
    return lines


def _feature(attributes: Mapping, line_name: str) -> str:
    """The name of the feature that a line is of; a line of a collection has a longer one."""
    return next((name for name in (line_name, line_name.partition(",")[0]) if name in attributes), "")


def _dip(attributes: Mapping, missing: Sequence[float]) -> float | None:
    value = _attribute(attributes, _DIP, missing)
    if value is None:
        return None
    if isinstance(value, str) or not 0.0 < value <= 90.0:
        raise OptionRefused(f"its attribute of the dip is {value!r}; it must be above 0, and at most 90")
    return value


def _direction(attributes: Mapping, missing: Sequence[float]) -> float | str | None:
    value = _attribute(attributes, _DIRECTION, missing)
    if value is not None:
        return checked_direction("dip_direction", value)
    value = _attribute(attributes, _STRIKE, missing)
    if isinstance(value, str):
        raise OptionRefused(f"its attribute of the strike is not a number: {value!r:.40}")
    return None if value is None else (value + 90.0) % 360.0


def _attribute(attributes: Mapping, name: re.Pattern, missing: Sequence[float]) -> float | str | None:
    """A number or a text of the first attribute that has such a name and a value."""
    for key, value in attributes.items():
        if not name.fullmatch(_NOT_LETTERS.sub("", str(key).lower())) or isinstance(value, bool):
            continue
        try:
            number = float(value)
        except (TypeError, ValueError):
            if isinstance(value, str) and value.strip():
                return value.strip()
            continue
        if np.isfinite(number) and number not in missing:
            return number
    return None
