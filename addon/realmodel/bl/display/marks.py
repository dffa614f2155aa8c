# SPDX-License-Identifier: GPL-3.0-or-later
"""Points and lines as small bodies, for renders: a renderer draws faces only."""

import numpy as np

_OCTAHEDRON = np.array([[1, 0, 0], [0, 1, 0], [-1, 0, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]], np.float64)
_FACES = np.array([[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4], [1, 0, 5], [2, 1, 5], [3, 2, 5], [0, 3, 5]])


def points(places, radius):
    """(8 N, 3, 3) float64 triangles: an octahedron around each place, (N, 3)."""
    return (places[:, None, None, :] + radius * _OCTAHEDRON[_FACES]).reshape(-1, 3, 3)


def lines(places, pairs, radius):
    """(6 E, 3, 3) float64 triangles: a three-sided bar along each pair (E, 2) of places (V, 3)."""
    begin, end = places[pairs[:, 0]], places[pairs[:, 1]]
    along = end - begin
    length = np.linalg.norm(along, axis=1)
    begin, end, along = begin[length > 0], end[length > 0], along[length > 0] / length[length > 0, None]
    helper = np.eye(3)[np.abs(along).argmin(axis=1)]
    side = np.cross(along, helper)
    side /= np.linalg.norm(side, axis=1)[:, None]
    other = np.cross(along, side)
    angles = 2 * np.pi * np.arange(3) / 3
    ring = radius * (
        np.cos(angles)[None, :, None] * side[:, None] + np.sin(angles)[None, :, None] * other[:, None]
    )
    near, far = begin[:, None] + ring, end[:, None] + ring
    following = [1, 2, 0]
    first = np.stack([near, near[:, following], far[:, following]], axis=2)
    second = np.stack([near, far[:, following], far], axis=2)
    return np.concatenate([first.reshape(-1, 3, 3), second.reshape(-1, 3, 3)])


def edges(mesh):
    """(E, 2) int32 edges of a mesh."""
    found = np.empty(2 * len(mesh.edges), np.int32)
    mesh.edges.foreach_get("vertices", found)
    return found.reshape(-1, 2)
