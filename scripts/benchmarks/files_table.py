# SPDX-License-Identifier: GPL-3.0-or-later
"""The table of files beside the same bytes written at once."""

from __future__ import annotations

from collections.abc import Callable

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
    "asked",
    "",
)
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


def _row(ending: str, cells: int, found: dict) -> list[str]:
    row = [f"`{ending}`", f"{cells:,}", f"{found['bytes'] / 1e6:.0f}", f"{found['processor']:.2f}"]
    verdicts = []
    for name, where in (("cached", "cache"), ("synced", "disk")):
        ours, theirs = found[name]
        row += [f"{ours:.2f}", f"{theirs:.2f}", f"**{ours / theirs:.1f}**"]
        verdicts.append(f"{where}: {'met' if ours <= _ASKED * theirs else 'NOT met'}")
    return [*row, f"{_ASKED}", "; ".join(verdicts)]
