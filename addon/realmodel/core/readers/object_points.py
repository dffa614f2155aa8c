# SPDX-License-Identifier: GPL-3.0-or-later
"""Points with heights from the objects of a file: sets of points, and the vertices of lines and surfaces."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from ..base.errors import InputRefused, counted
from ..base.mapped_arrays import JoinPieces
from ..settings.point_file import PointFile, list_of
from .object_input import read_object
from .objects.geo_object import HOLE, LINES, POINTS, SURFACE, GeoObject
from .tables.table_layout import names_shown

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
