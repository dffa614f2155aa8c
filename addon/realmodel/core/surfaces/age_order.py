# SPDX-License-Identifier: GPL-3.0-or-later
"""The order of surfaces in age, where their points tell it: what lies below is older."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Any

import numpy as np

from ..base.algebra import dot
from ..base.errors import number_list
from ..base.work import native_module, on_threads
from .shared_places import places_of

_MOST_SHARED = 5000  # places at which two surfaces are compared
_ASKED, _NEAR = 200, 1000  # points that look for the nearest one of another surface, and among how many
_LEAST_SPREAD = 1e-9  # of the points' spread, added so that points on a line give no slope across it
_NO_GAIN = 1e-9  # of weights that are no whole numbers: rounding
_WHOLE = 1000  # weight of a shared place; so much weighs a whole comparison of surfaces that share none


@dataclass(frozen=True)
class AgeOrder:
    """order: numbers of the surfaces, oldest first. places: at how many shared places two of them have
    different heights, counted for each pair. against: {(older, younger): count} of those where the older one
    lies higher, by numbers."""

    order: tuple[int, ...]
    places: int
    against: Mapping[tuple[int, int], int]

    def warning(self, names: Sequence[str]) -> str | None:
        """A sentence about the places that contradict the order; None where none does."""
        if not self.against:
            return None
        worst = sorted(self.against.items(), key=lambda entry: -entry[1])
        pairs = [f"'{names[older]}' above '{names[younger]}' at {count}" for (older, younger), count in worst]
        return (
            f"at {sum(self.against.values())} of {self.places} places where two surfaces have points, the "
            f"older one lies above the younger one: {number_list(pairs, 3)}; check the order, and these "
            "points"
        )


def age_order(
    names: Sequence[str],
    points: Sequence[np.ndarray | None],
    holes: Mapping[str, tuple] | None = None,
) -> AgeOrder:
    """The order that the fewest pairs of points at shared places contradict.

    points: of each surface (N, 3), or None: a surface without points keeps its place in the list. holes: the
    picks of boreholes (readers.Picks.holes), for pairs of surfaces that are met in the same ones; other pairs
    are compared where their points have the same x and y. Pairs that share no place are compared at the
    nearest points, without the dip that all have in common; this counts less than any shared place. What
    remains open follows the names, numbers in them by value, in the direction that fits the points better.
    """
    numbers = [n for n, xyz in enumerate(points) if xyz is not None and len(xyz)]
    point_sets = [np.asarray(points[n], np.float64)[:, :3] for n in numbers]
    below, shared = _compared([names[n] for n in numbers], point_sets, holes or {})
    order = _fewest_against(below, sorted(range(len(numbers)), key=lambda k: _natural(names[numbers[k]])))
    surface_order = list(range(len(names)))
    for slot, k in zip(numbers, order, strict=True):
        surface_order[slot] = numbers[k]
    against = {
        (numbers[older], numbers[younger]): int(shared[younger, older])
        for older, younger in combinations(order, 2)
        if shared[younger, older]
    }
    return AgeOrder(tuple(surface_order), int(shared.sum()), against)


def _natural(name: str) -> tuple:
    """A key that sorts the numbers in names by their values."""
    parts = re.split(r"(\d+)", name.casefold())
    return (
        *((text, int(number)) for text, number in zip(parts[::2], [*parts[1::2], "0"], strict=True)),
        name,
    )


def _compared(names: Sequence[str], points: list[np.ndarray], holes: Any) -> tuple[np.ndarray, np.ndarray]:
    """(n, n) twice: the weight of what speaks for surface i below surface j, and at how many shared places it
    is."""
    count = len(points)
    shared = _in_holes(names, holes)
    below = np.zeros((count, count), np.int64)
    if count > 1:
        places = places_of(points)
        level = _without_common_slope([xyz[:: -(-len(xyz) // _NEAR)] for xyz in points])
    for i, j in combinations(range(count), 2):
        if not (shared[i, j] or shared[j, i]):
            first, second = places[i].shared_with(places[j], _MOST_SHARED)
            difference = points[i][first, 2] - points[j][second, 2]
            shared[i, j], shared[j, i] = (difference < 0).sum(), (difference > 0).sum()
        below[i, j], below[j, i] = _WHOLE * shared[i, j], _WHOLE * shared[j, i]
        if not (shared[i, j] or shared[j, i]):
            below[i, j], below[j, i] = _at_nearest(level[i], level[j])
    return below, shared


def _in_holes(names: Sequence[str], holes: Any) -> np.ndarray:
    """(n, n) int64: in how many holes surface i is met below surface j."""
    number = {name: k for k, name in enumerate(names)}
    counts = np.zeros((len(names), len(names)), np.int64)
    for _, picks in holes.values():
        met = [(number[name], place[2]) for name, place in picks if name in number]
        for (i, z), (j, other) in combinations(met, 2):
            if z != other and i != j:
                counts[(i, j) if z < other else (j, i)] += 1
    return counts


def _without_common_slope(points: list[np.ndarray]) -> list[np.ndarray]:
    """The points less the slope in x and y that fits all surfaces best, each at its own height."""
    x, y, z = np.concatenate([xyz - xyz.mean(axis=0) for xyz in points]).T
    extra = _LEAST_SPREAD * (dot(x, x) + dot(y, y))
    xx, yy, xy = dot(x, x) + extra, dot(y, y) + extra, dot(x, y)
    determinant = xx * yy - xy * xy
    if not determinant > 0:  # all at one place
        return points
    slope = np.array([yy * dot(x, z) - xy * dot(y, z), xx * dot(y, z) - xy * dot(x, z)]) / determinant
    return [np.column_stack([xyz[:, :2], xyz[:, 2] - dot(xyz[:, :2], slope)]) for xyz in points]


def _at_nearest(first: np.ndarray, second: np.ndarray) -> tuple[int, int]:
    """Weights, together _WHOLE at most, of points that lie below and above the nearest one of the other
    surface."""
    lower = higher = total = 0
    for points, other, sign in ((first, second, 1), (second, first, -1)):
        asked = points[:: -(-len(points) // _ASKED)]
        nearest = native_module().nearest_points(other[:, :2], asked[:, :2], execution=on_threads(1))[0][:, 0]
        difference = sign * (asked[:, 2] - other[nearest, 2])
        lower += int((difference < 0).sum())
        higher += int((difference > 0).sum())
        total += len(asked)
    return _WHOLE * lower // total, _WHOLE * higher // total


def _fewest_against(below: np.ndarray, by_name: list[int]) -> list[int]:
    """The order, oldest first, with the least weight against it that single surfaces moved to another place
    find; from the order of the names in its better direction, or from that of the wins where it is better."""
    starts = sorted([by_name, by_name[::-1]], key=lambda order: _against(below, order))[:1]
    wins = (below > below.T).sum(axis=1)
    starts.append(sorted(starts[0], key=lambda k: -wins[k]))
    return min((improved(below, order) for order in starts), key=lambda order: _against(below, order))


def _against(below: np.ndarray, order: Sequence[int]) -> int:
    at = np.asarray(order, int)
    return int(np.tril(below[np.ix_(at, at)], -1).sum())


def improved(below: np.ndarray, order: list[int]) -> list[int]:
    """The order, oldest first, after moves of single surfaces, as long as one lessens the weight against it.
    below: (n, n) the weight of what speaks for surface i below surface j."""
    order = list(order)
    while True:
        gain, move = 0, (0, 0)
        for begin, moved in enumerate(order):
            others = order[:begin] + order[begin + 1 :]
            # Each step up passes one surface: what spoke for the one below is against it then.
            steps = [below[other, moved] - below[moved, other] for other in others]
            height = np.concatenate([[0], np.cumsum(steps)])
            best = int(height.argmax())
            if height[best] - height[begin] > gain + _NO_GAIN:
                gain, move = height[best] - height[begin], (begin, best)
        if gain == 0:
            return order
        order.insert(move[1], order.pop(move[0]))
