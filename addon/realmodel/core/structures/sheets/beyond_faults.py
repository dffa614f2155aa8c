# SPDX-License-Identifier: GPL-3.0-or-later
"""Picks of one side of a fault that lie beyond it, detected where the other side has picks, too."""

from __future__ import annotations

import numpy as np

from ...base.algebra import are_among
from ...base.work import native_module, on_threads
from ...heights.mis_ties import LARGEST_SHARE, contradictions, heights_apart

_LOOKED_AT = 16  # nearest points, whose sides are considered
_COUNTED = 4  # points of each side, whose mean height is the expected one
_BETTER = 2.0  # times nearer: a point alone at its place must fit other sides so much better


def contradicting(points: np.ndarray, rows: np.ndarray, contacts: np.ndarray) -> np.ndarray:
    """(P,) bool: of points (P, 3) those that others at their place in plan contradict; none where these are
    all. Of a hole that passes a fault, contacts (C, 3) that follow from observations are on their sides."""
    contradicted = beyond_faults(points, rows) & ~are_among(points, contacts)
    left = np.flatnonzero(~contradicted)
    contradicted[left[contradictions(np.column_stack([points, rows])[left])]] = True
    return contradicted & ~contradicted.all()


def beyond_faults(points: np.ndarray, rows: np.ndarray) -> np.ndarray:
    """(P,) bool: of points (P, 3) at places with several heights those that are on the wrong side of a fault,
    and those beside them that are.

    rows: (P, F) their sides. A point is on the wrong side where its height is nearer to that of its neighbors
    on other sides than to that of those on its own. Neighbors are points that are alone at their place.
    """
    is_beyond = np.zeros(len(points), bool)
    several = heights_apart(points) > 0
    if not several.any() or several.all():
        return is_beyond
    _, row = np.unique(rows, axis=0, return_inverse=True)
    row = row.ravel()
    tolerated = LARGEST_SHARE * np.ptp(points[:, 2])
    tried = np.flatnonzero(several).tolist()
    while tried:
        references = np.flatnonzero(~several & ~is_beyond)
        if not len(references):
            break
        nearest, run = native_module().nearest_points, on_threads(1)
        nearest_rows, _ = nearest(points[references, :2], points[tried, :2], _LOOKED_AT + 1, execution=run)
        wrong, beside = [], set()
        for number, numbers in zip(tried, nearest_rows, strict=True):
            near = references[numbers[numbers >= 0]]
            near = np.append(near[near != number], near[near == number])[:_LOOKED_AT]  # itself comes last
            own_off, other = _off(points, row, near, number)
            if own_off > (other if several[number] else max(tolerated, _BETTER * other)):
                wrong.append(number)
                beside.update(near.tolist())
        is_beyond[wrong] = True
        tried = sorted(number for number in beside if not is_beyond[number])
    return is_beyond


def _off(points: np.ndarray, row: np.ndarray, near: np.ndarray, number: int) -> tuple[float, float]:
    """The difference of a point's height from its neighbors on its own side, and from those on the other side
    that fits best; 0 and infinite where there are none."""
    off = {
        int(side): abs(float(points[near[row[near] == side][:_COUNTED], 2].mean() - points[number, 2]))
        for side in np.unique(row[near])
    }
    own_off = off.pop(int(row[number]), 0.0)
    return own_off, min(off.values(), default=np.inf)
