# SPDX-License-Identifier: GPL-3.0-or-later
"""What is measured of a history, and the projects that are made of it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from realmodel.core import Dips, Model, Observations, Project, Rock, Surface
from realmodel.core.base.work import run
from realmodel.core.project.series import Series
from realmodel.core.settings.series_kinds import SHEETS
from realmodel.core.validation.closed_form import closed_forms

from .histories import BASE, GRID, LENGTH, History

EDGE = 25.0


@dataclass(frozen=True)
class Measured:
    """contacts: of each surface (C, 3), of holes alone. logs: of holes. outcrops: places and blocks. dips: of
    each surface (positions, gradients)."""

    contacts: list[np.ndarray]
    logs: Observations
    outcrops: Observations
    dips: list[Dips | None]


def measure(history: History, seed: int = 1) -> Measured:
    """Holes, outcrops and dips at places drawn at random."""
    draw = np.random.default_rng(seed)
    contacts: list[list] = [[] for _ in history.layers]
    rows: list[tuple] = []
    for hole, (x, y) in enumerate(draw.uniform(0, LENGTH, (history.holes, 2)).tolist()):
        log = history.log(x, y)
        ground = log[0][0]
        for (top, block), (bottom, _) in pairwise(log):
            for z in (top, bottom):
                rows.append((x, y, z, f"B{block}", f"W{hole}", ground - z))
        for z, _ in log[1:-1]:
            contacts[history.on_surface(x, y, z)].append((x, y, z))
    places, blocks = np.array([row[:3] for row in rows]), np.array([row[3] for row in rows])
    logs = Observations(
        places, blocks, np.array([row[4] for row in rows]), np.array([row[5] for row in rows])
    )
    plan = draw.uniform(0, LENGTH, (history.outcrops, 2))
    z = history.heights(plan)[-1] - 0.01
    seen = np.column_stack([plan, z])
    outcrops = Observations(seen, np.array([f"B{block}" for block in history.block_at(seen).tolist()]))
    return Measured(
        [np.array(each).reshape(-1, 3) for each in contacts], logs, outcrops, _dips(history, draw)
    )


def _dips(history: History, draw: np.random.Generator) -> list[Dips | None]:
    """Where a block on either side of a surface crops out, its slope there."""
    plan = draw.uniform(0, LENGTH, (4000, 2))
    ground = history.block_at(np.column_stack([plan, history.heights(plan)[-1] - 0.01]))
    found: list[Dips | None] = []
    for number, layer in enumerate(history.layers):
        at = plan[(ground == number) | (ground == number + 1)][: layer.dips]
        if not len(at):
            found.append(None)
            continue
        slopes = np.array([history.slope(number, x, y) for x, y in at.tolist()])
        found.append(Dips(at, slopes))
    return found


def project(history: History, data: Measured, what: str, method: str | None = None) -> Project:
    """The project of a history. what: "contacts", without observations and dips, surfaces without a contact
    left out; "all"; or "series", all with what is conformable as series of sheets."""
    contacts_alone = what == "contacts"
    series = {name: run[0] for run in history.conformable for name in run} if what == "series" else {}
    surfaces = []
    steps = np.arange(0, LENGTH + GRID / 2, GRID)
    x, y = (each.ravel() for each in np.meshgrid(steps, steps))
    ground = np.column_stack([x, y, history.layers[-1].height(x, y)])
    for number, layer in enumerate(history.layers):
        given = Surface(layer.name, rule=layer.rule, block=f"B{number}", method=method)
        if number == len(history.layers) - 1:
            given = Surface(layer.name, points=ground, method="grid", rule=layer.rule, block=f"B{number}")
        elif contacts_alone:
            if not len(data.contacts[number]):
                continue
            given.points = data.contacts[number]
        else:
            given.dips = data.dips[number]
            given.series = series.get(layer.name)
        surfaces.append(given)
    rock = Rock(
        "r",
        surfaces,
        region=[[0, 0], [LENGTH, 0], [LENGTH, LENGTH], [0, LENGTH]],
        edge_length=EDGE,
        base_elevation=BASE - 1000,
        observations=None if contacts_alone else Observations.joined([data.logs, data.outcrops]),
        series=[Series(name, SHEETS) for name in dict.fromkeys(series.values())],
    )
    return Project(history.name, [rock])


def random_points(history: History, count: int = 20000, seed: int = 7) -> tuple[np.ndarray, np.ndarray]:
    """Points (N, 3) below the ground with their blocks (N,)."""
    draw = np.random.default_rng(seed)
    points = draw.uniform([0, 0, BASE], [LENGTH, LENGTH, 400.0], (count, 3))
    block = history.block_at(points)
    return points[block >= 0], block[block >= 0]


def right_share(
    model: Model, points: np.ndarray, block: np.ndarray, unit_names: Mapping[int, str] | None = None
) -> float:
    """The share of points (N, 3) that a model has in their blocks (N,). unit_names: what the model calls
    blocks, "B0", ... without it."""
    form = closed_forms(model)[0]
    numbers = run(lambda work: form.blocks_at(work, points))
    names = np.array([*(each.name for each in model.blocks), ""])
    right = np.array([unit_names[number] if unit_names else f"B{number}" for number in block.tolist()])
    return float(np.mean(names[numbers] == right))
