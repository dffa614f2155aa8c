# SPDX-License-Identifier: GPL-3.0-or-later
"""The block at given points of a model, without its cells."""

from __future__ import annotations

import numpy as np

from ..structures.closed_form import AIR, history
from ..structures.proof import closed_forms
from ..work import native_module


def blocks_at(model, points: np.ndarray, threads: int = 0) -> np.ndarray:
    """(N,) the number of the block at each point (N, 3); -1 for none.

    By the closed form of docs/dev/geometry.md. Heights of a surface are rounded as its triangles give them: a
    point that lies on it within a rounding may get either side.
    """
    points = np.ascontiguousarray(points, np.float64)
    found = np.full(len(points), AIR, np.int64)
    if model.structures is not None:
        for form in closed_forms(model):
            own = form.blocks_at(points)
            found = np.where(own != AIR, own, found)
        return found
    plan = np.ascontiguousarray(points[:, :2])
    number = {block.surface: n for n, block in enumerate(model.blocks)}
    first = 0
    for entry in model.rock_inputs:
        blocks = [number.get(first + k, AIR) for k in range(len(entry.surfaces))]
        first += len(entry.surfaces)
        heights = [_heights(shape, plan, threads) for shape in entry.surfaces]
        rules = [surface.rule for surface in entry.rock.surfaces]
        base = entry.rock.base_elevation
        own = history(points[:, 2], heights, rules, blocks, base is not None)
        if base is not None:
            own[points[:, 2] < base] = AIR
        if entry.region is not None:
            flat = np.column_stack([entry.region[0][:, :2], np.zeros(len(entry.region[0]))])
            own[np.isnan(_heights((flat, entry.region[1]), plan, threads))] = AIR
        found = np.where(own != AIR, own, found)
    return found


def _heights(shape, plan: np.ndarray, threads: int) -> np.ndarray:
    vertices, triangles = shape
    return native_module().surface_heights(vertices, triangles, plan, threads=threads)
