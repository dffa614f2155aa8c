# SPDX-License-Identifier: GPL-3.0-or-later
"""Rasters: heights on a regular grid, as points."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from ..errors import InputRefused


@dataclass(frozen=True)
class Raster:
    """Heights z (rows, columns) float64, NaN where there are none, the first row that of the file.

    The height of row r and column c lies at origin + c * across + r * down in plan. warnings: sentences.
    """

    z: np.ndarray
    origin: tuple[float, float]
    across: tuple[float, float]
    down: tuple[float, float]
    warnings: list[str] = field(default_factory=list)

    def points(self, file: Path) -> np.ndarray:
        """(P, 3) float64, row after row, those without a height left out.

        Raises InputRefused where none is left.
        """
        rows, columns = np.nonzero(np.isfinite(self.z))
        if not len(rows):
            raise InputRefused("no cell of the raster has a height", file=file)
        points = np.empty((len(rows), 3))
        for axis in (0, 1):
            points[:, axis] = self.origin[axis] + columns * self.across[axis] + rows * self.down[axis]
        points[:, 2] = self.z[rows, columns]
        return points


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
