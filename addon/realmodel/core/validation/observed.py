# SPDX-License-Identifier: GPL-3.0-or-later
"""How far a built model has the blocks that were observed, and the contacts and bounds that follow."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from ..base.errors import counted
from ..base.work import Work, run
from ..cells.model_data import ModelData
from ..readers.tables.observations import LeftOut, Observations, Origin, in_one_interval
from ..results.layer_values import at_places
from ..results.surface_quality import heights_of_points
from ..surfaces.observed.derived import BlockNumbers
from ..surfaces.rock_input import RockInput
from .closed_form import AIR, ClosedForm, closed_forms

PLACES = 16  # at which an interval is examined
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
    """(N,) heights at which places (N, 3) are examined: those a little above the youngest surface on it, as
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
    """Places at which observations are tested (N, 3), of which observation each is (N,), the first and the
    last row of each observation (O, 2), and (N,) bool whether a place may be seen on the ground, as it is in
    no hole. used: (R,) bool, the rows that count. An interval is the way along a hole through its rows."""
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


@dataclass(frozen=True)
class ObservedBlock:
    """One block of a rock mass. observations: of it, places and intervals, as far as they are used and lie
    over the region. outside: how many more lie beside it. share: of the observations that lie in the block,
    from 0 to 1; of an interval the part that does. A place without a hole, up to a tenth of an edge length
    above the youngest surface, is tested on that surface. None where there are none."""

    rock: str
    block: str
    observations: int
    outside: int
    share: float | None


@dataclass(frozen=True)
class ObservedContact:
    """A place (x, y, z) on a surface of a rock mass. hole, depth: where it comes from; "" and None for a
    place without a hole. residual: the place less the height of the surface, None where that has none; of a
    level set about the distance from it, positive on its younger side."""

    rock: str
    surface: str
    hole: str
    depth: float | None
    place: tuple[float, float, float]
    residual: float | None


@dataclass(frozen=True)
class ViolatedBound:
    """A place (x, y, z) above or below which a surface of a rock mass should be, and is not: by how much.
    is_lower: whether it should be above; of a level set, whether the place should be on its older side, and
    `by` is about the distance from it. hole, depth: as of ObservedContact."""

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
        total = sum(block.observations for block in self.blocks)
        inside = sum((block.share or 0.0) * block.observations for block in self.blocks)
        return inside / total if total else None

    def summary(self) -> str:
        """A line about all of it."""
        share = "none over the region" if self.share is None else f"{100 * self.share:.1f} % in their blocks"
        worst = max(
            (abs(contact.residual) for contact in self.contacts if contact.residual is not None), default=0.0
        )
        used = sum(block.observations for block in self.blocks)
        return (
            f"{counted(used, 'observation')}, {share}; {counted(len(self.contacts), 'contact')}, the "
            f"farthest {worst:.3g} off; {len(self.violated)} of {counted(self.bounds, 'bound')} not kept; "
            f"{counted(len(self.left_out), 'observation')} left out"
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
        rock, observed = entry.rock, entry.rock.observed
        if observed is not None and len(observed):
            blocks += _blocks(work, model, number, form)
            for at, surface in enumerate(rock.surfaces):
                data = entry.data[at]
                places = data.contacts[: 0 if data.has_only_bound_points else None]
                z = heights_of_points(model, first + at, at, number, places)
                near = NEAR * float(np.ptp(observed.places[:, 2]))
                for row, (place, height) in enumerate(zip(places.tolist(), z.tolist(), strict=True)):
                    residual = None if height != height else place[2] - height
                    source = data.source(data.contacts_from + row)[:2]
                    contacts.append(ObservedContact(rock.name, surface.name, *source, tuple(place), residual))
                count += len(data.bounds)
                violated += violated_bounds(model, (first + at, at, number), near)
        left_out += [(rock.name, observation) for observation in entry.left_out]
        first += len(rock.surfaces)
    violated.sort(key=lambda bound: -bound.by)
    return Observed(blocks, contacts, count, violated, left_out)


def violated_bounds(model: ModelData, surface: tuple[int, int, int], near: float) -> list[ViolatedBound]:
    """The bounds that a surface does not keep. surface: its number in the model, in its rock mass, and that
    of the rock mass."""
    number, at, r = surface
    rock = model.rock_inputs[r].rock
    bounds = model.rock_inputs[r].data[at].bounds
    if not len(bounds):
        return []
    own_field = model.rock_inputs[r].field_of(at)
    places, row = bounds.along(np.inf if own_field is None else own_field.fields[0].lattice.spacing[0])
    bounds_along = replace(bounds.some(row), places=places, ends=None)
    beyond = np.zeros(len(bounds))
    heights = heights_of_points(model, number, at, r, places, are_bounds=True)
    np.maximum.at(beyond, row, bounds_along.beyond(heights))
    return [
        ViolatedBound(
            rock.name,
            rock.surfaces[at].name,
            *Origin.of(bounds.holes[row], bounds.depths[row])[:2],
            tuple(bounds.places[row].tolist()),
            bool(bounds.is_lower[row]),
            float(beyond[row]),
        )
        for row in np.flatnonzero(beyond > near).tolist()
    ]


def _blocks(work: Work, model: ModelData, number: int, form: ClosedForm) -> list[ObservedBlock]:
    rock, seen = model.rock_inputs[number].rock, look(work, model, number, form)
    blocks = []
    for block in np.unique(seen.wanted).tolist():
        in_block = seen.wanted == block
        over = in_block & ~seen.is_beside
        share = float(seen.share[over].mean()) if over.any() else None
        name = seen.names[block]
        blocks.append(ObservedBlock(rock.name, name, int(over.sum()), int((in_block & ~over).sum()), share))
    return blocks
