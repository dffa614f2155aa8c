# SPDX-License-Identifier: GPL-3.0-or-later
"""The solid that is filled: a closed mesh, or an open one of one height everywhere, closed down to a base."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ..base.algebra import twice_area
from ..base.errors import InputRefused, place_text
from ..base.triangles import border_loops, checked_triangulation, open_edges
from ..base.work import Work, native_module
from ..results.booleans import intersect_within
from ..surfaces.planar_mesh import triangulate_polygon

Mesh = tuple[np.ndarray, np.ndarray]

ITEM = "the mesh"  # as refusals name it
_FAR = 10.0  # sizes of the mesh: how far away the solid is that takes nothing from it


def closed_mesh(vertices: ArrayLike, triangles: ArrayLike, base: float | None = None) -> Mesh:
    """A mesh without open edges: the given one, or, where that has one height at each position, it with walls
    and a level floor at the elevation `base` (None: as far beneath its lowest point as its highest is above).

    vertices (V, 3), triangles (T, 3). Vertices that are given come first, unchanged. Raises InputRefused for
    a mesh that is open otherwise, or that reaches down to the base.
    """
    vertices, triangles = checked_triangulation(vertices, triangles)
    edges = open_edges(vertices, triangles)
    if not len(edges):
        return vertices, triangles
    place = tuple(vertices[edges[0]].mean(axis=0).tolist())
    native, plan = native_module(), vertices[:, :2]
    turns = native.orient2d(*(plan[triangles[:, k]] for k in range(3)))
    if not ((turns > 0).all() or (turns < 0).all()):
        raise InputRefused(
            f"it is open, for example near {place_text(place)}, and has not one height at each position",
            item=ITEM,
            advice="close it, or take overhangs and vertical faces away",
            place=place,
        )
    if turns[0] < 0:
        triangles = triangles[:, ::-1]
    lowest, highest = float(vertices[:, 2].min()), float(vertices[:, 2].max())
    base = 2.0 * lowest - highest if base is None else float(base)
    if base >= lowest:
        raise InputRefused(
            f"it is open and reaches down to {lowest:.6g}, which is not above the base at {base:.6g}",
            item=ITEM,
            advice="choose a deeper base",
        )
    return _down_to(vertices, triangles, base)


def _down_to(vertices: np.ndarray, triangles: np.ndarray, base: float) -> Mesh:
    """A mesh that faces up with walls and a floor."""
    loops = border_loops(triangles)
    outer = [loop for loop in loops if twice_area(vertices[loop, :2]) > 0]
    if len(outer) != 1:
        place = tuple(vertices[loops[-1][0]].tolist())
        raise InputRefused(
            f"it is open and in {len(outer)} parts, one of them near {place_text(place)}",
            item=ITEM,
            advice="join the parts, or fill one after the other",
            place=place,
        )
    loops = outer + [loop for loop in loops if loop is not outer[0]]
    corners = np.concatenate(loops)
    below = np.arange(len(vertices), len(vertices) + len(corners))
    deep = np.column_stack([vertices[corners, :2], np.full(len(corners), base)])
    plan = [vertices[loop, :2] for loop in loops]
    floor = below[triangulate_polygon(plan[0], plan[1:])][:, ::-1]
    onward = np.concatenate([np.roll(part, -1) for part in np.split(np.arange(len(corners)), _ends(loops))])
    walls = [
        np.column_stack([corners[onward], corners, below]),
        np.column_stack([corners[onward], below, below[onward]]),
    ]
    closed = np.concatenate([triangles, *walls, floor]).astype(np.int32)
    return np.concatenate([vertices, deep]), closed


def _ends(loops: list[np.ndarray]) -> np.ndarray:
    return np.cumsum([len(loop) for loop in loops])[:-1]


def solid_within(work: Work, mesh: Mesh, share: float) -> Mesh:
    """What is inside a closed mesh as a solid that does not cross itself, as the first part of a job. Where
    it does, what it covers twice counts once, as in Booleans. Raises InputRefused where its triangles face
    both ways, or it holds nothing."""
    try:
        intersection = intersect_within(work, mesh, _far_from(mesh[0]), share)
        made = intersection.difference()
    except InputRefused as error:
        raise InputRefused(
            error.what, item=ITEM, advice=error.advice, triangles=error.triangles, place=error.place
        ) from error
    if not len(made[1]):
        raise InputRefused("it holds no volume", item=ITEM, advice="give it some thickness")
    return made


def _far_from(vertices: np.ndarray) -> Mesh:
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    size = float((high - low).max()) or 1.0
    corners = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]) * size + high + _FAR * size
    return corners, np.array([(0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)], np.int32)
