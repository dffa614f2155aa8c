# SPDX-License-Identifier: GPL-3.0-or-later
"""The block at given points of a model, without its cells, and how probable each block is there."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..base.work import run
from ..cells.model_data import ModelData
from ..proof.closed_form import blocks_of_all, closed_forms


def blocks_at(model: ModelData, points: np.ndarray, threads: int = 0) -> np.ndarray:
    """(N,) the number of the block at each point (N, 3); -1 for none.

    By the closed form of docs/dev/geometry.md. Heights of a surface are rounded as its triangles give them: a
    point that lies on it within a rounding may get either side.
    """
    points = np.ascontiguousarray(points, np.float64)
    return run(lambda work: blocks_of_all(work, closed_forms(model), points), threads=threads)


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
