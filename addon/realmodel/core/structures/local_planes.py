# SPDX-License-Identifier: GPL-3.0-or-later
"""Planes through the points that are nearest to a place."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

_COUNTED = 8  # nearest points, through which a plane is laid
_SHARE = 1e-3  # of the points' spread, added so that points on a line give no slope across it
_CELL = 2.0  # spacings: the width of a cell of the grid in which near points are looked for


class Planes(NamedTuple):
    """height: (N,) of planes at N places; slope: (N, 2) along x and y; misfit: (N,) root mean square of the
    distances of their points from them."""

    height: np.ndarray
    slope: np.ndarray
    misfit: np.ndarray


def mean_spacing(plan: np.ndarray) -> float:
    """The mean spacing of points (P, 2) in plan; of points on a line that along it."""
    extent = np.ptp(plan, axis=0)
    return max(float(np.sqrt(extent[0] * extent[1] / len(plan))), float(extent.max()) / len(plan))


def planes_at(places: np.ndarray, points: np.ndarray) -> Planes:
    """The planes through those of points (P, 3), one at least, that are nearest in plan to places (N, 2):
    least squares of heights, nearer points counting more. The order of the points does not count."""
    points = points[np.lexsort(points.T)]
    near = _nearest(places, points[:, :2])
    own = points[near]
    away = own - np.column_stack([places, np.zeros(len(places))])[:, None]
    distance = (away[:, :, :2] ** 2).sum(axis=2)
    scale = mean_spacing(points[:, :2]) ** 2
    weight = np.where(near >= 0, 1.0 / (distance + (scale if scale > 0 else 1.0)), 0.0)
    weight /= weight.sum(axis=1)[:, None]
    middle = (weight[:, :, None] * away).sum(axis=1)
    x, y, z = np.moveaxis(away - middle[:, None], 2, 0)
    xx, yy, xy, xz, yz = (
        (weight * one * other).sum(axis=1) for one, other in ((x, x), (y, y), (x, y), (x, z), (y, z))
    )
    extra = _SHARE * (xx + yy)
    xx, yy = xx + extra, yy + extra
    determinant = xx * yy - xy * xy
    is_plane = determinant > 0  # not one point, nor all at one place
    determinant = np.where(is_plane, determinant, 1.0)
    slope = np.stack([yy * xz - xy * yz, xx * yz - xy * xz], axis=1) / determinant[:, None]
    slope[~is_plane] = 0.0
    off = z - slope[:, :1] * x - slope[:, 1:] * y
    misfit = np.sqrt((weight * off * off).sum(axis=1))
    return Planes(middle[:, 2] - (slope * middle[:, :2]).sum(axis=1), slope, misfit)


def _nearest(places: np.ndarray, plan: np.ndarray) -> np.ndarray:
    """(N, 8) of points (P, 2) the nearest to each place (N, 2), in a grid of cells; the first of equally near
    ones, and -1 where there are fewer."""
    low, width = plan.min(axis=0), _CELL * mean_spacing(plan)
    width = width if width > 0 else 1.0
    columns, rows = (np.floor(np.ptp(plan, axis=0) / width).astype(np.int64) + 1).tolist()
    cell = np.floor((plan - low) / width).astype(np.int64)
    key = cell[:, 1] * columns + cell[:, 0]
    order = np.argsort(key, kind="stable")
    key = key[order]
    at = np.clip(np.floor((places - low) / width), -1, [columns, rows]).astype(np.int64)
    found = np.full((len(places), _COUNTED), -1)
    left, reach = np.arange(len(places)), 1
    while len(left):
        own, point = _in_cells(at[left], reach, key, columns, rows)
        own, point = left[own], order[point]
        away = ((plan[point] - places[own]) ** 2).sum(axis=1)
        best = np.lexsort((point, away, own))
        own, point, away = own[best], point[best], away[best]
        rank = np.arange(len(own)) - np.searchsorted(own, own)
        kept = rank < _COUNTED
        found[own[kept], rank[kept]] = point[kept]
        last = np.full(len(places), np.inf)
        last[own[rank == _COUNTED - 1]] = away[rank == _COUNTED - 1]
        if reach > columns + rows:
            break
        left = left[last[left] > (reach * width) ** 2]  # others may be nearer
        reach *= 2
    return found


def _in_cells(at: np.ndarray, reach: int, key: np.ndarray, columns: int, rows: int):
    """Pairs of a place, given by its cells (N, 2), and a point in the cells so many around it: their numbers
    (K,). key: (P,) the cells of points, ascending, row by row."""
    row = at[:, 1, None] + np.arange(-reach, reach + 1)
    first = np.clip(at[:, 0] - reach, 0, columns)[:, None]
    last = np.clip(at[:, 0] + reach, -1, columns - 1)[:, None]
    begin = np.searchsorted(key, row * columns + first, "left")
    end = np.searchsorted(key, row * columns + last, "right")
    count = np.where((row >= 0) & (row < rows) & (last >= first), end - begin, 0).ravel()
    place = np.repeat(np.arange(count.size), count)
    first_of_all = np.cumsum(count) - count
    point = np.arange(count.sum()) - first_of_all[place] + begin.ravel()[place]
    return place // row.shape[1], point
