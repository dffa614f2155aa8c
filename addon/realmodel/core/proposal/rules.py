# SPDX-License-Identifier: GPL-3.0-or-later
"""Which surfaces cut older rock, and which end against it, by the prediction of left-out holes.

Where a unit is absent between two others its rock was eroded, or it was never deposited there. The rules
decide which surface then passes through the contact (docs/reference/project_file.md), so surfaces that are
interpolated without a hole tell how well the rules suit: by the share of its length that they have in the
right unit. Surfaces are interpolated with a linear variogram and a plane as drift, and kept within what holes
say of them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..base.algebra import principal_axes
from ..heights.interpolate import interpolate
from .logs import Log
from .order import UnitOrder

_MOST_HOLES = 120  # on which rules are tried
_GROUPS = 10  # in which holes are left out
_BETTER = 0.002  # of the length in the right unit: less is no reason to change a rule
_STRAIGHT = 100.0  # the range of a variogram that is straight, in widths of the area
_ROUNDS = 3  # in which bounds are imposed
CUTS, ENDS = "erosional", "conformable"


@dataclass(frozen=True)
class RuleChoice:
    """rule: of the surface over a unit. reason: a sentence."""

    unit: str
    rule: str
    reason: str


@dataclass(frozen=True)
class _Holes:
    """plan: (H, 2). contacts: of each hole (number of the upper unit, of the lower, height), ends: (number of
    the unit, top, bottom)."""

    plan: np.ndarray
    contacts: Sequence[Sequence[tuple[int, int, float]]]
    ends: Sequence[Sequence[tuple[int, float, float]]]


def choose_rules(logs: Sequence[Log], order: UnitOrder) -> list[RuleChoice]:
    """The rule of the surface over each unit but the youngest, oldest first."""
    units = order.order
    holes = _holes(logs, order)
    gaps = _gaps(holes, len(units))
    if not any(gaps):
        reason = "no hole lacks a unit between two others: there is no sign that it cuts older rock"
        return [RuleChoice(unit, ENDS, reason) for unit in units[:-1]]
    share: dict[tuple[bool, ...], float] = {}
    made: dict[tuple, np.ndarray] = {}

    def right(cuts: tuple[bool, ...]) -> float:
        if cuts not in share:
            share[cuts] = _share_right(holes, cuts, made)
        return share[cuts]

    count = len(units) - 1
    best = max([(False,) * count, (True,) * count], key=right)
    for _ in range(2):
        before = best
        for number in range(count):
            flipped = (*best[:number], not best[number], *best[number + 1 :])
            if gaps[number] and right(flipped) > right(best) + _BETTER:
                best = flipped
        if best == before:
            break
    for number in range(count):  # what decides nothing cuts nothing
        flipped = (*best[:number], False, *best[number + 1 :])
        if best[number] and right(flipped) >= right(best):
            best = flipped
    choices = []
    for number, unit in enumerate(units[:-1]):
        cuts = best[number] and bool(gaps[number])
        if not gaps[number]:
            reason = "no hole lacks a unit next to it: there is no sign that it cuts older rock"
        else:
            other = right((*best[:number], not best[number], *best[number + 1 :]))
            reason = _reason([units[unit] for unit in gaps[number]], cuts, right(best), other)
        choices.append(RuleChoice(unit, CUTS if cuts else ENDS, reason))
    return choices


def _reason(absent: Sequence[str], cuts: bool, share: float, other: float) -> str:
    missing = ", ".join(f"'{unit}'" for unit in absent)
    what = "cuts older rock" if cuts else "ends against older rock"
    figures = f"left-out holes are right along {share:.1%} of their length so, and {other:.1%} if it"
    figures = f"{figures} {'ended against' if cuts else 'cut'} older rock"
    if abs(share - other) <= _BETTER:
        return f"where {missing} is absent, it {what}, which the holes hardly decide: {figures}"
    return f"where {missing} is absent, it {what}: {figures}"


def _holes(logs: Sequence[Log], order: UnitOrder) -> _Holes:
    used = [log for log in logs if log.parts]
    if len(used) > _MOST_HOLES:
        used = [used[number] for number in np.linspace(0, len(used) - 1, _MOST_HOLES).astype(int)]
    contacts, ends = [], []
    for log in used:
        ranks = [order.rank(part.unit) for part in log.parts]
        contacts.append(
            [
                (upper, lower, float(part.top[2]))
                for upper, lower, part in zip(ranks, ranks[1:], log.parts[1:], strict=False)
                if upper > lower
            ]
        )
        ends.append(
            [(rank, float(p.top[2]), float(p.bottom[2])) for rank, p in zip(ranks, log.parts, strict=True)]
        )
    return _Holes(np.array([log.plan for log in used]).reshape(-1, 2), contacts, ends)


def _gaps(holes: _Holes, count: int) -> list[list[int]]:
    """Of each surface but the youngest the units that are absent where its rule matters."""
    gaps: list[set[int]] = [set() for _ in range(count - 1)]
    for contacts in holes.contacts:
        for upper, lower, _ in contacts:
            if upper > lower + 1:
                for surface in range(lower, upper):
                    gaps[surface].update(range(lower + 1, upper))
    return [sorted(gap) for gap in gaps]


def _share_right(holes: _Holes, cuts: Sequence[bool], made: dict[tuple, np.ndarray]) -> float:
    """Of the length of holes that are left out in groups, in the right unit. made: heights by all that they
    follow from, since most of them are the same for other rules."""
    count = len(holes.plan)
    groups = np.arange(count) % min(_GROUPS, count)
    right = total = 0.0
    for group in range(min(_GROUPS, count)):
        left_out = np.flatnonzero(groups == group)
        known = np.flatnonzero(groups != group)
        if not len(known):
            continue
        heights = np.empty((len(cuts), len(left_out)))
        for surface in range(len(cuts)):
            told = _told(holes, known, cuts, surface)
            key = (group, *(values.tobytes() for values in told))
            if key not in made:
                made[key] = _predicted(holes.plan[known], *told, holes.plan[left_out])
            heights[surface] = made[key]
        for column, hole in enumerate(left_out.tolist()):
            bounds = _replayed(heights[:, column], cuts)
            for unit, top, bottom in holes.ends[hole]:
                low = -np.inf if unit == 0 else bounds[unit][0]
                high = bounds[unit][1]
                right += max(min(top, high) - max(bottom, low), 0.0)
                total += top - bottom
    return right / total if total else 1.0


def _replayed(heights: np.ndarray, cuts: Sequence[bool]) -> list[tuple[float, float]]:
    """(bottom, top) of each unit in a column: the replay of surfaces; the youngest unit has no top."""
    top, found = -np.inf, []
    for height, cut in zip(heights.tolist(), cuts, strict=True):
        if np.isnan(height):
            found.append((top, top))
            continue
        if cut:
            found = [(min(low, height), min(high, height)) for low, high in found]
            new = height
        else:
            new = max(height, top)
        found.append((min(top, new), new))
        top = new
    return [*found, (top, np.inf)]


def _told(
    holes: _Holes, known: np.ndarray, cuts: Sequence[bool], surface: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """What known holes say of a surface: its heights, NaN where they do not, and bounds from below and above,
    (N,) each."""
    count = len(known)
    equal, low, high = np.full(count, np.nan), np.full(count, -np.inf), np.full(count, np.inf)
    for row, hole in enumerate(known.tolist()):
        for upper, lower, height in holes.contacts[hole]:
            if not lower <= surface < upper:
                continue
            cutting = [number for number in range(lower, upper) if cuts[number]]
            through = cutting[-1] if cutting else lower
            if surface == through:
                equal[row] = height
            elif surface > through:
                high[row] = min(high[row], height)
            elif cuts[surface] or surface == lower:
                low[row] = max(low[row], height)
        for unit, top, bottom in holes.ends[hole]:
            if surface == unit or (surface > unit and cuts[surface]):
                low[row] = max(low[row], top)
            elif surface < unit and not any(cuts[surface + 1 : unit]):
                high[row] = min(high[row], bottom)
    return equal, low, high


def _predicted(
    places: np.ndarray, equal: np.ndarray, low: np.ndarray, high: np.ndarray, at: np.ndarray
) -> np.ndarray:
    """(N,) heights of a surface at plan points `at` (N, 2) from what is told at places (P, 2); NaN where that
    is nothing."""
    values = equal.copy()
    if not np.isfinite(values).any():
        values = np.where(np.isfinite(low), low, np.nan)  # no contact: as deep as it may be
    if not np.isfinite(values).any():
        return np.full(len(at), np.nan)
    nodes = np.concatenate([places, at])
    for _ in range(_ROUNDS):
        fixed = np.isfinite(values)
        here, there = np.split(_kriged(places[fixed], values[fixed], nodes), [len(places)])
        wrong = ~fixed & ((here < low) | (here > high))
        if not wrong.any():
            return there
        values[wrong] = np.clip(here[wrong], low[wrong], np.maximum(high[wrong], low[wrong]))
    fixed = np.isfinite(values)
    return _kriged(places[fixed], values[fixed], at)


def _kriged(places: np.ndarray, values: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Kriging whose variogram is straight over the places; the drift is a plane where places show one. Holes
    at one place count as one of their mean."""
    places, hole, count = np.unique(places, axis=0, return_inverse=True, return_counts=True)
    values = np.bincount(hole.ravel(), values) / count
    extent = max(float(np.ptp(places, axis=0).max()), 1e-12)
    has_plane = len(places) > 4 and principal_axes(places / extent)[0][-1] > 0.1
    method = "universal_kriging" if has_plane else "kriging"
    straight = {"model": "spherical", "range": _STRAIGHT * extent, "sill": _STRAIGHT}
    points = np.column_stack([places, values])
    # so small a system takes less time than threads take to begin
    return interpolate(points, at, method, variogram=straight, neighbours=0, threads=1).z
