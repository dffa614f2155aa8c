# SPDX-License-Identifier: GPL-3.0-or-later
"""Convex polygons as triangles."""

from __future__ import annotations

import numpy as np


def fanned(offsets: np.ndarray, corners: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Polygons as triangles (T, 3) from their first corners, and the polygon (T,) of each."""
    size = np.diff(offsets)
    owner = np.repeat(np.arange(len(size)), np.maximum(size - 2, 0))
    first = offsets[owner]
    at = first + np.arange(len(owner)) - np.repeat(np.cumsum(size - 2) - (size - 2), size - 2) + 1
    return np.column_stack([corners[first], corners[at], corners[at + 1]]), owner
