# SPDX-License-Identifier: GPL-3.0-or-later
"""Blocks and cells of a model as meshes of polygons with all their edges, for display and export."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from ..base.triangles import fanned
from ..base.work import Cancel, Work, native_module, run
from ..cells.model_data import ModelData
from ..results.booleans import Intersection
from .bedding import Bedding, SeriesLayer, bedding_of, seen_from_below
from .fine_polygons import fine_polygons


@dataclass(frozen=True, eq=False)
class PolygonMesh:
    """A mesh of polygons.

    coordinates: (V, 3) float32. offsets: (F + 1,) int32, where the corners of each polygon begin, and where
    the last end. corners: (C,) int32, vertex numbers, counter-clockwise seen from outside. face_surface:
    (F,) int32, the global index of the surface that each polygon lies on (-1 a wall, -2 the flat base), or
    None. edges: (E, 2) int32, each once, and corner_edges: (C,) int32, for each corner the edge from it to
    the next; both None where whoever takes the mesh is to find them. smooth: shaded without breaks.
    face_compartment: (F,) int32, the compartment that each polygon bounds, or None for models of one.
    bedding: of blocks, where its corners lie in their layers; None where that is not known.
    """

    coordinates: np.ndarray
    offsets: np.ndarray
    corners: np.ndarray
    face_surface: np.ndarray | None = None
    edges: np.ndarray | None = None
    corner_edges: np.ndarray | None = None
    smooth: bool = False
    face_compartment: np.ndarray | None = None
    bedding: Bedding | None = None

    @property
    def polygons(self) -> int:
        """The number of polygons."""
        return len(self.offsets) - 1


def of_triangles(coordinates: np.ndarray, triangles: np.ndarray, smooth: bool = False) -> PolygonMesh:
    """A mesh of triangles, (T, 3) int32, with its edges."""
    offsets = np.arange(0, 3 * len(triangles) + 1, 3, dtype=np.int32)
    corners = np.ascontiguousarray(triangles, np.int32).reshape(-1)
    edges, corner_edges = native_module().polygon_edges(offsets, corners, len(coordinates))
    return PolygonMesh(coordinates, offsets, corners, None, edges, corner_edges, smooth)


def of_surfaces(model: ModelData, origin: np.ndarray) -> list[PolygonMesh | None]:
    """For each surface of a model, by its global index, the faces that are left of it; None where it is all
    eroded. origin: as for `of_blocks`."""
    order = np.argsort(model.face_surface, kind="stable")
    begin = np.searchsorted(model.face_surface[order], np.arange(len(model.surface_names) + 1))
    meshes: list[PolygonMesh | None] = []
    for first, last in pairwise(begin.tolist()):
        if first == last:
            meshes.append(None)
            continue
        faces = order[first:last]
        # The cell that a face is numbered for lies below it or above; seen from above all turn the same way.
        offsets, corners = model.face_corners(faces, seen_from_below(model, faces))
        used, corners = np.unique(corners, return_inverse=True)
        coordinates = (model.vertices[used] - origin).astype(np.float32)
        offsets, corners = offsets.astype(np.int32), corners.astype(np.int32).ravel()
        edges, corner_edges = native_module().polygon_edges(offsets, corners, len(used))
        meshes.append(PolygonMesh(coordinates, offsets, corners, None, edges, corner_edges))
    return meshes


def of_blocks(
    model: ModelData,
    origin: np.ndarray,
    threads: int = 0,
    cancel: Cancel | None = None,
    compartments: Sequence[str] | None = None,
    vertices: np.ndarray | None = None,
) -> list[PolygonMesh | None]:
    """For each block of a model its closed boundary, all its parts together; None where it has no cells.

    origin: (3,) float64, taken off the coordinates before they are rounded to 32 bits. cancel: as for
    `build`. compartments: names by which face_compartment counts; None: the model's own. Of a stage those of
    the whole model are wanted; what these lack is counted on. vertices: (V, 3) float64, the coordinates of
    the meshes where they are not the model's, such as those in the coordinates of an object.
    Raises Cancelled, BuildFailed.
    """
    other = None if vertices is None else {"vertices": vertices}
    shapes = _shells(model, origin, None, threads, cancel, model.cell_block, len(model.blocks), other)
    numbers = _numbers(model, compartments)
    if numbers is None:
        return [None if shell is None else shell[0] for shell in shapes]
    made: list[PolygonMesh | None] = []
    for block, shell in enumerate(shapes):
        if shell is None:
            made.append(None)
            continue
        shape, faces = shell
        cells = model.face_cells[faces]
        inside = np.append(model.cell_block, np.int32(-1))[cells] == block
        cell = np.where(inside[:, 0], cells[:, 0], cells[:, 1])
        made.append(replace(shape, face_compartment=numbers[model.cell_compartment[cell]]))
    return made


def of_cells(
    model: ModelData,
    origin: np.ndarray,
    shrink: float | None,
    threads: int = 0,
    cancel: Cancel | None = None,
    compartments: Sequence[str] | None = None,
) -> list[PolygonMesh | None]:
    """For each block of a model all its cells, each separately with its own vertices that are drawn toward
    their mean by the factor `shrink`; where that is None the parts of the block in each compartment, each
    closed. Otherwise as `of_blocks`."""
    numbers = _numbers(model, compartments)
    if numbers is None:
        shapes = _shells(model, origin, shrink, threads, cancel, model.cell_block, len(model.blocks))
        return [None if shell is None else shell[0] for shell in shapes]
    count = int(model.cell_compartment.max()) + 1
    label = (model.cell_block * count + model.cell_compartment).astype(np.int32)
    shapes = _shells(model, origin, shrink, threads, cancel, label, len(model.blocks) * count)
    parts = [None if shell is None else shell[0] for shell in shapes]
    return [
        _joined(parts[begin : begin + count], numbers) for begin in range(0, len(model.blocks) * count, count)
    ]


def moved_apart(shape: PolygonMesh, shifts: np.ndarray) -> PolygonMesh:
    """A mesh of `of_cells` with each compartment moved; shifts: (N, 3)."""
    if shape.face_compartment is None:
        return shape
    of_vertex = np.zeros(len(shape.coordinates), np.int32)
    of_vertex[shape.corners] = np.repeat(shape.face_compartment, np.diff(shape.offsets))
    shifts = np.asarray(shifts, np.float32)[np.minimum(of_vertex, len(shifts) - 1)]
    return replace(shape, coordinates=shape.coordinates + shifts)


def _numbers(model: ModelData, names: Sequence[str] | None) -> np.ndarray | None:
    """The numbers by which the compartments of a model are named; None where it has only one."""
    model_names = model.compartment_names
    names = list(model_names if names is None else names)
    if max(len(model_names), len(names)) < 2:
        return None
    names += [name for name in model_names if name not in names]
    return np.array([names.index(name) for name in model_names], np.int32)


def _joined(parts: list[PolygonMesh | None], numbers: np.ndarray) -> PolygonMesh | None:
    """The parts of a block in each compartment as one mesh."""
    pairs = [(part, number) for part, number in zip(parts, numbers, strict=False) if part is not None]
    if not pairs:
        return None
    vertices, edges, corners = 0, 0, 0
    arrays: dict[str, list] = {key: [] for key in ("offsets", "corners", "edges", "corner_edges")}
    for part, _ in pairs:
        assert part.edges is not None and part.corner_edges is not None  # of_cells has made it
        arrays["offsets"].append(part.offsets[:-1] + corners)
        arrays["corners"].append(part.corners + vertices)
        arrays["edges"].append(part.edges + vertices)
        arrays["corner_edges"].append(part.corner_edges + edges)
        vertices, edges = vertices + len(part.coordinates), edges + len(part.edges)
        corners += len(part.corners)
    arrays["offsets"].append(np.array([corners]))
    return PolygonMesh(
        coordinates=np.concatenate([part.coordinates for part, _ in pairs]),
        offsets=np.concatenate(arrays["offsets"]).astype(np.int32),
        corners=np.concatenate(arrays["corners"]).astype(np.int32),
        edges=np.concatenate(arrays["edges"]).astype(np.int32),
        corner_edges=np.concatenate(arrays["corner_edges"]).astype(np.int32),
        face_surface=np.concatenate([part.face_surface for part, _ in pairs]),
        face_compartment=np.concatenate([np.full(part.polygons, number, np.int32) for part, number in pairs]),
        bedding=Bedding.joined([part.bedding for part, _ in pairs]),
    )


def _shells(
    model: ModelData,
    origin: Sequence[float] | np.ndarray,
    shrink: float | None,
    threads: int,
    cancel: Cancel | None,
    label: np.ndarray,
    count: int,
    other: dict[str, Any] | None = None,
) -> list[tuple[PolygonMesh, np.ndarray] | None]:
    """The mesh around the cells of each label, and of each polygon the face of the model. Around layers of
    series, polygons are divided, but of cells by themselves."""

    def task(work: Work) -> tuple[list, tuple[Bedding, dict[int, SeriesLayer]] | None]:
        shells = work.native(
            native_module().complex_shells,
            {**model.native(), "cell_block": label, **(other or {})},
            count,
            tuple(float(value) for value in origin),
            shrink,
        )
        present = [arrays for arrays in shells if arrays is not None]
        if not present or model.lacks_project is not None:
            return shells, None
        faces, is_second = (np.concatenate([arrays[n] for arrays in present]) for n in (3, 4))
        return shells, bedding_of(work, model, faces, is_second)

    shells, bedding_and_layers = run(task, cancel=cancel, threads=threads)
    bedding, layers = bedding_and_layers or (None, {})
    meshes: list[tuple[PolygonMesh, np.ndarray] | None] = []
    corner, polygon = 0, 0
    for arrays in shells:
        if arrays is None:
            meshes.append(None)
            continue
        coordinates, offsets, corners, faces, is_second, edges, corner_edges = arrays
        ends = corner + len(corners), polygon + len(faces)
        shell_bedding = bedding and bedding.part(slice(corner, ends[0]), slice(polygon, ends[1]))
        corner, polygon = ends
        surface = model.face_surface[faces]
        shape = PolygonMesh(
            coordinates, offsets, corners, surface, edges, corner_edges, bedding=shell_bedding
        )
        if layers and shrink is None:
            shape, faces = _with_fine_bedding(model, shape, faces, is_second, layers)
        meshes.append((shape, faces))
    return meshes


def _with_fine_bedding(
    model: ModelData,
    shape: PolygonMesh,
    faces: np.ndarray,
    is_second: np.ndarray,
    layers: dict[int, SeriesLayer],
) -> tuple[PolygonMesh, np.ndarray]:
    """The mesh of a block with more corners where its bedding is not linear between those it has: polygons of
    a layer of a series are divided, but for those on its top and its base. faces, is_second: (F,) of each
    polygon. Returns also the face of the model of each polygon."""
    cells = model.face_cells[faces, is_second.astype(np.int64)]
    surface = model.blocks[int(model.cell_block[cells[0]])].surface
    layer = layers.get(surface)
    if layer is None:
        return shape, faces
    assert shape.bedding is not None and shape.face_surface is not None  # there are layers of series
    positions = np.zeros((len(shape.coordinates), 3))
    positions[shape.corners] = model.vertices[model.face_corners(faces, is_second)[1]]
    begins, longest = shape.offsets[:-1], layer.longest
    extent = [ufunc.reduceat(positions[shape.corners], begins) for ufunc in (np.maximum, np.minimum)]
    chosen = np.square(extent[0] - extent[1]).sum(axis=1) > longest**2
    if layer.has_top:
        chosen &= shape.face_surface != surface
    if layer.has_base:
        chosen &= shape.face_surface != surface - 1
    if not chosen.any():
        return shape, faces
    fine = fine_polygons(positions, shape.offsets, shape.corners, chosen, longest)
    coordinates, polygon = fine.extended(shape.coordinates), fine.polygon
    edges, corner_edges = native_module().polygon_edges(fine.offsets, fine.corners, len(coordinates))
    of_corner = np.repeat(polygon, np.diff(fine.offsets))
    coarse = shape.bedding
    height, thickness, depth = np.ascontiguousarray(
        fine.of_corners(
            shape.offsets, shape.corners, np.column_stack([coarse.height, coarse.thickness, coarse.depth])
        ).T
    )
    asked = np.flatnonzero((fine.corners >= len(positions)) & chosen[of_corner])
    share, is_known = layer.shares(
        fine.extended(positions)[fine.corners[asked]], model.cell_compartment[cells[of_corner[asked]]]
    )
    height[asked[is_known]] = share[is_known]
    bedding = Bedding(height, thickness, depth, coarse.is_top[polygon], coarse.age[polygon])
    made = PolygonMesh(
        coordinates,
        fine.offsets,
        fine.corners,
        shape.face_surface[polygon],
        edges,
        corner_edges,
        bedding=bedding,
    )
    return made, faces[polygon]


_UP, _DOWN = 1, 2


def coarsened(shape: PolygonMesh, size: float) -> PolygonMesh | None:
    """A closed mesh as triangles, of which the vertices over each square of the plan, `size` wide, are one at
    their mean: those of faces that look up, those of faces that look down, those of both and those of walls
    each for themselves, so that thin layers stay. It is closed again; None where nothing is left."""
    at = shape.coordinates.astype(np.float64)
    triangles, faces = fanned(shape.offsets, shape.corners)
    a, b, c = at[triangles, :2].transpose(1, 0, 2)
    turn = (b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]
    turn = np.bincount(faces, turn, shape.polygons)[faces]
    if shape.face_surface is not None:
        turn[shape.face_surface[faces] == -1] = 0.0
    sides = np.zeros(len(at), np.int64)
    for side, seen in ((_UP, turn > 0), (_DOWN, turn < 0)):
        sides[np.unique(triangles[seen])] |= side
    squares = np.floor(at[:, :2] / size).astype(np.int64)
    _, number = np.unique(np.column_stack([squares, sides]), axis=0, return_inverse=True)
    number = number.reshape(-1)
    count = np.bincount(number)
    mean = np.column_stack([np.bincount(number, at[:, axis]) for axis in range(3)]) / count[:, None]
    left = _without_pairs(number[triangles])
    if not len(left):
        return None
    used, left = np.unique(left, return_inverse=True)
    return of_triangles(mean[used].astype(np.float32), left.reshape(-1, 3).astype(np.int32))


def joined(shapes: Sequence[PolygonMesh]) -> PolygonMesh:
    """Meshes of triangles joined to one."""
    first = np.cumsum([0, *(len(shape.coordinates) for shape in shapes)])
    triangles = [
        shape.corners.reshape(-1, 3) + start for shape, start in zip(shapes, first[:-1], strict=True)
    ]
    return of_triangles(
        np.concatenate([shape.coordinates for shape in shapes]), np.concatenate(triangles).astype(np.int32)
    )


def _without_pairs(triangles: np.ndarray) -> np.ndarray:
    """Triangles with three different corners, without pairs that coincide with opposite orientation."""
    a, b, c = triangles.T
    triangles = triangles[(a != b) & (b != c) & (c != a)]
    order = np.sort(triangles, axis=1)
    _, first, same = np.unique(order, axis=0, return_index=True, return_inverse=True)
    least = triangles.argmin(axis=1)
    rows = np.arange(len(triangles))
    forward = triangles[rows, (least + 1) % 3] < triangles[rows, (least + 2) % 3]
    net = np.bincount(same.reshape(-1), np.where(forward, 1, -1), len(first)).astype(np.int64)
    order = order[first]
    order[net < 0] = order[net < 0][:, [0, 2, 1]]
    return np.repeat(order, np.abs(net), axis=0)


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
        of.weights[mask] = barycentric(
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


def barycentric(places: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """(M, N, 3): the weights [:, i] of the corners of triangles (M, 3, 3) at places [:, i] of (M, N, 3); at a
    corner they are exactly 1, 0, 0."""
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
    weights = np.empty((*places.shape[:2], 3))
    for corner in range(places.shape[1]):
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
