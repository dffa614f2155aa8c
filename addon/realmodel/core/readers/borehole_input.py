# SPDX-License-Identifier: GPL-3.0-or-later
"""Boreholes from files; their format is detected from the content."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

from ..base.errors import InputRefused
from ..base.text import Step, no_step
from ..base.units import MODEL_UNIT
from ..settings.data_files import Boreholes
from .hole_files import read_hole_files
from .hole_values import read_logs
from .object_input import hole_sheets, is_object_file
from .point_input import refuse_keys
from .table_kind import with_sheets
from .tables.boreholes import Picks, picks_of_tables
from .tables.hole_data import MEANINGS, HoleTables, read_hole_rows
from .tables.hole_repair import repair
from .tables.holes import Holes
from .tables.interval_values import IntervalValues
from .tables.unit_names import UnitNames


def read_picks(
    given: Boreholes,
    model_unit: str = MODEL_UNIT,
    step: Step = no_step,
    units: UnitNames | None = None,
    plan_step: float | None = None,
) -> Picks:
    """The points of every surface that the picks name, in the model's unit, and what intervals say: of
    tables, or of the objects of an OMF or geoh5 file. units: what the names in them mean. plan_step: as of
    read_intervals. Raises InputRefused naming file and line, or object."""
    units = units or UnitNames()
    tables = read_repaired(given, model_unit, step, units)
    if tables.picks is None and tables.intervals is None and not given.logs:
        advice = "give a table of them: picks = ... or intervals = ..."
        if tables.without_blocks:
            advice = f"name the column of units: {tables.without_blocks}"
        what = "it has neither picks nor intervals of blocks"
        raise InputRefused(what, file=given.files[-1], advice=advice)
    logs = read_logs(tables, Holes(tables), model_unit)  # adds warnings
    picks = picks_of_tables(tables, tables.scale(model_unit), units, plan_step)
    picks.logs = IntervalValues.joined(logs) if logs else None
    return picks


def _refuse_tables(given: Boreholes, of_objects: list[Path]) -> None:
    """Refuses tables, and keys of tables, beside files of objects."""
    refuse_keys(of_objects[0], "has objects", given.only_for_tables)
    if len(of_objects) < len(given.files):
        advice = "give tables, or files of objects"
        raise InputRefused("it has objects, and the other file is a table", file=of_objects[0], advice=advice)


def read_repaired(
    given: Boreholes, model_unit: str = MODEL_UNIT, step: Step = no_step, units: UnitNames | None = None
) -> HoleTables:
    """The tables of some boreholes, repaired. units: what the names in them mean; None: themselves. Raises
    InputRefused naming file and line."""
    of_objects = [file for file in given.files if is_object_file(file)]
    if of_objects:
        _refuse_tables(given, of_objects)
        sheets, lines, warnings = hole_sheets(given, model_unit)
        tables_of: dict[str, Any] = dict.fromkeys(MEANINGS) | dict.fromkeys(sheets, of_objects[0])
        given = replace(given, file=None, layer=None, units=None, columns={}, **tables_of)
        tables = read_hole_rows(given, model_unit, step, sheets=sheets)
        tables.lines = lines
        tables.warnings += warnings
    else:
        given, names = with_sheets(given)
        if given.layer is not None:
            what = f"it is a table, so it has no object '{given.layer}'"
            raise InputRefused(what, file=given.files[-1], advice="take 'layer' out")
        tables = read_hole_files(given, model_unit, step, sheets=names)
    repair(tables, units)
    return tables
