# SPDX-License-Identifier: GPL-3.0-or-later
"""How far a built model has the blocks that were observed, and the contacts and bounds that follow."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from ..base.errors import counted
from ..base.work import Work, run
from ..cells.model_data import ModelData
from ..readers.tables.observations import LeftOut, Origin
from ..results.residuals import heights_of_points
from .closed_form import ClosedForm, closed_forms
from .seen_places import NEAR, look


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
                places = data.contacts[: 0 if data.is_along_bounds else None]
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
