# SPDX-License-Identifier: GPL-3.0-or-later
"""The order of units by age, from which lies over which (the law of superposition).

How often a unit lies over another is a graph with weights. The order that contradicts the least weight is
found exactly for groups of up to a dozen units that lie over one another in a circle (dynamic programming
over subsets: Held and Karp 1962; Lawler 1964 for this problem, "linear ordering"), and by moving units for
larger ones.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

import numpy as np

from ..surfaces.age_order import improved
from .logs import Log

_EXACT = 12  # units in a circle
_CLOSE = 2 / 3  # of the holes that say the one: so many that say the other leave a pair undecided
_OF_BORDERS = 1.0  # of what two units have as evidence: the weight of their common border
_NEAREST = 6  # pairs of holes from which heights of two units are compared


@dataclass(frozen=True)
class Evidence:
    """names: of units, sorted. over: (U, U) how many holes have the unit of the row over that of the column,
    by shares where a hole has both. adjacent: (U, U) in how many holes they touch so."""

    names: Sequence[str]
    over: np.ndarray
    adjacent: np.ndarray

    def plus(self, upper: str, lower: str, weight: float) -> None:
        """Adds evidence that a unit is younger than another."""
        self.over[self.names.index(upper), self.names.index(lower)] += weight


@dataclass(frozen=True)
class Alternative:
    """Two units whose order the data do not decide: the one that was taken for younger, and the other.
    reasons: what speaks for it. order: all units with the other order, oldest first."""

    younger: str
    older: str
    reasons: Sequence[str]
    order: Sequence[str]


@dataclass
class UnitOrder:
    """order: names of units, oldest first. alternatives: to pairs that are not decided."""

    order: list[str]
    alternatives: list[Alternative] = field(default_factory=list)

    def rank(self, unit: str) -> int:
        return self.order.index(unit)


def evidence_of(names: Sequence[str], columns: Iterable[Sequence[tuple[str, float]]]) -> Evidence:
    """What columns of units, from above downward with their thicknesses, say."""
    names = sorted(names)
    number = {name: at for at, name in enumerate(names)}
    over, adjacent = np.zeros((2, len(names), len(names)))
    for column in columns:
        both = np.zeros_like(over)
        touch = np.zeros_like(over)
        for at, (upper, thick) in enumerate(column):
            for lower, thickness in column[at + 1 :]:
                both[number[upper], number[lower]] += max(thick, 1e-9) * max(thickness, 1e-9)
            if at + 1 < len(column):
                touch[number[upper], number[column[at + 1][0]]] = 1
        total = both + both.T
        over += np.divide(both, total, out=np.zeros_like(both), where=total > 0)
        adjacent += touch
    np.fill_diagonal(over, 0.0)
    return Evidence(names, over, adjacent)


def find_order(evidence: Evidence, logs: Sequence[Log] = (), near: np.ndarray | None = None) -> UnitOrder:
    """The order that contradicts the evidence least; without it, elevations decide. near: (U, U) how much of
    their borders on a map units share: such units are neighbors in the order, too, as far as the evidence
    allows."""
    names, over = evidence.names, evidence.over
    hints = _Hints(names, logs)
    decides = over > over.T
    reach = _closure(decides)
    undecided = [
        (a, b)
        for a in range(len(names))
        for b in range(a + 1, len(names))
        if (not reach[a, b] and not reach[b, a])
        or (over[a, b] > 0 and min(over[a, b], over[b, a]) >= _CLOSE * max(over[a, b], over[b, a]))
    ]
    soft = np.zeros_like(over)
    for a, b in undecided:
        score = hints.score(a, b)
        soft[a, b], soft[b, a] = max(score, 0.0), max(-score, 0.0)
    least = np.min(np.abs(over - over.T)[over != over.T], initial=1.0)
    weights = over + soft * least / (4.0 * max(len(undecided), 1))
    downward = _linear_order(weights)
    if near is not None:
        downward = _neighbors_near(weights, near, downward)
    rank = {number: place for place, number in enumerate(downward)}
    found = UnitOrder([names[number] for number in reversed(downward)])
    for a, b in sorted(undecided, key=lambda pair: sorted(rank[number] for number in pair)):
        upper, lower = (a, b) if rank[a] < rank[b] else (b, a)
        other = _swapped(decides, downward, upper, lower)
        if other is not None:
            reasons = [*_counted(evidence, upper, lower), *hints.reasons(upper, lower)]
            order = [names[number] for number in reversed(other)]
            found.alternatives.append(Alternative(names[upper], names[lower], reasons, order))
    return found


def _counted(evidence: Evidence, upper: int, lower: int) -> list[str]:
    names = evidence.names
    holes = evidence.over[upper, lower], evidence.over[lower, upper]
    if not any(holes):
        return [f"nothing has both '{names[upper]}' and '{names[lower]}'"]
    return [f"'{names[upper]}' over '{names[lower]}': {holes[0]:.3g} holes or dips; under it: {holes[1]:.3g}"]


def _closure(relation: np.ndarray) -> np.ndarray:
    """Of a relation (U, U) bool, which can be reached from which in any number of steps."""
    reach = relation.copy()
    for middle in range(len(reach)):
        reach |= reach[:, [middle]] & reach[[middle], :]
    return reach


def _linear_order(weights: np.ndarray) -> list[int]:
    """The numbers from the youngest: circles are ordered by themselves, and between them there is no
    contradiction."""
    decides = weights > weights.T
    reach = _closure(decides)
    same = (reach & reach.T) | np.eye(len(weights), dtype=bool)
    groups = {tuple(np.flatnonzero(row).tolist()) for row in same}
    ordered: list[int] = []
    waiting = sorted(groups)
    while waiting:  # the first group that nothing left lies over
        rest = [number for group in waiting for number in group]
        chosen = next(
            group
            for group in waiting
            if not any(decides[number, group].any() for number in rest if number not in group)
        )
        waiting.remove(chosen)
        ordered += _circle(weights, list(chosen))
    return ordered


def _circle(weights: np.ndarray, group: list[int]) -> list[int]:
    if len(group) <= 1:
        return group
    inner = weights[np.ix_(group, group)]
    order = _exact(inner) if len(group) <= _EXACT else _moved(inner)
    return [group[number] for number in order]


def _exact(weights: np.ndarray) -> list[int]:
    """The order from the top with the least weight of contrary evidence."""
    count = len(weights)
    cost = np.full(1 << count, np.inf)
    last = np.zeros(1 << count, int)
    cost[0] = 0.0
    against = np.zeros((1 << count, count))  # (sets, U): by how much the set should lie over the unit
    for number in range(count):
        against[1 << number : 2 << number] = against[: 1 << number] + weights[number]
    for chosen in range(1 << count):
        for number in range(count):
            if chosen >> number & 1:
                continue
            # units that come after `number`, but lie over it
            wrong = weights[:, number].sum() - against[chosen, number]
            extended = chosen | 1 << number
            if cost[chosen] + wrong < cost[extended] - 1e-12:
                cost[extended], last[extended] = cost[chosen] + wrong, number
    order: list[int] = []
    chosen = (1 << count) - 1
    while chosen:
        order.append(int(last[chosen]))
        chosen &= ~(1 << order[-1])
    return order[::-1]


def _moved(weights: np.ndarray) -> list[int]:
    """By the balance of each, then moved."""
    balance = weights.sum(axis=1) - weights.sum(axis=0)
    return improved(weights.T, np.argsort(balance, kind="stable").tolist())[::-1]


def _neighbors_near(weights: np.ndarray, near: np.ndarray, order: list[int]) -> list[int]:
    """The order, changed by turning runs of units around and moving units as long as less contradicts it,
    or is apart although it touches."""
    both = weights + weights.T
    touch = (near + near.T) / 2
    known = (both > 0) & (touch > 0)
    touch = touch * _OF_BORDERS * (float(both[known].mean()) if known.any() else 1.0)

    def cost(candidate: Sequence[int]) -> float:
        at = np.array(candidate)
        apart = np.abs(np.arange(len(at))[:, None] - np.arange(len(at))) - 1
        wrong = np.tril(weights[np.ix_(at, at)], -1).sum()
        return float(wrong + np.triu(touch[np.ix_(at, at)] * apart, 1).sum())

    least = cost(order)
    for _ in range(len(order) ** 2):
        changed = [
            candidate
            for a in range(len(order))
            for b in range(a + 1, len(order))
            for candidate in (
                [*order[:a], *order[a : b + 1][::-1], *order[b + 1 :]],
                [*order[:a], *order[a + 1 : b + 1], order[a], *order[b + 1 :]],
                [*order[:a], order[b], *order[a:b], *order[b + 1 :]],
            )
        ]
        best = min(changed, key=cost, default=order)
        if cost(best) >= least - 1e-9:
            break
        order, least = best, cost(best)
    return order


def _swapped(decides: np.ndarray, downward: Sequence[int], upper: int, lower: int) -> list[int] | None:
    """The order with two units the other way round, as near to the given one as the rest allows; None where
    others decide between them after all."""
    place = {number: at for at, number in enumerate(downward)}
    over = np.zeros_like(decides)
    for a in downward:
        over[a] = [decides[a, b] and place[a] < place[b] for b in range(len(decides))]
    over[upper, lower], over[lower, upper] = False, True
    ordered: list[int] = []
    waiting = list(downward)
    while waiting:
        free = next((b for b in waiting if not any(over[a, b] for a in waiting)), None)
        if free is None:
            return None
        ordered.append(free)
        waiting.remove(free)
    return ordered


class _Hints:
    """What speaks for an order of two units that no hole decides: how high they lie over or under what holes
    of both have, and how thick they are."""

    def __init__(self, names: Sequence[str], logs: Sequence[Log]):
        self._names, self._logs = names, logs
        self._with = [[log for log in logs if any(p.unit == name for p in log.parts)] for name in names]

    def score(self, a: int, b: int) -> float:
        """From -1 to 1: how much speaks for a over b."""
        rises = self._rises(a, b)
        if not len(rises):
            return 0.0
        scale = np.abs(rises).mean()
        return float(np.clip(rises.mean() / scale, -1, 1)) if scale > 0 else 0.0

    def _rises(self, a: int, b: int) -> np.ndarray:
        """By how much a lies higher than b, of the nearest pairs of holes, over what both holes have."""
        firsts, seconds = self._with[a], self._with[b]
        if not firsts or not seconds:
            return np.empty(0)
        plan = [np.array([log.plan for log in logs]) for logs in (firsts, seconds)]
        apart = np.hypot(*(plan[0][:, None] - plan[1][None]).transpose(2, 0, 1)).ravel()
        rises = []
        for pair in np.argsort(apart, kind="stable")[:_NEAREST].tolist():
            first, second = firsts[pair // len(seconds)], seconds[pair % len(seconds)]
            rise = _middle(first, self._names[a]) - _middle(second, self._names[b])
            rises.append(rise - _step(first, second))
        return np.array(rises)

    def reasons(self, upper: int, lower: int) -> list[str]:
        names, rises = self._names, self._rises(upper, lower)
        if not len(rises):
            return ["elevations support neither order"]
        by = float(rises.mean())
        said = []
        if abs(by) <= 1e-6 * (1.0 + np.abs(rises).max()):
            said.append("both lie equally high: elevations support neither order")
        else:
            higher, other = (names[upper], names[lower]) if by > 0 else (names[lower], names[upper])
            said.append(f"'{higher}' lies {abs(by):.3g} higher than '{other}', over what nearby holes share")
        thick = [
            float(np.mean([p.thickness for log in self._with[at] for p in log.parts if p.unit == names[at]]))
            for at in (upper, lower)
        ]
        if min(thick) > 0.5 * max(thick):
            said.append(
                f"they are about as thick ({thick[0]:.3g} and {thick[1]:.3g}): perhaps one bed of two rocks"
            )
        return said


def _middle(log: Log, unit: str) -> float:
    return float(np.mean([part.middle for part in log.parts if part.unit == unit]))


def _step(first: Log, second: Log) -> float:
    """By how much what both holes have lies higher in the first: 0 where they share nothing."""
    tops = {part.unit: float(part.bottom[2]) for part in first.parts[:-1]}
    steps = [tops[part.unit] - float(part.bottom[2]) for part in second.parts[:-1] if part.unit in tops]
    feet = {part.unit: float(part.top[2]) for part in first.parts[1:]}
    steps += [feet[part.unit] - float(part.top[2]) for part in second.parts[1:] if part.unit in feet]
    return float(np.mean(steps)) if steps else 0.0
