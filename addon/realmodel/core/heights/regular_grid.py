# SPDX-License-Identifier: GPL-3.0-or-later
"""Points that are the nodes of a regular grid, turned in plan or not, and bilinear heights between them.

Calculated without NumPy's linear algebra, which gives other last digits on other processors.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..elementary import hypot
from ..errors import InputRefused, place_text
from .from_neighbours import nearest_heights
from .interpolation import Result, Task

# Of a cell: how far a point may lie from its place in the grid (coordinates are written with few digits).
_OFF_GRID = 0.02
_ON_LINE = 1e-9  # of a cell: what is so near a line of the grid lies on it, but for rounding
_SAMPLE = 200  # points whose neighbours show the grid's directions
_MOST_EMPTY = 100  # nodes of the grid for each point


@dataclass(frozen=True)
class RegularGrid:
    """Node (i, j) lies at origin + i * axes[0] + j * axes[1]; z (I, J), NaN where the grid has no point."""

    origin: np.ndarray
    axes: np.ndarray
    z: np.ndarray

    def places(self, plan: np.ndarray) -> np.ndarray:
        """(N, 2) places in numbers of cells."""
        return _in_cells(plan - self.origin, self.axes)


def bilinear(task: Task) -> Result:
    """Bilinear between the four nodes of a cell (a product of linear functions). Outside the grid, and in
    cells that lack a node: the heights of its border straight on, or of the nearest point."""
    grid = find_grid(task.points)
    at = grid.places(task.nodes)
    last = np.array(grid.z.shape) - 1
    outside = ((at < -_OFF_GRID) | (at > last + _OFF_GRID)).any(axis=1)
    at = np.clip(np.where(np.abs(at - np.rint(at)) < _ON_LINE, np.rint(at), at), 0, last)
    i, j = np.minimum(at.astype(np.int64), last - 1).T
    u, v = at[:, 0] - i, at[:, 1] - j
    z = np.zeros(len(at))
    for di, dj, weight in (
        (0, 0, (1 - u) * (1 - v)),
        (1, 0, u * (1 - v)),
        (0, 1, (1 - u) * v),
        (1, 1, u * v),
    ):
        corner = grid.z[i + di, j + dj]
        z += np.where(weight == 0, 0.0, weight * corner)  # a corner that is not needed may be missing
    missing = np.isnan(z)
    if missing.any():
        z[missing] = nearest_heights(task, np.ascontiguousarray(task.nodes[missing]))
    return Result(z, outside=outside | missing)


def find_grid(points: np.ndarray) -> RegularGrid:
    """The grid whose nodes the points (P, 3) are. Raises InputRefused, naming a point that is off it."""
    if len(points) < 4:
        raise InputRefused("a grid needs at least four points", item="points")
    plan = points[:, :2]
    start = plan[0]
    axes = _axes(plan - start)
    numbers = np.rint(_in_cells(plan - start, axes))
    for _ in range(3):  # the axes are known by one cell at first; the whole grid makes them sharper
        mean, middle = numbers.mean(axis=0), (plan - start).mean(axis=0)
        axes = _fitted_axes(numbers - mean, plan - start - middle)
        if abs(_determinant(axes)) <= 1e-9 * np.square(axes).sum():
            raise InputRefused("the points lie in one row; a grid needs two", item="points")
        origin = start + middle - mean[0] * axes[0] - mean[1] * axes[1]
        at = _in_cells(plan - origin, axes)
        numbers = np.rint(at)
    off = np.abs(at - numbers).max(axis=1)
    if off.max() > _OFF_GRID:
        worst = int(off.argmax())
        raise InputRefused(
            f"the points are not a regular grid: {place_text(points[worst])} is {off[worst]:.2g} cells off",
            item="points",
            place=tuple(points[worst]),
            advice='use method = "tin" or "kriging" for scattered points',
        )
    least = numbers.min(axis=0)
    numbers = (numbers - least).astype(np.int64)
    shape = numbers.max(axis=0) + 1
    if shape.min() < 2:
        raise InputRefused("the points lie in one row; a grid needs two", item="points")
    if shape[0] * shape[1] > _MOST_EMPTY * len(points):
        raise InputRefused(
            f"{len(points)} points would make a grid of {shape[0]} x {shape[1]} nodes, nearly all empty",
            item="points",
        )
    z = np.full(shape, np.nan)
    z[tuple(numbers.T)] = points[:, 2]
    told = z[tuple(numbers.T)] == points[:, 2]
    if not told.all():
        bad = points[np.flatnonzero(~told)[0]]
        raise InputRefused(
            f"two points with different heights lie at one node of the grid, {place_text(bad)}",
            item="points",
            place=tuple(bad),
        )
    return RegularGrid(origin + least[0] * axes[0] + least[1] * axes[1], axes, z)


def _determinant(axes: np.ndarray) -> float:
    return axes[0, 0] * axes[1, 1] - axes[0, 1] * axes[1, 0]


def _in_cells(plan: np.ndarray, axes: np.ndarray) -> np.ndarray:
    """(N, 2): how many times each of the axes leads to places."""
    x, y = plan.T
    along = x * axes[1, 1] - y * axes[1, 0], y * axes[0, 0] - x * axes[0, 1]
    return np.column_stack(along) / _determinant(axes)


def _fitted_axes(numbers: np.ndarray, plan: np.ndarray) -> np.ndarray:
    """The axes that lead best (least squares) from numbers of nodes to places, both about their means; zeros
    where the nodes lie in one row."""
    i, j = numbers.T
    ii, ij, jj = (i * i).sum(), (i * j).sum(), (j * j).sum()
    size = ii * jj - ij * ij
    if size <= 1e-9 * ii * jj:
        return np.zeros((2, 2))
    by_i, by_j = (i[:, None] * plan).sum(axis=0), (j[:, None] * plan).sum(axis=0)
    return np.array([jj * by_i - ij * by_j, ii * by_j - ij * by_i]) / size


def _axes(plan: np.ndarray) -> np.ndarray:
    """The shortest steps between points, and the shortest across them: [[x, y], [x, y]]."""
    steps = []
    for k in np.linspace(0, len(plan) - 1, min(len(plan), _SAMPLE)).astype(np.int64):
        d = plan - plan[k]
        squared = np.square(d).sum(axis=1)
        squared[squared == 0] = np.inf
        first = d[squared.argmin()]
        # Not along the first: more than 30 degrees off it.
        cross = d[:, 0] * first[1] - d[:, 1] * first[0]
        across = cross**2 > 0.25 * np.where(np.isinf(squared), 1.0, squared) * np.square(first).sum()
        if not across.any():
            continue
        second = d[np.where(across, squared, np.inf).argmin()]
        steps.append((first, second))
    if not steps:
        raise InputRefused("the points lie in one row; a grid needs two", item="points")
    # The commonest, by the lengths of both: cells with a missing neighbour show longer steps.
    lengths = np.array([[hypot(*a), hypot(*b)] for a, b in steps])
    best = np.lexsort((lengths[:, 0], np.round(lengths.sum(axis=1) / lengths.min(), 6)))[0]
    return np.array(steps[best])
