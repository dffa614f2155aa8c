# SPDX-License-Identifier: GPL-3.0-or-later
"""One surface of a project, read: its points or its ready mesh, from a file or from arrays."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterable, Iterator, Mapping, Sized
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..base.algebra import are_among, ascending
from ..base.errors import naming
from ..base.mapped_arrays import ROWS_AT_ONCE, JoinPieces, MappedArrays, in_memory, in_pieces
from ..base.text import Step, no_step
from ..base.triangles import Sheet, checked_triangulation
from ..base.work import Work
from ..heights.interpolate import checked_points
from ..project.project import Rock, Surface, surface_item
from ..readers import read_dips, read_mesh, read_point_file
from ..readers.tables.boreholes import Pick, picks_of
from ..settings.dips import Dips
from .observed.surface_data import Sources, SurfaceData
from .rock_input import RockInput


@dataclass(frozen=True)
class ReadSurface:
    """surface: with arrays instead of files. data: its own data, and picks. shape: the triangulation of a
    ready mesh, else None. faces: (T,) the face of its file that each triangle belongs to, None where these
    are equal. warnings: sentences."""

    surface: Surface
    data: SurfaceData
    shape: Sheet | None
    faces: np.ndarray | None
    warnings: list[str]

    def with_arrays(self, change: Callable[[Any], Any]) -> ReadSurface:
        """The same, with `change` of each array in its place: a reference to it (MappedArrays.place), or
        the array of such a reference."""
        surface, shape = self.surface, self.shape
        faces = None if self.faces is None else change(self.faces)
        if shape is None:
            rows = None if self.data.rows is None else change(self.data.rows)
            data = replace(self.data, points=change(self.data.points), rows=rows)
            points = None if surface.points is None else data.points
            return replace(self, surface=replace(surface, points=points), data=data, faces=faces)
        vertices, triangles = map(change, shape)
        surface = replace(surface, vertices=vertices, triangles=triangles)
        return replace(self, surface=surface, shape=Sheet(vertices, triangles), faces=faces)


@dataclass(frozen=True)
class SurfaceInput:
    """A surface before it is read, with all that reading it needs: another process may read it. rock: the
    name of its rock mass; boreholes: the last file of boreholes, or that of observations or of a map, if
    any; met: the picks of boreholes that are no points of it yet; picks: those that are."""

    rock: str
    surface: Surface
    boreholes: Path | None
    met: list[Pick] | None
    picks: list[Pick]
    units: str

    @classmethod
    def of(cls, rock: Rock, surface: Surface, units: str, met: list[Pick] | None = None) -> SurfaceInput:
        boreholes = None if rock.boreholes is None else rock.boreholes.files[-1]
        if boreholes is None and rock.observation_file is not None:
            boreholes = Path(rock.observation_file.file)
        if boreholes is None and rock.map is not None:
            boreholes = Path(rock.map.file)
        return cls(rock.name, surface, boreholes, met, picks_of(rock.hole_picks, surface.name), units)

    def read(self, step: Step = no_step, arrays: MappedArrays | None = None) -> ReadSurface:
        """arrays: where those that come from files are kept; None: in memory. Raises InputRefused, naming the
        surface."""
        surface = self.surface
        file = surface.input_file or surface.shape_file
        if file is None and surface.points is None:
            file = self.boreholes
        with naming(surface_item(Rock(self.rock, []), surface)):
            if surface.has_points:
                points, warnings = self._points(step, in_memory if arrays is None else arrays.gather)
                data = self._in_order(points, arrays)
                surface_points, dips = data.points if len(points) else None, self._dips(step)
                read = replace(surface, points=surface_points, dips=dips, shape_file=file)
                used = None if dips is None else dips.used_only()
                return ReadSurface(read, replace(data, dips=used), None, None, warnings)
            vertices, triangles, faces, warnings = self._mesh(step, arrays)
        surface = replace(surface, vertices=vertices, triangles=triangles, mesh=None, shape_file=file)
        return ReadSurface(surface, SurfaceData(), Sheet(vertices, triangles), faces, warnings)

    def _points(self, step: Step, gather: JoinPieces) -> tuple[np.ndarray, list[str]]:
        surface = self.surface
        points: Any = surface.points
        warnings: list[str] = []
        if surface.point_file is not None:
            points, warnings = read_point_file(surface.point_file, self.units, step, gather)
        if points is not None and surface.left_out is not None and len(surface.left_out):
            points = gather(_without(in_pieces(checked_points(points)), surface.left_out), np.empty((0, 3)))
            points = points if len(points) else None
        if self.met is not None:
            surface_points = np.empty((0, 3)) if points is None else checked_points(points)
            points = gather(
                (*in_pieces(surface_points), np.array([place for _, place in self.met])), np.empty((0, 3))
            )
        if points is None or (isinstance(points, Sized) and not len(points)):
            return np.empty((0, 3)), warnings
        checked = checked_points(points)
        # checked_points may return another array with the same values
        is_kept = surface.point_file is not None or self.met is not None
        return points if is_kept and isinstance(points, np.ndarray) else checked, warnings

    def _in_order(self, points: np.ndarray, arrays: MappedArrays | None) -> SurfaceData:
        """The points (P, 3) in the order of their coordinates. The order of rows must not decide a result."""
        count = len(points)
        order = ascending(*points.T) if arrays is None else arrays.ascending(points)
        every = (
            np.arange(first, min(first + ROWS_AT_ONCE, count)) for first in range(0, count, ROWS_AT_ONCE)
        )
        rows = None
        if not all(map(np.array_equal, in_pieces(order), every)):
            gather, rows = in_memory if arrays is None else arrays.gather, order
            points = gather((points[piece] for piece in in_pieces(order)), np.empty((0, 3)))
        if self.met is None:
            return SurfaceData(points, count, _sources_among(points, self.picks), rows=rows)
        first = count - len(self.met)
        at = np.flatnonzero(order >= first).tolist()
        return SurfaceData(points, count, {row: (self.met[order[row] - first][0],) for row in at}, rows=rows)

    def _dips(self, step: Step) -> Dips | None:
        file = self.surface.dip_file
        dips = self.surface.dips if file is None else read_dips(file, self.units, step)
        assert dips is None or isinstance(dips, Dips)
        return None if dips is None else dips.checked()

    def _mesh(
        self, step: Step, arrays: MappedArrays | None
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray | None, list[str]]:
        surface = self.surface
        if surface.mesh_file is None:
            return *checked_triangulation(*surface.triangulation()), None, []
        if arrays is None:
            mesh = read_mesh(surface.mesh_file, step)
            vertices, warnings = mesh.in_model(surface.mesh_file, self.units)
        else:
            mesh = read_mesh(surface.mesh_file, step, arrays.rows)
            vertices, warnings = mesh.in_model(surface.mesh_file, self.units, arrays.gather)
        return vertices, mesh.triangles, mesh.face_of_triangle, warnings


def _sources_among(points: np.ndarray, picks: list[Pick]) -> Sources:
    """The sources of the picks that are among points (P, 3), as of arrays that were read before; each is of a
    point of its own where several lie at one place."""
    rows: dict[tuple, list[int]] = {}
    for row in np.flatnonzero(np.isin(points[:, 0], [place[0] for _, place in picks])).tolist():
        rows.setdefault(tuple(points[row].tolist()), []).append(row)
    sources: Sources = {}
    for source, place in picks:
        if here := rows.get(tuple(map(float, place))):
            row = here.pop(0) if len(here) > 1 else here[0]
            sources[row] = (*sources.get(row, ()), source)
    return sources


def _without(pieces: Iterable[np.ndarray], left_out: ArrayLike) -> Iterator[np.ndarray]:
    """Pieces (P, 3) of points without those at places (Q, 3)."""
    places = np.asarray(left_out, np.float64).reshape(-1, 3)
    for piece in pieces:
        yield piece[~are_among(piece, places)]


# Reads surfaces in any order: pairs of number and surface. It reports its progress to the Work.
Reader = Callable[[Work, list[SurfaceInput]], Iterable[tuple[int, ReadSurface]]]


def read_each(work: Work, surfaces: list[SurfaceInput]) -> Iterator[tuple[int, ReadSurface]]:
    """Reads surfaces one after another."""
    for number, surface in enumerate(surfaces):

        def step(share: float, number: int = number) -> None:
            work.step((number + share) / len(surfaces))

        yield number, surface.read(step)
        work.step((number + 1) / len(surfaces))


_ARRAYS = ("vertices", "triangles", "vertex_offsets", "triangle_offsets")


@dataclass(frozen=True, eq=False)
class SurfaceArrays:
    """The arrays `surface_...` of docs/dev/geometry.md, under the same names, put together when they are
    asked for: vertices (Vs, 3) float64, triangles (Ts, 3) int32, which index within their own surface,
    vertex_offsets and triangle_offsets (S + 1,) int64. shapes: of each surface."""

    shapes: list[Sheet]

    @cached_property
    def vertices(self) -> np.ndarray:
        return np.concatenate([np.empty((0, 3)), *(vertices for vertices, _ in self.shapes)])

    @cached_property
    def triangles(self) -> np.ndarray:
        return np.concatenate([np.empty((0, 3), np.int32), *(triangles for _, triangles in self.shapes)])

    @cached_property
    def vertex_offsets(self) -> np.ndarray:
        return np.cumsum([0, *(len(vertices) for vertices, _ in self.shapes)], dtype=np.int64)

    @cached_property
    def triangle_offsets(self) -> np.ndarray:
        return np.cumsum([0, *(len(triangles) for _, triangles in self.shapes)], dtype=np.int64)

    @classmethod
    def of_arrays(cls, arrays: Mapping[str, np.ndarray]) -> SurfaceArrays:
        """Of the arrays of a file, which are not put together again."""
        stored_arrays = {name: arrays[f"surface_{name}"] for name in _ARRAYS}
        vertices, triangles = (
            [
                stored_arrays[name][begin:end]
                for begin, end in itertools.pairwise(stored_arrays[f"{one}_offsets"].tolist())
            ]
            for name, one in (("vertices", "vertex"), ("triangles", "triangle"))
        )
        surface_arrays = cls([Sheet(*pair) for pair in zip(vertices, triangles, strict=True)])
        vars(surface_arrays).update(stored_arrays)
        return surface_arrays


def triangle_sheets(inputs: list[RockInput]) -> np.ndarray:
    """(Ts,) int32: of each triangle of all surfaces the sheet of its surface that it is of, from 0; a surface
    that no fault displaces has one."""
    numbers = [np.zeros(0, np.int64)]
    for entry, number in by_rock(inputs):
        sizes = _sizes(entry, number)
        numbers.append(np.repeat(np.arange(len(sizes)), sizes))
    return np.concatenate(numbers).astype(np.int32)


def sheet_sizes(inputs: list[RockInput], number: int) -> list[int]:
    """How many triangles the sheets of one surface have, by its global index: they are its own one sheet
    after another."""
    return _sizes(*by_rock(inputs)[number])


def by_rock(inputs: list[RockInput]) -> list[tuple[RockInput, int]]:
    """Of each surface, by its global index, its rock mass and its number there."""
    return [(entry, number) for entry in inputs for number in range(len(entry.surfaces))]


def _sizes(entry: RockInput, number: int) -> list[int]:
    return [len(triangles) for _, triangles in entry.divided().distinct(number)]


def vertex_attributes(inputs: list[RockInput], number: int, vertices: np.ndarray) -> dict[str, np.ndarray]:
    """The attributes (V,) of the vertices of one surface, by its global index: `height`; `variance` and
    `distance`, NaN where there are none."""
    interfaces = [entry.attributes.get(k, {}) for entry, k in by_rock(inputs)]
    attributes = interfaces[number] if number < len(interfaces) else {}  # faults and bodies have none
    unknown = np.full(len(vertices), np.nan)
    return {
        "height": vertices[:, 2].copy(),
        "variance": attributes.get("variance", unknown),
        "distance": attributes.get("distance", unknown),
    }
