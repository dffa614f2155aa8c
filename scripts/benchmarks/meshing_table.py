# SPDX-License-Identifier: GPL-3.0-or-later
"""The tables of planar meshes and of polygons cut into triangles, beside the peers', in one run."""

from __future__ import annotations

import math
import os
import statistics
import time
from collections.abc import Callable
from dataclasses import dataclass

from .hard_outlines import CASES
from .meshing import edge_for, graded_largest
from .process import Skipped, alone

MESHES = (
    "region",
    "mesher",
    "triangles",
    "seconds",
    "microseconds each",
    "of Triangle's",
    "required",
    "mean edge / requested",
    "least angle",
    "mean ratio",
    "six neighbors",
    "memory, MB",
    "",
)
OUTLINES = (
    "outline",
    "edge length",
    "mesher",
    "triangles",
    "seconds",
    "least angle",
    "mean ratio",
    "required",
    "six neighbors",
    "",
)
POLYGONS = ("polygon", "corners", "ours, s", "earcut, s", "ours / earcut", "required", "")
# How long a triangle may take of Triangle's time for one, the mean ratio at least, and bytes at most.
_ASKED = {"delaunay": (1.0, None), "frontal": (3.0, 0.99), "grid": (None, None)}
_MOST_MEMORY = 2e9
_KINDS = {
    "coast": "smooth coast",
    "star": "star of 50,000 rays",
    "bristles": "rays of random length",
    "holes": "1,024 round holes",
}
_LEAST_RATIO = 0.95  # of frontal where an outline has much detail


@dataclass(frozen=True)
class _Patience:
    """Seconds for one mesh, for one of a hard outline, and for everything: what is not done by then is
    SKIPPED."""

    mesh: float
    outline: float
    all: float


_PATIENCE = _Patience(240.0, 60.0, 590.0)
_QUICK = _Patience(30.0, 15.0, 150.0)


@dataclass(frozen=True)
class _Case:
    name: str
    edge: float
    graded: bool
    with_gmsh: bool


def measure(
    quick: bool, memory: float, say: Callable[[str], None]
) -> tuple[list[list[str]], list[list[str]], list[list[str]]]:
    """Rows for MESHES, OUTLINES and POLYGONS; what could not be measured is SKIPPED, and why."""
    python = os.environ.get("REALMODEL_MESHING_PYTHON")
    rounds = 1 if quick else 3
    patience = _QUICK if quick else _PATIENCE
    end = time.monotonic() + patience.all

    def told(function: str, *arguments, most: float = patience.mesh) -> dict:
        left = end - time.monotonic()
        if left < 1:
            raise Skipped(f"the {patience.all:.0f} s that all this may take are over")
        return alone(function, *arguments, seconds=min(most, left), memory=memory, python=python)

    def say_all(rows: list[list[str]]) -> list[list[str]]:
        for row in rows:
            say("meshing: " + " | ".join(row))
        return rows

    polygons = [row for kind in _KINDS for row in say_all([_polygons(told, kind, rounds)])]
    cases = _cases(quick)
    last = [] if quick else [cases.pop()]  # of 4 M: Gmsh takes minutes for it
    meshes = [row for case in cases for row in say_all(_meshes(told, case, rounds))]
    outlines = _outlines(told, patience.outline, say_all)
    meshes += [row for case in last for row in say_all(_meshes(told, case, rounds))]
    return meshes, outlines, polygons


def _cases(quick: bool) -> list[_Case]:
    counts = (100_000,) if quick else (1_000_000, 4_000_000)
    even = [_Case(f"one length, {count / 1e6:g} M", edge_for(count), False, True) for count in counts]
    least = counts[0]
    graded = _Case(f"graded 1 : 24, {least / 1e6:g} M", graded_largest(least), True, True)
    return [even[0], graded, *even[1:]]


def _meshes(told, case: _Case, rounds: int) -> list[list[str]]:
    """Rounds of all meshers one after another; ratios are medians over rounds. Gmsh runs once: it is slow."""
    meshers = ("Triangle", *_ASKED)
    runs: dict[str, list[dict]] = {mesher: [] for mesher in (*meshers, "Gmsh")}
    reasons: dict[str, str] = {}
    for number in range(rounds):
        order = meshers if number % 2 == 0 else meshers[::-1]
        for mesher in (*order, *(["Gmsh"] if number == 0 and case.with_gmsh else [])):
            if mesher in reasons or (mesher == "grid" and case.graded):
                continue
            try:
                runs[mesher].append(told("meshing.mesh", mesher, case.edge, case.graded))
            except Skipped as skipped:
                reasons[mesher] = str(skipped)
    theirs = runs["Triangle"] if "Triangle" not in reasons else []
    rows = []
    for mesher, made in runs.items():
        if mesher in reasons:
            rows.append([case.name, mesher, *["-"] * (len(MESHES) - 3), f"SKIPPED; {reasons[mesher]}"])
        elif made:
            rows.append(_mesh_row(case.name, mesher, made, theirs))
    return rows


def _each(run: dict) -> float:
    return run["seconds"] / run["triangles"]


def _mesh_row(case: str, mesher: str, made: list[dict], theirs: list[dict]) -> list[str]:
    last = made[-1]
    ratio = None
    if theirs and mesher != "Triangle":
        ratio = statistics.median(
            _each(run) / _each(beside) for run, beside in zip(made, theirs, strict=False)
        )
    asked, least_ratio = _ASKED.get(mesher, (None, None))
    seconds = statistics.median(run["seconds"] for run in made)
    peak = max(run["resident"] for run in made)
    faults = []
    if mesher in _ASKED:
        if None not in (asked, ratio) and ratio > asked:
            faults.append("too slow")
        if least_ratio is not None and last["mean_ratio"] < least_ratio:
            faults.append("mean ratio too low")
        if peak > _MOST_MEMORY:
            faults.append("too much memory")
    verdict = f"NOT met: {', '.join(faults)}" if faults else "met" if asked is not None else ""
    return [
        case,
        mesher if mesher not in _ASKED else f"RealModel, `{mesher}`",
        f"{last['triangles']:,}",
        f"{seconds:.2f}",
        f"{1e6 * statistics.median(map(_each, made)):.2f}",
        "-" if ratio is None else f"**{ratio:.2f}**",
        "-" if asked is None else f"{asked:.0f}",
        f"{last['mean_edge']:.3f}",
        f"{last['least_angle']:.1f}",
        f"{last['mean_ratio']:.4f}",
        f"{100 * last['six']:.1f} %",
        f"{peak / 1e6:,.0f}",
        verdict,
    ]


def _outlines(told, seconds: float, say_all) -> list[list[str]]:
    """All meshers' rows by outline and length; Gmsh is run once ours are done: it is slow."""
    meshers = ("delaunay", "frontal", "Gmsh")
    cases = [(kind, edge) for kind, (_, lengths) in CASES.items() for edge in lengths]
    rows = {}
    for some in (meshers[:2], meshers[2:]):
        for kind, edge in cases:
            for mesher in some:
                rows[kind, edge, mesher] = _outline_row(told, kind, edge, mesher, seconds)
                say_all([rows[kind, edge, mesher]])
    return [rows[kind, edge, mesher] for kind, edge in cases for mesher in meshers]


def _outline_row(told, kind: str, edge: float, mesher: str, seconds: float) -> list[str]:
    called = mesher if mesher == "Gmsh" else f"RealModel, `{mesher}`"
    begin = [CASES[kind][0], f"{edge:g}", called]
    try:
        made = told("hard_outlines.mesh", mesher, kind, edge, most=seconds)
    except Skipped as skipped:
        return [*begin, *["-"] * (len(OUTLINES) - 4), f"SKIPPED; {skipped}"]
    return [*begin, *_outline_cells(mesher, made)]


def _outline_cells(mesher: str, made: dict) -> list[str]:
    asked = _LEAST_RATIO if mesher == "frontal" else None
    return [
        f"{made['triangles']:,}",
        f"{made['seconds']:.2f}",
        f"{made['least_angle']:.1f}",
        f"{made['mean_ratio']:.4f}",
        "-" if asked is None else f"{asked}",
        "-" if math.isnan(made["six"]) else f"{100 * made['six']:.1f} %",  # none inside
        "" if asked is None else "met" if made["mean_ratio"] >= asked else "NOT met",
    ]


def _polygons(told, kind: str, rounds: int) -> list[str]:
    name = _KINDS[kind]
    found: list[tuple[dict, dict]] = []
    try:
        for number in range(rounds):
            who = ("RealModel", "earcut") if number % 2 == 0 else ("earcut", "RealModel")
            runs = {one: told("meshing.ears", one, kind) for one in who}
            found.append((runs["RealModel"], runs["earcut"]))
    except Skipped as skipped:
        return [name, "-", "-", "-", "-", "1", f"SKIPPED; {skipped}"]
    ratio = statistics.median(ours["seconds"] / theirs["seconds"] for ours, theirs in found)
    mine, other = (statistics.median(run["seconds"] for run in runs) for runs in zip(*found, strict=True))
    corners = found[0][0]["corners"]
    verdict = "met" if ratio <= 1 else "NOT met"
    return [name, f"{corners:,}", f"{mine:.3f}", f"{other:.3f}", f"**{ratio:.2f}**", "1", verdict]
