# SPDX-License-Identifier: GPL-3.0-or-later
"""Sheets of a surface that is a ready mesh: its triangles in the compartments, continued to the faults."""

from __future__ import annotations

import itertools
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from ...base.errors import InputRefused, place_text
from ...base.triangles import (
    Sheet,
    border_loops,
    edge_lengths,
    edge_numbers,
    edges_of,
    median_edge,
    meet,
    open_edges,
    overlapping_pairs,
    welded,
)
from ...base.work import Work, native_module
from ...heights import Task, heights
from ...settings.methods import CONTINUATION
from ...surfaces.planar_mesh import MeshOptions, mesh_rings, triangulate_rings
from ...surfaces.rock_input import RockInput
from ...surfaces.rock_structure import FaultShape, fault_sides
from .between_sheets import common_lines
from .families import CompartmentTest, Family, around_tips, families
from .points_at_faults import distances
from .throws import Sheets
from .tips import (
    Lip,
    Trace,
    beyond_lips,
    hit_shares,
    on_fault,
    shared,
    split_beyond,
    trace_of,
    with_equal_ends,
)

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


_FARTHEST = 0.5774  # of its longest edge (1 / sqrt(3)): so far from all corners a triangle has places


class ReadyMesh:
    """One surface of a RockInput that is a ready mesh, divided along the faults by its triangles."""

    data = "triangles"

    def __init__(self, work: Work, entry: RockInput, number: int):
        self.work, self.entry, self.number = work, entry, number
        surface = entry.rock.surfaces[number]
        assert surface.vertices is not None and surface.triangles is not None  # it is read
        self.vertices, self.triangles = surface.vertices, surface.triangles
        self.method, self.settings = surface.method_options()
        faults = entry.divided().faults
        self.active = faults.active(number)
        self.counts: dict[tuple[int, ...], int] = {}  # of triangles, by the key of a family
        self.masks = np.full((len(self.triangles), len(faults)), LEFT | RIGHT, np.uint8)
        self.reach, away, width, self.on_lips = self._distances(faults.shapes)
        is_lip = self._lips(away < self.reach)
        corners = np.ascontiguousarray(self.triangles.T)
        for fault in np.flatnonzero(self.active):
            may_meet = away[:, fault][corners].min(axis=0) <= width
            self._divide(int(fault), faults.shapes[fault], is_lip[:, fault], corners, may_meet)
        self.tiling: PlanTiling | None = None

    def _distances(self, shapes: list[FaultShape]) -> tuple[float, np.ndarray, np.ndarray, np.ndarray]:
        """How near to a fault a border of the mesh counts as its cutoff line; (V, F) at least how far each
        vertex is from each fault that displaces it; (T,) how far a place in a triangle may be from its
        nearest corner; (V, F) the triangle of each fault to which a vertex is as near, else -1."""
        length = median_edge(self.vertices[:, :2], self.triangles)
        some = [shapes[fault] for fault in np.flatnonzero(self.active)]
        away = np.zeros((len(self.vertices), len(shapes)))
        reach, distance, nearest = distances(self.vertices, length, some)
        away[:, self.active] = np.minimum(distance, length)
        on_lips = np.full(away.shape, -1, np.int32)
        on_lips[:, self.active] = np.where(distance < reach, nearest, -1)
        width = _FARTHEST * edge_lengths(self.vertices, self.triangles).reshape(3, -1).max(axis=0)
        return reach, away, width, on_lips

    def _lips(self, near: np.ndarray) -> np.ndarray:
        """(V, F) bool: of the vertices near faults, (V, F) bool, those on a border of the mesh."""
        around = self.triangles[np.logical_or.reduce(near, axis=1)[self.triangles].any(axis=1)]
        rows, around = np.unique(around, return_inverse=True)
        vertices, on_lips = self.vertices[rows], np.zeros_like(near)
        is_border = np.zeros(len(rows), bool)
        is_border[open_edges(vertices, around.reshape(-1, 3))] = True
        on_lips[rows] = near[rows] & is_border[welded(vertices), None]
        return on_lips

    def _divide(
        self, fault: int, shape: FaultShape, is_lip: np.ndarray, corners: np.ndarray, may_meet: np.ndarray
    ) -> None:
        """The sides of a fault on which each triangle has a part. is_lip: (V,) bool, the vertices on the
        cutoff line, wherever it lies up to rounding. corners: (3, T) of the triangles; may_meet: (T,) bool,
        those that may meet it."""
        side = fault_sides(self.work, self.vertices, shape)
        side[on_fault(self.vertices, shape) | is_lip] = 0
        sides = side[corners]
        mask = np.where((sides < 0).any(axis=0), LEFT, 0) | np.where((sides > 0).any(axis=0), RIGHT, 0)
        clear = np.flatnonzero((sides != 0).all(axis=0) & (mask != (LEFT | RIGHT)) & may_meet)
        crossed = meet(self.vertices[self.triangles[clear]], shape.vertices[shape.triangles])
        mask[clear[crossed]] = LEFT | RIGHT
        along = _as_beside(self.vertices, self.triangles, mask) == 0  # all its corners lie on the fault
        middles = self.vertices[self.triangles[along]].mean(axis=1)
        mask[along] = np.where(fault_sides(self.work, middles, shape) > 0, RIGHT, LEFT)
        self.masks[:, fault] = mask

    def own(self, family: Family) -> np.ndarray:
        """(T,) bool: the triangles with a part in its compartments."""
        is_own = np.ones(len(self.triangles), bool)
        for fault, side in enumerate(family.key):
            if side in (-1, 1):
                is_own &= (self.masks[:, fault] & (RIGHT if side > 0 else LEFT)) > 0
        return is_own

    def count(self, family: Family) -> int:
        if family.key not in self.counts:
            self.counts[family.key] = int(self.own(family).sum())
        return self.counts[family.key]

    def has_data(self, family: Family) -> bool:
        return self.count(family) > 0

    def has_few_data(self, family: Family) -> bool:
        """Never: triangles show a slope."""
        return False

    def continued(self, sheets: Sheets, family: Family, source: Family, fault: int) -> Sheets:
        """Sheets of another family as they are: they continue by heights of their vertices."""
        return sheets

    def adopt(self, sheets: Sheets, others: Sheets) -> None:
        """Takes sheets that were made of its own; nothing more is known of these."""

    def sheets(self, family: Family, trends: Sheets | None = None) -> Sheets:
        """The sheet on each side of the faults that die out here, by sides. trends: of each side, where there
        are no triangles."""
        if trends is not None:
            return trends
        is_own = self.own(family)
        if not self.active.any():
            return dict.fromkeys(family.members.values(), Sheet(self.vertices, self.triangles))
        if self.tiling is None:
            self.tiling = plan_tiling(
                self.work, self.vertices, self.triangles, np.ascontiguousarray(self.masks[:, self.active])
            )
        plan, triangles, z = self.tiling.around(is_own)
        shapes = self.entry.divided().faults.shapes
        cut: list[tuple[int, int, Trace | None]] = [
            (fault, side, None) for fault, side in enumerate(family.key) if side in (-1, 1)
        ]
        common = self._continued(plan, z, triangles, cut)
        faults = [shapes[fault] for fault in family.dying]
        within = self._within(family)

        def traces_on(sheet: Sheet) -> list:
            return [trace_of(self.work, sheet, fault, within) for fault in faults]

        sheet = Sheet(np.column_stack([plan, common]), triangles)
        traces = traces_on(sheet)
        over = [np.zeros(len(is_own), bool) for _ in faults]
        for number, trace in enumerate(traces):
            if not len(trace.points) and not self.tiling.is_mesh:
                over[number] = self._over_others(is_own, family.dying[number])
        met = [number for number, trace in enumerate(traces) if len(trace.points) or over[number].any()]
        if not met and (self.tiling.is_mesh or not self._is_drawn_together()):
            return dict.fromkeys(family.members.values(), sheet)
        met = family.with_ends(met, self.entry.divided().faults)
        self._require_one_height_beyond(family, met, sheet)
        if not self.tiling.is_mesh:
            plan, triangles = self.tiling.nodes, self.tiling.tiles
            common = self._continued(plan, self.tiling.heights(is_own), triangles, cut)
            traces = traces_on(Sheet(np.column_stack([plan, common]), triangles))
        beside = {n: traces[n].beside(self.vertices[:, :2])[self.triangles].any(axis=1) for n in met}
        seen = {}
        for sides in sorted({tuple(row[number] for number in met) for row in family.members.values()}):
            hidden = np.zeros(len(self.triangles), bool)
            for number, side in zip(met, sides, strict=True):
                if not side:
                    continue
                other = LEFT if side > 0 else RIGHT
                hidden |= (self.masks[:, family.dying[number]] == other) & (beside[number] | over[number])
            left = is_own & ~hidden if (is_own & ~hidden).any() else is_own  # if all are hidden, none are
            dying = [(family.dying[n], side, traces[n]) for n, side in zip(met, sides, strict=True) if side]
            seen[sides] = self._continued(plan, self.tiling.heights(left), triangles, [*cut, *dying])
        drawn = self._with_equal_ends(family, met, seen, plan, triangles)
        return {sides: drawn[tuple(sides[number] for number in met)] for sides in family.members.values()}

    def _is_drawn_together(self) -> bool:
        """Whether sheets of several families are, so that they need one plan."""
        structure = self.entry.divided()
        return bool(around_tips(structure, self.number, families(structure, self.number)))

    def _over_others(self, is_own: np.ndarray, fault: int) -> np.ndarray:
        """(T,) bool: the own triangles on one side of a fault that lie over or under some on its other side,
        as at a fault that is nearly level; none where it does not pass between all of these. Such a place is
        noted: should the triangles meet in one sheet, this is why."""
        is_over = np.zeros(len(self.triangles), bool)
        left, right = (np.flatnonzero(is_own & (self.masks[:, fault] == side)) for side in (LEFT, RIGHT))
        corners = [self.vertices[self.triangles[some]] for some in (left, right)]
        pairs = overlapping_pairs(*(faces[:, :, :2] for faces in corners))
        if not len(pairs):
            return is_over
        begin, end = common_lines(corners[0][pairs[:, 0]], corners[1][pairs[:, 1]])
        faults = self.entry.divided().faults
        is_missed = np.isnan(hit_shares(begin, end, faults.shapes[fault]))
        if is_missed.any():
            first = int(is_missed.argmax())
            place = (begin[first] + end[first]) / 2
            self.entry.overlapping[self.number] = _two_heights_beyond(faults.names[fault], place)
        else:
            is_over[left[pairs[:, 0]]] = is_over[right[pairs[:, 1]]] = True
        return is_over

    def _require_one_height_beyond(self, family: Family, met: list[int], sheet: Sheet) -> None:
        faults = self.entry.divided().faults
        for number in met:
            fault, within = family.dying[number], self._within(family)
            place = split_beyond(self.work, sheet, faults.shapes[fault], within)
            if place is not None:
                raise _two_heights_beyond(faults.names[fault], place)

    def drawn_together(self, family: Family, sheets: dict) -> Sheets:
        """Sheets of another family, by sides, for this one: its faults may die out elsewhere."""
        if len(set(sheets.values())) == 1:
            return sheets
        vertices, triangles = next(iter(sheets.values()))
        heights = {sides: sheet.vertices[:, 2] for sides, sheet in sheets.items()}
        plan = np.ascontiguousarray(vertices[:, :2])
        return self._with_equal_ends(family, range(len(family.dying)), heights, plan, triangles)

    def _with_equal_ends(
        self, family: Family, some: Iterable[int], heights: dict, plan: np.ndarray, triangles: np.ndarray
    ) -> Sheets:
        """Sheets with some heights, by sides, drawn together beyond the ends of some of the faults that die
        out."""
        shapes = self.entry.divided().faults.shapes
        ramps = [(shapes[family.dying[number]], 0.0) for number in some]
        equal = with_equal_ends(self.work, plan, triangles, heights, ramps, self._within(family))
        return shared({sides: Sheet(np.column_stack([plan, z]), triangles) for sides, z in equal.items()})

    def _within(self, family: Family) -> CompartmentTest:
        return CompartmentTest(self.work, self.entry.divided(), self.number, family)

    def _continued(
        self,
        plan: np.ndarray,
        known_heights: np.ndarray,
        triangles: np.ndarray,
        cut: list[tuple[int, int, Trace | None]],
    ) -> np.ndarray:
        """(N,) heights: the known ones, and where they are NaN those of the method. cut: the faults that cut
        the sheet off, its side, and where one dies out its trace."""
        tiling = self.tiling
        same = tiling.same if tiling is not None and tiling.nodes is plan else welded(plan)
        order = np.flatnonzero(~np.isnan(known_heights))[::-1]
        of_place = np.full(len(plan), np.nan)
        of_place[same[order]] = known_heights[order]  # the first of several at one position
        z = np.where(np.isnan(known_heights), of_place[same], known_heights)
        missing = np.flatnonzero(np.isnan(z) & (same == np.arange(len(plan))))
        if len(missing):
            rows = np.flatnonzero(~np.isnan(of_place))
            points = np.column_stack([plan[rows], of_place[rows]])
            vertex = None  # of the mesh, that each point is
            if tiling is not None and tiling.is_mesh:
                of_places = np.empty(len(plan), np.intp)
                of_places[same[order]] = order
                vertex = of_places[rows]
            is_by_node = self.method == CONTINUATION  # it finds each node by itself
            nodes, tiles = (plan[missing], None) if is_by_node else (plan, triangles)
            nodes = np.ascontiguousarray(nodes)
            lips = [self._lip(fault, side, _beside(trace, points), vertex) for fault, side, trace in cut]
            beyond = beyond_lips(self.work, points, lips, self.reach, self.method, self.settings)
            points = np.concatenate([points, beyond])
            task = Task(self.work, points, nodes, self.settings, tiles)
            interpolation = heights(self.method, task)
            of_place[missing] = interpolation.z if is_by_node else interpolation.z[missing]
            z = np.where(np.isnan(z), of_place[same], z)
        return z

    def _lip(self, fault: int, side: int, points: np.ndarray, vertex: np.ndarray | None) -> Lip:
        """points: (P,) bool, those that may lie on the cutoff line; vertex: (P,) of the mesh, where each is
        one."""
        nearest = None if vertex is None else self.on_lips[vertex, fault]
        return Lip(self.entry.divided().faults.shapes[fault], side, points, nearest)

    def finish(self, sheets: list[Sheet]) -> None:
        """The triangles of the sheets are no longer those of the file."""
        if len(sheets) > 1 or sheets[0].triangles is not self.triangles:
            self.entry.file_faces[self.number] = None


def _as_beside(vertices: np.ndarray, triangles: np.ndarray, mask: np.ndarray) -> np.ndarray:
    """The mask (T,) of triangles, changed: those that have none get that of a triangle beside them."""
    lacking = np.flatnonzero(mask == 0)
    if not len(lacking):
        return mask
    edges = edge_numbers(edges_of(welded(vertices)[triangles]), len(vertices)).reshape(3, -1).T
    while True:
        order = np.argsort(edges[mask > 0].ravel(), kind="stable")
        masked_edges, of_edge = edges[mask > 0].ravel()[order], np.repeat(mask[mask > 0], 3)[order]
        lacking = lacking[mask[lacking] == 0]
        if not len(masked_edges) or not len(lacking):
            return mask
        at = np.minimum(np.searchsorted(masked_edges, edges[lacking]), len(masked_edges) - 1)
        beside = np.where(masked_edges[at] == edges[lacking], of_edge[at], 0).max(axis=1)
        if not beside.any():
            return mask
        mask[lacking] = beside


def _beside(trace: Trace | None, points: np.ndarray) -> np.ndarray:
    """(P,) bool: the points beside a fault, all where it does not die out."""
    return np.ones(len(points), bool) if trace is None else trace.beside(points[:, :2])


def _two_heights_beyond(fault: str, place: np.ndarray) -> InputRefused:
    return InputRefused(
        f"it has two elevations beyond the tip of fault '{fault}' near {place_text(place)}",
        advice="extend the fault, or give data beyond the tip that agree",
        place=tuple(place.tolist()),
    )
