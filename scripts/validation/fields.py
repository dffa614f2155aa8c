# SPDX-License-Identifier: GPL-3.0-or-later
"""Series of beds of known truth by all programs: random histories, folds of Noddy, Moureze, Claudius."""

from __future__ import annotations

import time
from collections.abc import Iterator

import compare_fields
import histories
import numpy as np
import test_fields
from realmodel.core import build, load_project
from realmodel.core.base.algebra import norm
from realmodel.core.fields import LevelSetData
from stacks import places

from .programs import PROGRAMS, Beds, Refused, Solved, gempy_model, gempy_values

SEEDS = 20  # of each kind of history
KINDS = ("near_flat", "rough", "folded")
DRAWS = 20  # of Moureze
NODDY_POINTS = 5000  # of each truth
NODDY = ("n_upright", "n_unconformity", "n_fault")
FOLDS = places.REAL_DATA / "folds"
SHARE = 0.1  # of the points of Claudius that are given
CLAUDIUS_VALUES = np.array([0.0, 60.0, 250.0, 330.0])  # as LoopStructural's tutorial has them
EVERY = 10  # of the points of Claudius that were not given is asked
STEP = 5.0  # meters, of differences of a field


def judged(work, refusals: list[str]) -> tuple[float | None, float]:
    """What some work returns, None where it is refused, and the seconds of processors that it takes."""
    began = time.process_time()
    try:
        share = work()
    except Refused as refusal:
        refusals.append(str(refusal)[:200])
        share = None
    return share, time.process_time() - began


def _rows(cases: Iterator, programs: dict) -> dict:
    """{program: its shares of each case, seconds of processors a case, refusals}."""
    rows = {name: {"shares": [], "seconds": 0.0, "refusals": []} for name in programs}
    for case in cases:
        for name, program in programs.items():
            share, seconds = judged(lambda run=program, data=case: run(data), rows[name]["refusals"])
            rows[name]["shares"].append(None if share is None else round(share, 4))
            rows[name]["seconds"] += seconds
        print(*(f"{name} {row['shares'][-1]}" for name, row in rows.items()), sep=", ", flush=True)
    for row in rows.values():
        row["seconds"] = round(row["seconds"] / len(row["shares"]), 2)
    return rows


def _of_history(program):
    def share(history):
        return history._share(program(_beds(history)).blocks(history._places()))

    return share


def _beds(history: histories.History) -> Beds:
    return Beds(history.data, np.zeros(3), history.size, history.levels)


def random_histories(kind: str) -> dict:
    """The share of 5,000 random points in the right block."""
    cases = (getattr(histories, kind)(seed) for seed in range(SEEDS))
    programs = {name: _of_history(program) for name, program in PROGRAMS.items()}
    programs["planes"] = lambda history: history.share_of_planes()
    rows = _rows((case for case in cases if case is not None), programs)
    return {"seeds": SEEDS, "histories": len(rows["planes"]["shares"]), "programs": rows}


def _thicknesses(data: LevelSetData) -> np.ndarray:
    """(S,) values for programs that ask for them, as the data show them: from one surface to the next, the
    median of vertical distances in holes, each by the cosine of the nearest dip."""
    values = [0.0]
    for surface in range(1, len(data.names)):
        above, below = (data.contacts[data.contact_surfaces == k] for k in (surface, surface - 1))
        apart = np.linalg.norm(above[:, None, :2] - below[None, :, :2], axis=2) < 1e-3
        nearest = norm(above[:, None] - data.dips).argmin(axis=1)
        rise = (above[:, None, 2] - below[None, :, 2]) * np.abs(data.normals[nearest, 2])[:, None]
        values.append(values[-1] + float(np.median(rise[apart & (rise > 0)])))
    return np.array(values)


def _noddy_beds(name: str) -> Beds:
    data, _, _ = test_fields.noddy(name)
    with np.load(FOLDS / name / "truth.npz") as truth:
        top = float(truth["ground_top"])
    return Beds(data, np.zeros(3), np.array([8000.0, 8000.0, top + 50.0]), _thicknesses(data))


def _noddy_truth(name: str) -> tuple[np.ndarray, np.ndarray]:
    """Points of the truth in the folded series, and the number of the block at each."""
    _, points, block = test_fields.noddy(name)
    return points[:NODDY_POINTS], block[:NODDY_POINTS]


def _noddy_realmodel(name: str) -> float:
    """The whole model, with its unconformity or fault."""
    model = build(load_project(FOLDS / name / "project.toml"))
    points, block = _noddy_truth(name)
    names = np.array([*(block.name.split(" / ")[0] for block in model.blocks), ""])
    expected = np.array([f"A unit {number}" for number in block])
    return float((names[model.block_at(points)] == expected).mean())


def _of_one_surface(points, normals, beds: Beds) -> Beds:
    """A surface as a series of its own: points (P, 3), and dips at some of them."""
    data = LevelSetData("F", points, np.zeros(len(points), np.int32), points[: len(normals)], normals)
    return Beds(data, beds.low, beds.high, np.zeros(1))


def _noddy_gempy(name: str) -> float:
    beds = _noddy_beds(name)
    points, block = _noddy_truth(name)
    groups, faults, units = [("A", beds)], [], [*range(5, -1, -1)]
    if name == "n_fault":
        vertices, normal = _fault(name)
        groups, faults = [("fault", _of_one_surface(vertices, normal, beds)), *groups], ["fault"]
        units = [-1, *units]
    _, numbers = gempy_values(gempy_model(groups, faults), points)
    return float((np.array(units)[numbers - 1] == block).mean())


def _fault(name: str):
    from realmodel.core.readers import read_mesh

    mesh = read_mesh(FOLDS / name / "fault.off")
    a, b, c = mesh.vertices[mesh.triangles[0]]
    normal = np.cross(b - a, c - a)
    normal *= np.sign(normal[2]) / norm(normal)
    return mesh.vertices, normal[None]


def _noddy_other(program_name: str):
    """Of programs that model one series: where it has no fault."""

    def share(name):
        if name == "n_fault":
            raise Refused("a fault needs its displacement, which is not in the data")
        points, block = _noddy_truth(name)
        return float((PROGRAMS[program_name](_noddy_beds(name)).blocks(points) == block).mean())

    return share


def folds() -> dict:
    """The share of random points in the right block."""
    programs = {"RealModel": _noddy_realmodel, "GemPy": _noddy_gempy}
    programs |= {name: _noddy_other(name) for name in ("LoopStructural", "SciPy RBF")}
    return {"folds": list(NODDY), "programs": _rows(iter(NODDY), programs)}


def moureze() -> dict:
    """The share of places beside dips that are on the right side of the surface."""

    def of(program):
        def share(case):
            history, asked, is_above = case
            return float((program(_beds(history)).blocks(asked) == is_above).mean())

        return share

    programs = {name: of(program) for name, program in PROGRAMS.items()}
    return {"draws": DRAWS, "programs": _rows(map(histories.moureze, range(DRAWS)), programs)}


def _distances(solved: Solved, points: list[np.ndarray]) -> list[np.ndarray]:
    """Of the points of each surface about how far they are from its level set, by central differences of the
    field, evaluated at once."""
    moves = STEP * np.concatenate([np.zeros((1, 3)), np.eye(3), -np.eye(3)])
    values = solved.at((moves[:, None] + np.concatenate(points)).reshape(-1, 3)).reshape(7, -1)
    steepness = norm((values[1:4] - values[4:]).T) / (2 * STEP)
    surfaces = np.repeat(np.arange(len(points)), [len(some) for some in points])
    far = (values[0] - solved.levels[surfaces]) / steepness
    return np.split(far, np.cumsum([len(some) for some in points])[:-1])


def claudius() -> dict:
    """Mean and standard deviation, in meters, of the distances of points that were not given from the level
    sets of each horizon (compare_fields), from a tenth of the points."""
    names = compare_fields.HORIZONS
    horizons = {
        name: np.vstack([compare_fields.table(f"{name}Points"), compare_fields.table(f"{name}Section")])
        for name in names
    }
    known = [horizons[name][horizons[name][:, 4] < SHARE, :3] for name in names]
    unseen = [horizons[name][horizons[name][:, 4] >= SHARE, :3][::EVERY] for name in names]
    dips = compare_fields.table("Dips")
    normals = -dips[:, 3:6] / norm(dips[:, 3:6])[:, None]
    surfaces = np.repeat(np.arange(4, dtype=np.int32), [len(some) for some in known])
    data = LevelSetData(names, np.concatenate(known), surfaces, dips[:, :3], normals)
    beds = Beds(data, compare_fields.LOW, compare_fields.HIGH, CLAUDIUS_VALUES)

    def of(program):
        return lambda: _distances(program(beds), unseen)

    rows = {}
    works = {name: of(program) for name, program in PROGRAMS.items()}
    works["RealModel"] = lambda: _claudius_ours(horizons, unseen)
    for name, work in works.items():
        refusals: list[str] = []
        far, seconds = judged(work, refusals)
        told = None if far is None else [[float(some.mean()), float(some.std())] for some in far]
        print(name, told, refusals, f"{seconds:.1f} s", flush=True)
        rows[name] = {"distances": told, "seconds": round(seconds, 1), "refusals": refusals}
    asked = sum(map(len, unseen))
    return {"points": len(data.contacts), "dips": len(dips), "asked": asked, "programs": rows}


def _claudius_ours(horizons: dict, unseen: list[np.ndarray]) -> list[np.ndarray]:
    """As scripts/compare_fields.py measures it: on the lattice of the benchmark, through the contacts."""
    _, through, _ = compare_fields.solved(horizons, SHARE, "")
    return [
        compare_fields.distances(through, points, level)
        for points, level in zip(unseen, through.levels, strict=True)
    ]
