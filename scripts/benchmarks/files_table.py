# SPDX-License-Identifier: GPL-3.0-or-later
"""The tables of files beside the same bytes written at once, and of models loaded beside built ones."""

from __future__ import annotations

import tempfile
from collections.abc import Callable

from . import files
from .process import Skipped, alone

FILES = (
    "file",
    "cells",
    "MB",
    "processors, s",
    "to the cache, s",
    "the same bytes, s",
    "times",
    "to the disk, s",
    "the same bytes, s",
    "times",
    "required",
    "",
)
LOADED = (
    *("model", "cells", "MB", "build, s", "save, s", "load, s", "load / build", "goal"),
    *("memory / file", "goal", ""),
)
_LOADED, _TAKEN = 1 / 3, 2.0
_ENDINGS = (".vtu", ".foam")
_ASKED = 1.5  # times the disk's own time
_ROUNDS = 7


def measure(quick: bool, memory: float, say: Callable[[str], None]) -> list[list[str]]:
    """Rows for FILES; what could not be measured is SKIPPED, and why."""
    spec = {"surfaces": 10, "quads": 60 if quick else 274, "plan": "shared"}
    try:
        found = alone("files.write_in_turns", spec, _ENDINGS, 1 if quick else _ROUNDS, 0, memory=memory)
    except Skipped as why:
        rows = [[ending, *["-"] * 10, f"SKIPPED: {why}"] for ending in _ENDINGS]
    else:
        rows = [_row(ending, found["cells"], found[ending]) for ending in _ENDINGS]
    for row in rows:
        say(" | ".join(row))
    return rows


def measure_loading(quick: bool, memory: float, say: Callable[[str], None]) -> list[list[str]]:
    """Rows for LOADED."""
    spec = {"surfaces": 10, "quads": 30 if quick else 300}
    model = f"10 x {2 * spec['quads'] ** 2:,}"
    with tempfile.TemporaryDirectory(dir=files.on_disk()) as folder:
        path = f"{folder}/m.npz"
        try:
            built = alone("files.build_and_save", spec, path, 0, memory=memory)
            row = _loaded_row(model, built, alone("files.load", path, memory=memory))
        except Skipped as why:
            row = [model, *["-"] * 9, f"SKIPPED: {why}"]
    say(" | ".join(row))
    return [row]


def _loaded_row(model: str, built: dict, loaded: dict) -> list[str]:
    share, taken = loaded["loaded"] / built["built"], loaded["taken"] / built["bytes"]
    row = [model, f"{built['cells']:,}", f"{built['bytes'] / 1e6:.0f}"]
    row += [f"{seconds:.2f}" for seconds in (built["built"], built["saved"], loaded["loaded"])]
    is_met = share <= _LOADED and taken <= _TAKEN
    row += [f"**{share:.2f}**", "1/3", f"**{taken:.2f}**", f"{_TAKEN:.0f}"]
    return [*row, "met" if is_met else "NOT met"]


def _row(ending: str, cells: int, found: dict) -> list[str]:
    row = [f"`{ending}`", f"{cells:,}", f"{found['bytes'] / 1e6:.0f}", f"{found['processor']:.2f}"]
    verdicts = []
    for name, where in (("cached", "cache"), ("synced", "disk")):
        ours, theirs = found[name]
        row += [f"{ours:.2f}", f"{theirs:.2f}", f"**{ours / theirs:.1f}**"]
        verdicts.append(f"{where}: {'met' if ours <= _ASKED * theirs else 'NOT met'}")
    return [*row, f"{_ASKED}", "; ".join(verdicts)]
