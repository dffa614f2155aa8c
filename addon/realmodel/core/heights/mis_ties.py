# SPDX-License-Identifier: GPL-3.0-or-later
"""Mis-ties: positions where two survey lines cross and have different heights of a surface."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..base.algebra import begins_run
from ..base.errors import place_text
from ..base.mapped_arrays import ROWS_AT_ONCE, JoinPieces, MakeZeros, in_memory, in_pieces

# of the height range of all points: beyond this it is a mistake in the data, and interpolation refuses it
LARGEST_SHARE = 0.05
_AT_ONCE = 1 << 18  # points among which those at one place are looked for


def without_mis_ties(
    points: np.ndarray, zeros: MakeZeros = np.zeros, gather: JoinPieces = in_memory
) -> tuple[np.ndarray, str | None]:
    """Points with one height at each position, and a warning (None: nothing was changed).

    points: (P, 3) float64, which may be in a file. Where heights at one position differ by no more than a
    twentieth of the height range of all points, their mean replaces the first of them; larger contradictions
    are left in. zeros, gather: where arrays are kept.
    """
    places = _Places(points, zeros, is_once=False)
    return places.kept(gather), places.warning()


def each_place_once(
    points: np.ndarray, zeros: MakeZeros, gather: JoinPieces
) -> tuple[np.ndarray, str | None, bool]:
    """without_mis_ties, and of points that are equal only the first; whether no two have one place now:
    larger contradictions are left in."""
    places = _Places(points, zeros, is_once=True)
    return places.kept(gather), places.warning(), not places.has_contradictions


class _Places:
    """Selects the points that are left when those at one position are merged. is_once: also those with equal
    heights."""

    def __init__(self, points: np.ndarray, zeros: MakeZeros, is_once: bool):
        self._points = points
        self._keeps = zeros((len(points),), bool)
        self._changed: list[tuple[np.ndarray, np.ndarray]] = []  # numbers and heights
        self._count, self._worst = 0, (0.0, 0.0, 0.0)  # how far apart, and where
        self.has_contradictions = False
        most = LARGEST_SHARE * float(np.ptp(points[:, 2])) if len(points) else 0.0
        for numbers, rows in _by_place(points, zeros):
            self._settle(numbers, rows, most, is_once)

    def _settle(self, numbers: np.ndarray, rows: np.ndarray, most: float, is_once: bool) -> None:
        place, first, apart = _places(rows)
        contradict = apart > most
        tolerated = (apart > 0) & ~contradict
        merged = ~contradict if is_once else tolerated
        keep = ~merged[place]
        keep[first[merged]] = True
        if is_once and contradict.any():
            among = np.flatnonzero(keep)
            keep[among] = False
            keep[among[np.unique(rows[among] + 0.0, axis=0, return_index=True)[1]]] = True
        self._keeps[numbers] = keep
        self.has_contradictions |= bool(contradict.any())
        if not tolerated.any():
            return
        self._count += int(tolerated.sum())
        self._changed.append((numbers[first[tolerated]], _means(rows, place)[tolerated]))
        worst = int(np.where(tolerated, apart, 0.0).argmax())
        x, y = rows[first[worst], :2].tolist()
        self._worst = max(self._worst, (float(apart[worst]), -x, -y))  # of equals the first from the west

    def kept(self, gather: JoinPieces) -> np.ndarray:
        """The points themselves where all are left as they are."""
        if not self._changed and all(piece.all() for piece in in_pieces(self._keeps)):
            return self._points
        return gather(self._pieces(), np.empty((0, self._points.shape[1])))

    def _pieces(self) -> Iterator[np.ndarray]:
        numbers = np.concatenate([np.empty(0, np.int64), *(part for part, _ in self._changed)])
        heights = np.concatenate([np.empty(0), *(part for _, part in self._changed)])
        order = np.argsort(numbers)
        numbers, heights = numbers[order], heights[order]
        for begin in range(0, len(self._points), ROWS_AT_ONCE):
            piece = np.array(self._points[begin : begin + ROWS_AT_ONCE])
            first, last = np.searchsorted(numbers, [begin, begin + len(piece)])
            piece[numbers[first:last] - begin, 2] = heights[first:last]
            yield piece[self._keeps[begin : begin + len(piece)]]

    def warning(self) -> str | None:
        if not self._count:
            return None
        apart, x, y = self._worst
        places = "1 position has" if self._count == 1 else f"{self._count} positions have"
        most = f"up to {apart:.6g} apart (at {place_text((-x, -y))})"
        return f"{places} several heights, {most}: their mean is used"


def _by_place(points: np.ndarray, zeros: MakeZeros) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Numbers of points, ascending, and the points, so that all at one place come together: all at once, or
    sorted by what their coordinates are mixed to."""
    if len(points) <= _AT_ONCE:
        yield np.arange(len(points)), np.asarray(points)
        return
    groups = -(-2 * len(points) // _AT_ONCE)
    ends = np.zeros(groups + 1, np.int64)
    for piece in in_pieces(points):
        ends[1:] += np.bincount(_mixed(piece, groups), minlength=groups)
    ends = np.cumsum(ends)
    rows, numbers, at, begin = (
        zeros(points.shape, float),
        zeros((len(points),), np.int64),
        ends[:-1].copy(),
        0,
    )
    for piece in in_pieces(points):
        group = _mixed(piece, groups)
        order = np.argsort(group, kind="stable")
        count = np.bincount(group, minlength=groups)
        to = np.arange(len(piece)) + np.repeat(at - (np.cumsum(count) - count), count)
        rows[to], numbers[to] = piece[order], order + begin
        at += count
        begin += len(piece)
    for first, last in zip(ends[:-1].tolist(), ends[1:].tolist(), strict=True):
        yield np.array(numbers[first:last]), np.array(rows[first:last])


def _mixed(points: np.ndarray, groups: int) -> np.ndarray:
    """(P,) numbers below `groups`, equal for points at one place."""
    x, y = (np.ascontiguousarray(points[:, axis] + 0.0).view(np.uint64) for axis in (0, 1))  # no -0
    mixed = (x * np.uint64(0x9E3779B97F4A7C15)) ^ (y * np.uint64(0xC2B2AE3D27D4EB4F) + np.uint64(1))
    mixed ^= mixed >> np.uint64(29)
    mixed *= np.uint64(0xBF58476D1CE4E5B9)
    return ((mixed >> np.uint64(32)) * np.uint64(groups) >> np.uint64(32)).astype(np.int64)


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
