# SPDX-License-Identifier: GPL-3.0-or-later
"""The region, the lengths and the heights of a project, from where its data are."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from .lenses import spacing

_MARGIN = 0.5  # of the spacing of holes
_LEAST_MARGIN = 0.05  # of the extent
_EDGES = 4  # between neighboring holes
_ACROSS = 20  # edges across the region, at least
_MOST_TRIANGLES = 20_000
_BELOW = 0.1  # of the range of heights: so far below the data the base is
_DEEP = 0.25  # of the width of a map: so far below the ground its base is


def region_around(plan: np.ndarray, within: np.ndarray | None = None) -> tuple[np.ndarray, float]:
    """(N, 2) the convex hull of places (P, 2) with a margin, counter-clockwise, and the margin. within:
    (2, 2) the corners of a box in which it stays."""
    extent = float(np.ptp(plan, axis=0).max()) or 1.0
    margin = rounded(max(_MARGIN * spacing(plan), _LEAST_MARGIN * extent))
    turned = np.arange(8) * np.pi / 4
    around = margin / np.cos(np.pi / 8) * np.column_stack([np.cos(turned), np.sin(turned)])
    corners = (plan[:, None] + around[None]).reshape(-1, 2)
    unit = 10.0 ** math.floor(math.log10(margin)) / 10
    hull = convex_hull(np.round(corners / unit) * unit)
    if within is not None:
        hull = _clipped(hull, within)
    return np.round(hull, 9), margin


def rounded(length: float, digits: int = 2) -> float:
    """A length above 0 with so many digits."""
    return float(f"{length:.{digits}g}")


def convex_hull(points: np.ndarray) -> np.ndarray:
    """(N, 2) the corners of the convex hull of points (P, 2), counter-clockwise (Andrew 1979)."""
    points = np.unique(points, axis=0)

    def half(ordered: np.ndarray) -> list:
        chain: list[np.ndarray] = []
        for point in ordered:
            while len(chain) > 1 and _turn(chain[-2], chain[-1], point) <= 0:
                chain.pop()
            chain.append(point)
        return chain[:-1]

    return np.array([*half(points), *half(points[::-1])])


def _turn(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> float:
    return float((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))


def _clipped(ring: np.ndarray, box: np.ndarray) -> np.ndarray:
    """A convex ring within a box (2, 2) (Sutherland and Hodgman 1974)."""
    for axis in (0, 1):
        for limit, sign in ((box[0, axis], 1.0), (box[1, axis], -1.0)):
            inside = sign * (ring[:, axis] - limit)
            corners = []
            for at in range(len(ring)):
                here, after = ring[at], ring[(at + 1) % len(ring)]
                d, e = inside[at], inside[(at + 1) % len(ring)]
                if d >= 0:
                    corners.append(here)
                if (d > 0 > e) or (d < 0 < e):
                    corners.append(here + d / (d - e) * (after - here))
            ring = np.array(corners).reshape(-1, 2)
    return ring


def ring_area(ring: np.ndarray) -> float:
    """The area inside a ring (N, 2)."""
    x, y = (ring - ring[0]).T
    return float(abs((x * np.roll(y, -1) - y * np.roll(x, -1)).sum()) / 2)


def edge_length(rings: Sequence[np.ndarray], plan: np.ndarray) -> tuple[float, str]:
    """The edge length for holes at (P, 2) in a region, and why. Without holes by the region alone."""
    corners = np.vstack(list(rings))
    width = float(np.ptp(corners, axis=0).max())
    area = sum(map(ring_area, rings))
    apart = spacing(plan)
    least = math.sqrt(area / (math.sqrt(3) / 4 * _MOST_TRIANGLES))
    wanted = min(apart / _EDGES if apart else math.inf, width / _ACROSS)
    if least > wanted:
        return rounded(least), f"as short as {_MOST_TRIANGLES} triangles allow"
    if wanted < width / _ACROSS:
        return rounded(wanted), f"a quarter of the distance between neighboring holes, {apart:.3g}"
    return rounded(wanted), f"a twentieth of the width of the region, {width:.3g}"


def base_below(heights: np.ndarray, width: float, is_map: bool) -> tuple[float, str]:
    """The elevation of the base below data at some heights, in a region of a width, and why."""
    lowest, highest = float(heights.min()), float(heights.max())
    if is_map:
        depth, why = _DEEP * width, "a quarter of the width of the map below the lowest ground"
    else:
        depth = max(_BELOW * (highest - lowest), 1e-3 * width)
        why = f"a tenth of the range of elevations below the deepest datum, {lowest:.6g}"
    step = 10.0 ** math.floor(math.log10(depth))
    return round(math.floor((lowest - depth) / step) * step, 9), why
