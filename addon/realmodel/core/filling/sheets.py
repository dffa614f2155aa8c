# SPDX-License-Identifier: GPL-3.0-or-later
"""The boundaries of beds as sheets: triangles in plan between the lines of folds and of faults."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from ..project.project import Surface
from .beds import Beds

Corner = tuple[float, float]

_MARGIN = 0.05  # of the box's size: how far sheets reach beyond it
_NEAR = 1e-9  # of the box's size: a corner so near to a line lies on it
_HALVES = np.array([(0, 1, 2), (0, 2, 3)], np.int32)  # of a box


def sheets_of(beds: Beds, properties: list[int]) -> list[Surface]:
    """Surfaces whose blocks are the beds, oldest first: the floor, the boundaries, and the top. properties:
    of each bed."""
    box = _box(beds)
    plan, strips, triangles = _plan(beds, box)
    datum = beds.datum(plan, strips)
    margin = _MARGIN * float((beds.high - beds.low).max())
    tilted = [beds.low[2] - datum.max() - margin, *beds.levels]
    level = [beds.floor, *beds.covers, beds.high[2] + margin]
    if not math.isfinite(beds.floor):
        tilted, level = [*tilted, beds.high[2] - datum.min() + margin], []
    sheets = [(np.column_stack([plan, datum + above]), triangles) for above in tilted]
    corners = np.array(box) + beds.middle
    sheets += [(np.column_stack([corners, np.full(4, z)]), _HALVES) for z in level]
    found = []
    for number, sheet in enumerate(sheets):
        name = f"Bed {number}" if number else "Floor"
        surface = Surface(name, *sheet, property=properties[max(number - 1, 0)])
        surface.block = name if number else None
        found.append(surface)
    return found


def _box(beds: Beds) -> list[Corner]:
    """The corners of what sheets cover, from the middle of the beds' box."""
    size = beds.high[:2] - beds.low[:2]
    x, y = (0.5 * size + _MARGIN * float(size.max())).tolist()
    return [(-x, -y), (x, -y), (x, y), (-x, y)]


def _plan(beds: Beds, box: list[Corner]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Places in plan (N, 2), the strip between faults that each is of, and triangles (T, 3). Along faults the
    places of both strips are equal, so that sheets part there in exact walls."""
    near = _NEAR * max(box[2])
    along, positions, _ = beds.fault
    fold_along, distances, heights = beds.fold
    folds = distances if heights.any() else distances[:0]
    places: dict[tuple[int, float, float], int] = {}
    triangles = []
    for strip, part in enumerate(_slices(box, along, positions, near)):
        for polygon in _slices(part, fold_along, folds, near):
            corners = [places.setdefault((strip, *corner), len(places)) for corner in polygon]
            triangles += [(corners[0], b, c) for b, c in pairwise(corners[1:])]
    rows = np.array(list(places))
    return rows[:, 1:] + beds.middle, rows[:, 0].astype(np.int64), np.array(triangles, np.int32)


def _slices(
    polygon: list[Corner], along: np.ndarray, distances: np.ndarray, near: float
) -> Iterator[list[Corner]]:
    """The parts of a convex polygon between parallel lines, at these distances along a direction: one more
    than there are lines, without corners where a line does not meet it."""
    for distance in distances.tolist():
        sides = [x * along[0] + y * along[1] - distance for x, y in polygon]
        sides = [0.0 if abs(side) <= near else side for side in sides]
        yield _side(polygon, sides, -1.0)
        polygon = _side(polygon, sides, 1.0)
    yield polygon


def _side(polygon: list[Corner], sides: list[float], sign: float) -> list[Corner]:
    """The part of a convex polygon on one side of a line; none where it only touches it."""
    if all(side * sign <= 0.0 for side in sides):
        return []
    found = []
    for k, corner in enumerate(polygon):
        if sides[k] * sign >= 0.0:
            found.append(corner)
        following = (k + 1) % len(polygon)
        if sides[k] * sides[following] < 0.0:
            found.append(_crossing((corner, sides[k]), (polygon[following], sides[following])))
    return found


def _crossing(one: tuple[Corner, float], other: tuple[Corner, float]) -> Corner:
    """Where an edge crosses a line: the same from both sides of the edge, to the last bit."""
    ((ax, ay), a), ((bx, by), b) = sorted((one, other))
    share = a / (a - b)
    return ax + share * (bx - ax), ay + share * (by - ay)
