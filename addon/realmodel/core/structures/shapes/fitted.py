# SPDX-License-Identifier: GPL-3.0-or-later
"""Surfaces of faults through sticks or scattered points: not functions of x and y."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from ...base.algebra import ascending, begins_run, cos, dot, norm, principal_axes, sin
from ...base.errors import InputRefused, number_list, place_text
from ...base.triangles import Sheet
from ...base.work import Work, native_module
from ...heights import Task, heights
from ...project.structure_entries import Fault
from ...readers.fault_input import FaultLines, read_fault_trace
from ...settings.dips import Dips, SpaceDips
from ...settings.directions import COMPASS, checked_direction, degrees_text, unit_vector
from ...settings.meshers import AUTO
from ...settings.methods import checked_options
from ...surfaces.planar_mesh import MeshOptions, mesh_rings
from .ground import Top, heights_on, levels_of, plan_of

_METHOD = "dsi"  # smooth, through the points, and continues beyond them without a bend
_IN_LINE = 1e-9  # of the longest extent: points so near a line bound no area
_TRIED = 100  # points of a path: so many are tried as the first one, and parts of the path are turned round
_NARROW = 0.1  # of their length: of points that are so narrow a strip dips say better how it is turned
_NEIGHBORS = 3  # on either side of a stick, for the direction of its extension
_ROUND = 16  # directions of an outline that is extended


def fit_sticks(sticks: Sequence[np.ndarray], extend: float = 0.0, extend_sideways: bool = True) -> Sheet:
    """The surface through fault sticks: their points, and triangles between neighbors.

    sticks: arrays (N, 3), in any order, as are the points of each. extend: how far each stick continues at
    both ends, and, if extend_sideways, the surface beyond the first and the last one. Returns vertices (V, 3)
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


def fit_points(
    work: Work,
    points: np.ndarray,
    extend: float = 0.0,
    extend_sideways: bool = True,
    dips: SpaceDips | None = None,
) -> Sheet:
    """The smooth surface through scattered points, over the plane that fits them best.

    points: (P, 3). The plane is that of the least squares of distances; on it the points' convex outline is
    meshed, and their distances from the plane are interpolated (discrete smooth interpolation). extend: how
    far the outline continues beyond the points; with extend_sideways False up and down the dip only. dips: of
    the surface, checked; the direction of their normals does not matter. Where the points show no plane, it
    is that of the dips. Returns vertices (V, 3) float64, triangles (T, 3) int32. Raises InputRefused.
    """
    points = np.asarray(points, np.float64).reshape(-1, 3)
    points = points[ascending(*points.T)]  # the order of rows must not decide a result
    dips = None if dips is None or not dips.in_use.any() else dips
    if dips is not None and not _shows_plane(points, _NARROW):
        points, axes, slopes = *_ruled(points, dips, extend), None
    elif _shows_plane(points, _IN_LINE):
        axes = plane_axes(principal_axes(points)[1][2])
        slopes = None if dips is None else _slopes(dips, points.mean(axis=0), axes)
    else:
        what = "its points lie in one line: they show no surface"
        raise InputRefused(what, advice="give points on the whole fault, its dips, or sticks")
    middle = points.mean(axis=0)
    local = np.column_stack([dot(points - middle, axis) for axis in axes])
    outline = _outline(local[:, :2], extend, extend_sideways)
    nodes, triangles = mesh_rings(work, [outline], MeshOptions(AUTO, points=local[:, :2]))
    options = checked_options(_METHOD, {})
    task = Task(work, np.ascontiguousarray(local), nodes, options, triangles, dips=slopes)
    interpolation = heights(_METHOD, task)
    along, down, normal = axes
    vertices = middle + nodes[:, :1] * along + nodes[:, 1:] * down + interpolation.z[:, None] * normal
    return Sheet(vertices, triangles)


def _shows_plane(points: np.ndarray, narrow: float) -> bool:
    spread = principal_axes(points)[0]
    return len(points) > 2 and bool(spread[1] > narrow * spread[0])


def _ruled(
    points: np.ndarray, dips: SpaceDips, extend: float
) -> tuple[np.ndarray, tuple[np.ndarray, np.ndarray, np.ndarray]]:
    """Points in about one line, with copies of them at both sides in the plane that their dips show, so that
    the surface continues sideways as it is; and the axes of that plane."""
    spread, (line, _, _) = principal_axes(points)
    normals = dips.normals[dips.in_use]
    normals = normals / norm(normals)[:, None]
    normal = (normals * np.where(dot(normals, normals[0]) < 0, -1.0, 1.0)[:, None]).mean(axis=0)
    far = max(extend, float(spread[0]))
    if far == 0:
        advice = "say with extend = ... how far it goes"
        raise InputRefused("its points are in one place: they show no surface", advice=advice)
    if spread[0] > 0:
        normal = normal - dot(normal, line) * line
        if norm(normal) < _NARROW:
            raise InputRefused("its dips are at right angles to its points", advice="correct the dips")
    axes = plane_axes(_unit(normal))
    moves = [far * axes[0], far * axes[1]] if spread[0] == 0 else [far * np.cross(axes[2], line)]
    return np.concatenate([points, *(points + side * move for move in moves for side in (-1, 1))]), axes


def _slopes(dips: SpaceDips, middle: np.ndarray, axes: Sequence[np.ndarray]) -> Dips | None:
    """Dips as slopes over a plane; those at right angles to it say nothing there."""
    places, normals = dips.positions[dips.in_use] - middle, dips.normals[dips.in_use]
    plan = np.column_stack([dot(places, axis) for axis in axes[:2]])
    along, down, up = (dot(normals, axis) for axis in axes)
    has_slope = np.abs(up) > _NARROW * norm(normals)
    if not has_slope.any():
        return None
    gradients = -np.column_stack([along, down])[has_slope] / up[has_slope, None]
    return Dips(plan[has_slope], gradients).merged()[0]


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


VERTICAL = 90.0
_ALONG = math.sin(math.radians(15.0))  # of the angle between trace and dip direction: less is along the trace
_OBLIQUE = math.cos(math.radians(30.0))  # of the angle to the normal of the trace: beyond, a warning
_END = 0.1  # of the length of a line: so much of it at an end gives the direction of its continuation
_PIECES = 256  # of the extent of the rock in plan: so long are the pieces of a line that is put on the ground
_STRAIGHT = 1e-5  # of the same extent: what leaves a straight line by less needs no vertex
_DETOUR = 1.1  # a trace is not longer than the shortest way through its points by more
_MOST_LINES = 1000


def read_trace(fault: Fault, units: str) -> tuple[Fault, list[str]]:
    """The fault with its trace as one line (N, 3), z NaN where it has none, and with the dip of the file's
    attributes if it has none; and warnings. Raises InputRefused."""
    text_or_file = fault.trace_file or (fault.trace if isinstance(fault.trace, str) else None)
    fault_lines = (
        FaultLines(_lines_of(fault.trace)) if text_or_file is None else read_fault_trace(text_or_file, units)
    )
    line, warnings = _joined([line[begins_run(line[:, :2])] for line in fault_lines.lines])
    if (line[0, :2] == line[-1, :2]).all():
        raise InputRefused(
            f"its trace returns to where it begins, {place_text(line[0, :2])}",
            advice="cut it open, or give the fault as a mesh",
            place=tuple(line[0, :2].tolist()),
        )
    if fault.elevation is None and (line[:, 2] == 0.0).all() and fault.trace_file is not None:
        text = "its line has elevation 0 everywhere; if that is no elevation, set elevation = ..."
        warnings.append(text)
    dip = fault_lines.dip() if fault.dip is None else fault.dip
    direction = checked_direction("dip_direction", fault.dip_direction)
    if direction is None and dip != VERTICAL:
        direction = fault_lines.dip_direction()
    if dip is None:
        what = "it has no dip, and its file has no attribute 'dip'"
        raise InputRefused(what, advice="set dip = ... (90 where the fault is vertical)")
    if dip != VERTICAL and direction is None:
        one, other = (degrees_text(side) for side in _sides(line))
        raise InputRefused(
            "it has a dip, but no dip direction",
            advice=f"set dip_direction = {one} or {other}, the two sides of its trace",
        )
    level = fault.elevation
    level = level if level is None or isinstance(level, str) else float(level)
    return replace(fault, trace=line, dip=float(dip), dip_direction=direction, elevation=level), warnings


def trace_surface(work: Work, fault: Fault, tops: list[Top]) -> tuple[Sheet, list[str]]:
    """The surface through the trace of a fault that read_trace returned, vertices (V, 3) float64 and
    triangles (T, 3) int32; and warnings.

    tops: of each rock mass that it displaces, the RockInput, and the number of the surface that the line is
    on where it has no elevation, or None. A number as direction is that of the dip, and all rulings are
    parallel to it; a point of the compass is the side to which the plane through both ends dips. Raises
    InputRefused.
    """
    plan, (low, high) = plan_of(tops), levels_of(tops, fault.trace_line()[:, 2])
    extent = float(norm(plan[1] - plan[0]))
    margin = (high - low) + extent / 4
    low, high = low - margin, high + margin
    line, is_given = _with_heights(work, fault, tops, extent)
    run, toward = _dip_of(fault, line)
    # where the surface cuts the level `high`: a line along its strike
    top = _at_level(line, high, run, toward)
    is_kept, is_given = _once_each(top, is_given)
    line, top = line[is_kept], top[is_kept]
    is_kept = is_given | _bends(top, is_given, _STRAIGHT * extent)
    line, top = line[is_kept], top[is_kept]
    warnings = [] if fault.dip in (None, VERTICAL) else _compare(top, toward, fault.dip)
    down = run * (high - low) * toward
    ends = None
    if fault.extend > 0:
        ends = _continuation(line, run, toward, [fault.extend, fault.extend])
    elif not fault.dies_out:
        # the rulings at its ends are beside the rock then, whatever the direction
        far = [max(_farthest(plan, end), _farthest(plan, end + down)) + extent for end in top[[0, -1]]]
        ends = _continuation(line, run, toward, far)
    if ends is not None:
        line, top = (_continued(row, ends) for row in (line, top))
    _refuse_crossing(top)
    _refuse_unsorted(fault.trace_line()[:, :2])
    rows = [
        np.column_stack([top, np.full(len(top), high)]),
        np.column_stack([top + down, np.full(len(top), low)]),
    ]
    if fault.dip != VERTICAL:
        # the surface holds the points that were given, not points beside them by what rounding moved these:
        # where the trace ends at a wall of the rock, a sliver would lie between the two
        rows.insert(1, line)
    return Sheet(np.concatenate(rows), _strips(len(rows), len(top))), warnings


def _at_level(line: np.ndarray, level: float, run: float, toward: np.ndarray) -> np.ndarray:
    """The points (N, 2) where the rulings through those of a line (N, 3) reach a level."""
    return line[:, :2] if run == 0.0 else line[:, :2] - (run * (level - line[:, 2]))[:, None] * toward


def _strips(rows: int, count: int) -> np.ndarray:
    """The triangles (T, 3) int32 between rows of so many vertices, the highest row first."""
    first = np.arange(count - 1)
    strips = []
    for above in range(0, (rows - 1) * count, count):
        here, below = above + first, above + count + first
        strips += [np.column_stack([below, below + 1, here + 1]), np.column_stack([below, here + 1, here])]
    return np.concatenate(strips).astype(np.int32)


def _farthest(plan: np.ndarray, place: np.ndarray) -> float:
    """The distance of a place (2,) from the farthest point of a box (2, 2)."""
    return float(norm(np.abs(plan - place).max(axis=0)))


def _lines_of(trace: Any) -> list[np.ndarray]:
    """The lines (N, 3) of arrays (N, 2) or (N, 3)."""
    several = len(trace) and np.ndim(trace[0]) > 1
    lines = []
    for number, points in enumerate(trace if several else [trace], 1):
        name = f"line {number} of the trace" if several else "the trace"
        try:
            line = np.array(points, np.float64)
        except (TypeError, ValueError) as error:
            raise InputRefused(f"{name} must be an array (N, 2) or (N, 3)") from error
        if line.ndim != 2 or line.shape[1] not in (2, 3):
            raise InputRefused(f"{name} must be an array (N, 2) or (N, 3), not {line.shape}")
        if line.shape[1] == 2:
            line = np.column_stack([line, np.full(len(line), np.nan)])
        bad = np.flatnonzero(~np.isfinite(line[:, :2]).all(axis=1) | np.isinf(line[:, 2]))
        if len(bad):
            raise InputRefused(f"point {bad[0]} of {name} is {place_text(line[bad[0]])}, not finite")
        lines.append(line)
    return lines


def _joined(lines: list[np.ndarray]) -> tuple[np.ndarray, list[str]]:
    """The pieces of a trace as one line: ends that are nearest to one another are joined, first those with
    the smallest gap. Refuses pieces that do not continue from one another."""
    lines = [line for line in lines if len(line) > 1]
    if not lines:
        raise InputRefused("its trace has no length in plan", advice="give two points or more")
    if len(lines) > _MOST_LINES:
        what = f"its trace has {len(lines)} lines"
        raise InputRefused(what, advice="choose the lines of one fault with where = { ... }")
    ends = np.array([line[at, :2] for line in lines for at in (0, -1)])
    one, other = np.triu_indices(len(ends), 1)
    one, other = one[one // 2 != other // 2], other[one // 2 != other // 2]
    gaps = norm(ends[one] - ends[other])
    joins: dict[int, int] = {}
    chain = np.arange(len(lines))
    for pair in np.argsort(gaps, kind="stable").tolist():
        a, b = int(one[pair]), int(other[pair])
        if a in joins or b in joins or chain[a // 2] == chain[b // 2]:
            continue
        joins[a], joins[b] = b, a
        chain[chain == chain[a // 2]] = chain[b // 2]
        if len(joins) == 2 * len(lines) - 2:
            break
    at = next(end for end in range(len(ends)) if end not in joins)
    order, bridged = [lines[at // 2][:: -1 if at % 2 else 1]], []
    while (before := at ^ 1) in joins:
        at = joins[before]
        piece = lines[at // 2][:: -1 if at % 2 else 1]
        _refuse_turning_back(order[-1], piece)
        bridged.append(float(norm(piece[0, :2] - order[-1][-1, :2])))
        order.append(piece)
    line = np.concatenate(order)
    line = line[begins_run(line[:, :2])]
    open_gaps = [gap for gap in bridged if gap > 0]
    if not open_gaps:
        return line, []
    text = f"gaps of {number_list(f'{gap:.6g}' for gap in open_gaps)} between the {len(lines)} lines of its "
    return line, [text + "trace are bridged by straight lines"]


def _refuse_unsorted(line: np.ndarray) -> None:
    """Refuses a line (N, 2) whose points another order joins by a much shorter way."""
    if len(line) > _TRIED:
        return
    ways = [float(norm(np.diff(points, axis=0)).sum()) for points in (line, line[_path(line)])]
    if ways[0] > _DETOUR * ways[1]:
        raise InputRefused(
            f"the points of its trace are not in order along it: in another order it is {ways[1]:.6g} long, "
            f"not {ways[0]:.6g}",
            advice="sort them along the trace, or give them as points with dips",
            place=tuple(line[0].tolist()),
        )


def _refuse_turning_back(before: np.ndarray, after: np.ndarray) -> None:
    """Refuses two pieces of a trace of which the second does not continue from the first."""
    gap = after[0, :2] - before[-1, :2]
    steps = [before[-1, :2] - before[0, :2], gap, after[-1, :2] - after[0, :2]]
    steps = [step for step in steps if step.any()]
    turns_back = any(dot(a, b) < 0 for a, b in itertools.combinations(steps, 2))
    if turns_back or norm(gap) > max(norm(steps[0]), norm(steps[-1])):
        raise InputRefused(
            f"the lines of its trace are not connected at {place_text(before[-1, :2])}",
            advice="give the lines of one fault only: choose them with where = { ... }",
            place=tuple(before[-1, :2].tolist()),
        )


def _sides(line: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The two directions (2,) at right angles to the line through the ends of a trace."""
    along = line[-1, :2] - line[0, :2]
    right = np.array([along[1], -along[0]]) / norm(along)
    return right, -right


def _dip_of(fault: Fault, line: np.ndarray) -> tuple[float, np.ndarray]:
    """How far the surface goes sideways for each unit down, and the direction (2,) of that."""
    if fault.dip == VERTICAL:
        return 0.0, np.zeros(2)
    direction = fault.dip_direction
    assert fault.dip is not None and direction is not None  # of read_trace
    angle = math.radians(fault.dip)
    run = float(cos(angle) / sin(angle))
    if not isinstance(direction, str):
        return run, unit_vector(direction)
    right, left = _sides(line)
    side = float(dot(right, unit_vector(COMPASS[direction])))
    if abs(side) < _ALONG:
        raise _refused_along(f"its dip direction, {direction},", right)
    # of the two planes with this dip through both ends the one that dips to this side
    ends = line[[0, -1]]
    share = run * float(ends[0, 2] - ends[1, 2]) / float(norm(ends[1, :2] - ends[0, :2]))
    if abs(share) >= _OBLIQUE:
        raise InputRefused(
            f"the line between the ends of its trace is about as steep as its dip, {fault.dip:g} degrees",
            advice="give the dip direction in degrees, or correct the dip or the elevations",
            place=tuple(ends[0].tolist()),
        )
    along = (ends[1, :2] - ends[0, :2]) / norm(ends[1, :2] - ends[0, :2])
    return run, math.sqrt(1.0 - share * share) * (right if side > 0 else left) + share * along


def _refused_along(what: str, across: np.ndarray) -> InputRefused:
    one, other = degrees_text(across), degrees_text(-across)
    return InputRefused(
        f"{what} is along its trace, which runs at right angles to {one} and {other}",
        advice=f"the two sides of the trace are dip_direction = {one} and {other}",
    )


def _with_heights(
    work: Work, fault: Fault, tops: list[tuple], extent: float
) -> tuple[np.ndarray, np.ndarray]:
    """The trace with all its elevations, and (N,) bool: the points that were given. Between these it gets
    more where it is put on a surface."""
    line = fault.trace_line().copy()
    is_given = np.ones(len(line), bool)
    if isinstance(fault.elevation, float):
        line[:, 2] = fault.elevation
    elif fault.elevation is not None:
        line[:, 2] = np.nan
    unknown = np.isnan(line[:, 2])
    if fault.dip == VERTICAL or not unknown.any():
        return line, is_given
    if unknown.all():
        line, is_given = _divided(line, extent / _PIECES)
        unknown = np.ones(len(line), bool)
    line[unknown, 2] = heights_on(work, np.ascontiguousarray(line[unknown, :2]), tops)
    return line, is_given


def _divided(line: np.ndarray, longest: float) -> tuple[np.ndarray, np.ndarray]:
    """A line in pieces that are not longer, and (N,) bool: its own points."""
    pieces, are_given = [], []
    for begin, end in itertools.pairwise(line):
        count = max(1, math.ceil(float(norm(end[:2] - begin[:2])) / longest))
        shares = np.arange(count)[:, None] / count
        pieces.append(begin + shares * (end - begin))
        are_given.append(np.arange(count) == 0)
    return np.concatenate([*pieces, line[-1:]]), np.concatenate([*are_given, [True]])


def _once_each(top: np.ndarray, is_given: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(N,) bool: the points that are not where the one before is; and which of them were given."""
    new = begins_run(top)
    top, is_given = top[new], is_given[new]
    if (top[0] == top[-1]).all():
        raise InputRefused(
            "its trace runs down its dip: it shows no surface",
            advice="correct the dip direction, or give a longer trace",
            place=tuple(top[0].tolist()),
        )
    is_given[[0, -1]] = True
    return new, is_given


def _bends(top: np.ndarray, is_given: np.ndarray, near: float) -> np.ndarray:
    """(N,) bool: of the points between given ones those that a line with a straight piece in their place
    would miss by more (Douglas and Peucker 1973)."""
    is_kept = np.zeros(len(top), bool)
    waiting = list(itertools.pairwise(np.flatnonzero(is_given).tolist()))
    while waiting:
        begin, end = waiting.pop()
        if end - begin < 2:
            continue
        along = top[end] - top[begin]
        apart = top[begin + 1 : end] - top[begin]
        share = np.clip(dot(apart, along) / max(float(dot(along, along)), 1e-300), 0.0, 1.0)
        away = norm(apart - share[:, None] * along)
        worst = int(away.argmax())
        if away[worst] > near:
            middle = begin + 1 + worst
            is_kept[middle] = True
            waiting += [(begin, middle), (middle, end)]
    return is_kept


def _compare(top: np.ndarray, toward: np.ndarray, dip: float) -> list[str]:
    """A warning where the dip direction is oblique to the strike of the surface, a line from end to end of
    `top`. Refuses one along it."""
    along = top[-1] - top[0]
    across = np.array([along[1], -along[0]]) / norm(along)
    share = float(dot(across, toward))
    across, share = (across, share) if share >= 0 else (-across, -share)
    if share < _ALONG:
        raise _refused_along("its dip direction", across)
    if share >= _OBLIQUE:
        return []
    angle = math.degrees(math.atan(math.tan(math.radians(dip)) / share))
    return [
        f"its dip direction is oblique to its trace, so that it dips {angle:.0f} degrees toward "
        f"{degrees_text(across)}, not {dip:g}; check the dip direction"
    ]


def _continuation(line: np.ndarray, run: float, toward: np.ndarray, lengths: list[float]) -> np.ndarray:
    """(2, 2): how far a line, seen along the dip, continues straight beyond its first and last point, in the
    mean direction of its last tenth there."""
    steps = []
    for ordered, length in zip((line[::-1], line), lengths, strict=True):
        seen = _at_level(ordered, float(ordered[-1, 2]), run, toward)
        way = norm(np.diff(seen, axis=0))[::-1].cumsum()  # from the end
        step = seen[-1] - seen[-2 - int(np.searchsorted(way, _END * way[-1]))]
        steps.append(length * step / norm(step))
    return np.array(steps)


def _continued(row: np.ndarray, by: np.ndarray) -> np.ndarray:
    """A row of points (N, 2) or (N, 3) with one more at each end, moved in plan."""
    ends = row[[0, -1]].copy()
    ends[:, :2] += by
    return np.concatenate([ends[:1], row, ends[1:]])


def _refuse_crossing(top: np.ndarray) -> None:
    """Refuses a line that crosses or touches itself (exact)."""
    begin, end = top[:-1], top[1:]
    pieces = np.stack([begin, end, end], axis=1)
    native = native_module()
    orient2d, pairs = native.orient2d, native.meeting_boxes(pieces, pieces)
    pairs = pairs[pairs[:, 0] < pairs[:, 1]]
    next_to = pairs[:, 1] == pairs[:, 0] + 1
    one, other = pairs[~next_to].T
    a, b, c, d = begin[one], end[one], begin[other], end[other]
    meets = (orient2d(a, b, c) * orient2d(a, b, d) <= 0) & (orient2d(c, d, a) * orient2d(c, d, b) <= 0)
    turn = pairs[next_to][:, 0]
    a, b, d = begin[turn], end[turn], end[turn + 1]
    back = (orient2d(a, b, d) == 0) & (dot(b - a, d - b) < 0)
    places = np.concatenate([begin[other[meets]], end[turn[back]]])
    if len(places):
        raise InputRefused(
            f"its surface crosses itself: seen along the dip its trace, continued at both ends, crosses or "
            f"touches itself near {place_text(places[0])}",
            advice="correct the trace, its elevation or its dip, limit `extend`, or give the fault as a mesh",
            place=tuple(places[0].tolist()),
        )
