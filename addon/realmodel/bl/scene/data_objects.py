# SPDX-License-Identifier: GPL-3.0-or-later
"""Points, outlines and boreholes of a scene's model as they were read, as objects to look at before a build.

They stand in the collection "<project> Data" beside the model, cannot be selected, are no input of anything
and not in renders. `update` makes them from the settings, so they follow whatever becomes of these.
"""

from itertools import pairwise

import bpy
import numpy as np

from ...core import InputRefused, MeshFile, PointFile, RealModelError, Surface
from ...core.project.structure_entries import FAULT
from ...core.readers import is_mesh_file, read_mesh, read_point_file, read_region
from ...core.readers.fault_input import read_fault_points, read_fault_trace
from .. import display
from ..objects import meshes, model_tree, stored_arrays
from ..objects.origin import KEY as ORIGIN_KEY
from ..objects.origin import choose_origin
from ..project import borehole_picks, method_settings, observed_blocks, project_settings, settings

KEY = settings.DATA  # on an object: the stamp of its source; on the collection: a mark
_ORIGIN = "realmodel_data_origin"  # on an object: the origin that its mesh was made for


def update(scene, read=None):
    """Makes missing objects, and removes those without a setting.

    read: {`file_key` of a row: (P, 3) float64}, points that the caller has read already. Files that cannot be
    read are not shown: the build will report the error.
    """
    wanted = {}
    if scene.realmodel.show_data and scene.library is None:
        wanted = _wanted(scene, read or {})
    by_stamp = {obj[KEY]: obj for obj in objects(scene)}
    for stamp in by_stamp.keys() - wanted.keys():
        _remove(by_stamp.pop(stamp))
    for stamp, (name, load) in wanted.items():
        obj = by_stamp.get(stamp)
        if obj is None:
            try:
                obj = _new(scene, stamp, name, *load())
            except (RealModelError, KeyError):
                continue
        else:
            model_tree.give_name(bpy.data.objects, obj, name)
    collection = _collection(scene)
    if collection is not None and not len(collection.objects):
        bpy.data.collections.remove(collection)
    place(scene)
    display.field_changed(scene)


def objects(scene):
    """The objects of the data in a scene."""
    collection = _collection(scene)
    return [] if collection is None else [obj for obj in collection.objects if KEY in obj]


def place(scene):
    """Moves the objects to their positions relative to the scene's origin."""
    origin = project_settings.model_origin(scene)
    for obj in objects(scene):
        obj.location = np.array(obj[_ORIGIN]) - origin


def begin(scene, points):
    """Sets the origin of a scene at the first data (P, 3), unless objects of the user determine the position
    of the model."""
    if ORIGIN_KEY not in scene and not project_settings.user_objects(scene) and len(points):
        scene[ORIGIN_KEY] = [float(value) for value in choose_origin(points)]


def points_of(scene, rock, depsgraph):
    """(P, 3) float64 of all points of a rock mass's surfaces and of its observations, in model coordinates;
    the vertices of ready meshes count where there are no points. Raises InputRefused."""
    clouds = [row_points(scene, row, depsgraph) for row in rock.surfaces]
    clouds.append(observed_blocks.places_of(rock))
    clouds = [points for points in clouds if points is not None and len(points)]
    if not clouds:
        raise InputRefused(
            f"no surface of {rock.name} has points yet", advice="import surfaces or boreholes first"
        )
    return np.concatenate(clouds)


def row_points(scene, row, depsgraph):
    """(P, 3) float64 in model coordinates: the points of a surface, or the vertices of its ready mesh; None
    where there are none yet. Raises InputRefused."""
    if project_settings.is_of_ground(row):
        return _ground_points(scene, settings.rock_of(row))
    if row.source in ("POINTS_OBJECT", "MESH_OBJECT") and row.object is not None:
        return project_settings.shapes.points(row.object, depsgraph) + project_settings.model_origin(scene)
    if row.source == "POINTS_FILE":
        return read_points(scene, row)
    if row.stored_mesh:
        return row.stored_mesh["vertices"]
    path = project_settings.absolute(row.filepath)
    if row.source != "MESH_FILE" or path is None:
        return None
    surface = Surface(row.name)
    project_settings.name_file(surface, row, path)
    return read_mesh(surface.mesh).in_model(surface.mesh, scene.realmodel.units)[0]


def _ground_points(scene, rock):
    """row_points of the ground of the row of a rock mass."""
    if rock.ground_stored:
        return rock.ground_stored["points" if "points" in rock.ground_stored else "vertices"]
    path, units = project_settings.absolute(rock.ground), scene.realmodel.units
    if is_mesh_file(path):
        return read_mesh(MeshFile(path)).in_model(MeshFile(path), units)[0]
    return read_point_file(PointFile(path), units)[0]


def read_points(scene, row):
    """(P, 3) of a surface's file of points, or of the data stored in the .blend; None where there are
    neither."""
    if row.stored:
        return row.stored["points"]
    path = project_settings.absolute(row.filepath)
    if path is None:
        return None
    return read_point_file(method_settings.point_file(row, path), scene.realmodel.units)[0]


def file_key(row):
    """A key of the file of a surface and of its import options; it changes when the file does."""
    path = project_settings.absolute(row.filepath)
    if path is None:
        return ""
    return f"{path} {method_settings.values(row, PointFile)} {stored_arrays.file_stamp(path)}"


def _wanted(scene, read):
    """{stamp: (name, load)}: load() gives coordinates (N, 3) in model coordinates and edges (E, 2)."""
    wanted = {}
    for rock in scene.realmodel.rocks:
        if rock.region is None and (rock.region_stored or rock.region_file):
            made_of = rock.region_file or rock.region_stored.digest
            wanted[f"outline {rock.name} {made_of}"] = (
                f"{rock.name} outline",
                lambda rock=rock: _outline(scene, rock),
            )
        logs, outcrops = observed_blocks.shown(rock)
        if rock.hole_picks or logs:
            wanted[f"boreholes {rock.name} {rock.hole_picks.digest}{rock.observations.digest}"] = (
                f"{rock.name} boreholes",
                lambda rock=rock: _chains(borehole_picks.paths(rock)),
            )
        # A map lies on its ground, and has a color where it was observed: thousands of dots would hide it.
        ground = rock.surfaces[-1].name if rock.map and len(rock.surfaces) else None
        if len(outcrops) and not rock.map:
            wanted[f"observations {rock.name} {rock.observations.digest}"] = (
                f"{rock.name} observations",
                lambda outcrops=outcrops: (outcrops, np.empty((0, 2), np.int32)),
            )
        for row in rock.surfaces:
            if row.name != ground and (key := _points_key(row)) is not None:
                wanted[f"points {rock.name} / {row.name} {key or row.stored.digest}"] = (
                    f"{row.name} points",
                    lambda row=row, key=key: _cloud(scene, row, read.get(key)),
                )
    for row in scene.realmodel.faults:
        if row.source == "TRACE_FILE" and (row.filepath or row.stored_trace):
            try:
                key = row.stored_stamp if row.stored_trace else file_key(row)
            except RealModelError:
                continue
            wanted[f"trace {row.name} {key or row.stored_trace.digest}"] = (
                f"{row.name} trace",
                lambda row=row: _trace(scene, row),
            )
        elif key := _points_key(row):
            wanted[f"sticks {row.name} {row.stick} {key}"] = (
                f"{row.name} sticks",
                lambda row=row: _sticks(scene, row),
            )
    return wanted


def _points_key(row):
    """`file_key` of a row that is made from points; None where there are none yet."""
    if row.source != "POINTS_FILE" or not (row.filepath or getattr(row, "stored", "")):
        return None
    try:
        return file_key(row)
    except RealModelError:  # only some of the columns are set yet
        return None


def _cloud(scene, row, points):
    points = read_points(scene, row) if points is None else points
    return points, np.empty((0, 2), np.int32)


def _sticks(scene, row):
    """The sticks of a fault, or its scattered points."""
    source = method_settings.point_file(row, project_settings.absolute(row.filepath))
    sticks, _ = read_fault_points(source, method_settings.value(row, "stick", FAULT), scene.realmodel.units)
    return (sticks, np.empty((0, 2), np.int32)) if isinstance(sticks, np.ndarray) else _chains(sticks)


def _chains(lines):
    """The points of lines (N, 3) each, and the edges (E, 2) that join those of each line."""
    starts = np.cumsum([0, *map(len, lines)])
    first = np.setdiff1d(np.arange(starts[-1]), starts[1:] - 1)
    return np.concatenate(lines), np.stack([first, first + 1], 1).astype(np.int32)


def _outline(scene, rock):
    """The rings of a region that comes from a file, below the lowest point of the model's data."""
    if rock.region_stored:
        rings = list(rock.region_stored.values())
    else:
        rings, _ = read_region(project_settings.absolute(rock.region_file))
    starts = np.cumsum([0, *map(len, rings)])
    edges = [np.stack([n := np.arange(a, b), np.roll(n, -1)], 1) for a, b in pairwise(starts)]
    plan = np.concatenate(rings)
    begin_z = project_settings.model_origin(scene)[2]
    return np.column_stack([plan, np.full(len(plan), begin_z)]), np.concatenate(edges).astype(np.int32)


def _trace(scene, fault):
    """The lines of a fault's file, where they have no elevation at the height of the scene's zero."""
    if fault.stored_trace:
        lines = [fault.stored_trace["line"]]
    else:
        trace_file = method_settings.point_file(fault, project_settings.absolute(fault.filepath))
        lines = read_fault_trace(trace_file, scene.realmodel.units).lines
    places, edges = _chains(lines)
    places[np.isnan(places[:, 2]), 2] = project_settings.model_origin(scene)[2]
    return places, edges


def _new(scene, stamp, name, coordinates, edges):
    if ORIGIN_KEY not in scene:
        begin(scene, coordinates)
    origin = project_settings.model_origin(scene)
    obj = bpy.data.objects.new(name, meshes.line_mesh(name, coordinates - origin, edges))
    obj[KEY], obj[_ORIGIN] = stamp, [float(value) for value in origin]
    obj.hide_select = obj.hide_render = True
    collection = _collection(scene)
    if collection is None:
        collection = bpy.data.collections.new(f"{scene.realmodel.name} Data")
        collection[KEY] = True
        collection.hide_render = True
        scene.collection.children.link(collection)
    collection.objects.link(obj)
    return obj


def _collection(scene):
    collections = scene.collection.children_recursive  # it may have been moved
    return next((c for c in collections if KEY in c and c.library is None), None)


def _remove(obj):
    mesh = obj.data
    bpy.data.objects.remove(obj)
    if not mesh.users:
        bpy.data.meshes.remove(mesh)


def shown_changed(group, _context):
    """`show_data` was switched on or off."""
    if not settings.is_filling():
        update(group.id_data)


def origin_of(group):
    """The origin of a scene as `scene.realmodel.origin` shows it."""
    return tuple(project_settings.model_origin(group.id_data))


def set_origin(group, given):
    """Sets another origin for a model that was not built yet; objects of the user stay in place."""
    scene = group.id_data
    scene[ORIGIN_KEY] = [float(str(np.float32(value))) for value in given]
    place(scene)
