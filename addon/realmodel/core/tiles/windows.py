# SPDX-License-Identifier: GPL-3.0-or-later
"""Which points a part of the plan needs, so that each place in it finds the points nearest to it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from .settling import Box

_IN_CELL = 2.0  # points, in the mean
_MOST_CELLS = 1 << 24
_SLACK = 1 + 1e-6  # for rounding


def point_windows(points: np.ndarray, boxes: Sequence[Box], needed: int) -> Iterator[np.ndarray]:
    """Of each box the numbers of the points (P, 2), ascending, among which are the `needed` nearest to any
    place in it, all of one distance, and one more; and the first of all. No two points have one place."""
    if len(points) <= needed + 1 or not len(boxes):
        yield from (np.arange(len(points)) for _ in boxes)
        return
    cells = _Cells(points, boxes)
    order = np.argsort(points[:, 0], kind="stable")
    x = points[order, 0]
    for box in boxes:
        reach = cells.reach(box, needed + 1)
        first, last = np.searchsorted(x, [box[0] - reach, box[2] + reach])
        near = order[first : min(last + 1, len(order))]
        y = points[near, 1]
        yield np.union1d([0], near[(y >= box[1] - reach) & (y <= box[3] + reach)])


class _Cells:
    """How many points are in each cell of a grid over points and boxes."""

    def __init__(self, points: np.ndarray, boxes: Sequence[Box]):
        boxes = np.array(boxes).reshape(-1, 2, 2)
        self._low = np.minimum(points.min(axis=0), boxes[:, 0].min(axis=0))
        size = np.maximum(points.max(axis=0), boxes[:, 1].max(axis=0)) - self._low
        cells = min(len(points) / _IN_CELL, _MOST_CELLS)
        self._side = max(float(np.sqrt(size[0] * size[1] / cells)), float(size.max()) / cells) or 1.0
        shape = self._at(self._low + size) + 1
        self._last = shape - 1
        column, row = self._at(points).T
        count = np.bincount(column * shape[1] + row, minlength=shape[0] * shape[1]).reshape(shape)
        self._sum = np.zeros(shape + 1, np.int64)  # of all cells below
        self._sum[1:, 1:] = count.cumsum(axis=0).cumsum(axis=1)

    def _at(self, places: np.ndarray) -> np.ndarray:
        return np.floor((places - self._low) / self._side).astype(np.int64)

    def reach(self, box: Box, needed: int) -> float:
        """How far from a box the `needed` nearest points of places in it may be."""
        low = np.clip(self._at(np.array(box[:2])), 0, self._last)
        high = np.clip(self._at(np.array(box[2:])), 0, self._last)
        column, row = (
            each.ravel()
            for each in np.meshgrid(*(np.arange(a, b + 1) for a, b in zip(low, high, strict=True)))
        )
        ring = 0
        while True:
            left, right = np.maximum(column - ring, 0), np.minimum(column + ring, self._last[0]) + 1
            lower, upper = np.maximum(row - ring, 0), np.minimum(row + ring, self._last[1]) + 1
            table = self._sum
            found = table[right, upper] - table[left, upper] - table[right, lower] + table[left, lower]
            few = found < needed
            if not few.any():
                return (ring + 1) * self._side * np.sqrt(2.0) * _SLACK
            column, row = column[few], row[few]
            ring += 1 + ring // 4
