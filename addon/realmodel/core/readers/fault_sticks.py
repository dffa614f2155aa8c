# SPDX-License-Identifier: GPL-3.0-or-later
"""Fault sticks and scattered points of a fault: files of polylines, tables with a column of sticks, and all
files that points are read from."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from ..base.errors import InputRefused
from ..base.text import Step, no_step, read_bytes
from ..base.units import MODEL_UNIT
from ..settings.point_file import PointFile
from .formats import RASTER, SHAPES, STICKS, format_of
from .point_input import in_model, read_point_file
from .tables.points import KNOWN, body_rows, open_table
from .tables.sticks import begins_as_sticks, read_sticks
from .tables.table_layout import Expected, plain_name

_COLUMN = "stick"  # the column of a stick's name or number, where none is given


def read_fault_points(
    given: PointFile, stick: str | int | None = None, model_unit: str = MODEL_UNIT, step: Step = no_step
) -> tuple[list[np.ndarray] | np.ndarray, list[str]]:
    """Sticks, a list of (N, 3) float64 each, or scattered points (P, 3), in the model's unit, and warnings.

    A file of polylines has x y z in each line, and 999 999 999 ends a stick. stick: the column of a table, by
    name or by number from 1, with one value for each stick; default: the column named "stick", and without
    such a column the points are scattered. Raises InputRefused naming the file, and the line where it has
    lines.
    """
    file = Path(given.file)
    if format_of(file, RASTER, SHAPES):
        if stick is not None:
            raise InputRefused("it is no table, so 'stick' has no effect", file=file, advice="take it out")
        return read_point_file(given, model_unit, step)
    if format_of(file, STICKS) or begins_as_sticks(read_bytes(file)):  # the first stick may be long
        sticks = [in_model(points, given, model_unit) for points in read_sticks(file, step)]
        return sticks, []
    column = _stick_column(given, file, stick)
    if column is None:
        return read_point_file(given, model_unit, step)
    return _table_sticks(given, file, column, model_unit)


def _stick_column(source: PointFile, file: Path, stick: str | int | None) -> str | None:
    """The column of sticks as `where` of a PointFile names it; None where there is none."""
    wanted = () if stick is None else (stick,)
    table = open_table(
        file, Expected(source.separator, (*(source.columns or ()), *wanted, *source.where), KNOWN)
    )
    if stick is not None:
        return str(table.column(stick) + 1)
    names = [plain_name(name) for name in table.layout.names or ()]
    return str(names.index(_COLUMN) + 1) if _COLUMN in names else None


def _table_sticks(
    source: PointFile, file: Path, column: str, model_unit: str
) -> tuple[list[np.ndarray], list[str]]:
    table = open_table(file, Expected(source.separator, (*(source.columns or ()), *source.where), KNOWN))
    at = int(column) - 1
    names = dict.fromkeys(row[at] for row in body_rows(table) if at < len(row))
    sticks, warnings = [], []
    for name in names:
        points, texts = read_point_file(replace(source, where={**source.where, column: name}), model_unit)
        sticks.append(points)
        warnings += texts
    return sticks, list(dict.fromkeys(warnings))
