# SPDX-License-Identifier: GPL-3.0-or-later
"""A project: rock masses with their surfaces, oldest first, from files or from arrays."""

from __future__ import annotations

import builtins
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from ..base.stored_objects import NOT_STORED
from ..base.toml_table import Source
from ..base.units import METERS, MODEL_UNIT
from ..readers.point_input import companions
from ..readers.tables.interval_values import IntervalValues
from ..readers.tables.observations import Observations
from ..settings.crs import checked_crs
from ..settings.data_files import Boreholes, MapFile, MapLayer, MeshFile, ObservationFile, PointFile
from ..settings.dips import DIPS, DipFile, Dips, dip_file_of
from ..settings.meshers import DEFAULT_MESHER, MESHERS, edge_length_fault, triangles_fault
from ..settings.method_options import OptionRefused, without
from ..settings.methods import (
    CONTINUATION,
    CONTINUATION_OPTIONS,
    DEFAULT_METHOD,
    DEFAULT_OPTIONS,
    METHODS,
    OPTIONS,
    checked_options,
)
from ..settings.rules import DEFAULT_RULE, RULES
from ..settings.series_kinds import FIELD
from ..settings.setting import declared, described, settings_of
from .entry import Compared, Entry
from .library import Library
from .plan_input import files_of_sizes, is_several, layer_files, map_layer
from .series import Series
from .structure_entries import MESH, POINTS, Body, Fault, Shaped, library_id

PROJECT_FILE = "project.toml"  # of a project that is a folder
BASE_BLOCK = "base block"  # the name of the block on the base, where its surface gives it none
# The shapes of a surface on which a setting has an effect: not on a ready mesh, nor on a level set.
OF_SHEETS, OF_POINTS = ("sheet",), ("sheet", "level set")


def _labels(registry: Mapping[str, Any]) -> dict[str, tuple[str, str]]:
    return {name: (entry.label, entry.tip) for name, entry in registry.items()}


def _checked_unit(key: str, unit: Any) -> Any:
    if unit not in METERS:
        raise OptionRefused(f"unknown unit {unit!r}", key, f"there are {', '.join(METERS)}")
    return unit


@dataclass(eq=False)
class Surface(Shaped):
    """One bounding surface of the layers.

    Its shape is a ready triangulation - `vertices` (V, 3) float64 in model units with `triangles` (T, 3) of
    vertex numbers, or a file or MeshFile `mesh` - or scattered `points`, (P, 3), a file or a PointFile, which
    are interpolated on the planar mesh of the rock's region by `method` with its `options`. Some methods do
    without points; some also use its `dips`, a file, a DipFile or arrays. `left_out` (Q, 3) are points that
    are not used: those of its file, or its array, at these places, model units. With `minimum_thickness` an
    interpolated surface stays at least this far above the older one; with `true_thickness` this, and the
    thickness of the method "parallel", is perpendicular to the other surface; unless `tie` is false, it
    passes through its points and keeps its bounds also within triangles; if it is `observed`, no younger
    surface cuts below its points, as below picks and the points of a series; `correlation` is that of the
    errors of its heights with those of the older one, in ensembles. `series` is the name of the series that
    it belongs to; in one whose kind is "field" it has `points` alone, and is a level set of that field
    (Rock.is_level_set). `rule`: its effect on older rock (docs/reference/project_file.md). `property` is the
    library id of the block deposited beneath it (0: none), `block` that block's name. `shape_file` is the
    file that the arrays were read from, if any: messages name it. Points that are read are in the order of
    their coordinates; what follows from them and from field data is in RockInput.data.
    """

    kind = "surface"
    name: str = declared(kind="name", label="Name", tip="Name of the surface", is_needed=True)
    vertices: np.ndarray | None = None
    triangles: np.ndarray | None = None
    points: np.ndarray | str | Path | PointFile | None = described(POINTS)
    method: str | None = declared(
        DEFAULT_METHOD,
        kind="method",
        label="Method",
        tip="How elevations are interpolated from the points",
        words=_labels(METHODS),
        shapes=OF_SHEETS,
        absent=None,
    )
    options: dict = declared(
        kind="options",
        shapes=OF_SHEETS,
        parts=OPTIONS | {key: replace(OPTIONS[key], default=word) for key, word in DEFAULT_OPTIONS.items()},
        factory=dict,
    )
    rule: str = declared(
        DEFAULT_RULE,
        kind="word",
        label="Rule",
        tip="What the surface does to the rock that was there before",
        words=_labels(RULES),
        more="See [Rules](#rules)",
    )
    property: int = described(library_id("deposited beneath this surface"))
    block: str | None = declared(
        kind="text",
        label="Block",
        tip='Name of the block beneath this surface; empty: the name of the surface and "block"',
        more='The block on the base is "base block"',
    )
    mesh: str | Path | MeshFile | None = described(MESH)
    dips: Dips | DipFile | str | Path | None = described(replace(DIPS, shapes=OF_SHEETS))
    left_out: np.ndarray | Sequence | None = declared(kind="places", shapes=OF_POINTS)
    series: str | None = declared(
        kind="series",
        label="Series",
        tip="Name of the series that the surface belongs to; empty: none",
        more="See [Series](#series)",
    )
    minimum_thickness: float | None = declared(
        kind="length",
        label="Minimum Thickness",
        tip="Minimum distance above the next older surface",
        low=0.0,
        more="For interpolated surfaces; points that contradict it are listed",
        switch=("Thickness ≥", "Keep the surface at least this far above the next older one"),
        shapes=OF_SHEETS,
    )
    true_thickness: bool = declared(
        False,
        kind="truth",
        label="True Thickness",
        tip="Measure the minimum thickness, and the thickness of a parallel surface, perpendicular to "
        "the other surface, not vertically",
        more="Default `false`; see [true thickness](methods.md#true-thickness)",
        shapes=OF_SHEETS,
    )
    tie: bool = declared(
        True,
        kind="truth",
        label="Tie",
        tip="The surface passes through all its points, also within the triangles of the planar mesh",
        more="Default `true`, for interpolated surfaces; see [ties](methods.md#ties). `false` leaves the "
        "elevations as the method interpolates them",
        shapes=OF_POINTS,
    )
    observed: bool = declared(
        False,
        kind="truth",
        label="Observed",
        tip="The points were seen in the rock: no younger surface cuts below them",
        more="Default `false`; picks of boreholes and points of a [series](#series) always are. See "
        "[observed contacts](#observed-contacts)",
        shapes=OF_POINTS,
    )
    correlation: float | None = declared(
        label="Correlation",
        tip="Correlation of the errors of its elevations with those of the next older surface, in ensembles",
        low=-1.0,
        high=1.0,
        more="-1 to 1, for interpolated surfaces; see [ensembles](../ensembles.md)",
        switch=("Correlation", "In ensembles, draw its elevations with those of the next older surface"),
        shapes=OF_SHEETS,
    )
    shape_file: Path | None = field(default=None, repr=False, compare=False)
    source: Source | None = field(default=None, repr=False, compare=False, metadata=NOT_STORED)

    @builtins.property  # a field of this class is called property
    def has_points(self) -> bool:
        """Whether it is made from points, by a method that needs none, or from boreholes, as an interpolated
        surface or a level set. Else it is a ready mesh."""
        return self.points is not None or (
            self.mesh is None and self.vertices is None and self.triangles is None
        )

    @builtins.property  # a field of this class is called property
    def needs_points(self) -> bool:
        """Whether its method makes nothing without points. Raises OptionRefused."""
        method, settings = self.method_options()
        return METHODS[method].needs_points(settings)

    @builtins.property  # a field of this class is called property
    def has_thickness(self) -> bool:
        """Whether it keeps a thickness above another surface, or below it."""
        return self.minimum_thickness is not None or self.method == "parallel"

    @builtins.property  # a field of this class is called property
    def block_name(self) -> str:
        """The name of the block deposited beneath it."""
        return self.block or f"{self.name} block"

    @builtins.property  # a field of this class is called property
    def dip_file(self) -> DipFile | None:
        """The file of its dips and how it is read; None where they are arrays, or there are none."""
        return dip_file_of(self.dips)

    def method_options(self) -> tuple[str, dict]:
        """The method and its complete options; of a ready mesh those by which it is continued to faults.
        Raises OptionRefused."""
        if self.method is None and not self.has_points:
            return CONTINUATION, checked_options(CONTINUATION, {**CONTINUATION_OPTIONS, **self.options})
        if self.method is None:
            return DEFAULT_METHOD, checked_options(DEFAULT_METHOD, {**DEFAULT_OPTIONS, **self.options})
        return self.method, checked_options(self.method, self.options)


@dataclass(eq=False)
class Rock(Entry):
    """A rock mass: a region in plan, and surfaces oldest first.

    `region` is an outline (N, 2), a list of several, well-known text, or a file (GeoJSON, WKT, shapefile,
    GeoPackage) or a MapLayer of one; `holes` lie inside an outline of coordinates; the rings count even-odd.
    `boreholes` give points to every surface that is not a ready mesh, in addition to its own, and
    observations of blocks. Once they are read, `hole_picks` are the picks of each (Picks.holes), and
    `hole_ends` where it ends (Picks.ends), `hole_values` the curves of their logs (Picks.logs): for display
    only. `observations` are further places in a block: a file, an ObservationFile or Observations; once they
    are read, with those of the boreholes and of the `map`, polygons of blocks on the ground. `dips` are those
    of its beds, a file, a DipFile or arrays: each counts for the surfaces that are parallel to it. `names`
    gives the meaning of names in all of these: {"SST": "Sandstone"}, the name of a block, surface or body, or
    "" for none. `edge_length` (model units) is that of the planar mesh on which points are interpolated, or
    "auto": half the spacing of the points of the surfaces; `triangles` is the number of triangles instead.
    `mesher` and `size` (where edges are shorter) are as mesh_region takes them. `constraints` must be
    contained in the planar mesh: lines (N, 2), points [x, y], and files of them as of a region; `size` may be
    at what is in such files too. `terrain` is the boundary above all surfaces: the name of one of them, or a
    Surface, a file of heights (a raster, points or a mesh), a PointFile, a MeshFile, or points (P, 3). It
    becomes the youngest surface of the model; faults and bodies end at it unless they name it. With
    `base_elevation` there is a block between this elevation and the oldest surface. `series` are runs of
    surfaces that share their structure. `shape_file` is the file that the rings were read from, if any:
    messages name it.
    """

    kind = "rock"
    name: str = declared(kind="name", label="Name", tip="Name of the rock mass", is_needed=True)
    surfaces: list[Surface] = declared(kind="tables", key="surface", of=Surface, is_needed=True)
    region: np.ndarray | Sequence | str | Path | MapLayer | None = declared(kind="region", of=MapLayer)
    holes: Sequence = declared((), kind="rings")
    edge_length: float | str | None = declared(
        kind="length",
        label="Edge Length",
        tip="Edge length of the triangles on which surfaces are interpolated. Half the length gives four "
        "times as many triangles",
        low=0.0,
        check=without(edge_length_fault),
        zero_is_none=True,
        needed="if a surface has `points`, unless `triangles` is given",
        more="Points that lie much closer together become nodes of the mesh (see "
        '[ties](methods.md#ties)). `"auto"`: half the local spacing of the points of the surfaces',
    )
    triangles: int | None = declared(
        kind="whole",
        label="Triangles",
        tip="Number of triangles of the planar mesh, within 5 %",
        start=10_000,
        low=1,
        check=without(triangles_fault),
        more='Instead of `edge_length`; with `edge_length = "auto"` it scales the point spacing',
        switch=(
            "Scale to Triangles",
            "Scale the point spacing so that the mesh has a number of triangles",
        ),
    )
    mesher: str = declared(
        DEFAULT_MESHER,
        kind="word",
        label="Mesher",
        tip="Algorithm that divides the region into triangles",
        words=_labels(MESHERS),
        more="See [meshing](../dev/meshing.md)",
    )
    size: Sequence[Mapping] = declared((), kind="sizes", of=MapLayer)
    base_elevation: float | None = declared(
        kind="length",
        label="Base Elevation",
        tip="Elevation of the flat base of the oldest block; surfaces that reach below are cut off there",
        more="It adds a block beneath the oldest surface; see [Base](#base)",
        switch=("Base", "Add a block between the oldest surface and the base elevation"),
        switch_name="use_base",
    )
    constraints: Sequence = declared((), kind="constraints", of=MapLayer)
    boreholes: Boreholes | None = declared(
        kind="table_file", of=Boreholes, example='{ collars = "collars.csv", picks = "picks.csv" }'
    )
    observations: str | Path | ObservationFile | Observations | None = declared(
        kind="table_file", of=ObservationFile, example='"outcrops.csv"'
    )
    dips: Dips | DipFile | str | Path | None = described(DIPS)
    names: Mapping[str, str] = declared(kind="meanings", factory=dict)
    map: MapFile | None = declared(
        kind="table_file", of=MapFile, example='{ file = "geology.gpkg", block = "UNIT" }'
    )
    terrain: str | Path | PointFile | MeshFile | np.ndarray | Surface | None = declared(kind="ground")
    series: list[Series] = declared(kind="tables", of=Series, factory=list)
    hole_picks: Mapping = field(default_factory=dict, repr=False, compare=False)
    hole_ends: Mapping = field(default_factory=dict, repr=False, compare=False)
    hole_values: IntervalValues | None = field(default=None, repr=False, compare=False)
    shape_file: Path | None = field(default=None, repr=False, compare=False)
    source: Source | None = field(default=None, repr=False, compare=False, metadata=NOT_STORED)

    def is_level_set(self, surface: Surface) -> bool:
        """Whether one of its surfaces is a level set of a field, that of its series."""
        return any(series.kind == FIELD and series.name == surface.series for series in self.series)

    def is_interpolated(self, surface: Surface) -> bool:
        """Whether heights of one of its surfaces are made: it is neither a ready mesh nor a level set."""
        return surface.has_points and not self.is_level_set(surface)

    @property
    def has_fields(self) -> bool:
        """Whether some of its surfaces are level sets of a field."""
        return any(series.kind == FIELD for series in self.series)

    def members(self, series: Series) -> list[int]:
        """The numbers of the surfaces of a series."""
        return [number for number, surface in enumerate(self.surfaces) if surface.series == series.name]

    @property
    def observation_file(self) -> ObservationFile | None:
        """The table of its observations; None where they are arrays, or there are none."""
        table = self.observations
        if isinstance(table, (str, Path)):
            return ObservationFile(table)
        return table if isinstance(table, ObservationFile) else None

    @property
    def dip_file(self) -> DipFile | None:
        """The file of its dips and how it is read; None where they are arrays, or there are none."""
        return dip_file_of(self.dips)

    @property
    def dip_files(self) -> list[DipFile]:
        """The files of its dips, and of those of its series and its surfaces."""
        files = [self.dip_file, *(series.dip_file for series in self.series)]
        files += [surface.dip_file for surface in self.surfaces]
        return [file for file in files if file is not None]

    @property
    def has_field_data(self) -> bool:
        """Whether it has boreholes, observations or a map, which may give its surfaces contacts."""
        return any(source is not None for source in (self.boreholes, self.observations, self.map))

    @property
    def observed(self) -> Observations | None:
        """The observations of a rock mass that is read; None where there are none."""
        assert self.observation_file is None
        return self.observations if isinstance(self.observations, Observations) else None

    @property
    def ground_file(self) -> PointFile | MeshFile | str | Path | None:
        """The file that the ground of its map is read from; None where it is a surface of the rock mass, or
        there is no map."""
        ground = None if self.map is None else self.map.ground
        is_surface = isinstance(ground, str) and ground in [surface.name for surface in self.surfaces]
        return None if is_surface else ground

    @property
    def terrain_number(self) -> int | None:
        """The number of the surface that is its terrain; None where it has none, or it is no surface yet."""
        numbers = (at for at, surface in enumerate(self.surfaces) if surface.name == self.terrain_name)
        return next(numbers, None)

    @property
    def terrain_name(self) -> str | None:
        """The name of the surface that is its terrain; the same."""
        is_name = isinstance(self.terrain, str) and any(
            surface.name == self.terrain for surface in self.surfaces
        )
        return str(self.terrain) if is_name else None

    @property
    def youngest_in_rock(self) -> int:
        """The number of its youngest surface below the terrain, up to which faults displace it, and after
        which bodies came by default."""
        last = len(self.surfaces) - 1
        return last - 1 if last > 0 and self.terrain_number == last else last

    @property
    def ground_number(self) -> int | None:
        """The number of the surface that is the ground of its map; None without a map, or where none is."""
        if self.map is None:
            return None
        names, youngest = [surface.name for surface in self.surfaces], len(self.surfaces) - 1
        ground = self.ground_file
        if ground is None:
            return names.index(self.map.ground) if self.map.ground in names else youngest
        file = Path(ground.file if isinstance(ground, (PointFile, MeshFile)) else ground)
        surface_file = self.surfaces[-1].input_file
        return youngest if surface_file is None or Path(surface_file) == file else None

    @property
    def map_files(self) -> list[Path]:
        """The files of its map."""
        if self.map is None:
            return []
        files = [*layer_files(self.map.polygons), *layer_files(self.map.faults)]
        ground = self.ground_file
        if ground is not None:
            file = Path(ground.file if isinstance(ground, (PointFile, MeshFile)) else ground)
            files += [file, *companions(file)]
        return files

    @property
    def region_file(self) -> Path | None:
        """The file of its region; None where there is none."""
        layer = map_layer(self.region)
        return None if layer is None else Path(layer.file)

    def block_names(self) -> list[str]:
        """The names of the blocks beneath its surfaces, the first that of the block on the base."""
        oldest = [surface.block or BASE_BLOCK for surface in self.surfaces[:1]]
        return [*oldest, *(surface.block_name for surface in self.surfaces[1:])]

    def rings(self) -> list[np.ndarray]:
        """The rings (N, 2) of a region of arrays, outlines and holes alike; they count even-odd."""
        assert self.region is not None and not isinstance(self.region, (str, Path, MapLayer))
        outlines = self.region if is_several(self.region) else [self.region]
        return [np.asarray(ring, float) for ring in (*outlines, *self.holes)]

    def stage(self, m: int) -> Rock:
        """The rock mass with the surfaces up to m, and the series that these belong to."""
        surfaces = self.surfaces[: m + 1]
        names = {surface.series for surface in surfaces}
        series = [series for series in self.series if series.name in names]
        is_above = self.terrain_number is not None and self.terrain_number > m
        return replace(self, surfaces=surfaces, series=series, terrain=None if is_above else self.terrain)

    @property
    def interpolates(self) -> bool:
        """Whether any of its surfaces is interpolated."""
        return any(map(self.is_interpolated, self.surfaces))


@dataclass(eq=False)
class Project(Compared):
    """Rock masses that make one model, the faults and bodies in them, and the library of their properties.

    name: of the model. rocks: its rock masses. path: the project file, if it was read from one.
    units: of the model's lengths, which files in other units are brought to. Where bodies overlap, the later
    one counts. crs: the code of its coordinate reference system, "EPSG:25832", which files that have a place
    for it name.
    """

    save: ClassVar[Callable[..., Path]]  # set by project_writer, which knows projects
    stereonet: ClassVar[Callable[..., Any]]  # likewise by model/stereonets

    name: str = declared(kind="name", is_needed=True)
    rocks: list[Rock] = declared(kind="tables", key="rock", of=Rock, is_needed=True)
    library: Library | None = declared(kind="library")
    path: Path | None = None
    units: str = declared(MODEL_UNIT, kind="line", check=_checked_unit)
    faults: list[Fault] = declared(kind="tables", key="fault", of=Fault, factory=list)
    bodies: list[Body] = declared(kind="tables", key="body", of=Body, factory=list)
    crs: str | None = declared(
        kind="text",
        label="CRS",
        tip="Coordinate reference system of the model by its code, such as EPSG:25832; empty: not known",
        check=checked_crs,
        more="A projected system, in the unit of the model. Coordinates are not converted. IFC, GeoJSON, "
        "geoh5, OMF and RESQML files name it; GeoTIFF and GeoPackage files name EPSG codes only",
    )

    def input_files(self) -> list[Path]:
        """Every file that this project reads, itself included."""
        files = [self.path, self.library.path if self.library else None]
        for rock in self.rocks:
            files += [*layer_files(rock.region), *(surface.input_file for surface in rock.surfaces)]
            files += [file for constraint in rock.constraints for file in layer_files(constraint)]
            files += files_of_sizes(rock.size)
            files += rock.boreholes.files if rock.boreholes is not None else []
            files += [Path(rock.observation_file.file)] if rock.observation_file is not None else []
            files += rock.map_files
            files += [Path(dip_file.file) for dip_file in rock.dip_files]
            for point_file in (surface.point_file for surface in rock.surfaces):
                files += [] if point_file is None else companions(Path(point_file.file))
        for entry in (*self.faults, *self.bodies):
            if entry.input_file is not None:
                files += [entry.input_file, *companions(entry.input_file)]
        return [Path(file) for file in files if file is not None]

    def names_of_units(self, rock: Rock) -> list[str]:
        """What a name in a table of a rock mass may mean: its blocks and surfaces, and the bodies."""
        surfaces = [surface.name for surface in rock.surfaces]
        return list(dict.fromkeys([*rock.block_names(), *surfaces, *(body.name for body in self.bodies)]))

    def stage(self, m: int) -> Project:
        """This project as it was just after surface m of each rock mass: only the surfaces up to it."""
        rocks = [rock.stage(m) for rock in self.rocks]
        for rock in rocks:
            unit_names = self.names_of_units(rock)
            rock.names = {code: name if name in unit_names else "" for code, name in rock.names.items()}
        return replace(self, rocks=rocks)


def surface_item(rock: Rock, surface: Surface) -> str:
    """The name of a surface in messages; of rows of the panel, too."""
    return f"rock '{rock.name}', surface '{surface.name}'"


SURFACE = settings_of(Surface)
ROCK = settings_of(Rock)
PROJECT = settings_of(Project)
