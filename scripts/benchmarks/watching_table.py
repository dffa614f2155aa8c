# SPDX-License-Identifier: GPL-3.0-or-later
"""The tables of progress and cancelling."""

from __future__ import annotations

from collections.abc import Callable

from .made_stacks import StackSpec
from .process import Skipped, alone
from .stacks_table import Limits

PROGRESS = (
    "work",
    "cells are",
    "s",
    "estimate, s",
    "memory, MB",
    "estimate at most, MB",
    "reported at half of the time",
    "largest deviation",
    "of processor time",
    "longest gap, s",
    "calls",
)
CANCELS = (
    "work",
    "cells are",
    "cancels",
    "slowest response, s",
    "median, s",
    "all memory freed after, s",
    "still held, MB",
)
_CASES = (
    ("10 x 20,000", StackSpec(10, 100)),
    ("10 x 180,000", StackSpec(10, 300)),
    ("10 x 180,000 on one plan mesh", StackSpec(10, 300, "shared")),
    ("lattice 10 x 45,000", StackSpec(10, 150, "lattice", "steps")),
    ("2 x 320,000", StackSpec(2, 400, "shared", "half")),
    ("10 x 980,000 on one plan mesh", StackSpec(10, 700, "shared")),
    ("10 x 980,000", StackSpec(10, 700)),
)
_MOMENTS = 8
_SECONDS = 1800.0


def measure(limits: Limits, say: Callable[[str], None]) -> tuple[list[list[str]], list[list[str]]]:
    """Rows for PROGRESS and CANCELS; what this run may not take is left out with the reason."""
    progress, cancels = [], []
    for work, spec in _CASES:
        for cells in ("columns", "blocks"):
            try:
                limits.allow(spec)
                told = alone(
                    "watching.progress",
                    vars(spec),
                    cells,
                    limits.threads,
                    seconds=_SECONDS,
                    memory=limits.memory,
                )
                progress.append(_progress_row(work, cells, told))
                say("progress: " + " | ".join(progress[-1]))
                found = alone(
                    "watching.cancelling",
                    vars(spec),
                    cells,
                    limits.threads,
                    _MOMENTS,
                    told["seconds"],
                    seconds=_SECONDS,
                    memory=limits.memory,
                )
                cancels.append(_cancel_row(work, cells, found))
                say("cancel: " + " | ".join(cancels[-1]))
            except Skipped as skipped:
                say(f"progress: {work}, {cells}: SKIPPED, {skipped}")
    return progress, cancels


def _progress_row(work: str, cells: str, told: dict) -> list[str]:
    return [
        work,
        cells,
        f"{told['seconds']:.2f}",
        f"{told['expected']:.2f}",
        f"{told['bytes'] / 1e6:,.0f}",
        f"{told['bound'] / 1e6:,.0f}",
        f"{100 * told['halfway']:.0f} %",
        f"{100 * told['deviation']:.0f} %",
        f"{100 * told['worked']:.0f} %",
        f"{told['gap']:.3f}",
        f"{told['calls']}",
    ]


def _cancel_row(work: str, cells: str, found: dict) -> list[str]:
    latency = sorted(found["latency"])
    return [
        work,
        cells,
        f"{len(latency)}",
        f"{latency[-1]:.3f}" if latency else "-",
        f"{latency[len(latency) // 2]:.3f}" if latency else "-",
        f"{max(found['gone'], default=0.0):.2f}",
        f"{max(found['kept']) / 1e6:.0f}",
    ]
