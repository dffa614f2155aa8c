# SPDX-License-Identifier: GPL-3.0-or-later
"""The line along the strike of a fault, by which it is unrolled."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...base.algebra import dot, norm, principal_axes
from ..contours import level_lines

_STRAIGHT = 0.05  # of the fault's width in plan: bends of its line that are smaller are not followed


@dataclass(frozen=True, eq=False)
class StrikeLine:
    """points: (N, 2) in plan, the level line of a fault at its middle elevation, with the fault's dip to the
    right; it continues straight at both ends."""

    points: np.ndarray

    @classmethod
    def of(
        cls, vertices: np.ndarray, triangles: np.ndarray, places: np.ndarray, across: np.ndarray
    ) -> StrikeLine:
        """Of a fault's triangles (T, 3). places: (N, 3) of the fault in the model; the line begins beside the
        first of them along it. across: (2,) the direction in which the fault dips on the whole."""
        plan, level = places[:, :2], float((places[:, 2].min() + places[:, 2].max()) / 2)
        lines = level_lines(vertices[triangles], triangles, triangles, level)
        line = max(lines, key=lambda one: norm(np.diff(one, axis=0)).sum(), default=None)
        if line is None:  # level, or beyond what the fault has
            axis = principal_axes(plan)[1][0]
            line = plan.mean(axis=0) + np.outer([-1.0, 1.0], axis)
        chord = line[-1] - line[0]
        if chord[1] * across[0] - chord[0] * across[1] < 0:
            line = line[::-1]
        width = np.abs(_away(line, plan)).max()
        line = _simplified(line, _STRAIGHT * width + 1e-9 * np.abs(line).max())
        whole = cls(line)
        first = float(whole.along(plan).min())
        passed = np.cumsum([0.0, *norm(np.diff(line, axis=0))])
        rest = line[passed > first] if passed[-1] > first else whole.at([first + 1.0])
        return cls(np.concatenate([whole.at([first]), rest]))

    def along(self, plan: np.ndarray) -> np.ndarray:
        """(N,) distances along the line of places (N, 2): between the lines that halve the angles of its
        bends these rise evenly."""
        steps = np.diff(self.points, axis=0)
        lengths = norm(steps)
        ways = steps / lengths[:, None]
        turn = ways[1:, 0] * ways[:-1, 1] - ways[1:, 1] * ways[:-1, 0]
        # how far the line that halves an angle continues for each unit to the left
        lean = turn / np.maximum(1.0 + dot(ways[1:], ways[:-1]), 1e-3)
        begins, ends = np.concatenate([[0.0], -lean]), np.concatenate([lean, [0.0]])
        starts = np.cumsum(lengths) - lengths
        best, nearest = np.zeros(len(plan)), np.full(len(plan), np.inf)
        for k, (point, way) in enumerate(zip(self.points[:-1], ways, strict=True)):
            moved = plan - point
            onward, left = dot(moved, way), dot(moved, np.array([-way[1], way[0]]))
            first, last = begins[k] * left, lengths[k] + ends[k] * left
            share = (onward - first) / np.maximum(last - first, 1e-9 * lengths[k])
            low, high = (-np.inf if k == 0 else 0.0), (np.inf if k == len(ways) - 1 else 1.0)
            beyond = np.maximum(np.maximum(low - share, share - high), 0.0) * lengths[k]
            away = np.abs(left) + beyond
            value = starts[k] + lengths[k] * np.clip(share, low, high)
            value = np.where(share < 0, starts[k] + onward - first, value) if k == 0 else value
            if k == len(ways) - 1:
                value = np.where(share > 1, starts[k] + lengths[k] + onward - last, value)
            best, nearest = np.where(away < nearest, value, best), np.minimum(nearest, away)
        return best

    def at(self, distances: np.ndarray | list[float]) -> np.ndarray:
        """(N, 2) the places on the line at distances (N,)."""
        steps = np.diff(self.points, axis=0)
        lengths = norm(steps)
        starts, values = np.cumsum(lengths) - lengths, np.asarray(distances, np.float64)
        k = np.clip(np.searchsorted(starts, values, side="right") - 1, 0, len(steps) - 1)
        return self.points[k] + ((values - starts[k]) / lengths[k])[:, None] * steps[k]


def _away(line: np.ndarray, plan: np.ndarray) -> np.ndarray:
    """(N,) distances of places from a line."""
    best = np.full(len(plan), np.inf)
    for begin, step in zip(line[:-1], np.diff(line, axis=0), strict=True):
        share = np.clip(dot(plan - begin, step) / dot(step, step), 0.0, 1.0)
        best = np.minimum(best, norm(plan - begin - share[:, None] * step))
    return best


def _simplified(line: np.ndarray, most: float) -> np.ndarray:
    """A line with the fewer corners that leave none farther away than `most` (Douglas and Peucker 1973)."""
    used = np.zeros(len(line), bool)
    used[[0, -1]] = True
    waiting = [(0, len(line) - 1)]
    while waiting:
        first, last = waiting.pop()
        if last - first < 2 or not (line[last] - line[first]).any():
            continue
        away = _away(line[[first, last]], line[first + 1 : last])
        if away.max() > most:
            middle = first + 1 + int(away.argmax())
            used[middle] = True
            waiting += [(first, middle), (middle, last)]
    return line[used]
