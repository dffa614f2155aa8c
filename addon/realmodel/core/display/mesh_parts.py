# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes of polygons made of parts of two others, and the sources of their vertices, corners, edges and
polygons."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from ..base.work import native_module
from ..results.booleans import Intersection
from .polygon_mesh import PolygonMesh

_ONWARD = np.array([1, 2, 0])


@dataclass(eq=False)
class Operand:
    """A mesh of polygons, divided into triangles, that takes part in a Boolean.

    vertices: (V, 3) float64. offsets: (F + 1,), where the corners of each polygon begin. corner_vertices,
    corner_edges: (C,), the vertex of each corner, and the edge from it to the next. triangle_corners: (T, 3).
    triangle_polygons: (T,). is_mirrored: the triangles are to be turned around.
    """

    vertices: np.ndarray
    offsets: np.ndarray
    corner_vertices: np.ndarray
    corner_edges: np.ndarray
    triangle_corners: np.ndarray
    triangle_polygons: np.ndarray
    is_mirrored: bool = False
    triangles: np.ndarray = field(init=False)

    def __post_init__(self) -> None:
        if self.is_mirrored:
            self.triangle_corners = np.ascontiguousarray(self.triangle_corners[:, [0, 2, 1]])
        self.triangles = self.corner_vertices[self.triangle_corners].astype(np.int32)


@dataclass(eq=False)
class OperandElements:
    """The elements of a mesh of parts that come from one operand.

    vertices: (N,) vertices of the mesh that lie on the operand; vertex_of: (N, 3), the vertices of the
    operand around each, with vertex_weights (N, 3). edges: (E,) edges of the mesh, parts of the operand's
    edges edge_of (E,). polygons: (P,) polygons of the mesh, parts of the operand's polygons polygon_of (P,).
    corners: (C,) corners of the mesh, between the operand's corners corner_of (C, 3), with corner_weights (C,
    3).
    """

    vertices: np.ndarray
    vertex_of: np.ndarray
    vertex_weights: np.ndarray
    edges: np.ndarray
    edge_of: np.ndarray
    polygons: np.ndarray
    polygon_of: np.ndarray
    corners: np.ndarray
    corner_of: np.ndarray
    corner_weights: np.ndarray


@dataclass(eq=False)
class MeshParts:
    """A mesh of polygons (coordinates in double precision), and its parts from each operand. meeting: (K,)
    the edges between polygons of the two operands."""

    vertices: np.ndarray
    offsets: np.ndarray
    corners: np.ndarray
    edges: np.ndarray
    corner_edges: np.ndarray
    sources: tuple[OperandElements, OperandElements]
    meeting: np.ndarray

    def shape(self, coordinates: np.ndarray) -> PolygonMesh:
        """The mesh with other coordinates, (V, 3) float32."""
        return PolygonMesh(coordinates, self.offsets, self.corners, None, self.edges, self.corner_edges)


class _Triangles(NamedTuple):
    """Triangles (M, 3) of an intersection, and where they come from.

    source: (M,), the operand of each; origin: its triangle there; polygon: its polygon there. weights: (M, 3,
    3), of the corners of the origin at its corners. between: (M, 3), the corners of the operand that it lies
    between. on_edge: (M, 3), the operand's edge that its edges lie on, -1: none. is_whole: (M,), whether its
    polygon was not divided.
    """

    triangles: np.ndarray
    source: np.ndarray
    origin: np.ndarray
    polygon: np.ndarray
    weights: np.ndarray
    between: np.ndarray
    on_edge: np.ndarray
    is_whole: np.ndarray


def _triangles_of(
    intersection: Intersection, rows: np.ndarray, is_turned: np.ndarray, operands: tuple[Operand, Operand]
) -> _Triangles:
    source, origin = intersection.source[rows], intersection.source_triangle[rows]
    count = len(rows)
    polygon, is_whole = np.empty(count, np.int64), np.zeros(count, bool)
    between, on_edge = np.empty((count, 3), np.int64), np.empty((count, 3), np.int64)
    of = _Triangles(
        intersection.triangles[rows],
        source,
        origin,
        polygon,
        np.empty((count, 3, 3)),
        between,
        on_edge,
        is_whole,
    )
    for number, operand in enumerate(operands):
        mask = source == number
        of.weights[mask] = _barycentric(
            intersection.vertices[of.triangles[mask]], operand.vertices[operand.triangles[origin[mask]]]
        )
        polygon[mask] = operand.triangle_polygons[origin[mask]]
        between[mask] = operand.triangle_corners[origin[mask]]
        pieces = np.bincount(
            intersection.source_triangle[intersection.source == number], minlength=len(operand.triangles)
        )
        on_edge[mask] = _edges_of(intersection, number, rows[mask], pieces, of.weights[mask], operand)
        is_whole[mask] = _whole_polygons(operand, origin[mask], pieces, polygon[mask], is_turned[mask])
    return of


def mesh_of_parts(
    found: Intersection,
    rows: np.ndarray,
    is_turned: np.ndarray,
    operands: tuple[Operand, Operand],
    mirror: bool,
) -> MeshParts:
    """The mesh of some triangles of an intersection. Polygons that were not divided are whole again.

    rows: (M,) of the triangles. is_turned: (M,) bool, which are turned around. mirror: all are turned around
    once more. The polygons are in the order of the operands and of their polygons.
    """
    triangles, source, origin, polygon, weights, between, on_edge, is_whole = _triangles_of(
        found, rows, is_turned, operands
    )
    key = np.lexsort((np.arange(len(rows)), polygon, source))
    same = (np.diff(source[key]) == 0) & (np.diff(polygon[key]) == 0) & is_whole[key][1:]
    faces = key[np.append(True, ~same)[: len(key)]]  # of a whole polygon only one triangle stands for it
    turned = is_turned[faces] ^ mirror
    sizes = np.full(len(faces), 3, np.int64)
    for number, operand in enumerate(operands):
        whole_faces = is_whole[faces] & (source[faces] == number)
        sizes[whole_faces] = np.diff(operand.offsets)[polygon[faces[whole_faces]]]
    offsets, corner_face, within, within_edge = _corners_of(sizes, turned)

    row = faces[corner_face]
    small = ~is_whole[row]
    corner_of = np.empty((len(row), 3), np.int64)
    corner_weights = np.zeros((len(row), 3))
    corner_edge = np.empty(len(row), np.int64)
    corners = np.empty(len(row), np.int64)
    corner_of[small] = between[row[small]]
    corner_weights[small] = weights[row[small], within[small]]
    corner_edge[small] = on_edge[row[small], within_edge[small]]
    corners[small] = triangles[row[small], within[small]]
    for number, operand in enumerate(operands):
        large = ~small & (source[row] == number)
        if not large.any():
            continue
        begin = operand.offsets[polygon[row[large]]]
        size = sizes[corner_face[large]]
        at, at_edge = within[large], within_edge[large]
        if operand.is_mirrored:  # its polygons are not turned around, its triangles are
            at, at_edge = (size - at) % size, (size - at_edge - 1) % size
        corner_of[large] = (begin + at)[:, None]
        corner_weights[large, 0] = 1.0
        corner_edge[large] = operand.corner_edges[begin + at_edge]
        whole = (source == number) & is_whole
        vertex = np.full(len(operand.vertices), -1, np.int64)
        nearest = np.argmax(weights[whole], axis=2)
        vertex[np.take_along_axis(operand.triangles[origin[whole]], nearest, axis=1)] = triangles[whole]
        corners[large] = vertex[operand.corner_vertices[begin + at]]

    used, corners = np.unique(corners, return_inverse=True)
    corners = corners.ravel().astype(np.int32)
    offsets = offsets.astype(np.int32)
    edges, edge_of_corner = native_module().polygon_edges(offsets, corners, len(used))

    def source_of(number: int, operand: Operand) -> OperandElements:
        at = np.flatnonzero(source[row] == number)
        vertices, first_at = np.unique(corners[at], return_index=True)
        with_edge = at[corner_edge[at] >= 0]
        own_edges, first_edge = np.unique(edge_of_corner[with_edge], return_index=True)
        own_faces = np.flatnonzero(source[faces] == number)
        return OperandElements(
            vertices,
            operand.corner_vertices[corner_of[at[first_at]]],
            corner_weights[at[first_at]],
            own_edges,
            corner_edge[with_edge[first_edge]],
            own_faces,
            polygon[faces[own_faces]],
            at,
            corner_of[at],
            corner_weights[at],
        )

    one, other = (source_of(number, operand) for number, operand in enumerate(operands))
    meeting = np.intersect1d(edge_of_corner[one.corners], edge_of_corner[other.corners])
    return MeshParts(found.vertices[used], offsets, corners, edges, edge_of_corner, (one, other), meeting)


def _corners_of(sizes: np.ndarray, turned: np.ndarray) -> tuple[np.ndarray, ...]:
    """Of the corners (C,) of faces with so many each, some of which are turned around: offsets (F + 1,), the
    face of each, its number within the face, and that of the edge after it, before the face was turned."""
    offsets = np.concatenate([[0], np.cumsum(sizes)])
    face = np.repeat(np.arange(len(sizes)), sizes)
    within = np.arange(offsets[-1]) - offsets[face]
    within = np.where(turned[face], (sizes[face] - within) % sizes[face], within)
    # where a face is turned around, the edge after a corner is the one before it
    return offsets, face, within, np.where(turned[face], (within - 1) % sizes[face], within)


def interpolated(values: np.ndarray, between: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """Values (N, ...) at corners or vertices, between three of which each place lies: (P, 3) numbers, and
    weights. Whole numbers are rounded, of truth values the half counts, of anything else the nearest."""
    if values.dtype.kind not in "fiub":
        return values[np.take_along_axis(between, weights.argmax(axis=1)[:, None], axis=1)[:, 0]]
    total = np.zeros(())
    for corner in range(3):
        weight = weights[:, corner].reshape(-1, *[1] * (values.ndim - 1))
        corner_values = values[between[:, corner]].astype(np.float64)
        total = total + np.where(weight == 0.0, 0.0, weight * np.where(weight == 0.0, 0.0, corner_values))
    if values.dtype.kind == "b":
        return total >= 0.5
    return (total if values.dtype.kind == "f" else np.rint(total)).astype(values.dtype)


def _barycentric(places: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """(M, 3, 3): the weights [:, i] of the corners of triangles (M, 3, 3) at places [:, i]; at a corner they
    are exactly 1, 0, 0."""
    a, b, c = triangles.transpose(1, 0, 2)
    normal = np.cross(b - a, c - a)
    axis = np.abs(normal).argmax(axis=1)
    plan = np.stack([(axis + 1) % 3, (axis + 2) % 3], axis=1)

    def seen(points: np.ndarray) -> np.ndarray:
        return np.take_along_axis(points, plan, axis=1)

    def area(p: np.ndarray, q: np.ndarray, r: np.ndarray) -> np.ndarray:
        u, v = q - p, r - p
        return u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]

    a, b, c = seen(a), seen(b), seen(c)
    weights = np.empty((len(places), 3, 3))
    for corner in range(3):
        p = seen(places[:, corner])
        parts = np.stack([area(p, b, c), area(p, c, a), area(p, a, b)], axis=1)
        whole = parts.sum(axis=1, keepdims=True)
        share = np.divide(parts, whole, out=np.full_like(parts, 1 / 3), where=whole != 0)
        share = np.clip(share, 0.0, 1.0)
        weights[:, corner] = share / share.sum(axis=1, keepdims=True)
        for k, at in enumerate((a, b, c)):
            weights[(p == at).all(axis=1), corner] = np.eye(3)[k]
    return weights


def _edges_of(
    intersection: Intersection,
    number: int,
    rows: np.ndarray,
    pieces: np.ndarray,
    weights: np.ndarray,
    operand: Operand,
) -> np.ndarray:
    """(M, 3): the edge of the operand on which the edge after each corner of triangles lies, -1 for none.

    An edge of a piece is on the border of the triangle that it is part of where no other piece of it has the
    edge; no distances are compared."""
    on_border = np.ones((len(rows), 3), bool)
    divided = pieces[intersection.source_triangle[rows]] > 1
    if divided.any():
        of_operand = np.flatnonzero(intersection.source == number)
        everything = of_operand[pieces[intersection.source_triangle[of_operand]] > 1]
        corners = intersection.triangles[everything]
        ends = np.sort(np.stack([corners, corners[:, _ONWARD]], axis=2), axis=2)
        origin = np.repeat(intersection.source_triangle[everything], 3)
        keys = np.column_stack([origin, ends.reshape(-1, 2)])
        _, same, count = np.unique(keys, axis=0, return_inverse=True, return_counts=True)
        single = (count[same.ravel()] == 1).reshape(-1, 3)
        on_border[divided] = single[np.searchsorted(everything, rows[divided])]
    beyond = np.maximum(weights, weights[:, _ONWARD]).argmin(
        axis=2
    )  # the corner that the edge is opposite to
    triangle = operand.triangle_corners[intersection.source_triangle[rows]]
    one = np.take_along_axis(triangle, _ONWARD[beyond], axis=1)
    other = np.take_along_axis(triangle, _ONWARD[_ONWARD[beyond]], axis=1)
    following = np.arange(len(operand.corner_vertices)) + 1
    following[operand.offsets[1:] - 1] = operand.offsets[:-1]
    edge = np.where(following[one] == other, operand.corner_edges[one], -1)
    edge = np.where(following[other] == one, operand.corner_edges[other], edge)
    return np.where(on_border, edge, -1)


def _whole_polygons(
    operand: Operand, origin: np.ndarray, pieces: np.ndarray, polygon: np.ndarray, is_turned: np.ndarray
) -> np.ndarray:
    """(M,) bool: the triangles of polygons of more than three corners that are all there, none divided, and
    turned alike."""
    count = len(operand.offsets) - 1
    needed = np.bincount(operand.triangle_polygons, minlength=count)
    undivided = pieces[origin] == 1
    present = np.bincount(polygon[undivided], minlength=count)
    turned = np.bincount(polygon[undivided & is_turned], minlength=count)
    whole = (present == needed) & ((turned == 0) | (turned == needed)) & (np.diff(operand.offsets) > 3)
    return undivided & whole[polygon]
