# SPDX-License-Identifier: GPL-3.0-or-later
"""Where intervals of inclined holes cross the edges of a planar mesh: between these a surface is linear, so
that what holds there and at the ends of an interval holds along it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ...base.triangles import Sheet, edges_of
from ...base.work import native_module
from ...readers.tables.observations import Observations, in_one_interval

# Of the way between two places: a crossing nearer to one of them says nothing new; and by how much it lies in
# the triangle to the left of the edge, as rounding must not put it beside the mesh.
_AT_END, _INSIDE = 1e-9, 2.5e-10


def with_crossings(observations: Observations, mesh: Sheet) -> tuple[Observations, np.ndarray]:
    """Observations with a place more wherever the way from one to the next of an interval that is used
    crosses an edge of a planar mesh in plan; and (N,) bool, those that are given, in their order."""
    return with_places(observations, *_crossings(observations, mesh))


def with_places(
    observations: Observations, end: np.ndarray, share: np.ndarray
) -> tuple[Observations, np.ndarray]:
    """As with_crossings, with K places more of intervals: the row (K,) at the end of the way that each is on,
    and its share of that way, ascending along each."""
    count = len(observations)
    if not len(end):
        return observations, np.ones(count, bool)
    rows = np.concatenate([np.arange(count), end])
    order = np.argsort(np.concatenate([np.arange(count), end - 1 + share]), kind="stable")
    places, depths = observations.places, observations.depths
    begin, left = end - 1, (1.0 - share)
    between = left[:, None] * places[begin] + share[:, None] * places[end]
    joined = replace(
        observations.some(rows[order]),
        places=np.concatenate([places, between])[order],
        depths=np.concatenate([depths, left * depths[begin] + share * depths[end]])[order],
    )
    return joined, order < count


def _crossings(observations: Observations, mesh: Sheet) -> tuple[np.ndarray, np.ndarray]:
    """(K,) the row at the end of the way that each crossing is on, and its share of that way, ascending."""
    plan = observations.places[:, :2]
    rows = np.flatnonzero(in_one_interval(observations, observations.in_use))
    rows = rows[(plan[rows] != plan[rows - 1]).any(axis=1)]
    if not len(rows):
        return rows, np.empty(0)
    nodes, triangles = mesh
    edges = nodes[edges_of(triangles)][:, :, :2]  # with their triangle to the left: inner ones twice
    ways = np.stack([plan[rows - 1], plan[rows]], axis=1)
    near = (edges.min(axis=1) <= ways.max(axis=(0, 1))) & (edges.max(axis=1) >= ways.min(axis=(0, 1)))
    edges = np.ascontiguousarray(edges[near.all(axis=1)])
    if not len(edges):
        return rows[:0], np.empty(0)
    way, edge = native_module().meeting_boxes(ways, edges).T
    (a, b), (p, q) = ways[way].transpose(1, 0, 2), edges[edge].transpose(1, 0, 2)
    before, after = _beside(p, q, a), _beside(p, q, b)
    meets = (_beside(a, b, p) * _beside(a, b, q) <= 0) & (before != after)
    with np.errstate(divide="ignore", invalid="ignore"):
        share = before / (before - after)
    share += np.where(before > after, -_INSIDE, _INSIDE)
    meets &= (share > _AT_END) & (share < 1 - _AT_END)
    way, share = way[meets], share[meets]
    order = np.lexsort((share, way))
    way, share = way[order], share[order]
    new = np.ones(len(way), bool)
    new[1:] = (np.diff(way) != 0) | (np.diff(share) > _AT_END)
    return rows[way[new]], share[new]


def _beside(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> np.ndarray:
    """(K,) how far to the left of the lines from a to b (K, 2) c lies, times their lengths."""
    along, away = b - a, c - a
    return along[:, 0] * away[:, 1] - along[:, 1] * away[:, 0]
