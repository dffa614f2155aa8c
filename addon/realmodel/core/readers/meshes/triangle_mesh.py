# SPDX-License-Identifier: GPL-3.0-or-later
"""The triangulated surface of a file, in any format."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ...base.algebra import begins_run
from ...base.errors import InputRefused, counted
from ...base.mapped_arrays import ROWS_AT_ONCE, JoinPieces, MakeRows, Rows, in_memory, in_pieces
from ...base.triangles import concave_divided, fanned
from ...settings.data_files import MeshFile
from ..objects.geo_object import SURFACE, GeoObject, ObjectName, Values, object_units

_MOST_VERTICES = np.iinfo(np.int32).max


@dataclass(frozen=True)
class TriangleMesh:
    """vertices (V, 3) float64, triangles (T, 3) int32; polygons are fanned from their first corner, or
    divided within themselves where a fan would leave them.

    face_of_triangle (T,): the face of the file that a triangle is of, from 0; None where they are the same.
    unit: of its lengths, as the file names it, or {"xy": ..., "z": ...}; None: it states none. said_unit: one
    of units.METERS that may not be meant. warnings: sentences.
    """

    vertices: np.ndarray
    triangles: np.ndarray
    face_of_triangle: np.ndarray | None = None
    unit: str | Mapping | None = None
    said_unit: str | None = None
    warnings: tuple[str, ...] = ()

    def in_model(
        self, given: MeshFile, model_unit: str, gather: JoinPieces = in_memory
    ) -> tuple[np.ndarray, list[str]]:
        """The vertices in the model's unit, z upward, and warnings. given: the import options of the user;
        where they have no unit, the unit of the file is used. gather: where the vertices are kept."""
        warnings = [f"{given.file}: {text}" for text in self.warnings]
        (plan, height), of_units = object_units(given, self, model_unit)
        warnings += of_units
        plan_scale, height_scale = replace(given, units={"xy": plan, "z": height}).scale(model_unit)
        if (plan_scale, height_scale) == (1.0, 1.0):
            return self.vertices, warnings
        scale = np.array([plan_scale, plan_scale, height_scale])
        return gather((piece * scale for piece in in_pieces(self.vertices)), np.empty((0, 3))), warnings


class MeshRows:
    """A mesh that comes piece by piece, in any order. rows: where it is kept. Raises InputRefused."""

    def __init__(self, file: Path, rows: MakeRows = Rows):
        self._file, self._rows = file, rows
        self._vertices = rows(np.empty((0, 3)))
        self._triangles = rows(np.empty((0, 3), np.int32))
        self._owners: Rows | None = None  # of triangles, where there are larger faces
        self._lines: Rows | None = None
        self.vertices, self.faces = 0, 0  # how many there are
        self._triangle_count = 0
        self._lowest, self._highest = 0, -1  # corners

    def add_vertices(self, vertices: ArrayLike) -> None:
        with np.errstate(invalid="ignore"):  # NaN of any kind is refused
            vertices = np.ascontiguousarray(vertices, np.float64).reshape(-1, 3)
        bad = np.flatnonzero(~np.isfinite(vertices).all(axis=1))
        if len(bad):
            raise InputRefused(f"vertex {self.vertices + bad[0] + 1} is not finite", file=self._file)
        self._vertices.add(vertices)
        self.vertices += len(vertices)

    def add_faces(self, faces: Sequence | np.ndarray, lines: Sequence[int] | None = None) -> None:
        """faces: their corners, from 0, (F, K) or a list of any lengths; these may come later than they.
        lines: where each face stands in the file."""
        if not len(faces):
            return
        if isinstance(faces, np.ndarray):
            sizes, numbers = np.full(len(faces), faces.shape[1]), faces.ravel()
        else:
            sizes = np.array([len(face) for face in faces])
            numbers = np.array(list(itertools.chain.from_iterable(faces)))
        for face in np.flatnonzero(sizes < 3)[:1]:
            line = None if lines is None else lines[face]
            raise InputRefused("a face of 2 corners", file=self._file, line=line)
        with np.errstate(invalid="ignore"):
            is_number = (numbers >= 0) & (numbers <= _MOST_VERTICES)
            corners = np.where(is_number, numbers, -1).astype(np.int32)
            corners[corners != numbers] = -1
        triangles, owner = fanned(np.append(0, np.cumsum(sizes)), corners)
        self._lowest = min(self._lowest, int(corners.min()))
        self._highest = max(self._highest, int(corners.max()))
        if self._owners is None and (sizes > 3).any():
            self._owners = self._rows(np.empty(0, np.int64))
            for begin in range(0, self._triangle_count, ROWS_AT_ONCE):
                self._owners.add(np.arange(begin, min(begin + ROWS_AT_ONCE, self._triangle_count)))
        if self._owners is not None:
            self._owners.add(owner + self.faces)
        if lines is not None:
            self._lines = self._lines or self._rows(np.empty(0, np.int64))
            self._lines.add(np.asarray(lines))
        self._triangles.add(triangles)
        self._triangle_count += len(triangles)
        self.faces += len(sizes)

    def mesh(self) -> TriangleMesh:
        """The mesh; concave polygons are divided within themselves."""
        if not self.faces:
            advice = "if it holds points, read it as points"
            raise InputRefused("the mesh has no faces", file=self._file, advice=advice)
        triangles = self._triangles.array()
        owners = None if self._owners is None else self._owners.array()
        if self._lowest < 0 or self._highest >= self.vertices:
            bad = self._first_bad(triangles)
            face = bad if owners is None else int(owners[bad])
            line = None if self._lines is None else int(self._lines.array()[face])
            raise InputRefused(f"face {face + 1} has a corner that is no vertex", file=self._file, line=line)
        vertices = self._vertices.array()
        if owners is None:
            return TriangleMesh(vertices, triangles)
        triangles, crossing = self._divided(vertices, triangles, owners)
        warnings = []
        if crossing:
            what = "its border crosses itself" if crossing == 1 else "their borders cross themselves"
            warnings = [f"{counted(crossing, 'face')} cannot be divided rightly: {what}"]
        return TriangleMesh(vertices, triangles, owners, warnings=tuple(warnings))

    def _divided(
        self, vertices: np.ndarray, triangles: np.ndarray, owners: np.ndarray
    ) -> tuple[np.ndarray, int]:
        """The triangles with concave polygons divided within themselves, and how many cross themselves."""
        rows, replaced, begin, crossing = [], [], 0, 0
        while begin < len(triangles):
            last = owners[min(begin + ROWS_AT_ONCE, len(triangles)) - 1]
            end = int(np.searchsorted(owners, last, "right"))
            first = np.flatnonzero(begins_run(owners[begin:end, None]))
            changed, new, crossed = concave_divided(vertices, triangles[begin:end], first)
            rows.append(begin + changed)
            replaced.append(new)
            crossing += len(crossed)
            begin = end
        changed_rows, new_triangles = np.concatenate(rows), np.concatenate(replaced)
        if not len(changed_rows):
            return triangles, crossing
        divided = self._rows(np.empty((0, 3), np.int32))
        for begin in range(0, len(triangles), ROWS_AT_ONCE):
            piece = np.array(triangles[begin : begin + ROWS_AT_ONCE])
            at = slice(*np.searchsorted(changed_rows, (begin, begin + len(piece))).tolist())
            piece[changed_rows[at] - begin] = new_triangles[at]
            divided.add(piece)
        return divided.array(), crossing

    def _first_bad(self, triangles: np.ndarray) -> int:
        begin = 0
        for piece in in_pieces(triangles):
            bad = np.flatnonzero(((piece < 0) | (piece >= self.vertices)).any(axis=1))
            if len(bad):
                return begin + int(bad[0])
            begin += len(piece)
        raise AssertionError("there is none")


def mesh_of_faces(
    file: Path, vertices: ArrayLike, faces: Sequence | np.ndarray, lines: Sequence[int] | None = None
) -> TriangleMesh:
    """The mesh of vertices (V, 3) and the corners of each face, as MeshRows takes them. Raises
    InputRefused."""
    mesh_rows = MeshRows(file)
    if len(faces):  # without faces another error is reported
        mesh_rows.add_vertices(vertices)
    mesh_rows.add_faces(faces, lines)
    return mesh_rows.mesh()


def mesh_of_corners(file: Path, corners: ArrayLike, sizes: Sequence[int] = (3,)) -> TriangleMesh:
    """The mesh of faces that are given by the places (C, 3) of their corners, one face after another; equal
    places become one vertex, in the order of their coordinates. sizes: the number of corners of each face, or
    that of all. Raises InputRefused."""
    with np.errstate(invalid="ignore"):  # NaN of any kind is refused
        places = np.asarray(corners, np.float64).reshape(-1, 3) + 0.0  # zero has one sign
    order = np.lexsort(places.T[::-1])
    ordered = places[order]
    is_first = begins_run(ordered)
    vertices, index = ordered[is_first], np.empty(len(places), np.int64)
    index[order] = np.cumsum(is_first) - 1
    if len(set(sizes)) == 1:
        return mesh_of_faces(file, vertices, index.reshape(-1, sizes[0]))
    ends = itertools.accumulate(sizes, initial=0)
    numbers = index.tolist()
    return mesh_of_faces(file, vertices, [numbers[begin:end] for begin, end in itertools.pairwise(ends)])


def surface_object(
    file: Path,
    name: str,
    vertices: ArrayLike,
    faces: Sequence | np.ndarray,
    lines: Sequence[int] | None = None,
    is_part: bool = False,
    **more: Any,
) -> ObjectName:
    """A surface of a file by its vertices (V, 3), of which others may be used by others, and the corners of
    its faces; arguments as of mesh_of_faces, which is called when it is read. is_part: as of an ObjectName.
    more: as of a GeoObject."""

    def made() -> GeoObject:
        return object_of_mesh(name, mesh_of_faces(file, vertices, faces, lines), **more)

    return ObjectName(name, SURFACE, made, is_part=is_part)


def object_of_mesh(name: str, mesh: TriangleMesh, warnings: Sequence[str] = (), **more: Any) -> GeoObject:
    """A surface with the vertices that its triangles use. more: as of a GeoObject."""
    used, index = np.unique(mesh.triangles, return_inverse=True)
    vertices, triangles = mesh.vertices[used], index.reshape(-1, 3).astype(np.int32)
    return GeoObject(
        name,
        SURFACE,
        vertices,
        triangles,
        [Values(vertices, {})],
        face_of_triangle=mesh.face_of_triangle,
        warnings=(*warnings, *mesh.warnings),
        **more,
    )


UNREADABLE = (ValueError, IndexError, KeyError, OverflowError, TypeError)


class DamagedError(ValueError):
    """An error in a file, with its line or byte."""

    def __init__(self, what: str, line: int | None = None, byte: int | None = None):
        super().__init__(what if byte is None else f"{what} (byte {byte})")
        self.line = line


def unreadable(file: Path, kind: str, error: Exception) -> InputRefused:
    reason = " ".join(str(error).split()) or type(error).__name__
    line = getattr(error, "line", None)
    return InputRefused(f"not a {kind} file that can be read: {reason:.200}", file=file, line=line)
