# SPDX-License-Identifier: GPL-3.0-or-later
"""The plan of a ready mesh that faults divide: what it covers, with the gaps that its parts leave along the
faults, as triangles on which each part can be continued."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..errors import InputRefused
from ..meshers import DEFAULT_MESHER
from ..planar_mesh import mesh_rings, triangulate_rings
from ..work import Work, native_module
from .fitted import convex_hull
from .triangles import border_loops, edges_of, welded

_AREA = 1e-9  # relative: parts that overlap by less do not


@dataclass(frozen=True)
class PlanTiling:
    """vertices (V, 3), triangles (T, 3): the mesh. nodes (N, 2), tiles (K, 3): triangles in plan of all that
    is to be covered. is_mesh: the first of them are the mesh itself, no two of which overlap."""

    work: Work
    vertices: np.ndarray
    triangles: np.ndarray
    nodes: np.ndarray
    tiles: np.ndarray
    is_mesh: bool

    def around(self, own: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Nodes (N, 2) and triangles (K, 3) int32 that cover all, among them the mesh's triangles `own` (T,)
        bool as they are; and the heights (N,) that these give, NaN elsewhere."""
        part = self.triangles[own]
        if self.is_mesh:
            known = np.full(len(self.nodes), np.nan)
            used = np.unique(part)
            known[used] = self.vertices[used, 2]
            return self.nodes, self.tiles, known
        used, part = np.unique(part, return_inverse=True)
        part = part.reshape(-1, 3).astype(np.int32)
        corners = self.vertices[used]
        surface_heights = native_module().surface_heights
        middles = np.ascontiguousarray(self.nodes[self.tiles].mean(axis=1))
        others = self.tiles[np.isnan(self.work.native(surface_heights, corners, part, middles))]
        on_part = self.work.native(surface_heights, corners, part, np.ascontiguousarray(self.nodes))
        nodes = np.concatenate([corners[:, :2], self.nodes])
        known = np.concatenate([corners[:, 2], on_part])
        tiles = np.concatenate([part, others + len(corners)])
        kept, tiles = np.unique(tiles, return_inverse=True)
        return (
            np.ascontiguousarray(nodes[kept]),
            np.ascontiguousarray(tiles.reshape(-1, 3), np.int32),
            known[kept],
        )


def plan_tiling(
    work: Work, vertices: np.ndarray, triangles: np.ndarray, sides: np.ndarray, active: np.ndarray
) -> PlanTiling:
    """sides: (V, F) of the vertices, 0 on a fault; active: (F,) bool, the faults that count."""
    plan = np.ascontiguousarray(vertices[:, :2])
    same = welded(plan)
    joined = same[triangles]
    loops = [plan[loop] for loop in border_loops(_one_way_up(plan, joined))]
    box = _around(plan)
    try:
        inside = _area(*triangulate_rings(loops)) if loops else 0.0
        if abs(inside - np.abs(_areas(plan, triangles)).sum()) <= _AREA * max(inside, 1e-300):
            around = triangulate_rings([box, *loops])
            gaps = _gaps(plan, sides[:, active], joined, around)
            tiles = np.concatenate([triangles, gaps])
            return PlanTiling(work, vertices, triangles, plan, np.ascontiguousarray(tiles, np.int32), True)
    except InputRefused:
        pass  # parts cross in plan
    nodes, tiles = _overlay(work, vertices, triangles, sides[:, active], box)
    return PlanTiling(work, vertices, triangles, nodes, tiles, False)


def _around(plan: np.ndarray) -> np.ndarray:
    """A rectangle well around all points."""
    low, high = plan.min(axis=0), plan.max(axis=0)
    margin = 0.25 * float((high - low).max()) or 1.0
    (x0, y0), (x1, y1) = low - margin, high + margin
    return np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]])


def _areas(plan: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    a, b, c = plan[triangles].transpose(1, 0, 2)
    (ux, uy), (vx, vy) = (b - a).T, (c - a).T
    return (ux * vy - uy * vx) / 2


def _area(plan: np.ndarray, triangles: np.ndarray) -> float:
    return float(np.abs(_areas(plan, triangles)).sum())


def _one_way_up(plan: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """The triangles, each counter-clockwise in plan."""
    return np.where((_areas(plan, triangles) < 0)[:, None], triangles[:, ::-1], triangles)


def _gaps(plan: np.ndarray, sides: np.ndarray, triangles: np.ndarray, around) -> np.ndarray:
    """Of triangles between the borders of a mesh those that bridge a fault: (K, 3) vertices of the mesh.

    They have corners on both sides of a fault; where one has an edge of the mesh that itself passes the
    fault, the mesh is not open there, and it and those beside it only fill a bay of the outline.
    """
    places, outer = around
    of_mesh = dict(zip(map(tuple, plan[::-1].tolist()), range(len(plan) - 1, -1, -1), strict=True))
    vertex = np.array([of_mesh.get(tuple(place), -1) for place in places.tolist()])
    outer = vertex[outer]
    outer = outer[(outer >= 0).all(axis=1)]
    if not len(outer):
        return np.empty((0, 3), np.int32)
    # of several vertices at one position each has the same side, or one of them is on the fault
    side = np.zeros((len(plan), sides.shape[1]), np.int8)
    same = welded(plan)
    for row in (sides != 0).any(axis=1).nonzero()[0]:
        side[same[row]] = np.where(sides[row] != 0, sides[row], side[same[row]])
    corners = side[outer]
    bridges = ((corners < 0).any(axis=1) & (corners > 0).any(axis=1)).any(axis=1)
    outer = outer[bridges]
    borders = {tuple(sorted(edge)) for edge in edges_of(triangles).tolist()}
    edges = np.sort(edges_of(outer), axis=1)
    passing = (side[edges[:, 0]] * side[edges[:, 1]] < 0).any(axis=1)
    closed = np.array([tuple(edge) in borders for edge in edges.tolist()], bool) & passing
    bays = _spread(outer, closed.reshape(3, -1).any(axis=0)) if len(outer) else np.zeros(0, bool)
    return np.ascontiguousarray(outer[~bays], np.int32)


def _spread(triangles: np.ndarray, marked: np.ndarray) -> np.ndarray:
    """(T,) bool: the marked triangles, and all that hang together with them by edges."""
    _, edge = np.unique(np.sort(edges_of(triangles), axis=1), axis=0, return_inverse=True)
    edge = edge.reshape(3, -1)
    while True:
        touched = np.zeros(edge.max() + 1, bool)
        touched[edge[:, marked]] = True
        wider = touched[edge].any(axis=0)
        if (wider == marked).all():
            return marked
        marked = wider


def _overlay(work: Work, vertices, triangles, sides: np.ndarray, box: np.ndarray):
    """Nodes (N, 2) and triangles (K, 3) of what parts that overlap in plan cover together, with the gaps; all
    their borders are edges."""
    plan = np.ascontiguousarray(vertices[:, :2])
    length = float(np.median(np.linalg.norm(np.diff(plan[edges_of(triangles)], axis=1)[:, 0], axis=1)))
    lines = [plan[edge] for edge in _part_borders(plan, triangles, sides)]
    nodes, tiles = mesh_rings(work, [_around(convex_hull(plan))], length, DEFAULT_MESHER, constraints=lines)
    surface_heights = native_module().surface_heights
    middles = np.ascontiguousarray(nodes[tiles].mean(axis=1))
    covered = tiles[~np.isnan(_any_height(work, surface_heights, vertices, triangles, sides, middles))]
    loops = [nodes[loop] for loop in border_loops(covered)]
    around = triangulate_rings([box, *loops])
    side = np.zeros((len(nodes), sides.shape[1]), np.int8)
    border = np.unique(np.concatenate(border_loops(covered)))
    nearest = _nearest_vertices(nodes[border], plan)
    side[border] = sides[nearest]
    gaps = _gaps(nodes, side, covered, around)
    return nodes, np.ascontiguousarray(np.concatenate([covered, gaps]), np.int32)


def _signature(triangles: np.ndarray, sides: np.ndarray) -> np.ndarray:
    """(T,) the number of the part that a triangle belongs to, by the sides of its corners."""
    corners = sides[triangles]
    rows = np.concatenate([corners.min(axis=1), corners.max(axis=1)], axis=1)
    return np.unique(rows, axis=0, return_inverse=True)[1].ravel()


def _part_borders(plan: np.ndarray, triangles: np.ndarray, sides: np.ndarray) -> np.ndarray:
    """(E, 2) the edges in which parts of a mesh end."""
    part = _signature(triangles, sides)
    found = []
    for number in range(part.max() + 1):
        own = triangles[part == number]
        edges, count = np.unique(np.sort(edges_of(own), axis=1), axis=0, return_counts=True)
        found.append(edges[count == 1])
    return np.unique(np.concatenate(found), axis=0)


def _any_height(work: Work, surface_heights, vertices, triangles, sides, places) -> np.ndarray:
    """(N,) a height of any part over each place; NaN where there is none."""
    part = _signature(triangles, sides)
    found = np.full(len(places), np.nan)
    for number in range(part.max() + 1):
        own = np.ascontiguousarray(triangles[part == number])
        z = work.native(surface_heights, vertices, own, places)
        found = np.where(np.isnan(found), z, found)
    return found


def _nearest_vertices(places: np.ndarray, plan: np.ndarray) -> np.ndarray:
    found = np.empty(len(places), np.int64)
    for number, place in enumerate(places):
        found[number] = ((plan - place) ** 2).sum(axis=1).argmin()
    return found
