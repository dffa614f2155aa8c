# SPDX-License-Identifier: GPL-3.0-or-later
"""UV coordinates of blocks, projected along the bedding, and these packed into one picture.

Each polygon is projected at right angles onto the bedding plane, or onto one of eight planes upright on it:
whichever faces it most. So no length is drawn out more than 1.48 times, all polygons have about one density,
and around a bed v is the height above its base. Seams are where the plane changes.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..base.algebra import atan2, cos, dot, norm, sin
from ..base.work import native_module

STEEPEST = 1.5  # the most that a length is drawn out, and so the inverse cosine of the angle to the plane
_SIDES = 8  # upright planes; their poles are _SIDES and _SIDES + 1
_CELLS = 6  # along each axis of the box of a block, in each of which the bedding has one direction
_TURN = math.radians(30.0)  # between the directions of bedding that count as different ones
_LEVEL = 1.0 - 1e-6  # cosine of the dip of beds that have no strike
_BASE = 1e-6  # of the height of a bed: what is lower lies on its base
_ANGLES = [2.0 * math.pi * number / _SIDES for number in range(_SIDES)]
_WAYS = np.array([*((math.cos(a), math.sin(a), 0.0) for a in _ANGLES), (0, 0, 1.0), (0, 0, -1.0)])


@dataclass(frozen=True, eq=False)
class Projection:
    """uv: (C, 2) float32 of the corners. chart: (F,) int32 of the polygons: those of one number lie in one
    plane."""

    uv: np.ndarray
    chart: np.ndarray


Arrays = tuple[np.ndarray, np.ndarray, np.ndarray]  # as of PolygonMesh: offsets, corners, corner_edges


def project(
    places: np.ndarray, mesh: Arrays, unit: float, bedding: tuple[np.ndarray, np.ndarray] | None = None
) -> Projection:
    """UV coordinates of a mesh. places: (V, 3). unit: the length of a UV unit. bedding: (F,) bool, the
    polygons on top or base of a bed, and (C,) the heights of corners in the bed; None: it is level."""
    offsets, corners, corner_edges = mesh
    at = places[corners].astype(np.float64)
    first = offsets[:-1]
    area = area_vectors(at, offsets)
    size = norm(area)
    which, frames = _frames(
        at[first], area, size, np.zeros(len(size), bool) if bedding is None else bedding[0]
    )
    pairs = neighbors(offsets, corner_edges)
    pairs = pairs[which[pairs[:, 0]] == which[pairs[:, 1]]]
    along = [dot(area, frames[which, axis]) for axis in range(3)]
    # as a neighbor, if the mean direction with all of them suits: rough rock would have a seam at each face
    (a, b), count = pairs.T, len(area)
    wide = _planes([part + np.bincount(a, part[b], count) + np.bincount(b, part[a], count) for part in along])
    plane = _planes(along)
    suits = np.zeros(count, bool)
    suits[np.append(a[plane[b] == wide[a]], b[plane[a] == wide[b]])] = True
    suits &= sum(along[axis] * _WAYS[wide, axis] for axis in range(3)) * STEEPEST > size
    plane = np.where(suits, wide, plane)
    chart = (which * (_SIDES + 2) + plane).astype(np.int32)
    counts = np.diff(offsets)
    low = np.zeros(len(at), bool) if bedding is None else bedding[1] < _BASE * bedding[1].max(initial=0.0)
    uv = np.empty((len(corners), 2), np.float32)
    of_corner = np.repeat(chart, counts)
    for number in np.unique(chart).tolist():
        frame, facing = divmod(number, _SIDES + 2)
        axes = _axes(frames[frame], facing)
        base = at[low & (np.repeat(which, counts) == frame)] if facing < _SIDES else at[:0]
        rows = np.flatnonzero(of_corner == number)
        uv[rows, 0] = dot(at[rows], axes[0]) / unit
        uv[rows, 1] = (dot(at[rows], axes[1]) - (dot(base, axes[1]).mean() if len(base) else 0.0)) / unit
    return Projection(uv, chart)


def area_vectors(at: np.ndarray, offsets: np.ndarray) -> np.ndarray:
    """(F, 3) twice the area of each polygon, as a vector outward. at: (C, 3) of its corners."""
    x, y, z = (at - at.mean(axis=0)).T if len(at) else at.T
    after = np.arange(1, len(at) + 1)
    after[offsets[1:] - 1] = offsets[:-1]
    parts = (y * z[after] - z * y[after], z * x[after] - x * z[after], x * y[after] - y * x[after])
    return np.column_stack([np.add.reduceat(part, offsets[:-1]) for part in parts])


def neighbors(offsets: np.ndarray, corner_edges: np.ndarray) -> np.ndarray:
    """(N, 2) the polygons on both sides of each edge."""
    face = np.repeat(np.arange(len(offsets) - 1), np.diff(offsets))
    order = np.argsort(corner_edges, kind="stable")
    is_pair = np.flatnonzero(corner_edges[order][1:] == corner_edges[order][:-1])
    return np.column_stack([face[order[is_pair]], face[order[is_pair + 1]]])


def _axes(frame: np.ndarray, plane: int) -> tuple[np.ndarray, np.ndarray]:
    """The directions of u and v in a plane, not mirrored seen from outside."""
    east, north, up = frame
    if plane >= _SIDES:
        return (east if plane == _SIDES else -east), north
    x, y, _ = _WAYS[plane]
    return x * north - y * east, up


def _planes(along: list[np.ndarray]) -> np.ndarray:
    """(F,) the plane that each polygon faces most. along: (F,) the parts of its normal in its frame."""
    east, north, up = along
    side = np.rint(np.arctan2(north, east) * (_SIDES / (2.0 * math.pi))).astype(np.int64) % _SIDES
    upright = east * _WAYS[side, 0] + north * _WAYS[side, 1]
    return np.where(np.abs(up) >= upright, np.where(up >= 0, _SIDES, _SIDES + 1), side)


def _frames(
    places: np.ndarray, area: np.ndarray, size: np.ndarray, is_bedding: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """(F,) the frame of each polygon, and frames (K, 3, 3): directions along the strike of the bedding, up
    its dip, and at right angles to it. Beds that are bent have several."""
    chosen = is_bedding & (size > 0)
    if not chosen.any():
        return np.zeros(len(size), np.int64), np.eye(3)[None]
    axis = _main_axis(area[chosen], size[chosen])
    east = np.array([-axis[1], axis[0], 0.0]) if axis[2] < _LEVEL else np.array([1.0, 0.0, 0.0])
    east = east - dot(east, axis) * axis
    east = east / norm(east)
    whole = np.array([east, np.cross(axis, east), axis])
    low, extent = places.min(axis=0), np.ptp(places, axis=0)
    steps = np.minimum(
        ((places - low) / np.where(extent > 0, extent, 1.0) * _CELLS).astype(np.int64), _CELLS - 1
    )
    cell = (steps[:, 0] * _CELLS + steps[:, 1]) * _CELLS + steps[:, 2]
    local = np.column_stack([dot(area[chosen], way) for way in whole])
    local[local[:, 2] < 0] *= -1.0
    total = np.column_stack([np.bincount(cell[chosen], part, _CELLS**3) for part in local.T])
    known = np.flatnonzero((total != 0).any(axis=1))
    grid = np.stack(np.unravel_index(np.arange(_CELLS**3), (_CELLS,) * 3), axis=1)
    away = np.square(grid[:, None] - grid[known]).sum(axis=2)
    total = total[known[away.argmin(axis=1)]]
    bins = np.rint(np.column_stack([atan2(total[:, k], total[:, 2]) for k in range(2)]) / _TURN)
    bins, of_cell = np.unique(bins, axis=0, return_inverse=True)
    frames = np.array([_turned(whole, *(bins[k] * _TURN)) for k in range(len(bins))])
    return of_cell.ravel()[cell], frames


def _main_axis(area: np.ndarray, size: np.ndarray) -> np.ndarray:
    """The direction, up rather than down, that the normals of polygons have but for their signs: the main
    axis of their tensor, by power iteration."""
    tensor = np.array([[float((area[:, i] * area[:, j] / size).sum()) for j in range(3)] for i in range(3)])
    axis = np.array([1e-3, 2e-3, 1.0])
    for _ in range(60):
        axis = dot(tensor, axis)
        axis /= norm(axis)
    return axis if axis[2] >= 0 else -axis


def _turned(frame: np.ndarray, first: float, second: float) -> np.ndarray:
    """A frame whose third axis is tilted by angles towards the first and the second."""
    east, north, axis = frame
    up = axis * cos(first) * cos(second) + east * sin(first) * cos(second) + north * sin(second) * cos(first)
    up = up / norm(up)
    middle = (axis + up) / (1.0 + dot(axis, up))
    return np.array([way - dot(way, up) * middle for way in (east, north)] + [up])


def islands(projection: Projection, mesh: Arrays) -> np.ndarray:
    """(F,) int32: one number for all polygons of a chart that hang together."""
    pairs = np.ascontiguousarray(neighbors(mesh[0], mesh[2]), np.int32)
    return native_module().cell_components(pairs, projection.chart)


def packed(uv: np.ndarray, island: np.ndarray, gap: float) -> np.ndarray:
    """(C, 2) float32: the UV coordinates (C, 2) with islands moved, and all made smaller or larger alike, so
    that they lie side by side in the unit square. island: (C,). gap: between islands, UV units of the
    square."""
    _, number = np.unique(island, return_inverse=True)
    number = number.ravel()
    order = np.argsort(number, kind="stable")
    begin = np.flatnonzero(np.diff(number[order], prepend=-1))
    low, high = (ufunc.reduceat(uv[order], begin).astype(np.float64) for ufunc in (np.minimum, np.maximum))
    extent = high - low
    rank = np.argsort(-extent[:, 1], kind="stable")
    least, most = 0.0, (1.0 - gap) / max(float(extent.max()), 1e-30)
    for _ in range(40):
        scale = 0.5 * (least + most)
        least, most = (scale, most) if _shelves(extent[rank] * scale + gap)[1] <= 1.0 else (least, scale)
    place = np.empty_like(extent)
    place[rank] = _shelves(extent[rank] * least + gap)[0] + 0.5 * gap
    return ((uv - low[number]) * least + place[number]).astype(np.float32)


def _shelves(size: np.ndarray) -> tuple[np.ndarray, float]:
    """The lower left corners (N, 2) of rectangles (N, 2) that stand on shelves one wide, and how high all
    are. The highest rectangles come first."""
    place = np.empty_like(size)
    ends = np.cumsum(size[:, 0])
    begin, height = 0, 0.0
    while begin < len(size):
        before = ends[begin] - size[begin, 0]
        end = max(int(np.searchsorted(ends, before + 1.0, "right")), begin + 1)
        place[begin:end, 0] = ends[begin:end] - size[begin:end, 0] - before
        place[begin:end, 1] = height
        height += float(size[begin, 1])
        begin = end
    return place, height
