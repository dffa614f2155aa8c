# SPDX-License-Identifier: GPL-3.0-or-later
"""The lines where polygons of different classes meet, though their borders may be digitized twice.

Borders with equal vertices are found as they are. An edge whose other side has no polygon is divided at the
ends of others that lie on it; what then remains is compared with the borders of other polygons near it.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ...base.algebra import norm, ranks_in_runs, twice_area
from ...base.work import native_module, on_threads
from ...readers.unit_polygons import UnitPolygon

_ON_EDGE = 0.01  # of the spacing: an end so near to an edge lies on it
_BESIDE = 0.1  # of the spacing: borders so near are one, which was digitized twice
_GAP = 0.5  # of the spacing: borders so near are listed, as they may be meant to be one
_SHORT = 0.25  # of the spacing: shorter ones are not listed
_OPPOSITE = -0.5  # the cosine between two sides of one line
_PIECES = 0.5  # of that, the length of pieces that are compared
_NEIGHBORS = 48  # pieces in which one of another polygon is looked for

Pair = tuple[int, int]


@dataclass(frozen=True, eq=False)
class BorderLine:
    """A line between the areas of two classes, the lower number first. corners: (N, 2); a closed line does
    not repeat the first. polygons: (E, 2) the numbers of the polygons beside each of its edges."""

    classes: Pair
    corners: np.ndarray
    polygons: np.ndarray
    closed: bool


@dataclass(frozen=True)
class Apart:
    """Two polygons whose borders do not meet: along which length, and how far apart at most. joined: so near
    that they count as one line."""

    polygons: Pair
    length: float
    width: float
    joined: bool


@dataclass
class _Edges:
    """Edges of rings. ends: (E, 2) vertex numbers, with the polygon `owner` (E,) to the left."""

    ends: np.ndarray
    owner: np.ndarray

    def some(self, chosen: np.ndarray) -> _Edges:
        return _Edges(self.ends[chosen], self.owner[chosen])


def border_lines(
    polygons: Sequence[UnitPolygon], classes: np.ndarray, spacing: float
) -> tuple[list[BorderLine], list[Apart]]:
    """The lines between polygons of different classes (P,), and where borders that should be one are apart.
    spacing: of the places that are taken of the lines."""
    rings = [(number, ring) for number, polygon in enumerate(polygons) for ring in _turned(polygon)]
    corners = np.concatenate([ring for _, ring in rings])
    plan, vertex = np.unique(corners, axis=0, return_inverse=True)
    vertex = vertex.ravel()
    sizes = [len(ring) for _, ring in rings]
    follows = np.arange(1, len(corners) + 1)
    follows[np.cumsum(sizes) - 1] = np.cumsum(sizes) - sizes
    owner = np.repeat([number for number, _ in rings], sizes)
    edges = _Edges(np.stack([vertex, vertex[follows]], axis=1), owner)
    met, open_edges = _matched(edges, classes)
    divided = _at_ends(plan, open_edges, _ON_EDGE * spacing)
    more, open_edges = _matched(divided, classes)
    plan, near, apart = _near(plan, open_edges, classes, spacing)
    ends, sides = (np.concatenate(arrays) for arrays in zip(met, more, near, strict=True))
    return _lines(plan, ends, sides, classes), apart


def _turned(polygon: UnitPolygon) -> list[np.ndarray]:
    """The rings with the polygon to their left: outlines counter-clockwise, holes clockwise."""
    rings = []
    for number, ring in enumerate(polygon.rings):
        if polygon.has_roles:
            is_hole = number > 0
        else:
            others = polygon.rings[:number] + polygon.rings[number + 1 :]
            is_hole = bool(inside(others, 0.5 * (ring[:1] + ring[1:2]))[0])
        is_left = twice_area(ring) > 0
        rings.append(ring if is_left != is_hole else ring[::-1])
    return rings


def inside(rings: Sequence[np.ndarray], places: np.ndarray) -> np.ndarray:
    """(N,) bool: which places (N, 2) lie within rings, by the even-odd rule (exact)."""
    is_inside = np.zeros(len(places), bool)
    if not rings or not len(places):
        return is_inside
    begin = np.concatenate(rings)
    end = np.concatenate([np.roll(ring, -1, axis=0) for ring in rings])
    order = np.argsort(places[:, 1], kind="stable")
    y = places[order, 1]
    first = np.searchsorted(y, np.minimum(begin[:, 1], end[:, 1]))
    last = np.searchsorted(y, np.maximum(begin[:, 1], end[:, 1]))
    count = last - first
    edge = np.repeat(np.arange(len(begin)), count)
    at = order[ranks_in_runs(count) + np.repeat(first, count)]
    rises = begin[edge, 1] < end[edge, 1]
    lower, upper = (
        np.where(rises[:, None], *ends) for ends in ((begin[edge], end[edge]), (end[edge], begin[edge]))
    )
    turn = native_module().orient2d(lower, upper, np.ascontiguousarray(places[at]))
    np.logical_xor.at(is_inside, at, turn > 0)
    return is_inside


def _matched(edges: _Edges, classes: np.ndarray) -> tuple[tuple[np.ndarray, np.ndarray], _Edges]:
    """Edges that have one class on each side, as (ends, polygons on both sides); and those with nothing on
    one of their sides. Where polygons overlap, an edge has several classes on a side, and is none of both."""
    low, high = edges.ends.min(axis=1), edges.ends.max(axis=1)
    is_forward = edges.ends[:, 0] == low
    _, number = np.unique(np.stack([low, high], axis=1), axis=0, return_inverse=True)
    number = number.ravel()
    count = int(number.max(initial=-1)) + 1
    owner = np.full((count, 2), -1)
    is_one = np.ones(count, bool)
    for side in (0, 1):
        side_edges = np.flatnonzero(is_forward == (side == 0))[::-1]
        owner[number[side_edges], side] = edges.owner[side_edges]  # the first of several
        differ = classes[owner[number[side_edges], side]] != classes[edges.owner[side_edges]]
        is_one[number[side_edges[differ]]] = False
    ends = np.empty((count, 2), np.int64)
    ends[number] = np.stack([low, high], axis=1)
    both = (owner[:, 0] >= 0) & (owner[:, 1] >= 0)
    met = both & is_one & (classes[owner[:, 0]] != classes[owner[:, 1]])
    return (ends[met], owner[met]), edges.some(~both[number])


def _at_ends(plan: np.ndarray, edges: _Edges, near: float) -> _Edges:
    """Edges divided at the ends of others that lie on them, or as near as that."""
    if not len(edges.ends):
        return edges
    among = np.unique(edges.ends)
    begin, end = plan[edges.ends[:, 0]], plan[edges.ends[:, 1]]
    boxes = np.stack([np.minimum(begin, end) - near, np.maximum(begin, end) + near], axis=1)
    pairs = native_module().meeting_boxes(boxes, plan[among][:, None])
    edge, vertex = pairs[:, 0], among[pairs[:, 1]]
    way, to = end[edge] - begin[edge], plan[vertex] - begin[edge]
    length = norm(way)
    along = (to * way).sum(axis=1) / length
    across = np.abs(way[:, 0] * to[:, 1] - way[:, 1] * to[:, 0]) / length
    on = (
        (across <= near)
        & (along > 0)
        & (along < length)
        & (vertex != edges.ends[edge, 0])
        & (vertex != edges.ends[edge, 1])
    )
    edge, vertex, along = edge[on], vertex[on], along[on]
    every = np.concatenate([np.arange(len(edges.ends)), edge])
    start = np.concatenate([edges.ends[:, 0], vertex])
    order = np.lexsort((np.concatenate([np.full(len(edges.ends), -1.0), along]), every))
    every, start = every[order], start[order]
    is_last = np.append(every[1:] != every[:-1], True)
    stop = np.where(is_last, edges.ends[every, 1], np.append(start[1:], 0))
    return _Edges(np.stack([start, stop], axis=1), edges.owner[every])


def _near(
    plan: np.ndarray, edges: _Edges, classes: np.ndarray, spacing: float
) -> tuple[np.ndarray, tuple[np.ndarray, np.ndarray], list[Apart]]:
    """Of edges with nothing on one side the pieces with one of another polygon within reach: the plan with
    their ends, (ends, polygons) as of _matched, and the polygons that are apart. Pieces of the lower polygon
    stand for both."""
    nothing = (np.empty((0, 2), np.int64), np.empty((0, 2), np.int64))
    if len(np.unique(edges.owner)) < 2:
        return plan, nothing, []
    begin, way = plan[edges.ends[:, 0]], plan[edges.ends[:, 1]] - plan[edges.ends[:, 0]]
    length = norm(way)
    reach = _BESIDE * spacing
    count = np.maximum(np.ceil(length / (_PIECES * reach)), 1).astype(np.int64)
    edge = np.repeat(np.arange(len(count)), count)
    part = ranks_in_runs(count)
    middle = begin[edge] + ((part + 0.5) / count[edge])[:, None] * way[edge]
    owner = edges.owner[edge]
    number, away = native_module().nearest_points(middle, middle, _NEIGHBORS, execution=on_threads(0))
    is_other = (number >= 0) & (owner[number] != owner[:, None]) & (away <= _GAP * spacing)
    # polygons to the left: two sides of one line go opposite ways, two parts of the edge of the map do not
    toward = (way / length[:, None])[edge]
    is_other &= (toward[number] * toward[:, None]).sum(axis=2) < _OPPOSITE
    has = is_other.any(axis=1)
    best = is_other.argmax(axis=1)
    rows = np.arange(len(edge))
    other, width = owner[number[rows, best]], away[rows, best]
    has &= classes[owner] != classes[other]
    joined = has & (width <= reach)
    apart = []
    for some, is_joined in ((joined, True), (has & ~joined, False)):
        apart += _apart(owner[some], other[some], (length / count)[edge][some], width[some], is_joined)
    apart = [pair for pair in apart if pair.length >= _SHORT * spacing]
    pieces = np.flatnonzero(joined & (owner < other))
    # ends of pieces within edges are further vertices
    inner = np.flatnonzero(part > 0)
    vertex = edges.ends[edge, 0]
    vertex[inner] = len(plan) + np.arange(len(inner))
    within = begin[edge[inner]] + (part[inner] / count[edge[inner]])[:, None] * way[edge[inner]]
    is_last = np.append(edge[1:] != edge[:-1], True)
    stop = np.where(is_last, edges.ends[edge, 1], np.append(vertex[1:], 0))
    ends, sides = np.stack([vertex, stop], axis=1)[pieces], np.stack([owner, other], axis=1)[pieces]
    return np.concatenate([plan, within]), (ends, sides), apart


def _apart(
    owner: np.ndarray, other: np.ndarray, length: np.ndarray, width: np.ndarray, joined: bool
) -> list[Apart]:
    pairs = np.sort(np.stack([owner, other], axis=1), axis=1)
    distinct, row = np.unique(pairs, axis=0, return_inverse=True)
    along = np.bincount(row.ravel(), length, len(distinct)) / 2  # both borders
    widest = np.zeros(len(distinct))
    np.maximum.at(widest, row.ravel(), width)
    return [
        Apart((a, b), far, wide, joined)
        for (a, b), far, wide in zip(distinct.tolist(), along.tolist(), widest.tolist(), strict=True)
    ]


def _lines(plan: np.ndarray, ends: np.ndarray, sides: np.ndarray, classes: np.ndarray) -> list[BorderLine]:
    """The lines that edges make, each between two classes, from where it branches or ends to the next such
    place."""
    of = np.sort(classes[sides], axis=1)
    keys, number = np.unique(of, axis=0, return_inverse=True)
    lines = []
    for key, pair in enumerate(keys.tolist()):
        pair_edges = np.flatnonzero(number.ravel() == key)
        for walk, edges, closed in _walks(ends[pair_edges]):
            corners = plan[walk]
            lines.append(BorderLine((pair[0], pair[1]), corners, sides[pair_edges[edges]], closed))
    return lines


def _walks(ends: np.ndarray) -> list[tuple[list[int], list[int], bool]]:
    """Vertices and edges of each line, and whether it is closed."""
    at = defaultdict(list)
    for edge, (a, b) in enumerate(ends.tolist()):
        at[a].append((edge, b))
        at[b].append((edge, a))
    done = np.zeros(len(ends), bool)
    walks = []

    def walk(begin: int, edge: int, to: int) -> None:
        vertices, edges = [begin, to], [edge]
        done[edge] = True
        while len(at[to]) == 2 and to != begin:
            edge, further = next(((e, v) for e, v in at[to] if not done[e]), (-1, -1))
            if edge < 0:
                break
            done[edge], to = True, further
            vertices.append(to)
            edges.append(edge)
        closed = to == begin and len(at[to]) == 2
        walks.append((vertices[:-1] if closed else vertices, edges, closed))

    for only_ends in (True, False):
        for begin in sorted(at):
            if only_ends and len(at[begin]) == 2:
                continue
            for edge, to in at[begin]:
                if not done[edge]:
                    walk(begin, edge, to)
    return walks


def places_along(line: BorderLine, spacing: float) -> tuple[np.ndarray, np.ndarray]:
    """(N, 2) places on a line about as far apart as the spacing, at its corners where there are some; and
    (N,) the edge that each lies on or begins."""
    corners = np.concatenate([line.corners, line.corners[:1]]) if line.closed else line.corners
    way = np.diff(corners, axis=0)
    length = norm(way)
    reached = np.concatenate([[0.0], np.cumsum(length)])
    count = max(int(np.rint(reached[-1] / spacing)), 1)
    wanted = (np.arange(count) + 0.5) * (reached[-1] / count)
    edge = np.clip(np.searchsorted(reached, wanted, "right") - 1, 0, len(length) - 1)
    share = np.divide(wanted - reached[edge], length[edge])
    places = corners[edge] + share[:, None] * way[edge]
    if len(corners) > 2:
        inner = reached[1:-1]
        nearest = np.clip(np.searchsorted(inner, wanted), 1, max(len(inner) - 1, 1))
        left, right = nearest - 1, np.minimum(nearest, len(inner) - 1)
        nearest = np.where(np.abs(inner[left] - wanted) <= np.abs(inner[right] - wanted), left, right)
        is_near = np.abs(inner[nearest] - wanted) <= 0.5 * reached[-1] / count
        places[is_near] = corners[1:-1][nearest[is_near]]
        edge[is_near] = nearest[is_near] + 1
    _, first = np.unique(places, axis=0, return_index=True)
    first.sort()
    return places[first], edge[first]
