# SPDX-License-Identifier: GPL-3.0-or-later
"""The plan of a ready mesh that faults divide: its area, with the gaps that its parts leave along the faults,
as triangles on which each part can be continued."""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np

from ...base.errors import InputRefused
from ...base.triangles import border_loops, edge_numbers, edges_of, median_edge, open_edges, welded
from ...base.work import Work, native_module
from ...surfaces.planar_mesh import MeshOptions, mesh_rings, triangulate_rings

LEFT, RIGHT, _BOTH = 1, 2, 3  # on which sides of a fault a triangle has a part
_AREA = 1e-9  # relative: parts that overlap by less do not


@dataclass(frozen=True)
class PlanTiling:
    """vertices (V, 3), triangles (T, 3): the mesh. nodes (N, 2), tiles (K, 3): triangles in plan of all that
    is to be covered; same (N,): as welded gives it of the nodes. is_mesh: the first of them are the mesh
    itself, no two of which overlap."""

    work: Work
    vertices: np.ndarray
    triangles: np.ndarray
    nodes: np.ndarray
    tiles: np.ndarray
    same: np.ndarray
    is_mesh: bool

    def heights(self, own: np.ndarray) -> np.ndarray:
        """(N,) heights at the nodes of some of the mesh's triangles, (T,) bool; NaN elsewhere."""
        part = np.ascontiguousarray(self.triangles[own])
        if not self.is_mesh:
            return self.work.native(native_module().surface_heights, self.vertices, part, self.nodes)
        z = np.full(len(self.nodes), np.nan)
        used = np.unique(part)
        z[used] = self.vertices[used, 2]
        return z

    def around(self, own: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Nodes (N, 2) and triangles (K, 3) int32 that cover all, among them the mesh's triangles `own` (T,)
        bool as they are; and the heights (N,) that these give, NaN elsewhere."""
        if self.is_mesh:
            return self.nodes, self.tiles, self.heights(own)
        used, part = np.unique(self.triangles[own], return_inverse=True)
        part = part.reshape(-1, 3).astype(np.int32)
        corners = self.vertices[used]
        middles = np.ascontiguousarray(self.nodes[self.tiles].mean(axis=1))
        over = self.work.native(native_module().surface_heights, corners, part, middles)
        nodes = np.concatenate([corners[:, :2], self.nodes])
        z = np.concatenate([corners[:, 2], self.heights(own)])
        tiles = np.concatenate([part, self.tiles[np.isnan(over)] + len(corners)])
        used_nodes, tiles = np.unique(tiles, return_inverse=True)
        return (
            np.ascontiguousarray(nodes[used_nodes]),
            np.ascontiguousarray(tiles.reshape(-1, 3), np.int32),
            z[used_nodes],
        )


def plan_tiling(work: Work, vertices: np.ndarray, triangles: np.ndarray, masks: np.ndarray) -> PlanTiling:
    """masks: (T, F) on which sides of each fault a triangle has a part: 1, 2, or 3 for both."""
    plan = np.ascontiguousarray(vertices[:, :2])
    same = welded(plan)
    joined = same[triangles]
    loops = [plan[loop] for loop in border_loops(_one_way_up(plan, joined))]
    box = _around(plan)
    try:
        inside = _area(*triangulate_rings(loops)) if loops else 0.0
        if abs(inside - np.abs(_areas(plan, triangles)).sum()) <= _AREA * max(inside, 1e-300):
            gaps = _gaps(plan, joined, masks, triangulate_rings([box, *loops]))
            tiles = np.ascontiguousarray(np.concatenate([triangles, gaps]), np.int32)
            return PlanTiling(work, vertices, triangles, plan, tiles, same, True)
    except InputRefused:
        pass  # parts cross in plan
    nodes, tiles = _overlay(work, vertices, triangles, masks, box)
    return PlanTiling(work, vertices, triangles, nodes, tiles, welded(nodes), False)


def _around(plan: np.ndarray) -> np.ndarray:
    """A rectangle well around all points."""
    low, high = plan.min(axis=0), plan.max(axis=0)
    margin = 0.25 * float((high - low).max()) or 1.0
    (x0, y0), (x1, y1) = low - margin, high + margin
    return np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]])


def _areas(plan: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    x, y = plan.T
    a, b, c = triangles.T
    return ((x[b] - x[a]) * (y[c] - y[a]) - (y[b] - y[a]) * (x[c] - x[a])) / 2


def _area(plan: np.ndarray, triangles: np.ndarray) -> float:
    return float(np.abs(_areas(plan, triangles)).sum())


def _one_way_up(plan: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """The triangles, each counter-clockwise in plan."""
    return np.where((_areas(plan, triangles) < 0)[:, None], triangles[:, ::-1], triangles)


def _gaps(
    plan: np.ndarray, triangles: np.ndarray, masks: np.ndarray, around: tuple[np.ndarray, np.ndarray]
) -> np.ndarray:
    """Of triangles between the borders of a mesh those that bridge a fault: (K, 3) vertices of the mesh.

    They have corners of parts on both sides of it. Where there is an edge of a triangle that itself passes
    the fault, the mesh is not open: what hangs together with it only fills a bay of the outline.
    """
    places, outer = around
    vertex = welded(np.concatenate([plan, places]))[len(plan) :]
    outer = np.where(vertex < len(plan), vertex, -1)[outer]
    outer = outer[(outer >= 0).all(axis=1)]
    touched = touched_masks(len(plan), triangles, masks)
    outer_edges, edges = (edge_numbers(edges_of(faces), len(plan)) for faces in (outer, triangles))
    gaps = np.zeros(len(outer), bool)
    for fault in range(masks.shape[1]):
        corners = touched[outer, fault]
        near = np.bitwise_or.reduce(corners, axis=1) == _BOTH
        bridges = (corners == LEFT).any(axis=1) & (corners == RIGHT).any(axis=1)
        if not bridges.any():
            continue
        closed = edges[np.tile(masks[:, fault] == _BOTH, 3)]
        at_closed = np.logical_or.reduce(np.isin(outer_edges, closed).reshape(3, -1), axis=0)
        bays = _spread(outer[near], at_closed[near])
        gaps[np.flatnonzero(near)[~bays]] |= bridges[near][~bays]
    return np.ascontiguousarray(outer[gaps], np.int32)


def touched_masks(count: int, triangles: np.ndarray, masks: np.ndarray) -> np.ndarray:
    """(V, F) the sides of each fault on which the triangles at each vertex have a part."""
    touched = np.zeros((count, masks.shape[1]), np.uint8)
    for fault, side in itertools.product(range(masks.shape[1]), (LEFT, RIGHT)):
        faces = triangles[(masks[:, fault] & side) > 0]
        touched[faces.ravel(), fault] |= side
    return touched


def _spread(triangles: np.ndarray, marked: np.ndarray) -> np.ndarray:
    """(T,) bool: the marked triangles, and all that hang together with them by edges."""
    count = int(triangles.max(initial=0)) + 1
    _, edge = np.unique(edge_numbers(edges_of(triangles), count), return_inverse=True)
    edge = edge.reshape(3, -1)
    while True:
        touched = np.zeros(edge.max() + 1, bool)
        touched[edge[:, marked]] = True
        wider = np.logical_or.reduce(touched[edge], axis=0)
        if (wider == marked).all():
            return marked
        marked = wider


def _overlay(
    work: Work, vertices: np.ndarray, triangles: np.ndarray, masks: np.ndarray, box: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Nodes (N, 2) and triangles (K, 3) of what parts that overlap in plan cover together, with the gaps; all
    their borders are edges."""
    plan = np.ascontiguousarray(vertices[:, :2])
    length = median_edge(plan, triangles)
    rows, part = np.unique(masks, axis=0, return_inverse=True)
    parts = [np.ascontiguousarray(triangles[part.ravel() == number]) for number in range(len(rows))]
    borders = [open_edges(vertices, faces) for faces in parts]
    lines = [plan[edge] for edge in np.unique(np.concatenate(borders), axis=0)]
    nodes, tiles = mesh_rings(work, [box], MeshOptions(length, constraints=lines))
    middles = np.ascontiguousarray(nodes[tiles].mean(axis=1))
    tile_masks = np.zeros((len(tiles), masks.shape[1]), np.uint8)
    for row, faces in zip(rows, parts, strict=True):
        over = ~np.isnan(work.native(native_module().surface_heights, vertices, faces, middles))
        tile_masks[over] |= row
    covered = tile_masks.any(axis=1)
    tiles, tile_masks = tiles[covered], tile_masks[covered]
    around = triangulate_rings([_around(nodes), *(nodes[loop] for loop in border_loops(tiles))])
    gaps = _gaps(nodes, tiles, tile_masks, around)
    return nodes, np.ascontiguousarray(np.concatenate([tiles, gaps]), np.int32)
