# SPDX-License-Identifier: GPL-3.0-or-later
"""Contour lines of triangles: straight within each, and joined where triangles share an edge in space."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..base.algebra import begins_run
from ..base.errors import UsageError
from ..cells.model_data import ModelData
from .geological_map import Ground, ground_of

MOST_LEVELS = 10_000
_AUTOMATIC = 15  # levels, about


@dataclass(frozen=True, eq=False)
class Contour:
    """A line of one height on the top of the model (surface ""), or on an input surface, by its name.

    elevation: its height, model units. points: (N, 2) float64, higher ground to the left; closed where the
    first is the last.
    """

    surface: str
    elevation: float
    points: np.ndarray


def checked_interval(interval: float | None, low: float, high: float) -> float:
    """The interval of levels: the given one, or one, two or five times a power of ten that gives about
    fifteen levels. Raises UsageError."""
    if interval is None:
        rough = max(high - low, 1e-9 * max(abs(low), abs(high), 1.0)) / _AUTOMATIC
        power = 10.0 ** math.floor(math.log10(rough))
        return next(step * power for step in (1, 2, 5, 10) if step * power >= rough * (1 - 1e-9))
    if not 0.0 < interval < math.inf:
        raise UsageError(f"a contour interval is a number above 0, not {interval}")
    if (high - low) / interval > MOST_LEVELS:
        raise UsageError(
            f"contours every {interval:g} from {low:g} to {high:g} are more than {MOST_LEVELS:,} levels; "
            "take a longer interval"
        )
    return float(interval)


def contours(model: ModelData, interval: float | None = None, ground: Ground | None = None) -> list[Contour]:
    """Contours of the top of the model, then of each input surface that is no fault or body, at multiples of
    the interval. interval: as of `checked_interval`. ground: as of `geological_map`. Raises UsageError,
    BuildFailed.

    >>> line = model.contours(interval=2)[0]  # of the top
    >>> line.elevation, sorted(line.points.tolist())
    (2.0, [[1.0, 0.0], [1.0, 1.0], [1.0, 4.0]])
    """
    ground = ground_of(model) if ground is None else ground
    shapes = [("", ground.corners, ground.vertices, ground.solid)]
    for number, name in enumerate(model.surface_names):
        if model.surface_kind[number] == 0:
            vertices, triangles = model.surface(number)
            shapes.append((name, vertices[triangles], triangles, triangles))
    heights = [corners[:, :, 2] for _, corners, _, _ in shapes if len(corners)]
    if not heights:
        return []
    low, high = min(z.min() for z in heights), max(z.max() for z in heights)
    step = checked_interval(interval, float(low), float(high))
    lines = (_of_shape(name, corners, plan, solid, step) for name, corners, plan, solid in shapes)
    return [line for of_shape in lines for line in of_shape]


def ground_contours(ground: Ground) -> list[Contour]:
    """Contours of the top of a model alone, at about fifteen levels of it."""
    if not len(ground.corners):
        return []
    heights = ground.corners[:, :, 2]
    step = checked_interval(None, float(heights.min()), float(heights.max()))
    return _of_shape("", ground.corners, ground.vertices, ground.solid, step)


def _of_shape(
    name: str, corners: np.ndarray, vertices: np.ndarray, solid: np.ndarray, step: float
) -> list[Contour]:
    if not len(corners):
        return []
    low, high = corners[:, :, 2].min(), corners[:, :, 2].max()
    levels = (k * step for k in range(math.ceil(low / step), math.floor(high / step) + 1))
    return [
        Contour(name, level, line)
        for level in levels
        for line in level_lines(corners, vertices, solid, level)
    ]


def level_lines(
    corners: np.ndarray, vertices: np.ndarray, solid: np.ndarray, level: float
) -> list[np.ndarray]:
    """The lines (N, 2) of a level on triangles (T, 3, 3), with higher ground to the left; the last point is
    the first of a closed one. A vertex at the level counts as higher, so a line never divides. vertices,
    solid: (T, 3) numbers of the corners in plan and in space."""
    is_high = corners[:, :, 2] >= level
    rows = np.flatnonzero(is_high.any(axis=1) & ~is_high.all(axis=1))
    if not len(rows):
        return []
    is_high, corners, vertices = is_high[rows], corners[rows], vertices[rows]
    solid = np.sort(solid[rows], axis=1).tolist()
    following = np.roll(is_high, -1, axis=1)
    falls, rises = (is_high & ~following).argmax(axis=1), (~is_high & following).argmax(axis=1)
    begin, from_edge = _crossings(corners, vertices, falls, level)
    end, to_edge = _crossings(corners, vertices, rises, level)
    starting: dict[tuple[int, int], list[int]] = {}
    for number, edge in enumerate(from_edge):
        starting.setdefault(edge, []).append(number)
    after = [-1] * len(rows)
    is_first = [True] * len(rows)
    for number, edge in enumerate(to_edge):
        for other in starting.get(edge, ()):
            if is_first[other] and len(set(solid[number]) & set(solid[other])) > 1:
                after[number], is_first[other] = other, False
                break
    lines, used = [], [False] * len(rows)
    for first in [*(n for n in range(len(rows)) if is_first[n]), *range(len(rows))]:
        if used[first]:
            continue
        path, at = [begin[first]], first
        while at >= 0 and not used[at]:
            used[at] = True
            path.append(end[at])
            at = after[at]
        points = np.array(path)
        points = points[begins_run(points)]
        if len(points) > 1:
            lines.append(points)
    return lines


def _crossings(
    corners: np.ndarray, vertices: np.ndarray, side: np.ndarray, level: float
) -> tuple[np.ndarray, list[tuple[int, int]]]:
    """The crossings of the level with the side from corner `side` of each triangle: (T, 2), and the vertices
    of these edges. Both triangles of an edge get the same position."""
    row = np.arange(len(side))
    a, b = corners[row, side], corners[row, (side + 1) % 3]
    one, two = vertices[row, side], vertices[row, (side + 1) % 3]
    swap = one > two
    a, b = np.where(swap[:, None], b, a), np.where(swap[:, None], a, b)
    share = ((level - a[:, 2]) / (b[:, 2] - a[:, 2]))[:, None]
    places = np.where(share < 0.5, a[:, :2] + share * (b - a)[:, :2], b[:, :2] - (1 - share) * (b - a)[:, :2])
    return places, list(zip(np.minimum(one, two).tolist(), np.maximum(one, two).tolist(), strict=True))
