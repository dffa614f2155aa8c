# SPDX-License-Identifier: GPL-3.0-or-later
"""Triangles in space that share vertices: open edges, orientation, crossings; polygons as triangles."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from .packages import extra

if TYPE_CHECKING:
    import pyvista
from numpy.typing import ArrayLike

from .algebra import begins_run, dot, norm
from .errors import InputRefused, place_text
from .work import native_module


class Triangulation(NamedTuple):
    """vertices: (V, 3) float64, or (V, 2) in plan, model units. triangles: (T, 3) int32, numbers of vertices.

    It is a tuple: `vertices, triangles = model.surfaces["top"]`.
    """

    vertices: np.ndarray
    triangles: np.ndarray

    def to_pyvista(self) -> pyvista.PolyData:
        """The triangles as a mesh of PyVista; in plan all heights are 0. Raises UsageError where PyVista is
        missing."""
        places = np.pad(self.vertices, ((0, 0), (0, 3 - self.vertices.shape[1])))
        return extra("pyvista", "to_pyvista()").PolyData.from_regular_faces(places, self.triangles)


@dataclass(frozen=True, eq=False)
class Sheet:
    """vertices: (V, 3) float64, or (V, 2) in plan. triangles: (T, 3) int32. numbers: (T,) of its triangles in
    the surface that it is a part of; None: 0, 1, ... Sheets are equal where they are one object, which
    compartments share."""

    vertices: np.ndarray
    triangles: np.ndarray
    numbers: np.ndarray | None = None

    def __iter__(self) -> Iterator[np.ndarray]:
        """`vertices, triangles = sheet`."""
        return iter(self.arrays)

    @property
    def arrays(self) -> Triangulation:
        """Vertices and triangles, as the native module takes them."""
        return Triangulation(self.vertices, self.triangles)

    @property
    def corners(self) -> np.ndarray:
        """(T, 3, 2) or (T, 3, 3): of its triangles."""
        return self.vertices[self.triangles]

    @property
    def of_surface(self) -> np.ndarray:
        """(T,) the numbers of its triangles, also where it is whole."""
        return np.arange(len(self.triangles)) if self.numbers is None else self.numbers

    def has_plan_of(self, other: Sheet) -> bool:
        """Whether it covers the same triangles in plan."""
        has_triangles = self.triangles is other.triangles or np.array_equal(self.triangles, other.triangles)
        return self is other or (
            has_triangles and np.array_equal(self.vertices[:, :2], other.vertices[:, :2])
        )

    def some(self, kept: np.ndarray) -> Sheet:
        """Some of its triangles (T,) bool, with only their own vertices."""
        if kept.all():
            return self
        used = np.zeros(len(self.vertices), bool)
        used[self.triangles[kept]] = True
        number = np.cumsum(used, dtype=np.int64) - 1
        triangles = number[self.triangles[kept]].astype(np.int32)
        return Sheet(np.ascontiguousarray(self.vertices[used]), triangles, self.of_surface[kept])


_EDGES = ((0, 1), (1, 2), (2, 0))


def welded(vertices: np.ndarray) -> np.ndarray:
    """(V,) the least vertex at the same position as each."""
    order = np.lexsort(vertices.T)  # of equal ones the least comes first
    is_first = begins_run(vertices[order])
    same = np.empty_like(order)
    same[order] = order[is_first][np.cumsum(is_first) - 1]
    return same


def extents(corners: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The least and the greatest coordinates (T, D) of triangles (T, 3, D)."""
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    return np.minimum(np.minimum(a, b), c), np.maximum(np.maximum(a, b), c)


def without_flat(vertices: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """The triangles (K, 3) int32 whose corners differ and do not lie in one line."""
    first, second, third = vertices[triangles].transpose(1, 0, 2)
    flat = (np.cross(second - first, third - first) == 0).all(axis=1)
    return np.ascontiguousarray(triangles[~flat])


def cross(u: np.ndarray, v: np.ndarray) -> np.ndarray:
    """(K, 3) as np.cross, which takes longer for the few pairs that there are at a fault."""
    (ux, uy, uz), (vx, vy, vz) = u.T, v.T
    return np.stack([uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx], axis=1)


def edges_of(triangles: np.ndarray) -> np.ndarray:
    """(3 T, 2) the directed edges: those from corner 0 to 1 of all triangles, then 1 to 2, then 2 to 0."""
    return np.concatenate([triangles[:, pair] for pair in _EDGES])


def edge_lengths(vertices: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """(3 T,) the lengths of the edges that edges_of gives, between vertices in plan or in space."""
    squares = np.zeros((3, len(triangles)))
    for coordinates in vertices.T:
        corners = np.ascontiguousarray(coordinates)[triangles.T]
        step = corners[[1, 2, 0]] - corners
        squares += step * step
    return np.sqrt(squares).ravel()


def median_edge(plan: np.ndarray, triangles: np.ndarray) -> float:
    """The median length of the edges of triangles in plan."""
    return float(np.median(edge_lengths(plan, triangles)))


def edge_numbers(edges: np.ndarray, count: int) -> np.ndarray:
    """(E,) int64: of edges (E, 2) between so many vertices, the same for both directions."""
    a, b = edges.T.astype(np.int64)
    return np.minimum(a, b) * count + np.maximum(a, b)


def edges_numbered(numbers: np.ndarray, count: int) -> np.ndarray:
    """(E, 2) the edges that edge_numbers numbers so, the lesser vertex first."""
    return np.column_stack(np.divmod(numbers, count))


def open_edges(vertices: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """(E, 2) edges that an odd number of triangles have; vertices at one position count as one."""
    edges = edges_of(welded(vertices)[triangles])
    numbers, times = np.unique(edge_numbers(edges, len(vertices)), return_counts=True)
    return edges_numbered(numbers[times % 2 == 1], len(vertices))


def joined_edges(edges: np.ndarray) -> list[list[int]]:
    """Edges (E, 2) between vertices joined to lines that end where not two meet; others are closed."""
    around: dict[int, list[int]] = defaultdict(list)
    for a, b in edges.tolist():
        around[a].append(b)
        around[b].append(a)
    lines = []
    for first in sorted(around, key=lambda vertex: (len(around[vertex]) == 2, vertex)):
        while around[first]:
            line = [first]
            while around[line[-1]]:
                at, after = line[-1], around[line[-1]][0]
                around[at].remove(after)
                around[after].remove(at)
                line.append(after)
                if len(around[after]) != 1:
                    break
            lines.append(line)
    return lines


def border_loops(triangles: np.ndarray) -> list[np.ndarray]:
    """The rings of vertices along edges that one triangle alone has, with the triangles on their left."""
    edges = edges_of(triangles)
    keys = edge_numbers(edges, int(triangles.max(initial=0)) + 1)
    order = np.argsort(keys, kind="stable")
    differs = np.ones(len(order) + 1, bool)
    differs[1:-1] = keys[order[1:]] != keys[order[:-1]]
    following: dict[int, list[int]] = {}
    for a, b in edges[np.sort(order[differs[:-1] & differs[1:]])].tolist():
        following.setdefault(a, []).append(b)
    loops = []
    for start in sorted(following):
        while following[start]:
            loop = [start]
            while following.get(loop[-1]):
                loop.append(following[loop[-1]].pop(0))
                if loop[-1] == start:
                    break
            loops.append(np.array(loop[:-1] if loop[-1] == start else loop))
    return [loop for loop in loops if len(loop) > 2]


def unit_normals(corners: np.ndarray) -> np.ndarray:
    """(T, 3) the normals of triangles (T, 3, 3), of length 1."""
    normals = cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return normals / norm(normals)[:, None]


def overlapping_pairs(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """(K, 2) rows of triangles in plan (N, 3, 2) and (M, 3, 2) that have a common area (exact): no edge of
    one separates them."""
    native = native_module()
    orient2d, pairs = native.orient2d, native.meeting_boxes(first, second)
    one, other = first[pairs[:, 0]], second[pairs[:, 1]]
    apart = np.zeros(len(pairs), bool)
    for triangle, corners in ((one, other), (other, one)):
        turn = orient2d(*triangle.transpose(1, 0, 2))
        for i, j in _EDGES:
            sides = [orient2d(triangle[:, i], triangle[:, j], corners[:, k]) * turn for k in range(3)]
            apart |= np.max(sides, axis=0) <= 0
    return pairs[~apart]


def meet(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """(N,) bool: the triangles of `first` (N, 3, 3) that an edge of one of `second` (M, 3, 3) passes, or
    whose own edge passes one of these; touching counts, up to rounding."""
    pairs = native_module().meeting_boxes(first, second)
    is_met = np.zeros(len(first), bool)
    for start in range(0, len(pairs), 1 << 14):
        some = pairs[start : start + (1 << 14)]
        some = some[_straddles(first[some[:, 0]], second[some[:, 1]])]
        one, other = first[some[:, 0]], second[some[:, 1]]
        begin = np.concatenate([corners[:, i] for corners in (other, one) for i, _ in _EDGES])
        end = np.concatenate([corners[:, j] for corners in (other, one) for _, j in _EDGES])
        hit = segments_hit(begin, end, np.concatenate([one, one, one, other, other, other]))
        is_met[some[hit.reshape(6, -1).any(axis=0), 0]] = True
    return is_met


def _straddles(triangles: np.ndarray, others: np.ndarray) -> np.ndarray:
    """(K,) bool: whether the first triangle of each pair (K, 3, 3) has corners on both sides of the plane of
    the second one, or on it."""
    a, b, c = others.transpose(1, 0, 2)
    off = np.einsum("kij,kj->ki", triangles - a[:, None], cross(b - a, c - a))
    return (off.min(axis=1) <= 0) & (off.max(axis=1) >= 0)


def segments_hit(begin: np.ndarray, end: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """(K,) bool: whether the segment from begin to end (K, 3) meets the triangle of its row (K, 3, 3); one in
    its plane does not."""
    a, b, c = triangles.transpose(1, 0, 2)
    normal = cross(b - a, c - a)
    low, high = ((begin - a) * normal).sum(axis=1), ((end - a) * normal).sum(axis=1)
    crosses = ((low <= 0) & (high >= 0) | (low >= 0) & (high <= 0)) & (low != high)
    with np.errstate(divide="ignore", invalid="ignore"):
        share = np.where(crosses, low / (low - high), 0.0)
    at = begin + share[:, None] * (end - begin)
    for p, q in ((a, b), (b, c), (c, a)):
        crosses &= (cross(q - p, at - p) * normal).sum(axis=1) >= 0
    return crosses


def shares_hit(begin: np.ndarray, end: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """(K,) where segments that hit the plane of the triangle of their row do so, 0 to 1 of their lengths."""
    a, b, c = triangles.transpose(1, 0, 2)
    normal = cross(b - a, c - a)
    low, high = ((begin - a) * normal).sum(axis=1), ((end - a) * normal).sum(axis=1)
    return low / (low - high)


class NoTwoSidesError(Exception):
    """A surface that returns to itself the other way round; edge: its ends (2, 3)."""

    def __init__(self, edge: np.ndarray):
        super().__init__("one-sided")
        self.edge = edge


def oriented(vertices: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """The triangles (T, 3) int32, each turned so that it continues from its neighbors.

    The first triangle of each component is unchanged, unless most of the component then faces the opposite
    way to the first one. Edges that more than two triangles have connect none. Raises NoTwoSidesError.
    """
    same = welded(vertices)[triangles]
    edges = edges_of(same)
    owner = np.tile(np.arange(len(triangles)), 3)
    ends = np.sort(edges, axis=1)
    order = np.lexsort((ends[:, 1], ends[:, 0]))
    _, first, count = np.unique(ends[order], axis=0, return_index=True, return_counts=True)
    two = first[count == 2]
    left, right = order[two], order[two + 1]
    reversed_ = (edges[left] == edges[right]).all(axis=1)  # both go the same way along their edge
    neighbors: list[list[tuple[int, bool, int]]] = [[] for _ in triangles]
    pairs = zip(owner[left].tolist(), owner[right].tolist(), reversed_.tolist(), left.tolist(), strict=True)
    for one, other, turns, edge in pairs:
        neighbors[one].append((other, turns, edge))
        neighbors[other].append((one, turns, edge))
    turned = np.full(len(triangles), -1, np.int8)
    part = np.zeros(len(triangles), np.int64)
    parts = 0
    for start in range(len(triangles)):
        if turned[start] >= 0:
            continue
        turned[start], part[start] = 0, parts
        waiting = [start]
        while waiting:
            at = waiting.pop()
            for other, turns, edge in neighbors[at]:
                wanted = turned[at] ^ turns
                if turned[other] < 0:
                    turned[other], part[other] = wanted, parts
                    waiting.append(other)
                elif turned[other] != wanted:
                    raise NoTwoSidesError(vertices[edges[edge]])
        parts += 1
    result = np.where(turned[:, None] == 1, triangles[:, ::-1], triangles)
    if parts > 1:
        corners = vertices[result]
        normals = cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        facing = np.array([normals[part == number].sum(axis=0) for number in range(parts)])
        away = (dot(facing, facing[0]) < 0)[part]
        result = np.where(away[:, None], result[:, ::-1], result)
    return np.ascontiguousarray(result, np.int32)


def checked_triangulation(vertices: ArrayLike, triangles: ArrayLike) -> tuple[np.ndarray, np.ndarray]:
    """Vertices (V, 3) float64 and triangles (T, 3) int32, contiguous. Raises InputRefused."""
    try:
        vertices = np.ascontiguousarray(vertices, np.float64)
        triangles = np.asarray(triangles)
    except (TypeError, ValueError) as error:
        raise InputRefused("vertices or triangles are not an array of numbers") from error
    if vertices.ndim != 2 or vertices.shape[1] != 3:
        raise InputRefused(f"vertices must be an array (V, 3), not {vertices.shape}")
    if triangles.size == 0 or triangles.ndim != 2 or triangles.shape[1] != 3:
        raise InputRefused(f"triangles must be an array (T, 3) with T > 0, not {triangles.shape}")
    if not np.issubdtype(triangles.dtype, np.integer):
        raise InputRefused(f"triangles must be whole numbers, not {triangles.dtype}")
    if triangles.min() < 0 or triangles.max() >= len(vertices):
        bad = int(np.flatnonzero(((triangles < 0) | (triangles >= len(vertices))).any(axis=1))[0])
        raise InputRefused(
            f"triangle {bad} names vertices {triangles[bad].tolist()}",
            triangles=(bad,),
            advice=f"they are numbered from 0 to {len(vertices) - 1}",
        )
    if not np.isfinite(vertices).all():
        bad = int(np.flatnonzero(~np.isfinite(vertices).all(axis=1))[0])
        raise InputRefused(f"vertex {bad} is {place_text(vertices[bad])}, not finite")
    return vertices, np.ascontiguousarray(triangles, np.int32)


def fanned(offsets: np.ndarray, corners: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Polygons as triangles (T, 3) from their first corners, and the polygon (T,) of each."""
    size = np.diff(offsets)
    owner = np.repeat(np.arange(len(size)), np.maximum(size - 2, 0))
    first = offsets[owner]
    at = first + np.arange(len(owner)) - np.repeat(np.cumsum(size - 2) - (size - 2), size - 2) + 1
    return np.column_stack([corners[first], corners[at], corners[at + 1]]), owner


_FOLDED = 1e-12  # of the area of a polygon: what a triangle of its fan may stand out of it by rounding


def concave_divided(
    vertices: np.ndarray, triangles: np.ndarray, first: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """What replaces fans that do not lie within their polygons, as seen along the normal of these: rows (R,)
    of triangles (T, 3), which come fan by fan, new triangles (R, 3), and the fans (K,) of polygons that cross
    themselves, which stay. first: (F,) rows where fans begin."""
    corners = vertices[triangles]
    normals = cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    vector_areas = np.add.reduceat(normals, first)
    fan = np.repeat(np.arange(len(first)), np.diff(np.append(first, len(triangles))))
    turned = dot(normals, vector_areas[fan]) < -_FOLDED * dot(vector_areas, vector_areas)[fan]
    rows, replaced, crossing = [np.empty(0, np.int64)], [np.empty((0, 3), np.int32)], []
    ends = np.append(first[1:], len(triangles))
    for number in np.unique(fan[turned]).tolist():
        some = triangles[first[number] : ends[number]]
        ring = np.concatenate([some[0, :2], some[:, 2]])
        divided = _ears(vertices[ring], vector_areas[number])
        if divided is None:
            crossing.append(number)
            continue
        rows.append(np.arange(first[number], ends[number]))
        replaced.append(ring[divided])
    return np.concatenate(rows), np.concatenate(replaced), np.array(crossing, np.int64)


def _ears(ring: np.ndarray, normal: np.ndarray) -> np.ndarray | None:
    """(N - 2, 3) the triangles of a polygon (N, 3) by the numbers of its corners; where corners repeat, some
    of them are without area. None: it crosses itself."""
    native, axis = native_module(), int(np.abs(normal).argmax())
    i, j = (axis + 1) % 3, (axis + 2) % 3
    above = ring[:, axis] - ring[0, axis]
    plan = np.column_stack([ring[:, k] - (normal[k] / normal[axis]) * above for k in (i, j)])
    try:
        triangles = native.triangulate_polygon([plan])
    except native.InputError:
        return None
    if normal[axis] < 0:
        triangles = triangles[:, ::-1]
    return np.concatenate([triangles, np.zeros((len(ring) - 2 - len(triangles), 3), np.int32)])
