# SPDX-License-Identifier: GPL-3.0-or-later
"""Faults that die out: where a sheet meets them, what counts on their two sides, and one sheet beyond.

A fault that dies out is a barrier: on each side only what is not hidden behind it counts. That gives two
sheets which differ beside the fault; beyond its ends they are made equal, so that nothing is displaced there.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ...base.algebra import norm
from ...base.triangles import (
    Sheet,
    edge_numbers,
    edges_numbered,
    edges_of,
    open_edges,
    segments_hit,
    shares_hit,
    unit_normals,
    welded,
)
from ...base.work import Work, native_module, on_threads
from ...heights.mis_ties import mean_heights
from ...settings.methods import METHODS
from ...surfaces.rock_structure import FaultShape, fault_sides
from .between_sheets import places_between
from .families import CompartmentTest, box_of, middles_of_parts, parts_of_lines
from .near_rows import SideRow, triangles_met, with_neighbors
from .points_at_faults import expected_heights

_ON = 1e-6  # of the extent of a fault: vertices so near it lie on it
_AT_ONCE = 1 << 21
_HALVINGS = 30  # a billionth of an edge
_TOUCHES, _PASSES = 1, 2


@dataclass(frozen=True)
class Trace:
    """The trace of a fault in a sheet. points: (M, 2) in plan, heights: (M,); is_end: (M,) bool, where it
    dies out. beyond: (N,) bool, the nodes of triangles that the fault's continuation beyond its ends passes
    through."""

    points: np.ndarray
    heights: np.ndarray
    is_end: np.ndarray
    beyond: np.ndarray

    def beside(self, plan: np.ndarray) -> np.ndarray:
        """(P,) bool: the plan points that are nearer to the trace than to its ends."""
        if not len(self.points):
            return np.zeros(len(plan), bool)
        nearest, _ = native_module().nearest_points(self.points, plan, execution=on_threads(1))
        return ~self.is_end[nearest[:, 0]]


def trace_of(
    work: Work,
    sheet: Sheet,
    fault: FaultShape,
    within: Callable[[np.ndarray], np.ndarray],
) -> Trace:
    """The trace of a fault in a sheet, edge by edge. within: whether points (K, 3) lie in the compartment; a
    fault that ends elsewhere does not die out."""
    vertices = sheet.vertices
    crossed = crossed_edges(work, sheet, fault)
    on = crossed.side == 0
    begin, end = vertices[crossed.edges[crossed.changing]].transpose(1, 0, 2)
    share = crossed.share[crossed.changing]
    hits = np.isfinite(share)
    passed = _where_sides_change(work, begin[~hits], end[~hits], fault)
    missed = np.zeros(len(crossed.edges), bool)
    missed[crossed.changing[~hits][within(passed)]] = True
    goes_on = missed[crossed.of_triangle].any(axis=1)
    beyond = np.zeros(len(vertices), bool)
    beyond[crossed.triangles[goes_on]] = True
    at_end = np.zeros(len(crossed.edges), bool)
    at_end[crossed.of_triangle[goes_on]] = True
    places = np.concatenate([begin[hits] + share[hits, None] * (end - begin)[hits], vertices[on]])
    is_end = np.concatenate([at_end[crossed.changing[hits]], beyond[on]])
    return Trace(places[:, :2], places[:, 2], is_end, beyond)


class CrossedEdges(NamedTuple):
    """The edges of a sheet at a fault. side: (V,) int8 of its vertices, 0 on the fault. triangles: (T, 3),
    those with corners not all on one side, in the sheet's order. edges: (E, 2) of these, and of_triangle:
    (T, 3) int64, those from corner 0 to 1 of each of them, 1 to 2, 2 to 0. changing: (K,) the edges with ends
    on both sides. share: (E,) where the fault meets these, from the first end to the second; NaN where it
    does not."""

    side: np.ndarray
    triangles: np.ndarray
    edges: np.ndarray
    of_triangle: np.ndarray
    changing: np.ndarray
    share: np.ndarray


def crossed_edges(work: Work, sheet: Sheet, fault: FaultShape) -> CrossedEdges:
    """Where a fault meets the edges of a sheet."""
    vertices, triangles = sheet
    side = fault_sides(work, vertices, fault)
    side[on_fault(vertices, fault)] = 0
    of_corners = side[triangles]
    triangles = triangles[(of_corners != of_corners[:, :1]).any(axis=1) | (of_corners[:, 0] == 0)]
    edges, number = np.unique(edge_numbers(edges_of(triangles), len(vertices)), return_inverse=True)
    edges = edges_numbered(edges, len(vertices))
    changing = np.flatnonzero(side[edges[:, 0]] * side[edges[:, 1]] < 0)
    share = np.full(len(edges), np.nan)
    begin, end = vertices[edges[changing]].transpose(1, 0, 2)
    share[changing] = hit_shares(begin, end, fault)
    return CrossedEdges(side, triangles, edges, number.reshape(3, -1).T, changing, share)


def _where_sides_change(work: Work, begin: np.ndarray, end: np.ndarray, fault: FaultShape) -> np.ndarray:
    """(K, 3) a point on each segment at which the side of a fault changes, by bisection."""
    low, high = np.zeros(len(begin)), np.ones(len(begin))
    first = fault_sides(work, begin, fault)
    for _ in range(_HALVINGS):
        middle = (low + high) / 2
        same = fault_sides(work, begin + middle[:, None] * (end - begin), fault) == first
        low, high = np.where(same, middle, low), np.where(same, high, middle)
    return begin + high[:, None] * (end - begin)


def precision_of(fault: FaultShape) -> float:
    """How near to a fault points count as on it."""
    return _ON * float(norm(np.ptp(fault.vertices[np.unique(fault.triangles)], axis=0)))


def on_fault(points: np.ndarray, fault: FaultShape) -> np.ndarray:
    """(N,) bool: the points on a fault up to the precision of files (a millionth of its extent)."""
    corners, reach = fault.vertices[fault.triangles], float(np.nextafter(precision_of(fault), np.inf))
    return native_module().nearest_triangles(corners, points, reach, execution=on_threads(1))[0] >= 0


def hit_shares(begin: np.ndarray, end: np.ndarray, fault: FaultShape) -> np.ndarray:
    """(K,) where each segment meets the fault, from 0 to 1 of its length; NaN where it does not."""
    vertices, triangles = fault.vertices, fault.triangles
    corners = vertices[triangles]
    shares = np.full(len(begin), np.nan)
    pairs = native_module().meeting_boxes(np.stack([begin, end, end], axis=1), corners)
    for start in range(0, len(pairs), 1 << 16):
        segment, triangle = pairs[start : start + (1 << 16)].T
        hit = segments_hit(begin[segment], end[segment], corners[triangle])
        shares[segment[hit]] = shares_hit(begin[segment[hit]], end[segment[hit]], corners[triangle[hit]])
    return shares


def blended(
    heights: dict[SideRow, np.ndarray],
    near: dict[SideRow, np.ndarray],
    on_side: dict[SideRow, list[np.ndarray]],
    weights: list,
) -> dict:
    """(N,) heights by the sides (+1 or -1 of each fault, 0 where it is not), different as the weights say.

    heights: what is seen from each combination of sides that there is. near: (N,) bool, the nodes near its
    compartment, where it counts. on_side: of each fault (N,) bool, the nodes that are on that side of it.
    weights: of each fault (N,), 1 where its sides have their own sheets, 0 where they have the same.
    """
    result = {sides: z.copy() for sides, z in heights.items()}
    ramped = np.array([weight < 1.0 for weight in weights])
    patterns, of_node = np.unique(ramped, axis=1, return_inverse=True)
    for pattern, some in zip(patterns.T, _groups(of_node.ravel()), strict=True):
        # where all of a fault's weights are 1, what is on its other side has no share
        distinct = [fault for fault, is_ramped in enumerate(pattern) if not is_ramped]
        present = {sides: near[sides][some] for sides in heights}
        present = {sides: mask for sides, mask in present.items() if mask.any()}
        for sides, mask in present.items():
            total, whole = np.zeros(len(some)), np.zeros(len(some))
            for other in present:
                if any(sides[fault] * other[fault] < 0 for fault in distinct):
                    continue
                share = present[other].astype(float)
                for fault, (side, its, weight) in enumerate(zip(sides, other, weights, strict=True)):
                    alike = side == its  # where one has no such fault: on the side that the other is on
                    if not alike and 0 in (side, its):
                        alike = on_side[sides if side else other][fault][some]
                    elif alike and fault in distinct:
                        continue
                    half = 0.5 * weight[some]
                    share = share * np.where(alike, 0.5 + half, 0.5 - half)
                z = heights[other][some]
                total, whole = total + np.where(share == 0.0, 0.0, share * z), whole + share
            result[sides][some[mask]] = total[mask] / np.where(whole > 0, whole, 1.0)[mask]
    return result


def _groups(number: np.ndarray) -> list[np.ndarray]:
    """The places of each number in an array (N,) of all numbers from 0."""
    order = np.argsort(number, kind="stable")
    return np.split(order, np.cumsum(np.bincount(number))[:-1])


def with_equal_ends(
    work: Work,
    plan: np.ndarray,
    triangles: np.ndarray,
    heights: dict[SideRow, np.ndarray],
    ramps: Sequence[tuple[FaultShape, float]],
    within: CompartmentTest,
) -> dict[SideRow, np.ndarray]:
    """The heights (N,) of the sheets on each combination of sides, equal to the bit at all nodes of
    triangles through which a fault that dies out would continue beyond its ends. Within a distance from
    these, its ramp, they are drawn together. ramps: each fault with it."""
    faults = [fault for fault, _ in ramps]
    first = next(iter(heights.values()))
    if all(np.array_equal(z, first, equal_nan=True) for z in heights.values()):
        return dict.fromkeys(heights, first)
    ends = [
        [n for n, other in enumerate(faults) if any(other.vertices is end.vertices for end in fault.ends)]
        for fault in faults
    ]
    side_of = _sides_of_nodes(work, plan, heights, faults)
    on_side = {
        sides: [(side == 0) | (of == side) for side, of in zip(sides, side_of[sides], strict=True)]
        for sides in heights
    }
    of_branches = {
        sides: {branch: of[branch].copy() for branch, ended_at in enumerate(ends) if ended_at}
        for sides, of in side_of.items()
    }
    del side_of
    passed = [np.zeros(len(plan), bool) for _ in faults]
    for _ in range(2):  # what is passed between nodes alone is near, too
        near = {
            sides: np.isfinite(z) & _near(triangles, on_side[sides], passed) for sides, z in heights.items()
        }
        low, high = _range(plan, heights, near)
        is_known = np.isfinite(low[:, 2])
        low[:, 2], high[:, 2] = (np.where(is_known, points[:, 2], 0.0) for points in (low, high))
        inside = is_known & within(low) & within(high)
        whole = np.ascontiguousarray(triangles[is_known[triangles].all(axis=1)])
        doubtful = [
            whole[triangles_met(work, fault, low, high, whole) > 0] if fault.dies_out else whole[:0]
            for fault in faults
        ]
        for nodes, some in zip(passed, doubtful, strict=True):
            nodes[some] = True
    lowest, highest = (extreme.reduce(list(heights.values()), axis=0) for extreme in (np.fmin, np.fmax))
    some = np.isfinite(lowest)
    box = box_of(*(np.column_stack([plan, z])[some] for z in (lowest, highest)))
    met = _Meeting(work, plan, triangles, faults, [_continued(fault, box) for fault in faults], within)
    drawn = _Drawn(plan, [ramp for _, ramp in ramps], ends, near, of_branches)
    looked_at: dict[int, np.ndarray] = {}
    while True:
        blends = blended(heights, near, on_side, drawn.weights)
        places = _places_of(plan, [np.where(is_known, z, 0.0) for z in blends.values()])
        for number in range(len(faults)):
            rows = [
                places.number[row][doubtful[number][near[sides][doubtful[number]].any(axis=1)]]
                for row, sides in enumerate(blends)
            ]
            some = np.unique(np.concatenate(rows), axis=0)
            corners = places.points[some]
            before = looked_at.get(number)
            if before is None or not np.array_equal(before, corners):
                looked_at[number] = corners
                _draw_where_passed(met, places, some, number, inside, drawn)
        if drawn.is_settled() and not _draw_between(met, blends, near, drawn):
            return blends


class _Meeting(NamedTuple):
    """Sheets on one planar mesh, and the faults that they meet, with the triangles (K, 3, 3) of each beyond
    its ends."""

    work: Work
    plan: np.ndarray
    triangles: np.ndarray
    faults: Sequence[FaultShape]
    beyond: Sequence[np.ndarray]
    within: CompartmentTest


def _draw_where_passed(
    met_by: _Meeting, places: _Places, some: np.ndarray, number: int, inside: np.ndarray, drawn: _Drawn
) -> None:
    """Lets sheets be equal at the nodes of triangles that a fault passes beyond its ends, of edges that lie
    in its triangles there, and where it touches them.

    places: of all sheets; some: (T, 3) int32 triangles of these. inside: (N,) bool, the nodes at which all
    sheets are in the compartment."""
    node = places.node
    work, within, fault, beyond = met_by.work, met_by.within, met_by.faults[number], met_by.beyond[number]
    met = triangles_met(work, fault, places.points, places.points, some)
    passes = met == _PASSES
    divided = np.flatnonzero(passes & ~inside[node[some]].all(axis=1))
    passes[divided] = _meet_within(places.points[some[divided]], beyond, within)
    drawn.require_equal(number, node[some[passes]])
    edges = np.unique(edge_numbers(edges_of(some[met == _TOUCHES]), len(places.points)))
    edges = edges_numbered(edges, len(places.points))
    lie_in = _lie_in(work, fault, places.points[edges], beyond, within)
    drawn.require_equal(number, node[edges[lie_in]])
    touched = np.unique(some[met > 0])
    touched = touched[inside[node[touched]]]
    on = _met_points(work, fault, places.points[touched])
    drawn.require_equal(number, node[touched[on], None])


class _Places(NamedTuple):
    """The different places that the nodes of sheets have: points (P, 3), and of which node each is. number:
    (S, N) int32, the place of each node of each sheet."""

    points: np.ndarray
    node: np.ndarray
    number: np.ndarray


def _places_of(plan: np.ndarray, heights: list[np.ndarray]) -> _Places:
    """Those of the nodes (N, 2) in sheets with heights (N,) each: at one node only those differ that some
    fault near it parts."""
    number = np.empty((len(heights), len(plan)), np.int32)
    points, nodes, total = [], [], 0
    for start in range(0, len(plan), some := max(1, _AT_ONCE // len(heights))):
        part = slice(start, start + some)
        z = np.array([sheet_z[part] for sheet_z in heights])
        order = np.argsort(z, axis=0, kind="stable")
        ascending = np.take_along_axis(z, order, axis=0)
        is_new = np.ones(z.shape, bool)
        is_new[1:] = ascending[1:] != ascending[:-1]
        count = is_new.sum(axis=0)
        first = total + count.cumsum() - count
        np.put_along_axis(number[:, part], order, (first + is_new.cumsum(axis=0) - 1).astype(np.int32), 0)
        nodes.append(np.repeat(np.arange(start, start + len(count)), count))
        points.append(np.column_stack([plan[nodes[-1]], ascending.T[is_new.T]]))
        total += len(nodes[-1])
    return _Places(np.concatenate(points), np.concatenate(nodes), number)


def _sides_of_nodes(
    work: Work, plan: np.ndarray, heights: dict, faults: list[FaultShape]
) -> dict[SideRow, np.ndarray]:
    """By the sides of each sheet: (F, N) int8, on which side of each fault its nodes are."""
    places = _places_of(plan, [np.nan_to_num(z) for z in heights.values()])
    side = np.array([fault_sides(work, places.points, fault) for fault in faults])
    return {sides: side[:, number] for sides, number in zip(heights, places.number, strict=True)}


class _Drawn:
    """Nodes at which the sheets on both sides of faults are to be equal, and what weight that leaves to the
    difference around. ends: of each fault those at which it ends; near: as with_equal_ends has it; sides: by
    the sides of each sheet the side of each such branch that its nodes are on."""

    def __init__(self, plan: np.ndarray, ramps: list[float], ends: list[list[int]], near: dict, sides: dict):
        self.plan, self.ramps, self.ends, self.near, self.sides = plan, ramps, ends, near, sides
        self.weights = [np.ones(len(plan)) for _ in ramps]
        self.equal = [np.zeros(len(plan), bool) for _ in ramps]

    def require_equal(self, number: int, nodes: np.ndarray) -> None:
        """For the sides of one fault, at the nodes (K, 1 to 3) of triangles or edges. A branch of it that
        passes a sheet there, or between two of them, ends in nothing: its sides are equal, too."""
        self.equal[number][nodes] = True
        for branch, ended_at in enumerate(self.ends):
            if number not in ended_at:
                continue
            above, below = np.zeros(len(nodes), bool), np.zeros(len(nodes), bool)
            for sides, near in self.near.items():
                is_near = near[nodes].any(axis=1)
                side = self.sides[sides][branch][nodes]
                above |= is_near & (side > 0).any(axis=1)
                below |= is_near & (side < 0).any(axis=1)
            self.equal[branch][nodes[above & below]] = True

    def is_settled(self) -> bool:
        """Whether nothing has changed since this was asked."""
        settled = True
        for number, (equal, ramp) in enumerate(zip(self.equal, self.ramps, strict=True)):
            if (equal & (self.weights[number] > 0)).any():
                self.weights[number] = share_of_sides(self.plan, equal, ramp)
                settled = False
        return settled


def _draw_between(met_by: _Meeting, by_sides: dict, near: dict[SideRow, np.ndarray], drawn: _Drawn) -> bool:
    """Lets sheets be equal where a fault would continue between those of its two sides beyond its ends,
    though neither meets it: rock would be above it alone, or below. Whether there is such a place. near,
    drawn: as with_equal_ends has them, changed."""
    work, plan, triangles, faults, *_ = met_by
    every = np.array(list(by_sides.values()))
    low, high = (np.column_stack([plan, extreme.reduce(every, axis=0)]) for extreme in (np.fmin, np.fmax))
    differ = triangles[(low[:, 2] < high[:, 2])[triangles].any(axis=1)]
    low, high = np.nan_to_num(low), np.nan_to_num(high)
    between = {}
    for number, fault in enumerate(faults):
        if not fault.dies_out:
            continue
        some = differ[triangles_met(work, fault, low, high, differ) == _PASSES]
        if len(some):
            between[number] = _between(met_by._replace(triangles=some), by_sides, number)
    places = np.concatenate([np.empty((0, 3)), *(candidates.places for candidates in between.values())])
    sides = [fault_sides(work, places, fault) for fault in faults]
    is_wider, first = False, 0
    for number, candidates in between.items():
        part = slice(first, first + len(candidates.places))
        first = part.stop
        for (one, other), faces, rows in candidates.pairs:
            is_there = np.ones(len(candidates.places), bool)
            for n, side in enumerate(sides):
                if n != number and (its := one[n] or other[n]):
                    is_there &= side[part] == its
            passed = faces[np.isin(rows, candidates.owner[is_there])]
            for its in (one, other) if len(passed) else ():
                is_wider = is_wider or not near[its][passed].all()
                near[its][passed] = True
            drawn.require_equal(number, passed)
    return not drawn.is_settled() or is_wider


class _Between(NamedTuple):
    """Where a fault would continue between sheets. pairs: the sides of each two sheets, the triangles (T, 3)
    over which it may be between them, and the numbers (T,) of these two triangles as one pair. places: (K, 3)
    in the compartment, and owner (K,) the pair of triangles that each lies between."""

    pairs: list[tuple]
    places: np.ndarray
    owner: np.ndarray


def _between(met_by: _Meeting, by_sides: dict, number: int) -> _Between:
    """Those of one fault. Of all pairs of sheets many have the same two triangles there,
    and what lies between these is the same."""
    work, plan, triangles, faults, beyond, within = met_by
    side, heights = _corners_with_sides(work, plan, triangles, by_sides, faults[number])
    over, chosen_rows = [], [np.empty((0, 7))]
    for one, other in _pairs(by_sides, number):
        both = np.column_stack([side[one], side[other]])
        z = np.column_stack([heights[one], heights[other]])
        apart = (both != both[:, :1]).any(axis=1) & np.isfinite(z).all(axis=1)
        chosen = np.flatnonzero(apart & (z[:, :3] != z[:, 3:]).any(axis=1))
        over.append(((one, other), triangles[chosen]))
        chosen_rows.append(np.column_stack([chosen, z[chosen]]))
    rows, numbers = np.unique(np.concatenate(chosen_rows), axis=0, return_inverse=True)
    ends = np.cumsum([0, *(len(faces) for _, faces in over)]).tolist()
    corners = plan[triangles[rows[:, 0].astype(np.int64)]]
    lower, upper = (np.dstack([corners, z]) for z in (rows[:, 1:4], rows[:, 4:]))
    owner, places = places_between(lower, upper, beyond[number], within)
    parts = zip(over, itertools.pairwise(ends), strict=True)
    pairs = [(*pair, numbers.ravel()[start:end]) for pair, (start, end) in parts]
    return _Between(pairs, places, owner)


def _corners_with_sides(
    work: Work, plan: np.ndarray, triangles: np.ndarray, sheets: dict, fault: FaultShape
) -> tuple[dict[SideRow, np.ndarray], dict[SideRow, np.ndarray]]:
    """By the sides of each sheet, of the corners of some triangles (T, 3): on which side of a fault they are,
    and their heights."""
    heights = {sides: z[triangles] for sides, z in sheets.items()}
    places = [np.column_stack([plan[triangles.ravel()], np.nan_to_num(z.ravel())]) for z in heights.values()]
    side = fault_sides(work, np.concatenate(places), fault)
    return dict(zip(sheets, side.reshape(len(sheets), -1, 3), strict=True)), heights


def _pairs(sheets: dict, number: int) -> Iterator[tuple[SideRow, SideRow]]:
    """The sides of sheets below and above one fault, which are otherwise alike."""
    for one, other in itertools.product(sheets, repeat=2):
        if one[number] == -1 and other[number] == 1:
            rest = (pair for n, pair in enumerate(zip(one, other, strict=True)) if n != number)
            if all(a == b or 0 in (a, b) for a, b in rest):
                yield one, other


def _near(triangles: np.ndarray, on_side: list[np.ndarray], passed: list[np.ndarray]) -> np.ndarray:
    """(N,) bool: the nodes of triangles with corners on given sides of all faults, and those beside them."""
    count = len(on_side)
    of_node = np.packbits([is_on | also for is_on, also in zip(on_side, passed, strict=True)], axis=0)
    a, b, c = (of_node[:, corner] for corner in triangles.T)
    near = np.zeros(of_node.shape[1], bool)
    near[triangles[((a | b | c) == np.packbits(np.ones((count, 1), bool), axis=0)).all(axis=0)]] = True
    return with_neighbors(triangles, near)


def _range(plan: np.ndarray, heights: dict, near: dict) -> tuple[np.ndarray, np.ndarray]:
    """(N, 3) the lowest and the highest place of the sheets near each node; infinite where there is none."""
    low, high = np.full(len(plan), np.inf), np.full(len(plan), -np.inf)
    for sides, z in heights.items():
        low = np.fmin(low, np.where(near[sides], z, low))
        high = np.fmax(high, np.where(near[sides], z, high))
    return np.column_stack([plan, low]), np.column_stack([plan, high])


def shared(sheets: dict[SideRow, Sheet]) -> dict[SideRow, Sheet]:
    """The same, with one object for all sheets that are bitwise equal."""
    by_bytes: dict[bytes, Sheet] = {}
    return {sides: by_bytes.setdefault(sheet.vertices.tobytes(), sheet) for sides, sheet in sheets.items()}


def split_beyond(work: Work, sheet: Sheet, fault: FaultShape, within: CompartmentTest) -> np.ndarray | None:
    """(3,) a place in a compartment at which a sheet has two heights along a line in which a fault would go
    on beyond its ends; None where there is none."""
    vertices, triangles = sheet
    ends = vertices[open_edges(vertices, triangles)]
    swap = (ends[:, 0, 0] > ends[:, 1, 0]) | (
        (ends[:, 0, 0] == ends[:, 1, 0]) & (ends[:, 0, 1] > ends[:, 1, 1])
    )
    ends[swap] = ends[swap, ::-1]
    lines, line = np.unique(ends[:, :, :2].reshape(-1, 4), axis=0, return_inverse=True)
    low, high = np.full((len(lines), 2), np.inf), np.full((len(lines), 2), -np.inf)
    np.minimum.at(low, line.ravel(), ends[:, :, 2])
    np.maximum.at(high, line.ravel(), ends[:, :, 2])
    is_split = (low < high).any(axis=1)
    if not is_split.any():
        return None
    low, high = (np.dstack([lines[is_split].reshape(-1, 2, 2), z[is_split]]) for z in (low, high))
    begin, end = (np.concatenate([low[:, end], high[:, end]]) for end in range(2))
    box = box_of(low, high)
    walls = np.concatenate([within.walls(box), _continued(fault, box)])
    line, shares = parts_of_lines(begin, end, walls, np.tile(np.arange(len(low)), 2))
    share = shares.mean(axis=1)
    low, high = (edges[line, 0] + share[:, None] * (edges[:, 1] - edges[:, 0])[line] for edges in (low, high))
    on = np.all([_met_points(work, fault, places) for places in (low, high)], axis=0)
    middles = (low + high)[on] / 2
    middles = middles[within(middles)]
    return middles[0] if len(middles) else None


def _continued(fault: FaultShape, box: np.ndarray) -> np.ndarray:
    """(M, 3, 3) the triangles in which a fault continues beyond its border, through a box (2, 3)."""
    return native_module().structure_continuation(fault.native(), box).reshape(-1, 3, 3)


def _met_points(work: Work, fault: FaultShape, points: np.ndarray) -> np.ndarray:
    """(P,) bool: the points at which a fault would continue beyond its ends."""
    alone = np.repeat(np.arange(len(points), dtype=np.int32)[:, None], 3, axis=1)
    return triangles_met(work, fault, points, points, alone) > 0


def _lie_in(
    work: Work, fault: FaultShape, lines: np.ndarray, beyond: np.ndarray, within: CompartmentTest
) -> np.ndarray:
    """(K,) bool: the lines (K, 2, 3) that lie in a compartment, and for a part where a fault would continue
    beyond its ends, in the triangles `beyond`."""
    is_inside = np.zeros(len(lines), bool)
    if len(lines):
        walls = np.concatenate([within.walls(box_of(lines)), beyond])
        line, places = middles_of_parts(lines[:, 0], lines[:, 1], walls)
        on = _met_points(work, fault, places)
        on[on] = within(places[on])
        is_inside[line[on]] = True
    return is_inside


def _meet_within(corners: np.ndarray, others: np.ndarray, within: CompartmentTest) -> np.ndarray:
    """(K,) bool: the triangles (K, 3, 3) of which a part of the lines where they meet others (M, 3, 3) is in
    a compartment."""
    pairs = native_module().meeting_boxes(corners, others)
    ends = np.full((len(pairs), 6, 3), np.nan)
    one, other = corners[pairs[:, 0]], others[pairs[:, 1]]
    for turn, (triangle, edges) in enumerate(((one, other), (other, one))):
        for corner in range(3):
            begin, end = edges[:, corner], edges[:, (corner + 1) % 3]
            hit = segments_hit(begin, end, triangle)
            share = shares_hit(begin[hit], end[hit], triangle[hit])
            ends[hit, 3 * turn + corner] = begin[hit] + share[:, None] * (end - begin)[hit]
    rows = np.flatnonzero(np.isfinite(ends[:, :, 0]).sum(axis=1) > 1)
    meets = np.zeros(len(corners), bool)
    if not len(rows):
        return meets
    some = ends[rows]
    at = np.arange(len(rows))
    first = some[at, np.isfinite(some[:, :, 0]).argmax(axis=1)]
    last = some[at, np.nan_to_num(np.linalg.norm(some - first[:, None], axis=2), nan=-1.0).argmax(axis=1)]
    line, places = middles_of_parts(first, last, within.walls(box_of(first, last)))
    meets[pairs[rows[line[within(places)]], 0]] = True
    return meets


def share_of_sides(plan: np.ndarray, beyond: np.ndarray, ramp: float) -> np.ndarray:
    """(N,) from 0 at nodes beyond the ends of a fault, (N,) bool, to 1 where these are a ramp away."""
    if not beyond.any():
        return np.ones(len(plan))
    if ramp <= 0:
        return np.where(beyond, 0.0, 1.0)
    _, away = native_module().nearest_points(plan[beyond], plan, execution=on_threads(1))
    share = np.minimum(1.0, away[:, 0] / ramp)
    return share * share * (3 - 2 * share)


_AWAY = 4.0  # times the reach: so far from a fault a sheet is continued
_STEEP = 0.1  # of a unit normal in plan: a fault that dips less is nearly level


class Lip(NamedTuple):
    """A fault at which a sheet is cut off: shape, side (-1 or +1) of the sheet, and points (P,) bool, those
    that may lie on its cutoff line. nearest: (P,) the triangle of the fault that is nearest to each, -1 where
    none is within reach; None where that is not known yet."""

    shape: FaultShape
    side: int
    points: np.ndarray
    nearest: np.ndarray | None = None

    def on(self, points: np.ndarray, reach: float) -> np.ndarray:
        """(P,) the triangle on which each of the points (P, 3) lies, -1 for those not on the cutoff line."""
        nearest = self.nearest
        if nearest is None:
            corners = self.shape.vertices[self.shape.triangles]
            nearest = native_module().nearest_triangles(corners, points, reach, execution=on_threads(1))[0]
        return np.where(self.points, nearest, -1)


def beyond_lips(
    work: Work, points: np.ndarray, lips: list[Lip], reach: float, method: str, settings: Mapping
) -> np.ndarray:
    """(K, 3) points that continue a sheet beyond the faults at which it is cut off, for a method that
    triangulates its points (P, 3).

    Their convex outline bridges each bay of a cutoff line by triangles in the fault itself. So each point
    nearer than `reach` to a fault has another one beyond it, four times as far, where those that are not near
    one predict the sheet; at the same height where that does not leave the fault, and where the method is
    to take the height of the nearest point beyond all.
    """
    if not lips or not METHODS[method].is_triangulated or settings["extrapolate"] == "none":
        return np.empty((0, 3))
    near = np.array([lip.on(points, reach) for lip in lips])
    of_lip, row = np.nonzero(near >= 0)
    if not len(row):
        return np.empty((0, 3))
    corners = np.concatenate(
        [lip.shape.vertices[lip.shape.triangles[on[on >= 0]]] for lip, on in zip(lips, near, strict=True)]
    )
    outward = -np.array([lip.side for lip in lips])[of_lip, None] * unit_normals(corners)
    level = norm(outward[:, :2])
    some = level > _STEEP
    near_points, outward, level = points[row[some]], outward[some], level[some]
    away = np.column_stack([outward[:, :2], np.zeros(len(near_points))]) * (_AWAY * reach / level**2)[:, None]
    ordinary = np.empty((0, 3))
    if settings["extrapolate"] == "method":
        ordinary = mean_heights(points[(near < 0).all(axis=0)])
    if len(ordinary):
        plan = np.concatenate([near_points + away, near_points])[:, :2]
        z_beyond, here = np.split(expected_heights(work, ordinary, plan), 2)
        rise = z_beyond - here
        leaves = 2.0 * rise * outward[:, 2] > -_AWAY * reach
        away[leaves, 2] = rise[leaves]
    beyond = near_points + away
    points = points[np.isin(points[:, 0], beyond[:, 0])]
    same = welded(np.concatenate([points, beyond])[:, :2])[len(points) :]
    return beyond[same == np.arange(len(points), len(points) + len(beyond))]  # none where another point is
