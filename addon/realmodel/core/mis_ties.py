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
    place, first, apart = _places(points)
    if not apart.any():
        return points, None
    tolerated = (apart > 0) & (apart <= LARGEST_SHARE * np.ptp(points[:, 2]))
    if not tolerated.any():
        return points, None
    merged = points.copy()
    merged[first[tolerated], 2] = _means(points, place)[tolerated]
    keep = ~tolerated[place]
    keep[first[tolerated]] = True
    worst = int(np.where(tolerated, apart, 0.0).argmax())
    count = int(tolerated.sum())
    places = "1 position has" if count == 1 else f"{count} positions have"
    most = f"up to {apart[worst]:.6g} apart (at {place_text(points[first[worst], :2])})"
    return merged[keep], f"{places} several heights, {most}: their mean is used"


def mean_heights(points: np.ndarray) -> np.ndarray:
    """Points (P, 3) with the mean of the heights at each place: a rough surface where they contradict."""
    place, first, _ = _places(points)
    return np.column_stack([points[first, :2], _means(points, place)])


def contradictions(points: np.ndarray) -> np.ndarray:
    """(P,) bool: the points that contradict others at their place by more than a mis-tie. points: (P, 3 + K),
    the latter of which places have to have in common."""
    place, _, apart = _places(points)
    if not apart.any():
        return np.zeros(len(points), bool)
    return (apart > LARGEST_SHARE * np.ptp(points[:, 2]))[place]


def heights_apart(points: np.ndarray) -> np.ndarray:
    """(P,) how far the heights at each point's place are apart."""
    place, _, apart = _places(points)
    return apart[place]


def _places(points: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Of each point (P,) its place in plan; of each place its first point, and how far heights are apart."""
    keys = np.delete(points, 2, axis=1)
    order = np.lexsort(keys.T[::-1])
    new = np.ones(len(points), bool)
    new[1:] = (keys[order[1:]] != keys[order[:-1]]).any(axis=1)
    first = order[new]  # the point with the least number: the sort is stable
    place = np.empty(len(points), np.int64)
    place[order] = np.cumsum(new) - 1
    if new.all():
        return place, first, np.zeros(len(first))
    low, high = np.full(len(first), np.inf), np.full(len(first), -np.inf)
    np.minimum.at(low, place, points[:, 2])
    np.maximum.at(high, place, points[:, 2])
    return place, first, high - low


def _means(points: np.ndarray, place: np.ndarray) -> np.ndarray:
    return np.bincount(place, weights=points[:, 2]) / np.bincount(place)
