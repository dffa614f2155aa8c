# SPDX-License-Identifier: GPL-3.0-or-later
"""scripts/benchmark.sh, once everything is built: measures, tells, and writes docs/dev/performance.md."""

from __future__ import annotations

import argparse
import signal
import sys
from pathlib import Path

from . import (
    blender_table,
    booleans_table,
    display_table,
    files_table,
    heights_table,
    memory_table,
    meshing_table,
    page,
    structures_table,
    tiles_table,
    watching_table,
    window_table,
)
from .process import ROOT
from .stacks_table import Limits, Row, StackRows

PARTS = (
    "stacks",
    "watch",
    "blender",
    "memory",
    "heights",
    "meshing",
    "booleans",
    "structures",
    "files",
    "tiles",
)
_QUICK_TRIANGLES, _ALL_TRIANGLES = 800_000, 10_000_000


def main() -> int:
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))  # ends what runs apart as well
    given = _arguments()
    memory = 1e9 * given.memory
    limits = Limits(
        _QUICK_TRIANGLES if given.quick else _ALL_TRIANGLES, memory, pairs=1 if given.quick else None
    )
    machine = page.machine()
    print(machine, flush=True)
    tables: dict[str, list[list[str]]] = {}
    parts = given.only or PARTS
    if "stacks" in parts:
        rows = StackRows(limits, lambda row: print(" | ".join(_cells(row)), flush=True)).all()
        tables["stacks"] = [page.table(_HEADINGS, [_cells(row) for row in rows], 2)]
    if "watch" in parts:
        progress, cancels = watching_table.measure(limits, _say)
        tables["progress"] = [
            page.table(watching_table.PROGRESS, progress, 2),
            page.table(watching_table.CANCELS, cancels, 2),
        ]
    if "blender" in parts:
        rows = blender_table.measure(given.quick, memory, _say)
        live, still = window_table.measure(given.quick, memory, _say)
        frames = display_table.measure(given.quick, memory, _say)
        tables["blender"] = [
            page.table(blender_table.UPLOADS, rows),
            page.table(window_table.LIVE, live),
            page.table(window_table.STILL, still),
            page.table(display_table.FRAMES, frames),
        ]
    if "memory" in parts:
        live, points = memory_table.measure(given.quick, memory, _say)
        tables["memory"] = [page.table(memory_table.LIVE, live), page.table(memory_table.POINTS, points)]
    if "heights" in parts:
        speed, accuracy = heights_table.measure(given.quick, memory, _say)
        tables["heights"] = [
            page.table(heights_table.SPEED, speed, 3),
            page.table(heights_table.ACCURACY, accuracy),
        ]
    if "meshing" in parts:
        meshes, outlines, polygons = meshing_table.measure(given.quick, memory, _say)
        tables["meshing"] = [
            page.table(meshing_table.MESHES, meshes, 2),
            page.table(meshing_table.OUTLINES, outlines, 3),
            page.table(meshing_table.POLYGONS, polygons),
        ]
    if "booleans" in parts:
        rows = booleans_table.measure(given.quick, memory, _say)
        tables["booleans"] = [page.table(booleans_table.BOOLEANS, rows, 2)]
    if "structures" in parts:
        faulted, cuts = structures_table.measure(given.quick, memory, _say)
        tables["structures"] = [
            page.table(structures_table.FAULTS, faulted, 2),
            page.table(structures_table.CUTS, cuts),
        ]
    if "files" in parts:
        rows = files_table.measure(given.quick, memory, _say)
        loaded = files_table.measure_loading(given.quick, memory, _say)
        tables["files"] = [page.table(files_table.FILES, rows), page.table(files_table.LOADED, loaded)]
    if "tiles" in parts:
        beside, sizes = tiles_table.measure(given.quick, memory, _say)
        tables["tiles"] = [page.table(tiles_table.BESIDE, beside, 2), page.table(tiles_table.SIZES, sizes)]
    if given.write:
        for name, of_part in tables.items():
            lines = [machine, *(line for table in of_part for line in ("", *table))]
            page.write_part(given.write, f"benchmark.sh {name}", lines)
        print(f"written into {given.write}", flush=True)
    return 0


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="benchmark.sh", description=__doc__)
    parser.add_argument(
        "--quick", action="store_true", help="small sizes, each once; the page is left as it is"
    )
    parser.add_argument(
        "--only", action="append", choices=PARTS, help="this part only; may be given several times"
    )
    parser.add_argument(
        "--memory", type=float, default=12.0, metavar="GB", help="most that a process may take"
    )
    parser.add_argument(
        "--write", type=Path, metavar="F.md", help="page to write (default: docs/dev/performance.md)"
    )
    given = parser.parse_args()
    if given.write is None and not given.quick:
        given.write = Path("docs/dev/performance.md")
    if given.write is not None:
        given.write = ROOT / given.write  # what is relative is so to the project, not to this folder
    return given


def _say(line: str) -> None:
    print(line, flush=True)


_HEADINGS = (
    "work",
    "compared with",
    "ours, s",
    "theirs, s",
    "ours / theirs",
    "required",
    "goal",
    "our memory, MB",
    "their memory, MB",
    "",
)


def _cells(row: Row) -> list[str]:
    return [
        row.work,
        row.peer,
        _seconds(row.ours),
        _seconds(row.theirs),
        "-" if row.ratio is None else f"**{_ratio(row.ratio)}**",
        _ratio(row.must),
        _ratio(row.goal),
        _megabytes(row.our_peak),
        _megabytes(row.their_peak),
        "; ".join([_verdict(row), *row.notes]),
    ]


def _verdict(row: Row) -> str:
    if row.met is None:
        return "SKIPPED"
    if row.met:
        return "met"
    return "NOT met" if row.ratio > row.must else "NOT met: too much memory"


def _ratio(value: float) -> str:
    return f"{value:.2f}" if value >= 0.1 else f"1/{1 / value:.0f}"


def _seconds(value: float | None) -> str:
    return "-" if value is None else f"{value:.2f}"


def _megabytes(value: int | None) -> str:
    return "-" if value is None else f"{value / 1e6:,.0f}"


if __name__ == "__main__":
    sys.exit(main())
