# SPDX-License-Identifier: GPL-3.0-or-later
"""The boxes of each part of space that may contain rock: only there the cells of a part are made."""

from __future__ import annotations

import copy
import itertools

import numpy as np

from ..base.triangles import Sheet, border_loops, extents
from ..base.work import Work, native_module
from ..structures.parts.parts import Structures
from ..surfaces.planar_mesh import triangulate_rings
from ..surfaces.rock_structure import FaultShape, fault_sides

_CELLS = (64, 64, 16)  # of the grid, at most
_MARGIN = 0.125  # of a cell: so far a model reaches beyond its part at least
_BELOW, _ABOVE, _BOTH = 1, 2, 3  # on which sides of a fault a cell may have points


class PartExtents:
    """Answers where some part may be, and which triangles may lie over or under it.

    The box of all rock is divided into cells. A cell that a fault may pass, or continue through beyond its
    border, has points on both sides of it; what hangs together without passing such a cell is on one side. So
    a cell is never left out that a part has a point in.
    """

    def __init__(self, work: Work, structures: Structures):
        self.structures = structures
        box = structures.divided_box()
        self.low, self.size = box[0], box[1] - box[0]
        step = self.size[:2].max() / _CELLS[0]
        self.count = np.maximum(1, np.minimum(_CELLS, np.ceil(self.size / step))).astype(np.int64)
        self.step = self.size / self.count
        # of the triangles of sheets, which may differ in heights: the corners of the columns that they meet
        self.ranges: list[tuple[Sheet, np.ndarray]] = []
        self.masks = [self._sides(work, shape) for shape in structures.fault_shapes()]
        self.asked = np.ones(self.count, bool)

    def within(self, structures: Structures, faults: list[int], box: tuple[float, ...]) -> PartExtents:
        """The reach of the parts that meet a box in plan (low x, low y, high x, high y), for some of the
        faults, by their numbers. structures: these faults, and some bodies."""
        few = copy.copy(self)
        few.structures, few.ranges = structures, []
        few.masks = [self.masks[fault] for fault in faults]
        few.asked = self._cells_in(np.array(box[:2]), np.array(box[2:]))
        return few

    def cells_of(self, part: int) -> np.ndarray:
        """(nx, ny, nz) bool: in which cells a part may have points."""
        possible = np.ones(self.count, bool)
        for mask, side in zip(self.masks, self.structures.sides[part].tolist(), strict=False):
            if side:
                possible &= (mask & (_ABOVE if side > 0 else _BELOW)) > 0
        low, high = self.structures.boxes()
        cells = possible & self._cells_in(low[part], high[part])
        return cells if (cells & self.asked).any() else np.zeros_like(cells)

    def around(self, columns: np.ndarray) -> Sheet:
        """A region in plan: these columns, a small margin around them, and everything beyond the last
        ones."""
        lines = []
        for axis, (count, step) in enumerate(zip(columns.shape, self.step[:2], strict=True)):
            at = self.low[axis] + step * (np.arange(count + 1)[:, None] + _MARGIN * np.array([-1.0, 1.0]))
            at[0, 0] -= step
            at[-1, 1] += step
            lines.append(at.ravel())
        # the strips along the lines are cells, too
        cells = np.zeros([2 * count + 1 for count in columns.shape], bool)
        cells[1::2, 1::2] = columns
        cells = _wider(cells)
        number = np.arange(lines[0].size * lines[1].size).reshape(lines[0].size, -1)
        corners = number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]
        a, b, c, d = (corner[cells] for corner in corners)
        squares = np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])])
        plan = np.stack(np.meshgrid(*lines, indexing="ij"), axis=-1).reshape(-1, 2)
        vertices, triangles = triangulate_rings([_corners(plan[ring]) for ring in border_loops(squares)])
        return Sheet(np.ascontiguousarray(vertices), np.ascontiguousarray(triangles, np.int32))

    def over(self, columns: np.ndarray, sheet: Sheet) -> np.ndarray:
        """(T,) bool: the triangles of a sheet whose boxes in plan meet what `around` gives."""
        total = np.zeros(np.array(columns.shape) + 1, np.int64)
        total[1:, 1:] = columns.cumsum(axis=0).cumsum(axis=1)
        low, high_y, high_x, high = total.ravel()[self._corners_of(sheet)]
        return high - high_y - high_x + low > 0

    def _corners_of(self, sheet: Sheet) -> np.ndarray:
        """(4, T) the corners of the columns that the triangles of a sheet meet, in a row through all corners
        of columns; sheets of a surface differ in heights."""
        for other, corners in self.ranges:
            if sheet.triangles is other.triangles and sheet.has_plan_of(other):
                return corners
        low, high = extents(sheet.corners[..., :2])
        margin = _MARGIN * self.step[:2]
        first, last = self._range(low - margin, high + margin)
        (x0, y0), (x1, y1) = first.T, last.T + 1
        lines = self.count[1] + 1
        corners = np.array([x0 * lines + y0, x0 * lines + y1, x1 * lines + y0, x1 * lines + y1])
        self.ranges.append((sheet, corners))
        return corners

    def _range(self, low: np.ndarray, high: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The first and the last cells of boxes; a box beside a cell counts as in it."""
        n = low.shape[1]
        near = 1e-6 * self.step[:n]
        first = np.floor((low - near - self.low[:n]) / self.step[:n])
        last = np.floor((high + near - self.low[:n]) / self.step[:n])
        limit = self.count[:n] - 1
        return np.clip(first, 0, limit).astype(np.int64), np.clip(last, 0, limit).astype(np.int64)

    def _cells_in(self, low: np.ndarray, high: np.ndarray) -> np.ndarray:
        """(nx, ny, nz) bool: the cells that a box meets, in space or in plan."""
        first, last = self._range(low[None], high[None])
        inside = np.zeros(self.count, bool)
        inside[tuple(slice(a, b + 1) for a, b in zip(first[0], last[0], strict=True))] = True
        return inside

    def _sides(self, work: Work, fault: FaultShape) -> np.ndarray:
        beyond = native_module().structure_continuation(fault.native(), self.structures.divided_box())
        crossed, beyond = self._passed(fault.vertices[fault.triangles]), self._passed(beyond)
        part = _hanging_together(~(crossed | beyond))
        beside = _wider(crossed) & (part >= 0)
        middles = self._middles()
        # the first and the last of all, too: the fault is continued as far as the points reach
        asked = np.concatenate([middles[beside], middles[[0, -1], [0, -1], [0, -1]]])
        side = np.zeros(self.count, np.int8)
        side[beside] = fault_sides(work, asked, fault)[:-2]
        mask = np.full(self.count, _BOTH, np.uint8)
        for number in np.unique(part[beside]):
            seen = side[beside & (part == number)]
            if (seen == seen[0]).all():
                mask[part == number] = _ABOVE if seen[0] > 0 else _BELOW
        return mask

    def _middles(self) -> np.ndarray:
        axes = [self.low[k] + self.step[k] * (np.arange(self.count[k]) + 0.5) for k in range(3)]
        return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)

    def _passed(self, corners: np.ndarray) -> np.ndarray:
        """(nx, ny, nz) bool: the cells that triangles (K, 3, 3) pass, or come near."""
        passed = np.zeros(self.count, bool)
        pieces = _divided(corners, float(self.step.max()), self.low, self.low + self.size)
        if len(pieces):
            first, last = self._range(*extents(pieces))
            for move in itertools.product(*(range(int(most) + 1) for most in (last - first).max(axis=0))):
                at = first + move
                passed[tuple(at[(at <= last).all(axis=1)].T)] = True
        return passed


def _divided(pieces: np.ndarray, longest: float, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """(K, 3, 3) triangles that cover the same part of a box as others, with no edge longer than `longest`."""
    done = [np.empty((0, 3, 3))]
    while len(pieces):
        away = (pieces.max(axis=1) < low).any(axis=1) | (pieces.min(axis=1) > high).any(axis=1)
        pieces = pieces[~away]
        sides = np.linalg.norm(pieces[:, [1, 2, 0]] - pieces, axis=2)
        side = sides.argmax(axis=1)
        short = sides[np.arange(len(side)), side] <= longest
        done.append(pieces[short])
        order = (side[~short, None] + np.arange(3)) % 3
        a, b, c = np.take_along_axis(pieces[~short], order[:, :, None], axis=1).transpose(1, 0, 2)
        middle = (a + b) / 2
        pieces = np.concatenate([np.stack([a, middle, c], axis=1), np.stack([middle, b, c], axis=1)])
    return np.concatenate(done)


def _corners(ring: np.ndarray) -> np.ndarray:
    """The corners of a ring along two axes."""
    straight = (np.roll(ring, 1, axis=0) == ring) & (ring == np.roll(ring, -1, axis=0))
    return ring[~straight.any(axis=1)]


def _part(axis: int, part: slice) -> tuple:
    return tuple(part if k == axis else slice(None) for k in range(3))


def _wider(cells: np.ndarray) -> np.ndarray:
    """Cells and all cells that touch them, also at corners."""
    for axis in range(cells.ndim):
        one, other = (_part(axis, part)[: cells.ndim] for part in (slice(None, -1), slice(1, None)))
        wider = cells.copy()
        wider[one] |= cells[other]
        wider[other] |= cells[one]
        cells = wider
    return cells


def _hanging_together(cells: np.ndarray) -> np.ndarray:
    """For each of some cells the least number of a cell that is connected to it over faces; -1 for the
    others."""
    nothing = cells.size
    number = np.where(cells, np.arange(cells.size).reshape(cells.shape), nothing)
    while True:
        before = number.copy()
        for axis, turn in itertools.product(range(3), (1, -1)):
            # along a line of cells the least number so far continues, until a cell that is none
            view = np.moveaxis(number, axis, 0)[::turn]
            for k in range(1, len(view)):
                view[k] = np.where(view[k] < nothing, np.minimum(view[k], view[k - 1]), nothing)
        if np.array_equal(before, number):
            return np.where(cells, number, -1)
