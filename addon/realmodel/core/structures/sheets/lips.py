# SPDX-License-Identifier: GPL-3.0-or-later
"""Sheets beyond the faults at which they are cut off, for methods that triangulate their points."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from ...base.algebra import norm
from ...base.triangles import unit_normals, welded
from ...base.work import Work, native_module, on_threads
from ...heights.mis_ties import mean_heights
from ...settings.methods import METHODS
from ...surfaces.sides import FaultShape
from .points_at_faults import expected_heights

_AWAY = 4.0  # times the reach: so far from a fault a sheet is continued
_STEEP = 0.1  # of a unit normal in plan: a fault that dips less is nearly level


class Lip(NamedTuple):
    """A fault at which a sheet is cut off: shape, side (-1 or +1) of the sheet, and points (P,) bool, those
    that may lie on its cutoff line."""

    shape: FaultShape
    side: int
    points: np.ndarray


def beyond_lips(
    work: Work, points: np.ndarray, lips: list[Lip], reach: float, method: str, settings: Mapping
) -> np.ndarray:
    """(K, 3) points that continue a sheet beyond the faults at which it is cut off, for a method that
    triangulates its points (P, 3).

    Their convex outline bridges each bay of a cutoff line by triangles in the fault itself. So each point
    nearer than `reach` to a fault has another one beyond it, four times as far, where those that are not near
    one let expect the sheet; at the same height where that does not leave the fault, and where the method is
    to take the height of the nearest point beyond all.
    """
    if not lips or not METHODS[method].is_triangulated or settings["extrapolate"] == "none":
        return np.empty((0, 3))
    corners = [lip.shape.vertices[lip.shape.triangles] for lip in lips]
    nearest, run = native_module().nearest_triangles, on_threads(1)
    near = [
        np.where(lip.points, nearest(own, points, reach, execution=run)[0], -1)
        for lip, own in zip(lips, corners, strict=True)
    ]
    if not any((triangle >= 0).any() for triangle in near):
        return np.empty((0, 3))
    ordinary = np.empty((0, 3))
    if settings["extrapolate"] == "method":
        ordinary = mean_heights(points[np.all([triangle < 0 for triangle in near], axis=0)])
    found = [np.empty((0, 3))]
    for lip, triangle, its in zip(lips, near, corners, strict=True):
        own = np.flatnonzero(triangle >= 0)
        outward = -lip.side * unit_normals(its[triangle[own]])
        level = norm(outward[:, :2])
        some = level > _STEEP
        own, outward, level = points[own[some]], outward[some], level[some]
        away = np.column_stack([outward[:, :2], np.zeros(len(own))]) * (_AWAY * reach / level**2)[:, None]
        if len(ordinary):
            there, here = (expected_heights(work, ordinary, plan[:, :2]) for plan in (own + away, own))
            rise = there - here
            leaves = 2.0 * rise * outward[:, 2] > -_AWAY * reach
            away[leaves, 2] = rise[leaves]
        found.append(own + away)
    beyond = np.concatenate(found)
    points = points[np.isin(points[:, 0], beyond[:, 0])]
    same = welded(np.concatenate([points, beyond])[:, :2])[len(points) :]
    return beyond[same == np.arange(len(points), len(points) + len(beyond))]  # none where another point is
