# SPDX-License-Identifier: GPL-3.0-or-later
"""Polygons from directed edges in plan: rings that do not cross, holes with their outlines."""

from __future__ import annotations

from collections import defaultdict

import numpy as np

from ..base.algebra import dot, twice_area
from ..base.errors import BuildFailed
from ..base.work import native_module

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
    """Closed walks along the edges. Where several edges begin at a vertex a walk goes on along the one that
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
    """Whether a ring lies in another one that it does not cross: one of its vertices that is no vertex of
    that, or the middle of an edge, is inside."""
    free_vertices = ring[~np.isin(ring, outline)]
    place = points[free_vertices[0]] if len(free_vertices) else (points[ring[0]] + points[ring[1]]) / 2
    a, b = points[outline], points[np.roll(outline, -1)]
    crosses = (a[:, 1] <= place[1]) != (b[:, 1] <= place[1])
    a, b = a[crosses], b[crosses]
    side = native_module().orient2d(a, b, np.broadcast_to(place, a.shape))
    return bool(((side > 0) == (b[:, 1] > a[:, 1])).sum() % 2)
