# SPDX-License-Identifier: GPL-3.0-or-later
"""What a tile is built from: of a project that nothing divides the triangles that meet it. With faults and
bodies a window around it: a separate project, of the triangles that are near, whose cells in the tile are
those of the whole."""

from __future__ import annotations

from collections.abc import Iterator
from copy import copy
from dataclasses import dataclass, replace
from typing import Any, TypeVar

import numpy as np

from ..base.algebra import norm
from ..base.mapped_arrays import StoreArray, unchanged
from ..base.triangles import Sheet, extents
from ..base.work import Work, native_module
from ..cells.joining import beyond_all
from ..cells.reach import PartExtents
from ..project.structure_entries import Body, Fault
from ..structures.parts.parts import Structures
from ..surfaces.rock_input import RockInput
from ..surfaces.rock_structure import RockFaults, RockStructure, fault_sides, joined
from .grid import Box, TileGrid, tile_grid, triangles_by_tile
from .tile_model import without_shape

_Entry = TypeVar("_Entry", Fault, Body)
_BESIDE = 0.05  # of the extent of the rock around a tile: a structure so near counts as there


@dataclass(frozen=True)
class Window:
    """inputs, structures, reach: as build_joined takes them; reach is None where nothing is divided. Each
    triangle that meets `safe` is there with all that lies over and under it, so a cell in this box is the
    same as in the whole. numbers: (S,) of the structures in the whole; part: (P,) a part of the whole for
    each of theirs."""

    safe: Box
    inputs: list[RockInput]
    structures: Structures
    reach: PartExtents | None
    numbers: np.ndarray
    part: np.ndarray


class _Plan:
    """The triangles (T, 3) of a sheet or a region, and its vertices in plan (V, 2)."""

    def __init__(self, vertices: np.ndarray, triangles: np.ndarray, keep: StoreArray):
        self.triangles, self.vertices = triangles, keep(np.ascontiguousarray(vertices[:, :2]))
        self._grid: TileGrid | None = None

    def sort(self, grid: TileGrid, keep: StoreArray) -> None:
        """Finds the triangles that meet each tile, so that those near a tile are found quickly."""
        pieces = sorted(
            triangles_by_tile(Sheet(self.vertices, self.triangles), grid), key=lambda piece: piece[0]
        )
        count = np.zeros((grid.columns, grid.rows), np.int64)
        for name, numbers in pieces:
            count[name] += len(numbers)
        self._grid, self._end = grid, count.cumsum().reshape(count.shape)
        self._begin = self._end - count
        numbers = np.concatenate([np.empty(0, np.int32), *(triangles for _, triangles in pieces)])
        self._of_tiles = keep(numbers)

    def meeting(self, box: Box) -> np.ndarray:
        """The numbers, ascending, of the triangles whose boxes meet a box."""
        assert self._grid is not None  # its triangles are sorted
        ends = ((self._begin[name], self._end[name]) for name in self._grid.tiles_meeting(box))
        of_tiles = np.asarray(self._of_tiles)  # a memmap would be slower
        tiles = [of_tiles[begin:end] for begin, end in ends if begin < end]
        if not tiles:
            return np.empty(0, np.int32)
        near = tiles[0] if len(tiles) == 1 else np.unique(np.concatenate(tiles))
        low, high = self.extents(near)
        return near[((low <= box[2:]) & (high >= box[:2])).all(axis=1)]

    def extents(self, numbers: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The least and the greatest plan coordinates (N, 2) of triangles."""
        return extents(self.vertices[self.triangles[numbers]])


class Windows:
    """The windows of a project that is read and interpolated, with its structures and sheets. inputs: the
    rock masses, plan coordinates that differ by rounding alone made equal and, where nothing divides them,
    borders joined; joined: the warning about that, or None. keep: where arrays of all triangles are kept."""

    def __init__(
        self,
        work: Work,
        inputs: list[RockInput],
        structures: Structures,
        keep: StoreArray = unchanged,
    ):
        self.inputs, self.joined = inputs, None
        self.structures, self._keep = structures, keep
        self._continued: list[tuple] = []
        self._find_plans()
        if not structures.is_divided:
            if not _have_one_mesh(inputs):
                self.inputs, self.joined = _joined(work, inputs, keep, borders=True)
                self._find_plans()
            return
        self._reach = PartExtents(work, structures)
        if _are_any_close(work, [plan.vertices for plan in self._all]):
            self.inputs, self.joined = _joined(work, inputs, keep, borders=False)
            self._find_plans()
        ends = [
            beyond_all(entry.divided().of_compartment(c), structures)
            for entry in inputs
            for c in range(len(entry.divided().sheets))
        ]
        tops = [field.top for entry in inputs for field in entry.fields]
        self._ends = min(low for low, _ in ends), max([*tops, *(high for _, high in ends)])
        arrays = structures.native()
        self._continued = native_module().continued_structures(arrays, structures.divided_box())
        corners = [triangles.reshape(-1, 3, 3) for triangles, _, _ in self._continued]
        self._extents = [extents(triangles) for triangles in corners]
        self._sides: dict[int, np.ndarray] = {}  # of faults, at the middles of all tiles

    def _find_plans(self) -> None:
        self._all: list[_Plan] = []
        self._plan_of = {sheet: self._known_plan(sheet) for sheet in self._sheets()}
        # level sets are made in each window again: their triangles are there for what shows surfaces
        self._plan_of |= {sheet: _Plan(*sheet.arrays, self._keep) for sheet in self._level_sets()}
        is_divided = self.structures.is_divided
        regions = [entry.region if is_divided or entry.is_clipped else None for entry in self.inputs]
        self._regions = [None if region is None else _Plan(*region.arrays, self._keep) for region in regions]
        self._all += [region for region in self._regions if region is not None]

    def _sheets(self) -> Iterator[Sheet]:
        for entry in self.inputs:
            for number in range(len(entry.surfaces)):
                if entry.field_of(number) is None:
                    yield from entry.divided().distinct(number)

    def _level_sets(self) -> Iterator[Sheet]:
        for entry in self.inputs:
            for series_field in entry.fields:
                for number in series_field.numbers:
                    yield from entry.divided().distinct(number)

    def _known_plan(self, sheet: Sheet) -> _Plan:
        """The plan of a sheet; sheets of one surface differ only in heights."""
        vertices, triangles = sheet
        for plan in self._all:
            if triangles is plan.triangles and np.array_equal(vertices[:, :2], plan.vertices):
                return plan
        self._all.append(_Plan(vertices, triangles, self._keep))
        return self._all[-1]

    def divide(self, tile_size: tuple[float, float]) -> TileGrid:
        """The grid of the tiles; to be called before any window is requested. Raises UsageError."""
        self._grid = tile_grid([plan.vertices for plan in self._all], tile_size)
        for plan in {*self._all, *self._plan_of.values()}:
            plan.sort(self._grid, self._keep)
        return self._grid

    def for_workers(self) -> Windows:
        """The same without what windows do not need; to be called after `divide`."""
        windows = copy(self)
        windows.inputs = [
            RockInput(
                without_shape(entry.rock),
                entry.surfaces,
                entry.region,
                structure=entry.structure,
                overlapping=entry.overlapping,
                fields=entry.fields,
            )
            for entry in self.inputs
        ]
        windows._keep = unchanged
        return windows

    def meets(self, box: Box) -> bool:
        """Whether anything lies over or under a box."""
        return any(len(plan.meeting(box)) for plan in self._all)

    def arrays(self) -> Iterator[np.ndarray]:
        """All arrays of shapes."""
        for sheet in self._sheets():
            yield from sheet
        for plan in self._all:
            yield plan.vertices
            yield plan.triangles
        for corners, is_continuation, _ in self._continued:
            yield corners
            yield is_continuation
        for entry in self.inputs:
            for series_field in entry.fields:
                for field in series_field.distinct():
                    yield from (np.array(field.lattice.origin), field.values, field.levels)
                    yield from (field.points, field.point_values)

    def _around(self, box: Box) -> Box:
        """A box around all triangles that meet one, and itself."""
        low, high = np.array(box[:2]), np.array(box[2:])
        for plan in self._all:
            met = plan.meeting(box)
            if len(met):
                least, most = plan.extents(met)
                low, high = np.minimum(low, least.min(axis=0)), np.maximum(high, most.max(axis=0))
        return *low.tolist(), *high.tolist()

    def window(self, work: Work, tile: tuple[int, int], farther: int | None = 0) -> Window:
        """The window of a tile, by its column and row. farther: this many more rows of triangles; None:
        all. Where nothing is divided it has what meets the tile."""
        of_plan: dict[_Plan, tuple[np.ndarray, np.ndarray, np.ndarray]] = {}
        if not self.structures.is_divided:
            box, none = self._grid.box(*tile), np.zeros(0, np.int8)
            # as no vertex is on a line: what meets the neighbors alone need not be examined then
            inner = (*np.nextafter(box[:2], np.inf).tolist(), *np.nextafter(box[2:], -np.inf).tolist())
            inputs = [self._rock(rock, inner, [], none, of_plan) for rock in range(len(self.inputs))]
            return Window(box, inputs, self.structures, None, np.empty(0, np.int32), np.zeros(1, np.int32))
        safe = self._around(self._around(self._grid.box(*tile)))
        if farther is None:
            safe = self._grid.whole
        for _ in range(farther or 0):
            safe = self._around(safe)
        taken = self._around(safe)
        around = self._around(taken)
        present, fixed = self._structures_near(work, tile, around)
        structures, part = self._few(present, fixed, around)
        inputs = [self._rock(rock, taken, present, fixed, of_plan) for rock in range(len(self.inputs))]
        faults = [number for number in present if number < len(self.structures.faults)]
        reach = self._reach.within(structures, faults, around)
        return Window(safe, inputs, structures, reach, np.array(present, np.int32), part)

    def _structures_near(self, work: Work, tile: tuple[int, int], box: Box) -> tuple[list[int], np.ndarray]:
        """The numbers of the structures that come into a box around a tile, and (S,) int8 the side on which
        all of the box is of the others."""
        space = self._space(box)
        margin = _BESIDE * (space[1] - space[0])
        low, high = space[0] - margin, space[1] + margin
        structures = self.structures
        number = {fault.name: n for n, fault in enumerate(structures.faults)}
        present, fixed = [], np.zeros(len(structures), np.int8)
        for s, (least, most) in enumerate(self._extents):
            if s >= len(structures.faults):
                is_there = bool((least.min(axis=0) <= high).all() and (most.max(axis=0) >= low).all())
                fixed[s] = 1  # outside of a body that is not there
            else:
                near = ((least <= high) & (most >= low)).all(axis=1)
                is_there = bool(near.any()) and _any_passes(self._continued[s][0][near], low, high)
                if not is_there:
                    fixed[s] = self._sides_of(work, s)[tile[1] * self._grid.columns + tile[0]]
            if is_there:
                present.append(s)
        # what a fault is beyond one at which it ends, that one says
        waiting = [s for s in present if s < len(structures.faults)]
        while waiting:
            ends = {number[name] for name in structures.faults[waiting.pop()].ends_at}.difference(present)
            present += ends
            waiting += ends
        present.sort()
        return present, fixed

    def _sides_of(self, work: Work, fault: int) -> np.ndarray:
        """(N,) int8 on which side of a fault the middles of all tiles are, row by row."""
        if fault not in self._sides:
            x, y = ((lines[1:] + lines[:-1]) / 2 for lines in (self._grid.x, self._grid.y))
            plan = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
            middles = np.column_stack([plan, np.full(len(plan), sum(self._ends) / 2)])
            shape = self.structures.fault_shapes()[fault]
            self._sides[fault] = fault_sides(work, middles, shape)
        return self._sides[fault]

    def _few(self, present: list[int], fixed: np.ndarray, around: Box) -> tuple[Structures, np.ndarray]:
        """Some structures alone; and (P,) for each of their parts a part of the whole."""
        whole, count = self.structures, len(self.structures.faults)
        whole_low, whole_high = whole.boxes()
        near = (whole_low[:, :2] <= around[2:]).all(axis=1) & (whole_high[:, :2] >= around[:2]).all(axis=1)
        rows = np.flatnonzero(_agree(whole.sides, present, fixed) & near)
        sides, first, part = np.unique(
            whole.sides[np.ix_(rows, np.array(present, np.int64))],
            axis=0,
            return_index=True,
            return_inverse=True,
        )
        low, high = np.full((len(sides), 3), np.inf), np.full((len(sides), 3), -np.inf)
        np.minimum.at(low, part.ravel(), whole_low[rows])
        np.maximum.at(high, part.ravel(), whole_high[rows])
        faults = [number for number in present if number < count]
        bodies = [number - count for number in present if number >= count]
        few = Structures(
            [_mesh_alone(whole.faults[number], points=None) for number in faults],
            [_mesh_alone(whole.bodies[number]) for number in bodies],
            [whole.displaced[number] for number in faults],
            [whole.times[number] for number in bodies],
            np.ascontiguousarray(sides),
            low,
            high,
            whole.box,
            [self._continued_near(number, around) for number in present],
            self._ends,
        )
        return few, rows[first].astype(np.int32)

    def _continued_near(self, number: int, around: Box) -> tuple:
        """The triangles of a structure that are nearest to anything in the window; of a body, or of a fault
        that is far away, all of them."""
        corners, is_continuation, end_sides = self._continued[number]
        space = self._space(around)
        away = 2 * norm(space[1] - space[0])
        low, high = self._extents[number]
        near = ((low <= space[1] + away) & (high >= space[0] - away)).all(axis=1)
        if number >= len(self.structures.faults) or not near.any():
            return self._continued[number]
        return np.ascontiguousarray(corners[near]), np.ascontiguousarray(is_continuation[near]), end_sides

    def _rock(self, rock: int, taken: Box, present: list[int], fixed: np.ndarray, of_plan: dict) -> RockInput:
        entry = self.inputs[rock]
        around = self._around(taken) if entry.fields else taken  # so far its rock reaches
        level_sets = {*self._level_sets()} if entry.fields else {}
        made: dict[Sheet, Sheet] = {}

        def sheet_of(sheet: Sheet) -> Sheet:
            if sheet not in made:
                box = around if sheet in level_sets else taken
                numbers, used, triangles = self._part(self._plan_of[sheet], box, of_plan)
                made[sheet] = Sheet(np.ascontiguousarray(sheet.vertices[used]), triangles, numbers)
            return made[sheet]

        structure = entry.divided()
        at = [n for n, number in enumerate(structure.faults.numbers) if number in present]
        whole = np.array(structure.faults.numbers, np.int64)
        rows = np.flatnonzero(_agree(structure.compartments, at, fixed[whole]))
        sides = structure.compartments[np.ix_(rows, np.array(at, np.int64))]
        compartments, first = np.unique(sides, axis=0, return_index=True)
        of = rows[first].tolist()
        sheets: list[list[Sheet | None]] = [[*map(sheet_of, structure.of_compartment(c))] for c in of]
        rock_structure = RockStructure(
            _faults(structure.faults, at, present),
            compartments,
            [structure.names[c] for c in of],
            sheets,
            [
                ([n for n, c in enumerate(of) if c in members], warning)
                for members, warning in structure.warnings
                if set(members).intersection(of)
            ],
        )
        region, plan = None, self._regions[rock]
        if plan is not None:
            _, used, triangles = self._part(plan, taken, of_plan)
            region = Sheet(np.ascontiguousarray(plan.vertices[used]), triangles)
        surfaces = [joined(rock_structure.distinct(k)) for k in range(len(entry.surfaces))]
        stub = without_shape(entry.rock)
        for surface, (vertices, triangles) in zip(stub.surfaces, surfaces, strict=True):
            surface.vertices, surface.triangles = vertices, triangles
        return RockInput(
            stub,
            list(surfaces),
            region,
            [None] * len(surfaces),
            [None] * len(surfaces),
            structure=rock_structure if self.structures.is_divided else None,
            overlapping=entry.overlapping,
            fields=[field.within(self._space(around), of) for field in entry.fields],
        )

    def _space(self, around: Box) -> np.ndarray:
        """(2, 3) a box in space over and under one in plan."""
        return np.array([[*around[:2], self._ends[0]], [*around[2:], self._ends[1]]])

    @staticmethod
    def _part(plan: _Plan, taken: Box, of_plan: dict) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """For a plan: the numbers of triangles in a box, of their vertices, and these triangles."""
        if plan not in of_plan:
            numbers = plan.meeting(taken)
            used, corners = np.unique(plan.triangles[numbers], return_inverse=True)
            of_plan[plan] = numbers, used, corners.reshape(-1, 3).astype(np.int32)
        return of_plan[plan]


def _are_any_close(work: Work, plans: list[np.ndarray]) -> bool:
    """Whether any x, or any y, of positions in plan differ by rounding alone. Without triangles, which
    might keep them apart: that is to be decided by those of all sheets."""
    none = np.empty((0, 3), np.int32)
    rocks: list[tuple] = [([], (plan, none), None, []) for plan in plans]
    return work.native(native_module().find_joins, rocks, borders=False) is not None


def _have_one_mesh(inputs: list[RockInput]) -> bool:
    """Whether all surfaces are interpolated on the whole mesh of one region: these have nothing to join."""
    if len(inputs) > 1 or inputs[0].region is None:
        return False
    rock, nodes = inputs[0].rock, len(inputs[0].region.vertices)
    return all(map(rock.is_interpolated, rock.surfaces)) and all(
        len(inputs[0].surface(number).vertices) == nodes for number in range(len(rock.surfaces))
    )


def _joined(
    work: Work, inputs: list[RockInput], keep: StoreArray, borders: bool
) -> tuple[list[RockInput], str | None]:
    """Rock masses with plan coordinates that differ by rounding alone made equal, the same in all windows,
    and borders joined where that is requested, one mesh at a time; and the warning about that, or None.
    Heights do not matter."""
    distinct = [
        [sheet for k in range(len(entry.surfaces)) for sheet in entry.divided().distinct(k)]
        for entry in inputs
    ]
    rocks: list[tuple] = [
        ([sheet.arrays for sheet in sheets], None if entry.region is None else entry.region.arrays, None, [])
        for sheets, entry in zip(distinct, inputs, strict=True)
    ]
    native = native_module()
    with work.phase(0.0, 1.0, "comparing the borders"):
        try:
            joins = work.native(native.find_joins, rocks, borders=borders)
        except native.InputError:
            return inputs, None  # the tile there refuses it with the names of the project
        if joins is None:
            return inputs, None

        def new(mesh: Sheet) -> Sheet | None:
            if not borders:
                return Sheet(keep(joins.snapped(mesh.vertices)), mesh.triangles)
            arrays = work.native(joins.mesh, *mesh.arrays)
            return None if arrays is None else Sheet(keep(arrays[0]), keep(arrays[1]))

        new_inputs = []
        for entry, sheets in zip(inputs, distinct, strict=True):
            meshes = {mesh: new(mesh) for mesh in (*sheets, entry.region) if mesh is not None}
            if None in meshes.values():
                return inputs, None
            entry = replace(entry, region=None if entry.region is None else meshes[entry.region])
            structure = entry.divided()
            compartments = range(len(structure.sheets))
            of = [[meshes[sheet] for sheet in structure.of_compartment(c)] for c in compartments]
            if borders:
                entry.surfaces = of[0]
            else:
                entry.structure = replace(structure, sheets=of)
            new_inputs.append(entry)
    return new_inputs, joins.text


def _agree(sides: np.ndarray, free: list[int], fixed: np.ndarray) -> np.ndarray:
    """(N,) bool: which rows (N, S) of sides may lie where the sides of all but some structures are fixed."""
    rest = np.setdiff1d(np.arange(sides.shape[1]), free)
    return ((sides[:, rest] == fixed[rest]) | (sides[:, rest] == 0)).all(axis=1)


def _mesh_alone(entry: _Entry, **more: Any) -> _Entry:
    """A fault or body with its arrays alone, and the file that they are from for messages."""
    return replace(entry, mesh=None, source=None, shape_file=entry.shape_source()[0], **more)


def _faults(faults: RockFaults, at: list[int], present: list[int]) -> RockFaults:
    """Some of the faults of a rock mass. present: the numbers of all structures that are there, in order."""
    new = {old: number for number, old in enumerate(at)}
    return RockFaults(
        [faults.names[n] for n in at],
        [faults.shapes[n] for n in at],
        [faults.youngest[n] for n in at],
        [faults.dies_out[n] for n in at],
        [present.index(faults.numbers[n]) for n in at],
        [[(new[other], side) for other, side in faults.ends[n] if other in new] for n in at],
    )


def _any_passes(triangles: np.ndarray, low: np.ndarray, high: np.ndarray) -> bool:
    """Whether any of (K, 3, 3) triangles passes a box: no axis separates them (T. Akenine-Moeller, "Fast 3D
    triangle-box overlap testing", 2001)."""
    half = (high - low) / 2
    corners = (triangles - (low + high) / 2) / half
    edges = np.roll(corners, -1, axis=1) - corners
    normal = np.cross(edges[:, 0], edges[:, 1])[:, None]
    axes = [np.broadcast_to(np.eye(3), (len(corners), 3, 3)), normal]
    axes += [np.cross(edges[:, k][:, None], np.eye(3)[None]) for k in range(3)]
    axis = np.concatenate(axes, axis=1)  # (K, 13, 3)
    along = np.einsum("kac,kvc->kav", axis, corners)
    reach = np.abs(axis).sum(axis=2)
    apart = (along.min(axis=2) > reach) | (along.max(axis=2) < -reach)
    return bool((~apart.any(axis=1)).any())
