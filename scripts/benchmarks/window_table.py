# SPDX-License-Identifier: GPL-3.0-or-later
"""The tables of what a person waits for in Blender's window: live edits, and when the window stands still."""

from __future__ import annotations

import json
import shutil
import statistics
from collections.abc import Callable

from .process import ROOT, Skipped, run_apart

LIVE = ("10 surfaces x 7,200 triangles", "edit to new blocks, s", "required, s", "")
STILL = (
    "task",
    "polygons",
    "window frozen, s",
    "without drawing, s",
    "required, s",
    "meshes to Blender, s",
    "one drawing, s",
    "",
)
_LIVE_ASKED, _STILL_ASKED = 0.3, 0.15
_LIVE_SCRIPT, _SCRIPT = (
    ROOT / "scripts" / "benchmarks" / name for name in ("blender_live.py", "blender_window.py")
)
_PLANS = {"shared": "all on one plan mesh", "own": "each with its own triangulation"}
_QUADS, _QUICK_QUADS = 290, 90  # three blocks of 850,000 polygons; a tenth of that


def measure(
    quick: bool, memory: float, say: Callable[[str], None]
) -> tuple[list[list[str]], list[list[str]]]:
    """Rows for LIVE and for STILL."""
    background = ["blender", "-b", "--factory-startup", "--python-exit-code", "1", "-P", _LIVE_SCRIPT]
    try:
        seconds = _told([*background, "--", 3 if quick else 11], memory)["seconds"]
        live = [_live(plan, seconds[plan]) for plan in _PLANS]
    except Skipped as skipped:
        live = [["live edits", "-", "-", f"SKIPPED: {skipped}"]]
    window = ["xvfb-run", "-a", "-s", "-screen 0 1280x800x24", "blender", "--factory-startup"]
    quads = _QUICK_QUADS if quick else _QUADS
    try:
        found = _told([*window, "--window-geometry", 0, 0, 1280, 800, "-P", _SCRIPT, "--", quads], memory)
        still = [_still(what, *figures) for what, figures in found.items()]
    except Skipped as skipped:
        still = [["building", *["-"] * (len(STILL) - 2), f"SKIPPED: {skipped}"]]
    for row in (*live, *still):
        say("window: " + " | ".join(row))
    return live, still


def _told(command: list, memory: float) -> dict:
    if shutil.which(command[0]) is None or shutil.which("blender") is None:
        raise Skipped(f"{command[0]} or blender is not there")
    out, _, _ = run_apart(command, 600.0, int(memory))
    lines = [line for line in out.splitlines() if line.startswith("{")]
    if not lines:
        raise Skipped("Blender did not tell its times")
    return json.loads(lines[-1])


def _live(plan: str, seconds: list[float]) -> list[str]:
    median = statistics.median(seconds)
    return [
        _PLANS[plan],
        f"{median:.2f}",
        f"{_LIVE_ASKED:.2f}",
        "met" if median <= _LIVE_ASKED else "NOT met",
    ]


def _still(
    what: str, still: float, without: float, upload: float, drawing: float, polygons: int
) -> list[str]:
    verdict = "met" if without <= _STILL_ASKED else "NOT met"
    figures = (f"{still:.2f}", f"{without:.2f}", f"{_STILL_ASKED:.2f}", f"{upload:.2f}", f"{drawing:.2f}")
    return [what, f"{polygons:,}", *figures, verdict]
