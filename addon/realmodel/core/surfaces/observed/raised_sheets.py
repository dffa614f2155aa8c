# SPDX-License-Identifier: GPL-3.0-or-later
"""Data of a sheet that was raised above the older one at the nodes of its mesh: within triangles it may miss
contacts and bounds then. Thicknesses at nodes are sought that honor them, and that are not negative.

Of the thicknesses at the corners of a triangle each datum asks that they lie between two planes; the nearest
ones are projections onto these, one after another, until all hold (Kaczmarz 1937; Agmon 1954, "The relaxation
method for linear inequalities", Canadian Journal of Mathematics 6).
"""

from __future__ import annotations

import numpy as np

from ...base.work import Work, native_module
from ...heights.ties import TieData

_MOST_ROUNDS = 5000  # where data share two corners it takes many
_ON_EDGE = 1e-9  # weights of corners that do not count


def honoring(
    work: Work, nodes: np.ndarray, triangles: np.ndarray, z: np.ndarray, least: np.ndarray, data: TieData
) -> np.ndarray:
    """Heights (N,) at nodes (N, 2), at or above the least ones (N,), NaN where there is none, with which a
    sheet honors its data as far as these leave room: those that it has, z, where it does."""
    places = np.ascontiguousarray(data.places)
    if not len(places):
        return z
    around = native_module().nodes_around(nodes, triangles, places)
    is_near = np.zeros(len(nodes), bool)
    is_near[around] = True
    is_near &= np.isfinite(least)
    corners, weights = _located(work, nodes, triangles[is_near[triangles].all(axis=1)], places)
    known = corners[:, 0] >= 0
    corners, weights = corners[known], weights[known]
    base = (weights * least[corners]).sum(axis=1)
    margins = data.margins[known]  # there may be no room for them
    high = np.maximum(data.upper[known] + margins - base, 0.0)
    low = np.minimum(data.lower[known] - margins - base, high)
    thickness = np.where(is_near, z - least, 0.0)
    is_none = np.zeros(len(nodes), bool)  # for good, where there is none within a triangle
    for _ in range(_MOST_ROUNDS):
        work.check()
        found = (weights * thickness[corners]).sum(axis=1)
        wrong = np.flatnonzero((found < low - data.tolerance) | (found > high + data.tolerance))
        before = thickness.copy()
        for row in wrong.tolist():
            at = corners[row]
            if high[row] <= data.tolerance:
                is_none[at[weights[row] > _ON_EDGE]] = True
            share = np.where(is_none[at], 0.0, weights[row])
            thickness[at[is_none[at]]] = 0.0
            own, square = float((share * thickness[at]).sum()), float((share * share).sum())
            if square > _ON_EDGE:
                moved = thickness[at] + share * (min(max(own, low[row]), high[row]) - own) / square
                thickness[at] = np.maximum(moved, 0.0)
        if np.array_equal(thickness, before):  # all hold, or the others never will
            break
    return np.where(is_near & (thickness != z - least), least + thickness, z)


def _located(
    work: Work, nodes: np.ndarray, triangles: np.ndarray, places: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """(P, 3) the corners of the triangle that each place lies in, -1 where there is none, and its weights
    there."""
    corners, weights = np.full((len(places), 3), -1), np.zeros((len(places), 3))
    a, b, c = (nodes[triangles[:, corner]] for corner in range(3))
    area = _cross(b - a, c - a)
    for number, place in enumerate(places):
        if number % 100 == 0:
            work.check()
        of_b, of_c = _cross(place - a, c - a) / area, _cross(b - a, place - a) / area
        inside = np.minimum(np.minimum(of_b, of_c), 1.0 - of_b - of_c)
        best = int(inside.argmax()) if len(inside) else -1
        if best >= 0 and inside[best] > -1e-9:
            corners[number] = triangles[best]
            weights[number] = 1.0 - of_b[best] - of_c[best], of_b[best], of_c[best]
    return corners, weights


def _cross(u: np.ndarray, v: np.ndarray) -> np.ndarray:
    return u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0]
