# SPDX-License-Identifier: GPL-3.0-or-later
"""The model origin, which is subtracted from model coordinates before Blender rounds them to float32.

At 5,400,000 m north the spacing of float32 is 0.5 m. Objects therefore have offsets from an origin near the
model, and the scene's custom property `realmodel_origin` has the origin in doubles: object coordinates +
origin = model coordinates.
"""

import math

import numpy as np

KEY = "realmodel_origin"

# Coordinates in plan, or heights, that are nowhere farther from 0 than this many extents of the model keep
# their own zero: float32 then loses three bits at most, and people see the coordinates they know.
FAR = 8.0

TOO_FAR = 100.0  # sizes of a model: coordinates in 32 bits then have steps of a hundred-thousandth of it


def far_from(origin, vertices):
    """The distance of a model with these vertices (V, 3) from its origin, where it is too large; else
    None."""
    if not len(vertices):
        return None
    low, high = vertices.min(axis=0) - origin, vertices.max(axis=0) - origin
    away = float(np.linalg.norm(np.maximum(0.0, np.maximum(low, -high))))
    return away if away > TOO_FAR * float((high - low).max()) else None


def choose_origin(vertices):
    """Origin for a model with these vertices.

    vertices: (V, 3) float64, model units. Returns (3,) float64: in plan and in height 0, or round numbers (a
    power of ten near a tenth of the extent is their step) next to the middle of the model. East and north
    move together: a map coordinate beside an offset is read as two of a kind.
    """
    vertices = np.asarray(vertices, np.float64)
    if not len(vertices):
        return np.zeros(3)
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    extent = float((high - low).max())
    origin = np.zeros(3)
    if extent > 0.0:
        step = 10.0 ** math.floor(math.log10(extent / 5.0))
        far = np.maximum(np.abs(low), np.abs(high)) > FAR * extent
        far[:2] = far[:2].any()
        origin[far] = np.rint((0.5 * (low + high))[far] / step) * step
    return origin


def offsets_from(origin, vertices):
    """(V, 3) float32 offsets of the vertices from the origin; subtracted in doubles."""
    return np.ascontiguousarray(np.asarray(vertices, np.float64) - origin, dtype=np.float32)
