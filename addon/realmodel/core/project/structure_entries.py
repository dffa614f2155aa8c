# SPDX-License-Identifier: GPL-3.0-or-later
"""The entries of faults and bodies in a project."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from ..base.stored_objects import NOT_STORED
from ..base.toml_table import Source
from ..settings.data_files import MeshFile, PointFile, is_wkt
from ..settings.dips import DIPS, DipFile, SpaceDips, dip_file_of
from ..settings.directions import checked_direction
from ..settings.method_options import OptionRefused, surface
from ..settings.setting import Setting, declared, described, settings_of
from .entry import Entry

POINTS = Setting(kind="points", of=PointFile)
MESH = Setting(kind="mesh", of=MeshFile)
OF_TRACES = ("trace",)
OF_INTERVALS = ("intervals",)


def library_id(of: str) -> Setting:
    """The number in the library of the rock of something."""
    return Setting(
        0,
        kind="whole",
        label="Property",
        tip=f"Library ID of the rock {of}; 0: none",
        name="property_id",
        more="See [Library](#library)",
    )


def _checked_stick(key: str, column: Any) -> Any:
    if column is not None and (isinstance(column, bool) or not isinstance(column, (str, int))):
        raise OptionRefused(f"'{key}' must be a column, by name or by number from 1, not {column!r}", key)
    return column


def _checked_elevation(key: str, elevation: Any) -> Any:
    if np.ndim(elevation):
        raise OptionRefused(f"'{key}' must be a number or the name of a surface", key)
    return None if elevation is None else surface(key, elevation)


def _checked_names(key: str, names: Any) -> tuple[str, ...]:
    is_list = isinstance(names, Sequence) and not isinstance(names, str)
    if not is_list or not all(isinstance(name, str) for name in names):
        raise OptionRefused(f"'{key}' must be a list of names, not {names!r}", key, f'write {key} = ["..."]')
    return tuple(names)


def _names(label: str) -> Setting:
    return Setting((), kind="names", label=label, check=_checked_names)


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
    def has_shape(self) -> bool:
        """Whether it has a mesh. A body without one is made of the intervals of boreholes."""
        return self.vertices is not None or self.mesh is not None

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
        file = self.mesh_file or self.point_file or getattr(self, "trace_file", None)
        return None if file is None else Path(file.file)


@dataclass(eq=False)
class Fault(Shaped):
    """A fault: an open triangulated surface in any position, that displaces surfaces.

    Its shape is a mesh - `vertices` (V, 3) float64 in model units with `triangles` (T, 3), or a file `mesh` -
    or `points` through which a surface is fitted: scattered (P, 3), sticks as a list of arrays (N, 3), or a
    file of either (.pol, or a table; `stick` names the column of the sticks' names); scattered ones may have
    `dips`, a file, a DipFile or SpaceDips, of which the fitted surface has the attitudes: with one of them a
    single point is enough. `extend`: how far the mesh is continued beyond its border, or the fitted surface
    beyond its points, model units.

    Or its shape is a `trace`, its line on the ground, with a `dip` in degrees below the horizontal: points
    (N, 2) or (N, 3), several such lines, well-known text, or a file or PointFile of lines. `dip_direction`:
    degrees clockwise from north (+y), or "N", "NE", ... for the side of the trace; not needed where it is
    vertical. Files may have both as attributes. `elevation` of the line: a number, or the name of the surface
    that it is on; None: z of the line (NaN: none), else it is on the youngest surface. The fault continues
    straight at both ends, through the rock; with `extend`, or where it dies out, only so far.

    youngest: name of the youngest surface that it displaces; None: all of them. ends_at: names of faults at
    which it ends; the smaller part of it beyond is dropped. dies_out: it ends inside the rock, where its
    displacement is 0. rocks: names of the rock masses that it displaces; none: all that have `youngest`.
    """

    kind = "fault"
    name: str = declared(kind="name", label="Name", tip="Name of the fault", is_needed=True)
    vertices: np.ndarray | None = None
    triangles: np.ndarray | None = None
    youngest: str | None = declared(
        kind="any_surface",
        label="Youngest",
        tip="Youngest surface that the fault displaces; empty: all surfaces",
        more="Younger surfaces ignore the fault",
    )
    ends_at: Sequence[str] = described(_names("Ends At"))
    dies_out: bool = declared(
        False,
        kind="truth",
        label="Dies Out",
        tip="The fault ends inside the rock; its displacement vanishes there",
        more="Default `false`: its border must lie outside the rock that it displaces",
    )
    rocks: Sequence[str] = described(_names("Rock Masses"))
    points: np.ndarray | Sequence[np.ndarray] | str | Path | PointFile | None = described(POINTS)
    stick: str | int | None = declared(
        kind="column",
        label="Stick Column",
        tip="Column of a table that numbers or names the fault sticks",
        more="Without it, and without a column named `stick`, the points are scattered",
        check=_checked_stick,
        shapes=("points",),
    )
    dips: SpaceDips | DipFile | str | Path | None = described(replace(DIPS, shapes=("points",)))
    extend: float = declared(
        0.0,
        kind="length",
        label="Extend",
        tip="Distance by which the mesh continues beyond its border, the fitted surface beyond its "
        "points, or the trace beyond its ends",
        low=0.0,
        more="In its own plane; of a fault that dies out up and down the dip only, of its trace along "
        "that. Default 0; a trace goes through the rock then, unless the fault dies out",
    )
    mesh: str | Path | MeshFile | None = described(MESH)
    trace: np.ndarray | Sequence[np.ndarray] | str | Path | PointFile | None = declared(
        kind="trace", of=PointFile
    )
    dip: float | None = declared(
        label="Dip",
        tip="Angle below the horizontal, in degrees; 0: the attribute of the file",
        low=0.0,
        high=90.0,
        above=0.0,
        zero_is_none=True,
        shapes=OF_TRACES,
    )
    dip_direction: float | str | None = declared(
        kind="direction",
        label="Dip Direction",
        tip="Degrees clockwise from north (+Y), or the side of the trace: N, NE, E, ... Not needed for a "
        "vertical fault",
        check=checked_direction,
        shapes=OF_TRACES,
    )
    elevation: float | str | None = declared(
        kind="surface",
        label="Elevation",
        tip="Elevation of the trace, or the surface that it is on. Empty: z of the trace, or the "
        "youngest surface where it has none",
        check=_checked_elevation,
        shapes=OF_TRACES,
    )
    traced: Fault | None = field(default=None, repr=False, compare=False)  # as it was, with the line as read
    shape_file: Path | None = field(default=None, repr=False, compare=False)
    source: Source | None = field(default=None, repr=False, compare=False, metadata=NOT_STORED)

    @property
    def shape_kind(self) -> str:
        """The kind of its shape, "trace", "points" or "mesh", by which settings have an effect."""
        return "trace" if self.trace is not None else "points" if self.points is not None else "mesh"

    @property
    def dip_file(self) -> DipFile | None:
        """The file of its dips and how it is read; None where they are arrays, or there are none."""
        return None if isinstance(self.dips, SpaceDips) else dip_file_of(self.dips)

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

    Its shape is `vertices` (V, 3) float64 in model units with `triangles` (T, 3), or a file `mesh`. Without
    one it is made from the intervals of boreholes with its name, and extends `reach` beyond them (None: half
    the distance of neighboring holes). after: name of the surface that was the youngest when the body came;
    None: the youngest. property: library id of its rock (0: none). void: it removes rock and leaves nothing.
    rock: name of the rock mass that it is in; None: all that have `after`.
    """

    kind = "body"
    name: str = declared(kind="name", label="Name", tip="Name of the body, and of its block", is_needed=True)
    vertices: np.ndarray | None = None
    triangles: np.ndarray | None = None
    after: str | None = declared(
        kind="any_surface",
        label="After",
        tip="Surface after which the body came; empty: the youngest",
        more="Younger surfaces erode and bury the body",
    )
    property: int = described(library_id("of the body"))
    void: bool = declared(
        False,
        kind="truth",
        label="Void",
        tip="The body takes rock away and leaves nothing, as a tunnel does",
        more="Default `false`",
    )
    rock: str | None = declared(
        kind="rock_mass",
        label="Rock Mass",
        tip="Rock mass that the body is in; empty: all",
        more="Default: all that have the surface `after`",
    )
    mesh: str | Path | MeshFile | None = described(MESH)
    reach: float | None = declared(
        kind="length",
        label="Reach",
        tip="How far a body from intervals goes beyond its holes, where no other hole ends it; 0: half the "
        "distance of neighboring holes",
        low=0.0,
        above=0.0,
        zero_is_none=True,
        more="See [bodies from intervals](#bodies-from-intervals)",
        shapes=OF_INTERVALS,
    )
    shape_file: Path | None = field(default=None, repr=False, compare=False)
    source: Source | None = field(default=None, repr=False, compare=False, metadata=NOT_STORED)


FAULT = settings_of(Fault)
BODY = settings_of(Body)
