# SPDX-License-Identifier: GPL-3.0-or-later
"""What is wrong with rows of tables of boreholes, and what was done about it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

USED, REPAIRED, LEFT_OUT = "used", "repaired", "left out"


@dataclass(frozen=True)
class HoleProblem:
    """A fault of a row of a table of boreholes.

    kind: a word of HOLE_PROBLEMS. file, line: of the row; line 0 where the format has none. hole: its name.
    depth: along it as the table has it, NaN where there is none. text: what is wrong, and what was done.
    action: "used" as it is, "repaired", or "left out".
    """

    kind: str
    file: Path
    line: int
    hole: str
    depth: float
    text: str
    action: str

    def __str__(self) -> str:
        return f"{self.file}:{self.line}: {self.text} ({self.action})"
