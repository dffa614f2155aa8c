# SPDX-License-Identifier: GPL-3.0-or-later
"""True thickness: the distance of a surface from another one, which is measured perpendicular to this.

What lies at a distance from a triangulated surface is the upper envelope of prisms on its triangles, tubes
around its edges and spheres around its corners. So in a syncline tighter than the thickness, where lines
perpendicular to the limbs cross, the envelope has a crest, and nothing has to be cut off.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from ..base.algebra import norm
from ..base.triangles import Sheet, border_loops, welded
from ..base.work import Work, native_module
from .interpolation import Task, sheet_of

_BEYOND = 1.1  # of the thickness: so far a surface continues beyond its border, also across corners
_HALVINGS = 5  # of that, where the surface itself is beyond its border
_ALONG, _ACROSS = (0.1, 0.5, 0.9), (0.25, 0.5, 0.75, 1.0)  # where it is asked whether it is
_STRAIGHT = 1e-9  # the sine of turns of the border that are none


class Base:
    """A surface above or below which thicknesses are measured; beyond its border it continues with its slopes
    there, as far as `reach`, the greatest thickness."""

    def __init__(self, work: Work, sheet: Sheet, reach: float):
        self.work = work
        self.corners = np.concatenate([sheet.corners, _continuation(work, sheet, _BEYOND * reach)])

    def thickness(self, points: np.ndarray, own: np.ndarray) -> np.ndarray:
        """(P,) how far points (P, 3) lie above it, negative below. own: (P,) its heights there."""
        _, away = self.work.native(native_module().nearest_triangles, self.corners, points)
        return np.where(points[:, 2] >= own, away, -away)

    def heights(self, places: np.ndarray, own: np.ndarray, thickness: np.ndarray) -> np.ndarray:
        """(N,) heights at places (N, 2) so far above it, or below where the thickness (N,) is negative; NaN
        where `own`, its heights there, are."""
        heights = own.copy()
        for sign in (1.0, -1.0):
            some = sign * thickness > 0
            if some.any():
                corners = self.corners if sign > 0 else self.corners * np.array([1.0, 1.0, sign])
                asked = (np.ascontiguousarray(places[some]), sign * own[some], sign * thickness[some])
                z = self.work.native(native_module().heights_at_distance, corners, *asked)
                heights[some] = sign * z
        return heights


def lifted(task: Task, below: np.ndarray, thickness: np.ndarray | float) -> np.ndarray:
    """(N,) heights at the nodes so far from the surface `to` of a task, whose heights there are `below`:
    upward or perpendicular to it, by the task."""
    sheet = _base_sheet(task)
    if sheet is None:
        return below + thickness
    thickness = np.broadcast_to(np.asarray(thickness, np.float64), below.shape)
    reach = np.abs(thickness[np.isfinite(below)]).max(initial=0.0)
    return Base(task.work, sheet, float(reach)).heights(task.nodes, below, thickness)


def measured(task: Task, points: np.ndarray, under: np.ndarray) -> np.ndarray:
    """(P, 3) points with their thicknesses above the surface `to` of a task instead of z. under: (P,)
    its heights there."""
    measured_points = points.copy()
    measured_points[:, 2] -= under
    sheet = _base_sheet(task)
    if sheet is not None:
        base = Base(task.work, sheet, float(np.abs(measured_points[:, 2]).max(initial=0.0)))
        measured_points[:, 2] = base.thickness(np.ascontiguousarray(points), under)
    return measured_points


def stretched(below: np.ndarray, z: np.ndarray, thickness: np.ndarray) -> np.ndarray:
    """(N,) by how much heights change with the thickness: 1 over level ground."""
    with np.errstate(invalid="ignore", divide="ignore"):
        share = (z - below) / thickness
    return np.where(np.isfinite(share), share, 1.0)


def _base_sheet(task: Task) -> Sheet | None:
    """The surface `to` where thicknesses are perpendicular to it and it is not level; else None."""
    return sheet_of(task, task.settings["to"], "to") if task.true_thickness else None


def _continuation(work: Work, sheet: Sheet, width: float) -> np.ndarray:
    """(K, 3, 3) triangles beyond the border of a sheet, as wide, where the sheet is not itself."""
    vertices, triangles = sheet.vertices, welded(sheet.vertices)[sheet.triangles]
    area = _doubled_areas(vertices[triangles])
    triangles = np.where(area[:, None] < 0, triangles[:, ::-1], triangles)[area != 0]
    loops = border_loops(triangles)
    if not loops or not width > 0:
        return np.empty((0, 3, 3))
    sectors = [_sectors(vertices[:, :2], loop) for loop in loops]
    ends = np.concatenate([part for part, _ in sectors])
    ways = np.concatenate([part for _, part in sectors])
    begin, rise = vertices[ends], (_slopes(vertices, triangles)[ends] * ways).sum(axis=2)
    widths = _free_widths(work, sheet, begin[:, :, :2], ways, width)
    by = np.concatenate([ways, rise[:, :, None]], axis=2) * widths[:, None, None]
    outer = begin + by
    first = np.stack([begin[:, 0], outer[:, 0], outer[:, 1]], axis=1)
    second = np.stack([begin[:, 0], outer[:, 1], begin[:, 1]], axis=1)[ends[:, 0] != ends[:, 1]]
    return np.concatenate([first[widths > 0], second[widths[ends[:, 0] != ends[:, 1]] > 0]])


def _doubled_areas(corners: np.ndarray) -> np.ndarray:
    """(T,) twice the areas of triangles (T, 3, 2 or 3) in plan, negative where they are clockwise."""
    u, v = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    return u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]


def _slopes(vertices: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """(V, 2) the slopes at vertices: the mean of those of their triangles, which are counter-clockwise,
    weighted by areas in plan, so that narrow ones do not say much."""
    corners = vertices[triangles]
    area = np.bincount(triangles.reshape(-1), np.repeat(_doubled_areas(corners), 3), len(vertices))
    slopes = np.zeros((len(vertices), 2))
    for k in range(3):
        z = corners[:, k, 2] - corners[:, 0, 2]
        across = corners[:, (k + 1) % 3, :2] - corners[:, (k + 2) % 3, :2]
        for axis, part in enumerate((z * across[:, 1], -z * across[:, 0])):
            slopes[:, axis] += np.bincount(triangles.reshape(-1), np.repeat(part, 3), len(vertices))
    with np.errstate(invalid="ignore"):
        return np.where(area[:, None] > 0, slopes / area[:, None], 0.0)


def _sectors(plan: np.ndarray, loop: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Of a loop with its sheet on the left what lies outside, in sectors: (K, 2) the vertices at which each
    begins, and (K, 2, 2) the directions in which it continues from them. Along edges the vertices differ,
    around corners that stick out the directions."""
    edge = plan[np.roll(loop, -1)] - plan[loop]
    way = np.column_stack([edge[:, 1], -edge[:, 0]]) / norm(edge)[:, None]
    before = np.roll(way, 1, axis=0)
    middle = before + way
    turn = before[:, 0] * way[:, 1] - before[:, 1] * way[:, 0]
    sticks_out = (turn > _STRAIGHT) & (norm(middle) > _STRAIGHT)
    corner, around = loop[sticks_out], [vectors[sticks_out] for vectors in (before, middle, way)]
    around[1] = around[1] / norm(around[1])[:, None]
    for at in (2, 1):  # quarters
        between = around[at - 1] + around[at]
        around.insert(at, between / norm(between)[:, None])
    ends = [np.column_stack([loop, np.roll(loop, -1)]), *[np.column_stack([corner, corner])] * 4]
    ways = [np.stack([way, way], axis=1), *(np.stack(pair, axis=1) for pair in pairwise(around))]
    return np.concatenate(ends), np.concatenate(ways)


def _free_widths(work: Work, sheet: Sheet, begin: np.ndarray, ways: np.ndarray, width: float) -> np.ndarray:
    """(K,) the widths of sectors, halved until the sheet is not within them; 0 where it always is."""
    widths = np.full(len(begin), width)
    along, across = np.array(_ALONG)[:, None], np.array(_ACROSS)
    asked = np.arange(len(begin))
    for _ in range(_HALVINGS):
        start = begin[asked, :1] + along * (begin[asked, 1:] - begin[asked, :1])
        way = ways[asked, :1] + along * (ways[asked, 1:] - ways[asked, :1])
        reach = widths[asked, None, None, None] * across[:, None]
        places = (start[:, :, None] + reach * way[:, :, None]).reshape(-1, 2)
        z = work.native(native_module().surface_heights, *sheet.arrays, np.ascontiguousarray(places))
        is_there = np.isfinite(z).reshape(len(asked), -1).any(axis=1)
        asked = asked[is_there]
        widths[asked] /= 2
        if not len(asked):
            break
    widths[asked] = 0.0
    return widths
