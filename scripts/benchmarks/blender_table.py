# SPDX-License-Identifier: GPL-3.0-or-later
"""The table of what Blender itself takes: meshes brought in, in each Blender that is here."""

from __future__ import annotations

import json
import os
import statistics
from collections.abc import Callable
from pathlib import Path

from .process import ROOT, Skipped, run_apart

UPLOADS = (
    "Blender",
    "polygons",
    "ours, s",
    "required, s",
    "foreach_set, s",
    "ours / foreach_set",
    "from_pydata, s",
    "ours / from_pydata",
    "",
)
ASKED = 0.5  # seconds for a million polygons
_SCRIPT = ROOT / "scripts" / "benchmarks" / "blender_upload.py"
_MODULE = ROOT / "build" / "venv-bpy" / "bin" / "python"  # scripts/test.sh makes it


def measure(quick: bool, memory: float, say: Callable[[str], None]) -> list[list[str]]:
    """Rows for UPLOADS."""
    rows = []
    for name, command in blenders(_SCRIPT):
        try:
            rows.append(_row(_upload([*command, "--", 1000, 3 if quick else 9], memory)))
        except Skipped as skipped:
            rows.append([name, *["-"] * (len(UPLOADS) - 2), f"SKIPPED: {skipped}"])
        say("upload: " + " | ".join(rows[-1]))
    return rows


def blenders(script: Path) -> list[tuple[str, list]]:
    """(name, command) of each Blender that is here, to run a script."""
    background = ["blender", "-b", "--factory-startup", "--python-exit-code", "1", "-P", script]
    return [("installed", background), ("module bpy", [_MODULE, script])]


def _upload(command: list, memory: float) -> dict:
    try:
        out, _, _ = run_apart(command, 300.0, int(memory))
    except FileNotFoundError as error:
        raise Skipped(f"{os.path.relpath(error.filename, ROOT)} is not there") from error
    told = [line for line in out.splitlines() if line.startswith("{")]
    if not told:
        raise Skipped("Blender did not tell its times")
    return json.loads(told[-1])


def _row(told: dict) -> list[str]:
    """Medians; the ratios are those of ways that ran in the same round."""
    seconds = told["seconds"]
    ours = statistics.median(seconds["ours"])

    def ratio(other: str) -> str:
        pairs = zip(seconds["ours"], seconds[other], strict=True)
        return f"**{statistics.median(a / b for a, b in pairs):.2f}**"

    asked = ASKED * told["polygons"] / 1e6
    return [
        told["blender"],
        f"{told['polygons']:,}",
        f"{ours:.2f}",
        f"{asked:.2f}",
        f"{statistics.median(seconds['bare_arrays']):.2f}",
        ratio("bare_arrays"),
        f"{statistics.median(seconds['from_pydata']):.2f}",
        ratio("from_pydata"),
        "met" if ours <= asked else "NOT met",
    ]
