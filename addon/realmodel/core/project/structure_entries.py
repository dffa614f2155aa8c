# SPDX-License-Identifier: GPL-3.0-or-later
"""The entries of faults and bodies in a project."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from ..base.stored_objects import NOT_STORED
from ..base.toml_table import Source
from ..settings.map_layer import is_wkt
from ..settings.point_file import MeshFile, PointFile
from .entry import Entry


class Shaped(Entry):
    """The common part of surfaces, faults and bodies: a mesh from arrays or from a file."""

    vertices: np.ndarray | None
    triangles: np.ndarray | None
    mesh: str | Path | MeshFile | None

    def triangulation(self) -> tuple[np.ndarray, np.ndarray]:
        """Vertices (V, 3) and triangles (T, 3) of one whose mesh is read or made."""
        assert self.vertices is not None and self.triangles is not None
        return self.vertices, self.triangles

    @property
    def mesh_file(self) -> MeshFile | None:
        """The file of its mesh; None where it has none."""
        return MeshFile(self.mesh) if isinstance(self.mesh, (str, Path)) else self.mesh

    @property
    def point_file(self) -> PointFile | None:
        """The file of its points and how it is read; None where they are an array, or there are none."""
        return as_point_file(getattr(self, "points", None))

    @property
    def input_file(self) -> Path | None:
        """The file that gives its shape; None where arrays do."""
        given = self.mesh_file or self.point_file or getattr(self, "trace_file", None)
        return None if given is None else Path(given.file)


@dataclass(eq=False)
class Fault(Shaped):
    """A fault: an open triangulated surface in any position, that displaces surfaces.

    Its shape is a mesh - `vertices` (V, 3) float64 in model units with `triangles` (T, 3), or a file `mesh` -
    or `points` through which a surface is fitted: scattered (P, 3), sticks as a list of arrays (N, 3), or a
    file of either (.pol, or a table; `stick` names the column of the sticks' names). `extend`: how far
    the mesh is continued beyond its border, or the fitted surface beyond its points, model units.

    Or its shape is a `trace`, the line in which it cuts the ground, with a `dip` in degrees below the
    horizontal: points (N, 2) or (N, 3), several such lines, well-known text, or a file or PointFile of lines.
    `dip_direction`: degrees clockwise from north (+y), or "N", "NE", ... for the side of the trace; not
    needed where it is vertical. Files may have both as attributes. `elevation` of the line: a number, or the
    name of the surface that it is on; None: z of the line (NaN: none), else it is on the youngest surface.
    The fault goes on straight at both ends, through the rock; with `extend`, or where it dies out, only so
    far.

    youngest: name of the youngest surface that it displaces; None: all of them. ends_at: names of faults at
    which it ends; the smaller part of it beyond is dropped. dies_out: it ends inside the rock, where its
    displacement vanishes. rocks: names of the rock masses that it displaces; none: all that have `youngest`.
    """

    kind = "fault"
    name: str
    vertices: np.ndarray | None = None
    triangles: np.ndarray | None = None
    youngest: str | None = None
    ends_at: Sequence[str] = ()
    dies_out: bool = False
    rocks: Sequence[str] = ()
    points: np.ndarray | Sequence[np.ndarray] | str | Path | PointFile | None = None
    stick: str | int | None = None
    extend: float = 0.0
    mesh: str | Path | MeshFile | None = None
    trace: np.ndarray | Sequence[np.ndarray] | str | Path | PointFile | None = None
    dip: float | None = None
    dip_direction: float | str | None = None
    elevation: float | str | None = None
    traced: Fault | None = field(default=None, repr=False, compare=False)  # as it was, with the line as read
    shape_file: Path | None = field(default=None, repr=False, compare=False)
    source: Source | None = field(default=None, repr=False, compare=False, metadata=NOT_STORED)

    def trace_line(self) -> np.ndarray:
        """(N, 3) the trace, once it is read as one line (traces.read_trace)."""
        assert isinstance(self.trace, np.ndarray)
        return self.trace

    @property
    def trace_file(self) -> PointFile | None:
        """The file of its trace; None where it is an array or text, or there is none."""
        return None if isinstance(self.trace, str) and is_wkt(self.trace) else as_point_file(self.trace)


def as_point_file(given: Any) -> PointFile | None:
    if isinstance(given, (str, Path)):
        return PointFile(given)
    return given if isinstance(given, PointFile) else None


@dataclass(eq=False)
class Body(Shaped):
    """A body: a closed triangulated surface of any shape, within which there is another rock, or none.

    Its shape is `vertices` (V, 3) float64 in model units with `triangles` (T, 3), or a file `mesh`.
    after: name of the surface that was the youngest when the body came; None: the youngest. property: library
    id of its rock (0: none). void: it takes rock away and leaves nothing. rock: name of the rock mass that it
    is in; None: all that have `after`.
    """

    kind = "body"
    name: str
    vertices: np.ndarray | None = None
    triangles: np.ndarray | None = None
    after: str | None = None
    property: int = 0
    void: bool = False
    rock: str | None = None
    mesh: str | Path | MeshFile | None = None
    shape_file: Path | None = field(default=None, repr=False, compare=False)
    source: Source | None = field(default=None, repr=False, compare=False, metadata=NOT_STORED)
