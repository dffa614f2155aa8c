# SPDX-License-Identifier: GPL-3.0-or-later
"""The blocks along a vertical borehole in a finished model."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..base.algebra import ranks_in_runs
from ..cells.model_data import ModelData

_WALL = -1  # face_surface


@dataclass(frozen=True)
class Interval:
    """A stretch of a borehole in one block (its number), from the height `top` down to `bottom`, model
    units."""

    block: int
    top: float
    bottom: float

    @property
    def length(self) -> float:
        """Between top and bottom, model units."""
        return self.top - self.bottom


def borehole(model: ModelData, x: float, y: float) -> list[Interval]:
    """The blocks along the vertical line at the position (x, y) in plan, from above downward; nothing where
    there is no rock. On the border of two faces one of them counts.

    >>> for interval in model.borehole(3.5, 1.0):
    ...     print(model.blocks[interval.block].name, interval.top, interval.bottom)
    soil 4.5 3.0
    sand 3.0 2.0
    clay 2.0 0.0
    """
    faces = _faces_at(model, x, y)
    height, is_up = _heights(model, faces, x, y)
    cells = model.face_cells[faces]
    cells[~is_up] = cells[~is_up, ::-1]
    below, above = np.append(model.cell_block, np.int32(-1))[cells].T  # the first cell is below
    intervals: list[Interval] = []
    for k in np.lexsort((above, -height)).tolist():
        z = float(height[k])
        if intervals and intervals[-1].bottom == -np.inf:
            intervals[-1] = Interval(intervals[-1].block, intervals[-1].top, z)
        if below[k] >= 0:
            intervals.append(Interval(int(below[k]), z, -np.inf))
    return _merged(intervals)


def _merged(intervals: list[Interval]) -> list[Interval]:
    """Without stretches of no length, and with those of one block that follow one another as one."""
    merged: list[Interval] = []
    for interval in intervals:
        if not interval.top > interval.bottom:
            continue
        if merged and merged[-1].block == interval.block and merged[-1].bottom == interval.top:
            merged[-1] = Interval(interval.block, merged[-1].top, interval.bottom)
        else:
            merged.append(interval)
    return merged


def _faces_at(model: ModelData, x: float, y: float) -> np.ndarray:
    """The faces over and under a position that are no walls: a ray to the right leaves them."""
    west, south, east, north = model.plan_boxes
    near = np.flatnonzero((west <= x) & (x <= east) & (south <= y) & (y <= north))
    near = near[model.face_surface[near] != _WALL]
    corners, following, size = _outlines(model, near)
    at_edge = np.flatnonzero((corners[:, 1] <= y) != (corners[following, 1] <= y))
    low, high = corners[at_edge, :2], corners[following[at_edge], :2]
    turned = low[:, 1] > high[:, 1]  # both faces at an edge see it the same way
    low[turned], high[turned] = high[turned], low[turned].copy()
    share = (y - low[:, 1]) / (high[:, 1] - low[:, 1])
    right = at_edge[low[:, 0] + share * (high[:, 0] - low[:, 0]) > x]
    times = np.bincount(np.repeat(np.arange(len(near)), size)[right], minlength=len(near))
    return near[times % 2 == 1]


def _outlines(model: ModelData, faces: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The corners of faces (K, 3), one face after another, which of them follows each, and how many each face
    has."""
    begin, size = model.face_offsets[faces], np.diff(model.face_offsets)[faces]
    step, here = ranks_in_runs(size), np.arange(size.sum())
    following = np.where(step + 1 == np.repeat(size, size), here - step, here + 1)
    return model.vertices[model.face_vertices[np.repeat(begin, size) + step]], following, size


def _heights(model: ModelData, faces: np.ndarray, x: float, y: float) -> tuple[np.ndarray, np.ndarray]:
    """The heights of faces at a position, and whether each faces up out of its first cell."""
    here, following, size = _outlines(model, faces)
    origin = here[np.cumsum(size) - size]
    here = here - np.repeat(origin, size, axis=0)
    doubled = np.cross(here, here[following]) if len(here) else np.empty((0, 3))
    normal = np.add.reduceat(doubled, np.cumsum(size) - size, axis=0) if len(faces) else np.empty((0, 3))
    slope = normal[:, 0] * (x - origin[:, 0]) + normal[:, 1] * (y - origin[:, 1])
    return origin[:, 2] - slope / normal[:, 2], normal[:, 2] > 0
