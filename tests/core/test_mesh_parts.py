# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes made of parts of two others: whole polygons, and what vertices, edges and corners are of these."""

from itertools import pairwise

import numpy as np
import pytest
from realmodel.core import intersect
from realmodel.core.display.polygon_mesh import Operand, interpolated, mesh_of_parts

_QUADS = np.array([(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)])


def cube(at=(0.0, 0.0, 0.0), size=(1.0, 1.0, 1.0), mirrored=False):
    """Six quads, each of two triangles."""
    vertices = np.array([(n & 1, n >> 1 & 1, n >> 2) for n in range(8)], float) * size + at
    ends = np.sort(np.stack([_QUADS, np.roll(_QUADS, -1, axis=1)], axis=2).reshape(-1, 2), axis=1)
    _, edges = np.unique(ends, axis=0, return_inverse=True)
    triangles = (4 * np.arange(6)[:, None] + np.array([0, 1, 2, 0, 2, 3])).reshape(-1, 3)
    polygons = np.repeat(np.arange(6), 2)
    offsets = np.arange(0, 25, 4)
    return Operand(vertices, offsets, _QUADS.ravel(), edges.ravel(), triangles, polygons, mirrored)


def edge_ends(operand, edge):
    corner = int(np.flatnonzero(operand.corner_edges == edge)[0])
    following = corner + 1 if (corner + 1) % 4 else corner - 3
    return operand.vertices[operand.corner_vertices[[corner, following]]]


def made(a, b, operation, mirror=False):
    found = intersect((a.vertices, a.triangles), (b.vertices, b.triangles))
    return mesh_of_parts(found, *found.boundary(operation), (a, b), mirror)


def normals(parts):
    """(F, 3) of the polygons, as long as twice their areas."""
    found = []
    for first, last in zip(parts.offsets[:-1], parts.offsets[1:], strict=True):
        p = parts.vertices[parts.corners[first:last]]
        found.append(sum(np.cross(q - p[0], r - p[0]) for q, r in pairwise(p[1:])))
    return np.array(found)


def volume(parts):
    centers = [
        parts.vertices[parts.corners[first:last]].mean(axis=0)
        for first, last in zip(parts.offsets[:-1], parts.offsets[1:], strict=True)
    ]
    return float(np.einsum("ij,ij->", normals(parts), np.array(centers)) / 6)


OPERANDS = [
    (cube(), cube((0.5, 0.25, 0.3))),
    (cube(), cube((0.5, 0.25, 0.3), mirrored=True)),
    (cube(size=(-1, 1, 1), mirrored=True), cube((-1.5, 0.25, 0.3))),
    (cube(), cube((1.0, 0.0, 0.0))),
    (cube(), cube((3.0, 0.0, 0.0))),
]


@pytest.mark.parametrize("operation", ["union", "difference", "intersection", "reverse_difference"])
@pytest.mark.parametrize("a, b", OPERANDS)
def test_the_mesh_is_the_boundary(a, b, operation):
    found = intersect((a.vertices, a.triangles), (b.vertices, b.triangles))
    vertices, triangles = getattr(found, operation)()
    if not len(triangles):
        return
    parts = made(a, b, operation)
    p = vertices[triangles]
    wanted = np.einsum("ij,ij->", p[:, 0], np.cross(p[:, 1], p[:, 2])) / 6
    assert volume(parts) == pytest.approx(wanted, abs=1e-12)
    assert volume(made(a, b, operation, mirror=True)) == pytest.approx(-wanted, abs=1e-12)
    assert len(np.unique(parts.corners)) == len(parts.vertices)


@pytest.mark.parametrize("mirror", [False, True])
@pytest.mark.parametrize("a, b", OPERANDS)
def test_where_corners_vertices_and_edges_come_from(a, b, mirror):
    parts = made(a, b, "union", mirror)
    following = np.arange(1, len(parts.corners) + 1)
    following[parts.offsets[1:] - 1] = parts.offsets[:-1]
    for source, operand in zip(parts.sources, (a, b), strict=True):
        at = operand.vertices[operand.corner_vertices]
        places = np.einsum("ci,cik->ck", source.corner_weights, at[source.corner_of])
        assert places == pytest.approx(parts.vertices[parts.corners[source.corners]], abs=1e-12)
        places = np.einsum("ci,cik->ck", source.vertex_weights, operand.vertices[source.vertex_of])
        assert places == pytest.approx(parts.vertices[source.vertices], abs=1e-12)
        polygon_of_corner = np.searchsorted(operand.offsets, source.corner_of, side="right") - 1
        face = np.searchsorted(parts.offsets, source.corners, side="right") - 1
        wanted = dict(zip(source.polygons.tolist(), source.polygon_of.tolist(), strict=True))
        assert (polygon_of_corner == np.array([wanted[f] for f in face.tolist()])[:, None]).all()
        lengths = np.zeros(12)
        for edge, origin in zip(source.edges, source.edge_of, strict=True):
            ends, (p, q) = parts.vertices[parts.edges[edge]], edge_ends(operand, origin)
            assert abs(np.cross(ends - p, q - p)).max() < 1e-12, "on the line of the edge"
            lengths[origin] += np.linalg.norm(ends[1] - ends[0])
        assert lengths.max() == pytest.approx(1.0), "some edges of each are outside of the other"
        assert (lengths < 1.0 + 1e-12).all()
    ends = np.sort(np.stack([parts.corners, parts.corners[following]], axis=1), axis=1)
    assert (np.sort(parts.edges[parts.corner_edges], axis=1) == ends).all()


def test_polygons_that_are_not_divided_stay_whole():
    a, b = cube(), cube((0.5, 0.25, 2.0))
    apart = made(a, b, "union")
    assert np.diff(apart.offsets).tolist() == [4] * 12
    assert (apart.vertices[apart.corners[:24]] == a.vertices[a.corner_vertices]).all()
    assert len(apart.meeting) == 0
    inside = made(cube(), cube((0.25, 0.25, 0.5), (0.5, 0.5, 1.0)), "difference")
    assert (
        sorted(np.diff(inside.offsets).tolist()).count(4) == 6
    )  # all but the top, and four walls and a floor
    assert len(inside.meeting) == 8  # the rim, which the diagonals of the walls divide


def test_values_between_corners():
    between, weights = (
        np.array([[0, 1, 2], [0, 1, 2], [2, 2, 2]]),
        np.array([[1, 0, 0], [0.25, 0.5, 0.25], [1, 0, 0]]),
    )
    numbers = np.array([1.0, 3.0, np.nan], np.float32)
    found = interpolated(numbers, between, weights)
    assert found.dtype == np.float32 and found[0] == 1.0 and np.isnan(found[1:]).all(), (
        "no NaN by a weight of 0"
    )
    assert interpolated(np.array([0, 3, 1], np.int32), between, weights).tolist() == [0, 2, 1]
    assert interpolated(np.array([True, True, False]), between, weights).tolist() == [True, True, False]
    assert interpolated(np.array(["a", "b", "c"], object), between, weights).tolist() == ["a", "b", "c"]
    vectors = np.array([[0, 0], [4, 8], [0, 0]], float)
    assert interpolated(vectors, between, weights).tolist() == [[0, 0], [2, 4], [0, 0]]
