#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The table of docs/dev/field_data.md: of eight histories in closed form the share of random points that
models have in the right block, from contacts of holes alone, from logs, outcrops and dips, and from these
with conformable surfaces as series of sheets.

    scripts/compare_field_data.py [--history NAME]... [--method NAME] [--seeds N]
        [--write docs/dev/field_data.md]

Needs the built module (scripts/build.sh).
"""

import argparse
import re
import sys
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT / folder) for folder in ("addon", "scripts")]

from field_data.histories import HISTORIES  # noqa: E402
from field_data.measured import measure, project, random_points, right_share  # noqa: E402
from realmodel.core import build  # noqa: E402

HEADER = (
    "| history | surfaces | holes | contacts alone | and logs, dips | and series | observations kept |",
    "|---|---|---|---|---|---|---|",
)
TABLE = re.compile(re.escape("\n".join(HEADER)) + r"\n(?:\|.*\n)*")


def row(history, method, seeds):
    """A row of the table: means over places of measurements drawn `seeds` times."""
    shares = []
    for seed in range(1, seeds + 1):
        data = measure(history, seed)
        points = random_points(history)
        models = [build(project(history, data, what, method)) for what in ("contacts", "all", "series")]
        kept = min(model.observed().share for model in models[1:])
        shares.append((*(right_share(model, *points) for model in models), kept))
    alone, whole, series, kept = np.mean(shares, axis=0)
    surfaces = len(history.layers)
    with_series = f"{series:.3f}" if history.conformable else ""
    given = f"| {history.name} | {surfaces} | {history.holes} | {alone:.3f} | {whole:.3f} |"
    return f"{given} {with_series} | {kept:.3f} |"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--history", action="append", choices=[each.name for each in HISTORIES])
    parser.add_argument("--method")
    parser.add_argument("--seeds", type=int, default=1)
    parser.add_argument("--write", type=Path)
    given = parser.parse_args()
    page = "" if given.write is None else given.write.read_text(encoding="utf-8")
    table = TABLE.search(page)
    if given.write is not None and table is None:
        parser.error(f"{given.write} has no table with the header\n{HEADER[0]}")
    rows = {line.split("|")[1].strip(): line for line in table[0].splitlines()[2:]} if table else {}
    for history in HISTORIES:
        if given.history is None or history.name in given.history:
            rows[history.name] = row(history, given.method, given.seeds)
            print(rows[history.name], flush=True)
    if table is not None:
        lines = [*HEADER, *(rows[history.name] for history in HISTORIES if history.name in rows)]
        page = page[: table.start()] + "\n".join(lines) + "\n" + page[table.end() :]
        given.write.write_text(page, encoding="utf-8")


if __name__ == "__main__":
    main()
