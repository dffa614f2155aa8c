# SPDX-License-Identifier: GPL-3.0-or-later
"""The tables of stacks with faults, beside the same without, and of cuts, beside Manifold, in one run."""

from __future__ import annotations

from collections.abc import Callable

from .process import Skipped, alone

FAULTS = (
    "stack",
    "cells are",
    "faults",
    "s",
    "times without",
    "of processors",
    "required",
    "goal",
    "cells",
    "compartments",
    "memory, MB",
    "",
)
CUTS = (
    "work",
    "ours, s",
    "processors, s",
    "required, s",
    "Manifold, s",
    "processors, s",
    "memory, MB",
    "their memory, MB",
    "",
)
# times the time without, and the goal: of columns on own triangulations, as models are built by default
_ASKED = {1: (4, 2), 3: (8, 3), 6: (12, 4)}
_RUNS = 3
_THREADS = 2


def measure(quick: bool, memory: float, say: Callable[[str], None]):
    """Rows for FAULTS and CUTS; what could not be measured is SKIPPED, and why."""
    faulted, cuts = [], []
    stacks = [("own", "columns")] if quick else [("own", "columns"), ("shared", "columns"), ("own", "blocks")]
    for plan, cells in stacks:
        without = None
        for count in (0, *_ASKED):
            row, found = _faulted(plan, cells, count, without, 40 if quick else 100, memory)
            without = found if count == 0 else without
            faulted.append(row)
            say(" | ".join(row))
    sizes = [(40, 20, None)] if quick else [(100, 45, 1.25), (300, 142, 11.0)]
    for cells in ("columns", "blocks"):
        for quads, rings, asked in sizes:
            cuts.append(_cut(quads, cells, rings, asked if cells == "columns" else None, memory))
            say(" | ".join(cuts[-1]))
    return faulted, cuts


def _faulted(plan: str, cells: str, count: int, without, quads: int, memory: float):
    name = f"10 x {2 * quads * quads:,}" + (" on one plan mesh" if plan == "shared" else "")
    spec = {"surfaces": 10, "quads": quads, "plan": plan}
    try:
        runs = [
            alone("structures.build_faulted", spec, cells, _THREADS, count, memory=memory)
            for _ in range(_RUNS)
        ]
    except Skipped as why:
        return [name, cells, str(count), *["-"] * 8, f"SKIPPED: {why}"], None
    found = sorted(runs, key=lambda run: run["seconds"])[_RUNS // 2]
    row = [name, cells, str(count), f"{found['seconds']:.2f}"]
    verdict = ""
    if without is None:
        row += ["-"] * 4
    else:
        asked, goal = _ASKED[count] if (plan, cells) == ("own", "columns") else (None, None)
        times = found["seconds"] / without["seconds"]
        if asked is not None:
            verdict = "met" if times <= asked else "NOT met"
        of_processors = found["processor"] / without["processor"]
        row += [f"**{times:.1f}**", f"{of_processors:.1f}", str(asked or "-"), str(goal or "-")]
    row += [f"{found['cells']:,}", str(found["compartments"]), f"{found['peak'] / 1e6:,.0f}", verdict]
    return row, found


def _cut(quads: int, cells: str, rings: int, asked: float | None, memory: float) -> list[str]:
    spec = {"surfaces": 10, "quads": quads}
    name = f"10 x {2 * quads * quads:,}, {cells}, by a sphere of {4 * rings * (rings - 1):,} triangles"
    try:
        ours = alone("structures.ours_cut", spec, cells, rings, _THREADS, memory=memory)
    except Skipped as why:
        return [name, *["-"] * 7, f"SKIPPED: {why}"]
    try:
        theirs = alone("structures.manifold_cut", spec, rings, memory=memory)
        peer = [f"{theirs['seconds']:.2f}", f"{theirs['processor']:.2f}"]
        their_memory, note = f"{theirs['peak'] / 1e6:,.0f}", ""
    except Skipped as why:
        peer, their_memory, note = ["-", "-"], "-", f"SKIPPED: {why}"
    if asked is not None:
        note = "; ".join(filter(None, ["met" if ours["seconds"] <= asked else "NOT met", note]))
    return [
        name,
        f"{ours['seconds']:.2f}",
        f"{ours['processor']:.2f}",
        "-" if asked is None else f"{asked:.2f}",
        *peer,
        f"{ours['peak'] / 1e6:,.0f}",
        their_memory,
        note,
    ]
