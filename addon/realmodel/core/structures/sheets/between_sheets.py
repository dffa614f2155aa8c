# SPDX-License-Identifier: GPL-3.0-or-later
"""Faults that die out, continued beyond their tips between two sheets: nothing displaces the sheets there."""

from __future__ import annotations

import numpy as np

from ...base.algebra import dot, norm
from ...base.work import native_module
from .families import CompartmentTest, box_of, middles_of_parts

_WIDTH = 1e-9  # of the extent of a sheet: narrower gaps are due to rounding
_INSET = 1e-3  # of a part: its border may lie on another fault, which has no side there
_AT_ONCE = 1 << 12  # parts; so many need some 100 MB

# planes, one for each of some triangles: points (P, 3) and the normals inward (P, 3)
_Planes = list[tuple[np.ndarray, np.ndarray]]


def places_between(
    one: np.ndarray, other: np.ndarray, beyond: np.ndarray, within: CompartmentTest
) -> tuple[np.ndarray, np.ndarray]:
    """Where triangles `beyond` (M, 3, 3) lie between two others with one plan, those of `one` and `other`
    (T, 3, 3), in a compartment: the number (K,) of the pair of each place, and places (K, 3), some in each
    part."""
    low, high = one.copy(), one.copy()
    low[:, :, 2], high[:, :, 2] = (
        extreme(one[:, :, 2], other[:, :, 2]) for extreme in (np.minimum, np.maximum)
    )
    boxes = np.stack([low.min(axis=1), high.max(axis=1), high.max(axis=1)], axis=1)
    parts = [(np.empty(0, np.int64), np.empty((0, 3)))]
    pairs = native_module().meeting_boxes(boxes, beyond)
    for start in range(0, len(pairs), _AT_ONCE):
        t, m = pairs[start : start + _AT_ONCE].T
        number, places = _places_in_parts(one[t], other[t], beyond[m], within)
        parts.append((t[number], places))
    return np.concatenate([number for number, _ in parts]), np.concatenate([places for _, places in parts])


def _places_in_parts(
    one: np.ndarray, other: np.ndarray, crossing: np.ndarray, within: CompartmentTest
) -> tuple[np.ndarray, np.ndarray]:
    """As places_between has them, of one triangle (3, 3) of `crossing` (P, 3, 3) for each pair."""
    origin = one[:, 0]
    one, other, crossing = (triangles - origin[:, None] for triangles in (one, other, crossing))
    corners = np.concatenate([one, other], axis=1)
    narrow = _WIDTH * np.ptp(corners, axis=1).max(axis=1)
    parts: list[tuple[np.ndarray, np.ndarray]] = []
    for lower, upper in ((one, other), (other, one)):
        corners, owner = _part_between(crossing, lower, upper)
        is_wide = ~_are_narrow(corners, owner, narrow)[owner]
        # a number for each polygon, also of the two of one pair
        parts.append((corners[is_wide] + origin[owner[is_wide]], 2 * owner[is_wide] + len(parts)))
    corners, owner = (np.concatenate(arrays) for arrays in zip(*parts, strict=True))
    if not len(corners):
        return np.empty(0, np.int64), corners
    middle = _means(corners, owner)[owner]
    inset = corners + _INSET * (middle - corners)
    begin, end = np.tile(inset, (2, 1)), np.concatenate([inset[_after(owner)], middle])
    line, inner = middles_of_parts(begin, end, within.walls(box_of(corners)))
    is_inside = within(inner)
    return np.tile(owner, 2)[line[is_inside]] // 2, inner[is_inside]


def _part_between(
    triangles: np.ndarray, lower: np.ndarray, upper: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """The parts of triangles that lie above and below two others with one plan, (P, 3, 3) each, as _clipped
    has them."""
    planes = _walls(lower)
    for facing, sheet in ((1.0, lower), (-1.0, upper)):
        normal = np.cross(sheet[:, 1] - sheet[:, 0], sheet[:, 2] - sheet[:, 0])
        planes.append((sheet[:, 0], normal * (facing * np.sign(normal[:, 2:]))))
    return _clipped(triangles, planes)


def common_lines(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """(2, K, 3) the ends of vertical lines from triangles (P, 3, 3) to others, just within each corner of
    their common areas in plan."""
    corners, owner = _clipped(one, _walls(other))
    corners = corners + _INSET * (_means(corners, owner)[owner] - corners)
    normal = np.cross(other[:, 1] - other[:, 0], other[:, 2] - other[:, 0])[owner]
    first, end = other[owner, 0], corners.copy()
    end[:, 2] = first[:, 2] - dot((corners - first)[:, :2], normal[:, :2]) / normal[:, 2]
    return np.stack([corners, end])


def _walls(triangles: np.ndarray) -> _Planes:
    """The vertical planes through the edges of triangles (P, 3, 3)."""
    (ux, uy), (vx, vy) = ((triangles[:, k, :2] - triangles[:, 0, :2]).T for k in (1, 2))
    turn = np.sign(ux * vy - uy * vx)
    steps = np.roll(triangles, -1, axis=1) - triangles
    level = np.zeros(len(triangles))
    return [
        (triangles[:, k], np.column_stack([-turn * steps[:, k, 1], turn * steps[:, k, 0], level]))
        for k in range(3)
    ]


def _clipped(triangles: np.ndarray, planes: _Planes) -> tuple[np.ndarray, np.ndarray]:
    """The parts of triangles (P, 3, 3) that are inward of all their planes: the corners (K, 3) of these
    polygons, one polygon after another, and the number of the triangle of each corner."""
    corners, owner = triangles.reshape(-1, 3), np.repeat(np.arange(len(triangles)), 3)
    for at, inward in planes:
        off = dot(corners - at[owner], inward[owner])
        after = _after(owner)
        crosses = (off < 0) != (off[after] < 0)
        share = off / np.where(crosses, off - off[after], 1.0)
        crossing = corners + share[:, None] * (corners[after] - corners)
        is_kept = np.column_stack([off >= 0, crosses]).ravel()
        corners = np.stack([corners, crossing], axis=1).reshape(-1, 3)[is_kept]
        owner = np.repeat(owner, 2)[is_kept]
    return corners, owner


def _after(owner: np.ndarray) -> np.ndarray:
    """(K,) the corner after each corner of polygons, by the numbers of these."""
    after = np.arange(1, len(owner) + 1)
    is_first = np.diff(owner, prepend=-1) != 0
    after[np.roll(is_first, -1)] = np.flatnonzero(is_first)
    return after


def _means(corners: np.ndarray, owner: np.ndarray) -> np.ndarray:
    """(P, 3) the mean of the corners of each polygon; 0 where there is none."""
    total = np.zeros((int(owner.max(initial=-1)) + 1, 3))
    np.add.at(total, owner, corners)
    return total / np.maximum(1, np.bincount(owner, minlength=len(total)))[:, None]


def _are_narrow(corners: np.ndarray, owner: np.ndarray, width: np.ndarray) -> np.ndarray:
    """(P,) bool: the polygons that are narrower than these widths, (P,)."""
    after = _after(owner)
    spokes = corners - corners[np.searchsorted(owner, owner)]
    area, length = np.zeros((len(width), 3)), np.zeros(len(width))
    np.add.at(area, owner, np.cross(spokes, spokes[after]))
    np.add.at(length, owner, norm(corners - corners[after]))
    return norm(area) <= width * length
