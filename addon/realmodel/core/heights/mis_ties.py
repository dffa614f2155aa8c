# SPDX-License-Identifier: GPL-3.0-or-later
"""Mis-ties: positions where two survey lines cross and have different heights of a surface."""

from __future__ import annotations

import numpy as np

from ..base.algebra import begins_run
from ..base.errors import place_text

# of the height range of all points: beyond this it is a mistake in the data, and interpolation refuses it
LARGEST_SHARE = 0.05


def without_mis_ties(points: np.ndarray) -> tuple[np.ndarray, str | None]:
    """Points with one height at each position, and a warning (None: nothing was changed).

    points: (P, 3) float64. Where heights at one position differ by no more than a twentieth of the height
    range of all points, their mean replaces the first of them; larger contradictions are left in.
    """
    place, first, apart = _places(points)
    most = LARGEST_SHARE * float(np.ptp(points[:, 2])) if len(points) else 0.0
    tolerated = (apart > 0) & (apart <= most)
    if not tolerated.any():
        return points, None
    keeps, merged = ~tolerated[place], np.array(points)
    keeps[first[tolerated]] = True
    merged[first[tolerated], 2] = _means(points, place)[tolerated]
    worst = int(np.where(tolerated, apart, 0.0).argmax())  # of equals the first from the west
    count = int(tolerated.sum())
    places = "1 position has" if count == 1 else f"{count} positions have"
    most_apart = f"up to {apart[worst]:.6g} apart (at {place_text(points[first[worst], :2])})"
    return merged[keeps], f"{places} several elevations, {most_apart}: their mean is used"


def shuffled(places: np.ndarray) -> np.ndarray:
    """(P,) the numbers of places (P, 2) in an order that goes to and fro among them, and does not depend on
    their order or on rounding: that of multiples of the golden ratio (a low-discrepancy sequence)."""
    _, place = np.unique(places + 0.0, axis=0, return_inverse=True)
    return np.argsort(place.ravel().astype(np.uint64) * np.uint64(0x9E3779B97F4A7C15), kind="stable")


def first_at_each_place(points: np.ndarray) -> np.ndarray:
    """The first of the points (P, 3) at each place in plan, in their order."""
    _, first = np.unique(points[:, :2] + 0.0, axis=0, return_index=True)
    return np.ascontiguousarray(points[np.sort(first)])


def mean_heights(points: np.ndarray) -> np.ndarray:
    """Points (P, 3) with the mean of the heights at each place: a rough surface where they contradict."""
    return SortedPoints(points).mean_heights()


class SortedPoints:
    """Points (P, 3) in the order of their positions in plan, for means of some of them and then of others."""

    def __init__(self, points: np.ndarray):
        self._order, new = _sorted(points)
        self._points, self._place = points[self._order], np.cumsum(new)

    def mean_heights(self, some: np.ndarray | None = None) -> np.ndarray:
        """As mean_heights of the points of a mask (P,)."""
        chosen = slice(None) if some is None else some[self._order]
        points, place = self._points[chosen], self._place[chosen]
        new = np.diff(place, prepend=0) != 0
        return np.column_stack([points[new, :2], _means(points, np.cumsum(new) - 1)])


def contradictions(points: np.ndarray) -> np.ndarray:
    """(P,) bool: the points that contradict others at their place by more than a mis-tie. points: (P, 3 + K),
    the latter of which places have to have in common."""
    place, _, apart = _places(points)
    if not apart.any():
        return np.zeros(len(points), bool)
    return (apart > LARGEST_SHARE * np.ptp(points[:, 2]))[place]


def heights_apart(points: np.ndarray) -> np.ndarray:
    """(P,) how far the heights at each point's place are apart."""
    place, _, apart = _places(points)
    return apart[place]


def _places(points: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """For each point (P,) its position in plan; for each position its first point, and the range of the
    heights there."""
    order, new = _sorted(points)
    first = order[new]  # the point with the least number: the sort is stable
    place = np.empty(len(points), np.int64)
    place[order] = np.cumsum(new) - 1
    if new.all():
        return place, first, np.zeros(len(first))
    low, high = np.full(len(first), np.inf), np.full(len(first), -np.inf)
    np.minimum.at(low, place, points[:, 2])
    np.maximum.at(high, place, points[:, 2])
    return place, first, high - low


def _sorted(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The order (P,) of points by position, then number; which in it are at another one than that before."""
    keys = np.delete(points, 2, axis=1)
    order = np.lexsort(keys.T[::-1])
    return order, begins_run(keys[order])


def _means(points: np.ndarray, place: np.ndarray) -> np.ndarray:
    return np.bincount(place, weights=points[:, 2]) / np.bincount(place)
