# SPDX-License-Identifier: GPL-3.0-or-later
"""Observations of blocks among faults and bodies: the compartment of each, and the bodies that it is in."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from ..base.algebra import norm
from ..base.triangles import Sheet
from ..base.work import Work, native_module
from ..readers.tables.observations import Observations, in_one_interval
from ..surfaces.field_data import apply_observations, observed_on_mesh
from ..surfaces.observed.columns import Succession
from ..surfaces.observed.derived import BlockNumbers, PlaceContext
from ..surfaces.observed.edge_crossings import with_places
from ..surfaces.rock_input import RockInput
from ..surfaces.rock_structure import sides_of
from .fields import spacing
from .parts.parts import Structures
from .sheets.families import box_of, parts_of_lines, walls_of

# Of an edge length of the planar mesh, or of the lattice of a field alone.
_NEAR = 0.25  # nearer to a fault, a boundary between blocks may be the fault
_LOGGED = 1e-3  # nearer along a hole, it is the fault, up to the rounding of the log
_BESIDE = 1e-6  # how far from a fault places are that stand for its two sides


# of places (N, 3) those in faults (N, F) and in bodies (N, B)
SidesOf = Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]


def apply_in_compartments(work: Work, structures: Structures, inputs: list[RockInput]) -> None:
    """Gives the surfaces of rock masses (RockInput) whose compartments are known the contacts and bounds that
    follow from their observations."""
    for number, entry in enumerate(inputs):
        if entry.rock.observed is None or not len(entry.rock.observed):
            continue
        bodies = [
            (body, times[number])
            for body, times in zip(structures.bodies, structures.times, strict=True)
            if number in times
        ]
        shapes = [Sheet(*body.triangulation()) for body, _ in bodies]

        def sides(
            places: np.ndarray, entry: RockInput = entry, shapes: list[Sheet] = shapes
        ) -> tuple[np.ndarray, np.ndarray]:
            inside = [_inside(work, body, places) for body in shapes]
            within = np.array(inside, bool).reshape(len(shapes), len(places)).T
            return sides_of(work, places, entry.divided().faults), within

        observations, is_own, edge = entry.rock.observed, np.ones(len(entry.rock.observed), bool), None
        across = np.zeros(len(observations), bool)
        if entry.region is not None:
            edge = entry.median_edge() if entry.rock.interpolates else spacing(entry)
            observations, is_own, across = _with_both_sides(entry, shapes, sides, _BESIDE * edge)
            observations, is_kept = observed_on_mesh(entry, observations)
            at = np.cumsum(is_kept) - 1
            is_own, across = is_kept & is_own[at], is_kept & across[at]
        situation = PlaceContext(
            None,
            *sides(observations.places),
            after=[after for _, after in bodies],
            bodies=[body.name for body, _ in bodies],
            voids=[body.void for body, _ in bodies],
            across=across,
            displaced=_displaced(entry),
        )
        if edge is not None:
            disputed, length = _between(entry, observations, _NEAR * edge, situation)
            is_rounding = length <= _LOGGED * edge
            parted = _parted(observations, _NEAR * edge, sides) | (disputed & is_rounding)
            situation = replace(situation, parted=parted, disputed=disputed & ~is_rounding)
        apply_observations(work, entry, situation, (observations, is_own))


def _with_both_sides(
    entry: RockInput, bodies: Sequence[Sheet], sides: SidesOf, off: float
) -> tuple[Observations, np.ndarray, np.ndarray]:
    """The observations of a RockInput, with a place more on each side of a fault, and of the border of a
    body, wherever an interval that is used passes it; and (N,) bool twice, those that are given, and of the
    two on both sides the second. off: how far from it the places are, and from the ends of ways at least."""
    observations = entry.rock.observed
    assert observations is not None
    end = np.flatnonzero(in_one_interval(observations, observations.in_use))
    first, last = observations.places[end - 1], observations.places[end]
    length = norm(last - first)
    is_long = length > 2 * off
    end, first, last, length = end[is_long], first[is_long], last[is_long], length[is_long]
    if not len(end):
        return observations, np.ones(len(observations), bool), np.zeros(len(observations), bool)
    walls = walls_of(entry.divided().faults.shapes, box_of(first, last))
    walls = np.concatenate([walls, *(body.vertices[body.triangles] for body in bodies)])
    way, shares = parts_of_lines(first, last, walls)
    passes = shares[:, 0] > 0
    way, at = way[passes], shares[passes, 0]
    beside = off / length
    ways = [way, way]
    share_parts = [at - beside[way], at + beside[way]]
    for share, place in ((beside, first), (1.0 - beside, last)):  # an end that lies on a fault
        inner = first + share[:, None] * (last - first)
        on = [(a != b).any(axis=1) for a, b in zip(sides(place), sides(inner), strict=True)]
        ways.append(np.flatnonzero(np.logical_or(*on)))
        share_parts.append(share[ways[-1]])
    way, share = np.concatenate(ways), np.concatenate(share_parts)
    is_second = np.zeros(len(way), bool)
    is_second[len(at) : 2 * len(at)] = share_parts[0] >= beside[ways[0]]
    is_within = (share >= beside[way]) & (share <= 1.0 - beside[way])
    order = np.lexsort((share[is_within], way[is_within]))
    more, is_own = with_places(observations, end[way[is_within][order]], share[is_within][order])
    across = np.zeros(len(more), bool)
    across[~is_own] = is_second[is_within][order]
    return more, is_own, across


def _inside(work: Work, body: Sheet, places: np.ndarray) -> np.ndarray:
    """(N,) bool: which places (N, 3) lie in a body."""
    if not len(places):
        return np.zeros(0, bool)
    prepared = native_module().PreparedStructure([(*body.arrays, True, [], False)])
    return work.native(prepared.sides, np.ascontiguousarray(places)) < 0


def _parted(observations: Observations, reach: float, sides: SidesOf) -> np.ndarray:
    """(N,) bool: places without a hole where blocks meet, as on a map, and a fault or the border of a body
    passes nearer in plan than `reach`: it may be this that divides them."""
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
        sides_around = np.concatenate([columns.astype(np.int8) for columns in sides(around)], axis=1)
        sides_around = sides_around.reshape(len(shifts), -1, sides_around.shape[1])
        meets[meets] = (sides_around != sides_around[:1]).any(axis=(0, 2))
        parted[alone] = meets[place]
    return parted


def _between(
    entry: RockInput, observations: Observations, reach: float, situation: PlaceContext
) -> tuple[np.ndarray, np.ndarray]:
    """(N,) bool: of intervals the places between an end at which another block begins, and a fault or the
    border of a body, if that passes within `reach` along the hole: it may be this that divides the blocks,
    and nothing is known between the two. And (N,) how long that part is."""
    follows = in_one_interval(observations, observations.in_use)
    chosen = np.zeros(len(observations), bool)
    row = np.flatnonzero(follows)
    length = np.zeros(len(observations))
    if not len(row):
        return chosen, length
    places, holes, blocks = observations.places, observations.holes, observations.blocks
    meets = (holes[1:] == holes[:-1]) & (blocks[1:] != blocks[:-1])
    meets &= (places[1:] == places[:-1]).all(axis=1)
    meets = np.concatenate([[False], meets, [False]])  # each row with the one before
    number = np.maximum(BlockNumbers(entry.rock, situation.bodies).of(blocks), 0)
    may_divide = _dividing(entry, situation)
    assert situation.sides is not None and situation.inside is not None
    passes_body = (situation.inside[row - 1] != situation.inside[row]).any(axis=1)
    passed = situation.sides[row - 1] != situation.sides[row]
    first = np.flatnonzero(~follows)
    last = np.append(first[1:], len(follows)) - 1
    interval = np.cumsum(~follows)[row] - 1
    for end, inner, step in ((first[interval], row - 1, 0), (last[interval], row, 1)):
        is_end = meets[end + step]
        other = np.where(is_end, end + 2 * step - 1, end)
        away = norm(places[inner] - places[end])
        near = is_end & (away <= reach)
        near &= passes_body | (passed & may_divide[number[end], number[other]]).any(axis=1)
        for one, two, far in zip(*(column[near].tolist() for column in (end, inner, away)), strict=True):
            part = slice(min(one, two), max(one, two) + 1)
            chosen[part], length[part] = True, np.maximum(length[part], far)
    return chosen, length


def _displaced(entry: RockInput) -> np.ndarray:
    """(S, F) bool: which surfaces each fault displaces."""
    faults, count = entry.divided().faults, len(entry.rock.surfaces)
    return np.array([faults.active(surface) for surface in range(count)]).reshape(count, len(faults))


def _dividing(entry: RockInput, situation: PlaceContext) -> np.ndarray:
    """(B, B, F) bool: whether two blocks may meet at a fault. Not if a surface that it does not displace
    would be there, too."""
    count, displaced = len(entry.rock.surfaces), _displaced(entry)
    succession = Succession([surface.rule for surface in entry.rock.surfaces], situation.after)
    blocks = range(count + len(situation.after))
    return np.array([[displaced[succession.contacts((a, b))].all(axis=0) for b in blocks] for a in blocks])
