# SPDX-License-Identifier: GPL-3.0-or-later
"""Faults that die out, continued beyond their tips between two sheets: nothing displaces the sheets there."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ..algebra import dot, norm
from .triangles import crossing_pairs
from .within import Within, box_of, middles_of_parts

_WIDTH = 1e-9  # of the extent of a sheet: narrower gaps are due to rounding
_INSET = 1e-3  # of a part: its border may lie on another fault, which has no side there


def torn_triangles(
    plan: np.ndarray,
    triangles: np.ndarray,
    sheets: tuple[np.ndarray, np.ndarray],
    beyond: np.ndarray,
    within: Within,
    also: Callable[[np.ndarray], np.ndarray],
) -> np.ndarray:
    """(T,) bool: the triangles over which a part of others, `beyond` (M, 3, 3), lies between two sheets, in a
    compartment.

    sheets: heights (N,) at the nodes, plan (N, 2). also: what else holds at points (K, 3) where that counts.
    """
    found = np.zeros(len(triangles), bool)
    low, high = (np.column_stack([plan, each(*sheets)])[triangles] for each in (np.minimum, np.maximum))
    boxes = np.stack([low.min(axis=1), high.max(axis=1), high.max(axis=1)], axis=1)
    places, owners = [], []
    for t, m in crossing_pairs(boxes, beyond):
        node = triangles[t]
        origin = np.append(plan[node[0]], sheets[0][node[0]])
        one, other = (np.column_stack([plan[node], z[node]]) - origin for z in sheets)
        narrow = _WIDTH * float(np.ptp(np.concatenate([one, other]), axis=0).max())
        for lower, upper in ((one, other), (other, one)):
            polygon = _part_between(beyond[m] - origin, lower, upper)
            if not _is_narrow(polygon, narrow):
                places.append(polygon + origin)
                owners.append(t)
    if not places:
        return found
    walls = within.walls(box_of(*places))
    for polygon, t in zip(places, owners, strict=True):
        if found[t]:
            continue
        middle = np.broadcast_to(polygon.mean(axis=0), polygon.shape)
        inset = polygon + _INSET * (middle - polygon)
        begin, end = np.tile(inset, (2, 1)), np.concatenate([np.roll(inset, -1, axis=0), middle])
        _, inner = middles_of_parts(begin, end, walls)
        found[t] = (within(inner) & also(inner)).any()
    return found


def _part_between(triangle: np.ndarray, lower: np.ndarray, upper: np.ndarray) -> np.ndarray:
    """(K, 3) the polygon of a triangle that lies above and below two others with one plan, (3, 3) each."""
    planes = _walls(lower)
    for facing, sheet in ((1.0, lower), (-1.0, upper)):
        normal = np.cross(sheet[1] - sheet[0], sheet[2] - sheet[0])
        planes.append((sheet[0], normal * facing * np.sign(normal[2])))
    return _clipped(triangle, planes)


def common_lines(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """(2, K, 3) the ends of vertical lines from one triangle (3, 3) to another, just within each corner of
    their common area in plan."""
    polygon = _clipped(one, _walls(other))
    if len(polygon):
        polygon = polygon + _INSET * (polygon.mean(axis=0) - polygon)
    normal = np.cross(other[1] - other[0], other[2] - other[0])
    end = polygon.copy()
    end[:, 2] = other[0, 2] - dot((polygon - other[0])[:, :2], normal[:2]) / normal[2]
    return np.stack([polygon, end])


def _walls(triangle: np.ndarray) -> list[tuple[np.ndarray, np.ndarray]]:
    """The vertical planes through the edges of a triangle: a point, and the normal inward, of each."""
    (ux, uy), (vx, vy) = triangle[1, :2] - triangle[0, :2], triangle[2, :2] - triangle[0, :2]
    turn = np.sign(ux * vy - uy * vx)
    steps = np.roll(triangle, -1, axis=0) - triangle
    return [
        (at, np.array([-turn * step[1], turn * step[0], 0.0]))
        for at, step in zip(triangle, steps, strict=True)
    ]


def _clipped(polygon: np.ndarray, planes: list[tuple[np.ndarray, np.ndarray]]) -> np.ndarray:
    """(K, 3) the part of a polygon that is inward of all planes."""
    for at, inward in planes:
        if not len(polygon):
            break
        off = dot(polygon - at, inward)
        after = np.roll(polygon, -1, axis=0)
        off_after = np.roll(off, -1)
        crosses = (off < 0) != (off_after < 0)
        share = off / np.where(crosses, off - off_after, 1.0)
        crossing = polygon + share[:, None] * (after - polygon)
        every = np.stack([polygon, crossing], axis=1).reshape(-1, 3)
        polygon = every[np.column_stack([off >= 0, crosses]).ravel()]
    return polygon


def _is_narrow(polygon: np.ndarray, width: float) -> bool:
    if len(polygon) < 3:
        return True
    spokes = polygon - polygon[0]
    area = norm(np.cross(spokes[1:-1], spokes[2:]).sum(axis=0))
    length = norm(polygon - np.roll(polygon, -1, axis=0)).sum()
    return bool(area <= width * length)
