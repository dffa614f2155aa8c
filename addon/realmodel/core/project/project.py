# SPDX-License-Identifier: GPL-3.0-or-later
"""A project: rock masses with their surfaces, oldest first, from files or from arrays, and its checks."""

from __future__ import annotations

import builtins
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path

import numpy as np

from ..base.algebra import are_among
from ..base.errors import InputRefused
from ..base.stored_objects import NOT_STORED
from ..base.toml_table import Source
from ..base.units import METERS, MODEL_UNIT
from ..readers.point_input import companions
from ..readers.tables.observations import Bounds, Observations, along_bounds
from ..settings.boreholes import Boreholes
from ..settings.crs import checked_crs
from ..settings.dips import DipFile, Dips, dip_file_of
from ..settings.map_file import MapFile
from ..settings.map_layer import MapLayer
from ..settings.mesh_sizes import AUTO, local_lengths
from ..settings.meshers import DEFAULT_MESHER
from ..settings.method_options import OptionRefused, is_name
from ..settings.methods import (
    CONTINUATION,
    CONTINUATION_OPTIONS,
    DEFAULT_METHOD,
    METHODS,
    SURFACE_OPTIONS,
    check_method,
    check_uses_dips,
    checked_options,
)
from ..settings.observation_file import ObservationFile
from ..settings.point_file import MeshFile, PointFile
from ..settings.rules import DEFAULT_RULE
from ..settings.schema import ROCK, SURFACE
from .entry import (
    Entry,
    check_file,
    check_property,
    check_values,
    named_once,
    refused_by,
    shapes_given,
)
from .field_checks import check_field_data, files_of_map, names_of_units
from .library import Library
from .plan_input import check_layer, files_of_sizes, is_place_elsewhere, layer_files, map_layer
from .region_rings import is_several
from .series import Series, check_level_set, check_names_series, check_series, mark_level_sets
from .structure_checks import check_structures
from .structure_entries import Body, Fault, Shaped

MOST_CONTACTS = 10_000  # points of a surface; more are a survey, which a mesh need not resolve
BASE_BLOCK = "base block"  # the name of the block on the base, where its surface gives it none


@dataclass
class Surface(Shaped):
    """One bounding surface of the layers.

    Its shape is a ready triangulation - `vertices` (V, 3) float64 in model units with `triangles`
    (T, 3) of vertex numbers, or a file or MeshFile `mesh` - or scattered `points`, (P, 3), a file or a
    PointFile, which are interpolated on the planar mesh of the rock's region by `method` with its `options`.
    Some methods do without points; some also use its `dips`, a file, a DipFile or arrays. `left_out` (Q, 3)
    are points that are not used: those of its file, or its array, at these places, model units. With
    `minimum_thickness` an interpolated surface stays so far above the
    older one; with `true_thickness` this, and the thickness of the method "parallel", is perpendicular to the
    other surface; unless `tie` is false, it passes through its points and keeps its bounds also
    within triangles; `correlation` is that of the errors of its heights with those of the older one, in
    ensembles.
    `series` is the name of the series that it belongs to; in one whose kind is "field" it has `points` alone,
    and is a level set of that field (`is_level_set`, which its rock mass says).
    `rule` says what it does to older rock (docs/reference/project_file.md). `property` is the library id of
    the block deposited beneath it (0: none), `block` that block's name.
    `rock_dips` are dips of its rock mass that count for it, and
    `contacts` are those of its points that follow from observations of its rock mass, and `bounds` the
    heights that it lies at or above, or at or below; all are found when a project is read, and no input.
    `shape_file` is the file that the arrays were read from, if any: messages name it.
    """

    kind = "surface"
    name: str
    vertices: np.ndarray | None = None
    triangles: np.ndarray | None = None
    points: np.ndarray | str | Path | PointFile | None = None
    method: str | None = None
    options: dict = field(default_factory=dict)
    rule: str = DEFAULT_RULE
    property: int = 0
    block: str | None = None
    mesh: str | Path | MeshFile | None = None
    dips: Dips | DipFile | str | Path | None = None
    left_out: np.ndarray | Sequence | None = None
    series: str | None = None
    minimum_thickness: float | None = None
    true_thickness: bool = False
    tie: bool = True
    correlation: float | None = None
    rock_dips: Dips | None = field(default=None, repr=False, compare=False)
    contacts: np.ndarray | None = field(default=None, repr=False, compare=False)
    bounds: Bounds | None = field(default=None, repr=False, compare=False)
    is_level_set: bool = field(default=False, repr=False, compare=False)
    shape_file: Path | None = field(default=None, repr=False, compare=False)
    source: Source | None = field(default=None, repr=False, compare=False, metadata=NOT_STORED)

    @builtins.property  # a field of this class is called property
    def interpolated(self) -> bool:
        """Whether its heights are made: from points, by a method that needs none, or from boreholes."""
        return not self.is_level_set and (
            self.points is not None
            or (self.mesh is None and self.vertices is None and self.triangles is None)
        )

    @builtins.property  # a field of this class is called property
    def has_points(self) -> bool:
        """Whether it is made from points: it is interpolated, or a level set. Else it is a ready mesh."""
        return self.interpolated or self.is_level_set

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
    def ties(self) -> bool:
        """Whether a surface that is read is made to pass through its contacts and to keep its bounds."""
        return self.tie and self.interpolated

    @builtins.property  # a field of this class is called property
    def tied_points(self) -> np.ndarray:
        """(C, 3) the points that a surface which ties passes through: all, but none of a grid or of so many
        that they are a survey of the surface. Both are finer than a planar mesh should be."""
        points = self.point_array()
        if METHODS[self.method_options()[0]].has_contacts and len(points) <= MOST_CONTACTS:
            return points
        return points[:0]

    @builtins.property  # a field of this class is called property
    def is_along_bounds(self) -> bool:
        """Whether no contact is known of a sheet, and its points are places on its bounds."""
        if self.is_level_set or not self.has_bounds or self.contacts is None or not len(self.contacts):
            return False
        assert self.bounds is not None
        return self.own_points() is None and np.array_equal(self.contacts, along_bounds(self.bounds))

    @builtins.property  # a field of this class is called property
    def block_name(self) -> str:
        """The name of the block deposited beneath it."""
        return self.block or f"{self.name} block"

    def point_array(self) -> np.ndarray:
        """(P, 3) float64 the points of a surface that is read; none where it has none."""
        assert not isinstance(self.points, (str, Path, PointFile))
        return np.empty((0, 3)) if self.points is None else np.asanyarray(self.points, np.float64)

    @builtins.property  # a field of this class is called property
    def dip_file(self) -> DipFile | None:
        """The file of its dips and how it is read; None where they are arrays, or there are none."""
        return dip_file_of(self.dips)

    def known_points(self) -> np.ndarray:
        """(P, 3) the points that are known to be on a surface that is read: not places on its bounds."""
        points = self.point_array()
        return points[:0] if self.is_along_bounds else points

    def own_dips(self) -> Dips | None:
        """The dips of a surface that is read, without those of its rock mass."""
        assert self.dips is None or isinstance(self.dips, Dips)
        return self.dips

    def known_dips(self) -> Dips | None:
        """All dips that count for a surface that is read: none of them is switched off."""
        given = [each.used_only() for each in (self.own_dips(), self.rock_dips) if each is not None]
        parts = [each for each in given if each is not None]
        return Dips.joined(parts) if len(parts) > 1 else next(iter(parts), None)

    @builtins.property  # a field of this class is called property
    def has_bounds(self) -> bool:
        """Whether heights are known that it lies above or below."""
        return self.bounds is not None and len(self.bounds) > 0

    def contact_array(self) -> np.ndarray:
        """(C, 3) float64 its contacts; none where it has none."""
        return np.empty((0, 3)) if self.contacts is None else self.contacts

    def own_points(self) -> np.ndarray | None:
        """(P, 3) the points of a surface that is read without its contacts; None where it has no others."""
        points, contacts = self.point_array(), self.contact_array()
        count = len(points) - len(contacts)
        if np.array_equal(points[max(count, 0) :], contacts):  # as they are added
            own = points[:count]
        else:
            own = points[~are_among(points, contacts)]
        return own if len(own) else None

    def method_options(self) -> tuple[str, dict]:
        """The method and its complete options; of a ready mesh those by which it is continued to faults.
        Raises OptionRefused."""
        if self.method is None and not self.interpolated:
            return CONTINUATION, checked_options(CONTINUATION, {**CONTINUATION_OPTIONS, **self.options})
        method = self.method or DEFAULT_METHOD
        return method, checked_options(method, self.options)


@dataclass
class Rock(Entry):
    """A rock mass: a region in plan, and surfaces oldest first.

    `region` is an outline (N, 2), a list of several, well-known text, or a file (GeoJSON, WKT, shapefile,
    GeoPackage) or a MapLayer of one; `holes` lie inside an outline of coordinates; the rings count even-odd.
    `boreholes` give points to every surface that is not a ready mesh, beside its own, and observations of
    blocks; `hole_picks` is what each of them met once they are read (Picks.holes), and `hole_ends` where it
    ends (Picks.ends): for display, no input.
    `observations` are further places that lie in a block, a file, an ObservationFile or Observations; once
    they are read, with those of the boreholes and of the `map`, polygons of blocks on the ground. `dips` are
    those of its beds, a file, a DipFile or arrays: each counts for the surfaces that are parallel to it.
    `names` says what a name in all of these means: {"SST": "Sandstone"}, the name of a block, surface
    or body, or "" for nothing.
    `edge_length` (model units) is that of the planar mesh on which points are interpolated, or
    "auto": half as long as the points of the surfaces are apart; `triangles` is how many there should be
    instead. `mesher` and `size` (where edges are shorter) are as mesh_region takes them.
    `constraints` are what the planar mesh must contain beside: lines (N, 2), points [x, y], and files of them
    as of a region; `size` may be at what is in such files too.
    With `base_elevation` there is a block between this height and the oldest surface.
    `series` are runs of surfaces that share their structure.
    `shape_file` is the file that the rings were read from, if any: messages name it.
    """

    kind = "rock"
    name: str
    surfaces: list[Surface]
    region: np.ndarray | Sequence | str | Path | MapLayer | None = None
    holes: Sequence = ()
    edge_length: float | str | None = None
    triangles: int | None = None
    mesher: str = DEFAULT_MESHER
    size: Sequence[Mapping] = ()
    base_elevation: float | None = None
    constraints: Sequence = ()
    boreholes: Boreholes | None = None
    observations: str | Path | ObservationFile | Observations | None = None
    dips: Dips | DipFile | str | Path | None = None
    names: Mapping[str, str] = field(default_factory=dict)
    map: MapFile | None = None
    series: list[Series] = field(default_factory=list)
    hole_picks: Mapping = field(default_factory=dict, repr=False, compare=False)
    hole_ends: Mapping = field(default_factory=dict, repr=False, compare=False)
    shape_file: Path | None = field(default=None, repr=False, compare=False)
    source: Source | None = field(default=None, repr=False, compare=False, metadata=NOT_STORED)

    def __post_init__(self):
        mark_level_sets(self)

    @property
    def observation_file(self) -> ObservationFile | None:
        """The table of its observations; None where they are arrays, or there are none."""
        given = self.observations
        if isinstance(given, (str, Path)):
            return ObservationFile(given)
        return given if isinstance(given, ObservationFile) else None

    @property
    def dip_file(self) -> DipFile | None:
        """The file of its dips and how it is read; None where they are arrays, or there are none."""
        return dip_file_of(self.dips)

    @property
    def has_field_data(self) -> bool:
        """Whether it has boreholes, observations or a map, which may give its surfaces contacts."""
        return any(given is not None for given in (self.boreholes, self.observations, self.map))

    @property
    def observed(self) -> Observations | None:
        """The observations of a rock mass that is read; None where there are none."""
        assert self.observation_file is None
        return self.observations if isinstance(self.observations, Observations) else None

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

    def constraint_lines(self) -> list[np.ndarray]:
        """The lines (N, 2) of constraints that are arrays."""
        return [line for line in self.constraints if len(line) > 1]

    def constraint_points(self) -> np.ndarray | None:
        """The points (N, 2) of constraints that are arrays; None where there are none."""
        points = [point for point in self.constraints if len(point) == 1]
        return np.concatenate(points) if points else None

    def stage(self, m: int) -> Rock:
        """The rock mass with the surfaces up to m, and the series that these belong to."""
        kept = self.surfaces[: m + 1]
        names = {surface.series for surface in kept}
        return replace(self, surfaces=kept, series=[each for each in self.series if each.name in names])

    @property
    def interpolates(self) -> bool:
        """Whether any of its surfaces is interpolated."""
        return any(surface.interpolated for surface in self.surfaces)


@dataclass
class Project:
    """Rock masses that make one model, the faults and bodies in them, and the library of their properties.

    name: of the model. rocks: its rock masses. path: the project file, if it was read from one.
    units: of the model's lengths, which files in other units are brought to. Where bodies overlap, the later
    one counts. crs: the code of its coordinate reference system, "EPSG:25832", which files that have a place
    for it name.
    """

    name: str
    rocks: list[Rock]
    library: Library | None = None
    path: Path | None = None
    units: str = MODEL_UNIT
    faults: list[Fault] = field(default_factory=list)
    bodies: list[Body] = field(default_factory=list)
    crs: str | None = None

    def input_files(self) -> list[Path]:
        """Every file that this project reads, itself included."""
        files = [self.path, self.library.path if self.library else None]
        for rock in self.rocks:
            files += [*layer_files(rock.region), *(surface.input_file for surface in rock.surfaces)]
            files += [file for given in rock.constraints for file in layer_files(given)]
            files += files_of_sizes(rock.size)
            files += rock.boreholes.files if rock.boreholes is not None else []
            files += [Path(rock.observation_file.file)] if rock.observation_file is not None else []
            files += files_of_map(rock)
            files += [Path(rock.dip_file.file)] if rock.dip_file is not None else []
            for surface in rock.surfaces:
                if surface.point_file is not None:
                    files += companions(Path(surface.point_file.file))
                if surface.dip_file is not None:
                    files.append(Path(surface.dip_file.file))
            files += [Path(each.dip_file.file) for each in rock.series if each.dip_file is not None]
        for entry in (*self.faults, *self.bodies):
            if entry.input_file is not None:
                files += [entry.input_file, *companions(entry.input_file)]
        return [Path(file) for file in files if file is not None]

    def stage(self, m: int) -> Project:
        """This project as it was just after surface m of each rock mass: only the surfaces up to it."""
        rocks = [rock.stage(m) for rock in self.rocks]
        for rock in rocks:
            known = names_of_units(self, rock)
            rock.names = {code: name if name in known else "" for code, name in rock.names.items()}
        return replace(self, rocks=rocks)


def surface_item(rock: Rock, surface: Surface) -> str:
    """The name of a surface in messages; of rows of the panel, too."""
    return f"rock '{rock.name}', surface '{surface.name}'"


def check_project(project: Project) -> None:
    """Refuses a project that cannot be built, before anything is read. Raises InputRefused."""
    if not is_name(project.name):
        raise InputRefused("a project needs a name", file=project.path)
    if project.units not in METERS:
        what = f"unknown unit {project.units!r}"
        raise InputRefused(what, file=project.path, item="units", advice=f"there are {', '.join(METERS)}")
    try:
        checked_crs("crs", project.crs)
    except OptionRefused as error:
        raise InputRefused(error.what, file=project.path, item="crs", advice=error.advice) from error
    if not project.rocks:
        raise InputRefused("there is no rock mass", file=project.path, item=f"project '{project.name}'")
    for rock in named_once(project.rocks, "rock mass"):
        _check_rock(project, rock)
    check_structures(project)


def _check_rock(project: Project, rock: Rock) -> None:
    refuse = rock.refused
    mark_level_sets(rock)  # surfaces may have come later
    if not rock.surfaces:
        raise refuse("it has no surface", advice="a block needs two surfaces, or one and a base_elevation")
    check_values(rock, ROCK, ("edge_length", "triangles", "mesher", "base_elevation"), refuse)
    _check_mesh(rock, refuse)
    if rock.region is None and len(rock.holes):
        raise refuse("it has holes but no region", "holes", "add the outline as region")
    if isinstance(rock.region, (str, Path, MapLayer)) and len(rock.holes):
        raise refuse(
            "holes need a region given by coordinates", "holes", "put the holes into the region's file"
        )
    check_layer(rock.region, "region", refuse)
    for given in rock.constraints:
        check_layer(given, "constraints", refuse)
    if len(rock.constraints) and not rock.interpolates:
        what = "constraints have no effect, as no surface is interpolated"
        raise refuse(what, "constraints")
    check_field_data(project, rock)
    check_series(rock)
    names: set[str] = set()
    for surface in rock.surfaces:
        _check_surface(project, rock, surface)
        if surface.name in names:
            advice = "give each surface of a rock mass a unique name"
            item = surface_item(rock, surface)
            raise surface.refused("another surface has this name", "name", advice, item)
        names.add(surface.name)
    _check_references(rock)


def _check_mesh(rock: Rock, refuse) -> None:
    """Refuses settings from which no planar mesh can be made."""
    if rock.triangles is not None and rock.edge_length not in (None, AUTO):
        raise refuse("edge_length and triangles cannot both be given", "triangles", "give one of them")
    try:
        sizes = [_at_a_place(entry, refuse) for entry in rock.size]
        local_lengths(sizes, [np.zeros((1, 2))] if len(rock.constraints) else [], None)
    except InputRefused as error:
        raise refuse(f"{error.item}: {error.what}" if error.item else error.what, "size") from error


def _at_a_place(entry, refuse):
    """An entry of `size` that is at what a file or a text holds, with a place instead, once there is that
    file; others as they are."""
    if not (isinstance(entry, Mapping) and is_place_elsewhere(entry.get("at"))):
        return entry
    check_layer(entry["at"], "size", refuse)
    return {**entry, "at": [0.0, 0.0]}


def _check_surface(project: Project, rock: Rock, surface: Surface) -> None:
    if not is_name(surface.name):
        raise surface.refused("a surface has no name", "name", item=rock.item)
    refuse = partial(surface.refused, item=surface_item(rock, surface))
    check_names_series(rock, surface, refuse)
    if surface.is_level_set:
        check_level_set(rock, surface, refuse)
    else:
        _check_shape(rock, surface, refuse, bool(project.faults))
        _check_dips(surface, refuse)
    check_values(
        surface,
        SURFACE,
        ("minimum_thickness", "true_thickness", "tie", "correlation", "rule", "property", "block"),
        refuse,
    )
    check_property(project.library, surface.property, refuse)


def _check_shape(rock: Rock, surface: Surface, refuse, continues: bool) -> None:
    """Checks the source of the shape. continues: a ready mesh may also have a method, by which it is
    continued to faults."""
    shapes = shapes_given(surface, ("points", "mesh"), refuse)
    no_points = not shapes and not rock.has_field_data
    if no_points and surface.method is None:
        raise refuse("it has neither points nor a mesh", advice="add points = ... or mesh = ...")
    if shapes:
        check_file(surface.input_file, shapes[0], refuse)
    with refused_by(refuse):
        for file in (surface.mesh_file, surface.point_file):
            if file is not None:
                file.check()
    if not surface.interpolated:
        given = [*(["method"] if surface.method is not None else []), *surface.options]
        given = [] if continues else given
        of_points = ("minimum_thickness", "correlation", "left_out")
        given += [key for key in of_points if getattr(surface, key) is not None]
        given += ["true_thickness"] if surface.true_thickness else []
        given += [] if surface.tie else ["tie"]
        if given:
            raise refuse(f"'{given[0]}' has no effect, as a mesh is not interpolated", given[0])
        if continues:
            _check_method(surface, refuse)
            _check_continuation(surface, refuse)
        return
    _check_method(surface, refuse, no_points)
    if surface.true_thickness and not surface.has_thickness:
        what = "'true_thickness' has no effect, as the surface keeps no thickness above another one"
        raise refuse(what, "true_thickness", 'add minimum_thickness, or use method = "parallel"')
    length = rock.edge_length if rock.triangles is None else rock.triangles
    for key, value in (("region", rock.region), ("edge_length", length)):
        if value is None:
            raise refuse(
                f"its points cannot be interpolated: {rock.item} has no {key}",
                "points",
                f"give the rock mass {'an' if key == 'edge_length' else 'a'} {key}",
            )


def _check_dips(surface: Surface, refuse) -> None:
    if surface.dips is None:
        return
    file = surface.dip_file
    with refused_by(refuse, "dips", "dips: "):
        if file is not None:
            file.check()
    check_file(None if file is None else file.file, "dips", refuse)
    if not surface.interpolated:
        raise refuse("'dips' has no effect, as a mesh is not interpolated", "dips")
    with refused_by(refuse):
        check_uses_dips(surface.method or DEFAULT_METHOD)


def _check_continuation(surface: Surface, refuse) -> None:
    """Refuses options that give a ready mesh no heights where it does not reach its faults."""
    for option in SURFACE_OPTIONS:
        if isinstance(surface.options.get(option), str):
            what = f"'{option}' names a surface; a mesh is continued from its own vertices"
            raise refuse(what, option, "choose another method, or a number")
    if surface.options.get("extrapolate") == "none":
        what = 'extrapolate = "none" gives no heights where the mesh is continued to the faults'
        raise refuse(what, "extrapolate", 'use "nearest" or "method"')


def _check_method(surface: Surface, refuse, no_points: bool = False) -> None:
    with refused_by(refuse):
        check_method(surface.method or DEFAULT_METHOD)
        if no_points and surface.needs_points:
            method, _ = surface.method_options()
            option = METHODS[method].instead_of_points
            either = f", or {option} = ..." if option else ""
            raise refuse(f"method '{method}' needs points", "method", f"add points = ...{either}")
        surface.method_options()


def _check_references(rock: Rock) -> None:
    """Refuses unknown names of surfaces, a minimum thickness above nothing, and circular references."""
    numbers = {surface.name: number for number, surface in enumerate(rock.surfaces)}
    needs: list[list[tuple[str, int]]] = []
    for number, surface in enumerate(rock.surfaces):
        item, needed = surface_item(rock, surface), []
        for option in SURFACE_OPTIONS:
            name = surface.options.get(option)
            if not isinstance(name, str):
                continue
            if name not in numbers:
                what = f"'{option}' names surface '{name}', which {rock.item} does not have"
                raise surface.refused(what, option, f"it has {', '.join(numbers)}", item)
            needed.append((option, numbers[name]))
        for key in ("minimum_thickness", "correlation"):
            if number == 0 and getattr(surface, key) is not None:
                what = f"the oldest surface cannot have a {key}, as there is no surface beneath it"
                raise surface.refused(what, key, item=item)
        if surface.minimum_thickness is not None:
            needed.append(("minimum_thickness", number - 1))
        needs.append(needed)
    done: set[int] = set()

    def visit(number: int, above: tuple[int, ...]) -> None:
        for option, needed in needs[number]:
            if needed in (*above, number):
                surface, other = rock.surfaces[number], rock.surfaces[needed]
                what = f"'{option}' names '{other.name}', which depends on this surface"
                raise surface.refused(what, option, item=surface_item(rock, surface))
            if needed not in done:
                visit(needed, (*above, number))
        done.add(number)

    for number in range(len(rock.surfaces)):
        if number not in done:
            visit(number, ())
