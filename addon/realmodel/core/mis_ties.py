# SPDX-License-Identifier: GPL-3.0-or-later
"""Mis-ties: places where two measured lines cross and do not agree on the height of a surface."""

from __future__ import annotations

import numpy as np

from .errors import place_text

# of the height range of all points: beyond this it is a mistake in the data, and interpolation refuses it
LARGEST_SHARE = 0.05


def without_mis_ties(points: np.ndarray) -> tuple[np.ndarray, str | None]:
    """Points with one height at each place, and what was done, as a sentence (None: nothing).

    points: (P, 3) float64. Where heights at one place differ by no more than a twentieth of the height range
    of all points, their mean takes the place of the first of them; larger contradictions are left in.
    """
    order = np.lexsort((points[:, 1], points[:, 0]))
    new = np.ones(len(points), bool)
    new[1:] = (points[order[1:], :2] != points[order[:-1], :2]).any(axis=1)
    if new.all():
        return points, None
    first = order[new]  # of each place, the point with the least number: the sort is stable
    place = np.empty(len(points), np.int64)
    place[order] = np.cumsum(new) - 1
    low, high = np.full(len(first), np.inf), np.full(len(first), -np.inf)
    np.minimum.at(low, place, points[:, 2])
    np.maximum.at(high, place, points[:, 2])
    apart = high - low
    tolerated = (apart > 0) & (apart <= LARGEST_SHARE * np.ptp(points[:, 2]))
    if not tolerated.any():
        return points, None
    merged = points.copy()
    mean = np.bincount(place, weights=points[:, 2]) / np.bincount(place)
    merged[first[tolerated], 2] = mean[tolerated]
    keep = ~tolerated[place]
    keep[first[tolerated]] = True
    worst = int(np.where(tolerated, apart, 0.0).argmax())
    count = int(tolerated.sum())
    places = "1 position has" if count == 1 else f"{count} positions have"
    most = f"up to {apart[worst]:.6g} apart (at {place_text(points[first[worst], :2])})"
    return merged[keep], f"{places} several heights, {most}: their mean is used"
