# SPDX-License-Identifier: GPL-3.0-or-later
"""Small faults, surfaces and rock masses for the tests of structures."""

import numpy as np
from realmodel.core.structures.closed_form import nearest_side


def fault_sides(points, vertices, triangles, threads=0, control=None):
    """_native.fault_sides in NumPy."""
    side = nearest_side(np.asarray(points), vertices, triangles)
    return np.where(side == 0, 1, side).astype(np.int8)


def plane_fault(x=5.0, lean=0.0, y=(-5.0, 15.0), z=(-20.0, 20.0), turn=0.0):
    """A plane along y that passes (x, 5, 0) and leans: x grows by `lean` for each unit down; turned about the
    vertical through (x, 5) by `turn` degrees."""
    (y0, y1), (z0, z1) = y, z
    corners = np.array(
        [[-lean * height, at, height] for height, at in ((z0, y0), (z0, y1), (z1, y1), (z1, y0))]
    )
    corners[:, 1] -= 5.0
    cos, sin = np.cos(np.radians(turn)), np.sin(np.radians(turn))
    corners[:, :2] = corners[:, :2] @ np.array([[cos, sin], [-sin, cos]])
    return corners + np.array([x, 5.0, 0.0]), np.array([[0, 1, 2], [0, 2, 3]], np.int32)


SQUARE = np.array([[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [0.0, 10.0]])
