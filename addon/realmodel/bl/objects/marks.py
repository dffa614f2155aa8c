# SPDX-License-Identifier: GPL-3.0-or-later
"""Points, lines and planes as small bodies, for renders: a renderer draws faces only."""

import numpy as np
from mathutils.kdtree import KDTree

from ...core.display.polygon_mesh import PolygonMesh

_RADIUS, _LEAST_RADIUS = 0.007, 0.0015  # of the size of all, at most and at least
_APART = 0.1  # of the points may lie so close that their bodies overlap
_ASKED = 2000  # points at most whose distance to the nearest other is looked at
_DISC_SIDES = 16
_THICK, _NORMAL, _NORMAL_RADIUS = 0.02, 0.5, 0.05  # of a disc's radius: between its sides, its normal

_OCTAHEDRON = np.array([[1, 0, 0], [0, 1, 0], [-1, 0, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]], np.float32)
_FACES = np.array([[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4], [1, 0, 5], [2, 1, 5], [3, 2, 5], [0, 3, 5]])


def points(places, radius, stretch):
    """An octahedron around each place, (N, 3), as a PolygonMesh. stretch: the vertical exaggeration with
    which it is shown as long as wide."""
    body = np.float32(radius) * _OCTAHEDRON / np.array([1.0, 1.0, stretch], np.float32)
    coordinates = (places[:, None].astype(np.float32) + body).reshape(-1, 3)
    return PolygonMesh(coordinates, *_repeated(_FACES, len(places), 6))


def spaced_points(places, size, stretch):
    """`points` that are as large as their places (N, 3) allow, if most are not to overlap with the vertical
    exaggeration `stretch`. size: of all that is shown."""
    shown = places * (1.0, 1.0, stretch)
    tree = KDTree(len(shown))
    for number, place in enumerate(shown.tolist()):
        tree.insert(place, number)
    tree.balance()
    asked = shown[:: -(-len(shown) // _ASKED)].tolist()
    nearest = [tree.find_n(place, 2)[-1][2] for place in asked]
    least, most = _LEAST_RADIUS * size, _RADIUS * size
    apart = float(np.quantile(nearest, _APART)) if len(shown) > 1 else most
    return points(places, np.clip(0.5 * apart, least, most), stretch)


def discs(places, normals, radius, stretch):
    """A disc at each place (N, 3) across its normal (N, 3), of any length, with a short line along that, as a
    PolygonMesh: of each disc its side toward the normal, its other side, and the faces of the line. They are
    round, and the line is normal, with the vertical exaggeration `stretch`."""
    normals = normals * (stretch, stretch, 1.0)
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    helper = np.eye(3)[np.abs(normals).argmin(axis=1)]
    side = np.cross(normals, helper)
    side /= np.linalg.norm(side, axis=1)[:, None]
    other = np.cross(normals, side)
    angles = 2 * np.pi * np.arange(_DISC_SIDES) / _DISC_SIDES
    ring = np.cos(angles)[None, :, None] * side[:, None] + np.sin(angles)[None, :, None] * other[:, None]
    flat = (1.0, 1.0, 1.0 / stretch)
    centers = places * (1.0, 1.0, stretch)
    apart = 0.5 * _THICK * radius * normals
    upper, lower = ((centers + shift)[:, None] + radius * ring for shift in (apart, -apart))
    ends = np.stack([centers, centers + _NORMAL * radius * normals], axis=1).reshape(-1, 3)
    bars = lines(ends, np.arange(len(ends)).reshape(-1, 2), _NORMAL_RADIUS * radius)
    bar = bars.coordinates.reshape(len(places), -1, 3)
    coordinates = np.concatenate([upper, lower[:, ::-1], bar], axis=1) * flat
    first = np.arange(_DISC_SIDES)
    faces = [first, first + _DISC_SIDES, *(_around(3) + 2 * _DISC_SIDES)]
    count, vertices = len(places), coordinates.shape[1]
    corners = np.arange(count, dtype=np.int32)[:, None] * vertices + np.concatenate(faces)
    sizes = np.tile([len(face) for face in faces], count)
    offsets = np.concatenate([[0], np.cumsum(sizes)]).astype(np.int32)
    return PolygonMesh(
        coordinates.reshape(-1, 3).astype(np.float32), offsets, corners.ravel().astype(np.int32)
    )


DISC_FACES = 5  # of a disc: its sides, and the three faces of its normal


def places_of(coordinates):
    """(N, 3): what the coordinates of `points`, (6 N, 3), were made around."""
    corners = coordinates.reshape(-1, len(_OCTAHEDRON), 3)
    return np.column_stack([corners[:, 1, 0], corners[:, 0, 1], corners[:, 0, 2]])


def lines(places, pairs, radius, sides=3):
    """A bar with this number of sides along each pair (E, 2) of places (V, 3), as `points`. radius: of all
    bars, or (E,) of each. Pairs of equal places have none."""
    begin, end = places[pairs[:, 0]].astype(np.float64), places[pairs[:, 1]].astype(np.float64)
    along = end - begin
    length = np.linalg.norm(along, axis=1)
    begin, end, along = begin[length > 0], end[length > 0], along[length > 0] / length[length > 0, None]
    helper = np.eye(3)[np.abs(along).argmin(axis=1)]
    side = np.cross(along, helper)
    side /= np.linalg.norm(side, axis=1)[:, None]
    other = np.cross(along, side)
    angles = 2 * np.pi * np.arange(sides) / sides
    radius = np.broadcast_to(radius, len(length))[length > 0]
    ring = radius[:, None, None] * (
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
