# SPDX-License-Identifier: GPL-3.0-or-later
"""The block at given points of a model, without its cells."""

from __future__ import annotations

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
