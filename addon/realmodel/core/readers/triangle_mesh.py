# SPDX-License-Identifier: GPL-3.0-or-later
"""What files of triangulated surfaces hold, whatever their format."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from ..errors import InputRefused
from ..point_file import MeshFile
from ..polygon_mesh import fanned


@dataclass(frozen=True)
class TriangleMesh:
    """vertices (V, 3) float64, triangles (T, 3) int32; polygons are fanned from their first corner.

    face_of_triangle (T,): the face of the file that a triangle is of, from 0; None where they are the same.
    unit: of its lengths (units.METERS), where the file says one; said_unit: one that may not be meant.
    warnings: sentences.
    """

    vertices: np.ndarray
    triangles: np.ndarray
    face_of_triangle: np.ndarray | None = None
    unit: str | None = None
    said_unit: str | None = None
    warnings: tuple[str, ...] = ()

    def in_model(self, given: MeshFile, model_unit: str) -> tuple[np.ndarray, list[str]]:
        """The vertices in the model's unit, z upward, and what to tell. given: what the user says of the
        file;
        without a unit of the user's the one of the file counts."""
        told = [f"{given.file}: {text}" for text in self.warnings]
        if given.units is None and self.unit not in (None, model_unit):
            given = replace(given, units=self.unit)
            told.append(f"{given.file}: its lengths are in {self.unit}, according to the file")
        if given.units is None and self.said_unit not in (None, model_unit):
            what = f"its header says {self.said_unit}; it is read in the unit of the model, {model_unit}"
            told.append(f'{given.file}: {what}: write units = "{self.said_unit}" if the header is right')
        plan_scale, height_scale = given.scale(model_unit)
        if (plan_scale, height_scale) == (1.0, 1.0):
            return self.vertices, told
        return self.vertices * (plan_scale, plan_scale, height_scale), told


def mesh_of_faces(file: Path, vertices, faces: Sequence, lines: Sequence[int] | None = None) -> TriangleMesh:
    """The mesh of vertices (V, 3) and the corners of each face, from 0: (F, K), or a list of any lengths.
    lines: where each face stands in the file. Raises InputRefused."""
    with np.errstate(invalid="ignore"):  # NaN of any kind is refused below
        vertices = np.ascontiguousarray(vertices, np.float64).reshape(-1, 3)
    if not len(faces):
        raise InputRefused("the mesh has no faces", file=file, advice="if it holds points, read it as points")
    bad = np.flatnonzero(~np.isfinite(vertices).all(axis=1))
    if len(bad):
        raise InputRefused(f"vertex {bad[0] + 1} is not finite", file=file)
    if isinstance(faces, np.ndarray):
        sizes, given = np.full(len(faces), faces.shape[1]), faces.ravel()
    else:
        sizes = np.array([len(face) for face in faces])
        given = np.array(list(itertools.chain.from_iterable(faces)))
    exists = (given >= 0) & (given < len(vertices))
    corners = np.where(exists, given, 0).astype(np.int64)
    wrong = ~exists | (corners != given)
    face_of_corner = np.repeat(np.arange(len(sizes)), sizes)
    for face in (*np.flatnonzero(sizes < 3)[:1], *face_of_corner[wrong][:1]):
        what = f"face {face + 1} has a corner that is no vertex" if sizes[face] > 2 else "a face of 2 corners"
        raise InputRefused(what, file=file, line=None if lines is None else lines[face])
    triangles, owner = fanned(np.append(0, np.cumsum(sizes)), corners)
    return TriangleMesh(vertices, triangles.astype(np.int32), None if (sizes == 3).all() else owner)
