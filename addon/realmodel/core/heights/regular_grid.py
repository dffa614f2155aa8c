# SPDX-License-Identifier: GPL-3.0-or-later
"""Regular grids: points that are the nodes of a grid, rotated in plan or not, and bilinear heights between
them.

Calculated without NumPy's linear algebra, whose last digits differ between processors.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ..base.algebra import hypot
from ..base.errors import InputRefused, place_text
from ..base.mapped_arrays import ROWS_AT_ONCE, in_pieces
from .from_neighbors import nearest_heights
from .interpolation import Result, Task

# Of a cell: how far a point may lie from its place in the grid (coordinates are written with few digits).
_OFF_GRID = 0.02
_CELL = 0.5  # of a cell: so far each node of a raster reaches, where it says all that is known
_ON_LINE = 1e-9  # of a cell: nearer points lie on a line of the grid, up to rounding
_SAMPLE = 200  # points whose neighbors show the grid's directions
_MOST_EMPTY = 100  # nodes of the grid for each point
_NEAR = 16  # points, in the mean, in a cell where neighbors are looked for
_SURE = 0.99  # of a cell's side: points so far are in the cells around, but for rounding
_ONE_ROW = "the points lie in one row; a grid needs two"


@dataclass(frozen=True)
class RegularGrid:
    """Node (i, j) lies at origin + i * axes[0] + j * axes[1], both from 0 and below `shape`."""

    origin: np.ndarray
    axes: np.ndarray
    shape: tuple[int, int]

    def places(self, plan: np.ndarray) -> np.ndarray:
        """(N, 2) places in numbers of cells."""
        return _in_cells(plan - self.origin, self.axes)

    def nodes(self, points: np.ndarray) -> np.ndarray:
        """(P, 2) int64: the nodes that points are."""
        return np.rint(self.places(points[:, :2])).astype(np.int64)


def bilinear(task: Task) -> Result:
    """Bilinear between the four nodes of a cell (a product of linear functions). Outside the grid, and in
    cells that lack a node: the heights of its border straight on, or of the nearest point."""
    if not len(task.nodes):
        return Result(np.empty(0), outside=np.empty(0, bool))
    grid = find_grid(task.points)
    at = grid.places(task.nodes)
    last = np.array(grid.shape) - 1
    border = _CELL if task.settings.get("extrapolate") == "none" else 0.0
    outside = np.maximum(-at, at - last).max(axis=1, initial=0.0) > border + _OFF_GRID
    at = np.clip(np.where(np.abs(at - np.rint(at)) < _ON_LINE, np.rint(at), at), 0, last)
    i, j = np.minimum(at.astype(np.int64), last - 1).T
    u, v = at[:, 0] - i, at[:, 1] - j
    known = _heights(task.points, grid)
    z = np.zeros(len(at))
    for di, dj, weight in (
        (0, 0, (1 - u) * (1 - v)),
        (1, 0, u * (1 - v)),
        (0, 1, (1 - u) * v),
        (1, 1, u * v),
    ):
        corner = known[i + di, j + dj]
        z += np.where(weight == 0, 0.0, weight * corner)  # a corner that is not needed may be missing
    missing = np.isnan(z)
    if missing.any():
        z[missing] = nearest_heights(task, np.ascontiguousarray(task.nodes[missing]))
    return Result(z, outside=outside | missing)


def _heights(points: np.ndarray, grid: RegularGrid) -> np.ndarray:
    """The heights of the nodes; NaN where there is no point. Raises InputRefused where two points that are
    one node have different heights."""
    z = np.full(grid.shape, np.nan)
    for piece in in_pieces(points):
        z[tuple(grid.nodes(piece).T)] = piece[:, 2]
    for piece in in_pieces(points):
        differs = z[tuple(grid.nodes(piece).T)] != piece[:, 2]
        for bad in piece[differs][:1]:
            raise InputRefused(
                f"two points with different elevations lie at one node of the grid, {place_text(bad)}",
                item="points",
                place=tuple(bad),
            )
    return z


def find_grid(points: np.ndarray) -> RegularGrid:
    """The grid whose nodes the points (P, 3) are, which may be in a file. Raises InputRefused, naming a point
    that is off it."""
    if len(points) < 4:
        raise InputRefused("a grid needs at least four points", item="points")
    start = points[0, :2]
    grid = RegularGrid(start, _axes(points), (0, 0))
    for _ in range(3):  # the axes are known by one cell at first; the whole grid makes them sharper
        grid = _fitted(points, start, grid)
    far, worst, least, most = -1.0, 0, np.full(2, np.inf), np.full(2, -np.inf)
    for number, piece in enumerate(in_pieces(points)):
        at = grid.places(piece[:, :2])
        node = np.rint(at)
        off = np.abs(at - node).max(axis=1)
        if off.max() > far:
            far, worst = float(off.max()), number * ROWS_AT_ONCE + int(off.argmax())
        least, most = np.minimum(least, node.min(axis=0)), np.maximum(most, node.max(axis=0))
    if far > _OFF_GRID:
        raise InputRefused(
            f"the points are not a regular grid: {place_text(points[worst])} is {far:.2g} cells off",
            item="points",
            place=tuple(points[worst]),
            advice='use method = "tin" or "kriging" for scattered points',
        )
    shape = int(most[0] - least[0]) + 1, int(most[1] - least[1]) + 1
    if min(shape) < 2:
        raise InputRefused(_ONE_ROW, item="points")
    if shape[0] * shape[1] > _MOST_EMPTY * len(points):
        raise InputRefused(
            f"{len(points)} points would make a grid of {shape[0]} x {shape[1]} nodes, nearly all empty",
            item="points",
        )
    origin = grid.origin + int(least[0]) * grid.axes[0] + int(least[1]) * grid.axes[1]
    return RegularGrid(origin, grid.axes, shape)


def _fitted(points: np.ndarray, start: np.ndarray, grid: RegularGrid) -> RegularGrid:
    """The grid that fits points best, with the nodes that they are in another: by sums over pieces."""

    def pieces() -> Iterator[tuple[np.ndarray, np.ndarray]]:
        for piece in in_pieces(points):
            yield np.rint(grid.places(piece[:, :2])), piece[:, :2] - start

    sums = [np.array([node.sum(axis=0), plan.sum(axis=0)]) for node, plan in pieces()]
    mean, middle = _added(sums) / len(points)
    sums = [_products(node - mean, plan - middle) for node, plan in pieces()]
    axes = _fitted_axes(*_added(sums))
    if abs(_determinant(axes)) <= 1e-9 * np.square(axes).sum():
        raise InputRefused(_ONE_ROW, item="points")
    return RegularGrid(start + middle - mean[0] * axes[0] - mean[1] * axes[1], axes, grid.shape)


def _added(sums: list) -> np.ndarray:
    total = sums[0]
    for term in sums[1:]:
        total = total + term
    return total


def _determinant(axes: np.ndarray) -> float:
    return axes[0, 0] * axes[1, 1] - axes[0, 1] * axes[1, 0]


def _in_cells(plan: np.ndarray, axes: np.ndarray) -> np.ndarray:
    """(N, 2): how many times each of the axes leads to places."""
    x, y = plan.T
    along = x * axes[1, 1] - y * axes[1, 0], y * axes[0, 0] - x * axes[0, 1]
    return np.column_stack(along) / _determinant(axes)


def _products(numbers: np.ndarray, plan: np.ndarray) -> np.ndarray:
    """The sums that _fitted_axes takes, of numbers of nodes and places, both about their means."""
    i, j = numbers.T
    squares = (i * i).sum(), (i * j).sum(), (j * j).sum()
    return np.array([*squares, *(i[:, None] * plan).sum(axis=0), *(j[:, None] * plan).sum(axis=0)])


def _fitted_axes(ii: float, ij: float, jj: float, *products: np.ndarray) -> np.ndarray:
    """The axes that lead best (least squares) from numbers of nodes to places; zeros where the nodes lie in
    one row."""
    size = ii * jj - ij * ij
    if size <= 1e-9 * ii * jj:
        return np.zeros((2, 2))
    by_i, by_j = np.array(products).reshape(2, 2)
    return np.array([jj * by_i - ij * by_j, ii * by_j - ij * by_i]) / size


def _axes(points: np.ndarray) -> np.ndarray:
    """The shortest steps between points, and the shortest across them: [[x, y], [x, y]]."""
    numbers = np.linspace(0, len(points) - 1, min(len(points), _SAMPLE)).astype(np.int64)
    pairs = _steps(points, numbers)
    steps = [step for number in numbers.tolist() if (step := pairs[number]) is not None]
    if not steps:
        raise InputRefused(_ONE_ROW, item="points")
    # The commonest, by the lengths of both: cells with a missing neighbor show longer steps.
    lengths = np.array([[hypot(*a), hypot(*b)] for a, b in steps])
    best = np.lexsort((lengths[:, 0], np.round(lengths.sum(axis=1) / lengths.min(), 6)))[0]
    return np.array(steps[best])


def _steps(points: np.ndarray, numbers: np.ndarray) -> dict[int, tuple[np.ndarray, np.ndarray] | None]:
    """The steps from some points to the nearest one, and to the nearest one across that direction, if there
    is one."""
    start = points[0, :2]
    low, high = points[:, :2].min(axis=0), points[:, :2].max(axis=0)
    size = high - low
    side = max(np.sqrt(_NEAR * size[0] * size[1] / len(points)), _NEAR * size.max() / len(points)) or 1.0
    pairs, waiting = {}, [(number, points[number, :2]) for number in numbers.tolist()]
    while waiting:
        near = _in_cells_around(points, np.array([place for _, place in waiting]), low, side) - start
        unsure = []
        for number, place in waiting:
            pairs[number], reach = _step(near, place - start, side)
            if reach > _SURE * side and side < size.max():
                unsure.append((number, place))  # there may be nearer points elsewhere
        waiting, side = unsure, 4 * side
    return pairs


def _in_cells_around(points: np.ndarray, places: np.ndarray, low: np.ndarray, side: float) -> np.ndarray:
    """The places of points, in their order, in the square cells of some places and in those around them."""

    def cells(plan: np.ndarray) -> np.ndarray:
        return np.floor((plan - low) / side).astype(np.int64) + 1  # from 0, with those around

    around = np.array([[i, j] for i in (-1, 0, 1) for j in (-1, 0, 1)])
    wanted = (cells(places)[:, None, :] + around).reshape(-1, 2)
    rows = int(wanted[:, 1].max()) + 2  # more than there are, so that each cell has a number of its own
    wanted = np.unique(wanted[:, 0] * rows + wanted[:, 1])
    parts = []
    for piece in in_pieces(points):
        plan = piece[:, :2]
        column, row = cells(plan).T
        parts.append(plan[np.isin(column * rows + np.minimum(row, rows - 1), wanted)])
    return np.concatenate(parts)


def _step(
    plan: np.ndarray, place: np.ndarray, within: float
) -> tuple[tuple[np.ndarray, np.ndarray] | None, float]:
    """The steps from a position to the nearest of others, and to the nearest across, if there is one; and the
    distance. within: others that are farther in x or y do not count."""
    d = plan[np.abs(plan[:, 0] - place[0]) <= within] - place
    d = d[np.abs(d[:, 1]) <= within]
    squared = np.square(d).sum(axis=1)
    squared[squared == 0] = np.inf
    first = d[squared.argmin()].copy()  # a view would keep all
    # Not along the first: more than 30 degrees off it.
    cross = d[:, 0] * first[1] - d[:, 1] * first[0]
    across = cross**2 > 0.25 * np.where(np.isinf(squared), 1.0, squared) * np.square(first).sum()
    if not across.any():
        return None, np.inf
    away = np.where(across, squared, np.inf)
    return (first, d[away.argmin()].copy()), float(np.sqrt(away.min()))
