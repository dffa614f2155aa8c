# SPDX-License-Identifier: GPL-3.0-or-later
"""Connected parts of a graph, in whole-array steps."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np


def connected_parts(count: int, edges: np.ndarray, check: Callable[[], None] | None = None) -> np.ndarray:
    """(count,) int64: for each node the least node that it is connected with, itself included.

    edges: (E, 2) node numbers. Every node that has a smaller neighbour is hung below its smallest one, trees
    are flattened, and edges within a tree dropped, until none is left (Shiloach and Vishkin 1982, with
    the smallest neighbour so that the result does not depend on the order of the edges).
    check() is called between the steps; what it raises passes through.
    """
    parent = np.arange(count, dtype=np.int64)
    low = np.minimum(edges[:, 0], edges[:, 1]).astype(np.int64)
    high = np.maximum(edges[:, 0], edges[:, 1]).astype(np.int64)
    while True:
        if check is not None:
            check()
        apart = low != high
        low, high = low[apart], high[apart]
        if not len(low):
            return parent
        # of all that is assigned to one place, the last stays: the smallest neighbour
        order = np.argsort(-low, kind="stable")
        parent[high[order]] = low[order]
        parent = _flattened(parent)
        low, high = parent[low], parent[high]
        low, high = np.minimum(low, high), np.maximum(low, high)


def _flattened(parent: np.ndarray) -> np.ndarray:
    """Every node hung directly below the root of its tree."""
    while True:
        above = parent[parent]
        if np.array_equal(above, parent):
            return parent
        parent = above
