# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the vertices on the border of a tile are: decided alike in all tiles that share them.

Points that differ can round to the same doubles, and then one of them moves to the next ones. On a border
each tile may have points that its neighbors have not. So what moves there follows from the exact points that
all of them have together, and from nothing else.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from fractions import Fraction
from itertools import groupby
from math import inf, nextafter

import numpy as np

from ..base.algebra import begins_run
from .borders import Side, sides_of
from .grid import Box

_Exact = tuple[str, str, str]


@dataclass(frozen=True)
class BorderVertices:
    """The vertices of a tile on its border: their numbers (N,), ascending; the doubles nearest to where they
    are, (N, 3); and the exact x, y and z in a line: fractions in hexadecimal, equal where points are, in all
    tiles. Of a tile those on the border of another are enough, by their places among the N."""

    numbers: np.ndarray
    nearest: np.ndarray
    exact: dict[int, bytes]

    @staticmethod
    def arrays_of(built: dict) -> dict[str, np.ndarray]:
        """What the native build_tile gives, as arrays: `exact` is text, a line for each vertex."""
        return {
            "numbers": built["border_vertices"],
            "nearest": built["border_nearest"],
            "exact": np.frombuffer(built["border_exact"], np.uint8),
        }

    @classmethod
    def of_arrays(cls, arrays: dict[str, np.ndarray], box: Box) -> BorderVertices:
        """Only what is on the border of a box has its exact place."""
        nearest, lines = arrays["nearest"], arrays["exact"].tobytes().splitlines()
        needed = np.zeros(len(nearest), bool)
        for side in sides_of(box):
            needed |= _is_near(nearest, side, box)
        exact = {place: lines[place] for place in np.flatnonzero(needed).tolist()}
        return cls(arrays["numbers"], nearest, exact)


def settled(box: Box, tiles: Iterable[BorderVertices]) -> list[np.ndarray]:
    """Where vertices are that lie on the border of a tile. tiles: those of the tile, and of all that share
    its sides or corners. Returns (N, 3) float64 for each, NaN where a neighbor's is not on this border."""
    tiles = list(tiles)
    if _are_apart(box, tiles):
        return [_rounded(box, vertices) for vertices in tiles]
    exact_places = [{number: _words(line) for number, line in vertices.exact.items()} for vertices in tiles]
    heights: dict[tuple[str, str], dict[str, float]] = {}
    on_sides = []
    for side in sides_of(box):
        axis = side.along
        along = {_text(end): end for end in (box[axis], box[axis + 2])}
        on_side = [_on_side(*pair, side, box) for pair in zip(tiles, exact_places, strict=True)]
        for vertices, places, numbers in zip(tiles, exact_places, on_side, strict=True):
            for number in numbers:
                x, y, z = exact = places[number]
                heights.setdefault((x, y), {})[z] = float(vertices.nearest[number, 2])
                along[exact[axis]] = float(vertices.nearest[number, axis])
        _separate(along)
        on_sides.append((side, along, on_side))
    for of_vertical in heights.values():
        _separate(of_vertical)
    positions = [np.full(vertices.nearest.shape, np.nan) for vertices in tiles]
    for side, along, on_side in on_sides:
        axis = side.along
        for places, numbers, at in zip(exact_places, on_side, positions, strict=True):
            for number in numbers:
                exact = places[number]
                at[number, side.axis] = side.line
                at[number, axis] = along[exact[axis]]
                at[number, 2] = heights[exact[:2]][exact[2]]
    return positions


def _are_apart(box: Box, tiles: list[BorderVertices]) -> bool:
    """Whether no two different points round to the same doubles, nor to a corner of the box what is beside
    it. As a vertex is exactly on a line of its tile, all that round to the border are then exactly there."""
    lines = [line for vertices in tiles for line in vertices.exact.values()]
    nearest = np.concatenate([vertices.nearest[list(vertices.exact)] for vertices in tiles])
    points = set(lines)
    corners = [(x, y) for x in (box[0], box[2]) for y in (box[1], box[3])]
    plan = {line[: line.rindex(b" ")] for line in points}
    plan.update(f"{_text(x)} {_text(y)}".encode() for x, y in corners)
    return len(points) == _distinct(nearest) and len(plan) == _distinct(
        np.concatenate([nearest[:, :2], corners])
    )


def _distinct(rows: np.ndarray) -> int:
    """How many different rows (N, C) there are."""
    rows = rows[np.lexsort(rows.T)]
    return int(begins_run(rows).sum())


def _rounded(box: Box, vertices: BorderVertices) -> np.ndarray:
    """(N, 3): the nearest doubles of those on the border of a box, NaN elsewhere."""
    at = np.full(vertices.nearest.shape, np.nan)
    for side in sides_of(box):
        near = _is_near(vertices.nearest, side, box)
        at[near] = vertices.nearest[near]
        at[near, side.axis] = side.line
    return at


def _on_side(vertices: BorderVertices, places: dict[int, _Exact], side: Side, box: Box) -> list[int]:
    """Which vertices are exactly on a side of a box, its ends included."""
    low, high = box[side.along], box[side.along + 2]
    near = vertices.nearest[:, side.along]
    line = _text(side.line)

    def is_there(number: int) -> bool:
        exact = places[number]
        if exact[side.axis] != line:
            return False
        return near[number] not in (low, high) or low <= _fraction(exact[side.along]) <= high

    possible = np.flatnonzero(_is_near(vertices.nearest, side, box)).tolist()
    return [number for number in possible if is_there(number)]


def _is_near(nearest: np.ndarray, side: Side, box: Box) -> np.ndarray:
    """(N,) bool: which places are on a side of a box, its ends included, when they are rounded."""
    low, high = box[side.along], box[side.along + 2]
    along = nearest[:, side.along]
    return (nearest[:, side.axis] == side.line) & (along >= low) & (along <= high)


def _separate(values: dict[str, float]) -> None:
    """Makes the doubles of exact values distinct, in their order, by as little as possible. What is a double
    itself stays as long as there is room."""
    if len(set(values.values())) == len(values):
        return
    order = []
    for _, equal in groupby(sorted(values, key=values.__getitem__), values.__getitem__):
        order += sorted(equal, key=_fraction)
    at = [values[exact] for exact in order]

    def is_double(number: int) -> bool:
        return _fraction(order[number]) == values[order[number]]

    for number in range(1, len(at)):
        low = number
        if at[number] <= at[number - 1] and is_double(number):
            while low > 0 and at[low - 1] >= at[low] and not is_double(low - 1):
                at[low - 1] = nextafter(at[low], -inf)
                low -= 1
        while 0 < low <= number and at[low] <= at[low - 1]:
            at[low] = nextafter(at[low - 1], inf)
            low += 1
    values.update(zip(order, at, strict=True))


def _words(line: bytes) -> _Exact:
    x, y, z = line.decode().split()
    return x, y, z


def _text(value: float) -> str:
    """A double as exact coordinates are written."""
    numerator, denominator = value.as_integer_ratio()
    return f"{numerator:x}" if denominator == 1 else f"{numerator:x}/{denominator:x}"


def _fraction(exact: str) -> Fraction:
    numerator, _, denominator = exact.partition("/")
    return Fraction(int(numerator, 16), int(denominator or "1", 16))
