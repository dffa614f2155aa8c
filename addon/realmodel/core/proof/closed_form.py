# SPDX-License-Identifier: GPL-3.0-or-later
"""The block at a point of a rock mass with faults and bodies, from its sheets alone, without building. An
independent evaluation for tests and for the proof of a model: it shares with the builder only the
continuation of faults beyond their borders."""

from __future__ import annotations

import functools
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from ..base.algebra import dot
from ..base.exact import orient2d, orient3d
from ..base.sheet import Sheet
from ..base.triangles import distances_of_pairs, open_edges
from ..base.work import native_module
from ..settings.rules import RULES
from ..surfaces.sides import FaultShape, RockFaults

AIR = -1
_BASEMENT = -2  # below the first surface: no block, but there to be cut
_AT_ONCE = 1 << 20  # pairs of a point and a triangle
_EQUAL = 1e-12  # of a distance: as far as another


@dataclass(frozen=True)
class BodyOfRock:
    """A closed body with triangles facing outward. after: the surface of the rock mass after which it came.
    block: its number; AIR for a void."""

    shape: Sheet
    after: int
    block: int


@dataclass(frozen=True)
class ClosedForm:
    """One rock mass. rules: of its surfaces, oldest first. compartments: (C, F) int8 rows of sides; sheets:
    of each compartment one triangulation for each surface. blocks: the number of the block beneath each
    surface (AIR: none). region: triangles in plan that bound it, or None."""

    rules: Sequence[str]
    faults: RockFaults
    compartments: np.ndarray
    sheets: Sequence[Sequence[Sheet]]
    blocks: Sequence[int]
    base_elevation: float | None = None
    bodies: Sequence[BodyOfRock] = ()
    region: Sheet | None = None
    grids: dict[Sheet, PlanGrid] = field(default_factory=dict, compare=False)

    def _grid(self, shape: Sheet) -> PlanGrid:
        """The grid of a shape, cached."""
        if shape not in self.grids:
            self.grids[shape] = PlanGrid(shape.corners)
        return self.grids[shape]

    def compartments_of(self, points: np.ndarray) -> np.ndarray:
        """(N,) the compartment that each point lies in; -1 for none."""
        points = np.asarray(points, np.float64).reshape(-1, 3)
        columns = [self._sides(shape, points) for shape in self.faults.shapes]
        sides = np.column_stack(columns) if columns else np.zeros((len(points), 0), np.int8)
        sides = self.faults.without_dropped(sides)
        found = np.full(len(points), -1, np.int64)
        for number, row in enumerate(self.compartments):
            found[(sides == row).all(axis=1)] = number
        return found

    def _sides(self, shape: FaultShape, points: np.ndarray) -> np.ndarray:
        """(N,) the side of a fault on which each point lies; where its border is nearest, the side of its
        continuation."""
        corners = shape.vertices[shape.triangles]
        nearest = corners[_nearest_triangles(points, corners)]
        a, b, c = nearest.transpose(1, 0, 2)
        sides = orient3d(a, b, c, points)
        border = shape.vertices[open_edges(shape.vertices, shape.triangles)]
        away = distances_of_pairs(points, nearest)
        ends = _to_segments(points, border) <= away * (1 + _EQUAL)
        if ends.any():
            sides[ends] = nearest_side(points[ends], *self._continued(shape, points))
        return sides

    @staticmethod
    def _continued(shape: FaultShape, points: np.ndarray) -> Sheet:
        """A fault with its continuation beyond its border."""
        if not len(points):
            return Sheet(shape.vertices, shape.triangles)
        box = np.array([points.min(axis=0), points.max(axis=0)])
        beyond = native_module().structure_continuation(shape.native(), box).reshape(-1, 3)
        numbers = np.arange(len(shape.vertices), len(shape.vertices) + len(beyond)).reshape(-1, 3)
        return Sheet(np.concatenate([shape.vertices, beyond]), np.concatenate([shape.triangles, numbers]))

    def blocks_at(self, points: np.ndarray) -> np.ndarray:
        """(N,) the block at each point (N, 3); AIR for none. Points of no compartment are in none."""
        points = np.asarray(points, np.float64).reshape(-1, 3)
        where = self.compartments_of(points)
        blocks = np.full(len(points), AIR, np.int64)
        insides = [
            winding_numbers(points, *body.shape.arrays, self._grid(body.shape)) % 2 != 0
            for body in self.bodies
        ]
        for number, sheets in enumerate(self.sheets):
            here = np.flatnonzero(where == number)
            if len(here):
                blocks[here] = self._history(points[here], sheets, [inside[here] for inside in insides])
        if self.base_elevation is not None:
            blocks[points[:, 2] < self.base_elevation] = AIR
        if self.region is not None:
            grid = self._grid(self.region)
            blocks[np.isnan(heights_at(points[:, :2], *_flat(self.region).arrays, grid))] = AIR
        return blocks

    def _history(self, points: np.ndarray, sheets: Sequence[Sheet], insides) -> np.ndarray:
        """The block at points of one compartment."""
        every = [heights_at(points[:, :2], *sheet.arrays, self._grid(sheet)) for sheet in sheets]
        if self.region is None:  # the rock mass reaches as far as its surfaces
            reached = ~np.isnan(every).all(axis=0)
            insides = [inside & reached for inside in insides]
        has_base = self.base_elevation is not None
        return history(points[:, 2], every, self.rules, self.blocks, has_base, self.bodies, insides)


def history(
    z: np.ndarray,
    heights: Sequence[np.ndarray],
    rules: Sequence[str],
    blocks: Sequence[int],
    has_base: bool,
    bodies: Sequence[BodyOfRock] = (),
    insides: Sequence[np.ndarray] = (),
) -> np.ndarray:
    """(N,) the block at points, by the events oldest first; AIR for none. Base elevation and region are not
    looked at.

    z: (N,) of the points. heights: of each surface there (N,), NaN where it does not exist. rules, blocks: of
    each surface, as ClosedForm. insides: of each body (N,) bool.
    """
    state = np.full(len(z), AIR, np.int64)
    covered = np.zeros(len(z), bool)
    protected = np.zeros(len(z), bool)
    for k, (rule, at) in enumerate(zip(rules, heights, strict=True)):
        exists = ~np.isnan(at)
        below, above = exists & (z < at), exists & (z > at)
        if RULES[rule].cuts:
            state[above & ~protected] = AIR
        oldest = blocks[0] if k == 0 and has_base else _BASEMENT
        filled = below & (state == AIR)
        state[filled] = np.where(covered, blocks[k], oldest)[filled]
        covered |= exists
        if RULES[rule].protects:
            protected |= below | (exists & (state != AIR))
        for body, inside in zip(bodies, insides, strict=True):
            if body.after == k:
                state[inside & (has_base | (state != _BASEMENT))] = body.block
    state[state == _BASEMENT] = AIR
    return state


def _flat(region: Sheet) -> Sheet:
    vertices, triangles = region
    return Sheet(np.column_stack([vertices[:, :2], np.zeros(len(vertices))]), triangles)


def heights_at(
    plan: np.ndarray, vertices: np.ndarray, triangles: np.ndarray, grid: PlanGrid | None = None
) -> np.ndarray:
    """(N,) heights of a surface at plan points (N, 2); NaN where it has no triangle there (exact). grid: of
    its triangles, if there is one already."""
    heights = np.full(len(plan), np.nan)
    for points, rows in (grid or PlanGrid(vertices[triangles])).over(plan):
        a, b, c = vertices[triangles[rows]].transpose(1, 0, 2)
        p = plan[points]
        turns = [orient2d(u[:, :2], v[:, :2], p) for u, v in ((a, b), (b, c), (c, a))]
        within = np.all([turn >= 0 for turn in turns], axis=0) | np.all([turn <= 0 for turn in turns], axis=0)
        within &= np.any(turns, axis=0)
        heights[points[within]] = heights_in_plane(a[within], b[within], c[within], p[within])
    return heights


def heights_in_plane(a, b, c, plan) -> np.ndarray:
    """(N,) heights of the planes through three points each, at plan points."""
    (ux, uy, uz), (vx, vy, vz) = (b - a).T, (c - a).T
    x, y = (plan - a[:, :2]).T
    area = ux * vy - uy * vx
    return a[:, 2] + ((x * vy - y * vx) * uz + (ux * y - uy * x) * vz) / area


class PlanGrid:
    """Polygons (T, K, D) in the cells of a grid in plan, so that those over points are found quickly."""

    def __init__(self, corners: np.ndarray):
        plan = [corners[:, k, :2] for k in range(corners.shape[1])]
        self.low, self.high = functools.reduce(np.minimum, plan), functools.reduce(np.maximum, plan)
        if not len(corners):
            return
        # min(axis=0) would take several times as long
        self.origin = np.array([axis.min() for axis in self.low.T])
        self.last = np.array([axis.max() for axis in self.high.T])
        size = self.last - self.origin
        # no cells that are much smaller than polygons: where many lie over each other there would be too many
        usual = (self.high - self.low).mean(axis=0)
        most = int(np.min(size[usual > 0] / usual[usual > 0], initial=512))
        self.count = int(np.clip(int(np.sqrt(len(corners))), 1, max(1, most)))
        self.step = np.where(size > 0, size / self.count, 1.0)
        first, last = (self._cells(at) for at in (self.low, self.high))
        spans = last - first + 1
        each = spans[:, 0] * spans[:, 1]
        owner = np.repeat(np.arange(len(corners)), each)
        at = np.arange(each.sum()) - np.repeat(np.cumsum(each) - each, each)
        row, column = at // spans[owner, 1], at % spans[owner, 1]
        cell = (first[owner, 0] + row) * self.count + first[owner, 1] + column
        order = np.argsort(cell, kind="stable")
        self.owner = owner[order]
        self.begin = np.searchsorted(cell[order], np.arange(self.count**2 + 1))

    def _cells(self, plan: np.ndarray) -> np.ndarray:
        return np.clip((plan - self.origin) / self.step, 0, self.count - 1).astype(np.int64)

    def over(self, plan: np.ndarray):
        """Pairs of plan points (N, 2) and polygons whose boxes they are in, some at a time: rows of the
        points and of the polygons."""
        if not len(plan) or not len(self.low):
            return
        inside = ((plan >= self.origin) & (plan <= self.last)).all(axis=1)
        places = self._cells(plan)
        places = places[:, 0] * self.count + places[:, 1]
        number = np.where(inside, self.begin[places + 1] - self.begin[places], 0)
        ends = np.cumsum(number)
        start = 0
        while start < len(plan):
            stop = max(start + 1, int(np.searchsorted(ends, ends[start] - number[start] + _AT_ONCE, "right")))
            some = np.arange(start, stop)
            points = np.repeat(some, number[some])
            at = np.arange(len(points)) - np.repeat(np.cumsum(number[some]) - number[some], number[some])
            rows = self.owner[self.begin[places[points]] + at]
            near = ((plan[points] >= self.low[rows]) & (plan[points] <= self.high[rows])).all(axis=1)
            if near.any():
                yield points[near], rows[near]
            start = stop


def winding_numbers(
    points: np.ndarray, vertices: np.ndarray, triangles: np.ndarray, grid: PlanGrid | None = None
) -> np.ndarray:
    """(N,) how often a closed surface goes around each point: the signed count of its triangles above."""
    found = np.zeros(len(points), np.int64)
    corners = vertices[triangles]
    for rows, _, turn in triangles_above(points, corners, grid or PlanGrid(corners)):
        np.add.at(found, rows, turn)
    return found


def triangles_above(points: np.ndarray, corners: np.ndarray, grid: PlanGrid):
    """Pairs of points (N, 3) and triangles (T, 3, 3) above them, all of a point at a time: rows of the points
    and of the triangles, and +1 or -1, how these turn in plan. Exact: points on an edge in plan count as
    moved aside by less than any distance, those on a triangle as above it. grid: of the triangles."""
    for rows, above in grid.over(points[:, :2]):
        a, b, c = corners[above].transpose(1, 0, 2)
        p = points[rows]
        turns = [_moved_side(u[:, :2], v[:, :2], p[:, :2]) for u, v in ((a, b), (b, c), (c, a))]
        turn = np.where((turns[0] == turns[1]) & (turns[1] == turns[2]), turns[0], 0)
        hit = np.flatnonzero(turn)
        hit = hit[orient3d(a[hit], b[hit], c[hit], p[hit]) * turn[hit] < 0]
        yield rows[hit], above[hit], turn[hit]


def _moved_side(a: np.ndarray, b: np.ndarray, p: np.ndarray) -> np.ndarray:
    """orient2d of points moved by (e, e * e), e smaller than any number: never 0 where a and b differ."""
    side = orient2d(a, b, p)
    x, y = np.sign(b - a).T.astype(np.int8)
    return np.where(side != 0, side, np.where(y != 0, -y, x))


def nearest_side(points: np.ndarray, vertices: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """(N,) int8: the side of its nearest triangle on which each point lies, +1 where its corners are seen
    counter-clockwise. Of triangles equally near, at an edge or a corner, that which the point is farthest off
    the plane of counts. 0 on the plane."""
    corners = vertices[triangles]
    a, b, c = corners[_nearest_triangles(points, corners)].transpose(1, 0, 2)
    return orient3d(a, b, c, points)


def _nearest_triangles(points: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """(N,) the number of the triangle that nearest_side takes, of triangles (T, 3, 3)."""
    middles = corners.mean(axis=1)
    radius = np.linalg.norm(corners - middles[:, None], axis=2).max(axis=1)
    chosen = np.empty(len(points), np.int64)
    some = max(1, _AT_ONCE // len(corners))
    for start in range(0, len(points), some):
        part = points[start : start + some]
        apart = np.linalg.norm(part[:, None] - middles, axis=2)
        farthest = (apart + radius).min(axis=1)
        rows, near = np.nonzero(apart - radius <= farthest[:, None] * (1 + _EQUAL))
        chosen[start : start + some] = _nearest(part, rows, corners[near], near)
    return chosen


def _to_segments(points: np.ndarray, ends: np.ndarray) -> np.ndarray:
    """(N,) how far the nearest of segments (E, 2, 3) is from each point, up to rounding."""
    found = np.full(len(points), np.inf)
    for begin, end in ends:
        along = end - begin
        share = np.clip(dot(points - begin, along) / dot(along, along), 0.0, 1.0)
        found = np.minimum(found, np.linalg.norm(points - begin - share[:, None] * along, axis=1))
    return found


def _nearest(points: np.ndarray, rows: np.ndarray, corners: np.ndarray, numbers: np.ndarray) -> np.ndarray:
    """(N,) the nearest triangle of each point, of pairs: `rows` of points, triangles (K, 3, 3), `numbers`."""
    p = points[rows]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    size = np.linalg.norm(normal, axis=1)[:, None]
    normal /= np.where(size > 0, size, 1.0)  # one without an area comes last
    off = np.abs(((p - corners[:, 0]) * normal).sum(axis=1))
    away = distances_of_pairs(p, corners)
    least = np.full(len(points), np.inf)
    np.minimum.at(least, rows, away)
    rounding = 16 * np.spacing(np.abs(points).max(axis=1, initial=0.0))
    equal = away <= (least * (1 + _EQUAL) + rounding)[rows]
    order = np.lexsort((numbers, -off, ~equal, rows))
    first = order[np.concatenate([[True], np.diff(rows[order]) > 0])]
    return numbers[first]
