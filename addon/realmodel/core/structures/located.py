# SPDX-License-Identifier: GPL-3.0-or-later
"""In which cell of a finished model points lie."""

from __future__ import annotations

import numpy as np

from ..polygon_mesh import fanned
from .closed_form import PlanGrid, triangles_above

OUTSIDE = -1


class Locator:
    """Locates points in the cells of a model, by winding numbers."""

    def __init__(self, model):
        triangles, face = fanned(model.face_offsets, model.face_vertices)
        corners = model.vertices[triangles]
        plan = corners[:, :, :2]
        flat = (plan == plan[:, [1, 2, 0]]).all(axis=2).any(axis=1)  # two corners above one another
        self.corners, self.cells_of = corners[~flat], model.face_cells[face[~flat]]
        self.grid = PlanGrid(self.corners)
        self.count = len(model.cell_block)

    def cells(self, points: np.ndarray) -> np.ndarray:
        """(N,) the cell that each point (N, 3) lies in, OUTSIDE for none; the first one where rounding made
        cells overlap. Exact for the triangles into which faces are divided; a point on a face is above it."""
        found = np.full(len(points), OUTSIDE, np.int64)
        for rows, above, turn in triangles_above(points, self.corners, self.grid):
            # a face is seen counter-clockwise from outside of its first cell
            keys = rows[:, None] * (self.count + 1) + self.cells_of[above] + 1
            key, number = np.unique(keys, return_inverse=True)
            winding = np.zeros(len(key), np.int64)
            np.add.at(winding, number.reshape(keys.shape), np.column_stack([turn, -turn]))
            row, cell = np.divmod(key[winding > 0], self.count + 1)
            row, first = np.unique(row[cell > 0], return_index=True)
            found[row] = cell[cell > 0][first] - 1
        return found
