#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The units of the boreholes at Kai Tak, from the descriptions of their logs.

    python3 blend_samples/kai_tak/read_units.py 64475_ASD012162.ags FOLDER

writes collars.csv and intervals.csv to the folder. The column of units of the file (GEOL_GEOL) knows two, so
the unit is read from the description: the first line of UNITS whose words are in it. Rock means grades III
and better. Granite is the rock that a hole ends in, if it is at least 5 m thick; rock above it is a corestone
in saprolite.

Needs the Python package, or PYTHONPATH=addon.
"""

import csv
import re
import sys
from pathlib import Path

from realmodel.core import InputRefused, RealModelError, read_boreholes

UNITS = (
    ("Marine Deposit", r"MARINE DEPOSIT\)"),
    ("Alluvium", r"\(ALLUVIUM|as ALLUVIUM"),
    ("Fill", r"\(FILL\)|as FILL|CONCRETE|BITUMEN"),
    ("", r"No sample recovered\.$"),
    ("Saprolite", r"(completely|highly) decomposed"),
    ("rock", r"(moderately|slightly) decomposed|GRANITE"),
)
PROVED = 5.0  # m of rock at the end of a hole


def unit_of(description: str) -> str:
    """The unit that a description means, "" for none. Raises InputRefused where no line of UNITS fits."""
    for unit, words in UNITS:
        if re.search(words, description):
            return unit
    raise InputRefused(f"no unit is known for {description!r}: add its words to UNITS")


def with_granite(log: list[list]) -> list[list]:
    """The log of a hole, rows of (hole, from, to, unit): its rock is granite, or corestones in saprolite."""
    end = len(log)
    while end and log[end - 1][3] == "rock":
        end -= 1
    if end < len(log) and log[-1][2] - log[end][1] < PROVED:
        end = len(log)
    names = [
        ("Granite" if number >= end else "Saprolite") if unit == "rock" else unit
        for number, (*_, unit) in enumerate(log)
    ]
    return [[*row[:3], name] for row, name in zip(log, names, strict=True)]


def main(file: Path, folder: Path) -> None:
    boreholes = read_boreholes(file, columns={"block": "GEOL_DESC"})
    logs: dict[str, list[list]] = {}
    for hole, top, end, text in zip(*boreholes.intervals.values(), strict=True):
        logs.setdefault(hole, []).append([hole, top, end, unit_of(text)])
    rows = [row for log in logs.values() for row in with_granite(log)]
    folder.mkdir(parents=True, exist_ok=True)
    collars = boreholes.collars
    write(folder / "collars.csv", collars, zip(*collars.values(), strict=True))
    write(folder / "intervals.csv", ("hole", "from", "to", "block"), rows)
    corestones = sum(end - top for log in logs.values() for _, top, end, unit in log if unit == "rock")
    granite = sum(row[2] - row[1] for row in rows if row[3] == "Granite")
    saprolite = sum(row[2] - row[1] for row in rows if row[3] == "Saprolite")
    unnamed = sum(not row[3] for row in rows)
    print(f"{len(logs)} holes, {len(rows)} intervals, {unnamed} of them without a unit")
    print(f"corestones: {100 * (corestones - granite) / saprolite:.1f} % of the length in saprolite")


def write(path: Path, header, rows) -> None:
    with path.open("w", newline="", encoding="utf-8") as file:
        csv.writer(file).writerows([header, *rows])


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    try:
        main(Path(sys.argv[1]), Path(sys.argv[2]))
    except RealModelError as error:
        sys.exit(f"read_units.py: {error}")
