# SPDX-License-Identifier: GPL-3.0-or-later
"""How far a built model has the blocks that were observed, and the contacts and bounds that follow."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from ..base.triangles import median_edge
from ..base.work import Work, run
from ..cells.model_data import ModelData
from ..readers.tables.observations import LeftOut, Observations
from ..results.layer_values import at_places
from ..results.residuals import heights_of_points
from ..surfaces.observed.derived import BlockNumbers
from ..surfaces.rock_input import RockInput
from .closed_form import ClosedForm, closed_forms

_SAMPLES = 16  # places at which an interval is looked at
_OFF_GROUND = 0.1  # of an edge length
_NEAR = 1e-9  # of the range of heights: a place so near to a block lies in it, a bound so near is kept


@dataclass(frozen=True)
class ObservedBlock:
    """One block of a rock mass. observations: of it, places and intervals, as far as they are used and lie
    over the region. outside: how many more lie beside it. share: of the observations that lie in the block,
    from 0 to 1; of an interval the part that does. A place of no hole up to a tenth of an edge length
    above the youngest surface is looked at on that. None where there are none."""

    rock: str
    block: str
    observations: int
    outside: int
    share: float | None


@dataclass(frozen=True)
class ObservedContact:
    """A place (x, y, z) on a surface of a rock mass. hole, depth: where it comes from; "" and None for a
    place without a hole. residual: the place less the height of the surface, None where that has none."""

    rock: str
    surface: str
    hole: str
    depth: float | None
    place: tuple[float, float, float]
    residual: float | None


@dataclass(frozen=True)
class ViolatedBound:
    """A place (x, y, z) above or below which a surface of a rock mass should be, and is not: by how much.
    is_lower: whether it should be above. hole, depth: as of ObservedContact."""

    rock: str
    surface: str
    hole: str
    depth: float | None
    place: tuple[float, float, float]
    is_lower: bool
    by: float


@dataclass(frozen=True)
class Observed:
    """What became of the observations of a model. blocks: those of its blocks that were observed. contacts:
    the places on surfaces that follow. bounds: how many heights surfaces have to be above or below, beside;
    violated: those that they are not, the largest first. left_out: (rock mass, observation) of those that
    were not used, and why."""

    blocks: list[ObservedBlock] = field(default_factory=list)
    contacts: list[ObservedContact] = field(default_factory=list)
    bounds: int = 0
    violated: list[ViolatedBound] = field(default_factory=list)
    left_out: list[tuple[str, LeftOut]] = field(default_factory=list)

    @property
    def share(self) -> float | None:
        """The share of all observations that lie in their blocks; None where there are none."""
        total = sum(each.observations for each in self.blocks)
        inside = sum((each.share or 0.0) * each.observations for each in self.blocks)
        return inside / total if total else None

    def summary(self) -> str:
        """A line about all of it."""
        share = "none over the region" if self.share is None else f"{100 * self.share:.1f} % in their blocks"
        worst = max((abs(each.residual) for each in self.contacts if each.residual is not None), default=0.0)
        return (
            f"{sum(each.observations for each in self.blocks)} observations, {share}; {len(self.contacts)} "
            f"contacts, the farthest {worst:.3g} off; {len(self.violated)} of {self.bounds} bounds not kept; "
            f"{len(self.left_out)} observations left out"
        )


def observed(model: ModelData) -> Observed:
    """What the built model has at the places of its observations (Rock.observations, and the intervals of its
    boreholes): for each block the share of them that lies in it, the residual of each contact, the bounds
    that are not kept, and what was left out. Empty where it has none.

    Raises InputRefused for a model of a file without its project.
    """
    model.require_project("what was observed")
    return run(lambda work: _observed(work, model), threads=model.threads)


def _observed(work: Work, model: ModelData) -> Observed:
    blocks, contacts, violated, left_out, count = [], [], [], [], 0
    forms, first = closed_forms(model), 0
    for number, (entry, form) in enumerate(zip(model.rock_inputs, forms, strict=True)):
        rock, given = entry.rock, entry.rock.observed
        if given is not None and len(given):
            blocks += _blocks(work, model, number, form, given)
            sources = _sources(given)
            for at, surface in enumerate(rock.surfaces):
                places = surface.contact_array()
                z = heights_of_points(model, first + at, at, number, places)
                near = _NEAR * float(np.ptp(given.places[:, 2]))
                for place, height in zip(places.tolist(), z.tolist(), strict=True):
                    residual = None if height != height else place[2] - height
                    source = sources.get(tuple(place), ("", None))
                    contacts.append(ObservedContact(rock.name, surface.name, *source, tuple(place), residual))
                count += 0 if surface.bounds is None else len(surface.bounds)
                violated += _violated(model, (first + at, at, number), near)
        left_out += [(rock.name, each) for each in entry.left_out]
        first += len(rock.surfaces)
    violated.sort(key=lambda each: -each.by)
    return Observed(blocks, contacts, count, violated, left_out)


def _depth(value: float) -> float | None:
    return None if np.isnan(value) else float(value)


def _sources(given: Observations) -> dict[tuple, tuple[str, float | None]]:
    """The hole and the depth of places."""
    rows = zip(given.places.tolist(), given.holes.tolist(), given.depths.tolist(), strict=True)
    return {tuple(place): (hole, _depth(depth)) for place, hole, depth in rows}


def _violated(model: ModelData, surface: tuple[int, int, int], near: float) -> list[ViolatedBound]:
    """The bounds that a surface does not keep. surface: its number in the model, in its rock mass, and that
    of the rock mass."""
    number, at, r = surface
    rock = model.rock_inputs[r].rock
    bounds = rock.surfaces[at].bounds
    if bounds is None or not len(bounds):
        return []
    beyond = bounds.beyond(heights_of_points(model, number, at, r, bounds.places))
    return [
        ViolatedBound(
            rock.name,
            rock.surfaces[at].name,
            str(bounds.holes[row]),
            _depth(bounds.depths[row]),
            tuple(bounds.places[row].tolist()),
            bool(bounds.is_lower[row]),
            float(beyond[row]),
        )
        for row in np.flatnonzero(beyond > near).tolist()
    ]


def _blocks(
    work: Work, model: ModelData, number: int, form: ClosedForm, given: Observations
) -> list[ObservedBlock]:
    entry = model.rock_inputs[number]
    bodies = [
        (n, body)
        for n, (body, times) in enumerate(zip(model.structures.bodies, model.structures.times, strict=True))
        if number in times
    ]
    numbers = BlockNumbers(entry.rock, [body.name for _, body in bodies]).of(given.blocks)
    surfaces = len(entry.rock.surfaces)
    of_model = np.array([*form.blocks, *(body.block for body in form.bodies), -1], np.int64)
    wanted = of_model[numbers]
    used = wanted >= 0
    if entry.used is not None:
        used &= entry.used
    samples, owner, of_block, on_ground = _samples(given, wanted, used)
    inside = np.zeros(len(samples), bool)
    near = _NEAR * float(np.ptp(given.places[:, 2]))
    samples[on_ground, 2] = _lowered(work, entry, form, samples[on_ground])
    for shift in (near, -near):
        moved = samples + np.array([0.0, 0.0, shift])
        inside |= form.blocks_at(work, moved) == of_block[owner]
    beside = np.zeros(len(samples), bool)
    if entry.region is not None:
        vertices, triangles = entry.region
        level = np.column_stack([vertices[:, :2], np.zeros(len(vertices))])
        beside = np.isnan(at_places(level, triangles, samples[:, :2], model.threads))
    counts = np.bincount(owner, minlength=len(of_block))
    parts = np.bincount(owner, inside, len(of_block)) / np.maximum(counts, 1)
    is_beside = np.bincount(owner, beside, len(of_block)) == counts
    names = [*entry.rock.block_names(), *(body.name for _, body in bodies)]
    found = []
    for block in np.unique(of_block).tolist():
        own = (of_block == block) & (counts > 0)
        over = own & ~is_beside
        name = names[int(np.flatnonzero(of_model[: surfaces + len(bodies)] == block)[0])]
        share = float(parts[over].mean()) if over.any() else None
        found.append(ObservedBlock(entry.rock.name, name, int(over.sum()), int((own & ~over).sum()), share))
    return found


def _lowered(work: Work, entry: RockInput, form: ClosedForm, places: np.ndarray) -> np.ndarray:
    """(N,) heights at which places (N, 3) are looked at: those a little above the youngest surface on it, as
    the ground between the nodes of the planar mesh is not just where it was seen."""
    if entry.region is None:
        return places[:, 2]
    above = places[:, 2] - form.youngest_heights(work, places)
    return np.where(
        (above > 0) & (above < _OFF_GROUND * median_edge(*entry.region.arrays)),
        places[:, 2] - above,
        places[:, 2],
    )


def _samples(
    given: Observations, wanted: np.ndarray, used: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Places at which observations are looked at (N, 3), of which observation each is (N,), the block of
    each observation, and (N,) bool whether a place may be seen on the ground, as it is in no hole. wanted:
    (R,) the blocks of rows; used: (R,) bool, those that count. An interval is the way along a hole through
    its rows."""
    follows = given.goes_on & used
    follows[1:] &= used[:-1]
    ends = np.flatnonzero(follows)
    shares = (np.arange(_SAMPLES) + 0.5) / _SAMPLES
    begin, way = given.places[ends - 1], given.places[ends] - given.places[ends - 1]
    along = (begin[:, None] + shares[None, :, None] * way[:, None]).reshape(-1, 3)
    # a place without a hole, or one that is alone in its block in a hole, and on no boundary
    in_interval = follows | np.append(follows[1:], False)
    _, place, times = np.unique(given.places, axis=0, return_inverse=True, return_counts=True)
    alone = np.flatnonzero(used & ~in_interval & (times[place.ravel()] == 1))
    first = np.cumsum(~follows) - 1  # the number of the observation that a row is of
    rows = np.concatenate([np.repeat(ends, _SAMPLES), alone])
    numbers, owner = np.unique(first[rows], return_inverse=True)
    on_ground = np.concatenate([np.zeros(len(along), bool), given.holes[alone] == ""])
    places = np.concatenate([along, given.places[alone]])
    return places, owner.ravel(), wanted[~follows][numbers], on_ground
