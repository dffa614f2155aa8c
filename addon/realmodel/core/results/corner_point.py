# SPDX-License-Identifier: GPL-3.0-or-later
"""Corner-point grids of a model, with vertical pillars: Model.corner_point_grid.

A column of cells takes its blocks and their thickness from the exact vertical line through its center, and
the shape of contacts from the lines along its pillars. Where a pillar does not meet the surface of a column,
as beyond a fault, the triangle that the center meets continues to it; there heights of neighboring columns
differ, which is a step (Ponting 1989, "Corner Point Geometry in Reservoir Simulation").
"""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np

from ..base.algebra import ascending, begins_run, cos, dot, ranks_in_runs, sin
from ..base.errors import BuildWarning, InputRefused, UsageError, number_list
from ..base.work import native_module
from ..cells.model_data import ModelData
from ..notebook import ShortRepr
from .samples import MOST_CELLS, CellSize, checked_size, over_centers

_ABSENT, _VOID = -2, -1  # among the blocks of a column: no more, and a gap between two
_NO_THICKNESS = 1e-9  # of the heights of the model
_OFF_EDGES = np.array([1.37e-7, 0.73e-7])  # of a column: so lines through centers pass no vertex and no edge
_UPRIGHT = 1e-9  # of the square of its extent: the area in plan of a vertical face
_INSIDE = 4e-7  # of a column: twice what the outermost pillars are moved into the model
_NEAR = 1e-6  # of a column: more than rounding and the moves of lines
_SIDES = np.array([[-0.5, -0.5], [0.5, -0.5], [-0.5, 0.5], [0.5, 0.5]])  # corners of a column from its center
_MOST_CHANGE = 0.01  # of the volume of a block, without a warning


@dataclass(frozen=True, eq=False, repr=False)
class CornerPointGrid(ShortRepr):
    """A corner-point grid as Eclipse and its relatives read it: depths count down, k from the top.

    shape: (nx, ny, nz), cells along i, j, k. cell_size: (2,) of a column along i and j, azimuth: of j, in
    degrees clockwise from north; i points to the right of j. coord: (ny + 1, nx + 1, 6) float64, of each
    pillar x, y and depth of its top and of its bottom. zcorn: (2 nz, 2 ny, 2 nx) float64, the depth of each
    corner. actnum, fipnum: (nz, ny, nx) int32, 1 where a cell is active, and the number of its block plus 1,
    0 in a void; flattened, all are in the order of the file. names: of the blocks. volumes, exact_volumes:
    (B,) float64, of the blocks in the grid and in the model, model units cubed. porosity, permeability: (B,)
    float64, of the library, NaN where it has none. warnings: what the grid does not show. Coordinates are
    those of the model.
    """

    shape: tuple[int, int, int]
    cell_size: np.ndarray
    azimuth: float
    coord: np.ndarray
    zcorn: np.ndarray
    actnum: np.ndarray
    fipnum: np.ndarray
    names: list[str]
    volumes: np.ndarray
    exact_volumes: np.ndarray
    porosity: np.ndarray
    permeability: np.ndarray
    warnings: list[BuildWarning] = field(default_factory=list)

    @property
    def thickness(self) -> np.ndarray:
        """(nz, ny, nx) float64: the mean thickness of each cell, which times its area in plan is its volume,
        model units."""
        nx, ny, nz = self.shape
        corners = self.zcorn.reshape(nz, 2, ny, 2, nx, 2)
        return (corners[:, 1] - corners[:, 0]).mean(axis=(2, 4))

    @property
    def difference(self) -> np.ndarray:
        """(B,) float64: how much larger each block is in the grid, as a share of its exact volume; 0 for an
        absent one."""
        change = self.volumes - self.exact_volumes
        return np.divide(change, self.exact_volumes, out=np.zeros(len(change)), where=self.exact_volumes > 0)


def corner_point_grid(
    model: ModelData, cell_size: CellSize = None, layers: int = 1, azimuth: float = 0.0
) -> CornerPointGrid:
    """A corner-point grid with vertical pillars, whose layers follow the blocks and end where they end.

    cell_size: of columns in plan, one number or two, model units; columns fill the box of the model, so their
    size may differ by what makes their number whole. None: a hundredth of the longest side. layers: of each
    block, at least 1. azimuth: of the direction j, degrees clockwise from north. A block that a column has
    several times, as above and below a reverse fault, has layers for each time.

    Raises UsageError, InputRefused where the model has no cells.
    """
    size = checked_size(model, cell_size)[:2]
    if isinstance(layers, bool) or not isinstance(layers, (int, np.integer)) or layers < 1:
        raise UsageError(f"layers must be a whole number above 0, not {layers!r}")
    if not np.isfinite(azimuth):
        raise UsageError(f"the azimuth must be a finite number, not {azimuth!r}")
    if not len(model.cell_block):
        raise InputRefused("the model has no cells", advice="its surfaces enclose no block")
    frame = _Frame.of(model, size, float(azimuth) % 360.0)
    columns = _Columns(model, frame)
    nx, ny = frame.counts
    of_blocks = _Layers.of(columns, nx * ny, len(model.blocks))
    nz = len(of_blocks.blocks) * layers
    if float(nx) * ny * nz > MOST_CELLS:
        raise UsageError(f"columns of {size.tolist()} give {nx} x {ny} x {nz} cells; take larger ones")
    return _assembled(model, frame, columns, of_blocks, int(layers))


@dataclass(frozen=True, eq=False)
class _Frame:
    """Columns in plan. axes: (2, 2), of length 1, along i and along j. low: (2,) along these, the first
    corner. size, counts: of columns."""

    azimuth: float
    axes: np.ndarray
    low: np.ndarray
    size: np.ndarray
    counts: tuple[int, int]

    @classmethod
    def of(cls, model: ModelData, size: np.ndarray, azimuth: float) -> _Frame:
        turn = np.radians(azimuth)
        s, c = (0.0, 1.0) if azimuth == 0.0 else (float(sin(turn)), float(cos(turn)))
        axes = np.array([[c, -s], [s, c]])
        x, y = model.vertices[:, :2].T
        along = np.stack([x * a + y * b for a, b in axes], axis=1)
        low, extent = along.min(axis=0), np.ptp(along, axis=0)
        numbers = np.maximum(np.round(extent / size), 1.0)
        if numbers.prod() > MOST_CELLS:
            raise UsageError(f"columns of {size.tolist()} are {numbers.prod():.3g}; take larger ones")
        nx, ny = (int(number) for number in numbers)
        return cls(azimuth, axes, low, extent / numbers, (nx, ny))

    def in_columns(self, points: np.ndarray) -> np.ndarray:
        """(..., 3): points (..., 3) with plan coordinates that count columns from the first corner."""
        x, y = points[..., 0], points[..., 1]
        (a, b), (c, d) = self.axes
        u = (x * a + y * b - self.low[0]) / self.size[0]
        v = (x * c + y * d - self.low[1]) / self.size[1]
        return np.stack([u, v, points[..., 2]], axis=-1)

    def pillars(self) -> np.ndarray:
        """(ny + 1, nx + 1, 2): x and y."""
        u, v = (
            np.arange(n + 1) * s + low for n, s, low in zip(self.counts, self.size, self.low, strict=True)
        )
        u, v = np.meshgrid(u, v)
        return np.stack([u * self.axes[0, k] + v * self.axes[1, k] for k in range(2)], axis=-1)


class _Contacts:
    """The faces of a model between two blocks, or a block and the outside, that lines through the centers of
    columns meet: as triangles (T, 3, 3) in columns.

    below: (T,) the block under each, -1 outside. sheet: (T,) equal where triangles continue in one another:
    of one surface in one compartment, or between the same two, seen from one side. slope: (T, 2) over a
    column. has_steps: (ny * nx,) bool, columns with walls or tips of faults, where a sheet may jump.
    """

    def __init__(self, model: ModelData, frame: _Frame):
        blocks = model.face_blocks
        faces = np.flatnonzero(blocks[:, 0] != blocks[:, 1])
        offsets, corners = model.face_corners(faces, np.zeros(len(faces), bool))
        vertices = frame.in_columns(model.vertices)
        plan = vertices[corners, :2]
        low, high = (end.reduceat(plan, offsets[:-1]) for end in (np.minimum, np.maximum))
        is_step = _are_steps(model, faces, _plan_areas(plan, offsets), (high - low).max(axis=1))
        self.has_steps = _touched(low[is_step], high[is_step], frame.counts)
        faces = faces[_hold_whole(low, high) | _hold_whole(low + 0.5, high + 0.5)]
        offsets, corners = model.face_corners(faces, np.zeros(len(faces), bool))
        rows, begins = native_module().triangulate_faces(model.vertices, offsets, corners)
        face = np.repeat(faces, np.diff(begins))
        self.triangles = vertices[rows]
        (ax, ay, az), (bx, by, bz) = ((self.triangles[:, k] - self.triangles[:, 0]).T for k in (1, 2))
        twice = ax * by - ay * bx
        slopes = np.stack([az * by - bz * ay, ax * bz - bx * az], axis=1)
        self.slope = np.divide(slopes, twice[:, None], out=np.zeros_like(slopes), where=twice[:, None] != 0)
        upper = np.where(twice > 0, 1, 0)  # a face is seen from above from its second cell
        cells, number = model.face_cells[face], np.arange(len(face))
        below, above = cells[number, 1 - upper], cells[number, upper]
        self.below = np.append(model.cell_block, -1)[below].astype(np.int64)
        parts = np.append(model.cell_compartment, -1)
        under, over = parts[below], parts[above]
        count, is_fault = int(parts.max()) + 2, _on_fault(model, face)
        one, two = np.where(is_fault, under, np.maximum(under, over)), np.where(is_fault, over, -1)
        surface = model.face_surface[face].astype(np.int64) + 1
        self.sheet = ((surface * count + one + 1) * count + two + 1) * 2 + upper

    def on_lines(self, nx: int, ny: int, shift: np.ndarray, scale: np.ndarray | float = 1.0) -> tuple:
        """(line, height, triangle) of each crossing of vertical lines, the centers of nx x ny columns of the
        triangles moved and scaled about the middle."""
        middle = np.array([nx, ny]) / 2
        moved = self.triangles.copy()
        moved[:, :, :2] = (moved[:, :, :2] + (shift - middle)) * scale + middle
        none = np.empty(0, np.int64)
        parts = [(line, z, triangle) for line, z, _, triangle in over_centers(moved, nx, ny)]
        return tuple(np.concatenate(column) for column in zip((none, none, none), *parts, strict=True))

    def at(self, triangle: np.ndarray, places: np.ndarray) -> np.ndarray:
        """(N,) the heights of the planes of triangles (N,) at places (N, 2) in columns."""
        first = self.triangles[:, 0][triangle]
        return first[:, 2] + dot(self.slope[triangle], places - first[:, :2])


def _hold_whole(low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """(N,) bool: the boxes from low to high (N, 2) that have a point of whole numbers."""
    holds = np.floor(high + _NEAR) >= np.ceil(low - _NEAR)
    return np.asarray(holds[:, 0] & holds[:, 1])


def _on_fault(model: ModelData, faces: np.ndarray) -> np.ndarray:
    return np.append(model.surface_kind, 0)[model.face_surface[faces]] == 1  # -1 is no surface


def _plan_areas(corners: np.ndarray, offsets: np.ndarray) -> np.ndarray:
    """(F,) the areas in plan of faces, whose corners (N, 2) follow one another."""
    after = np.arange(1, len(corners) + 1)
    after[offsets[1:] - 1] = offsets[:-1]
    x, y = (corners - np.repeat(corners[offsets[:-1]], np.diff(offsets), axis=0)).T
    return np.abs(np.add.reduceat(x * y[after] - x[after] * y, offsets[:-1])) / 2


def _are_steps(model: ModelData, faces: np.ndarray, areas: np.ndarray, extents: np.ndarray) -> np.ndarray:
    """(F,) bool: faces within a compartment that are upright, or on a fault that ends there."""
    cells = model.face_cells[faces]
    one, other = np.append(model.cell_compartment, -1)[cells].T
    is_wall = (areas <= _UPRIGHT * extents**2) | _on_fault(model, faces)
    return is_wall & (one == other) & (cells >= 0).all(axis=1)


def _touched(low: np.ndarray, high: np.ndarray, counts: tuple[int, int]) -> np.ndarray:
    """(ny * nx,) bool: the columns that boxes from low to high (N, 2) touch."""
    nx, ny = counts
    i, j = np.clip(np.ceil(low - _NEAR) - 1, 0, counts).astype(np.int64).T
    to_i, to_j = np.clip(np.floor(high + _NEAR) + 1, 0, counts).astype(np.int64).T
    change = np.zeros((ny + 1, nx + 1), np.int64)
    for row, column, sign in ((j, i, 1), (j, to_i, -1), (to_j, i, -1), (to_j, to_i, 1)):
        np.add.at(change, (row, column), sign)
    return (change.cumsum(axis=0).cumsum(axis=1)[:ny, :nx] > 0).ravel()


class _Columns:
    """The contacts of blocks along the lines through the centers of columns, one column after another, from
    above.

    column: (N,). below: (N,) the block, _VOID for none. corners: (N, 4) heights at the pillars: of lower j
    and lower i, lower j and upper i, upper j and lower i, both upper. Over all columns their mean is that of
    the heights at the centers, so blocks have their volume.
    """

    def __init__(self, model: ModelData, frame: _Frame):
        contacts = _Contacts(model, frame)
        column, z, triangle = contacts.on_lines(*frame.counts, _OFF_EDGES)
        order = ascending(column, -z, triangle)
        column, z, triangle = column[order], z[order], triangle[order]
        goes_on = np.append(column[1:] == column[:-1], False)[: len(column)]
        is_thin = goes_on & (z - np.append(z[1:], 0.0) <= _NO_THICKNESS * np.ptp(model.vertices[:, 2]))
        column, z, triangle = column[~is_thin], z[~is_thin], triangle[~is_thin]
        is_new = begins_run(np.stack([column, contacts.below[triangle]], axis=1))
        column, z, triangle = column[is_new], z[is_new], triangle[is_new]
        if not (column[1:] == column[:-1]).any():
            size = frame.size.tolist()
            raise UsageError(f"no column of {size} has its center in the model; take smaller ones")
        self.column, self.below = column, contacts.below[triangle]
        corners, pillar = self._on_pillars(frame, contacts, column, z, triangle)
        leader = _leaders(column, z, corners)
        corners = _with_mean(corners, z, pillar, leader == np.arange(len(z)))
        corners = corners[leader] + (z - z[leader])[:, None]
        goes_on = (column[1:] == column[:-1])[:, None]
        while (is_high := goes_on & (corners[1:] > corners[:-1])).any():
            corners[1:][is_high] = corners[:-1][is_high]
        self.corners = corners

    @staticmethod
    def _on_pillars(
        frame: _Frame, contacts: _Contacts, column: np.ndarray, z: np.ndarray, triangle: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """(N, 4) the heights at pillars of contacts at heights z (N,) in the centers of columns; and (N, 4)
        the number of what meets the pillar there. Where the sheet does not, its plane continues to the
        pillar, and the number is -1."""
        nx, ny = frame.counts
        pillars = (nx + 1) * (ny + 1)
        # the outermost pillars stand just inside of the model
        wider = 1.0 + _INSIDE / np.array(frame.counts)
        line, height, of = contacts.on_lines(nx + 1, ny + 1, np.array([0.5, 0.5]), wider)
        code = contacts.sheet[of] * pillars + line
        order = ascending(code, height)
        code, height, of = code[order], height[order], of[order]
        first = np.flatnonzero(begins_run(code))
        sizes, code = (
            np.diff(np.append(first, len(code))),
            np.append(code[first], -1),
        )  # the last is no pillar
        same = _NO_THICKNESS * float(np.ptp(height))
        j, i = np.divmod(column, nx)
        centers = np.stack([i, j], axis=1) + 0.5
        corners = contacts.at(triangle, centers)[:, None] + dot(contacts.slope[triangle][:, None], _SIDES)
        pillar = np.full(corners.shape, -1)
        for corner, near in enumerate(corners.T):
            wanted = contacts.sheet[triangle] * pillars + (j + corner // 2) * (nx + 1) + i + corner % 2
            run = np.searchsorted(code[:-1], wanted)
            is_met = code[run] == wanted
            best, count = np.append(first, 0)[run], np.append(sizes, 0)[run] * is_met
            for step in range(1, int(count.max(initial=1))):  # the nearest of several
                rows = np.flatnonzero(count > step)
                other = first[run[rows]] + step
                is_nearer = np.abs(height[other] - near[rows]) < np.abs(height[best[rows]] - near[rows])
                best[rows] = np.where(is_nearer, other, best[rows])
            rows = np.flatnonzero(is_met & contacts.has_steps[column])
            up = height[best[rows]] - near[rows]
            back = z[rows] - contacts.at(of[best[rows]], centers[rows])
            # where two planes meet on the way, both continue to the same side of the other
            is_met[rows] = (up * back >= 0) | (np.minimum(np.abs(up), np.abs(back)) <= same)
            pillar[is_met, corner] = best[is_met]
            corners[is_met, corner] = height[best[is_met]]
        return corners, pillar


def _leaders(column: np.ndarray, z: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """(N,) for each contact at height z (N,) the one whose shape it takes, so that none crosses another in
    its column: of contacts that would, the flattest. So walls and faults are steps, and beds continue."""
    leader, goes_on = np.arange(len(z)), column[1:] == column[:-1]
    crosses = goes_on & (corners[1:] > corners[:-1]).any(axis=1)
    has_crossing = np.zeros(int(column.max(initial=-1)) + 1, bool)
    has_crossing[column[1:][crosses]] = True
    rows = np.flatnonzero(has_crossing[column])
    z, shape, goes_on = z[rows, None], corners[rows] - z[rows, None], goes_on[rows[:-1]]
    group = of_group = np.arange(len(rows))
    while True:
        bent = z + shape[of_group[group]]
        crosses = goes_on & (bent[1:] > bent[:-1]).any(axis=1) & (group[1:] != group[:-1])
        if not crosses.any():
            leader[rows] = rows[of_group[group]]
            return leader
        group = np.cumsum(np.append(True, (group[1:] != group[:-1]) & ~crosses)) - 1
        of_group = ascending(group, np.ptp(shape, axis=1))[begins_run(group)]


def _with_mean(corners: np.ndarray, z: np.ndarray, pillar: np.ndarray, is_free: np.ndarray) -> np.ndarray:
    """Corners (N, 4) of free contacts moved, those at one pillar (N, 4) alike, so that together they have the
    mean of the heights z (N,)."""
    change = np.broadcast_to((z - corners.mean(axis=1))[:, None], corners.shape).copy()
    shared = (pillar >= 0) & is_free[:, None]
    number = pillar[shared]
    change[shared] = (np.bincount(number, change[shared]) / np.maximum(np.bincount(number), 1))[number]
    return corners + change


@dataclass(frozen=True, eq=False)
class _Layers:
    """blocks: (L,) of the layers from above, _VOID for one of none. is_present: (L, C) bool, in each column.
    repeats: (B,) in how many columns a block is several times. voids: columns with one."""

    blocks: np.ndarray
    is_present: np.ndarray
    repeats: np.ndarray
    voids: int

    @classmethod
    def of(cls, columns: _Columns, count: int, blocks: int) -> _Layers:
        column = columns.column
        sizes = np.bincount(column, minlength=count)
        rows = np.full((count, int(sizes.max(initial=1)) - 1), _ABSENT)
        inner = np.append(column[1:] == column[:-1], False)  # below the last is the outside
        rows[column[inner], ranks_in_runs(sizes)[inner]] = columns.below[inner]
        begins = begins_run(rows)
        table, number = np.unique(rows[begins], axis=0, return_inverse=True)
        stack_of = number.ravel()[np.cumsum(begins) - 1]
        stacks = [tuple(block for block in row if block != _ABSENT) for row in table.tolist()]
        order = _sorted_blocks(stacks)
        for stack in sorted(stacks, key=lambda stack: (-len(stack), stack)):
            order = _with_stack(order, stack)
        has = np.zeros((len(stacks), len(order)), bool)
        for row, stack in zip(has, stacks, strict=True):
            row[_places(order, stack)] = True
        widths = np.bincount(stack_of, minlength=len(stacks))
        times = np.array([[stack.count(block) for block in range(blocks)] for stack in stacks])
        return cls(
            np.array(order, np.int64),
            has[stack_of].T,
            ((times > 1) * widths[:, None]).sum(axis=0),
            int(widths[[_VOID in stack for stack in stacks]].sum()),
        )


def _sorted_blocks(stacks: list[tuple[int, ...]]) -> list[int]:
    """The blocks, each after those that are above it anywhere; where blocks are above one another, the one
    with the fewest of these before it, of equal ones the youngest."""
    above: dict[int, set[int]] = {block: set() for stack in stacks for block in stack if block != _VOID}
    for stack in stacks:
        for upper, lower in pairwise(stack):
            if upper != lower and _VOID not in (upper, lower):
                above[lower].add(upper)
    order: list[int] = []
    while above:
        block = min(above, key=lambda block: (len(above[block]), -block))
        order.append(block)
        del above[block]
        for others in above.values():
            others.discard(block)
    return order


def _with_stack(order: list[int], stack: tuple[int, ...]) -> list[int]:
    """The shortest order that has both an order and a stack, by their longest common subsequence."""
    if _places(order, stack) is not None:
        return order
    common = np.zeros((len(order) + 1, len(stack) + 1), np.int64)
    for i in range(len(order) - 1, -1, -1):
        for j in range(len(stack) - 1, -1, -1):
            is_same = order[i] == stack[j]
            common[i, j] = common[i + 1, j + 1] + 1 if is_same else max(common[i + 1, j], common[i, j + 1])
    merged, i, j = [], 0, 0
    while i < len(order) or j < len(stack):
        if i < len(order) and j < len(stack) and order[i] == stack[j]:
            merged.append(order[i])
            i, j = i + 1, j + 1
        elif j == len(stack) or (i < len(order) and common[i + 1, j] >= common[i, j + 1]):
            merged.append(order[i])
            i += 1
        else:
            merged.append(stack[j])
            j += 1
    return merged


def _places(order: list[int], stack: tuple[int, ...]) -> list[int] | None:
    """Where each block of a stack is in the order, the first place that can be; None where one is in none."""
    places, begin = [], 0
    for block in stack:
        try:
            begin = order.index(block, begin) + 1
        except ValueError:
            return None
        places.append(begin - 1)
    return places


def _assembled(
    model: ModelData, frame: _Frame, columns: _Columns, of_blocks: _Layers, layers: int
) -> CornerPointGrid:
    (nx, ny), count = frame.counts, len(of_blocks.blocks)
    sizes = np.bincount(columns.column, minlength=nx * ny)
    # of a column without rock the cells have no thickness; they are at the middle of the model
    middle = (model.vertices[:, 2].min() + model.vertices[:, 2].max()) / 2
    corners = np.concatenate([columns.corners, np.full((1, 4), middle)])
    contact = np.where(sizes > 0, np.cumsum(sizes) - sizes, len(columns.corners))
    depth = np.empty((count * layers, 2, ny, 2, nx, 2))
    bottom = corners[contact]
    for number, is_present in enumerate(of_blocks.is_present):
        contact = contact + is_present
        top, bottom = bottom, corners[contact]
        for part in range(layers):
            for side in range(2):
                share = (part + side) / layers
                z = bottom if share == 1.0 else top + share * (bottom - top)
                depth[number * layers + part, side] = -z.reshape(ny, nx, 2, 2).transpose(0, 2, 1, 3)
    zcorn = depth.reshape(-1, 2 * ny, 2 * nx)
    zcorn += 0.0  # no -0
    fipnum = np.repeat(of_blocks.blocks.astype(np.int32) + 1, layers)[:, None, None]
    fipnum = np.broadcast_to(fipnum, (count * layers, ny, nx)).copy()
    pillars = frame.pillars()
    ends = np.broadcast_to([zcorn.min(), zcorn.max()], (*pillars.shape[:2], 2))
    grid = CornerPointGrid(
        shape=(nx, ny, count * layers),
        cell_size=frame.size,
        azimuth=frame.azimuth,
        coord=np.concatenate([pillars, ends[..., :1], pillars, ends[..., 1:]], axis=-1),
        zcorn=zcorn,
        actnum=np.zeros(fipnum.shape, np.int32),
        fipnum=fipnum,
        names=[block.name for block in model.blocks],
        volumes=np.zeros(len(model.blocks)),
        exact_volumes=np.array([block.volume for block in model.blocks]),
        porosity=_of_library(model, "porosity"),
        permeability=_of_library(model, "permeability"),
    )
    thickness = grid.thickness
    is_active = (thickness > _NO_THICKNESS * np.ptp(model.vertices[:, 2])) & (fipnum > 0)
    grid.actnum[:] = is_active
    volume = thickness[is_active] * frame.size.prod()
    grid.volumes[:] = np.bincount(fipnum[is_active] - 1, volume, len(model.blocks))
    grid.warnings.extend(_warnings(grid, of_blocks))
    return grid


def _of_library(model: ModelData, key: str) -> np.ndarray:
    """(B,) float64: the library's value of each block, NaN for none."""
    library = model.project.library
    entries = [library.get(block.property) if library else None for block in model.blocks]
    return np.array([getattr(entry, key, None) for entry in entries], np.float64)


def _warnings(grid: CornerPointGrid, of_blocks: _Layers) -> list[BuildWarning]:
    """What the grid shows otherwise than the model."""
    warnings = []
    order = np.argsort(-np.abs(grid.difference), kind="stable")
    changes = [(grid.names[block], float(grid.difference[block])) for block in order]
    large = [f"'{name}' {100 * change:+.2g} %" for name, change in changes if abs(change) > _MOST_CHANGE]
    if large:
        text = (
            "blocks that are few columns wide, or whose border is not along columns, have volumes in the "
            "corner-point grid that differ by more than 1 % from the model; smaller columns change less: "
        )
        warnings.append(BuildWarning(text + number_list(large), "corner_point_volume"))
    repeats = zip(grid.names, of_blocks.repeats.tolist(), strict=True)
    repeated = [f"'{name}' in {count}" for name, count in repeats if count]
    if repeated:
        text = (
            "pillars are vertical, so a block that is above and below another one, as at reverse faults, "
            "in folds and around bodies, has layers for each time, and overhanging parts have steps; "
            "columns: "
        )
        warnings.append(BuildWarning(text + number_list(repeated), "corner_point_repeats"))
    for key in ("porosity", "permeability"):
        is_known = np.isfinite(getattr(grid, key))
        without = [name for name, known in zip(grid.names, is_known, strict=True) if not known]
        if without and is_known.any():
            text = f"blocks without a {key} in the library have 0 in the corner-point grid: "
            warnings.append(BuildWarning(text + number_list(without), f"corner_point_{key}"))
    if of_blocks.voids:
        text = (
            f"{of_blocks.voids} columns of the corner-point grid go through a void, which has no active cells"
        )
        warnings.append(BuildWarning(text, "corner_point_voids"))
    return warnings


def corner_point_entry(grid: CornerPointGrid) -> dict:
    """The entry of a corner-point grid in the report: lengths and volumes are in model units."""
    rows = zip(
        grid.names, grid.volumes.tolist(), grid.exact_volumes.tolist(), grid.difference.tolist(), strict=True
    )
    return {
        "shape": list(grid.shape),
        "cell_size": grid.cell_size.tolist(),
        "azimuth": grid.azimuth,
        "active_cells": int(grid.actnum.sum()),
        "blocks": [
            {"block": name, "volume": volume, "exact_volume": exact, "difference": difference}
            for name, volume, exact, difference in rows
        ],
    }
