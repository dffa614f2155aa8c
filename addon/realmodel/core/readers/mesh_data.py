# SPDX-License-Identifier: GPL-3.0-or-later
"""A mesh from a file, for scripts: as a project reads it, in one call."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ..base.units import MODEL_UNIT
from ..settings.data_files import MeshFile
from .mesh_input import read_mesh as read_triangle_mesh
from .point_input import reading_keys


@dataclass(frozen=True, eq=False)
class MeshData:
    """What read_mesh gives. vertices: (V, 3) float64 in the model's unit, z upward. triangles: (T, 3) int32.
    warnings: sentences."""

    vertices: np.ndarray
    triangles: np.ndarray
    warnings: list[str]


def read_mesh(
    file: str | Path, units: str = MODEL_UNIT, *, file_units: str | Mapping | None = None, **keys: Any
) -> MeshData:
    """The triangulated surface of a file in any format of meshes, as a project reads it.

    units: of the model. file_units: of the file, "ft", or {"xy": "m", "z": "ft"}, where the file does not
    state them or is wrong; None: what it states, or else those of the model. keys: those of MeshFile: layer,
    z_axis. Raises UsageError for an unknown unit or key, InputRefused naming the file, and the line where it
    has lines; with the names of the surfaces if there are several and `layer` selects none.
    """
    given = reading_keys(MeshFile, file, units, file_units, keys)
    mesh = read_triangle_mesh(given)
    vertices, warnings = mesh.in_model(given, units)
    return MeshData(vertices, mesh.triangles, warnings)
