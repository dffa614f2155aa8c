# SPDX-License-Identifier: GPL-3.0-or-later
"""What files of triangulated surfaces hold, whatever their format."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class TriangleMesh:
    """vertices (V, 3) float64, triangles (T, 3) int32; polygons are fanned from their first corner.

    face_of_triangle (T,): the face of the file that a triangle is of, from 0; None where they are the same.
    """

    vertices: np.ndarray
    triangles: np.ndarray
    face_of_triangle: np.ndarray | None = None
