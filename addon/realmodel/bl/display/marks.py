# SPDX-License-Identifier: GPL-3.0-or-later
"""Points and lines as small bodies, for renders: a renderer draws faces only."""

import numpy as np

from ...core.display.polygon_mesh import PolygonMesh

_OCTAHEDRON = np.array([[1, 0, 0], [0, 1, 0], [-1, 0, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]], np.float32)
_FACES = np.array([[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4], [1, 0, 5], [2, 1, 5], [3, 2, 5], [0, 3, 5]])


def points(places, radius, stretch):
    """An octahedron around each place, (N, 3), as a PolygonMesh. stretch: the vertical exaggeration with
    which it is shown as long as wide."""
    body = np.float32(radius) * _OCTAHEDRON / np.array([1.0, 1.0, stretch], np.float32)
    coordinates = (places[:, None].astype(np.float32) + body).reshape(-1, 3)
    return PolygonMesh(coordinates, *_repeated(_FACES, len(places), 6))


def places_of(coordinates):
    """(N, 3): what the coordinates of `points`, (6 N, 3), were made around."""
    corners = coordinates.reshape(-1, len(_OCTAHEDRON), 3)
    return np.column_stack([corners[:, 1, 0], corners[:, 0, 1], corners[:, 0, 2]])


def lines(places, pairs, radius, sides=3):
    """A bar with this number of sides along each pair (E, 2) of places (V, 3), as `points`. Pairs of equal
    places have none."""
    begin, end = places[pairs[:, 0]].astype(np.float64), places[pairs[:, 1]].astype(np.float64)
    along = end - begin
    length = np.linalg.norm(along, axis=1)
    begin, end, along = begin[length > 0], end[length > 0], along[length > 0] / length[length > 0, None]
    helper = np.eye(3)[np.abs(along).argmin(axis=1)]
    side = np.cross(along, helper)
    side /= np.linalg.norm(side, axis=1)[:, None]
    other = np.cross(along, side)
    angles = 2 * np.pi * np.arange(sides) / sides
    ring = radius * (
        np.cos(angles)[None, :, None] * side[:, None] + np.sin(angles)[None, :, None] * other[:, None]
    )
    coordinates = np.concatenate([begin[:, None] + ring, end[:, None] + ring], axis=1)
    coordinates = coordinates.reshape(-1, 3).astype(np.float32)
    return PolygonMesh(coordinates, *_repeated(_around(sides), len(begin), 2 * sides))


def _around(sides):
    """(sides, 4): the faces of a bar."""
    first = np.arange(sides)
    following = (first + 1) % sides
    return np.column_stack([first, following, following + sides, first + sides])


def _repeated(faces, count, vertices):
    """(offsets, corners) int32 of a body repeated this many times."""
    corners = (np.arange(count, dtype=np.int32)[:, None, None] * vertices + faces).astype(np.int32)
    return np.arange(0, corners.size + 1, faces.shape[1], dtype=np.int32), corners.ravel()
