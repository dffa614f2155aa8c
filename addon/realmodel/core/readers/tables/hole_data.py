# SPDX-License-Identifier: GPL-3.0-or-later
"""The tables of boreholes as they are read, row by row, whatever format they come from."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

from ...base.text import Step, no_step
from ...settings.data_files import Boreholes
from .hole_problems import HoleProblem
from .hole_tables import COLLARS, INTERVALS, SURVEY, Columns, Row, rows

MEANINGS: dict[str, Columns] = {
    "collars": COLLARS,
    "survey": SURVEY,
    "picks": COLLARS,
    "intervals": INTERVALS,
}
_NEEDED = {
    "collars": ("hole", "x", "y", "z"),
    "survey": ("hole", "depth", "azimuth"),
    "picks": ("hole", "surface"),
    "intervals": ("hole", "from", "to", "block"),
}


@dataclass
class HoleTables:
    """given: what they were read from. collars, survey, picks, intervals: their rows, None where there is no
    such table. problems: what was wrong with rows, as far as they are repaired. warnings: sentences."""

    given: Boreholes
    collars: list[Row] | None = None
    survey: list[Row] | None = None
    picks: list[Row] | None = None
    intervals: list[Row] | None = None
    problems: list[HoleProblem] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)


def read_hole_rows(
    given: Boreholes, step: Step = no_step, needed: tuple[str, ...] | None = None
) -> HoleTables:
    """The rows of the tables of some boreholes as they are. needed: the columns of intervals that there must
    be; None: with the block. Raises InputRefused naming file and line."""
    tables = HoleTables(given)
    for kind, known in MEANINGS.items():
        file = getattr(given, kind)
        if file is not None:
            columns = needed if needed is not None and kind == "intervals" else _NEEDED[kind]
            slow = step if kind in ("picks", "intervals") else no_step
            setattr(tables, kind, list(rows(given, Path(file), known, columns, slow)))
    return tables
