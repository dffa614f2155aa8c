# SPDX-License-Identifier: GPL-3.0-or-later
"""Surfaces of faults through sticks or scattered points: not functions of x and y."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator, Sequence

import numpy as np

from ...base.algebra import ascending, dot, norm, principal_axes
from ...base.elementary import cos, sin
from ...base.errors import InputRefused
from ...base.sheet import Sheet
from ...base.work import Work
from ...heights import Task, heights
from ...settings.mesh_sizes import AUTO
from ...settings.methods import checked_options
from ...surfaces.planar_mesh import MeshOptions, mesh_rings

_METHOD = "dsi"  # smooth, through the points, and goes on beyond them without a bend
_IN_LINE = 1e-9  # of the longest extent: points so near a line bound no area
_TRIED = 100  # points of a path: so many are tried as the first one, and parts of the path are turned round
_NEIGHBORS = 3  # on either side of a stick, for the direction of its extension
_ROUND = 16  # directions of an outline that is extended


def fit_sticks(sticks: Sequence[np.ndarray], extend: float = 0.0, extend_sideways: bool = True) -> Sheet:
    """The surface through fault sticks: their points, and triangles between neighbors.

    sticks: arrays (N, 3), in any order, as are the points of each. extend: how far each stick goes on at both
    ends, and, if extend_sideways, the surface beyond the first and the last one. Returns vertices (V, 3)
    float64 and triangles (T, 3) int32. Neighbors are joined at equal shares of their lengths, so sticks keep
    their shape. Raises InputRefused.
    """
    sticks = [_along(np.asarray(stick, np.float64).reshape(-1, 3)) for stick in sticks]
    sticks = list({stick.tobytes(): stick for stick in sticks if len(stick) > 1}.values())
    if len(sticks) < 2:
        raise InputRefused(
            f"a surface needs two sticks of two points or more, there {'is' if len(sticks) == 1 else 'are'} "
            f"{len(sticks)}",
            advice="give more sticks, or a mesh",
        )
    middles = np.array([(stick.min(axis=0) + stick.max(axis=0)) / 2 for stick in sticks])
    sticks = _one_way([sticks[number] for number in _path(middles)])
    if extend > 0:
        sticks = _longer(sticks, extend)
        if extend_sideways:
            first = sticks[0] + extend * _unit(sticks[0].mean(axis=0) - sticks[1].mean(axis=0))
            last = sticks[-1] + extend * _unit(sticks[-1].mean(axis=0) - sticks[-2].mean(axis=0))
            sticks = [first, *sticks, last]
    begin = np.cumsum([0, *map(len, sticks)])
    between = [
        triangle
        for number, (left, right) in enumerate(itertools.pairwise(sticks))
        for triangle in _between(left, right, int(begin[number]), int(begin[number + 1]))
    ]
    vertices = np.concatenate(sticks)
    triangles = np.array(between, np.int32).reshape(-1, 3)
    first, second, third = vertices[triangles].transpose(1, 0, 2)
    has_area = (np.cross(second - first, third - first) != 0).any(axis=1)
    return Sheet(vertices, np.ascontiguousarray(triangles[has_area]))


def _along(stick: np.ndarray) -> np.ndarray:
    """The points of a stick from one end to the other, each once."""
    points = np.unique(stick + 0.0, axis=0)
    return points[_path(points)]


def _path(points: np.ndarray) -> list[int]:
    """The numbers of points (N, 3), in order along a line: of a few orders the one with the shortest path, in
    which no part is shorter if it is turned round. The order in which they are given does not matter."""
    rank = ascending(*points.T)
    points = points[rank]
    _, axes = principal_axes(points)
    along = dot(points, axes[0])
    starts = range(len(points)) if len(points) <= _TRIED else (int(along.argmin()), int(along.argmax()))
    orders = [np.argsort(along, kind="stable").tolist(), *(_nearest_first(points, start) for start in starts)]
    lengths = [norm(np.diff(points[order], axis=0)).sum() for order in orders]
    order = orders[int(np.argmin(lengths))]
    if len(order) <= _TRIED:
        _turn_parts(points, order)
    return rank[order if order[0] < order[-1] else order[::-1]].tolist()


def _nearest_first(points: np.ndarray, start: int) -> list[int]:
    order, free = [start], np.ones(len(points), bool)
    free[start] = False
    while free.any():
        away = np.where(free, norm(points - points[order[-1]]), np.inf)
        order.append(int(away.argmin()))
        free[order[-1]] = False
    return order


def _turn_parts(points: np.ndarray, order: list[int]) -> None:
    """Turns parts of a path round as long as this makes it shorter (2-opt; Croes 1958)."""
    away = norm(points[:, None] - points[None])
    count, is_changed = len(order), True
    while is_changed:
        is_changed = False
        for first, last in itertools.combinations(range(count), 2):
            a, b, c, d = order[first - 1], order[first], order[last], order[(last + 1) % count]
            before = (away[a, b] if first else 0.0) + (away[c, d] if last + 1 < count else 0.0)
            after = (away[a, c] if first else 0.0) + (away[b, d] if last + 1 < count else 0.0)
            if after < before * (1 - _IN_LINE):
                order[first : last + 1] = order[first : last + 1][::-1]
                is_changed = True


def _one_way(sticks: list[np.ndarray]) -> list[np.ndarray]:
    """All sticks from their upper end down; level ones in the direction of the previous stick."""
    aligned, before = [], np.array([0.0, 0.0, -1.0])
    for stick in sticks:
        direction = stick[-1] - stick[0]
        same = dot(direction, before)
        if same < 0 or (same == 0 and direction[2] > 0):
            stick, direction = stick[::-1], -direction
        aligned.append(stick)
        before = _unit(direction)
    return aligned


def _unit(direction: np.ndarray) -> np.ndarray:
    length = norm(direction)
    return direction / length if length > 0 else direction


def _longer(sticks: list[np.ndarray], by: float) -> list[np.ndarray]:
    """Extends each stick at both ends in the mean direction of its own end and its neighbors', so that sticks
    that are not quite parallel do not cross."""
    ends = np.array([[_unit(stick[0] - stick[1]), _unit(stick[-1] - stick[-2])] for stick in sticks])
    longer = []
    for number, stick in enumerate(sticks):
        near = ends[max(0, number - _NEIGHBORS) : number + _NEIGHBORS + 1].mean(axis=0)
        begin, end = stick[0] + by * _unit(near[0]), stick[-1] + by * _unit(near[1])
        longer.append(np.concatenate([begin[None], stick, end[None]]))
    return longer


def _between(
    left: np.ndarray, right: np.ndarray, first_left: int, first_right: int
) -> Iterator[tuple[int, int, int]]:
    """The triangles of the strip between two sticks, as vertex numbers."""
    at_left, at_right = _shares(left), _shares(right)
    i = j = 0
    while i + 1 < len(left) or j + 1 < len(right):
        goes_left = j + 1 == len(right) or (i + 1 < len(left) and at_left[i + 1] <= at_right[j + 1])
        apex = (first_left + i, first_right + j)
        if goes_left:
            i += 1
            yield (*apex, first_left + i)
        else:
            j += 1
            yield (*apex, first_right + j)


def _shares(stick: np.ndarray) -> np.ndarray:
    """The position of each point along a stick, from 0 to 1."""
    way = np.concatenate([[0.0], norm(np.diff(stick, axis=0)).cumsum()])
    return way / way[-1]


def fit_points(work: Work, points: np.ndarray, extend: float = 0.0, extend_sideways: bool = True) -> Sheet:
    """The smooth surface through scattered points, over the plane that fits them best.

    points: (P, 3). The plane is that of the least squares of distances; on it the points' convex outline is
    meshed, and their distances from the plane are interpolated (discrete smooth interpolation). extend: how
    far the outline goes on beyond the points; with extend_sideways False up and down the dip only. Returns
    vertices (V, 3) float64, triangles (T, 3) int32. Raises InputRefused.
    """
    points = np.asarray(points, np.float64).reshape(-1, 3)
    points = points[ascending(*points.T)]  # the order of rows must not decide a result
    middle = points.mean(axis=0)
    spread, axes = principal_axes(points)
    if len(points) < 3 or spread[1] <= _IN_LINE * spread[0]:
        what = "its points lie in one line: they show no surface"
        raise InputRefused(what, advice="give points on the whole fault, or sticks")
    along, down, normal = plane_axes(axes[2])
    local = np.column_stack([dot(points - middle, axis) for axis in (along, down, normal)])
    outline = _outline(local[:, :2], extend, extend_sideways)
    nodes, triangles = mesh_rings(work, [outline], MeshOptions(AUTO, points=local[:, :2]))
    options = checked_options(_METHOD, {})
    task = Task(work, np.ascontiguousarray(local), nodes, options, triangles)
    interpolation = heights(_METHOD, task)
    vertices = middle + nodes[:, :1] * along + nodes[:, 1:] * down + interpolation.z[:, None] * normal
    return Sheet(vertices, triangles)


def plane_axes(normal: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The axes of a plane: its strike, its dip (downward), and its normal, of length 1 and at right
    angles."""
    along = np.array([-normal[1], normal[0], 0.0])
    along = _unit(along) if norm(along) > _IN_LINE else np.array([1.0, 0.0, 0.0])
    down = np.cross(normal, along)
    if down[2] > 0:
        along, down = -along, -down
    return along, down, np.cross(along, down)


def _outline(plan: np.ndarray, extend: float, sideways: bool) -> np.ndarray:
    if extend > 0 and sideways:
        angles = np.arange(_ROUND) * (2 * np.pi / _ROUND)
        moves = extend * np.column_stack([cos(angles), sin(angles)])
    else:
        moves = np.array([[0.0, extend], [0.0, -extend]]) if extend > 0 else np.zeros((1, 2))
    return convex_hull((convex_hull(plan)[:, None] + moves).reshape(-1, 2))


def convex_hull(plan: np.ndarray) -> np.ndarray:
    """(N, 2) corners of the convex hull of points, counter-clockwise (Andrew's monotone chain)."""
    points = np.unique(plan, axis=0).tolist()

    def half(ordered: Iterable[list[float]]) -> list[list[float]]:
        chain: list[list[float]] = []
        for x, y in ordered:
            while len(chain) > 1:
                (ax, ay), (bx, by) = chain[-2:]
                if (bx - ax) * (y - ay) - (by - ay) * (x - ax) > 0:
                    break
                chain.pop()
            chain.append([x, y])
        return chain[:-1]

    return np.array(half(points) + half(points[::-1]))
