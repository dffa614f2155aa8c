# SPDX-License-Identifier: GPL-3.0-or-later
"""Samples of a model, the centers of cells of a section, a fence, a borehole or a regular grid, and the
probabilities of blocks there."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from ..base.algebra import ranks_in_runs
from ..base.errors import UsageError
from ..base.triangles import Sheet
from ..base.work import Work, native_module, run
from ..cells.model_data import ModelData
from ..heights.true_thickness import Base
from .layer_values import at_places
from .sections.section_data import SectionData


@dataclass(frozen=True, eq=False)
class Samples:
    """places: (N, 3), the middles of cells."""

    places: np.ndarray


@dataclass(frozen=True, eq=False)
class SectionSamples(Samples):
    """Cells on a section or a fence, in rows from below. section: of the model. corners: (N, 4, 3) of the
    cells; flat: (N, 4, 2), the same as sections are drawn. columns: cells in a row."""

    section: SectionData
    corners: np.ndarray
    flat: np.ndarray
    columns: int

    @property
    def distance(self) -> np.ndarray:
        """(N,) float64: of the places from the left end of the drawing."""
        return self.flat[:, :, 0].mean(axis=1)


@dataclass(frozen=True, eq=False)
class BoreholeSamples(Samples):
    """Cells of a vertical line, from above. height: of a cell."""

    height: float


@dataclass(frozen=True, eq=False)
class HoleSamples(Samples):
    """Cells along a planned hole, from the collar. depths: (N,) of their middles along it."""

    depths: np.ndarray


@dataclass(frozen=True, eq=False)
class GridSamples(Samples):
    """Cells of a regular grid; x runs fastest, z slowest. As of regular_cells."""

    origin: np.ndarray
    size: np.ndarray
    counts: tuple[int, int, int]


@dataclass(frozen=True, eq=False)
class Probabilities:
    """Probabilities of blocks, whose names are `block_names`, at places. probability: (N, B) float64; the
    rest to 1 is the probability of no block."""

    block_names: list[str]
    probability: np.ndarray

    @property
    def _outside(self) -> np.ndarray:
        return np.maximum(1.0 - self.probability.sum(axis=1), 0.0)

    def entropy(self) -> np.ndarray:
        """(N,) float64, bits: how uncertain the block at each place is; 0 where all realizations agree.
        The outside counts as one more block (Shannon 1948; Wellmann and Regenauer-Lieb 2012)."""
        every = np.column_stack([self.probability, self._outside])
        shares = np.where(every > 0, every, 1.0)
        return np.abs((shares * np.log2(shares)).sum(axis=1))

    def likeliest(self) -> np.ndarray:
        """(N,) the number of the most probable block; -1 where the outside is most probable."""
        return np.column_stack([self._outside, self.probability]).argmax(axis=1) - 1

    def colors(self, block_colors: np.ndarray) -> np.ndarray:
        """(N, 3) the mean of the colors of the blocks, block_colors (B, 3) from 0 to 1; white for none."""
        return np.clip(self.probability @ block_colors + self._outside[:, None], 0.0, 1.0)


MOST_CELLS = 200_000_000
_AUTOMATIC = 100  # cells along the longest side
_PAIRS_AT_ONCE = 4_000_000
CellSize = float | Sequence[float] | np.ndarray | None


@dataclass(frozen=True, eq=False)
class RegularCells:
    """origin (3,): the lowest corner; size (3,): of a cell; counts (3,): of cells along x, y and z.

    volumes: (B, nz, ny, nx) float64, of each block in each cell, model units cubed.
    """

    origin: np.ndarray
    size: np.ndarray
    counts: tuple[int, int, int]
    volumes: np.ndarray

    @property
    def shares(self) -> np.ndarray:
        """(B, nz, ny, nx): the share of each block in each cell, from 0 to 1."""
        return self.volumes / self.size.prod()


def checked_size(model: ModelData, size: CellSize) -> np.ndarray:
    """(3,) the size of cells: of one number that in all directions, of two that in plan and in height;
    None: a
    hundredth of the longest side of the model. Raises UsageError."""
    if size is None:
        extent = np.ptp(model.vertices, axis=0).max() if len(model.vertices) else 1.0
        size = extent / _AUTOMATIC
    sizes = np.atleast_1d(np.asarray(size, np.float64))
    if sizes.shape not in ((1,), (2,), (3,)) or not (np.isfinite(sizes).all() and (sizes > 0).all()):
        raise UsageError(f"a cell size is one, two or three numbers above 0, not {size}")
    return sizes[{1: [0, 0, 0], 2: [0, 0, 1], 3: [0, 1, 2]}[len(sizes)]]


def regular_cells(
    model: ModelData,
    size: CellSize = None,
    step: Callable[[float], None] = lambda share: None,
) -> RegularCells:
    """The volume of each block in each cell of a grid that covers the model; its corners are multiples of the
    size. size: as of `checked_size`. step(share) is called after each block. Raises UsageError."""
    cell = checked_size(model, size)
    origin, counts = frame_of(model, cell)
    cells = int(np.prod(counts, dtype=np.float64))
    if cells * max(len(model.blocks), 1) > MOST_CELLS:
        raise UsageError(
            f"cells of {cell.tolist()} give {cells} cells for {len(model.blocks)} blocks; take larger ones"
        )
    nx, ny, nz = counts
    volumes = np.zeros((len(model.blocks), nz, ny, nx))
    for block in range(len(model.blocks)):
        step(block / len(model.blocks))
        triangles = (_triangles(model, block) - origin) / cell  # in cells
        for axis in range(3):
            triangles = _divided(triangles, axis)
        if not len(triangles):
            continue
        place = np.floor(triangles.mean(axis=1)).astype(np.int64)
        place = np.clip(place, 0, np.array(counts) - 1)
        a, b = (triangles[:, k, :2] - triangles[:, 0, :2] for k in (1, 2))
        area = (a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]) / 2  # above zero where it is seen from above
        flat = (place[:, 2] * ny + place[:, 1]) * nx + place[:, 0]
        within = area * (triangles[:, :, 2].mean(axis=1) - place[:, 2])
        volume = np.bincount(flat, within, nx * ny * nz).reshape(nz, ny, nx)
        whole = np.bincount(flat, area, nx * ny * nz).reshape(nz, ny, nx)
        volume[:-1] += np.cumsum(whole[::-1], axis=0)[::-1][1:]  # beneath a face cells are full
        volumes[block] = volume
    # volumes below this are rounding errors of empty cells
    volumes[np.abs(volumes) < 1e-12] = 0.0
    return RegularCells(origin, cell, counts, np.maximum(volumes, 0.0) * cell.prod())


def frame_of(model: ModelData, size: np.ndarray) -> tuple[np.ndarray, tuple[int, int, int]]:
    """The lowest corner of a grid that covers the model, and its numbers of cells along x, y and z."""
    if not len(model.vertices):
        return np.zeros(3), (1, 1, 1)
    low = np.floor(model.vertices.min(axis=0) / size)
    high = np.ceil(model.vertices.max(axis=0) / size)
    nx, ny, nz = (int(n) for n in np.maximum(high - low, 1))
    return low * size, (nx, ny, nz)


def _triangles(model: ModelData, block: int) -> np.ndarray:
    """(T, 3, 3): the boundary of a block, without vertical triangles."""
    shape = model.block_boundary(block)
    if not len(shape.faces):
        return np.empty((0, 3, 3))
    corners, _ = native_module().triangulate_faces(shape.vertices, shape.face_offsets, shape.face_vertices)
    return shape.vertices[corners]


def _divided(triangles: np.ndarray, axis: int) -> np.ndarray:
    """Triangles (T, 3, 3) divided along the planes where this coordinate is a whole number."""
    done = []
    while len(triangles):
        values = triangles[:, :, axis]
        level = np.floor(values.min(axis=1)) + 1
        crosses = values.max(axis=1) > level
        done.append(triangles[~crosses])
        triangles, level = triangles[crosses], level[crosses]
        if not len(triangles):
            break
        # turn each so that its first corner is alone on its side of the plane
        below = triangles[:, :, axis] < level[:, None]
        alone = np.where(below.sum(axis=1) == 1, below.argmax(axis=1), (~below).argmax(axis=1))
        order = (alone[:, None] + np.arange(3)) % 3
        a, b, c = np.take_along_axis(triangles, order[:, :, None], axis=1).transpose(1, 0, 2)
        ab, ac = (_crossing(a, other, axis, level) for other in (b, c))
        tip = np.stack([a, ab, ac], axis=1)
        rest = np.concatenate([np.stack([ab, b, c], axis=1), np.stack([ab, c, ac], axis=1)])
        tip_is_below = np.take_along_axis(below, alone[:, None], axis=1)[:, 0]
        twice = np.concatenate([tip_is_below, tip_is_below])
        done += [tip[tip_is_below], rest[~twice]]
        triangles = np.concatenate([tip[~tip_is_below], rest[twice]])
    return np.concatenate(done) if done else triangles


def _crossing(a: np.ndarray, b: np.ndarray, axis: int, level: np.ndarray) -> np.ndarray:
    """(N, 3): where edges meet the plane; the same from both ends."""
    swap = (a[:, axis] > b[:, axis])[:, None]
    a, b = np.where(swap, b, a), np.where(swap, a, b)
    t = ((level - a[:, axis]) / (b[:, axis] - a[:, axis]))[:, None]
    points = a + t * (b - a)
    points[:, axis] = level
    return points


@dataclass(frozen=True, eq=False)
class PlanGrids:
    """Heights and thicknesses at the centers of square cells in plan, row 0 in the north.

    north_west (2,): the outer corner of the first cell. size (2,): of a cell. top: (ny, nx), the highest
    rock,
    NaN where there is none. thickness, upper: (B, ny, nx), of each block its thickness (all its parts over
    the
    place), 0 where it is not, and the height of its top, NaN where it is not. true_thickness: (B, ny, nx),
    how far the top of each block is from its base, which continues beyond its border with the slopes that it
    has there; 0 where the block is not. deviation: name and (ny, nx) of each surface whose heights have a
    known variance, their standard deviation, NaN where there is none.
    """

    north_west: tuple[float, float]
    size: tuple[float, float]
    top: np.ndarray
    thickness: np.ndarray
    upper: np.ndarray
    true_thickness: np.ndarray
    deviation: list[tuple[str, np.ndarray]]


def plan_grids(model: ModelData, size: CellSize = None) -> PlanGrids:
    """The plan grids, exact at the centers of cells. size: as of `checked_size`; the height is ignored.
    Raises UsageError."""
    cell_size = checked_size(model, size)
    origin, (nx, ny, _) = frame_of(model, cell_size)
    if float(nx) * ny * max(len(model.blocks), 1) > MOST_CELLS:
        raise UsageError(f"cells of {cell_size[:2].tolist()} give {nx * ny} cells; take larger ones")
    thickness = np.zeros((len(model.blocks), ny * nx))
    upper = np.full((len(model.blocks), ny * nx), -np.inf)
    for block in range(len(model.blocks)):
        triangles = (_triangles(model, block) - origin) / cell_size
        for cell, z, sign, _ in over_centers(triangles, nx, ny):
            np.add.at(thickness[block], cell, z * sign)
            np.maximum.at(upper[block], cell, z)
    upper = np.where(np.isfinite(upper), upper * cell_size[2] + origin[2], np.nan)
    thickness = np.maximum(thickness * cell_size[2], 0.0)
    column, row = np.meshgrid(np.arange(nx), np.arange(ny))
    centers = origin[:2] + (np.column_stack([column.ravel(), row.ravel()]) + 0.5) * cell_size[:2]
    true = np.zeros_like(thickness)
    for block, of_block in enumerate(zip(upper, thickness, strict=True)):
        true[block] = run(
            partial(_true_thickness, model=model, block=block, centers=centers, heights=of_block)
        )
    top = np.full(ny * nx, np.nan) if not len(upper) else np.fmax.reduce(upper, axis=0)
    north = origin[1] + ny * cell_size[1]
    shape = (ny, nx)
    return PlanGrids(
        (float(origin[0]), float(north)),
        (float(cell_size[0]), float(cell_size[1])),
        top.reshape(shape)[::-1],
        thickness.reshape(-1, *shape)[:, ::-1],
        upper.reshape(-1, *shape)[:, ::-1],
        true.reshape(-1, *shape)[:, ::-1],
        [(name, values.reshape(shape)[::-1]) for name, values in _deviations(model, centers)],
    )


def _deviations(model: ModelData, centers: np.ndarray) -> Iterator[tuple[str, np.ndarray]]:
    """The standard deviation (N,) of the heights of each surface at places (N, 2), where it is known."""
    for number, name in enumerate(model.surface_names):
        if model.surface_kind[number] != 0 or model.lacks_project is not None:
            continue
        variance = model.surface_attributes(number)["variance"]
        if np.isfinite(variance).any():
            vertices, triangles = model.surface(number)
            deviation = np.sqrt(np.maximum(variance, 0.0))
            yield name, at_places(np.column_stack([vertices[:, :2], deviation]), triangles, centers)


def _true_thickness(
    work: Work, model: ModelData, block: int, centers: np.ndarray, heights: tuple[np.ndarray, np.ndarray]
) -> np.ndarray:
    """(N,) how far the top of a block is from its base at the centers of cells (N, 2); 0 where it is not.
    heights: (N,) of its top, and its vertical thickness."""
    upper, vertical = heights
    result, cells = np.zeros(len(centers)), np.flatnonzero(vertical > 0)
    triangles = _triangles(model, block)
    a, b = (triangles[:, k, :2] - triangles[:, 0, :2] for k in (1, 2))
    base = triangles[a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0] < 0]
    if len(cells) and len(base):
        corners = base.reshape(-1, 3)
        sheet = Sheet(corners, np.arange(len(corners), dtype=np.int32).reshape(-1, 3))
        points = np.column_stack([centers[cells], upper[cells]])
        under = Base(work, sheet, float(vertical.max()))
        result[cells] = np.minimum(under.thickness(points, points[:, 2] - vertical[cells]), vertical[cells])
    return result


def over_centers(
    triangles: np.ndarray, nx: int, ny: int
) -> Iterator[tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]]:
    """In pieces: numbers of cells whose center lies under or over a triangle, the triangle's height there,
    1 where it is seen from above, else -1, and the number of the triangle. triangles: (T, 3, 3), plan
    coordinates in cells. A center on an edge that two triangles share belongs to one of them."""
    a, b = (triangles[:, k, :2] - triangles[:, 0, :2] for k in (1, 2))
    twice = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    number = np.flatnonzero(twice)
    triangles, twice = triangles[number], twice[number]
    p, q, r = triangles[:, :, :2].transpose(1, 0, 2)  # NumPy takes several times as long for min(axis=1)
    low = np.ceil(np.minimum(np.minimum(p, q), r) - 0.5).astype(np.int64)
    high = np.floor(np.maximum(np.maximum(p, q), r) - 0.5).astype(np.int64)
    low, high = np.maximum(low, 0), np.minimum(high, [nx - 1, ny - 1])
    wide = np.maximum(high - low + 1, 0)
    pairs = wide.prod(axis=1)
    pieces = max(1, -(-int(pairs.sum()) // _PAIRS_AT_ONCE))
    bounds = np.searchsorted(np.cumsum(pairs), np.linspace(0, pairs.sum(), pieces + 1)[1:-1])
    for part in np.split(np.arange(len(triangles)), bounds):
        of = np.repeat(part, pairs[part])
        if not len(of):
            continue
        rank = ranks_in_runs(pairs[part])
        x, y = low[of, 0] + rank % wide[of, 0], low[of, 1] + rank // wide[of, 0]
        center = np.stack([x + 0.5, y + 0.5], axis=1)
        corners = triangles[of]
        sign = np.sign(twice[of])
        inside = np.ones(len(of), bool)
        sides = []
        for k in range(3):
            p, q = corners[:, (k + 1) % 3, :2], corners[:, (k + 2) % 3, :2]
            turned = ((p[:, 0] > q[:, 0]) | ((p[:, 0] == q[:, 0]) & (p[:, 1] > q[:, 1])))[:, None]
            p, q = np.where(turned, q, p), np.where(turned, p, q)
            u, v = q - p, center - p
            side = np.where(turned[:, 0], -1.0, 1.0) * (u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0])
            sides.append(side)
            # on the edge: of the triangle to the left of it as it runs from its lower end
            inside &= (side * sign > 0) | ((side == 0) & ((sign > 0) != turned[:, 0]))
        weights = np.stack(sides, axis=1)[inside]
        z = (weights * corners[inside, :, 2]).sum(axis=1) / weights.sum(axis=1)
        yield (y * nx + x)[inside], z, sign[inside], number[of[inside]]
