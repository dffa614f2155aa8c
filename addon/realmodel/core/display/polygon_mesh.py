# SPDX-License-Identifier: GPL-3.0-or-later
"""Blocks and cells of a model as meshes of polygons with all their edges, for display and export."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np

from ..base.work import Cancel, Work, native_module, run
from ..cells.model_data import ModelData
from .bedding import Bedding, bedding_of, seen_from_below
from .fine_polygons import fine_polygons
from .series_layers import SeriesLayer


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
    """For each block of a model all its cells, each by itself with vertices of its own that are drawn towards
    their mean by the factor `shrink`; where that is None the parts of the block in each compartment, each
    closed by itself. Otherwise as `of_blocks`."""
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
