# SPDX-License-Identifier: GPL-3.0-or-later
"""Maps of tops, thickness and uncertainty as areas between levels, from values at the centers of cells."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..cells.model_data import ModelData
from .contours import checked_interval
from .geological_map import net_edges, polygons_of
from .samples import CellSize, PlanGrids, plan_grids

_FLAT = 1e-6  # of the largest value: a range that is no range


@dataclass(frozen=True, eq=False)
class ValueMap:
    """A map of one value. kind: "top", "thickness" or "deviation"; of: the block, or the surface, whose it
    is. areas: (low, high, polygons) of each class, rising; polygons as of MapArea."""

    kind: str
    of: str
    areas: list[tuple[float, float, list[list[np.ndarray]]]]


def value_maps(model: ModelData, cell_size: CellSize = None, interval: float | None = None) -> list[ValueMap]:
    """The maps of a model: the top and the thickness of each block, then the standard deviation of each
    surface where that is known. A cell belongs to the class of the value at its center.

    cell_size: as of plan_grids. interval: of the levels of tops, as of checked_interval. Raises UsageError.
    """
    grids = plan_grids(model, cell_size)
    maps = []
    for number, block in enumerate(model.blocks):
        thickness = grids.thickness[number]
        maps.append(_map("top", block.name, grids.upper[number], grids, interval))
        maps.append(_map("thickness", block.name, np.where(thickness > 0, thickness, np.nan), grids))
    maps += [_map("deviation", name, values, grids) for name, values in grids.deviation]
    return [made for made in maps if made.areas]


def _map(kind: str, of: str, values: np.ndarray, grids: PlanGrids, interval: float | None = None) -> ValueMap:
    known = values[np.isfinite(values)]
    if not len(known):
        return ValueMap(kind, of, [])
    low, high = float(known.min()), float(known.max())
    if high - low <= _FLAT * max(abs(low), abs(high)):
        return ValueMap(kind, of, [(low, high, _polygons(np.isfinite(values), grids))])
    step = checked_interval(interval, low, high)
    level = np.floor(values / step)
    areas = [
        (k * step, (k + 1) * step, _polygons(level == k, grids))
        for k in np.unique(level[np.isfinite(level)]).tolist()
    ]
    return ValueMap(kind, of, areas)


def _polygons(is_in: np.ndarray, grids: PlanGrids) -> list[list[np.ndarray]]:
    """The area of the cells (ny, nx) that are in a class."""
    rows, columns = is_in.shape
    (west, north), (dx, dy) = grids.north_west, grids.size
    row, column = np.divmod(np.arange((rows + 1) * (columns + 1)), columns + 1)
    places = np.column_stack([west + dx * column, north - dy * row])
    row, column = np.nonzero(is_in)
    upper_left = row * (columns + 1) + column
    corners = np.stack(  # counter-clockwise
        [upper_left + columns + 1, upper_left + columns + 2, upper_left + 1, upper_left], axis=1
    )
    start, end, _ = net_edges(corners.ravel(), corners[:, [1, 2, 3, 0]].ravel())
    polygons = polygons_of(places, start, end)
    return [[places[ring[_bends(places[ring])]] for ring in polygon] for polygon in polygons]


def _bends(ring: np.ndarray) -> np.ndarray:
    """The corners of a ring along cells, without those between two of one direction."""
    onward = np.roll(ring, -1, axis=0) - ring
    is_level = onward[:, 1] == 0
    return is_level != np.roll(is_level, 1)
