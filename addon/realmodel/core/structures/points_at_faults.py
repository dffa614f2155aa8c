# SPDX-License-Identifier: GPL-3.0-or-later
"""The sides of points that lie on a fault or near it: those whose other points they agree with.

Horizons come with points where faults cut them off, on the fault up to the digits of a file. Their side by
position is that of the last bit, and a point on the wrong side bends the sheet there by the throw.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from ..algebra import dot, norm
from ..build_warning import BuildWarning
from ..errors import place_text
from ..methods import METHODS
from ..work import Work
from .local_planes import mean_spacing, planes_at
from .sides import FaultShape, sides_of
from .triangles import median_edge, nearest_triangles, unit_normals

_NEAR = 0.25  # of an edge length: nearer to a fault, the position does not decide
_MISFITS = 10.0  # of a local plane: a point farther from it does not agree
_LEAST = 1e-6  # of the range of heights: nearer to a plane, a point agrees
_UPRIGHT = 1e-6  # of a unit normal: with less of it in plan a fault is level


class PointSides(NamedTuple):
    """Of points and faults: sides (P, F) int8, to which the points belong; moved (P, F) bool, where these are
    not the sides on which they lie; reach: as reach_of gives it."""

    sides: np.ndarray
    moved: np.ndarray
    reach: float

    def some(self, chosen: np.ndarray) -> PointSides:
        """Of some of the points, (P,) bool."""
        return PointSides(self.sides[chosen], self.moved[chosen], self.reach)


def point_sides(work: Work, points: np.ndarray, entry, number: int, threads: int = 0) -> PointSides:
    """The sides of the faults that points (P, 3) of surface `number` of a RockInput belong to.

    A point that is near a fault that displaces the surface (see reach_of) gets the sides of those points,
    near no fault, whose local plane is nearest to it. Where only one side has such points, its position
    decides, unless some of the points near the fault agree with them and others do not: these are of the
    other side.
    """
    structure = entry.structure
    faults = structure.faults
    sides = sides_of(work, points, faults, threads)
    active = faults.active(number)
    moved, near = np.zeros(sides.shape, bool), np.zeros(sides.shape, bool)
    reach = reach_of(points, median_edge(*entry.region), [faults.shapes[n] for n in np.flatnonzero(active)])
    if len(points) < 2 or not active.any():
        return PointSides(sides, moved, reach)
    for fault in np.flatnonzero(active):
        near[:, fault] = _nearest(points, faults.shapes[fault], reach) >= 0
    is_near = near.any(axis=1)
    rows = np.where(active, sides, 0)
    candidates = np.unique(np.where(active, structure.compartments, 0), axis=0)
    some = np.flatnonzero(is_near)
    alike = (candidates == rows[some, None]) | (candidates == 0) | (rows[some, None] == 0)
    possible = (alike | near[some, None]).all(axis=2)
    off, misfit = np.full(possible.shape, np.inf), np.zeros(possible.shape)
    for candidate, row in enumerate(candidates):
        group = points[~is_near & (rows == row).all(axis=1)]
        asked = np.flatnonzero(possible[:, candidate])
        if len(group) and len(asked):
            planes = planes_at(points[some[asked], :2], group)
            off[asked, candidate] = np.abs(planes.height - points[some[asked], 2])
            misfit[asked, candidate] = planes.misfit
    least = _LEAST * float(np.ptp(points[:, 2]))
    placed = _best(possible, (candidates == rows[some, None]).all(axis=2), off, _MISFITS * misfit + least)
    some, placed = some[placed >= 0], placed[placed >= 0]
    settled = np.where(active, candidates[placed], sides[some])
    moved[some] = settled != sides[some]
    sides[some] = settled
    return PointSides(sides, moved, reach)


def _best(possible: np.ndarray, own: np.ndarray, off: np.ndarray, tolerated: np.ndarray) -> np.ndarray:
    """(N,) the compartment that each point near a fault belongs to, as a number among C; -1 where it stays
    where it is.

    possible: (N, C) bool, those that it may belong to; own: (N, C) bool, where it lies; off: (N, C) how far
    it is from what the points of each say, infinite where they say nothing; tolerated: (N, C) how far it may
    be and agree with them.
    """
    rows = np.arange(len(off))
    best = off.argmin(axis=1)
    is_known = np.isfinite(off[rows, best])
    of_own = np.where(own, off, np.inf).min(axis=1, initial=np.inf)
    placed = np.where(is_known & (np.isfinite(of_own) | ~own.any(axis=1)), best, -1)
    agrees = is_known & (off <= tolerated).any(axis=1)
    for other in np.flatnonzero(np.isinf(off).all(axis=0)):  # no points away from the faults
        strange = possible[:, other] & is_known & ~agrees
        if strange.any():
            placed[strange & (own[:, other] | np.isfinite(of_own))] = other
            placed[agrees & own[:, other]] = best[agrees & own[:, other]]
    return placed


class Lip(NamedTuple):
    """A fault at which a sheet is cut off: shape, side (-1 or +1) of the sheet, and points (P,) bool, those
    that may lie on its cutoff line."""

    shape: FaultShape
    side: int
    points: np.ndarray


def beyond_lips(
    points: np.ndarray, lips: list[Lip], reach: float, method: str, settings: Mapping
) -> np.ndarray:
    """(K, 3) points that continue a sheet beyond the faults at which it is cut off, for a method that
    triangulates its points (P, 3).

    Their convex outline bridges each bay of a cutoff line by triangles in the fault itself. So each point
    nearer than `reach` to a fault has another one beyond it, four times as far: in the plane of the points
    around that are not near one, level where that plane does not leave the fault. It is level, too, where the
    method is to take the height of the nearest point beyond them.
    """
    if not METHODS[method].is_triangulated or settings["extrapolate"] == "none":
        return np.empty((0, 3))
    near = [np.where(lip.points, _nearest(points, lip.shape, reach), -1) for lip in lips]
    ordinary = points[np.all([triangle < 0 for triangle in near], axis=0)]
    found = [np.empty((0, 3))]
    for lip, triangle in zip(lips, near, strict=True):
        outward = -lip.side * unit_normals(lip.shape.vertices[lip.shape.triangles])[triangle]
        level = norm(outward[:, :2])
        some = (triangle >= 0) & (level > _UPRIGHT)
        own, outward, level = points[some], outward[some], level[some]
        away = np.column_stack([outward[:, :2] * (reach / _NEAR / level)[:, None], np.zeros(len(own))])
        if settings["extrapolate"] == "method" and len(ordinary):
            rise = dot(planes_at(own[:, :2], ordinary).slope, away[:, :2])
            leaves = 2.0 * rise * outward[:, 2] > -level * reach / _NEAR
            away[leaves, 2] = rise[leaves]
        found.append(own + away)
    return np.concatenate(found)


def placed_warning(points: np.ndarray, moved: np.ndarray, names: list[str], rock: str, surface: str):
    """The warning about points that are not on the side on which they lie; None where there are none."""
    count = int(moved.any(axis=1).sum())
    if not count:
        return None
    of = [f"'{names[fault]}'" for fault in np.flatnonzero(moved.any(axis=0))]
    first = points[int(moved.any(axis=1).argmax())]
    text = (
        f"{count} of its {len(points)} points, one at {place_text(first)}, lie on or just beyond fault"
        f"{'s' if len(of) > 1 else ''} {', '.join(of)}, and are taken for the side whose other points they "
        "agree with"
    )
    return BuildWarning(text, "points", rock, surface)


def reach_of(points: np.ndarray, length: float, shapes: list[FaultShape]) -> float:
    """How near to a fault points (P, 3) may be on its cutoff line: nearer than a quarter of an edge length,
    or of the mean spacing of the points farther away than that, where it is less. Cutoff lines may have many
    points, and say nothing of that spacing."""
    reach = _NEAR * length
    near = [_nearest(points, shape, reach) >= 0 for shape in shapes]
    ordinary = points[~np.any(near, axis=0)] if near else points
    return min(reach, _NEAR * mean_spacing(ordinary[:, :2])) if len(ordinary) > 1 else reach


def _nearest(points: np.ndarray, shape: FaultShape, reach: float) -> np.ndarray:
    """(P,) the nearest triangle of a fault; -1 where none is within `reach`."""
    return nearest_triangles(points, np.full(len(points), reach), shape.vertices[shape.triangles])
