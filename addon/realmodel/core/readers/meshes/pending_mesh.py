# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes whose vertices and faces come one by one, with the vertex numbers of the file."""

from __future__ import annotations

from bisect import bisect_right
from pathlib import Path

from ...base.mapped_arrays import MakeRows
from ...base.text import LINES_AT_ONCE
from .triangle_mesh import MeshRows, TriangleMesh


class PendingMesh:
    """A mesh of which a few vertices and faces wait to be added."""

    def __init__(self, file: Path, rows: MakeRows):
        self.file = file
        self._mesh = MeshRows(file, rows)
        self.vertices: list[list[float]] = []
        self._faces: list[list[int]] = []
        self._lines: list[int] = []

    @property
    def vertex_count(self) -> int:
        """The number of vertices, including the pending ones."""
        return self._mesh.vertices + len(self.vertices)

    def add_face(self, corners: list[int], line: int | None = None) -> None:
        """Adds a face. line: its line in the file; given for all faces, or for none."""
        self._faces.append(corners)
        if line is not None:
            self._lines.append(line)

    def flush_some(self) -> None:
        """Adds what waits, if it is much."""
        if len(self.vertices) + len(self._faces) >= LINES_AT_ONCE:
            self._flush()

    def _flush(self) -> None:
        if self.vertices:
            self._mesh.add_vertices(self.vertices)
        self._mesh.add_faces(self._faces, self._lines or None)
        self.vertices, self._faces, self._lines = [], [], []

    def mesh(self) -> TriangleMesh:
        self._flush()
        return self._mesh.mesh()


class VertexNumbers:
    """The vertices of a surface by their numbers in the file: runs of consecutive ones, and others."""

    def __init__(self):
        self._runs: list[tuple[int, int]] = []  # where they begin, ascending, and the first vertex
        self._ends: list[int] = []
        self._others: dict[int, int] = {}

    def __setitem__(self, number: int, vertex: int) -> None:
        end = self._ends[-1] if self._ends else None
        if end is not None and number < end:
            self._others[number] = vertex
            return
        if number != end or vertex - number != self._runs[-1][1] - self._runs[-1][0]:
            self._runs.append((number, vertex))
            self._ends.append(number)
        self._ends[-1] = number + 1

    def __getitem__(self, number: int) -> int:
        if number in self._others:
            return self._others[number]
        run = bisect_right(self._ends, number)
        begin, first = self._runs[run]
        if number < begin:
            raise KeyError(number)
        return first + number - begin
