# SPDX-License-Identifier: GPL-3.0-or-later
"""The sides of points that lie on a fault or near it: those whose other points they agree with.

Horizons come with points where faults cut them off, on the fault up to the digits of a file. Their side by
position is that of the last bit, and a point on the wrong side bends the sheet there by the throw.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from ..algebra import norm
from ..build_warning import BuildWarning
from ..errors import place_text
from ..methods import METHODS
from ..mis_ties import mean_heights
from ..work import Work, native_module
from .sides import FaultShape, sides_of
from .triangles import median_edge, nearest_triangles, unit_normals

_NEAR = 0.25  # of an edge length: nearer to a fault, the position does not decide
_EXPECTED_BY = 16  # points: so many let expect a height
_PLANE = 1e6  # a spline so smooth is a plane
_LEAST = 1e-3  # of the range of heights: nearer to what is expected, a point agrees
_SURE = (
    0.25  # of the distance from what another side lets expect: so near, a point counts for its side at once
)
_PASSES = 40  # times that points which count at once let expect more
_UPRIGHT = 1e-6  # of a unit normal: with less of it in plan a fault is level


class PointSides(NamedTuple):
    """Of points and faults: sides (P, F) int8, to which the points belong; moved (P, F) bool, where these are
    not the sides on which they lie; reach: as near_faults gives it."""

    sides: np.ndarray
    moved: np.ndarray
    reach: float

    def some(self, chosen: np.ndarray) -> PointSides:
        """Of some of the points, (P,) bool."""
        return PointSides(self.sides[chosen], self.moved[chosen], self.reach)


def point_sides(work: Work, points: np.ndarray, entry, number: int, threads: int = 0) -> PointSides:
    """The sides of the faults that points (P, 3) of surface `number` of a RockInput belong to.

    A point that is near a fault that displaces the surface (near_faults) gets the sides of those points,
    near no fault, that let expect a height nearest to its own. Where only one side has such points, its
    position decides, unless some of the points near the fault agree with them and others do not: these are of
    the other side.
    """
    structure = entry.structure
    faults = structure.faults
    sides = sides_of(work, points, faults, threads)
    active = faults.active(number)
    moved, near = np.zeros(sides.shape, bool), np.zeros(sides.shape, bool)
    shapes = [faults.shapes[fault] for fault in np.flatnonzero(active)]
    reach, near[:, active] = near_faults(points, median_edge(*entry.region), shapes)
    is_near = near.any(axis=1)
    rows = np.where(active, sides, 0)
    candidates = np.unique(np.where(active, structure.compartments, 0), axis=0)
    some = np.flatnonzero(is_near)
    alike = (candidates == rows[some, None]) | (candidates == 0) | (rows[some, None] == 0)
    possible = (alike | near[some, None]).all(axis=2)
    group = np.full(len(points), -1)
    for candidate, row in enumerate(candidates):
        group[~is_near & (rows == row).all(axis=1)] = candidate
    for _ in range(_PASSES):
        off, tolerated = _off(work, points, group, some, possible, reach, threads)
        best = np.sort(off, axis=1)[:, :2]
        sure = np.isfinite(best).all(axis=1) & (best[:, 0] <= _SURE * best[:, -1])
        if best.shape[1] < 2 or not sure.any():
            break
        group[some[sure]] = off[sure].argmin(axis=1)
    own = (candidates == rows[some, None]).all(axis=2)
    placed = np.where(group[some] >= 0, group[some], _best(possible, own, off, tolerated))
    some, placed = some[placed >= 0], placed[placed >= 0]
    settled = np.where(active, candidates[placed], sides[some])
    moved[some] = settled != sides[some]
    sides[some] = settled
    return PointSides(sides, moved, reach)


def _off(
    work: Work, points: np.ndarray, group: np.ndarray, some: np.ndarray, possible, reach: float, threads: int
) -> tuple[np.ndarray, np.ndarray]:
    """off, tolerated (N, C), as _best has them, of some points that are in none of C groups (P,) yet. reach:
    so far a point may be from its place on the fault."""
    off, tolerated = np.full(possible.shape, np.inf), np.zeros(possible.shape)
    least = _LEAST * float(np.ptp(points[:, 2]))
    for number in range(possible.shape[1]):
        own = points[group == number]
        asked = np.flatnonzero(possible[:, number] & (group[some] < 0))
        if len(own) and len(asked):
            plan = points[some[asked], :2]
            expected = _expected(work, own, plan, threads=threads)
            beside = (plan + reach * np.array([[[0.0, 0.0]], [[1.0, 0.0]], [[0.0, 1.0]]])).reshape(-1, 2)
            plane, *sloped = _expected(work, own, beside, _PLANE, threads).reshape(3, -1)
            off[asked, number] = np.abs(expected - points[some[asked], 2])
            rise = sum(np.abs(each - plane) for each in sloped)
            tolerated[asked, number] = np.abs(expected - plane) + rise + least
    return off, tolerated


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
    work: Work, points: np.ndarray, lips: list[Lip], reach: float, method: str, settings: Mapping
) -> np.ndarray:
    """(K, 3) points that continue a sheet beyond the faults at which it is cut off, for a method that
    triangulates its points (P, 3).

    Their convex outline bridges each bay of a cutoff line by triangles in the fault itself. So each point
    nearer than `reach` to a fault has another one beyond it, four times as far, where those that are not near
    one let expect the sheet; at the same height where that does not leave the fault, and where the method is
    to take the height of the nearest point beyond all.
    """
    if not METHODS[method].is_triangulated or settings["extrapolate"] == "none":
        return np.empty((0, 3))
    near = [np.where(lip.points, _nearest(points, lip.shape, reach)[0], -1) for lip in lips]
    ordinary = points[np.all([triangle < 0 for triangle in near], axis=0)]
    found = [np.empty((0, 3))]
    for lip, triangle in zip(lips, near, strict=True):
        outward = -lip.side * unit_normals(lip.shape.vertices[lip.shape.triangles])[triangle]
        level = norm(outward[:, :2])
        some = (triangle >= 0) & (level > _UPRIGHT)
        own, outward, level = points[some], outward[some], level[some]
        away = np.column_stack([outward[:, :2] * (reach / _NEAR / level)[:, None], np.zeros(len(own))])
        if settings["extrapolate"] == "method" and len(ordinary):
            there, here = (_expected(work, ordinary, plan[:, :2]) for plan in (own + away, own))
            rise = there - here
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


def _expected(
    work: Work, points: np.ndarray, plan: np.ndarray, smoothing: float = 0.0, threads: int = 0
) -> np.ndarray:
    """(N,) the heights at plan points (N, 2) of splines through the nearest of some points (P, 3)."""
    spline, plan = native_module().spline, np.ascontiguousarray(plan)
    points = mean_heights(points)
    return work.native(spline, points, plan, smoothing=smoothing, neighbours=_EXPECTED_BY, threads=threads)


def near_faults(points: np.ndarray, length: float, shapes: list[FaultShape]) -> tuple[float, np.ndarray]:
    """How near to a fault points (P, 3) may be on its cutoff line, and (P, F) bool, which are so near.

    That is nearer than a quarter of an edge length, or of the mean spacing of the points farther away than
    that, where it is less. Cutoff lines may have many points, and say nothing of that spacing.
    """
    reach = _NEAR * length
    away = np.full((len(points), len(shapes)), np.inf)
    for fault, shape in enumerate(shapes):
        away[:, fault] = _nearest(points, shape, reach)[1]
    ordinary = points[np.isinf(away).all(axis=1)]
    if len(ordinary) > 1:
        reach = min(reach, _NEAR * _spacing(ordinary))
    return reach, away < reach


def _spacing(points: np.ndarray) -> float:
    """The mean spacing in plan; of points on a line that along it."""
    along = float(np.ptp(points[:, :2], axis=0).max()) / len(points)
    return max(float(native_module().mean_spacing(np.ascontiguousarray(points), are_apart=True)), along)


def _nearest(points: np.ndarray, shape: FaultShape, reach: float) -> tuple[np.ndarray, np.ndarray]:
    """(P,) the nearest triangle of a fault and how far it is, as nearest_triangles gives them."""
    return nearest_triangles(points, np.full(len(points), reach), shape.vertices[shape.triangles])
