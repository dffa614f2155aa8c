# SPDX-License-Identifier: GPL-3.0-or-later
"""The table of how fast a viewport without a graphics card draws a model in each display mode."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable

from .process import ROOT, Skipped, run_apart

FRAMES = (
    "display mode",
    "polygons",
    "frames/s",
    "time / plain meshes",
    "per polygon",
    "time / same content as plain meshes",
    "time to switch, s",
    "",
)
_SCRIPT = ROOT / "scripts" / "benchmarks" / "blender_display.py"
_SURFACES, _SIDE, _QUICK_SIDE = 4, 290, 90  # three blocks of a million polygons; a tenth of that


def measure(quick: bool, memory: float, say: Callable[[str], None]) -> list[list[str]]:
    """Rows for FRAMES: the same blocks as plain meshes first, which the ratios are to."""
    try:
        rows = _rows(_drawn(_QUICK_SIDE if quick else _SIDE, 3 if quick else 9, memory))
    except Skipped as skipped:
        rows = [["display modes", *["-"] * (len(FRAMES) - 2), f"SKIPPED: {skipped}"]]
    for row in rows:
        say("display: " + " | ".join(row))
    return rows


def _drawn(side: int, frames: int, memory: float) -> dict:
    for needed in ("xvfb-run", "blender"):
        if shutil.which(needed) is None:
            raise Skipped(f"{needed} is not there")
    window = ["xvfb-run", "-a", "-s", "-screen 0 1280x800x24", "blender", "--factory-startup"]
    command = [*window, "--window-geometry", 0, 0, 1280, 800, "-P", _SCRIPT, "--", _SURFACES, side, frames]
    out, _, _ = run_apart(command, 600.0, int(memory))
    told = [line for line in out.splitlines() if line.startswith("{")]
    if not told:
        raise Skipped("Blender did not tell its times")
    return json.loads(told[-1])


def _rows(told: dict) -> list[list[str]]:
    seconds, polygons = told["seconds"], told["polygons"]
    plain = (seconds["plain"] + seconds["plain again"]) / 2  # before and after the modes
    rows = [["plain meshes", f"{polygons['plain']:,}", f"{1 / plain:.1f}", "1", "1", "1", "-", ""]]
    for mode, switch in told["switch"].items():
        shown = polygons[mode] or polygons["plain"]  # points and lines are those of the blocks
        ratio, alike = seconds[mode] / plain, told["alike"].get(mode)
        rows.append(
            [
                mode,
                f"{shown:,}",
                f"{1 / seconds[mode]:.1f}",
                f"**{ratio:.2f}**",
                f"{ratio * polygons['plain'] / shown:.2f}",
                "-" if alike is None else f"**{seconds[mode] / alike:.2f}**",
                f"{switch:.2f}",
                "",
            ]
        )
    return rows
