# SPDX-License-Identifier: GPL-3.0-or-later
"""Points that are the nodes of a regular grid, turned in plan or not, and bilinear heights between them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..errors import InputRefused, place_text
from .from_neighbours import nearest_heights
from .interpolation import Result, Task

# Of a cell: how far a point may lie from its place in the grid (coordinates are written with few digits).
_OFF_GRID = 0.02
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
        return np.linalg.solve(self.axes.T, (plan - self.origin).T).T


def bilinear(task: Task) -> Result:
    """Bilinear between the four nodes of a cell (a product of linear functions). Outside the grid, and in
    cells that lack a node: the heights of its border straight on, or of the nearest point."""
    grid = find_grid(task.points)
    at = grid.places(task.nodes)
    last = np.array(grid.z.shape) - 1
    outside = ((at < -_OFF_GRID) | (at > last + _OFF_GRID)).any(axis=1)
    at = np.clip(at, 0, last)
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
    numbers = np.rint(np.linalg.solve(axes.T, (plan - start).T).T)
    for _ in range(3):  # the axes are known by one cell at first; the whole grid makes them sharper
        terms = np.column_stack([np.ones(len(plan)), numbers - numbers.mean(axis=0)])
        fitted, *_ = np.linalg.lstsq(terms, plan - start, rcond=None)
        axes = fitted[1:]
        if abs(np.linalg.det(axes)) < 1e-9 * np.square(axes).sum():
            raise InputRefused("the points lie in one row; a grid needs two", item="points")
        origin = start + fitted[0] - numbers.mean(axis=0) @ axes
        at = np.linalg.solve(axes.T, (plan - origin).T).T
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
    return RegularGrid(origin + least @ axes, axes, z)


def _axes(plan: np.ndarray) -> np.ndarray:
    """The shortest steps between points, and the shortest across them: [[x, y], [x, y]]."""
    steps = []
    for k in np.linspace(0, len(plan) - 1, min(len(plan), _SAMPLE)).astype(np.int64):
        d = plan - plan[k]
        squared = np.einsum("ij,ij->i", d, d)
        squared[squared == 0] = np.inf
        first = d[squared.argmin()]
        # Not along the first: more than 30 degrees off it.
        cross = d[:, 0] * first[1] - d[:, 1] * first[0]
        across = cross**2 > 0.25 * np.where(np.isinf(squared), 1.0, squared) * (first @ first)
        if not across.any():
            continue
        second = d[np.where(across, squared, np.inf).argmin()]
        steps.append((first, second))
    if not steps:
        raise InputRefused("the points lie in one row; a grid needs two", item="points")
    # The commonest, by the lengths of both: cells with a missing neighbour show longer steps.
    lengths = np.array([[np.hypot(*a), np.hypot(*b)] for a, b in steps])
    best = np.lexsort((lengths[:, 0], np.round(lengths.sum(axis=1) / lengths.min(), 6)))[0]
    return np.array(steps[best])
