# SPDX-License-Identifier: GPL-3.0-or-later
"""Rasters: heights on a regular grid, as points."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from ...base.errors import InputRefused
from ...base.mapped_arrays import ROWS_AT_ONCE, JoinPieces, in_memory
from ...settings.crs import MOST_DEGREES

_ON_CELL = 1e-9  # of a cell: a place so near to its middle is there


@dataclass(frozen=True)
class Raster:
    """Heights z (rows, columns) float64, NaN where there are none, the first row that of the file.

    z may be in a file. The height of row r and column c lies at origin + c * across + r * down in plan.
    warnings: sentences. units: of x and y, and of z, as the file names them; "" where it does not.
    """

    z: np.ndarray
    origin: tuple[float, float]
    across: tuple[float, float]
    down: tuple[float, float]
    warnings: list[str] = field(default_factory=list)
    units: tuple[str, str] = ("", "")

    def points(self, file: Path, gather: JoinPieces = in_memory) -> np.ndarray:
        """(P, 3) float64, row after row, those without a height left out.

        Raises InputRefused where none is left.
        """
        points = gather(self._pieces(), np.empty((0, 3)))
        if not len(points):
            raise InputRefused("no cell of the raster has an elevation", file=file)
        return points

    def warned_of_degrees(self) -> Raster:
        """The same with a warning about plan coordinates in degrees, as the file states, where they may be:
        some programs write such a system for lengths."""
        rows, columns = np.array(self.z.shape) - 1
        corners = np.outer([0, columns, 0, columns], self.across) + np.outer([0, 0, rows, rows], self.down)
        if np.abs(corners + self.origin).max() > MOST_DEGREES:
            return self
        text = (
            "its plan coordinates are degrees of longitude and latitude, its elevations are not: "
            "project it (to UTM, say) in a GIS"
        )
        return replace(self, warnings=[text, *self.warnings])

    def heights_at(self, plan: np.ndarray) -> np.ndarray:
        """(N,) heights at places in plan (N, 2): bilinear between the middles of four cells, up to half a
        cell beyond the outermost as there; NaN where a cell that counts has none."""
        (ax, ay), (dx, dy) = self.across, self.down
        x, y = (plan - np.array(self.origin)).T
        area = ax * dy - ay * dx
        heights = np.zeros(len(plan))
        places, low, shares = [], [], []
        for at, count in (
            ((ax * y - ay * x) / area, len(self.z)),
            ((x * dy - y * dx) / area, self.z.shape[1]),
        ):
            # up to rounding
            on = np.where(np.abs(at - np.rint(at)) < _ON_CELL, np.rint(at), at)
            heights[(on < -0.5 - _ON_CELL) | (on > count - 0.5 + _ON_CELL)] = np.nan
            on = np.clip(on, 0, count - 1)
            first = np.minimum(on.astype(np.int64), max(count - 2, 0))
            places.append(count)
            low.append(first)
            shares.append(on - first)
        for i in (0, 1):
            for j in (0, 1):
                weight = np.abs(1 - i - shares[0]) * np.abs(1 - j - shares[1])
                row, column = np.minimum(low[0] + i, places[0] - 1), np.minimum(low[1] + j, places[1] - 1)
                heights += np.where(weight > 0, weight * self.z[row, column], 0.0)
        return heights

    def _pieces(self) -> Iterator[np.ndarray]:
        height, width = self.z.shape
        wide = min(width, ROWS_AT_ONCE)
        high = ROWS_AT_ONCE // wide if wide == width else 1
        for top in range(0, height, high):
            for left in range(0, width, wide):
                z = self.z[top : top + high, left : left + wide]
                rows, columns = np.nonzero(np.isfinite(z))
                points = np.empty((len(rows), 3))
                points[:, 2] = z[rows, columns]
                rows, columns = rows + top, columns + left
                for axis in (0, 1):
                    points[:, axis] = self.origin[axis] + columns * self.across[axis] + rows * self.down[axis]
                yield points


def known_heights(
    pieces: Iterable[np.ndarray], none: Sequence[float], gather: JoinPieces, below: float = np.inf
) -> np.ndarray:
    """All heights, NaN where none is known. none: values that mean this, as do those from `below` on."""

    def known() -> Iterator[np.ndarray]:
        for z in pieces:
            z[z >= below] = np.nan
            yield without_values(z, none)

    return gather(known(), np.empty(0))


def without_values(
    z: np.ndarray, values: Sequence[float], stored: np.dtype | type = np.float64
) -> np.ndarray:
    """Heights with NaN where one of the values stands that mean none.

    What writes such a value and what writes the heights may round it differently: of floating-point heights
    those within a few units in the last place of what was stored are meant.
    """
    for value in values:
        if np.isnan(value):
            continue
        near = 8 * np.finfo(stored).eps * abs(value) if np.issubdtype(stored, np.floating) else 0.0
        # -3.402823e+38 is written for the lowest 32-bit number, -3.40282347e+38
        if stored == np.float32 and abs(value) > 1e38:
            near = 1e-6 * abs(value)
        z[np.abs(z - value) <= near] = np.nan
    return z
