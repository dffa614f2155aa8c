# SPDX-License-Identifier: GPL-3.0-or-later
"""What is wrong with rows of tables of boreholes, and what was done about it."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ...base.errors import counted, number_list
from .hole_tables import Row

USED, REPAIRED, LEFT_OUT = "used", "repaired", "left out"
NOT_REACHED = "not_reached"  # picks that are left out, although nothing is wrong
_LISTED = 3

# By the kind of a problem; those of intervals and picks that are left out have theirs in observations.KINDS.
HOLE_PROBLEMS = {
    "hole_name": "holes are matched with those with collars",
    "double": "rows are there twice, and count once",
    "two_collars": "holes have two collars, of which one is used",
    "no_place": "holes are without x, y or z, and are not used",
    "null": "values that stand for none are taken as not known",
    "number": "numbers are written otherwise, and are read as such",
    "no_row": "rows are no data, and are not used",
    "station": "stations of surveys make no sense, and are not used",
    "azimuth": "azimuths are turned into 0 to 360",
    "dip_sign": "dips have the wrong sign, which is changed",
    "two_directions": "holes have two directions at one depth, of which one is used",
    "order": "rows are out of order, and are sorted, or are used as they are where the hole may be right",
    "below_end": "data are deeper than the hole, and are used: the collar's depth or they are wrong",
    "gap": "gaps between intervals are closed at their middle",
    "overlap": "overlaps of intervals are closed at their middle",
    "reversed": "intervals end above where they begin, and are turned around",
    "elevations": "depths are elevations; converted: the collar's elevation minus them",
    "minus_sign": "depths have a minus sign, which is taken away",
    "unrepaired": "rows are used unchanged, because of 'unrepaired'",
    "switched_off": "rows are not used, because of 'left_out'",
    NOT_REACHED: "picks are without a depth, as the hole did not reach the surface",
}


DECIDED = ("unrepaired", "switched_off")  # kinds that are the user's word, and no problem any more


@dataclass(frozen=True)
class HoleProblem:
    """A fault of a row of a table of boreholes.

    kind: the fault, such as "gap", "overlap", "null", "double", "elevations", "no_collar". file, line: of the
    row; line 0 where the format has none. hole: its name. depth: along it, as the table has it, NaN where
    there is none. text: the fault and its treatment. action: "used" as it is, "repaired", or "left out".
    code: the unit or surface of an interval or a pick, None of other rows.
    """

    kind: str
    file: Path
    line: int
    hole: str
    depth: float
    text: str
    action: str
    code: str | None = None

    def __str__(self) -> str:
        return f"{self.file}: {self.text} ({self.action})"


class ProblemList(list[HoleProblem]):
    """Problems as they are found. values: those of values that stand for none, by file, line and column:
    whether the rest of the row is used is known later."""

    def __init__(self) -> None:
        super().__init__()
        self.values: dict[tuple[Path, int, str], HoleProblem] = {}

    def note(
        self, kind: str, action: str, row: Row, what: str, depth: float | None = None, code: str | None = None
    ) -> None:
        """Adds a problem of a row. what: the end of its text. depth: None or NaN where it is not known. code:
        the unit or surface of an interval or a pick."""
        self.append(_problem(kind, action, row, what, (depth, code)))

    def note_value(self, row: Row, column: str, what: str) -> None:
        """Adds that a value of a row stands for none."""
        problem = _problem("null", REPAIRED, row, f"{column} is {what}: no value", (None, None))
        self.values[row.file, row.line, column] = problem

    def in_order(self) -> list[HoleProblem]:
        """All of them, by file and line."""
        return sorted([*self.values.values(), *self], key=lambda problem: (str(problem.file), problem.line))

    def taken(self, row: Row, *columns: str) -> str:
        """Takes out what note_value added of some columns, as the row is left out: the first of it, "" where
        there is none."""
        taken = (self.values.pop((row.file, row.line, column), None) for column in columns)
        return next((problem.text.partition(": ")[2] for problem in [*taken] if problem is not None), "")


def _problem(
    kind: str, action: str, row: Row, what: str, where: tuple[float | None, str | None]
) -> HoleProblem:
    hole = row.text("hole") if row.has("hole") else ""
    depth, code = float("nan") if where[0] is None else float(where[0]), where[1]
    at, named = "" if np.isnan(depth) else f" at {depth:.9g}", "" if code is None else f", '{code}'"
    text = f"{row.place}, hole '{hole}'{at}{named}: {what}"
    if kind == "overlap" and action == LEFT_OUT:
        text = f"hole '{hole}' {what}"
    return HoleProblem(kind, row.file, row.line, hole, depth, text, action, code)


def problem_warnings(problems: Iterable[HoleProblem]) -> list[str]:
    """A sentence for each file and kind of problems, but those of intervals and picks that are left out: a
    build lists them."""
    texts: dict[tuple[Path, str], list[str]] = {}
    for problem in problems:
        if problem.code is None or problem.action != LEFT_OUT:
            texts.setdefault((problem.file, problem.kind), []).append(problem.text)
    sentences = []
    for (file, kind), listed in texts.items():
        if kind == NOT_REACHED:
            sentences.append(f"{file}: left out: {counted(len(listed), 'pick')} without a depth")
        elif kind == "hole_name":
            names = dict.fromkeys(
                text.partition("hole ")[2].replace(": taken for", " for") for text in listed
            )
            sentences.append(f"{file}: {HOLE_PROBLEMS[kind]}: {number_list(names)}")
        else:
            sentences.append(f"{file}: {HOLE_PROBLEMS[kind]} ({len(listed)}): {number_list(listed, _LISTED)}")
    return sentences
