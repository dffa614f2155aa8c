# SPDX-License-Identifier: GPL-3.0-or-later
"""A mesh divided where it passes from one bed to another, so that each triangle is of one bed."""

from __future__ import annotations

import numpy as np

from ..base.algebra import dot
from ..base.triangles import edge_numbers, edges_of
from .beds import Beds

Mesh = tuple[np.ndarray, np.ndarray]

_MOST_ROUNDS = 12  # an edge passes through a bed in each
_ENDS = 0.04  # of an edge: a boundary this near to its end passes through the end
_LEAST = 1e-9  # of the size of the beds' box: the same, for edges that lie in a boundary but for rounding


def divided_at_beds(vertices: np.ndarray, triangles: np.ndarray, beds: Beds) -> Mesh:
    """A mesh, vertices (V, 3) and triangles (T, 3), with a vertex where an edge passes from one bed to
    another; the given vertices come first. Edges stay straight, so closed meshes stay closed."""
    whole = []  # triangles without a split edge: as edges do not change, they stay so
    for _ in range(_MOST_ROUNDS):
        edges = edges_of(triangles)
        numbers, of_edge = np.unique(edge_numbers(edges, len(vertices)), return_inverse=True)
        first = np.empty(len(numbers), np.int64)
        first[of_edge] = np.arange(len(of_edge))
        ends = np.sort(edges[first], axis=1)
        share = _shares(vertices[ends[:, 0]], vertices[ends[:, 1]], beds)
        is_split = np.isfinite(share)
        if not is_split.any():
            break
        chosen = ends[is_split]
        places = vertices[chosen[:, 0]]
        places = places + share[is_split, None] * (vertices[chosen[:, 1]] - places)
        middle = np.full(len(numbers), -1)
        middle[is_split] = len(vertices) + np.arange(len(chosen))
        middles = middle[of_edge].reshape(3, -1).T
        is_whole = (middles < 0).all(axis=1)
        whole.append(triangles[is_whole])
        triangles = _split(triangles[~is_whole], middles[~is_whole])
        vertices = np.concatenate([vertices, places])
    return vertices, np.concatenate([*whole, triangles]).astype(np.int32)


def _shares(a: np.ndarray, b: np.ndarray, beds: Beds) -> np.ndarray:
    """(E,) where edges from a to b (E, 3) pass into another strip between faults, through the unconformity,
    or else through a boundary between beds: a share of their length; NaN where they do not."""
    share = np.full(len(a), np.nan)
    across, height = [], []
    strips = beds.strips(beds.upright(0.5 * (a + b))[:, :2])  # an end on a fault may be of the other strip
    for points in (a, b):
        plan = beds.upright(points)[:, :2]
        across.append(dot(plan - beds.middle, beds.fault[0]))
        height.append(points[:, 2] - beds.datum(plan, strips))
    is_covered = np.minimum(a[:, 2], b[:, 2]) >= beds.floor
    least = _LEAST * float((beds.high - beds.low).max())
    for levels, (begin, end), chosen in (
        (beds.fault[1], across, True),
        (np.array([beds.floor]), (a[:, 2], b[:, 2]), True),
        (beds.levels, height, ~is_covered),
        (beds.covers, (a[:, 2], b[:, 2]), is_covered),
    ):
        margin = _ENDS * np.abs(end - begin) + least
        low, high = np.minimum(begin, end) + margin, np.maximum(begin, end) - margin
        level = np.append(levels, np.inf)[np.searchsorted(levels, low)]
        rows = np.flatnonzero((level < high) & np.isnan(share) & chosen)
        share[rows] = (level[rows] - begin[rows]) / (end[rows] - begin[rows])
    return share


def _split(triangles: np.ndarray, middles: np.ndarray) -> np.ndarray:
    """Triangles (T, 3) divided at new vertices in their edges. middles: (T, 3) of those from corners 0 to 1,
    1 to 2 and 2 to 0; -1: none."""
    made = []
    for corner in range(3):
        order = np.roll(np.arange(3), -corner)
        has = middles[:, order] >= 0  # from the corner on
        a, b, c = triangles[:, order].T
        p, q, r = middles[:, order].T
        one = has[:, 0] & ~has[:, 1] & ~has[:, 2]
        made += [np.stack(part, axis=1)[one] for part in ((a, p, c), (p, b, c))]
        two = has[:, 0] & ~has[:, 1] & has[:, 2]
        made += [np.stack(part, axis=1)[two] for part in ((a, p, r), (p, b, c), (p, c, r))]
    a, b, c = triangles.T
    p, q, r = middles.T
    three = (middles >= 0).all(axis=1)
    made += [np.stack(part, axis=1)[three] for part in ((a, p, r), (p, b, q), (r, q, c), (p, q, r))]
    return np.concatenate(made)
