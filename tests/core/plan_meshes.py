# SPDX-License-Identifier: GPL-3.0-or-later
"""What tests ask of a planar mesh, and figures of its quality."""

from dataclasses import dataclass

import numpy as np


def ring_area(ring) -> float:
    x, y = (np.asarray(ring, float) - np.asarray(ring, float)[0]).T
    return 0.5 * abs(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1)))


@dataclass(frozen=True)
class Figures:
    """lengths: (T, 3) of sides; ratios: (T,) mean ratio, 1 where equilateral; least_angle: degrees,
    of angles that are not between two border edges or constraints; six: share of inside vertices with six
    neighbours; centers: (T, 2)."""

    lengths: np.ndarray
    ratios: np.ndarray
    least_angle: float
    six: float
    centers: np.ndarray


def edges_of(triangles) -> np.ndarray:
    """(3 T, 2) directed."""
    return np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])


def _keys(edges, count):
    edges = np.sort(edges, axis=1).astype(np.int64)
    return edges[:, 0] * count + edges[:, 1]


def border_edges(vertices, triangles) -> np.ndarray:
    """(B, 2) directed edges with no triangle on their right."""
    edges = edges_of(triangles)
    keys = _keys(edges, len(vertices))
    _, first, counts = np.unique(keys, return_index=True, return_counts=True)
    assert counts.max() <= 2
    return edges[first[counts == 1]]


def distances_to_segments(places, a, b) -> np.ndarray:
    """(P,) of each place to the nearest of segments a-b (S, 2)."""
    least = np.full(len(places), np.inf)
    for p, q in zip(a, b, strict=True):
        along = np.clip((places - p) @ (q - p) / max(np.dot(q - p, q - p), 1e-300), 0, 1)
        least = np.minimum(least, np.hypot(*(places - p - along[:, None] * (q - p)).T))
    return least


def check_mesh(vertices, triangles, rings, lines=()) -> Figures:
    """Asserts that a mesh is one: counter-clockwise, conforming, its border the rings and nothing else,
    their corners among its vertices, lines covered by edges. Returns its figures."""
    assert vertices.dtype == np.float64 and triangles.dtype == np.int32
    assert len(np.unique(vertices, axis=0)) == len(vertices)
    assert np.array_equal(np.unique(triangles), np.arange(len(vertices)))
    corners = vertices[triangles]
    u, v = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    areas = 0.5 * (u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0])
    assert (areas > 0).all()
    edges = edges_of(triangles)
    assert len(np.unique(edges[:, 0].astype(np.int64) * len(vertices) + edges[:, 1])) == len(edges)

    rings = [np.asarray(ring, float) for ring in rings]
    a = np.concatenate(rings)
    b = np.concatenate([np.roll(ring, -1, axis=0) for ring in rings])
    reach = np.abs(a).max()
    border = border_edges(vertices, triangles)
    for share in (0.0, 0.5):
        places = vertices[border[:, 0]] * (1 - share) + vertices[border[:, 1]] * share
        assert distances_to_segments(places, a, b).max() <= 8e-16 * reach
    length = np.hypot(*(vertices[border[:, 0]] - vertices[border[:, 1]]).T).sum()
    assert np.isclose(length, np.hypot(*(b - a).T).sum(), rtol=1e-9)
    known = {tuple(p) for p in vertices}
    assert all(tuple(corner) in known for corner in a)

    fixed = _keys(border, len(vertices))
    if len(lines):
        p = np.concatenate([np.asarray(line, float)[:-1] for line in lines])
        q = np.concatenate([np.asarray(line, float)[1:] for line in lines])
        ends = vertices[edges]
        near = [distances_to_segments(ends[:, i], p, q) <= 1e-12 * reach for i in (0, 1)]
        near.append(distances_to_segments(ends.mean(axis=1), p, q) <= 1e-12 * reach)
        fixed = np.concatenate([fixed, _keys(edges[np.all(near, axis=0)], len(vertices))])

    sides = np.roll(corners, -1, axis=1) - corners
    lengths = np.hypot(sides[..., 0], sides[..., 1])
    before = np.roll(lengths, 1, axis=1)
    angles = np.degrees(np.arcsin(np.clip(2 * areas[:, None] / (lengths * before), 0, 1)))
    given = np.isin(_keys(edges, len(vertices)), fixed).reshape(3, -1).T
    free = ~(given & np.roll(given, 1, axis=1))
    inside = np.ones(len(vertices), bool)
    inside[np.unique(border)] = False
    valence = np.bincount(np.unique(_keys(edges, len(vertices))) // len(vertices), minlength=len(vertices))
    valence += np.bincount(np.unique(_keys(edges, len(vertices))) % len(vertices), minlength=len(vertices))
    return Figures(
        lengths=lengths,
        ratios=4 * np.sqrt(3) * areas / (lengths**2).sum(axis=1),
        least_angle=float(angles[free].min()) if free.any() else 60.0,
        six=float((valence[inside] == 6).mean()) if inside.any() else 1.0,
        centers=corners.mean(axis=1),
    )
