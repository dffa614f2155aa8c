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
from dataclasses import dataclass, field

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


@dataclass
class _Holes:
    """plan: (H, 2). contacts: (C, 4) hole, number of the upper unit, of the lower, height, ends: (E, 4) hole,
    number of the unit, top, bottom; by hole, from above downward. groups: (H,) in which they are left out.
    found: heights at the holes of a group by what the others say of a surface: mostly the same with the next
    set of rules."""

    plan: np.ndarray
    contacts: np.ndarray
    ends: np.ndarray
    groups: np.ndarray
    found: dict[tuple[int, bytes], np.ndarray] = field(default_factory=dict)


def choose_rules(logs: Sequence[Log], order: UnitOrder) -> list[RuleChoice]:
    """The rule of the surface over each unit but the youngest, oldest first."""
    units = order.order
    holes = _holes(logs, order)
    gaps = _gaps(holes, len(units))
    if not any(gaps):
        reason = "no hole lacks a unit between two others: there is no sign that it cuts older rock"
        return [RuleChoice(unit, ENDS, reason) for unit in units[:-1]]
    share: dict[tuple[bool, ...], float] = {}

    def right(cuts: tuple[bool, ...]) -> float:
        if cuts not in share:
            share[cuts] = _share_right(holes, cuts)
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
    for hole, log in enumerate(used):
        ranks = [order.rank(part.unit) for part in log.parts]
        contacts += [
            (hole, upper, lower, float(part.top[2]))
            for upper, lower, part in zip(ranks, ranks[1:], log.parts[1:], strict=False)
            if upper > lower
        ]
        ends += [
            (hole, rank, float(part.top[2]), float(part.bottom[2]))
            for rank, part in zip(ranks, log.parts, strict=True)
        ]
    plan = np.array([log.plan for log in used]).reshape(-1, 2)
    groups = np.arange(len(used)) % _GROUPS
    return _Holes(plan, np.array(contacts).reshape(-1, 4), np.array(ends).reshape(-1, 4), groups)


def _gaps(holes: _Holes, count: int) -> list[list[int]]:
    """Of each surface but the youngest the units that are absent where its rule matters."""
    gaps: list[set[int]] = [set() for _ in range(count - 1)]
    for upper, lower in holes.contacts[:, 1:3].astype(int).tolist():
        if upper > lower + 1:
            for surface in range(lower, upper):
                gaps[surface].update(range(lower + 1, upper))
    return [sorted(gap) for gap in gaps]


def _share_right(holes: _Holes, cuts: Sequence[bool]) -> float:
    """Of the length of holes that are left out in groups, in the right unit."""
    said = [_said_of(surface, holes, cuts) for surface in range(len(cuts))]
    right = total = 0.0
    for group in range(min(_GROUPS, len(holes.plan)) if len(holes.plan) > 1 else 0):
        heights = np.array([_predicted(holes, group, of_surface) for of_surface in said])
        for column, hole in enumerate(np.flatnonzero(holes.groups == group).tolist()):
            bounds = _replayed(heights[:, column], cuts)
            first, end = np.searchsorted(holes.ends[:, 0], [hole, hole + 1])
            for number, top, bottom in holes.ends[first:end, 1:].tolist():
                unit = int(number)
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


def _said_of(surface: int, holes: _Holes, cuts: Sequence[bool]) -> np.ndarray:
    """(3, H) that holes say of a surface: its height, or NaN, and heights that it lies above and below."""
    cut = np.array(cuts)
    equal, low, high = np.array([[np.nan], [-np.inf], [np.inf]]).repeat(len(holes.plan), axis=1)
    hole, upper, lower = holes.contacts[:, :3].T.astype(int)
    height = holes.contacts[:, 3]
    last_cut = np.maximum.accumulate(np.where(cut, np.arange(len(cut)), -1))[upper - 1]
    through = np.where(last_cut >= lower, last_cut, lower)
    passed = (lower <= surface) & (surface < upper)
    at, above = passed & (through == surface), passed & (through < surface)
    below = passed & (through > surface) & (cut[surface] | (lower == surface))
    equal[hole[at]] = height[at]
    np.minimum.at(high, hole[above], height[above])
    np.maximum.at(low, hole[below], height[below])
    hole, unit = holes.ends[:, :2].T.astype(int)
    cuts_before = np.concatenate([[0], np.cumsum(cut)])
    above = (unit == surface) | (unit < surface) & cut[surface]
    below = (unit > surface) & (cuts_before[unit] == cuts_before[surface + 1])
    np.maximum.at(low, hole[above], holes.ends[above, 2])
    np.minimum.at(high, hole[below], holes.ends[below, 3])
    return np.array([equal, low, high])


def _predicted(holes: _Holes, group: int, said: np.ndarray) -> np.ndarray:
    """(N,) of a surface at the holes of a group from what the others say (3, H), NaN where that is none."""
    known = holes.groups != group
    key = group, said[:, known].tobytes()
    if key not in holes.found:
        holes.found[key] = _heights(holes.plan[known], said[:, known], holes.plan[~known])
    return holes.found[key]


def _heights(places: np.ndarray, said: np.ndarray, at: np.ndarray) -> np.ndarray:
    """(N,) of a surface at places (N, 2), from what holes at others say of it (3, K)."""
    equal, low, high = said
    values = equal.copy()
    if not np.isfinite(values).any():
        values = np.where(np.isfinite(low), low, np.nan)  # no contact: as deep as it may be
    for _ in range(_ROUNDS):
        fixed = np.isfinite(values)
        if not fixed.any():
            return np.full(len(at), np.nan)
        made = _kriged(places[fixed], values[fixed], places)
        wrong = ~fixed & ((made < low) | (made > high))
        if not wrong.any():
            break
        values[wrong] = np.clip(made[wrong], low[wrong], np.maximum(high[wrong], low[wrong]))
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
    return interpolate(points, at, method, variogram=straight, neighbours=0, threads=1).z
