# SPDX-License-Identifier: GPL-3.0-or-later
"""Which points a part of the plan needs, so that each place in it finds the points nearest to it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from ..base.mapped_arrays import in_pieces
from ..heights.regular_grid import RegularGrid
from .settling import Box

_IN_CELL = 2.0  # points, in the mean
_MOST_CELLS = 1 << 20
_SLACK = 1 + 1e-6  # for rounding


class PointWindows:
    """Of some boxes the points among which are the `needed` nearest to any place in a box, all of one
    distance, and one more; those within `least` of it; those of the cells of `grid` that places in it lie in;
    and the first of all. No two points have one place. wider: so many times as far around the boxes."""

    def __init__(
        self,
        points: np.ndarray,
        boxes: Sequence[Box],
        needed: int,
        grid: RegularGrid | None = None,
        least: float = 0.0,
        wider: float = 1.0,
    ):
        """points: (P, 2 or more), which may be in a file."""
        self._windows = np.array(boxes).reshape(-1, 4)
        if len(points) <= needed + 1:
            self._windows[:] = -np.inf, -np.inf, np.inf, np.inf
        elif len(boxes):
            cells = _Cells(points, boxes)
            reach = np.array([[max(cells.reach(box, needed + 1), least * _SLACK)] for box in boxes])
            self._windows += wider * reach * [-1, -1, 1, 1]
            if grid is not None:
                of_cells = np.array([grid.box_of_cells(box) for box in boxes])
                self._windows[:, :2] = np.minimum(self._windows[:, :2], of_cells[:, :2])
                self._windows[:, 2:] = np.maximum(self._windows[:, 2:], of_cells[:, 2:])

    def window(self, box: int) -> Box:
        """All points in it, its border included, are those of a box."""
        return tuple(self._windows[box].tolist())

    def of(self, piece: np.ndarray, is_first: bool) -> Iterator[tuple[int, np.ndarray]]:
        """The numbers of boxes that have some of a piece of the points, and which, ascending. is_first: the
        first of all is the first of these."""
        order = np.argsort(piece[:, 0], kind="stable")
        x = piece[order, 0]
        begins = np.searchsorted(x, self._windows[:, 0], "left")
        ends = np.searchsorted(x, self._windows[:, 2], "right")
        for box, (_, low, _, high) in enumerate(self._windows):
            near = order[begins[box] : ends[box]]
            y = piece[near, 1]
            near = np.sort(near[(y >= low) & (y <= high)])
            if is_first and (not len(near) or near[0]):
                near = np.append(0, near)
            if len(near):
                yield box, near


class _Cells:
    """How many points are in each cell of a grid over points and boxes."""

    def __init__(self, points: np.ndarray, boxes: Sequence[Box]):
        ends = np.array(boxes).reshape(-1, 2, 2)
        plan = points[:, :2]
        self._low = np.minimum(plan.min(axis=0), ends[:, 0].min(axis=0))
        size = np.maximum(plan.max(axis=0), ends[:, 1].max(axis=0)) - self._low
        cells = min(len(points) / _IN_CELL, _MOST_CELLS)
        self._side = max(float(np.sqrt(size[0] * size[1] / cells)), float(size.max()) / cells) or 1.0
        shape = self._at(self._low + size) + 1
        self._last = shape - 1
        self._sum = np.zeros(shape + 1, np.int64)  # of all cells below
        count = self._sum[1:, 1:]
        for piece in in_pieces(plan):
            column, row = self._at(piece).T
            cell, of_piece = np.unique(column * shape[1] + row, return_counts=True)
            count[np.divmod(cell, shape[1])] += of_piece
        np.cumsum(count, axis=0, out=count)
        np.cumsum(count, axis=1, out=count)

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
