# SPDX-License-Identifier: GPL-3.0-or-later
"""The boundaries of beds as sheets: triangles in plan between the lines of folds and of faults."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np

from ..base.algebra import dot
from ..project.project import Surface
from .beds import Beds
from .pegs import Pegs

Corner = tuple[float, float]
Sheet = tuple[np.ndarray, np.ndarray]

_GAP, _AT_FAULTS = "Gap {}", "Gap at Faults"  # names of blocks, the first with the number of the bed beneath

_MARGIN = 0.05  # of the box's size: how far sheets reach beyond it
_NEAR = 1e-9  # of the box's size: a corner so near to a line lies on it
_LEFT = 1e-6  # of a gap along a fault
_HALVES = np.array([(0, 1, 2), (0, 2, 3)], np.int32)  # of a box


def sheets_of(beds: Beds, properties: list[int], gap: float, pegs: Pegs) -> list[Surface]:
    """Surfaces whose blocks are the beds, oldest first: the floor, the boundaries, and the top. properties:
    of each bed. gap: between beds, at right angles to their datum's plane; blocks there have no property."""
    surfaces: list[Surface] = []
    bed = 0
    for number, (gap_name, (points, triangles)) in enumerate(_Sheets(beds, gap, pegs).all()):
        surface = Surface(f"Sheet {number}" if number else "Floor", points, triangles)
        surface.property = 0 if gap_name else properties[bed]
        if number:
            bed += not gap_name
            surface.block = gap_name.format(bed) if gap_name else f"Bed {bed}"
        surfaces.append(surface)
    return surfaces


@dataclass(frozen=True, eq=False)
class _Plan:
    """A sheet seen from above. places (N, 2), triangles (T, 3), and of each place: the strip between faults,
    whether it is of what is open between two strips, and whether it is of a peg. Along the borders of these
    the places of both sides are equal, so that sheets part there in exact walls."""

    places: np.ndarray
    strips: np.ndarray
    is_open: np.ndarray
    is_raised: np.ndarray
    triangles: np.ndarray


class _Sheets:
    """The sheets of beds, each with the name of the gap beneath it, empty above a bed."""

    def __init__(self, beds: Beds, gap: float, pegs: Pegs):
        self._beds, self._gap, self._pegs = beds, gap, pegs
        self._box = _box(beds)
        self._margin = _MARGIN * float((beds.high - beds.low).max())
        # Between strips there is a strip without rock: its sheets lie beneath the beds, but for the highest.
        self._is_split = bool(gap and len(beds.fault[1]))

    def all(self) -> Iterator[tuple[str, Sheet]]:
        """The sheets, oldest first."""
        beds, margin = self._beds, self._margin
        is_covered = math.isfinite(beds.floor)
        plan = _plan(beds, self._box, self._squares(None, 0.0))
        datum = beds.datum(plan.places, plan.strips)
        yield "", self._tilted(beds.low[2] - datum.max() - margin)
        for number, above in enumerate(beds.levels.tolist()):
            yield from self._boundary(self._tilted, number, above, beds.slant * self._gap)
        top = beds.high[2] + margin
        if self._is_split or not is_covered:
            yield "", self._tilted(beds.high[2] - datum.min() + margin, is_last=True)
        if self._is_split:
            yield (
                _AT_FAULTS,
                self._level(beds.floor - 0.5 * self._gap if is_covered else 2.0 * top - datum.min()),
            )
        if is_covered:
            lower, *upper = self._boundary(self._level, None, beds.floor, self._gap)
            yield from upper if self._is_split else (lower, *upper)
            for number, level in enumerate(beds.covers.tolist(), len(beds.levels)):
                yield from self._boundary(self._level, number, level, self._gap)
            yield "", self._level(top)

    def _boundary(
        self, sheet: Callable, number: int | None, height: float, gap: float
    ) -> Iterator[tuple[str, Any]]:
        """The sheet between two beds, or the two beside the gap there. number: of the boundary's pegs."""
        if not gap:
            yield "", sheet(height, number)
            return
        yield "", sheet(height - 0.5 * gap, number)
        yield _GAP, sheet(height + 0.5 * gap, number, self._gap)

    def _tilted(
        self, above: float, number: int | None = None, play: float = 0.0, is_last: bool = False
    ) -> Sheet:
        """A sheet parallel to the datum. play: how much wider than pegs their holes are, on each side.
        is_last: it erodes all of what is open along faults. Where lines of pegs end there, corners are
        rounded; sheets with others would leave slivers."""
        gap = self._gap * (1.0 if is_last else 1.0 - _LEFT) if self._is_split else 0.0
        plan = _plan(self._beds, self._box, self._squares(number, play), gap)
        z = self._beds.datum(plan.places, plan.strips) + above + self._rise(number) * plan.is_raised
        z[plan.is_open] = self._beds.low[2] - self._margin
        return np.column_stack([plan.places, z]), plan.triangles

    def _level(self, z: float, number: int | None = None, play: float = 0.0) -> Sheet:
        squares = self._squares(number, play)
        if not len(squares):
            return np.column_stack([np.array(self._box) + self._beds.middle, np.full(4, z)]), _HALVES
        across = self._beds.across
        level = replace(self._beds, wave=np.array([1.0, 0.0, 0.0]), fault=_no_faults(across))
        plan = _plan(level, self._box, squares)
        return np.column_stack([plan.places, z + self._rise(number) * plan.is_raised]), plan.triangles

    def _squares(self, number: int | None, play: float) -> np.ndarray:
        """(P, 2, 2) the lower and the upper end of pegs, or of their holes, along both axes of the folds."""
        if number is None:
            return np.empty((0, 2, 2))
        half = 0.5 * self._pegs.side + play
        return self._pegs.places[number][:, None] + np.array([[-half, -half], [half, half]])

    def _rise(self, number: int | None) -> float:
        return 0.0 if number is None else float(self._pegs.heights[number])


def _box(beds: Beds) -> list[Corner]:
    """The corners of what sheets cover, from the middle of the beds' box."""
    size = beds.high[:2] - beds.low[:2]
    x, y = (0.5 * size + _MARGIN * float(size.max())).tolist()
    return [(-x, -y), (x, -y), (x, y), (-x, y)]


def _plan(beds: Beds, box: list[Corner], squares: np.ndarray, gap: float = 0.0) -> _Plan:
    """The plan of a sheet. squares: as of `_Sheets._squares`. gap: the width of what is open along faults."""
    near = _NEAR * max(box[2])
    along, positions, _ = beds.fault
    fold_along, (distances, heights) = beds.across, beds.fold
    ends = np.sort(squares, axis=0).reshape(-1, 2) if len(squares) else np.empty((0, 2))
    folds = np.sort(np.concatenate([distances if heights.any() else distances[:0], ends[:, 0]]))
    if gap:
        positions = (positions[:, None] + (-0.5 * gap, 0.5 * gap)).ravel()
    places: dict[tuple[int, bool, float, float], int] = {}
    triangles = []
    for strip, part in enumerate(_slices(box, along, positions, near)):
        for column in _slices(part, fold_along, folds, near):
            for polygon in _slices(column, beds.axes[1], np.sort(ends[:, 1]), near):
                raised = bool(polygon) and _is_within(np.mean(polygon, axis=0), beds.axes, squares)
                corners = [places.setdefault((strip, raised, *corner), len(places)) for corner in polygon]
                triangles += [(corners[0], b, c) for b, c in pairwise(corners[1:])]
    rows = np.array(list(places))
    strips = rows[:, 0].astype(np.int64)
    return _Plan(
        rows[:, 2:] + beds.middle,
        strips >> 1 if gap else strips,
        strips & 1 > 0 if gap else np.zeros(len(strips), bool),
        rows[:, 1] > 0,
        np.array(triangles, np.int32),
    )


def _no_faults(across: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    return across, np.empty(0), np.zeros(1)


def _is_within(place: np.ndarray, axes: np.ndarray, squares: np.ndarray) -> bool:
    at = dot(axes, place)
    return bool(((squares[:, 0] < at) & (at < squares[:, 1])).all(axis=1).any())


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
    corners = []
    for k, corner in enumerate(polygon):
        if sides[k] * sign >= 0.0:
            corners.append(corner)
        following = (k + 1) % len(polygon)
        if sides[k] * sides[following] < 0.0:
            corners.append(_crossing((corner, sides[k]), (polygon[following], sides[following])))
    return corners


def _crossing(one: tuple[Corner, float], other: tuple[Corner, float]) -> Corner:
    """Where an edge crosses a line: the same from both sides of the edge, to the last bit."""
    ((ax, ay), a), ((bx, by), b) = sorted((one, other))
    share = a / (a - b)
    return ax + share * (bx - ax), ay + share * (by - ay)
