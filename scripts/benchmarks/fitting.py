# SPDX-License-Identifier: GPL-3.0-or-later
"""Fits the constants behind estimate() and behind the progress: addon/realmodel/core/measured_costs.py.

    scripts/benchmark.sh --fit [--quick]

Every case is built once, in a process of its own, for both kinds of cells, and sampled once as estimate()
does, in another. Memory is fitted to what was counted, time to what the sample took, and the fraction that
the stack builder counts to the time that had passed.
"""

from __future__ import annotations

import itertools
import time
from collections.abc import Callable

import numpy as np

from .made_stacks import StackSpec
from .process import ROOT, Skipped, alone, peak_resident, resident

TARGET = ROOT / "addon" / "realmodel" / "core" / "measured_costs.py"
CELLS = ("columns", "blocks")
FEATURES = ("triangles", "vertices", "faces", "corners")
KINDS = ("own", "shared", "touching")  # of stacks, as estimate.stack_kind
CASES = [
    StackSpec(10, 100),
    StackSpec(10, 190),
    StackSpec(10, 300),
    StackSpec(40, 100),
    StackSpec(10, 100, "shared"),
    StackSpec(10, 300, "shared"),
    StackSpec(10, 700, "shared"),
    StackSpec(10, 150, "lattice", "steps"),
    StackSpec(10, 300, "lattice", "steps"),
    StackSpec(2, 400, "shared", "half"),
    StackSpec(10, 700),
]
_KNOTS = 25
_GROWTHS = np.linspace(0.8, 1.1, 31)  # powers of the size that time is taken to grow by
_QUICK = 1_000_000  # triangles in all
_LARGE = 1_000_000  # the same, of which a stack's pace is that of large ones
_BOUND = 1.5  # how far memory by triangles alone lies above the dearest case


def build_measured(spec: dict, cells: str, threads: int) -> dict:
    """One build: seconds, bytes taken, what came out, and what the native part counted when."""
    from realmodel.core import build
    from realmodel.core.expected_costs import expected_shares

    from .watching import counting_plainly, project

    given = project(StackSpec(**spec))
    shares = expected_shares(given, cells)
    before = resident()
    told = []
    began = time.perf_counter()
    with counting_plainly():
        model = build(
            given,
            cells,
            threads,
            progress=lambda share, _text: told.append([time.perf_counter() - began, share]),
            memory=1 << 62,
        )
    seconds = time.perf_counter() - began
    return {
        "seconds": seconds,
        "bytes": peak_resident() - before,
        "triangles": len(model.surface_triangles),
        "vertices": len(model.vertices),
        "faces": len(model.face_cells),
        "corners": len(model.face_vertices),
        "cells": len(model.cell_block),
        "told": [
            [at / seconds, (share - shares.read) / (shares.intersect - shares.read)] for at, share in told
        ],
    }


def sample_measured(spec: dict, cells: str, threads: int) -> dict:
    """One sample: seconds of its stacks, corners that they made and the whole will have, how much touches."""
    from realmodel.core.estimate import sampled
    from realmodel.core.rock_input import read_rocks
    from realmodel.core.work import Work

    from .watching import project

    work = Work()
    (entry,) = read_rocks(work, project(StackSpec(**spec)))
    began = time.perf_counter()
    sample = sampled(work, entry, cells, threads, scaled=False)
    return {
        "seconds": sample.seconds,
        "built": sample.built,
        "corners": sample.counts.corners,
        "touching": float(sample.touching),
        "whole": sample.built == round(sample.counts.corners),  # nothing scaled, nothing torn
        "took": time.perf_counter() - began,
    }


def least_squares(rows: np.ndarray, wanted: np.ndarray, most: int | None = None) -> np.ndarray:
    """Coefficients >= 0 that make rows @ coefficients / wanted closest to 1: the best of all subsets of at
    most so many."""
    best, error = np.zeros(rows.shape[1]), np.inf
    scaled = rows / wanted[:, None]
    for count in range(1, min(rows.shape[1], most or rows.shape[1]) + 1):
        for chosen in itertools.combinations(range(rows.shape[1]), count):
            found, *_ = np.linalg.lstsq(scaled[:, chosen], np.ones(len(rows)), rcond=None)
            if (found < 0).any():
                continue
            missed = float(np.square(scaled[:, chosen] @ found - 1.0).sum())
            if missed < error * (1 - 1e-9):
                best, error = np.zeros(rows.shape[1]), missed
                best[list(chosen)] = found
    return best


def pace(cases: list[dict]) -> list[dict]:
    """Knots [fraction counted, share of the time] of small stacks and of large ones, by rising `triangles`:
    of large ones less is cut for each triangle, and other steps take a larger share."""
    stacks = [StackSpec(**case["spec"]) for case in cases]
    sizes = [stack.triangles * stack.surfaces for stack in stacks]
    curves = []
    for is_large in (False, True):
        chosen = [k for k, size in enumerate(sizes) if (size > _LARGE) is is_large]
        if chosen:
            middle = float(np.exp(np.mean(np.log([sizes[k] for k in chosen]))))
            curves.append({"triangles": round(middle), "knots": knots([cases[k] for k in chosen])})
    return curves


def knots(cases: list[dict]) -> list[list[float]]:
    """[fraction counted, share of the time], the mean of some builds; both rise from 0 to 1."""
    fractions = np.linspace(0.0, 1.0, _KNOTS)
    shares = []
    for case in cases:
        at, counted = np.array(case["told"]).T
        # where counting stands still, the middle of the time is the least wrong
        first = np.interp(fractions, counted + 1e-9 * np.arange(len(counted)), at)
        last = np.interp(fractions, counted - 1e-9 * np.arange(len(counted))[::-1], at)
        shares.append((first + last) / 2)
    mean = np.maximum.accumulate(np.mean(shares, axis=0))
    mean[0], mean[-1] = 0.0, 1.0
    return [[round(float(a), 4), round(float(b), 4)] for a, b in zip(fractions, mean, strict=True)]


def scale(cases: list[dict]) -> dict[str, float]:
    """How much longer a whole build takes than its sample: `pace` times a power of the ratio of corners, such
    that no case is missed by more than it has to be. Below 1 the power stands for what each start costs, of
    which a sample of eight windows has more than the whole."""
    sampled = [case for case in cases if not case["sample"]["whole"]]
    if not sampled:
        return {"pace": 1.0, "growth": 1.0}
    work = np.log([case["sample"]["corners"] / case["sample"]["built"] for case in sampled])
    slower = np.log([case["seconds"] / case["sample"]["seconds"] for case in sampled])
    # two cases have no more than one power: that is not known then
    powers = _GROWTHS if len(sampled) > 2 else np.ones(1)
    left = slower - powers[:, None] * work
    # the power that leaves least between the cases; of equal ones that nearest to 1
    best = min(zip(np.ptp(left, axis=1).round(6), np.abs(powers - 1), range(len(powers)), strict=True))[2]
    middle = (left[best].min() + left[best].max()) / 2
    return {"pace": float(f"{np.exp(middle):.4g}"), "growth": float(f"{powers[best]:.4g}")}


def sizes(cases: list[dict]) -> dict[str, float]:
    """Bytes for each triangle, vertex, face and corner: no more of these than half the cases tell, and such
    that no case is missed by more than it has to be."""
    rows = np.array([[case[name] for name in FEATURES] for case in cases], float)
    taken = np.array([case["bytes"] for case in cases], float)
    found = least_squares(rows, taken, max(1, len(cases) // 2))
    told = rows @ found / taken
    found /= np.sqrt(told.min() * told.max())
    return dict(zip(FEATURES, found.round(1).tolist(), strict=True))


def kind_of(case: dict) -> str:
    """Which kind of stack a case is, as estimate() tells them apart."""
    from realmodel.core.estimate import stack_kind

    return stack_kind(case["spec"]["plan"] != "own", case["sample"]["touching"])


def constants(cells: str, cases: list[dict]) -> dict:
    """The part of COSTS of one kind of cells, from measured cases."""
    own = [case for case in cases if case["spec"]["plan"] == "own"]
    shared = [case for case in cases if case["spec"]["plan"] != "own"]
    # a kind that none of few cases is of is taken to cost what all of them do
    by_kind = {kind: [case for case in cases if kind_of(case) == kind] or cases for kind in KINDS}
    dearest = max(case["bytes"] / case["triangles"] for case in cases)
    return {
        **{f"bytes_{kind}": sizes(of_kind) for kind, of_kind in by_kind.items()},
        "most_bytes_per_triangle": round(_BOUND * dearest),
        "seconds_per_triangle": float(f"{np.median([c['seconds'] / c['triangles'] for c in cases]):.3g}"),
        **{f"scale_{kind}": scale(of_kind) for kind, of_kind in by_kind.items()},
        "pace_own": pace(own),
        "pace_shared": pace(shared),
    }


def steps_before() -> dict:
    """Seconds for a byte read, a triangle meshed, a node interpolated, a variogram of one point."""
    import tempfile
    from pathlib import Path

    from realmodel.core import interpolate, mesh_region
    from realmodel.core.readers import read_off

    vertices, triangles = StackSpec(1, 200).make()[0]
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "surface.off"
        lines = [f"OFF\n{len(vertices)} {len(triangles)} 0"]
        lines += [" ".join(map(repr, vertex)) for vertex in vertices.tolist()]
        lines += [f"3 {a} {b} {c}" for a, b, c in triangles.tolist()]
        path.write_text("\n".join(lines) + "\n", encoding="ascii")
        began = time.perf_counter()
        read_off(path)
        read = (time.perf_counter() - began) / path.stat().st_size
    began = time.perf_counter()
    nodes, made = mesh_region([[0, 0], [1, 0], [1, 1], [0, 1]], edge_length=0.004)
    mesh = (time.perf_counter() - began) / len(made)
    began = time.perf_counter()
    interpolate(vertices[::20], nodes, variogram={"model": "spherical", "range": 0.5, "sill": 1.0})
    nodes_second = (time.perf_counter() - began) / len(made)
    began = time.perf_counter()
    interpolate(vertices[::20], nodes[:16])
    point = (time.perf_counter() - began) / len(vertices[::20]) ** 0.5
    return {"read": read, "mesh": mesh, "interpolate": nodes_second, "variogram": point}


HEADINGS = ("work", "cells are", "cells", "told", "bytes taken, MB", "told", "s", "told", "estimate took, s")


def fit_and_check(
    quick: bool, memory: float, say: Callable[[str], None], threads: int = 2, *, write: bool
) -> list[list[str]]:
    """Measures all cases that the memory allows and fits the constants, which are written if asked.

    Returns rows for HEADINGS: what was measured, and what estimate() tells of it with the constants as they
    are then.
    """
    before = alone("fitting.steps_before")
    costs = {name: float(f"{before[name]:.3g}") for name in ("read", "mesh", "interpolate", "variogram")}
    measured = []
    for cells in CELLS:
        cases = []
        for spec in CASES:
            if quick and spec.triangles * spec.surfaces > _QUICK:
                continue
            try:
                case = alone("fitting.build_measured", vars(spec), cells, threads, memory=memory)
                case["sample"] = alone("fitting.sample_measured", vars(spec), cells, threads)
            except Skipped as skipped:
                say(f"fit: {spec} {cells}: left out, {skipped}")
                continue
            case["spec"], case["kind"] = vars(spec), cells
            say(f"fit: {spec} {cells}: {case['seconds']:.2f} s, {case['bytes'] / 1e6:.0f} MB")
            cases.append(case)
        costs[cells] = constants(cells, cases)
        measured += cases
    if write:
        head = TARGET.read_text(encoding="utf-8").partition("COSTS = ")[0]
        TARGET.write_text(f"{head}COSTS = {literal(costs)}\n", encoding="utf-8")
    rows = []
    for case in measured:
        told = alone("fitting.told", case["spec"], case["kind"], threads)
        rows.append(_row(case, told))
        say("estimate: " + " | ".join(rows[-1]))
    return rows


def told(spec: dict, cells: str, threads: int) -> dict:
    """What estimate() tells of a case."""
    from realmodel.core import estimate

    from .watching import project

    given = project(StackSpec(**spec))
    began = time.perf_counter()
    found = estimate(given, cells, threads)
    return {
        "cells": found.cells,
        "memory": found.memory,
        "seconds": found.seconds,
        "took": time.perf_counter() - began,
    }


def _row(case: dict, found: dict) -> list[str]:
    spec = StackSpec(**case["spec"])
    return [
        f"{spec.surfaces} x {spec.triangles:,}, {spec.plan}, {spec.heights}",
        case["kind"],
        f"{case['cells']:,}",
        f"x {found['cells'] / case['cells']:.2f}",
        f"{case['bytes'] / 1e6:,.0f}",
        f"x {found['memory'] / case['bytes']:.2f}",
        f"{case['seconds']:.2f}",
        f"x {found['seconds'] / case['seconds']:.2f}",
        f"{found['took']:.2f}",
    ]


def literal(value, indent: str = "") -> str:
    """Nested dictionaries and lists of pairs as Python, in the form that ruff leaves as it is."""
    inner = indent + "    "
    if isinstance(value, dict):
        lines = [f'{inner}"{name}": {literal(entry, inner)},' for name, entry in value.items()]
        return "\n".join(["{", *lines, indent + "}"])
    if isinstance(value, list) and value and isinstance(value[0], dict):
        return "\n".join(["[", *(f"{inner}{literal(entry, inner)}," for entry in value), indent + "]"])
    if isinstance(value, list) and value and isinstance(value[0], list):
        return "\n".join(["[", *(f"{inner}{pair}," for pair in value), indent + "]"])
    return repr(value)
