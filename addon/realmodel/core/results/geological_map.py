# SPDX-License-Identifier: GPL-3.0-or-later
"""The geological map of a model: polygons in plan of the blocks that crop out on top, which share their
borders."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..base.algebra import dot, norm, twice_area
from ..base.errors import BuildFailed, InputRefused
from ..base.triangles import joined_edges
from ..base.work import native_module
from ..cells.joining import apart, near_positions
from ..cells.model_data import ModelData
from ..project.plan_input import checked_region, given_rings
from .booleans import intersect

Polygon = list[np.ndarray]  # its outline, counter-clockwise, then its holes, clockwise: vertex numbers, open


def net_edges(start: np.ndarray, end: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Each edge once, in the direction that it is passed more often, and how much more often: (E,) start,
    end, count. Edges that are passed as often one way as the other are left out, and those without length."""
    differ = start != end
    start, end = start[differ], end[differ]
    forward = start < end
    low, high = np.where(forward, start, end).astype(np.int64), np.where(forward, end, start).astype(np.int64)
    size = int(high.max(initial=0)) + 1
    key, number = np.unique(low * size + high, return_inverse=True)
    net = np.bincount(number.ravel(), np.where(forward, 1, -1), len(key)).astype(np.int64)
    mask = net != 0
    low, high, net = key[mask] // size, key[mask] % size, net[mask]
    return np.where(net > 0, low, high), np.where(net > 0, high, low), np.abs(net)


def polygons_of(points: np.ndarray, start: np.ndarray, end: np.ndarray) -> list[Polygon]:
    """The polygons that lie to the left of directed edges.

    points: (V, 2) float64. start, end: (E,) vertex numbers; as many edges begin as end at each vertex, and no
    two cross. The polygons touch themselves and each other in vertices at most, and each is connected within.
    Raises BuildFailed where there is a hole in nothing."""
    outlines: list[np.ndarray] = []
    holes: list[np.ndarray] = []
    for walk in _walks(points, start, end):
        for ring in _simple_rings(walk):
            (outlines if twice_area(points[ring]) > 0 else holes).append(np.array(ring))
    polygons: list[Polygon] = [[ring] for ring in outlines]
    if not holes:
        return polygons
    areas = np.array([twice_area(points[ring]) for ring in outlines])
    around = _Around(points, outlines)
    for hole in holes:
        candidates = around.rings_around(hole)
        if not len(candidates):
            raise BuildFailed(
                f"the plan is not valid: a hole without an outline at {points[hole[0]].tolist()}"
            )
        polygons[candidates[areas[candidates].argmin()]].append(hole)
    return polygons


def covers_once(points: np.ndarray, polygons: list[Polygon]) -> bool:
    """Whether no two polygons have a place in common; their rings do not cross."""
    rings = [ring for polygon in polygons for ring in polygon]
    sign = np.array([1 if k == 0 else -1 for polygon in polygons for k in range(len(polygon))])
    around = _Around(points, rings)
    return all(
        sign[around.rings_around(ring, number)].sum() == (0 if sign[number] > 0 else 1)
        for number, ring in enumerate(rings)
    )


class _Around:
    """Finds the rings that contain another ring."""

    def __init__(self, points: np.ndarray, rings: list[np.ndarray]):
        self.points, self.rings = points, rings
        self.low = np.array([points[ring].min(axis=0) for ring in rings]).reshape(-1, 2)
        self.high = np.array([points[ring].max(axis=0) for ring in rings]).reshape(-1, 2)

    def rings_around(self, ring: np.ndarray, itself: int = -1) -> np.ndarray:
        low, high = self.points[ring].min(axis=0), self.points[ring].max(axis=0)
        near = np.flatnonzero((self.low <= low).all(axis=1) & (self.high >= high).all(axis=1))
        return np.array(
            [n for n in near.tolist() if n != itself and _contains(self.points, self.rings[n], ring)],
            np.int64,
        )


def _walks(points: np.ndarray, start: np.ndarray, end: np.ndarray) -> list[list[int]]:
    """Closed walks along the edges. Where several edges begin at a vertex a walk continues along the one that
    the same area lies to the left of: the first one clockwise from the way that it came."""
    leaving: dict[int, list[int]] = defaultdict(list)
    ends = end.tolist()
    for edge, vertex in enumerate(start.tolist()):
        leaving[vertex].append(edge)
    order = np.lexsort((end, start)).tolist()
    used, walks = [False] * len(ends), []
    starts = start.tolist()
    for first in order:
        if used[first]:
            continue
        walk, edge = [], first
        while not used[edge]:
            used[edge] = True
            walk.append(starts[edge])
            at = ends[edge]
            ways = leaving[at]
            edge = ways[0] if len(ways) == 1 else _first_clockwise(points, starts[edge], at, ways, ends)
        walks.append(walk)
    return walks


def _first_clockwise(points: np.ndarray, came: int, at: int, ways: list[int], ends: list[int]) -> int:
    best = ways[0]
    for way in ways[1:]:
        if _is_before(points, at, came, ends[way], ends[best]):
            best = way
    return best


def _is_before(points: np.ndarray, at: int, origin: int, one: int, other: int) -> bool:
    """Whether, turning clockwise from the vertex `origin` around `at`, `one` comes before `other`."""
    first, second = _half(points, at, origin, one), _half(points, at, origin, other)
    if first != second:
        return first < second
    return _side(points, at, other, one) > 0


def _half(points: np.ndarray, at: int, origin: int, way: int) -> int:
    """0: in the half turn clockwise from origin, 1: opposite to origin, 2: in the other half, 3: origin
    itself."""
    side = _side(points, at, origin, way)
    if side == 0:
        away = dot(points[origin] - points[at], points[way] - points[at]) < 0
        return 1 if away else 3
    return 0 if side < 0 else 2


def _side(points: np.ndarray, a: int, b: int, p: int) -> int:
    return int(native_module().orient2d(points[[a]], points[[b]], points[[p]])[0])


def _simple_rings(walk: list[int]) -> list[list[int]]:
    """A closed walk divided where it comes to a vertex again."""
    rings: list[list[int]] = []
    path: list[int] = []
    place: dict[int, int] = {}
    for vertex in walk:
        if vertex in place:
            begin = place[vertex]
            ring = path[begin:]
            rings.append(ring)
            for gone in ring[1:]:
                del place[gone]
            del path[begin + 1 :]
        else:
            place[vertex] = len(path)
            path.append(vertex)
    rings.append(path)
    return [ring for ring in rings if len(ring) > 2]


def _contains(points: np.ndarray, outline: np.ndarray, ring: np.ndarray) -> bool:
    """Whether a ring lies inside an outline that it does not cross: tested at a vertex that is not one of the
    outline's, or at the middle of an edge."""
    free_vertices = ring[~np.isin(ring, outline)]
    place = points[free_vertices[0]] if len(free_vertices) else (points[ring[0]] + points[ring[1]]) / 2
    a, b = points[outline], points[np.roll(outline, -1)]
    crosses = (a[:, 1] <= place[1]) != (b[:, 1] <= place[1])
    a, b = a[crosses], b[crosses]
    side = native_module().orient2d(a, b, np.broadcast_to(place, a.shape))
    return bool(((side > 0) == (b[:, 1] > a[:, 1])).sum() % 2)


_WALL = -1
_FAULT = 1  # of `surface_kind`
_UPRIGHT = 2.0**-40  # the slope from which on a face is upright but for the rounding of its corners


@dataclass(frozen=True, eq=False)
class MapArea:
    """The outcrop of one block, in one compartment. polygons: of each the outline (N, 2) float64,
    counter-clockwise, then its holes, clockwise; rings are open."""

    block: int
    compartment: int
    polygons: list[list[np.ndarray]]

    @cached_property
    def area(self) -> float:
        """The area in plan, model units squared."""
        return float(sum(_area(ring) for polygon in self.polygons for ring in polygon))


@dataclass(frozen=True, eq=False)
class Ground:
    """The top of a model as triangles that nothing lies above.

    corners: (T, 3, 3) float64. vertices: (T, 3), numbers of places in plan. solid: (T, 3), numbers by which
    two triangles are known to meet in space. areas: as of geological_map.
    """

    corners: np.ndarray
    vertices: np.ndarray
    solid: np.ndarray
    areas: list[MapArea]


def geological_map(model: ModelData, ground: Ground | None = None) -> list[MapArea]:
    """The areas where each block crops out, by block, then by compartment.

    Their polygons are unions of the faces on top, so they share borders vertex by vertex, and together are
    the plan of the model. Where one part of the model lies above another, as over a void, the higher one is
    shown. ground: where `ground_of` was called before. Raises BuildFailed.

    >>> [(model.blocks[area.block].name, area.area) for area in model.geological_map()]
    [('clay', 4.0), ('sand', 4.0), ('soil', 8.0)]
    """
    return (ground_of(model) if ground is None else ground).areas


def fault_lines(model: ModelData, ground: Ground) -> list[tuple[str, np.ndarray]]:
    """Where faults come to the top of a model: the name of each and a line (N, 2) float64, closed where the
    first place is the last. Lines of a fault meet where it branches. ground: as of `ground_of`."""
    kinds = np.append(model.surface_kind, 0)  # faces on no surface have numbers below 0
    faces = np.flatnonzero(kinds[np.maximum(model.face_surface, -1)] == _FAULT)
    offsets, corners = model.face_corners(faces, np.zeros(len(faces), bool))
    following = np.arange(1, len(corners) + 1)
    following[offsets[1:] - 1] = offsets[:-1]
    size = len(model.vertices)

    def keys(start: np.ndarray, end: np.ndarray) -> np.ndarray:
        return np.minimum(start, end).astype(np.int64) * size + np.maximum(start, end)

    of_faults = keys(corners, corners[following])
    on_ground = np.isin(of_faults, keys(*_edges(ground.solid)))
    surface = np.repeat(model.face_surface[faces], np.diff(offsets))
    plan, vertex = _plan_vertices(model.vertices[:, :2])
    lines = []
    for fault in np.unique(surface[on_ground]):
        edges = of_faults[on_ground & (surface == fault)]
        ends = np.sort(vertex[np.column_stack([edges // size, edges % size])], axis=1)
        for line in joined_edges(np.unique(ends[ends[:, 0] != ends[:, 1]], axis=0)):
            lines.append((model.surface_names[fault], plan[line]))
    return lines


def _areas(
    model: ModelData, plan: np.ndarray, start: np.ndarray, end: np.ndarray, cell: np.ndarray
) -> list[MapArea]:
    """The areas, from the edges of the ground in plan, with the ground to their left, and the cells of each
    edge."""
    of = np.stack([model.cell_block[cell], model.cell_compartment[cell]], axis=1)
    keys, number = np.unique(of, axis=0, return_inverse=True)
    areas = []
    for k, (block, compartment) in enumerate(keys.tolist()):
        mask = number.ravel() == k
        first, second, _ = net_edges(start[mask], end[mask])
        polygons = polygons_of(plan, first, second)
        if polygons:
            rings = [[plan[ring] for ring in polygon] for polygon in polygons]
            areas.append(MapArea(block, compartment, rings))
    return areas


def ground_of(model: ModelData) -> Ground:
    """The top of a model. Raises BuildFailed."""
    triangles, cell, upright = _outside(model)
    plan, vertex = _plan_vertices(model.vertices[:, :2])
    rises = _rises(model.vertices[triangles])
    is_ground = rises & ~upright
    start, end = _edges(vertex[triangles[is_ground]])
    edges = _divided(plan, start, end, np.repeat(cell[is_ground], 3))
    try:
        if _is_plain(plan, *edges[:2]):
            ground = triangles[is_ground]
            return Ground(model.vertices[ground], vertex[ground], ground, _areas(model, plan, *edges))
    except BuildFailed:  # an area no wider than rounding is inverted
        pass
    return _highest(model, triangles[rises], vertex, plan, cell[rises])


def _plan_vertices(places: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Positions in plan that differ, and the number of each vertex's. Those that are some roundings apart are
    one: a line would zigzag between them, which no polygon may."""
    plan, vertex = np.unique(places + 0.0, axis=0, return_inverse=True)  # no -0.0
    representatives, number = np.unique(near_positions(plan), return_inverse=True)
    return plan[representatives], number.ravel()[vertex.ravel()]


def _outside(model: ModelData) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The faces of the outside as triangles (T, 3), counter-clockwise seen from outside; of each
    (T,) the cell behind it, and whether its face is upright."""
    outside = np.flatnonzero((model.face_cells < 0).any(axis=1))
    turned = model.face_cells[outside, 0] < 0
    offsets, corners = model.face_corners(outside, turned)
    triangles, begins = native_module().triangulate_faces(model.vertices, offsets, corners)
    face = np.repeat(np.arange(len(outside)), np.diff(begins))
    cell = model.face_cells[outside].max(axis=1)
    a, b, c = model.vertices[triangles].transpose(1, 0, 2)
    normals = np.zeros((len(outside), 3))
    np.add.at(normals, face, np.cross(b - a, c - a))
    upright = model.face_surface[outside] == _WALL
    upright |= np.abs(normals[:, 2]) <= _UPRIGHT * np.linalg.norm(normals[:, :2], axis=1)
    return triangles.astype(np.int64), cell[face], upright[face]


def _rises(corners: np.ndarray) -> np.ndarray:
    """Whether triangles (T, 3, 2 or 3) are counter-clockwise in plan."""
    return native_module().orient2d(*corners[:, :, :2].transpose(1, 0, 2)) > 0


def _edges(triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    return triangles.ravel(), triangles[:, [1, 2, 0]].ravel()


def _divided(
    plan: np.ndarray, start: np.ndarray, end: np.ndarray, cell: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Edges in plan, divided at vertices that lie on them up to rounding: above and below a step, and on two
    sides of a border of rock masses, there may be different vertices."""
    first, second, _ = net_edges(start, end)  # the others have the same edge beside them
    inserted = _vertices_on_edges(plan, first, second)
    if not inserted:
        return start, end, cell
    size = len(plan)
    rows = np.flatnonzero(np.isin(start * size + end, [a * size + b for a, b in inserted]))
    chains = [[a, *inserted[a, b], b] for a, b in zip(start[rows].tolist(), end[rows].tolist(), strict=True)]
    cells = np.repeat(cell[rows], [len(chain) - 1 for chain in chains])
    return (
        np.concatenate([np.delete(start, rows), *(chain[:-1] for chain in chains)]).astype(np.int64),
        np.concatenate([np.delete(end, rows), *(chain[1:] for chain in chains)]).astype(np.int64),
        np.concatenate([np.delete(cell, rows), cells]),
    )


def _vertices_on_edges(
    plan: np.ndarray, start: np.ndarray, end: np.ndarray
) -> dict[tuple[int, int], list[int]]:
    """For each edge the ends of other edges that lie on it up to rounding, in their order."""
    among = np.unique(np.concatenate([start, end]))
    near = apart(plan)
    sorted_by = [among[np.argsort(plan[among, axis], kind="stable")] for axis in (0, 1)]
    low, high = np.minimum(plan[start], plan[end]) - near, np.maximum(plan[start], plan[end]) + near
    begins = [np.searchsorted(plan[sorted_by[k], k], low[:, k]) for k in (0, 1)]
    ends = [np.searchsorted(plan[sorted_by[k], k], high[:, k], "right") for k in (0, 1)]
    axis = (ends[1] - begins[1] < ends[0] - begins[0]).astype(np.int64)
    vertices = {}
    for edge, (a, b, k) in enumerate(zip(start.tolist(), end.tolist(), axis.tolist(), strict=True)):
        beside = sorted_by[k][begins[k][edge] : ends[k][edge]]
        if len(beside) < 3:
            continue
        way, to = plan[b] - plan[a], plan[beside] - plan[a]
        length = norm(way)
        along, across = dot(to, way) / length, (to[:, 0] * way[1] - to[:, 1] * way[0]) / length
        on = (np.abs(across) <= near) & (along > 0) & (along < length) & (beside != a) & (beside != b)
        if on.any():
            vertices[a, b] = beside[on][np.argsort(along[on], kind="stable")].tolist()
    return vertices


def _is_plain(plan: np.ndarray, start: np.ndarray, end: np.ndarray) -> bool:
    """Whether nothing of the ground lies above another part of it: what bounds all of it are rings that do
    not cross, with the ground on the right side."""
    start, end, count = net_edges(start, end)
    if (count > 1).any():
        return False
    try:
        polygons = polygons_of(plan, start, end)
        rings = [plan[ring] for polygon in polygons for ring in polygon]
        if rings:
            checked_region(given_rings(rings))
    except (BuildFailed, InputRefused):
        return False
    return covers_once(plan, polygons)


def _highest(
    model: ModelData, triangles: np.ndarray, vertex: np.ndarray, plan: np.ndarray, cell: np.ndarray
) -> Ground:
    """As ground_of, for ground with parts above one another: projected and divided along all edges; of pieces
    at the same position the highest."""
    rises = _rises(plan[vertex[triangles]])  # where vertices were joined some do no more
    triangles, cell = triangles[rises], cell[rises]
    flat = np.column_stack([plan, np.zeros(len(plan))])
    beyond = plan.max(axis=0) + np.ptp(plan, axis=0) + 1.0
    other = np.array([[*beyond, 0], [beyond[0] + 1, beyond[1], 0], [beyond[0], beyond[1] + 1, 0]])
    try:
        refined = intersect((flat, vertex[triangles].astype(np.int32)), (other, np.array([[0, 1, 2]])))
    except InputRefused as error:
        raise BuildFailed(f"the top of the model cannot be laid flat: {error}") from error
    numbers = np.flatnonzero(refined.source == 0)
    source, pieces = refined.source_triangle[numbers], refined.triangles[numbers].astype(np.int64)
    plane = model.vertices[triangles[source]]
    heights = _heights(plane, refined.vertices[pieces][:, :, :2])
    place = np.sort(pieces, axis=1)
    order = np.lexsort((heights.mean(axis=1), *place.T))
    is_last = np.append((np.diff(place[order], axis=0) != 0).any(axis=1), True)
    highest = np.sort(order[is_last])
    highest = highest[_rises(refined.vertices[pieces[highest]])]
    pieces, source = pieces[highest], source[highest]
    corners = np.concatenate([refined.vertices[pieces][:, :, :2], heights[highest][:, :, None]], axis=2)
    start, end = _edges(pieces)
    areas = _areas(model, refined.vertices[:, :2] + 0.0, start, end, np.repeat(cell[source], 3))
    return Ground(corners, pieces, triangles[source], areas)


def _heights(planes: np.ndarray, places: np.ndarray) -> np.ndarray:
    """(N, 3) the heights of triangles (N, 3, 3) at three places (N, 3, 2) within each; at a corner its
    own."""
    a, b, c = planes.transpose(1, 0, 2)
    u, v = b - a, c - a
    area = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
    w = places - a[:, None, :2]
    along = (w[:, :, 0] * v[:, None, 1] - w[:, :, 1] * v[:, None, 0]) / area[:, None]
    across = (u[:, None, 0] * w[:, :, 1] - u[:, None, 1] * w[:, :, 0]) / area[:, None]
    heights = a[:, None, 2] + along * u[:, None, 2] + across * v[:, None, 2]
    heights = np.clip(heights, planes[:, :, 2].min(axis=1)[:, None], planes[:, :, 2].max(axis=1)[:, None])
    for corner in (a, b, c):
        same = (places == corner[:, None, :2]).all(axis=2)
        heights = np.where(same, corner[:, None, 2], heights)
    return heights


def _area(ring: np.ndarray) -> float:
    return twice_area(ring) / 2
