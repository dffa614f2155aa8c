# SPDX-License-Identifier: GPL-3.0-or-later
"""Samples of a model, the centers of cells of a section, a fence, a borehole or a regular grid, and the
probabilities of blocks there."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .sections.section_data import SectionData


@dataclass(frozen=True, eq=False)
class Samples:
    """places: (N, 3), the middles of cells."""

    places: np.ndarray


@dataclass(frozen=True, eq=False)
class SectionSamples(Samples):
    """Cells on a section or a fence, in rows from below. section: of the model. corners: (N, 4, 3) of the
    cells; flat: (N, 4, 2), the same as sections are drawn. columns: cells in a row."""

    section: SectionData
    corners: np.ndarray
    flat: np.ndarray
    columns: int

    @property
    def distance(self) -> np.ndarray:
        """(N,) float64: of the places from the left end of the drawing."""
        return self.flat[:, :, 0].mean(axis=1)


@dataclass(frozen=True, eq=False)
class BoreholeSamples(Samples):
    """Cells of a vertical line, from above. height: of a cell."""

    height: float


@dataclass(frozen=True, eq=False)
class HoleSamples(Samples):
    """Cells along a planned hole, from the collar. depths: (N,) of their middles along it."""

    depths: np.ndarray


@dataclass(frozen=True, eq=False)
class GridSamples(Samples):
    """Cells of a regular grid; x runs fastest, z slowest. As of regular_cells."""

    origin: np.ndarray
    size: np.ndarray
    counts: tuple[int, int, int]


@dataclass(frozen=True, eq=False)
class Probabilities:
    """Probabilities of blocks, whose names are `block_names`, at places. probability: (N, B) float64; the
    rest to 1 is the probability of no block."""

    block_names: list[str]
    probability: np.ndarray

    @property
    def _outside(self) -> np.ndarray:
        return np.maximum(1.0 - self.probability.sum(axis=1), 0.0)

    def entropy(self) -> np.ndarray:
        """(N,) float64, bits: how uncertain the block at each place is; 0 where all realizations agree.
        Outside of all blocks counts as one more (Shannon 1948; Wellmann and Regenauer-Lieb 2012)."""
        every = np.column_stack([self.probability, self._outside])
        shares = np.where(every > 0, every, 1.0)
        return np.abs((shares * np.log2(shares)).sum(axis=1))

    def likeliest(self) -> np.ndarray:
        """(N,) the number of the most probable block; -1 where there is rather none."""
        return np.column_stack([self._outside, self.probability]).argmax(axis=1) - 1

    def colors(self, block_colors: np.ndarray) -> np.ndarray:
        """(N, 3) the mean of the colors of the blocks, block_colors (B, 3) from 0 to 1; white for none."""
        return np.clip(self.probability @ block_colors + self._outside[:, None], 0.0, 1.0)
