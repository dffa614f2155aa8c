# SPDX-License-Identifier: GPL-3.0-or-later
"""Closed and open triangulated surfaces, (vertices, triangles) each, for the tests of Booleans, and what can
be said of them without intersecting anything."""

from fractions import Fraction

import numpy as np
from stacks import places

SOLIDS = places.REAL_DATA / "solids"

_CUBE = [(0, 2, 1), (1, 2, 3), (4, 5, 6), (5, 7, 6), (0, 1, 4), (1, 5, 4), (2, 6, 3), (3, 6, 7)]
_CUBE += [(0, 4, 2), (2, 4, 6), (1, 3, 5), (3, 7, 5)]


def box(low, high):
    low, high = np.asarray(low, float), np.asarray(high, float)
    corners = np.array([(n & 1, n >> 1 & 1, n >> 2) for n in range(8)])
    return np.where(corners == 1, high, low), np.array(_CUBE, np.int32)


def tetrahedron(corners):
    """Of four points (4, 3), not in one plane; turned outward."""
    corners = np.asarray(corners, float)
    triangles = np.array([(0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)], np.int32)
    return corners, triangles if volume(corners, triangles) > 0 else triangles[:, ::-1].copy()


def torus(n=24, m=12, radius=2.0, tube=0.7):
    """Around the z axis."""
    i, j = (a.ravel() for a in np.meshgrid(np.arange(n), np.arange(m), indexing="ij"))
    u, v = 2 * np.pi * i / n, 2 * np.pi * j / m
    along = radius + tube * np.cos(v)
    vertices = np.column_stack([along * np.cos(u), along * np.sin(u), tube * np.sin(v)])
    onward, beside = (i + 1) % n, (j + 1) % m
    a, b, c, d = i * m + j, onward * m + j, onward * m + beside, i * m + beside
    triangles = np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)])
    return vertices, triangles.astype(np.int32)


def sheet(size=10.0, height=0.0):
    """A level square around the z axis."""
    x = 0.5 * size * np.array([-1, 1, 1, -1])
    y = 0.5 * size * np.array([-1, -1, 1, 1])
    return np.column_stack([x, y, np.full(4, height)]), np.array([(0, 1, 2), (0, 2, 3)], np.int32)


def together(*surfaces):
    """Several surfaces as one."""
    starts = np.cumsum([0, *(len(vertices) for vertices, _ in surfaces)])
    triangles = [t + s for (_, t), s in zip(surfaces, starts, strict=False)]
    return np.concatenate([vertices for vertices, _ in surfaces]), np.concatenate(triangles)


def moved(surface, by=(0.0, 0.0, 0.0), turned=None, scaled=1.0):
    """A surface scaled, turned by a matrix (3, 3), and moved."""
    vertices, triangles = surface
    turned = np.eye(3) if turned is None else turned
    return scaled * vertices @ turned.T + np.asarray(by, float), triangles


def rotation(random):
    """Any rotation matrix, all alike likely."""
    q, r = np.linalg.qr(random.normal(size=(3, 3)))
    q *= np.sign(np.diag(r))
    return q if np.linalg.det(q) > 0 else -q


def volume(vertices, triangles):
    """Inside of a closed surface, counted as often as it is wound around."""
    if not len(triangles):
        return 0.0
    a, b, c = (vertices - vertices[triangles[0, 0]])[triangles].transpose(1, 0, 2)
    return float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6)


def exact_volumes(vertices, triangles):
    """(T,) whole numbers, and the unit that they count: the volume between each triangle and the origin.
    Those of a closed surface add up to its volume, without any rounding."""
    digits, exponents = np.frexp(vertices)
    least = int(exponents.min()) - 53
    whole = (digits * 2.0**53).astype(np.int64).astype(object) << (exponents - 53 - least).astype(object)
    (ax, ay, az), (bx, by, bz), (cx, cy, cz) = whole[triangles].transpose(1, 2, 0)
    six = ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx)
    return six, Fraction(2) ** (3 * least) / 6


def area(vertices, triangles):
    """(T,) of each triangle."""
    a, b, c = vertices[triangles].transpose(1, 0, 2)
    return 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1)


def winding(points, vertices, triangles):
    """(P,) how often a closed surface is wound around each point: the sum of solid angles (van Oosterom and
    Strackee 1983)."""
    a, b, c = (vertices[triangles][None] - points[:, None, None]).transpose(2, 0, 1, 3)
    la, lb, lc = (np.linalg.norm(x, axis=2) for x in (a, b, c))

    def dot(x, y):
        return np.einsum("pti,pti->pt", x, y)

    under = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb
    angles = np.arctan2(dot(a, np.cross(b, c)), under)
    return angles.sum(axis=1) / (2 * np.pi)


def open_edges(triangles):
    """How many edges are not used as often in one direction as in the other."""
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    forward = np.where(edges[:, 0] < edges[:, 1], 1, -1)
    _, edge = np.unique(np.sort(edges, axis=1), axis=0, return_inverse=True)
    return int(np.count_nonzero(np.bincount(edge.ravel(), forward)))
