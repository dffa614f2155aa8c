# SPDX-License-Identifier: GPL-3.0-or-later
"""The lines that divide the plan into tiles, and what of a rock mass each tile needs."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from ..base.algebra import ranks_in_runs
from ..base.errors import UsageError
from ..base.mapped_arrays import in_pieces
from ..base.triangles import Sheet

_SEARCHED = 1 / 16  # of a tile's side: how far a line may be from where it was requested
_IN_GAP = 0.3819660112501051  # the golden section: far from all simple fractions
_BEYOND = 1 / 64  # of the model's extent: how far the outermost tiles reach beyond it
_MOST_TILES = 100_000
_TRIANGLES_AT_ONCE = 1 << 17

Box = tuple[float, float, float, float]  # low x, low y, high x, high y


@dataclass(frozen=True)
class TileGrid:
    """x: (C + 1,) float64 ascending, y: (R + 1,): tile (column, row) lies between lines column and
    column + 1, and row and row + 1. No vertex lies on a line."""

    x: np.ndarray
    y: np.ndarray

    @property
    def columns(self) -> int:
        return len(self.x) - 1

    @property
    def rows(self) -> int:
        return len(self.y) - 1

    def __iter__(self) -> Iterator[tuple[int, int]]:
        return ((column, row) for row in range(self.rows) for column in range(self.columns))

    @property
    def whole(self) -> Box:
        """The box of all tiles."""
        return float(self.x[0]), float(self.y[0]), float(self.x[-1]), float(self.y[-1])

    def box(self, column: int, row: int) -> Box:
        """Low x, low y, high x, high y."""
        x, y = self.x, self.y
        return float(x[column]), float(y[row]), float(x[column + 1]), float(y[row + 1])

    def tiles_meeting(self, box: Box) -> Iterator[tuple[int, int]]:
        """The tiles that a box meets; what lies beyond the outermost lines counts to the outermost tiles."""
        columns, rows = (
            range(int(_strip(lines, box[axis], "left")), int(_strip(lines, box[axis + 2], "right")) + 1)
            for axis, lines in enumerate((self.x, self.y))
        )
        return ((column, row) for row in rows for column in columns)


def _strip(lines: np.ndarray, places: float | np.ndarray, side: Literal["left", "right"]) -> np.ndarray:
    """The columns or rows that coordinates lie in; on a line that on this side of it."""
    return (np.searchsorted(lines, places, side) - 1).clip(0, len(lines) - 2)


def checked_size(tile_size: Any) -> tuple[float, float]:
    """Width and height of tiles. Raises UsageError."""
    try:
        width, height = (float(side) for side in tile_size)
    except (TypeError, ValueError) as error:
        raise UsageError(f"tile_size must be two lengths above 0, not {tile_size!r}") from error
    if not (0 < width < math.inf and 0 < height < math.inf):
        raise UsageError(f"tile_size must be two lengths above 0, not {tile_size!r}")
    return width, height


def tile_grid(meshes: Sequence[np.ndarray], tile_size: tuple[float, float]) -> TileGrid:
    """A grid over all meshes' vertices, (V, 2) or (V, 3) each, with lines off all of them.

    A line stands in the widest gap between vertices near where it was requested. Raises UsageError where
    there are too many tiles.
    """
    lines = []
    for axis, size in enumerate(tile_size):
        values = [mesh[:, axis] for mesh in meshes if len(mesh)]
        if not values:
            lines.append(np.array([0.0, size]))
            continue
        low, high = min(positions.min() for positions in values), max(positions.max() for positions in values)
        count = max(1, math.ceil((high - low) / size * (1 - 1e-9)))
        if count > _MOST_TILES:
            raise UsageError(f"{count} tiles along one axis are too many; make them larger")
        beyond = max((high - low) * _BEYOND, abs(low) * 2.0**-20, abs(high) * 2.0**-20, 2.0**-20)
        near = [_near_lines(positions, low, size) for positions in values] if count > 1 else []
        inner = [_line_near(near, low + k * size, size * _SEARCHED) for k in range(1, count)]
        lines.append(np.array([low - beyond, *inner, high + beyond]))
    if len(lines[0]) * len(lines[1]) > _MOST_TILES:
        raise UsageError(f"more than {_MOST_TILES} tiles are too many; make them larger")
    return TileGrid(*lines)


def _near_lines(values: np.ndarray, low: float, size: float) -> np.ndarray:
    """The values that may be near any line."""
    pieces = [np.empty(0)]
    for piece in in_pieces(values):
        pieces.append(piece[np.abs((piece - low) / size % 1 - 0.5) > 0.5 - 1.01 * _SEARCHED])
    return np.concatenate(pieces)


def _line_near(values: list[np.ndarray], wanted: float, reach: float) -> float:
    """In the widest gap between values within `reach` of a position. Not in its middle: there edges of
    regular meshes would cross each other on the line."""
    near = [positions[(positions > wanted - reach) & (positions < wanted + reach)] for positions in values]
    ends = np.unique(np.concatenate([[wanted - reach, wanted + reach], *near]))
    widest = int(np.diff(ends).argmax())
    return float(ends[widest] + (ends[widest + 1] - ends[widest]) * _IN_GAP)


def triangles_by_tile(mesh: Sheet, grid: TileGrid) -> Iterator[tuple[tuple[int, int], np.ndarray]]:
    """Piece by piece the numbers, ascending, of the triangles whose boxes meet a tile."""
    vertices, triangles = map(np.asarray, mesh)  # a memmap would be slower
    for begin in range(0, len(triangles), _TRIANGLES_AT_ONCE):
        corners = triangles[begin : begin + _TRIANGLES_AT_ONCE]
        first, count = [], []
        for axis, lines in enumerate((grid.x, grid.y)):
            a, b, c = (vertices[:, axis][corner] for corner in corners.T)
            low = _strip(lines, np.minimum(np.minimum(a, b), c), "left")
            high = _strip(lines, np.maximum(np.maximum(a, b), c), "right")
            first.append(low)
            count.append(high - low + 1)
        tiles = count[0] * count[1]
        numbers, (column, row) = np.arange(len(corners)), first
        if int(tiles.sum()) > len(corners):
            numbers = np.repeat(numbers, tiles)
            column, row = column[numbers], row[numbers]
            nth = ranks_in_runs(tiles)
            column, row = column + nth // count[1][numbers], row + nth % count[1][numbers]
        for tile, which in _grouped(column, row, grid):
            yield tile, (numbers[which] + begin).astype(np.int32)


def _grouped(
    column: np.ndarray, row: np.ndarray, grid: TileGrid
) -> Iterator[tuple[tuple[int, int], np.ndarray]]:
    """Which of tiles (N,) are the same one, in ascending order."""
    if not len(column):
        return
    number = column * grid.rows + row
    if grid.columns * grid.rows < 1 << 15:
        number = number.astype(np.int16)  # quicker to sort
    order = np.argsort(number, kind="stable")
    number = number[order]
    begins = np.flatnonzero(np.diff(number, prepend=-1))
    for tile, which in zip(number[begins].tolist(), np.split(order, begins[1:]), strict=True):
        yield divmod(tile, grid.rows), which


def clipped_region(region: Sheet, box: Box) -> Sheet:
    """A triangulation ((V, 2), (T, 3)) of what of a region lies in a box; where an edge meets the box is
    rounded, equally for both triangles at it. For questions about positions, not for building."""
    low_x, low_y, high_x, high_y = box
    vertices: dict[tuple[float, float], int] = {}
    triangles = []
    for corners in region.corners.tolist():
        polygon = [tuple(corner) for corner in corners]
        for axis, line, sign in ((0, low_x, 1), (0, high_x, -1), (1, low_y, 1), (1, high_y, -1)):
            polygon = _half(polygon, axis, line, sign)
        numbers = [vertices.setdefault(corner, len(vertices)) for corner in polygon]
        triangles += [(numbers[0], numbers[k], numbers[k + 1]) for k in range(1, len(numbers) - 1)]
    return Sheet(
        np.array(list(vertices), np.float64).reshape(-1, 2),
        np.array(triangles, np.int32).reshape(-1, 3),
    )


def _half(polygon: list, axis: int, line: float, sign: int) -> list:
    """The part of a convex polygon where sign * (coordinate - line) is not negative."""
    corners = []
    for start, end in zip(polygon, polygon[1:] + polygon[:1], strict=True):
        inside, beyond = sign * (start[axis] - line) >= 0, sign * (end[axis] - line) >= 0
        if inside:
            corners.append(start)
        if inside != beyond:
            first, second = sorted((start, end))
            share = (line - first[axis]) / (second[axis] - first[axis])
            other = first[1 - axis] + share * (second[1 - axis] - first[1 - axis])
            corners.append((line, other) if axis == 0 else (other, line))
    return corners


def box_triangles(box: Box) -> Sheet:
    """A box as two triangles."""
    low_x, low_y, high_x, high_y = box
    corners = [[low_x, low_y], [high_x, low_y], [high_x, high_y], [low_x, high_y]]
    return Sheet(np.array(corners), np.array([[0, 1, 2], [0, 2, 3]], np.int32))
