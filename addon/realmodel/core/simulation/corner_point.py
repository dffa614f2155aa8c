# SPDX-License-Identifier: GPL-3.0-or-later
"""Corner-point grids of a model, with vertical pillars: Model.corner_point_grid.

A column of cells takes its blocks from the exact vertical line through its center, and its corners from the
lines along its pillars. Where a pillar does not meet the surface of a column, as beyond a fault, the triangle
that the center meets goes on to it; there heights of neighboring columns differ, which is a step (Ponting
1989, "Corner Point Geometry in Reservoir Simulation").
"""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np

from ..base.algebra import ascending, begins_run, cos, dot, norm, ranks_in_runs, sin
from ..base.errors import BuildWarning, InputRefused, UsageError, number_list
from ..base.work import native_module
from ..cells.model_data import ModelData
from ..notebook import ShortRepr
from ..results.samples import MOST_CELLS, CellSize, checked_size, over_centers

_ABSENT, _VOID = -2, -1  # among the blocks of a column: no more, and a gap between two
_NO_THICKNESS = 1e-9  # of the heights of the model
_OFF_EDGES = np.array([1.37e-7, 0.73e-7])  # of a column: so lines through centers pass no vertex and no edge
_UPRIGHT = 1e-9  # of the square of its longest side: twice the area in plan of a vertical triangle
_AROUND = [(u, v) for u in (-0.5, 0.0, 0.5) for v in (-0.5, 0.0, 0.5)]  # of a place, in columns
_MOST_CHANGE = 0.01  # of the volume of a block, without a warning


@dataclass(frozen=True, eq=False, repr=False)
class CornerPointGrid(ShortRepr):
    """A corner-point grid as Eclipse and its relatives read it: depths count down, k from the top.

    shape: (nx, ny, nz), cells along i, j, k. cell_size: (2,) of a column along i and j, azimuth: of j, in
    degrees clockwise from north; i points to the right of j. coord: (ny + 1, nx + 1, 6) float64, of each
    pillar x, y and depth of its top and of its bottom. zcorn: (2 nz, 2 ny, 2 nx) float64, the depth of each
    corner. actnum, fipnum: (nz, ny, nx) int32, 1 where a cell is active, and the number of its block plus 1,
    0 in a void; flattened, all are in the order of the file. names: of the blocks. volumes, exact_volumes:
    (B,) float64, of the blocks in the grid and in the model, model units cubed. warnings: what the grid does
    not show. Coordinates are those of the model.
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
    contacts = _Contacts(model, frame)
    columns = _Columns(model, frame, contacts)
    order = _order_of_layers(columns.blocks)
    nx, ny = frame.counts
    if float(nx) * ny * len(order) * layers > MOST_CELLS:
        raise UsageError(
            f"columns of {size.tolist()} give {nx} x {ny} x {len(order) * layers} cells; take larger ones"
        )
    return _assembled(model, frame, columns, order, int(layers))


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
    """The faces of a model between two blocks, or a block and the outside, as triangles (T, 3, 3) in columns.

    above, below: (T,) the block on each side, -1 outside. sheet: (T,) equal where triangles go on in one
    another: of one surface in one compartment, or between the same two.
    """

    def __init__(self, model: ModelData, frame: _Frame):
        blocks = model.face_blocks
        faces = np.flatnonzero(blocks[:, 0] != blocks[:, 1])
        offsets, corners = model.face_corners(faces, np.zeros(len(faces), bool))
        rows, begins = native_module().triangulate_faces(model.vertices, offsets, corners)
        self.triangles = frame.in_columns(model.vertices)[rows]
        face = np.repeat(faces, np.diff(begins))
        a, b = (self.triangles[:, k, :2] - self.triangles[:, 0, :2] for k in (1, 2))
        twice = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
        upper = np.where(twice > 0, 1, 0)  # a face is seen from above from its second cell
        cells = model.face_cells[face]
        below, above = cells[np.arange(len(face)), 1 - upper], cells[np.arange(len(face)), upper]
        self.below, self.above = (np.append(model.cell_block, -1)[side] for side in (below, above))
        parts = np.append(model.cell_compartment, -1).astype(np.int64) + 1
        under, over = parts[below], parts[above]
        surface = model.face_surface[face].astype(np.int64)
        is_fault = (surface >= 0) & (np.append(model.surface_kind, 0)[np.maximum(surface, -1)] == 1)
        one, two = np.where(is_fault, under, np.maximum(under, over)), np.where(is_fault, over, 0)
        count = int(parts.max()) + 1
        self.sheet = ((surface - surface.min()) * count + one) * count + two
        self._twice = twice
        sides = self.triangles[:, [1, 2, 0], :2] - self.triangles[:, :, :2]
        is_upright = np.abs(twice) <= _UPRIGHT * dot(sides, sides).max(axis=1)
        self._is_step = (is_upright | (is_fault & (under == over))) & (cells >= 0).all(axis=1)

    def columns_with_steps(self, nx: int, ny: int) -> np.ndarray:
        """(nx * ny,) bool: columns at walls within the model and at tips of faults: a sheet may jump."""
        start = self.triangles[self._is_step][:, :, :2]
        side = start[:, [1, 2, 0]] - start
        parts = np.ceil(2 * norm(side)).astype(np.int64).ravel() + 1
        share = ranks_in_runs(parts + 1) / np.repeat(parts, parts + 1)
        places = np.repeat(start.reshape(-1, 2), parts + 1, axis=0)
        places = places + share[:, None] * np.repeat(side.reshape(-1, 2), parts + 1, axis=0)
        is_near = np.zeros((ny, nx), bool)
        for shift in _AROUND:
            i, j = np.floor(places + shift).astype(np.int64).T
            is_near[np.clip(j, 0, ny - 1), np.clip(i, 0, nx - 1)] = True
        return is_near.ravel()

    def on_lines(self, nx: int, ny: int, shift: np.ndarray, scale: float = 1.0) -> tuple:
        """(line, height, triangle) of each crossing of vertical lines, the centers of nx x ny columns of the
        triangles moved and scaled about the middle; by line, from above."""
        middle = np.array([nx, ny]) / 2
        moved = self.triangles.copy()
        moved[:, :, :2] = (moved[:, :, :2] + shift - middle) * scale + middle
        parts = [(line, z, triangle) for line, z, _, triangle in over_centers(moved, nx, ny)]
        line, z, triangle = (np.concatenate(column) for column in zip(*parts, strict=True))
        order = ascending(line, -z, triangle)
        return line[order], z[order], triangle[order]

    def at(self, triangle: np.ndarray, places: np.ndarray) -> np.ndarray:
        """(N,) the heights of the planes of triangles (N,) at places (N, 2) in columns."""
        p, q, r = self.triangles[triangle].transpose(1, 0, 2)
        a, b, d = q - p, r - p, places - p[:, :2]
        s = (d[:, 0] * b[:, 1] - d[:, 1] * b[:, 0]) / self._twice[triangle]
        t = (a[:, 0] * d[:, 1] - a[:, 1] * d[:, 0]) / self._twice[triangle]
        return p[:, 2] + s * a[:, 2] + t * b[:, 2]


class _Columns:
    """What each column has, from above.

    blocks: (C, M) int64, _VOID for a gap, _ABSENT behind the last. heights: (C, M + 1, 4) of the contacts
    between them at the corners: of lower j and lower i, lower j and upper i, upper j and lower i, both upper.
    """

    def __init__(self, model: ModelData, frame: _Frame, contacts: _Contacts):
        nx, ny = frame.counts
        column, z, triangle = contacts.on_lines(nx, ny, _OFF_EDGES)
        heights, is_met = self._corners(frame, contacts, column, z, triangle)
        first = np.flatnonzero(begins_run(column))
        counts = np.diff(np.append(first, len(column)))
        rank = ranks_in_runs(counts)
        most = int(counts.max(initial=1))
        shape = (nx * ny, most, 4)
        filled, met = np.full(shape, -np.inf), np.zeros(shape, bool)
        filled[column, rank], met[column, rank] = heights, is_met
        self.heights = _in_order(filled, met)
        center = np.full(shape[:2], np.nan)
        center[column, rank] = z
        blocks = np.full((nx * ny, most), _ABSENT)
        blocks[column, rank] = contacts.below[triangle]
        thick = center[:, :-1] - center[:, 1:]
        is_thin = thick <= _NO_THICKNESS * np.ptp(model.vertices[:, 2])
        blocks[:, :-1][is_thin] = _ABSENT
        last = np.append(first[1:], len(column)) - 1
        blocks[column[last], rank[last]] = _ABSENT  # below is the outside
        self.blocks = blocks[:, :-1]

    @staticmethod
    def _corners(
        frame: _Frame, contacts: _Contacts, column: np.ndarray, z: np.ndarray, triangle: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """(N, 4) the heights of contacts at the pillars of their columns, and whether their sheet is there.
        Where it is not, the columns around take the mean of what goes on to it."""
        nx, ny = frame.counts
        pillars = (nx + 1) * (ny + 1)
        # the outermost pillars stand just inside of the model
        line, height, of = contacts.on_lines(nx + 1, ny + 1, np.array([0.5, 0.5]), 1.0 + 1e-9)
        number = np.unique(contacts.sheet, return_inverse=True)[1]
        number = number.ravel().astype(np.int64)
        code = number[of] * pillars + line
        order = ascending(code, height)
        code, height, of = code[order], height[order], of[order]
        same = _NO_THICKNESS * float(np.ptp(height))
        has_steps = contacts.columns_with_steps(nx, ny)[column]
        centers = np.column_stack([column % nx, column // nx]) + 0.5
        result, is_met = np.empty((len(column), 4)), np.empty((len(column), 4), bool)
        places = np.empty((len(column), 4), np.int64)
        for corner in range(4):
            i, j = column % nx + corner % 2, column // nx + corner // 2
            near = contacts.at(triangle, np.column_stack([i, j]).astype(np.float64))
            wanted = number[triangle] * pillars + j * (nx + 1) + i
            begin, end = np.searchsorted(code, wanted), np.searchsorted(code, wanted, "right")
            is_met[:, corner] = end > begin
            best = np.minimum(begin, len(code) - 1)
            for step in range(1, int((end - begin).max(initial=0))):  # the nearest of several
                other = np.minimum(begin + step, len(code) - 1)
                is_nearer = np.abs(height[other] - near) < np.abs(height[best] - near)
                best = np.where((begin + step < end) & is_nearer, other, best)
            at_step = np.flatnonzero(is_met[:, corner] & has_steps)
            jump = height[best[at_step]] - near[at_step]
            back = z[at_step] - contacts.at(of[best[at_step]], centers[at_step])
            # where two planes meet on the way, both go on to the same side of the other
            is_met[at_step, corner] = (jump * back >= 0) | (np.minimum(np.abs(jump), np.abs(back)) <= same)
            result[:, corner] = np.where(is_met[:, corner], height[best], near)
            places[:, corner] = wanted
        beyond = ~is_met
        _, group = np.unique(places[beyond], return_inverse=True)
        group = group.ravel()
        if len(group):
            result[beyond] = (np.bincount(group, result[beyond]) / np.bincount(group))[group]
        lowest, highest = height.min(), height.max()
        return np.clip(result, lowest, highest), is_met


def _in_order(heights: np.ndarray, is_met: np.ndarray) -> np.ndarray:
    """Heights (C, M, 4) none of which is above the one before it; those that were met bind the others."""
    upper = np.minimum.accumulate(np.where(is_met, heights, np.inf), axis=1)
    lower = np.where(is_met, heights, -np.inf)[:, ::-1]
    lower = np.maximum.accumulate(lower, axis=1)[:, ::-1]
    bound = np.where(is_met, heights, np.minimum(np.maximum(heights, lower), upper))
    return np.minimum.accumulate(bound, axis=1)


def _order_of_layers(blocks: np.ndarray) -> list[int]:
    """The blocks of the layers from above, of which those of each column (C, M) are some, in this order."""
    stacks = [tuple(b for b in row if b != _ABSENT) for row in np.unique(blocks, axis=0).tolist()]
    order = _sorted_blocks(stacks)
    for stack in sorted(set(stacks), key=lambda stack: (-len(stack), stack)):
        order = _with_stack(order, stack)
    return order


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
    model: ModelData, frame: _Frame, columns: _Columns, order: list[int], layers: int
) -> CornerPointGrid:
    (nx, ny), count = frame.counts, len(order)
    layer = _layers_of(columns.blocks, order)
    # of a column without rock the cells have no thickness; they are at the middle of the model
    is_rock = (columns.blocks != _ABSENT).any(axis=1)
    first = (columns.blocks != _ABSENT).argmax(axis=1)
    bottom = columns.heights[np.arange(nx * ny), first]
    middle = (model.vertices[:, 2].min() + model.vertices[:, 2].max()) / 2
    bottom = np.where(is_rock[:, None], bottom, middle)
    depth = np.empty((count, layers, 2, ny, 2, nx, 2))
    for number in range(count):
        top = bottom.copy()
        column, rank = np.nonzero(layer == number)
        top[column] = columns.heights[column, rank]
        bottom = top.copy()
        bottom[column] = columns.heights[column, rank + 1]
        for part in range(layers):
            for side in range(2):
                share = (part + side) / layers
                z = bottom if share == 1.0 else top + share * (bottom - top)
                depth[number, part, side] = -z.reshape(ny, nx, 2, 2).transpose(0, 2, 1, 3)
    zcorn = depth.reshape(2 * count * layers, 2 * ny, 2 * nx) + 0.0
    fipnum = np.repeat(np.array(order, np.int32) + 1, layers)[:, None, None]
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
    )
    thickness = grid.thickness
    is_active = (thickness > _NO_THICKNESS * np.ptp(model.vertices[:, 2])) & (fipnum > 0)
    grid.actnum[:] = is_active
    volume = thickness[is_active] * frame.size.prod()
    grid.volumes[:] = np.bincount(fipnum[is_active] - 1, volume, len(model.blocks))
    grid.warnings.extend(_warnings(model, grid, columns.blocks))
    return grid


def _layers_of(blocks: np.ndarray, order: list[int]) -> np.ndarray:
    """(C, M) the place in the order of each block of each column, -1 for none."""
    stacks, stack_of = np.unique(blocks, axis=0, return_inverse=True)
    layer = np.full(stacks.shape, -1)
    for number, stack in enumerate(stacks.tolist()):
        ranks = [rank for rank, block in enumerate(stack) if block != _ABSENT]
        layer[number, ranks] = _places(order, tuple(stack[rank] for rank in ranks))
    return layer[stack_of.ravel()]


def _warnings(model: ModelData, grid: CornerPointGrid, blocks: np.ndarray) -> list[BuildWarning]:
    """What the grid shows otherwise than the model."""
    warnings = [
        BuildWarning(
            f"block '{block.name}' has a volume of {volume:.6g} in the corner-point grid, "
            f"{100 * change:+.2g} % of {block.volume:.6g} in the model; smaller columns change less",
            "corner_point_volume",
            model.rock_inputs[block.rock].rock.name if model.rock_inputs else None,
        )
        for block, volume, change in zip(model.blocks, grid.volumes, grid.difference.tolist(), strict=True)
        if abs(change) > _MOST_CHANGE
    ]
    repeated = [
        f"'{name}' in {count}"
        for number, name in enumerate(grid.names)
        if (count := int(((blocks == number).sum(axis=1) > 1).sum()))
    ]
    if repeated:
        text = (
            "pillars are vertical, so a block that is above and below another one, as at reverse faults, "
            "in folds and around bodies, has layers for each time, and overhanging parts have steps; "
            "columns: "
        )
        warnings.append(BuildWarning(text + number_list(repeated), "corner_point_repeats"))
    if gaps := int((blocks == _VOID).any(axis=1).sum()):
        text = f"{gaps} columns of the corner-point grid go through a void, whose cells are inactive"
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
