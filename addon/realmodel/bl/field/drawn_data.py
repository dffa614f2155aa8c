# SPDX-License-Identifier: GPL-3.0-or-later
"""Data that are drawn on a section plane or on a placed image: contacts of a surface, sticks of a fault."""

import bpy
import numpy as np

from ...core import InputRefused
from ...core.project.structure_entries import FAULT
from ...core.readers.fault_input import read_fault_points
from ..display import cuts
from ..objects import exaggeration, shapes
from ..project import method_settings, project_settings, settings
from ..scene import borehole_points, data_objects, live
from . import placed_images


def plane(context):
    """(point, normal) in model coordinates of what is drawn on: the active object if it is a placed image,
    else the section plane. Raises InputRefused."""
    obj = context.active_object
    if obj is not None and settings.IMAGE in obj:
        return placed_images.plane_of(context.scene, obj)
    if cuts.plane_of(context.scene) is not None:
        return cuts.plane_in_model(context.scene)
    raise InputRefused(
        "there is nothing to draw on",
        advice="add a section plane, or place an image and make it the active object",
    )


def on_plane(scene, ray, plane):
    """(3,) in model coordinates where a ray (start, direction) of the world meets a plane (point, normal) of
    the model; None where it does not."""
    stretched = exaggeration.matrix(scene)
    start = np.linalg.solve(stretched, np.append(np.array(ray[0], np.float64), 1.0))[:3]
    along = np.linalg.solve(stretched[:3, :3], np.array(ray[1], np.float64))
    start = start + project_settings.model_origin(scene)
    point, normal = (np.asarray(vector, np.float64) for vector in plane)
    towards = along @ normal
    if abs(towards) < 1e-6 * np.linalg.norm(along):
        return None
    return start + (point - start) @ normal / towards * along


def add_contacts(scene, row, points):
    """Adds points (P, 3) in model coordinates to those that a surface is made from. Raises InputRefused where
    it is a ready mesh."""
    if row.source == "POINTS_OBJECT" and row.object is not None:
        _add_to_mesh(scene, row.object, points, np.empty((0, 2), np.int32))
    else:
        existing = borehole_points.own_points(scene, row)
        if existing is None:
            raise InputRefused(
                f"'{row.name}' is made of an object or a mesh, and takes no points",
                advice="make a surface from points the active one",
            )
        with settings.filling():
            borehole_points.keep_points(row, np.concatenate([existing, points]))
        scene.realmodel.show_data = True
    data_objects.update(scene)
    live.touch(scene)


def add_sticks(scene, row, lines):
    """Adds sticks through points, (P, 3) each in model coordinates, to those that a fault is fitted through,
    which are an object from now on. Raises InputRefused where the fault is made of something else."""
    if any(len(points) < 2 for points in lines):
        raise InputRefused("a stick needs two points", advice="draw a line along the fault")
    sticks = _sticks(scene, row)
    if sticks is not None:
        obj = bpy.data.objects.new(f"{row.name} sticks", bpy.data.meshes.new(f"{row.name} sticks"))
        obj.show_in_front = True  # they run through the blocks
        scene.collection.objects.link(obj)
        for stick in sticks:
            _add_to_mesh(scene, obj, stick, _along(len(stick)))
        with settings.filling():
            row.source, row.object, row.filepath = "STICKS_OBJECT", obj, ""
            method_settings.fill_reading(row)
            row.stick, row.interface_digest = "", ""
            project_settings.forget_shape(row)
    for points in lines:
        _add_to_mesh(scene, row.object, points, _along(len(points)))
    data_objects.update(scene)
    live.touch(scene)


def _sticks(scene, row):
    """The sticks of a fault that are no object yet; None where they are one. Raises InputRefused."""
    if row.source == "STICKS_OBJECT" and row.object is not None:
        if row.object.type != "MESH":
            what = f"the sticks of '{row.name}' are a curve"
            raise InputRefused(what, advice="convert it to a mesh (Object > Convert), or draw in the curve")
        return None
    path = project_settings.absolute(row.filepath)
    if row.source == "POINTS_FILE" and path is not None:
        point_file, column = method_settings.point_file(row, path), method_settings.value(row, "stick", FAULT)
        sticks, _ = read_fault_points(point_file, column, scene.realmodel.units)
        if isinstance(sticks, np.ndarray):
            what = f"'{row.name}' is made of scattered points, which no stick can join"
            raise InputRefused(what, advice="draw into a new fault (+)")
        return sticks
    if row.object is not None or path is not None or project_settings.stored_shape(row):
        what = f"the surface of '{row.name}' is there already"
        raise InputRefused(what, advice="draw into a new fault (+)")
    return []


def _along(count):
    first = np.arange(count - 1, dtype=np.int32)
    return np.column_stack([first, first + 1])


def _add_to_mesh(scene, obj, points, edges):
    """Adds vertices at places in model coordinates to a mesh object, and edges between them."""
    if obj.mode == "EDIT" or obj.library is not None:
        raise InputRefused(f"'{obj.name}' is being edited, or linked", advice="leave Edit Mode first")
    obj.data = obj.data if obj.data.users == 1 else obj.data.copy()
    matrix = np.linalg.inv(exaggeration.true_matrix(obj))
    offsets = points - project_settings.model_origin(scene)
    local = offsets @ matrix[:3, :3].T + matrix[:3, 3]
    mesh = obj.data
    first, edge = len(mesh.vertices), len(mesh.edges)
    mesh.vertices.add(len(local))
    for number, place in enumerate(local.tolist(), first):
        mesh.vertices[number].co = place
    mesh.edges.add(len(edges))
    for number, ends in enumerate((edges + first).tolist(), edge):
        mesh.edges[number].vertices = ends
    mesh.update(calc_edges_loose=True)  # other edges without faces are not drawn in Blender 3.4


def lines_of(scene, item, depsgraph):
    """The lines (N, 3) of a curve or mesh object in model coordinates. Raises InputRefused."""
    return [line + project_settings.model_origin(scene) for line in shapes.lines(item, depsgraph)]
