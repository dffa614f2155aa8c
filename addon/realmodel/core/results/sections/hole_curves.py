# SPDX-License-Identifier: GPL-3.0-or-later
"""Values along boreholes as graphs beside them: bars from a base line, as wide as the values."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from ...base.algebra import dot
from ...readers.tables.interval_values import IntervalValues

_MOST = 500  # intervals of a hole that meet, of which no more can be seen
_SAME = 1e-9  # of a depth: depths that are nearer are one


def seen_values(values: IntervalValues, name: str, most: int = _MOST) -> IntervalValues:
    """The values of a column of numbers that can be seen: hole by hole, downward, where there is one. Where
    more than `most` intervals meet, the least and the greatest of each stretch, which meet in their
    places."""
    values = values.some(values.has(name))
    _, number = np.unique(values.holes, return_inverse=True)
    values = values.some(np.lexsort((values.depths[:, 0], number.reshape(-1))))
    array, depths = values.columns[name], values.depths
    away = np.abs(depths[1:, 0] - depths[:-1, 1]) > _SAME * np.abs(depths[1:, 0])
    starts = np.flatnonzero(np.append(True, away | (values.holes[1:] != values.holes[:-1])))
    chosen, first, last = [], [], []
    for begin, end in pairwise([*starts.tolist(), len(array)]):
        some = np.arange(begin, end)
        if len(some) > most:
            stretches = np.array_split(some, max(most // 2, 1))
            ends = [part[pick(array[part])] for part in stretches for pick in (np.argmin, np.argmax)]
            some = np.unique(ends)
        chosen.append(some)
        borders = (some[1:] + some[:-1] + 1) // 2
        first.append(np.concatenate([[begin], borders]))
        last.append(np.concatenate([borders, [end]]) - 1)
    if not len(array):
        return values
    rows, first_row, last_row = (np.concatenate(parts) for parts in (chosen, first, last))
    depths = np.column_stack([depths[first_row, 0], depths[last_row, 1]])
    begins, ends_of = values.begins[first_row], values.ends[last_row]
    return IntervalValues(values.holes[rows], begins, ends_of, depths, {name: array[rows]})


def limits_of(array: np.ndarray) -> tuple[float, float]:
    """The low and the high of values (N,); of none 0 and 0."""
    known = array[np.isfinite(array)]
    return (float(known.min()), float(known.max())) if len(known) else (0.0, 0.0)


def shares_of(array: np.ndarray, limits: tuple[float, float]) -> np.ndarray:
    """(N,) from 0 to 1: where values lie between a low and a high."""
    return np.clip((array - limits[0]) / ((limits[1] - limits[0]) or 1.0), 0.0, 1.0)


def sides_of(
    holes: np.ndarray, begins: np.ndarray, ends: np.ndarray, right: np.ndarray, up: np.ndarray
) -> np.ndarray:
    """(N, D) the side of each interval (N, D) on which its graph stands: right of holes (N,) that are steeper
    than level, seen as a whole, above others. right, up: (D,) of length 1, on the picture."""
    _, first, number = np.unique(holes, return_index=True, return_inverse=True)
    last = len(holes) - 1 - np.unique(holes[::-1], return_index=True)[1]
    ways = ends[last] - begins[first]
    is_steep = np.abs(dot(ways, up)) >= np.abs(dot(ways, right))
    return np.where(is_steep[:, None], right, up)[number.reshape(-1)]


def bars(
    begins: np.ndarray, ends: np.ndarray, sides: np.ndarray, shares: np.ndarray, gap: float, width: float
) -> np.ndarray:
    """(N, 4, D) the corners of bars beside intervals (N, D), a gap away on a side of length 1 (N, D): both
    ends of the base line, then both ends at the value. shares: (N,) of the width, from 0 to 1."""
    base, value = gap * sides, (gap + width * shares[:, None]) * sides
    return np.stack([begins + base, ends + base, ends + value, begins + value], axis=1)
