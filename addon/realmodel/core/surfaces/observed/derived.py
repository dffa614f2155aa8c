# SPDX-License-Identifier: GPL-3.0-or-later
"""Contacts and bounds of surfaces from observations of blocks."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ...heights.bounded import consistent
from ...heights.mis_ties import contradictions, without_mis_ties
from ...project.project import Rock, Surface
from ...readers.tables.observations import SWITCHED_OFF, Bounds, LeftOut, Observations, Origin, along_bounds
from .columns import Succession, in_wrong_order
from .kept_contacts import kept_bounds
from .level_sets import FieldStatements
from .surface_data import Sources, SurfaceData


@dataclass(frozen=True)
class PlaceContext:
    """Where the places of observations (N) lie, as far as it is known.

    covered: (N, S) bool, over or under which surfaces of the rock mass. sides: (N, F) int8, of the faults
    that act in it; displaced: (S, F) bool, which surfaces each of these displaces. across: (N,) bool, places
    on the other side of a fault beside the one before: for surfaces that it does not displace they are one.
    inside: (N, B) bool, in which bodies; after: of each body, the surface after which it came; bodies: their
    names; voids: which of them are voids. parted: (N,) bool, where blocks meet that a fault or a body may
    divide, which is not used; disputed: (N,) bool, the same, where parts of intervals are left out for that.
    None and empty: everywhere covered, without faults and bodies."""

    covered: np.ndarray | None = None
    sides: np.ndarray | None = None
    inside: np.ndarray | None = None
    after: Sequence[int] = ()
    bodies: Sequence[str] = ()
    voids: Sequence[bool] = ()
    parted: np.ndarray | None = None
    disputed: np.ndarray | None = None
    across: np.ndarray | None = None
    displaced: np.ndarray | None = None


@dataclass
class Derived:
    """What observations say of each surface of a rock mass. contacts: (C, 3) places on it; sources: of these;
    errors: (C,) how far the height of each may be off. bounds: heights that it lies at or above, or at or
    below, at other places. used: (N,) bool, the observations that these follow from; left_out: those that are
    not used."""

    contacts: list[np.ndarray]
    sources: list[Sources]
    errors: list[np.ndarray]
    bounds: list[Bounds]
    used: np.ndarray
    left_out: list[LeftOut]


class BlockNumbers:
    """The numbers of blocks by their names: of the surface that each lies beneath, of the block, of a body;
    in this order. A name that several blocks have is none of them."""

    def __init__(self, rock: Rock, bodies: Sequence[str] = ()):
        count = len(rock.surfaces)
        self._numbers: dict[str, int] = {}
        blocks = rock.block_names()
        for number, name in enumerate(bodies):
            self._numbers[name] = count + number
        for number, name in enumerate(blocks):
            if blocks.count(name) == 1:
                self._numbers[name] = number
        for number, surface in enumerate(rock.surfaces):
            self._numbers[surface.name] = number

    def of(self, names: np.ndarray) -> np.ndarray:
        """(N,) int64 the numbers of blocks by their names (N,); -1 where there is no such block."""
        distinct, row = np.unique(names, return_inverse=True)
        numbers = np.array([self._numbers.get(name, -1) for name in distinct.tolist()], np.int64)
        return numbers[row.ravel()] if len(numbers) else np.empty(0, np.int64)


def derive(rock: Rock, observations: Observations, situation: PlaceContext | None = None) -> Derived:
    """Contacts and bounds of the surfaces of a rock mass from observations of its blocks."""
    situation = situation or PlaceContext()
    blocks = BlockNumbers(rock, situation.bodies).of(observations.blocks)
    left_out = _Listed(observations)
    left_out.add(~observations.in_use, SWITCHED_OFF, "it is switched off")
    left_out.add(
        observations.in_use & (blocks < 0),
        "no_surface",
        "no block, surface or body of the rock mass has this name",
    )
    used = observations.in_use & (blocks >= 0)
    if situation.disputed is not None:
        text = "the block ends beside a fault or a body, which may divide it from the next one"
        left_out.add(used & situation.disputed, "at_fault", text)
        used &= ~situation.disputed
    if situation.parted is not None:
        used &= ~situation.parted
    blocks = np.where(used, blocks, -1)
    used &= ~_without_surface(rock, situation, blocks, left_out)
    used &= ~_against_bodies(rock, situation, blocks, left_out)
    rows = np.flatnonzero(used)
    blocks_used = blocks[rows]
    ordered = np.where(blocks_used < len(rock.surfaces), blocks_used, -1)
    _, parts = _numbered(_sides(situation, len(observations))[rows])
    is_sheet = np.array([not rock.is_level_set(surface) for surface in rock.surfaces], bool)
    may = Succession([surface.rule for surface in rock.surfaces]).may_lie_above(is_sheet)
    wrong = rows[in_wrong_order(observations.some(rows), ordered, parts, may)]
    is_wrong = np.isin(np.arange(len(observations)), wrong)
    left_out.add(is_wrong, "wrong_order", "an older block lies above a younger one here, or a block twice")
    used &= ~is_wrong
    parts_derived, not_adjacent = _of_used(rock, observations, situation, blocks, np.flatnonzero(used))
    text = "it meets a block here that is not next to it in its series: no surface is known to be here"
    left_out.add(np.isin(np.arange(len(observations)), not_adjacent), "not_adjacent", text)
    return Derived(*parts_derived, used, left_out.entries)


class _Listed:
    """The observations that are left out, those of one interval as one entry."""

    def __init__(self, observations: Observations):
        self._given = observations
        self.entries: list[LeftOut] = []

    def add(self, chosen: np.ndarray, kind: str, text: str) -> None:
        observations = self._given
        before: int | None = None
        for row in np.flatnonzero(chosen).tolist():
            follows = (
                before == row - 1
                and observations.holes[row] != ""
                and observations.holes[row] == observations.holes[row - 1]
            )
            if not (follows and observations.blocks[row] == observations.blocks[row - 1]):
                entry = LeftOut(
                    kind,
                    f"{observations.source(row)}, '{observations.blocks[row]}': {text}",
                    str(observations.blocks[row]),
                    *Origin.of(observations.holes[row], observations.depths[row])[:2],
                    tuple(observations.places[row].tolist()),
                )
                self.entries.append(entry)
            before = row


def _sides(situation: PlaceContext, count: int) -> np.ndarray:
    return np.zeros((count, 0), np.int8) if situation.sides is None else situation.sides


def _numbered(rows: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The first of equal rows (N, K), and (N,) the number of each among the different ones."""
    if not rows.shape[1]:
        return np.arange(min(len(rows), 1)), np.zeros(len(rows), np.int64)
    _, first, number = np.unique(rows, axis=0, return_index=True, return_inverse=True)
    return first, number.ravel()


def _without_surface(
    rock: Rock, situation: PlaceContext, blocks: np.ndarray, left_out: _Listed
) -> np.ndarray:
    """(N,) bool: where the surface over the block does not exist."""
    missing = np.zeros(len(blocks), bool)
    if situation.covered is not None:
        layers = np.flatnonzero((blocks >= 0) & (blocks < len(rock.surfaces)))
        layer_blocks = blocks[layers]
        # the first surface that exists somewhere forms no block there, unless it is the oldest of all
        older = np.cumsum(situation.covered[layers], axis=1)[np.arange(len(layers)), layer_blocks] > 1
        missing[layers] = ~situation.covered[layers, layer_blocks] | ((layer_blocks > 0) & ~older)
        left_out.add(missing, "no_surface", "the surface over this block, or every older one, is not here")
    return missing


def _against_bodies(rock: Rock, situation: PlaceContext, blocks: np.ndarray, left_out: _Listed) -> np.ndarray:
    """(N,) bool: places in a body that are observed to be in something else, and the other way round. A void
    does not contradict a block: rock is seen before it is dug, and what fills it later."""
    against = np.zeros(len(blocks), bool)
    if situation.inside is None:
        return against
    count = len(rock.surfaces)
    succession = Succession([surface.rule for surface in rock.surfaces])
    for number, (after, is_void) in enumerate(zip(situation.after, situation.voids, strict=True)):
        if is_void:
            continue
        removed = np.array([succession.removes(block, after) for block in range(count)], bool)
        layer = (blocks >= 0) & (blocks < count)
        stays = ~removed[np.where(layer, blocks, 0)]
        against |= situation.inside[:, number] & layer & stays
        against |= ~situation.inside[:, number] & (blocks == count + number)
    left_out.add(against, "in_body", "a body lies here, or the body that was seen does not")
    return against


def _of_used(
    rock: Rock,
    observations: Observations,
    situation: PlaceContext,
    blocks: np.ndarray,
    used: np.ndarray,
) -> tuple[tuple[list[np.ndarray], list[Sources], list[np.ndarray], list[Bounds]], np.ndarray]:
    """The contacts of each surface, their sources and errors, and its bounds from the observations that are
    used, their rows; and the rows at places where blocks meet that no surface of their series divides."""
    places, sides = observations.places[used] + 0.0, _sides(situation, len(observations))[used]
    above, below = _statements(rock, situation, blocks, used)
    if (terrain := rock.terrain_number) is not None:  # it is measured, and not moved to what contradicts it
        above[:, terrain] = below[:, terrain] = False
    first, place = _numbered(np.column_stack([places, sides]))
    first_rows = np.full(len(first), len(used))
    np.minimum.at(first_rows, place, np.arange(len(used)))
    at_place = [np.zeros((len(first), len(rock.surfaces)), bool) for _ in range(2)]
    for mask, said in zip(at_place, (above, below), strict=True):
        np.logical_or.at(mask, place, said)
    meets = at_place[0] & at_place[1]
    _, column = _numbered(np.column_stack([places[:, :2], sides]))
    seen_on, errors_of = observations.seen_on[used], observations.errors[used]
    fields = FieldStatements(rock, observations, used, (above, below), (place, first_rows))
    contacts, sources, errors, bounds = [], [], [], []
    for number, surface in enumerate(rock.surfaces):
        is_level_set = number in fields.contacts
        on = fields.contacts[number] if is_level_set else np.sort(first_rows[meets[:, number]])
        contacts.append(places[on])
        sources.append(_sources_at(place, on, observations.holes[used], observations.depths[used]))
        errors.append(errors_of[on])
        if is_level_set:
            bounds.append(fields.bounds(number))
            continue
        # bounds from both sides, not a contact: the points of a grid are only those of the grid
        is_on = seen_on == surface.name
        lower, upper = (
            np.flatnonzero((said[:, number] | is_on) & ~meets[place, number]) for said in (above, below)
        )
        crossed = _crossed(places, column, lower, upper, on)
        bound_rows = [
            np.union1d(_tightest(places, column, rows, on, sign), rows[crossed[column[rows]]])
            for rows, sign in ((lower, 1.0), (upper, -1.0))
        ]
        rows = used[np.concatenate(bound_rows)]
        bounds.append(
            Bounds(
                observations.places[rows],
                np.repeat([True, False], [len(part) for part in bound_rows]),
                observations.holes[rows],
                observations.depths[rows],
            )
        )
    return (contacts, sources, errors, bounds), used[fields.not_adjacent]


def _sources_at(place: np.ndarray, on: np.ndarray, holes: np.ndarray, depths: np.ndarray) -> Sources:
    """The sources of contacts by their rows (C,): the holes at their places. place, holes, depths: (U,), of
    all rows."""
    number = np.full(len(place), -1)
    number[place[on]] = np.arange(len(on))
    sources: Sources = {}
    for row in np.flatnonzero((number[place] >= 0) & (holes != "")).tolist():
        at, hole = int(number[place[row]]), str(holes[row])
        if all(hole != origin.hole for origin in sources.get(at, ())):
            sources[at] = (*sources.get(at, ()), Origin.of(hole, depths[row]))
    return sources


def _statements(
    rock: Rock, situation: PlaceContext, blocks: np.ndarray, used: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """(U, S) bool twice: which surfaces lie at or above, and at or below, the places that are used."""
    count = len(rock.surfaces)
    rules = [surface.rule for surface in rock.surfaces]
    above, below = np.zeros((len(used), count), bool), np.zeros((len(used), count), bool)
    covered = np.ones((len(used), count), bool)
    if situation.covered is not None:
        covered = situation.covered[used]
    first, pattern = _numbered(covered)
    for number, row in enumerate(first):
        present = np.flatnonzero(covered[row])
        # a surface that does not exist here changes nothing here
        at = np.searchsorted(present, np.arange(count), side="right") - 1
        after = [int(at[surface]) for surface in situation.after]
        succession = Succession([rules[surface] for surface in present], after)
        new = np.full(count + len(after), -1)
        new[present] = np.arange(len(present))
        new[count:] = len(present) + np.arange(len(after))
        rows = np.flatnonzero(pattern == number)
        new_blocks = new[blocks[used[rows]]]
        above[np.ix_(rows, present)] = succession.at_or_above[new_blocks]
        below[np.ix_(rows, present)] = succession.at_or_below[new_blocks]
    if situation.inside is not None:
        for body, dug in enumerate(situation.after):
            if situation.voids[body]:  # what fills a void lies below surfaces that it was dug through
                fills = situation.inside[used, body] & (blocks[used] > dug) & (blocks[used] < count)
                below[fills, : dug + 1] = False
    if situation.across is not None:
        twice = _repeats_previous_place(situation, used)
        above &= ~twice
        below &= ~twice
    return above, below


def _repeats_previous_place(situation: PlaceContext, used: np.ndarray) -> np.ndarray:
    """(U, S) bool: of places that are used, the surfaces for which each is the one before, as no fault that
    lies between the two displaces them."""
    assert situation.across is not None and situation.sides is not None and situation.displaced is not None
    is_said = np.zeros((len(used), len(situation.displaced)), bool)
    second = np.flatnonzero(situation.across[used])
    second = second[(second > 0) & (used[second - 1] == used[second] - 1)]
    passed = situation.sides[used[second]] != situation.sides[used[second] - 1]
    is_said[second] = ~(passed[:, None] & situation.displaced).any(axis=2)
    return is_said


def _crossed(
    places: np.ndarray, column: np.ndarray, lower: np.ndarray, upper: np.ndarray, contacts: np.ndarray
) -> np.ndarray:
    """(K,) bool: the columns in which bounds contradict one another or a contact: there all count, as the
    fewest are to be left out. lower, upper, contacts: rows."""
    count = int(column.max(initial=-1)) + 1
    low, high = np.full(count, -np.inf), np.full(count, np.inf)
    for rows in (lower, contacts):
        np.maximum.at(low, column[rows], places[rows, 2])
    for rows in (upper, contacts):
        np.minimum.at(high, column[rows], places[rows, 2])
    return low > high


def _tightest(
    places: np.ndarray, column: np.ndarray, rows: np.ndarray, contacts: np.ndarray, sign: float
) -> np.ndarray:
    """Of rows that bound a surface, those that no other over or under the place, and no contact, implies.
    sign: 1 for bounds from below, of which the highest counts, -1 for those from above."""
    if not len(rows):
        return rows
    every = np.concatenate([contacts, rows])
    height = sign * places[every, 2]
    is_bound = np.arange(len(every)) >= len(contacts)
    # the highest of each column first; of equal ones a contact
    order = np.lexsort((is_bound, -height, column[every]))
    new = np.ones(len(order), bool)
    new[1:] = np.diff(column[every[order]]) != 0
    best = order[new]
    return np.sort(every[best[is_bound[best]]])


def with_contacts(rock: Rock, data: Sequence[SurfaceData], derived: Derived) -> list[SurfaceData]:
    """The data of the surfaces of a rock mass with these contacts instead of those that they had from
    observations, and with the bounds and those by contacts of older surfaces. A surface that has no point, no
    contact, and needs some, goes through places on its bounds."""
    all_data = []
    for number, (surface, surface_data, older_bounds) in enumerate(
        zip(rock.surfaces, data, kept_bounds(rock, data), strict=True)
    ):
        bounds = Bounds.joined([derived.bounds[number], older_bounds])
        surface_data = replace(surface_data, bounds=bounds)
        if surface.has_points:
            contacts = derived.contacts[number]
            is_alone = not (len(contacts) or surface_data.contacts_from or rock.is_level_set(surface))
            if has_only_bound_points := is_alone and surface.needs_points and len(bounds) > 0:
                contacts = along_bounds(bounds)
            points = np.concatenate([surface_data.own, contacts]) if len(contacts) else surface_data.own
            surface_data = replace(
                surface_data,
                points=points,
                sources=surface_data.picks
                | {
                    surface_data.contacts_from + row: origins
                    for row, origins in derived.sources[number].items()
                },
                error=float(np.sum(derived.errors[number] ** 2)) / max(len(points), 1),
                has_only_bound_points=has_only_bound_points,
            )
        all_data.append(surface_data)
    return all_data


_LISTED = 4  # others that a text names; all are in `contradicts`


def without_contradictions(
    rock: Rock, data: Sequence[SurfaceData]
) -> tuple[list[SurfaceData], list[LeftOut]]:
    """The data of the surfaces of a rock mass without faults, without contacts and bounds that contradict;
    and these. The bounds of a surface that goes through places on them, as it has no points, stay as they
    are."""
    consistent_data, left_out = list(data), list[LeftOut]()
    for number, surface in enumerate(rock.surfaces):
        if not rock.is_level_set(surface):
            consistent_data[number], doubles = _one_height_each(surface, data[number])
            left_out += doubles
        surface_data = consistent_data[number]
        bounds = surface_data.bounds
        if (
            not (len(bounds) and len(surface_data.points))
            or surface_data.has_only_bound_points
            or not rock.is_interpolated(surface)
        ):
            continue
        points, _ = without_mis_ties(surface_data.points)
        wrong = consistent(np.ascontiguousarray(points), bounds).left_out
        if not len(wrong):
            continue
        left_out += [_listed(surface, surface_data, bounds, wrong, row) for row in wrong.tolist()]
        is_kept = np.ones(len(bounds), bool)
        is_kept[wrong] = False
        consistent_data[number] = replace(surface_data, bounds=bounds.some(is_kept))
    return consistent_data, left_out


def _one_height_each(surface: Surface, data: SurfaceData) -> tuple[SurfaceData, list[LeftOut]]:
    """The data without contacts that are more than a mis-tie off the first point at their place in plan, as
    those of two holes at one place may be; and these."""
    if not len(data.contacts):
        return data, []
    wrong = contradictions(data.points)
    wrong[: data.contacts_from] = False
    if not wrong.any():
        return data, []
    _, first, place = np.unique(data.points[:, :2] + 0.0, axis=0, return_index=True, return_inverse=True)
    wrong[first] = False
    left_out = []
    for row in np.flatnonzero(wrong).tolist():
        texts = [
            f"{data.source_text(number)}: '{surface.name}' lies at {data.points[number, 2]:.9g}"
            for number in (row, int(first[place.ravel()[row]]))
        ]
        origin, at = data.source(row), tuple(data.points[row].tolist())
        text = f"{texts[0]}, which contradicts {texts[1]}"
        left_out.append(LeftOut("contradiction", text, "", origin.hole, origin.depth, at, tuple(texts[1:])))
    return data.some(~wrong), left_out


def _listed(surface: Surface, data: SurfaceData, bounds: Bounds, wrong: np.ndarray, row: int) -> LeftOut:
    """A bound that is left out, with the points and the bounds that are not which it contradicts."""
    place, is_lower = bounds.places[row], bool(bounds.is_lower[row])
    sign = 1.0 if is_lower else -1.0
    others = []
    for number in np.flatnonzero((data.points[:, :2] == place[:2]).all(axis=1)).tolist():
        height = float(data.points[number, 2])
        if sign * (place[2] - height) > 0:
            others.append(f"{data.source_text(number)}: '{surface.name}' lies at {height:.9g}")
    over = (bounds.places[:, :2] == place[:2]).all(axis=1) & (bounds.is_lower != is_lower)
    over &= sign * (place[2] - bounds.places[:, 2]) > 0
    over[wrong] = False
    others += [_said(surface, bounds, other) for other in np.flatnonzero(over).tolist()]
    named = "; ".join(others[:_LISTED])
    text = f"{_said(surface, bounds, row)}, which contradicts {named}"
    return LeftOut(
        "contradiction",
        text,
        "",
        *Origin.of(bounds.holes[row], bounds.depths[row])[:2],
        tuple(place.tolist()),
        tuple(others),
    )


def _said(surface: Surface, bounds: Bounds, row: int) -> str:
    side = "above" if bounds.is_lower[row] else "below"
    return f"{bounds.source(row)}: '{surface.name}' lies at or {side} {bounds.places[row, 2]:.9g}"
