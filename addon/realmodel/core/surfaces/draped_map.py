# SPDX-License-Identifier: GPL-3.0-or-later
"""The polygons of a geological map as triangles on its ground."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..base.errors import InputRefused
from ..readers import UnitNames
from .map_data import MapOnGround
from .planar_mesh import mesh_region


@dataclass(frozen=True, eq=False)
class DrapedMap:
    """vertices: (V, 3) float64, model units. triangles: (T, 3) int32, counter-clockwise from above. unit:
    (T,) int32, of `names`: the block that a triangle shows or, where there is none, what the map says.
    warnings: sentences about polygons that are not shown."""

    vertices: np.ndarray
    triangles: np.ndarray
    unit: np.ndarray
    names: list[str]
    warnings: list[str]


def draped_map(given: MapOnGround, units: UnitNames) -> DrapedMap:
    """A map on its ground, as densely as it counts. Triangles where the ground is not known are left out."""
    vertices, triangles, numbers = [np.empty((0, 2))], [np.empty((0, 3), np.int32)], [np.empty(0, np.int32)]
    names: dict[str, int] = {}
    warnings, count = [], 0
    for polygon in given.polygons:
        block = polygon.unit if units.says_nothing(polygon.unit) else units.block(polygon.unit)
        number = names.setdefault(block or polygon.unit, len(names))
        try:
            plan, faces = mesh_region(list(polygon.rings), edge_length=given.frame.spacing)
        except InputRefused as error:
            warnings.append(f"{polygon.item} is not shown: {error.what}")
            continue
        vertices.append(plan)
        triangles.append(faces + np.int32(count))
        numbers.append(np.full(len(faces), number, np.int32))
        count += len(plan)
    plan = np.concatenate(vertices)
    z = given.frame.heights(plan) if len(plan) else np.empty(0)
    faces, unit = np.concatenate(triangles), np.concatenate(numbers)
    known = np.isfinite(z[faces]).all(axis=1)
    used, corners = np.unique(faces[known], return_inverse=True)
    places = np.column_stack([plan, z])[used]
    return DrapedMap(places, corners.reshape(-1, 3).astype(np.int32), unit[known], list(names), warnings)
