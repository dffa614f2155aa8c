# SPDX-License-Identifier: GPL-3.0-or-later
"""The tables of what stays: memory over live builds; the .blend and undo of a surface of many points."""

from __future__ import annotations

import json
import statistics
from collections.abc import Callable

from .blender_table import blenders
from .process import ROOT, Skipped, run_apart

LIVE = (
    "Blender",
    "live builds",
    "after the first, MB",
    "after the last, MB",
    "grown, MB",
    "required, MB",
    "",
)
POINTS = (
    "Blender",
    "points",
    "file, MB",
    ".blend, MB",
    "required, MB",
    "undo step, s",
    "undo, s",
    "required, s",
    "memory of five steps, MB",
    "",
)
ASKED_GROWN = 100e6  # bytes in all
ASKED_UNDO = 0.2  # seconds for a million points
ASKED_BLEND = 48.0  # bytes a point: twice its three numbers
_SCRIPT = ROOT / "scripts" / "benchmarks" / "blender_memory.py"


def measure(
    quick: bool, memory: float, say: Callable[[str], None]
) -> tuple[list[list[str]], list[list[str]]]:
    """Rows for LIVE and for POINTS."""
    live, points = [], []
    for name, command in blenders(_SCRIPT):
        try:
            told = _told([*command, "--", 20, 100_000 if quick else 1_000_000], memory)
            live.append(_live_row(told))
            points.append(_points_row(told))
        except Skipped as skipped:
            live.append([name, *["-"] * (len(LIVE) - 2), f"SKIPPED: {skipped}"])
            points.append([name, *["-"] * (len(POINTS) - 2), f"SKIPPED: {skipped}"])
        say("memory: " + " | ".join(live[-1]))
        say("memory: " + " | ".join(points[-1]))
    return live, points


def _told(command: list, memory: float) -> dict:
    try:
        out, _, _ = run_apart(command, 900.0, int(memory))
    except FileNotFoundError as error:
        raise Skipped(f"{error.filename} is not there") from error
    lines = [line for line in out.splitlines() if line.startswith("{")]
    if not lines:
        raise Skipped("Blender did not tell what it took")
    return json.loads(lines[-1])


def _live_row(told: dict) -> list[str]:
    taken = told["live"]["resident"]
    grown = max(taken) - taken[0]
    megabytes = (f"{value / 1e6:,.0f}" for value in (taken[0], taken[-1], grown, ASKED_GROWN))
    return [told["blender"], str(len(taken)), *megabytes, "met" if grown <= ASKED_GROWN else "NOT met"]


def _points_row(told: dict) -> list[str]:
    points, seconds = told["points"]["points"], told["points"]["seconds"]
    undo, blend = statistics.median(seconds["undo"]), told["points"]["blend"]
    most = ASKED_UNDO * points / 1e6
    is_met = undo <= most and blend <= ASKED_BLEND * points
    return [
        told["blender"],
        f"{points:,}",
        f"{told['points']['csv'] / 1e6:,.1f}",
        f"{blend / 1e6:,.1f}",
        f"{ASKED_BLEND * points / 1e6:,.1f}",
        f"{statistics.median(seconds['change and step']):.3f}",
        f"{undo:.3f}",
        f"{most:.3f}",
        f"{told['points']['five steps'] / 1e6:,.1f}",
        "met" if is_met else "NOT met",
    ]
