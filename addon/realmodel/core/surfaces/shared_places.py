# SPDX-License-Identifier: GPL-3.0-or-later
"""Positions in plan at which several surfaces have points, as in wells."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

_SAME = 1e-7  # of the extent in plan: points no farther apart than about this are at the same place
_RASTER = 400  # points, at least, that a raster has


class Places:
    """The points of a surface by their positions in plan; of several at one position the first counts."""

    def __init__(self, points: np.ndarray, corner: tuple[float, float], cell: float):
        column, row = np.zeros((2, len(points)), np.int64)
        if cell > 0:
            column, row = (np.round((points[:, k] - corner[k]) / cell).astype(np.int64) for k in (0, 1))
        self._at, self._numbers = np.unique((column << 32) + row, return_index=True)

    def shared_with(self, other: Places, most: int | None = None) -> tuple[np.ndarray, np.ndarray]:
        """The numbers of the points of this surface and of the other one that share a position, (N,) each.
        most: the number of tested positions; None: all."""
        if len(self._at) > len(other._at):
            return other.shared_with(self, most)[::-1]
        step = 1 if most is None else -(-len(self._at) // most)
        at, numbers = self._at[::step], self._numbers[::step]
        rows = np.minimum(np.searchsorted(other._at, at), len(other._at) - 1)
        same = other._at[rows] == at
        return numbers[same], other._numbers[rows[same]]


def places_of(points: Sequence[np.ndarray]) -> list[Places]:
    """The positions of surfaces, each with points (N, 3), one at least."""
    x, y = (np.concatenate([xyz[:, axis] for xyz in points]) for axis in (0, 1))
    cell = float(max(np.ptp(x), np.ptp(y))) * _SAME
    return [Places(xyz, (x.min(), y.min()), cell) for xyz in points]


def is_raster(points: np.ndarray) -> bool:
    """Whether points (N, 3) fill at least half of the nodes of a grid in x and y."""
    if len(points) < _RASTER:
        return False
    columns, rows = (len(np.unique(points[:, axis])) for axis in (0, 1))
    return columns * rows <= 2 * len(points)
