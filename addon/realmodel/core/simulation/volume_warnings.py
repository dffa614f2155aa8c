# SPDX-License-Identifier: GPL-3.0-or-later
"""Warnings about blocks whose volume a mesh changes."""

from __future__ import annotations

import numpy as np

from ..base.build_warning import BuildWarning
from ..base.work import native_module
from ..cells.model_data import ModelData

_MOST_CHANGE = 0.1  # of a block's volume, without a warning


def changed_volumes(model: ModelData, volumes: np.ndarray, advice: str) -> list[BuildWarning]:
    """A warning for each block whose volume in a mesh, (B,), differs by more than a tenth."""
    return [
        BuildWarning(
            f"block '{block.name}' has a volume of {volume:.6g} in the mesh, and of {block.volume:.6g} in "
            f"the model; {advice}",
            "mesh_volume",
            model.rock_inputs[block.rock].rock.name,
        )
        for block, volume in zip(model.blocks, volumes, strict=True)
        if abs(volume - block.volume) > _MOST_CHANGE * block.volume
    ]


def changed_voids(
    model: ModelData, points: np.ndarray, triangles: np.ndarray, surface: np.ndarray
) -> list[BuildWarning]:
    """A warning for each void whose volume in a mesh differs by more than a tenth.

    triangles (T, 3), surface (T,): of the mesh, on the outside counter-clockwise seen from there."""
    warnings = []
    for body in model.structures.bodies:
        number = model.surface_names.index(body.name)
        faces = np.flatnonzero(model.face_surface == number)
        if not body.void or not len(faces):
            continue
        offsets, corners = model.face_corners(faces, np.zeros(len(faces), bool))
        exact, _ = native_module().triangulate_faces(model.vertices, offsets, corners)
        middle = float(model.vertices[corners, 2].mean())
        was = _enclosed(model.vertices, exact.reshape(-1, 3), middle)
        made = _enclosed(points, triangles[surface == number], middle)
        if abs(made - was) > _MOST_CHANGE * abs(was):
            what = f"void '{body.name}' has a volume of {made:.6g} in the mesh, and of {was:.6g} in the model"
            advice = "use a shorter edge length: one that is wider than the void closes it in places"
            warnings.append(BuildWarning(f"{what}; {advice}", "mesh_volume"))
    return warnings


def _enclosed(points: np.ndarray, triangles: np.ndarray, level: float) -> float:
    """The volume that triangles seen from outside the rock enclose. Vertical walls, in which a void may end,
    have no part of it: it is what lies between the triangles and a level."""
    a, b, c = (points[triangles[:, k]] - (0.0, 0.0, level) for k in range(3))
    u, v = (b - a)[:, :2], (c - a)[:, :2]
    plan = (u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]) / 2
    return float(-(plan * (a[:, 2] + b[:, 2] + c[:, 2]) / 3).sum())
