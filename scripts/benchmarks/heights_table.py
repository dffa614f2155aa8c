# SPDX-License-Identifier: GPL-3.0-or-later
"""The tables of interpolation: speed and accuracy beside the peers', pair by pair in one run."""

from __future__ import annotations

import os
import statistics
import time
from collections.abc import Callable

from .heights import METHODS, SETS, TIMED
from .process import Skipped, alone

SPEED = (
    "points",
    "ours",
    "compared with",
    "ours, nodes/s",
    "theirs, nodes/s",
    "ours / theirs",
    "required",
    "",
)
ACCURACY = (
    "method",
    *(f"RMSE {name}" for name in SETS),
    *(f"within two deviations, {name}" for name in SETS),
)
_OURS = (
    "kriging",
    "auto",
    "kriging, spherical, 16",
    "kriging, Matern 3/2, 16",
    "kriging, Matern 3/2, 32",
    "universal kriging, spherical, 16",
)
# Their errors are those of ours with the same variogram, and some take minutes to say so.
_SAME_SYSTEMS = ("PyKrige, spherical, 16", "gstat, spherical, 16", "gstat, universal, spherical, 16")
# What is compared, with how many nodes theirs is measured, and how many times as fast ours is to be. Speeds
# hardly depend on the number of nodes, but for what first makes a matrix of all points (PyKrige), their
# triangulation or a grid: there ours has as few. What is slow has as many as take it some seconds. Triangles
# and grids alone may be faster; the other table has their errors.
_PAIRS = (
    ("kriging, spherical, 16", "PyKrige, spherical, 16", 10_000, 3.0),
    ("kriging, spherical, 16", "gstat, spherical, 16", 100_000, 3.0),
    ("universal kriging, spherical, 16", "gstat, universal, spherical, 16", 50_000, 3.0),
    ("kriging, Matern 3/2, 32", "gstat, Matern 3/2, 32", 20_000, 3.0),
    ("kriging, spherical, 16", "SciPy, thin plate, 16", 100_000, 3.0),
    ("kriging, Matern 3/2, 32", "SciPy, thin plate, 32", 50_000, 3.0),
    ("kriging", "SciPy, thin plate, 32", 50_000, 3.0),
    ("auto", "SciPy, thin plate, 32", 50_000, 3.0),
    ("kriging", "SciPy, Clough-Tocher", 200_000, None),
    ("kriging", "GMT, surface", 1_000_000, None),
)
_AS_MANY = ("PyKrige, spherical, 16", "SciPy, Clough-Tocher", "GMT, surface")  # nodes of ours as of theirs
_SECONDS = {"speed": 90.0, "dsi": 90.0, "accuracy": 180.0}  # what takes longer is SKIPPED
_LONG = 8.0  # seconds of a peer: such pairs are not repeated
_PLAIN = 2.0  # times the ratio asked for: nor are those that leave no doubt
_ALL = 470.0  # seconds for everything: what is not begun by then is SKIPPED


def measure(
    quick: bool, memory: float, say: Callable[[str], None]
) -> tuple[list[list[str]], list[list[str]]]:
    """Rows for SPEED and ACCURACY; what could not be measured is left out with the reason."""
    python = os.environ.get("REALMODEL_HEIGHTS_PYTHON")
    nodes, pairs, splits = (200_000, 1, 2) if quick else (1_000_000, 3, 5)

    until = time.monotonic() + _ALL

    def told(function: str, *arguments) -> dict:
        left = until - time.monotonic()
        if left <= 0:
            raise Skipped(f"all the rest took {_ALL / 60:.0f} minutes")
        seconds = min(_SECONDS[function], max(left, _LONG))
        return alone(f"heights.{function}", *arguments, seconds=seconds, memory=memory, python=python)

    accuracy = []
    for method in METHODS:
        if method in _SAME_SYSTEMS:
            continue
        accuracy.append(_accuracy(told, method, splits))
        say("heights: " + " | ".join(accuracy[-1]))
    speed = []
    for name in TIMED:
        for ours, theirs, their_nodes, asked in _PAIRS:
            few = min(nodes, their_nodes)
            of_ours = few if theirs in _AS_MANY else nodes
            row = _pair(told, name, ours, theirs, (of_ours, few), pairs, asked)
            speed.append(row)
            say("heights: " + " | ".join(speed[-1]))
    speed.append(_dsi(told, nodes))
    say("heights: " + " | ".join(speed[-1]))
    return speed, accuracy


def _pair(told, name: str, ours: str, theirs: str, nodes, pairs: int, asked) -> list[str]:
    """Alternating order; the ratio is the median of the pairs', or the first where it leaves no doubt."""
    found: list[tuple[float, float]] = []
    wanted = "-" if asked is None else f"{asked:.0f}"
    try:
        for pair in range(pairs):
            order = [(ours, nodes[0]), (theirs, nodes[1])]
            rates, longest = {}, 0.0
            for method, count in order if pair % 2 == 0 else order[::-1]:
                run = told("speed", name, method, count, 2)
                rates[method] = run["nodes"] / run["seconds"]
                longest = max(longest, run["seconds"])
            found.append((rates[ours], rates[theirs]))
            no_doubt = asked is None or rates[ours] > _PLAIN * asked * rates[theirs]
            if longest > _LONG or no_doubt:
                break
    except Skipped as skipped:
        return [name, ours, theirs, "-", "-", "-", wanted, f"SKIPPED; {skipped}"]
    ratio = statistics.median(a / b for a, b in found)
    mine, other = (statistics.median(column) for column in zip(*found, strict=True))
    of = f"{nodes[0]:,} nodes each" if nodes[0] == nodes[1] else f"{nodes[0]:,} nodes, theirs {nodes[1]:,}"
    verdict = of if asked is None else f"{'met' if ratio >= asked else 'NOT met'}; {of}"
    return [name, ours, theirs, f"{mine:,.0f}", f"{other:,.0f}", f"**{ratio:.1f}**", wanted, verdict]


def _dsi(told, nodes: int) -> list[str]:
    try:
        run = told("dsi", nodes, 2)
    except Skipped as skipped:
        return ["drogon", "dsi", "-", "-", "-", "-", "5 s", f"SKIPPED; {skipped}"]
    verdict = "met" if run["seconds"] <= 5 else "NOT met"
    rate = f"{run['nodes'] / run['seconds']:,.0f}"
    return ["drogon", "dsi", "-", rate, "-", "-", "5 s", f"{run['seconds']:.1f} s; {verdict}"]


def _accuracy(told, method: str, splits: int) -> list[str]:
    errors, shares = [], []
    for name in SETS:
        try:
            run = told("accuracy", name, method, splits, 2)
        except Skipped as skipped:
            errors.append(f"SKIPPED; {skipped}")
            shares.append("-")
            continue
        errors.append(f"{statistics.fmean(run['rmse']):.3f}")
        within = run["within"]
        # Of a variogram that was not fitted the variance means nothing.
        fitted = within and method in ("kriging", "auto")
        shares.append(f"{100 * min(within):.1f} .. {100 * max(within):.1f} %" if fitted else "-")
    label = f"RealModel, {method}" if method in _OURS else method
    return [label, *errors, *shares]
