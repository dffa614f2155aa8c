# SPDX-License-Identifier: GPL-3.0-or-later
"""The table of Booleans beside the peers', in one run."""

from __future__ import annotations

import os
from collections.abc import Callable

from .process import Skipped, alone

BOOLEANS = (
    "work",
    "compared with",
    "ours, s",
    "theirs, s",
    "ours / theirs",
    "of processors",
    "required",
    "our triangles",
    "theirs",
    "our memory, MB",
    "their memory, MB",
    "",
)
_ASKED = 3.0


def measure(quick: bool, memory: float, say: Callable[[str], None]) -> list[list[str]]:
    """Rows for BOOLEANS, the best of three runs each; what could not be measured is SKIPPED, and why."""
    python = os.environ.get("REALMODEL_BOOLEANS_PYTHON")
    rounds = 1 if quick else 3

    def best(function: str, *arguments, interpreter: str | None = None) -> dict:
        runs = [
            alone(f"booleans.{function}", *arguments, memory=memory, python=interpreter)
            for _ in range(rounds)
        ]
        return min(runs, key=lambda run: run["seconds"])

    rows = []
    for rings in (100,) if quick else (160, 500):
        name = f"union of two spheres, {4 * rings * (rings - 1):,} triangles each"
        rows.append(
            _row(name, "Manifold", _ASKED, best, ("ours_spheres", "manifold_spheres"), (rings,), None)
        )
        say(" | ".join(rows[-1]))
    name = "39 faults of California, all with all"
    for peer, interpreter, asked in (("geogram", None, 1.0), ("trueform", python, None)):
        rows.append(_row(name, peer, asked, best, ("ours_faults", f"{peer}_faults"), (), interpreter))
        say(" | ".join(rows[-1]))
    return rows


def _row(name, peer, asked, best, functions, arguments, python) -> list[str]:
    blank = ["-"] * 8
    try:
        ours = best(functions[0], *arguments)
    except Skipped as why:
        return [name, peer, *blank, "-", f"SKIPPED: {why}"]
    try:
        theirs = best(functions[1], *arguments, interpreter=python)
    except Skipped as why:
        cells = [f"{ours['seconds']:.2f}", *["-"] * 4, f"{ours['triangles']:,}", "-"]
        return [name, peer, *cells, f"{ours['peak'] / 1e6:,.0f}", "-", f"SKIPPED: {why}"]
    ratio = ours["seconds"] / theirs["seconds"]
    verdict = "" if asked is None else "met" if ratio <= asked else "NOT met"
    return [
        name,
        peer,
        f"{ours['seconds']:.2f}",
        f"{theirs['seconds']:.2f}",
        f"**{ratio:.2f}**",
        f"{ours['processor'] / theirs['processor']:.2f}",
        "-" if asked is None else f"{asked:.0f}",
        f"{ours['triangles']:,}",
        f"{theirs['triangles']:,}",
        f"{ours['peak'] / 1e6:,.0f}",
        f"{theirs['peak'] / 1e6:,.0f}",
        verdict,
    ]
