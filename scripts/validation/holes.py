# SPDX-License-Identifier: GPL-3.0-or-later
"""Field data: histories of known truth by all methods for heights, and wells left out of real data."""

from __future__ import annotations

import time
from dataclasses import replace

import numpy as np
from field_data.histories import HISTORIES, History, Layer
from field_data.measured import measure, project, random_points, right_share
from realmodel.core import build, load_project
from realmodel.core.base.errors import RealModelError
from realmodel.core.base.work import run
from realmodel.core.heights.left_out_places import in_turn, places_of
from realmodel.core.surfaces.observed.derived import BlockNumbers
from realmodel.core.validation.observed import PLACES
from scipy.interpolate import RBFInterpolator
from stacks import places

METHODS = (
    "kriging",
    "universal_kriging",
    "spline",
    "dsi",
    "natural_neighbour",
    "tin",
    "idw",
    "plane",
    "constant",
)
WITH_LOGS, WITH_SERIES = "default, with logs and dips", "and with series"
GROUPS = 5  # in which holes are left out
WELLS = places.REAL_DATA / "field" / "geoinr_intervals" / "project.toml"


def rbf_heights(points: np.ndarray):
    """The heights of a surface through points (P, 3) by SciPy with default options; a constant through fewer
    than three."""
    _, first = np.unique(points[:, :2], axis=0, return_index=True)
    chosen = points[np.sort(first)]
    if len(chosen) < 3:
        return lambda x, y: np.full(np.shape(x), chosen[:, 2].mean())
    middle, scale = chosen[:, :2].mean(axis=0), np.ptp(chosen[:, :2], axis=0).max()
    function = RBFInterpolator((chosen[:, :2] - middle) / scale, chosen[:, 2])
    return lambda x, y: function((np.column_stack([x, y]) - middle) / scale)


def _rbf_share(history: History, points, block) -> float:
    """With contacts alone and the rules of the history."""
    data = measure(history)
    layers = [
        layer if number == len(history.layers) - 1 else replace(layer, height=rbf_heights(contacts))
        for number, (layer, contacts) in enumerate(zip(history.layers, data.contacts, strict=True))
        if len(contacts) or number == len(history.layers) - 1
    ]
    names = {layer.name: number for number, layer in enumerate(history.layers)}
    numbers = np.array([*(names[layer.name] for layer in layers), -1])
    made = replace(history, layers=layers)
    return float(np.mean(numbers[made.block_at(points)] == block))


def methods() -> dict:
    """Of each history the share of 20,000 random points in the right block, from contacts of holes alone by
    each method, and by the default method from all data."""
    rows: dict[str, list] = {}
    seconds: dict[str, float] = {}
    for history in HISTORIES:
        points = random_points(history)
        data = measure(history)

        def of(what, method, case=(history, data, points)):
            try:
                return right_share(build(project(case[0], case[1], what, method)), *case[2])
            except RealModelError as refusal:
                print(f"{case[0].name}, {method}: {refusal}", flush=True)
                return None

        works = {"default": lambda of=of: of("contacts", None)}
        works |= {name: lambda name=name, of=of: of("contacts", name) for name in METHODS}
        works["SciPy RBF"] = lambda case=(history, *points): _rbf_share(*case)
        works[WITH_LOGS] = lambda of=of: of("all", None)
        if history.conformable:
            works[WITH_SERIES] = lambda of=of: of("series", None)
        for name, work in works.items():
            began = time.process_time()
            share = work()
            rows.setdefault(name, []).append(None if share is None else round(share, 4))
            seconds[name] = seconds.get(name, 0.0) + time.process_time() - began
        print(history.name, {name: row[-1] for name, row in rows.items()}, flush=True)
    seconds = {name: round(total / len(rows[name]), 1) for name, total in seconds.items()}
    return {"histories": [history.name for history in HISTORIES], "methods": rows, "seconds": seconds}


def wells() -> dict:
    """The share of the length of the holes of the Western Canadian basin in the right block, each predicted
    by the others, and the errors of the heights of contacts."""
    model = build(load_project(WELLS))
    began = time.process_time()
    validation = model.cross_validate_holes(folds=GROUPS)
    seconds = time.process_time() - began
    rock = model.rock_inputs[0].rock
    log = _Log(rock)
    contacts = {hole.hole: hole.contacts for hole in validation.holes}
    turns = in_turn(run(lambda work: _numbers(work, log)), GROUPS)
    rows = {"RealModel": _row(validation.share, validation.errors, seconds)}
    for name, predict in (("SciPy RBF", _rbf), ("nearest hole", _nearest)):
        began = time.process_time()
        lengths, errors = [], []
        for out in turns:
            right, away = predict(log, contacts, rock, out)
            lengths.append(right)
            errors.append(away)
        share = sum(lengths) / log.total
        rows[name] = _row(share, np.concatenate(errors), time.process_time() - began)
        print(name, rows[name], flush=True)
    return {"holes": len(validation.holes), "groups": validation.groups, "programs": rows}


def _row(share: float, errors: np.ndarray, seconds: float) -> dict:
    size = np.abs(errors)
    return {
        "share": round(float(share), 4),
        "median": round(float(np.median(size)), 1) if len(size) else None,
        "rms": round(float(np.sqrt((errors**2).mean())), 1) if len(size) else None,
        "contacts": len(errors),
        "seconds": round(seconds, 1),
    }


class _Log:
    """The intervals of vertical holes: names (H,) and plan (H, 2) of holes; of each interval its hole, top
    and foot, and block number."""

    def __init__(self, rock):
        observed = rock.observed
        self.names = list(dict.fromkeys(observed.holes.tolist()))
        number = {name: k for k, name in enumerate(self.names)}
        owner = np.array([number[name] for name in observed.holes.tolist()])
        self.plan = np.array([observed.places[owner == k][0, :2] for k in range(len(self.names))])
        ends = np.flatnonzero((observed.intervals[1:] == observed.intervals[:-1]) & (owner[1:] == owner[:-1]))
        self.hole = owner[ends]
        self.top, self.foot = observed.places[ends, 2], observed.places[ends + 1, 2]
        self.block = BlockNumbers(rock).of(observed.blocks)[ends]
        self.length = self.top - self.foot
        self.total = float(self.length.sum())

    def inside(self, intervals: np.ndarray) -> np.ndarray:
        """(I, PLACES) heights in some intervals."""
        shares = (np.arange(PLACES) + 0.5) / PLACES
        return self.top[intervals, None] - shares * self.length[intervals, None]


def _numbers(work, log: _Log) -> np.ndarray:
    numbers = places_of(work, log.plan)
    return np.arange(len(log.names)) if numbers is None else numbers


def _rbf(log, contacts, rock, out) -> tuple[float, np.ndarray]:
    """Surfaces by SciPy through the contacts of the other holes, with the rules of the project."""
    known = {surface.name: [] for surface in rock.surfaces}
    for number in np.flatnonzero(~out):
        for contact in contacts[log.names[number]]:
            known[contact.surface].append(contact.place)
    heights = [rbf_heights(np.array(known[surface.name] or surface.points)) for surface in rock.surfaces]
    layers = [
        Layer(surface.name, surface.rule, height)
        for surface, height in zip(rock.surfaces, heights, strict=True)
    ]
    history = History("wells", layers, 0, 0)
    asked = np.flatnonzero(out[log.hole])
    z = log.inside(asked)
    plan = np.repeat(log.plan[log.hole[asked]], PLACES, axis=0)
    block = history.block_at(np.column_stack([plan, z.ravel()])).reshape(z.shape)
    right = float(((block == log.block[asked, None]).mean(axis=1) * log.length[asked]).sum())
    errors = [
        heights[number](*np.array([contact.place[:2]]).T)[0] - contact.place[2]
        for hole in np.flatnonzero(out)
        for contact in contacts[log.names[hole]]
        for number, surface in enumerate(rock.surfaces)
        if surface.name == contact.surface
    ]
    return right, np.array(errors)


def _nearest(log, contacts, rock, out) -> tuple[float, np.ndarray]:
    """Every hole has what the nearest of the other holes has at the same height; above and below its log what
    it has at its ends. It has no surfaces, so no heights are compared."""
    others = np.flatnonzero(~out)
    right = 0.0
    for hole in np.flatnonzero(out):
        near = others[np.linalg.norm(log.plan[others] - log.plan[hole], axis=1).argmin()]
        known = np.flatnonzero(log.hole == near)
        known = known[np.argsort(log.foot[known])]
        asked = np.flatnonzero(log.hole == hole)
        if not len(known):
            continue
        at = np.minimum(np.searchsorted(log.foot[known], log.inside(asked), side="right") - 1, len(known) - 1)
        block = log.block[known[np.maximum(at, 0)]]
        right += float(((block == log.block[asked, None]).mean(axis=1) * log.length[asked]).sum())
    return right, np.empty(0)
