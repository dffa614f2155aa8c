# SPDX-License-Identifier: GPL-3.0-or-later
"""The sides of points that lie on a fault or near it: those whose other points they agree with.

Horizons come with points where faults cut them off, on the fault up to the digits of a file. Their side by
position is that of the last bit, and a point on the wrong side bends the sheet there by the throw.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..algebra import norm
from ..build_warning import BuildWarning
from ..errors import place_text
from ..work import Work, native_module
from .beyond_faults import MEAN_DISTANCES, nearest_points
from .rock_structure import RockStructure
from .sides import FaultShape, sides_of
from .triangles import crossing_pairs, distances_of_pairs

_NEAR = 0.25  # of the mean spacing of the points: nearer to a fault, the position does not decide
_COUNTED = 8  # points of each side, through which a plane is laid
_SHARE = 1e-3  # of the points' spread, added so that points on a line give no slope across it
_UPRIGHT = 1e-6  # of a unit normal: with less of it in plan a fault is level


class PointSides(NamedTuple):
    """Of points and faults: sides (P, F) int8, to which the points belong; moved (P, F) bool, where these are
    not the sides on which they lie; near (P, F) bool, where a point is near a fault that displaces its
    surface."""

    sides: np.ndarray
    moved: np.ndarray
    near: np.ndarray

    def some(self, chosen: np.ndarray) -> PointSides:
        """Of some of the points, (P,) bool."""
        return PointSides(*(each[chosen] for each in self))


def point_sides(
    work: Work, points: np.ndarray, structure: RockStructure, number: int, threads: int = 0
) -> PointSides:
    """The sides of the faults that points (P, 3) of surface `number` belong to.

    A point is near a fault that displaces the surface when it is nearer than a quarter of the points' mean
    spacing. It gets the sides of those points, near no fault, whose local plane (weighted least squares of
    heights) is nearest to it. Where only one side has such points, its position decides.
    """
    faults = structure.faults
    sides = sides_of(work, points, faults, threads)
    active = faults.active(number)
    moved, near = np.zeros(sides.shape, bool), np.zeros(sides.shape, bool)
    if len(points) < 2 or not active.any():
        return PointSides(sides, moved, near)
    spacing = _spacing(points)
    for fault in np.flatnonzero(active):
        near[:, fault] = _are_near(points, faults.shapes[fault], _NEAR * spacing)
    undecided = np.flatnonzero(near.any(axis=1))
    rows = np.where(active, sides, 0)
    candidates = np.unique(np.where(active, structure.compartments, 0), axis=0)
    groups = [np.flatnonzero(~near.any(axis=1) & (rows == row).all(axis=1)) for row in candidates]
    groups = [group[np.argsort(points[group, 0], kind="stable")] for group in groups]
    for point in undecided.tolist():
        may_be = ((candidates == rows[point]) | near[point] | (candidates == 0) | (rows[point] == 0)).all(
            axis=1
        )
        off = np.full(len(candidates), np.inf)
        for candidate in np.flatnonzero(may_be).tolist():
            if len(group := groups[candidate]):
                off[candidate] = abs(_plane_at(points, group, point, spacing)[0] - points[point, 2])
        is_own = (candidates == rows[point]).all(axis=1)
        best = int(off.argmin())
        if is_own.any() and np.isfinite(off[is_own]).all() and off[best] < off[is_own].min():
            placed = np.where(active, candidates[best], sides[point])
            moved[point] = placed != sides[point]
            sides[point] = placed
    return PointSides(sides, moved, near)


def beyond_lips(points: np.ndarray, placed: PointSides, shapes: dict[int, FaultShape]) -> np.ndarray:
    """(K, 3) points that continue a sheet beyond the faults at which it is cut off, for methods that
    triangulate its points (P, 3).

    Their convex outline bridges each bay of a cutoff line by triangles in the fault itself. So each point
    near a fault has another one a mean spacing beyond it, in the plane of the points around it. shapes: the
    faults that part the sheet, by number.
    """
    spacing = _spacing(points) if len(points) else 0.0
    order = np.argsort(points[:, 0], kind="stable")
    found = []
    for fault, shape in shapes.items():
        corners = shape.vertices[shape.triangles]
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        normals /= norm(normals)[:, None]
        for point in np.flatnonzero(placed.near[:, fault]).tolist():
            away = distances_of_pairs(np.broadcast_to(points[point], (len(corners), 3)), corners)
            outward = -placed.sides[point, fault] * normals[int(away.argmin()), :2]
            level = float(norm(outward))
            if level > _UPRIGHT:
                shift = spacing / level * outward
                _, slope = _plane_at(points, order[order != point], point, spacing)
                found.append(points[point] + [*shift, slope[0] * shift[0] + slope[1] * shift[1]])
    return np.array(found).reshape(-1, 3)


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


def _spacing(points: np.ndarray) -> float:
    """The mean spacing in plan; of points on a line that along it."""
    along = float(np.ptp(points[:, :2], axis=0).max()) / len(points)
    return max(float(native_module().mean_spacing(np.ascontiguousarray(points), are_apart=True)), along)


def _are_near(points: np.ndarray, shape: FaultShape, reach: float) -> np.ndarray:
    """(P,) bool: the points that are nearer than `reach` to a fault."""
    corners = shape.vertices[shape.triangles]
    found = np.zeros(len(points), bool)
    pairs = crossing_pairs(np.stack([points - reach, points + reach, points], axis=1), corners)
    is_near = distances_of_pairs(points[pairs[:, 0]], corners[pairs[:, 1]]) < reach
    found[pairs[is_near, 0]] = True
    return found


def _plane_at(
    points: np.ndarray, group: np.ndarray, point: int, spacing: float
) -> tuple[float, tuple[float, float]]:
    """The height, at a point, of the plane through those of a group, ordered by x, nearest to it; and its
    slopes along x and y."""
    near = nearest_points(points, group, points[group, 0], point, MEAN_DISTANCES * spacing)[:_COUNTED]
    away = points[near] - points[point]
    weight = 1.0 / ((away[:, :2] ** 2).sum(axis=1) + spacing**2)
    weight /= weight.sum()
    middle = (weight[:, None] * away).sum(axis=0)
    x, y, z = (away - middle).T
    xx, yy, xy = (weight * x * x).sum(), (weight * y * y).sum(), (weight * x * y).sum()
    xz, yz = (weight * x * z).sum(), (weight * y * z).sum()
    extra = _SHARE * (xx + yy)
    xx, yy = xx + extra, yy + extra
    determinant = xx * yy - xy * xy
    if not determinant > 0:  # one point, or all at one place
        return float(points[point, 2] + middle[2]), (0.0, 0.0)
    slope = float(yy * xz - xy * yz) / determinant, float(xx * yz - xy * xz) / determinant
    height = points[point, 2] + middle[2] - slope[0] * middle[0] - slope[1] * middle[1]
    return float(height), slope
