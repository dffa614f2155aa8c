# SPDX-License-Identifier: GPL-3.0-or-later
"""Observations of blocks among faults and bodies: the compartment of each, and the bodies that it is in."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ..base.algebra import norm
from ..base.sheet import Sheet
from ..base.work import Work, native_module
from ..readers.tables.observations import Observations
from ..surfaces.field_data import apply_observations, observed_on_mesh
from ..surfaces.observed.derived import Situation
from ..surfaces.rock_input import RockInput
from ..surfaces.sides import sides_of
from .fields import spacing
from .parts.parts import Structures

# Of an edge length of the planar mesh, or of the lattice of a field alone.
_NEAR = 0.25  # nearer to a fault, a boundary between blocks may be the fault


# of places (N, 3) those in faults (N, F) and in bodies (N, B)
SidesOf = Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]


def apply_in_compartments(work: Work, structures: Structures, inputs: list[RockInput]) -> None:
    """Gives the surfaces of rock masses (RockInput) whose compartments are known the contacts and bounds that
    follow from their observations."""
    for number, entry in enumerate(inputs):
        observations = entry.rock.observed
        if observations is None or not len(observations):
            continue
        bodies = [
            (body, times[number])
            for body, times in zip(structures.bodies, structures.times, strict=True)
            if number in times
        ]

        def sides(
            places: np.ndarray, entry: RockInput = entry, bodies: list = bodies
        ) -> tuple[np.ndarray, np.ndarray]:
            inside = [_inside(work, Sheet(*body.triangulation()), places) for body, _ in bodies]
            within = np.array(inside, bool).reshape(len(bodies), len(places)).T
            return sides_of(work, places, entry.divided().faults), within

        places, parted = observations.places, None
        if entry.region is not None:
            reach = _NEAR * (entry.median_edge() if entry.rock.interpolates else spacing(entry))
            parted = _parted(observations, reach, sides)
            places = _off_structures(observations, reach, sides)
        given = observed_on_mesh(entry, places)
        if parted is not None:
            of_given = parted
            parted = np.zeros(len(given[1]), bool)
            parted[given[1]] = of_given
        of_faults, within = sides(given[0].places)
        situation = Situation(
            sides=of_faults,
            inside=within,
            after=[after for _, after in bodies],
            bodies=[body.name for body, _ in bodies],
            voids=[body.void for body, _ in bodies],
            parted=parted,
        )
        apply_observations(work, entry, situation, given)


def _inside(work: Work, body: Sheet, places: np.ndarray) -> np.ndarray:
    """(N,) bool: which places (N, 3) lie in a body."""
    if not len(places):
        return np.zeros(0, bool)
    given: list[tuple] = [(*body.arrays, True, [], False)]
    return work.native(native_module().structure_sides, given, np.ascontiguousarray(places)) < 0


def _parted(observations: Observations, reach: float, sides: SidesOf) -> np.ndarray:
    """(N,) bool: places without a hole where blocks meet, as on a map, and a fault or the border of a body
    passes nearer in plan than `reach`: it may be this that divides them. sides: as of _off_structures."""
    alone = np.flatnonzero(observations.holes == "")
    places, place = np.unique(observations.places[alone], axis=0, return_inverse=True)
    place, blocks = place.ravel(), observations.blocks[alone]
    first = np.full(len(places), "", blocks.dtype)
    first[place] = blocks
    meets = np.zeros(len(places), bool)
    meets[place[first[place] != blocks]] = True
    parted = np.zeros(len(observations), bool)
    if meets.any():
        shifts = reach * np.array([[0, 0, 0], [1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0]], float)
        around = (places[meets] + shifts[:, None]).reshape(-1, 3)
        found = np.concatenate([each.astype(np.int8) for each in sides(around)], axis=1)
        found = found.reshape(len(shifts), -1, found.shape[1])
        meets[meets] = (found != found[:1]).any(axis=(0, 2))
        parted[alone] = meets[place]
    return parted


def _off_structures(observations: Observations, reach: float, sides: SidesOf) -> np.ndarray:
    """(N, 3) the places of observations. Where two intervals of a hole meet, and a fault or the border of a
    body passes nearer than `reach` along the hole, it may be this that divides them: no surface is known to
    be there, and both ends move into their intervals by that much.

    sides(places): of faults and of bodies, (N, F) and (N, B).
    """
    places, holes, blocks = observations.places, observations.holes, observations.blocks
    if len(places) < 2:
        return places
    follows = (holes[1:] == holes[:-1]) & (holes[1:] != "")
    meets = follows & (blocks[1:] != blocks[:-1]) & (places[1:] == places[:-1]).all(axis=1)
    upper = np.flatnonzero(meets)
    lower = upper + 1
    moved = places.copy()
    inward = np.concatenate([upper - 1, np.minimum(lower + 1, len(places) - 1)])
    ends = np.concatenate([upper, lower])
    same = (inward >= 0) & (blocks[inward] == blocks[ends]) & (holes[inward] == holes[ends])
    way = np.where(same[:, None], places[inward] - places[ends], 0.0)
    length = norm(way)[:, None]
    with np.errstate(invalid="ignore", divide="ignore"):
        step = np.where(length > 0, way * np.minimum(1.0, reach / length), 0.0)
    inner = places[ends] + step
    found = np.concatenate([each.astype(np.int8) for each in sides(inner)], axis=1)
    parted = (found[: len(upper)] != found[len(upper) :]).any(axis=1)
    moved[upper[parted]] = inner[: len(upper)][parted]
    moved[lower[parted]] = inner[len(upper) :][parted]
    return moved
