# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether a built model has the observed block at the places of each observation."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..base.work import Work
from ..cells.model_data import ModelData
from ..readers.tables.observations import Observations, in_one_interval
from ..results.layer_values import at_places
from ..surfaces.observed.derived import BlockNumbers
from ..surfaces.rock_input import RockInput
from .closed_form import AIR, ClosedForm

PLACES = 16  # at which an interval is looked at
_OFF_GROUND = 0.1  # of an edge length
NEAR = 1e-9  # of the range of heights: a place so near to a block lies in it, a bound so near is kept


@dataclass(frozen=True, eq=False)
class Seen:
    """The observations of a rock mass that are used, places and intervals. rows: (O, 2) the first and the
    last row of each in Observations. wanted: (O,) the number of its block in the model. share: (O,) from 0 to
    1, which part of it lies in that block. found: (O,) the block that has most of the rest of it; AIR for
    none. is_beside: (O,) bool, which lie beside the region. names: of blocks, by their numbers."""

    rows: np.ndarray
    wanted: np.ndarray
    share: np.ndarray
    found: np.ndarray
    is_beside: np.ndarray
    names: dict[int, str]


def look(work: Work, model: ModelData, number: int, form: ClosedForm) -> Seen:
    """What the model has at the observations of a rock mass, by its number; form: its closed form."""
    entry = model.rock_inputs[number]
    observed = entry.rock.observed
    assert observed is not None
    bodies = [
        (n, body)
        for n, (body, times) in enumerate(zip(model.structures.bodies, model.structures.times, strict=True))
        if number in times
    ]
    numbers = BlockNumbers(entry.rock, [body.name for _, body in bodies]).of(observed.blocks)
    of_model = np.array([*form.blocks, *(body.block for body in form.bodies), -1], np.int64)
    wanted = of_model[numbers]
    used = wanted >= 0
    if entry.used is not None:
        used &= entry.used
    samples, owner, rows, on_ground = _samples(observed, used)
    of_block = wanted[rows[:, 0]]
    near = NEAR * float(np.ptp(observed.places[:, 2])) if len(observed) else 0.0
    samples[on_ground, 2] = _lowered(work, entry, form, samples[on_ground])
    model_blocks = [form.blocks_at(work, samples + np.array([0.0, 0.0, shift])) for shift in (near, -near)]
    inside = (model_blocks[0] == of_block[owner]) | (model_blocks[1] == of_block[owner])
    beside = np.zeros(len(samples), bool)
    if entry.region is not None:
        vertices, triangles = entry.region
        level = np.column_stack([vertices[:, :2], np.zeros(len(vertices))])
        beside = np.isnan(at_places(level, triangles, samples[:, :2], model.threads))
    counts = np.bincount(owner, minlength=len(of_block))
    parts = np.bincount(owner, inside, len(of_block)) / np.maximum(counts, 1)
    is_beside = np.bincount(owner, beside, len(of_block)) == counts
    names = [*entry.rock.block_names(), *(body.name for _, body in bodies)]
    first: dict[int, str] = {AIR: ""}
    for block, name in zip(of_model.tolist(), names, strict=False):
        first.setdefault(block, name)
    most = _most(owner[~inside], model_blocks[1][~inside], of_block)
    return Seen(rows, of_block, parts, most, is_beside, first)


def _most(owner: np.ndarray, blocks: np.ndarray, otherwise: np.ndarray) -> np.ndarray:
    """(O,) the block that most places of each observation have; where it has none, that of `otherwise`.
    owner, blocks: (N,) of places."""
    most = otherwise.copy()
    pairs, count = np.unique(np.column_stack([owner, blocks]), axis=0, return_counts=True)
    order = np.argsort(count, kind="stable")
    most[pairs[order, 0]] = pairs[order, 1]
    return most


def _lowered(work: Work, entry: RockInput, form: ClosedForm, places: np.ndarray) -> np.ndarray:
    """(N,) heights at which places (N, 3) are looked at: those a little above the youngest surface on it, as
    the ground between the nodes of the planar mesh is not just where it was seen."""
    if entry.region is None:
        return places[:, 2]
    above = places[:, 2] - form.youngest_heights(work, places)
    return np.where(
        (above > 0) & (above < _OFF_GROUND * entry.median_edge()),
        places[:, 2] - above,
        places[:, 2],
    )


def places_along(given: Observations, ends: np.ndarray) -> np.ndarray:
    """(PLACES E, 3) places on the way to each of some rows (E,) from the one before."""
    shares = (np.arange(PLACES) + 0.5) / PLACES
    begin, way = given.places[ends - 1], given.places[ends] - given.places[ends - 1]
    return (begin[:, None] + shares[None, :, None] * way[:, None]).reshape(-1, 3)


def _samples(
    observed: Observations, used: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Places at which observations are looked at (N, 3), of which observation each is (N,), the first and the
    last row of each observation (O, 2), and (N,) bool whether a place may be seen on the ground, as it is in
    no hole. used: (R,) bool, the rows that count. An interval is the way along a hole through its
    rows."""
    follows = in_one_interval(observed, used)
    ends = np.flatnonzero(follows)
    along = places_along(observed, ends)
    # a place without a hole, or one that is alone in its block in a hole, and on no boundary
    in_interval = follows | np.append(follows[1:], False)
    _, place, times = np.unique(observed.places, axis=0, return_inverse=True, return_counts=True)
    alone = np.flatnonzero(used & ~in_interval & (times[place.ravel()] == 1))
    first = np.cumsum(~follows) - 1  # the number of the observation that a row is of
    rows = np.concatenate([np.repeat(ends, PLACES), alone])
    numbers, owner = np.unique(first[rows], return_inverse=True)
    on_ground = np.concatenate([np.zeros(len(along), bool), observed.holes[alone] == ""])
    places = np.concatenate([along, observed.places[alone]])
    begin = np.flatnonzero(~follows)
    ends = np.append(begin[1:], len(observed)) - 1
    return places, owner.ravel(), np.column_stack([begin, ends])[numbers], on_ground
