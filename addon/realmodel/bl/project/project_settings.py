# SPDX-License-Identifier: GPL-3.0-or-later
"""Converts the settings of a scene, and the objects that they refer to, to a project, and back."""

from __future__ import annotations

import copy
import os
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import NamedTuple

import bpy
import numpy as np

from ...core import InputRefused, MeshFile, PointFile, Project, Rock, Surface
from ...core.base.errors import naming
from ...core.base.work import run
from ...core.project.fingerprint import fingerprint
from ...core.project.project import surface_item
from ...core.readers import is_mesh_file
from ...core.readers.fault_input import read_fault_points
from ...core.results.automatic_library import with_library
from ...core.settings.methods import CONTINUATION
from ...core.settings.setting import declarations
from ...core.structures.shapes.reading import read_structures
from ...core.surfaces.prepare import read_rocks
from ..objects import built_models, exaggeration, shapes, stored_arrays
from ..objects.origin import KEY as ORIGIN_KEY
from . import (
    borehole_picks,
    interval_values,
    library_rows,
    method_settings,
    names,
    observed_blocks,
    plan_mesh,
    series_settings,
    settings,
    structure_settings,
    surface_dips,
    units,
)


@dataclass
class Composed:
    """The project of a scene. read: by place (settings.row_at) the stamp of the file that is still to be
    read. origin_is_free: no object of the user determines the position of the model. has_origin: the origin
    was chosen before. edited: the places of the interfaces that were changed by hand since they were made,
    and are used as they are. files: of entries that come from a file, as `fingerprint` takes them.
    fingerprint: of the project and the kind of its cells, with a space between."""

    project: Project
    origin: np.ndarray
    origin_is_free: bool
    has_origin: bool = False
    read: dict = field(default_factory=dict)
    edited: list = field(default_factory=list)
    objects: set = field(default_factory=set)
    files: dict = field(default_factory=dict)
    fingerprint: str = ""

    def from_object(self, place):
        """Whether a shape is a mesh object of the scene just as it stands."""
        return place in self.objects


class _Source(NamedTuple):
    """What a project is composed from, see `compose`."""

    scene: bpy.types.Scene
    depsgraph: bpy.types.Depsgraph
    whole: bool


def model_origin(scene):
    """(3,) float64: what object coordinates lack to be model coordinates."""
    return np.array(scene.get(ORIGIN_KEY, (0.0, 0.0, 0.0)), np.float64)


def in_world(scene, places):
    """(N, 3) where places (N, 3) of the model are shown."""
    stretched = exaggeration.matrix(scene)
    offsets = np.asarray(places, np.float64).reshape(-1, 3) - model_origin(scene)
    return offsets @ stretched[:3, :3].T + stretched[:3, 3]


def user_objects(scene):
    """The objects of the user that a model is made from: where they stand fixes its origin."""
    objects = [row.region for row in scene.realmodel.rocks]
    objects += [obj for row in scene.realmodel.rocks for obj in plan_mesh.objects(row)]
    objects += [row.object for _, row in settings.interface_rows(scene) if row.source in settings.OF_OBJECTS]
    return [obj for obj in objects if obj is not None]


def absolute(path):
    """A path as the user gave it ("//" is the .blend's folder) as a Path; None for an empty one."""
    path = path.strip()
    return Path(os.path.realpath(bpy.path.abspath(path))) if path else None


def compose(scene, depsgraph, whole=True):
    """Composes the project from a scene's settings.

    depsgraph: the evaluated one, in which modifiers have been applied. whole: check whether files have
    changed; otherwise (live) the data stored in the .blend are used if there are any. Raises InputRefused,
    naming the rock mass and the surface, for invalid input.
    """
    origin = model_origin(scene)
    group = scene.realmodel
    if not len(group.rocks):
        raise InputRefused("there is no rock mass", advice="add one, or open a project file")
    project = Project(
        group.name, [], library_rows.library_of(scene), units=group.units, crs=group.crs.strip() or None
    )
    composed = Composed(project, origin, not user_objects(scene), ORIGIN_KEY in scene)
    source = _Source(scene, depsgraph, whole)
    for number, row in enumerate(group.rocks):
        picks = borehole_picks.of_rock(row)
        ends = borehole_picks.ends_of(row)
        values = method_settings.values(row, Rock)
        rock = Rock(**values, surfaces=[], hole_picks=picks, hole_ends=ends)
        with naming(rock.item):
            rock.observations = observed_blocks.of_rock(row)
            if row.ground and len(row.surfaces) and rock.observations is not None:
                rock.observations = _on_youngest(rock.observations, row.surfaces[-1].name)
            rock.dips = surface_dips.of_row(row)
            rock.series = series_settings.of_rock(row)
        plan_mesh.compose(rock, row, depsgraph, origin)
        _region(source, composed, number, rock, row)
        composed.project.rocks.append(rock)
        fields = series_settings.fields(row)
        for at, surface_row in enumerate(row.surfaces):
            surface = _plain_surface(surface_row, fields)
            with naming(surface_item(rock, surface)):
                _shape(source, composed, (number, at), surface, surface_row)
            rock.surfaces.append(surface)
        if len(row.surfaces) and row.surfaces[-1].is_terrain:
            rock.terrain = rock.surfaces[-1].name
        if not rock.interpolates:  # no mesh that they could affect
            rock.constraints, rock.size = [], []
    for place, row in settings.structure_rows(scene):
        entry = structure_settings.entry_of(place, row)
        with naming(entry.item):
            _shape(source, composed, place, entry, row)
        (project.faults if place[0] == "fault" else project.bodies).append(entry)
    composed.origin_is_free = composed.origin_is_free and not composed.edited
    composed.fingerprint = f"{fingerprint(project, composed.files)} {group.cells}"
    return composed


def files(scene):
    """The files that a scene's model is made from."""
    paths = [path for row in scene.realmodel.rocks for path in (row.region_file, row.ground)]
    paths += [
        row.filepath for _, row in settings.interface_rows(scene) if row.source not in settings.OF_OBJECTS
    ]
    return [path for path in map(absolute, paths) if path is not None]


def _is_to_be_read(source, composed, place, entry, named, path, stored_stamp):
    """Whether the file of an entry is to be read, or the data are used that the .blend has stored of it.
    named: the entry as its settings name the file. stored_stamp: the stamp of the file that the
    stored data are of; None where there are none."""
    now = stored_arrays.file_stamp(path)
    is_read = stored_stamp is None or (source.whole and bool(now) and now != stored_stamp)
    if is_read:
        composed.read[place] = now
    composed.files[id(entry)] = named, now if is_read else stored_stamp
    return is_read


def _on_youngest(observations, name):
    """Observations of which those that were seen on the ground name the surface that is made from it."""
    return replace(observations, on=np.where(observations.seen_on == "", "", name))


def _plain_surface(row, fields):
    """A surface with everything but its shape. fields: the names of series whose surfaces are level sets."""
    is_ready = row.source in method_settings.READY_MESHES
    is_level_set = not is_ready and row.series in fields
    shape = "mesh" if is_ready else "level set" if is_level_set else "sheet"
    surface = Surface(**method_settings.values(row, Surface, shape))
    if not is_ready:
        surface.dips = surface_dips.of_row(row)
        if row.left_out:
            surface.left_out = row.left_out["points"]
    if not is_level_set and method_settings.has_method(row):
        surface.method = row.method
        surface.options = method_settings.options_of(row)
    surface.true_thickness &= surface.has_thickness  # it stays set where it has no effect
    return surface


def region_rings(row, depsgraph, origin):
    """The outlines of a rock mass's region object, or None where it has none. Raises InputRefused."""
    if row.region is None:
        return None
    return [ring + origin[:2] for ring in shapes.rings(row.region, depsgraph)]


def _region(source, composed, number, rock, row):
    with naming(rock.item):
        rings = region_rings(row, source.depsgraph, composed.origin)
        if rings is None:
            rings = _stored_rings(source, composed, number, rock, row)
    if rings:  # holes are not marked: the even-odd rule decides
        rock.region = rings if len(rings) > 1 else rings[0]


def _stored_rings(source, composed, number, rock, row):
    """The outlines that the .blend keeps of a region's file; None where the file is to be read."""
    path = absolute(row.region_file)
    if path is not None:
        named = copy.copy(rock)
        named.region = path
        stored_stamp = row.region_stamp if row.region_stored else None
        if _is_to_be_read(source, composed, (number, None), rock, named, path, stored_stamp):
            rock.region = path
            return None
    if not row.region_stored:
        return None
    return list(row.region_stored.values())


def is_of_ground(row):
    """Whether a surface is made from the ground of its rock mass: the youngest one, where it is made from
    nothing else. So the ground stays on top, whichever surface is moved there."""
    rock = settings.rock_of(row)
    if not (rock.ground or rock.ground_stored) or row.path_from_id() != rock.surfaces[-1].path_from_id():
        return False
    return is_free(row)


def is_free(row):
    """Whether a surface is made from no data of its own."""
    has_none = row.source == "NONE" or (row.source == "POINTS_FILE" and not (row.filepath or row.stored))
    return has_none and not series_settings.is_level_set(row)


def _take_ground(source, composed, place, surface, row):
    """Makes a surface from the ground of its rock mass."""
    rock = settings.rock_of(row)
    path, stored, is_read = absolute(rock.ground), rock.ground_stored, False
    if path is not None:
        named = copy.copy(surface)
        _name_ground(named, path)
        is_read = _is_to_be_read(
            source, composed, place, surface, named, path, rock.ground_stamp if stored else None
        )
    if is_read:
        _name_ground(surface, path)
    else:
        _take_stored(surface, stored, row)
    if surface.points is None:
        _as_ready(surface)
    elif rock.ground_is_raster and surface.method != "grid":
        surface.method, surface.options = "grid", {}


def _name_ground(surface, path):
    if is_mesh_file(path):
        surface.mesh = MeshFile(path)
    else:
        surface.points = PointFile(path)


def _as_ready(surface):
    """Unsets what a surface that is made of a mesh does not have."""
    for part in declarations(Surface):
        if not part.setting.fits("mesh"):
            setattr(surface, part.name, copy.copy(part.default))


def _shape(source, composed, place, surface, row):
    of_ground = isinstance(surface, Surface) and is_of_ground(row)
    if row.source == "NONE" and not of_ground:
        return
    if row.source in ("POINTS_OBJECT", "MESH_OBJECT"):
        _from_object(source, composed, place, surface, row)
        return
    if row.interface_digest and in_use(row.interface):
        vertices, triangles = shapes.triangulation(row.interface, source.depsgraph)
        if shapes.digest(vertices, triangles) != row.interface_digest:
            if isinstance(surface, Surface) and series_settings.is_level_set(row):
                what = f"its interface was edited, but it is a level set of series '{row.series}'"
                raise InputRefused(
                    what, advice="undo that and move its contacts, or take it out of the series"
                )
            composed.edited.append(place)
            composed.objects.add(place)
            if isinstance(surface, Surface) and row.source not in method_settings.READY_MESHES:
                _as_ready(surface)
            base = _made_of(source.scene, place, row)
            _take_mesh(composed, surface, row.interface, vertices, triangles, base)
            structure_settings.clear_extension(surface)
            return
    if row.source == "INTERVALS":
        return
    if of_ground:
        _take_ground(source, composed, place, surface, row)
        return
    if row.source in settings.LINE_OBJECTS:
        _lines_of_object(source, composed, surface, row)
        return
    path, stored, is_read = absolute(row.filepath), stored_shape(row), False
    if path is not None:
        named = copy.copy(surface)
        name_file(named, row, path)
        stored_stamp = row.stored_stamp if stored else None
        is_read = _is_to_be_read(source, composed, place, surface, named, path, stored_stamp)
    if is_read:
        name_file(surface, row, path)
    elif stored:
        _take_stored(surface, stored, row)
        if row.source == "POINTS_FILE" or (path is not None and row.source != "TRACE_FILE"):
            structure_settings.clear_extension(surface)
    else:
        kind = {"POINTS_FILE": "points", "TRACE_FILE": "trace"}.get(row.source, "mesh")
        raise InputRefused(f"no file with its {kind} is chosen", advice="choose its file, or another source")


def name_file(entry, row, path):
    """Sets the file of a surface, fault or body from its row, with its import options."""
    if row.source == "POINTS_FILE":
        entry.points = method_settings.point_file(row, path)
    elif row.source == "TRACE_FILE":
        structure_settings.set_trace(entry, row, method_settings.point_file(row, path))
    else:
        entry.mesh = MeshFile(path, **method_settings.values(row, MeshFile))


def _stored_key(row):
    """The key under which a row stores the shape of its file: of faults the fitted surface, not the
    points."""
    if row.source == "TRACE_FILE":
        return "stored_trace"
    return "stored" if row.source == "POINTS_FILE" and hasattr(row, "stored") else "stored_mesh"


def stored_shape(row):
    """The arrays that the .blend stores of a row's file."""
    return getattr(row, _stored_key(row))


def keep_shape(row, arrays, stamp):
    """Stores the shape of a row in the .blend, and the stamp of the file that it was read from."""
    setattr(row, _stored_key(row), arrays)
    row.stored_stamp = stamp


def keep_ground(row, arrays, stamp):
    """The same of the ground of a rock mass."""
    row.ground_stored, row.ground_stamp = arrays, stamp


def forget_shape(row):
    """Discards the stored shape of a row's file."""
    setattr(row, "stored" if hasattr(row, "stored") else "stored_mesh", {})
    if hasattr(row, "stored_trace"):
        row.stored_trace = {}
    row.stored_stamp = ""


def _take_stored(surface, arrays, row):
    if row.source == "TRACE_FILE":
        structure_settings.set_stored_trace(surface, row)
        return
    for key, array in arrays.items():
        setattr(surface, key, array)


def _from_object(source, composed, place, surface, row):
    if row.object is None:
        if row.source == "MESH_OBJECT" and row.stored_mesh:
            _take_stored(surface, row.stored_mesh, row)
            return
        raise InputRefused("it has no object", advice="choose the object that gives its shape")
    if not in_use(row.object) and row.object.modifiers:
        raise InputRefused(
            f"object '{row.object.name}' was deleted from the scene",
            advice="undo that, or choose another object",
        )
    if row.source == "POINTS_OBJECT":
        surface.points = shapes.points(row.object, source.depsgraph) + composed.origin
        if not len(surface.points):
            raise InputRefused(f"object '{row.object.name}' has no vertices", advice="choose another object")
        return
    if settings.kind_of(row) == "surface" and not row.object.modifiers:
        shapes.require_open(row.object)
    vertices, triangles = shapes.triangulation(row.object, source.depsgraph)
    composed.objects.add(place)
    _take_mesh(composed, surface, row.object, vertices, triangles, row.stored_mesh)


def _lines_of_object(source, composed, fault, row):
    """The trace of a fault, or its sticks."""
    if row.object is None:
        raise InputRefused("it has no object", advice="choose the curve or mesh with its trace or its sticks")
    lines = [line + composed.origin for line in shapes.lines(row.object, source.depsgraph)]
    if row.source == "STICKS_OBJECT":
        fault.points = lines
        return
    structure_settings.set_trace(fault, row, lines if len(lines) > 1 else lines[0])


def _made_of(scene, place, row):
    """The arrays, in full digits, that an interface was made from: stored ones, or those of the cached
    model."""
    if row.source == "MESH_FILE" and row.stored_mesh:
        return row.stored_mesh
    model = built_models.current(scene)
    places = [place for place, _ in settings.interface_rows(scene)]
    if model is None or len(model.surface_names) != len(places):
        return {}
    vertices, triangles = model.surface(places.index(place))
    return {"vertices": vertices, "triangles": triangles}


def _take_mesh(composed, surface, obj, vertices, triangles, base):
    if not len(triangles):
        raise InputRefused(f"object '{obj.name}' has no faces", advice="choose a mesh that has faces")
    if hasattr(surface, "points"):
        surface.points = None
    surface.vertices = shapes.with_full_digits(
        vertices, triangles, composed.origin, base.get("vertices"), base.get("triangles")
    )
    surface.triangles = triangles


def oldest_first(items, depsgraph):
    """Mesh objects by the mean height of their vertices: for surfaces in sequence, their order in age."""

    def mean_height(obj):
        heights = shapes.points(obj, depsgraph)[:, 2]
        return float(heights.mean()) if len(heights) else 0.0

    return sorted(items, key=mean_height)


def read_project(composed):
    """The project with arrays in the place of the files that it still names. Raises InputRefused."""
    project = composed.project
    if not composed.read:
        return project
    inputs = run(lambda work: read_rocks(work, project))
    faults, bodies, _ = run(lambda work: read_structures(work, project))
    return replace(project, rocks=[entry.rock for entry in inputs], faults=faults, bodies=bodies)


def read_as_given(scene, composed):
    """As read_project, but faults of points with dips have these, not the surface that was fitted to them.
    Raises InputRefused."""
    project = read_project(composed)
    for number, row in enumerate(scene.realmodel.faults):
        path = absolute(row.filepath) if row.source == "POINTS_FILE" else None
        if path is None or not row.dips or ("fault", number) in composed.edited or not path.is_file():
            continue
        fault = structure_settings.entry_of(("fault", number), row)
        with naming(fault.item):
            points, _ = read_fault_points(method_settings.point_file(row, path), fault.stick, project.units)
        project.faults[number] = replace(fault, points=points, stick=None)
    return project


def in_use(item):
    """Whether an object that a setting points to is still in some scene: deleted objects that are pointed to
    live on outside of all."""
    return item is not None and len(item.users_scene) > 0


def entry_at(project, place):
    """The realmodel.core.Surface, Fault or Body of a place."""
    first, number = place
    if isinstance(first, str):
        return (project.faults if first == "fault" else project.bodies)[number]
    return project.rocks[first].surfaces[number]


def shape_arrays(surface):
    """What a row stores of the shape of a realmodel.core.Surface, Fault or Body with arrays."""
    if getattr(surface, "traced", None) is not None:
        return structure_settings.trace_arrays(surface.traced)
    if getattr(surface, "points", None) is not None:
        return {"points": np.asarray(surface.points, np.float64)}
    return structure_settings.mesh_arrays(surface)


def region_arrays(rock):
    """What a row stores of the outlines of a realmodel.core.Rock with arrays."""
    return {f"ring{n}": ring for n, ring in enumerate(rock.rings())}


def fill(scene, project):
    """Fills the rows from a project, in place of the present ones. project: realmodel.core.Project. Files
    stay files; data that were read, as in `Model.project`, are stored. Without a library it gets one, as
    surfaces that are imported do."""
    project = with_library(project)
    group = scene.realmodel
    with settings.filling():
        group.rocks.clear()
        group.results.clear()
        group.active_rock = group.stage = 0
        group.name, group.units, group.crs = project.name, project.units, project.crs or ""
        group.exists = True
        group.version = settings.VERSION
        group.project_file = str(project.path or "")
        group.library_path = str(project.library.path or "") if project.library else ""
        for rock in project.rocks:
            add_rock(group, rock)
        structure_settings.fill(scene, project)
    settings.follow_youngest(scene)
    names.store(scene)
    units.set_up(scene, project.units)
    library_rows.fill(scene, project.library)


def add_rock(group, rock):
    """A row for a realmodel.core.Rock."""
    row = group.rocks.add()
    with settings.filling():
        method_settings.set_values(row, Rock, rock)
        plan_mesh.fill(row, rock)
        if rock.region_file is not None:
            row.region_file = str(rock.region_file)
        elif rock.region is not None:
            row.region_stored = region_arrays(rock)
        for surface in rock.surfaces:
            fill_surface(row.surfaces.add(), surface)
            row.surfaces[-1].is_terrain = surface.name == rock.terrain_name
        row.active_surface = max(len(rock.surfaces) - 1, 0)
        borehole_picks.keep(row, rock.hole_picks)
        borehole_picks.keep_ends(row, rock.hole_ends)
        if rock.hole_values is not None:
            interval_values.add(row, rock.hole_values)
        observed_blocks.keep(row, rock.observed)
        surface_dips.keep(row, rock.dips)
        series_settings.fill(row, rock.series)
    return row


def fill_surface(row, surface):
    """Sets a surface's row from a realmodel.core.Surface."""
    with settings.filling():
        method_settings.set_values(row, Surface, surface)
        has_method = surface.method is not None or surface.options
        row.use_continuation = bool(has_method) and not surface.has_points
        method = CONTINUATION if row.use_continuation and surface.method is None else surface.method
        method_settings.set_options(row, method, surface.options)
        surface_dips.keep(row, surface.dips)
        if surface.left_out is not None and len(surface.left_out):
            row.left_out = {"points": np.asarray(surface.left_out, np.float64)}
        if surface.input_file is not None:
            row.source = "POINTS_FILE" if surface.has_points else "MESH_FILE"
            row.filepath = str(surface.input_file)
            method_settings.fill_reading(row, surface.point_file or surface.mesh_file)
        elif surface.has_points and (surface.points is None or not len(surface.points)):
            row.source = "NONE"
        else:
            row.source = "POINTS_FILE" if surface.has_points else "MESH_FILE"
            setattr(row, "stored" if surface.has_points else "stored_mesh", shape_arrays(surface))
