# SPDX-License-Identifier: GPL-3.0-or-later
"""Closed triangles that touch themselves in an edge or a vertex, as a manifold."""

from __future__ import annotations

import numpy as np


def separated(vertices: np.ndarray, triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The vertices (N,) and triangles (T, 3) of a shape in which each edge is between two triangles, and the
    triangles around each vertex are one fan: where a shape touches itself, its vertices are repeated.

    vertices: (V, 3) float64. triangles: (T, 3), numbers of vertices; each edge is used as often one way as
    the other. At an edge that more triangles have, those are neighbors between which the rock lies.
    """
    corners = np.asarray(triangles, np.int64).ravel()
    number = np.arange(len(corners))
    after = number - number % 3 + (number + 1) % 3
    before = number - number % 3 + (number + 2) % 3
    twin = _twins(vertices, corners, after, before)
    fan, following = number, twin[before]  # the next corner around the same vertex
    while True:
        least = np.minimum(fan, fan[following])
        if np.array_equal(least, fan):
            break
        fan, following = least, following[following]
    first, made = np.unique(fan, return_inverse=True)
    return corners[first], made.reshape(-1, 3)


def _twins(vertices: np.ndarray, corners: np.ndarray, after: np.ndarray, before: np.ndarray) -> np.ndarray:
    """(3T,): for the edge that begins at each corner, the corner at which its other side begins."""
    ends = np.column_stack([corners, corners[after]])
    keys = np.sort(ends, axis=1)
    is_forward = ends[:, 0] == keys[:, 0]
    order = np.lexsort((~is_forward, keys[:, 1], keys[:, 0]))
    begins = np.flatnonzero(np.append(True, (np.diff(keys[order], axis=0) != 0).any(axis=1)))
    counts = np.diff(np.append(begins, len(order)))
    twin = np.empty(len(corners), np.int64)
    pairs = order[begins[counts == 2][:, None] + [0, 1]]
    twin[pairs] = pairs[:, ::-1]
    for begin, count in zip(begins[counts != 2].tolist(), counts[counts != 2].tolist(), strict=True):
        around = order[begin : begin + count]
        around = around[
            np.argsort(_angles(vertices, keys[around[0]], corners[before[around]]), kind="stable")
        ]
        _pair(twin, around.tolist(), is_forward)
    return twin


def _angles(vertices: np.ndarray, edge: np.ndarray, opposite: np.ndarray) -> np.ndarray:
    """(N,) the angles around an edge (2,) at which its triangles stand, by their third vertices (N,): growing
    counter-clockwise as seen from the edge's end."""
    begin, end = vertices[edge]
    axis = (end - begin) / np.linalg.norm(end - begin)
    across = np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))])
    arms = vertices[opposite] - begin
    return np.arctan2(arms @ np.cross(axis, across), arms @ across)


def _pair(twin: np.ndarray, around: list[int], is_forward: np.ndarray) -> None:
    """Pairs the sides of one edge, in the order of their angles. Rock lies beyond the angle of a triangle
    that has the edge backward, up to that of the next one that has it forward."""
    backward = [side for side in around if not is_forward[side]]
    if 2 * len(backward) != len(around):
        raise AssertionError("the triangles are not closed")
    waiting: list[int] = []
    paired: set[int] = set()
    for side in (*around, *around):  # twice, for the pair that has the first angle in between
        if side in paired or side in waiting:
            continue
        if not is_forward[side]:
            waiting.append(side)
        elif waiting:
            other = waiting.pop()
            twin[side], twin[other] = other, side
            paired |= {side, other}
