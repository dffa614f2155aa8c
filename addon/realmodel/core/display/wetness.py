# SPDX-License-Identifier: GPL-3.0-or-later
"""How wet rock looks, of the shape of its surface alone: low down, and in hollows that face north."""

from __future__ import annotations

import numpy as np

from ..base.algebra import dot, norm
from .box_projection import area_vectors

_HOLLOW = 4.0  # a hollow whose sides rise by a quarter counts in full
_TINY = np.finfo(float).tiny


def wetness(
    places: np.ndarray, offsets: np.ndarray, corners: np.ndarray, edges: np.ndarray, low: float, high: float
) -> np.ndarray:
    """(V,) float32 from 0, dry, to 1, of the vertices (V, 3) of a mesh; y is north. edges: (E, 2). low, high:
    elevations of the lowest and the highest place of all meshes that belong together.

    What is low has the square of the depth below the highest place, as a share. A hollow has the mean slope
    at which neighbors rise above the tangent plane, times 4, at most 1; where it faces south nothing of it
    counts, north all. Of both together: 1 - (1 - low) (1 - hollow)."""
    places = places.astype(np.float64)
    area = np.repeat(area_vectors(places[corners], offsets), np.diff(offsets), axis=0)
    count = len(places)
    normal = np.column_stack([np.bincount(corners, part, count) for part in area.T])
    normal = normal / np.maximum(norm(normal), _TINY)[:, None]
    a, b = edges.T
    way = places[b] - places[a]
    way = way / np.maximum(norm(way), _TINY)[:, None]
    rise = np.bincount(a, dot(way, normal[a]), count) - np.bincount(b, dot(way, normal[b]), count)
    degree = np.bincount(edges.ravel(), minlength=count)
    hollow = np.clip(_HOLLOW * rise / np.maximum(degree, 1), 0.0, 1.0) * (0.5 + 0.5 * normal[:, 1])
    depth = np.clip((high - places[:, 2]) / max(high - low, _TINY), 0.0, 1.0)
    return (1.0 - (1.0 - depth**2) * (1.0 - hollow)).astype(np.float32)
