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
    that may lie on its cutoff line. nearest: (P,) the triangle of the fault that is nearest to each, -1 where
    none is within reach; None where that is not known yet."""

    shape: FaultShape
    side: int
    points: np.ndarray
    nearest: np.ndarray | None = None

    def on(self, points: np.ndarray, reach: float) -> np.ndarray:
        """(P,) the triangle on which each of the points (P, 3) lies, -1 for those not on the cutoff line."""
        nearest = self.nearest
        if nearest is None:
            corners = self.shape.vertices[self.shape.triangles]
            nearest = native_module().nearest_triangles(corners, points, reach, execution=on_threads(1))[0]
        return np.where(self.points, nearest, -1)


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
    near = np.array([lip.on(points, reach) for lip in lips])
    of_lip, row = np.nonzero(near >= 0)
    if not len(row):
        return np.empty((0, 3))
    corners = np.concatenate(
        [lip.shape.vertices[lip.shape.triangles[on[on >= 0]]] for lip, on in zip(lips, near, strict=True)]
    )
    outward = -np.array([lip.side for lip in lips])[of_lip, None] * unit_normals(corners)
    level = norm(outward[:, :2])
    some = level > _STEEP
    near_points, outward, level = points[row[some]], outward[some], level[some]
    away = np.column_stack([outward[:, :2], np.zeros(len(near_points))]) * (_AWAY * reach / level**2)[:, None]
    ordinary = np.empty((0, 3))
    if settings["extrapolate"] == "method":
        ordinary = mean_heights(points[(near < 0).all(axis=0)])
    if len(ordinary):
        plan = np.concatenate([near_points + away, near_points])[:, :2]
        z_beyond, here = np.split(expected_heights(work, ordinary, plan), 2)
        rise = z_beyond - here
        leaves = 2.0 * rise * outward[:, 2] > -_AWAY * reach
        away[leaves, 2] = rise[leaves]
    beyond = near_points + away
    points = points[np.isin(points[:, 0], beyond[:, 0])]
    same = welded(np.concatenate([points, beyond])[:, :2])[len(points) :]
    return beyond[same == np.arange(len(points), len(points) + len(beyond))]  # none where another point is
