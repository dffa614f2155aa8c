# SPDX-License-Identifier: GPL-3.0-or-later
"""The last refusal of a build, and the way to the place that it speaks of."""

import json

import bmesh
import bpy
import numpy as np

from ...core import InputRefused
from ..host import notices
from ..objects import exaggeration, shapes, viewports, visible
from ..project import project_settings, series_settings
from . import build_job, data_objects

_FRAMED = 0.05  # of the object's size, at least, around a bad place


def forget():
    activity = bpy.context.window_manager.realmodel
    for name in ("problem", "problem_item", "problem_object", "problem_triangles", "problem_place"):
        setattr(activity, name, "")


def tell(text):
    """Says what is of no place and no surface."""
    forget()
    bpy.context.window_manager.realmodel.problem = text


def remember(scene, error):
    """Stores the objects and triangles of a refusal of a scene's model, for `show`."""
    activity = bpy.context.window_manager.realmodel
    activity.problem = notices.in_panel_words(build_job.message(error))
    activity.problem_item = (error.item or "") if isinstance(error, InputRefused) else ""
    row = build_job.refused_surface(scene, error)
    is_given = row is not None and row.source in ("MESH_OBJECT", "TRACE_OBJECT")
    obj = None if row is None else (row.object if is_given else row.interface)
    if project_settings.in_use(obj) and (error.triangles or error.place is not None):
        activity.problem_object = obj.name
        activity.problem_triangles = json.dumps([int(t) for t in error.triangles])
    if isinstance(error, InputRefused) and error.place is not None:
        activity.problem_place = json.dumps([float(value) for value in error.place])


def of_series(rock, row):
    """The last refusal, where it speaks of a series (its row) or of one of its surfaces; else empty."""
    activity = bpy.context.window_manager.realmodel
    members = [f"surface '{rock.surfaces[number].name}'" for number in series_settings.members(rock, row)]
    parts = activity.problem_item.split(", ")
    is_of_it = parts[0] == f"rock '{rock.name}'" and {f"series '{row.name}'", *members} & set(parts[1:2])
    return activity.problem if is_of_it else ""


def has_place(context):
    activity = context.window_manager.realmodel
    return bool(activity.problem_place) or activity.problem_object in bpy.data.objects


def show(context):
    """Selects the bad triangles of the last refusal in edit mode, or moves the 3D cursor to its place and
    selects the object that it speaks of, if there is one yet; and turns the viewport there.

    Raises InputRefused where they are not there any more.
    """
    activity = context.window_manager.realmodel
    obj = bpy.data.objects.get(activity.problem_object)
    obj = None if obj is None or obj.name not in context.view_layer.objects else obj
    if obj is None and not activity.problem_place:
        raise InputRefused("the refused surface is not in this scene any more", advice="build again")
    triangles = json.loads(activity.problem_triangles or "[]")
    if context.mode != "OBJECT":
        bpy.ops.object.mode_set(mode="OBJECT")
    if obj is None:
        _show_place(context, None, json.loads(activity.problem_place))
        return
    visible.show(context.scene, obj, True)
    _open_eyes(context.view_layer.layer_collection, obj)
    if not triangles:
        _show_place(context, obj, json.loads(activity.problem_place))
        return
    depsgraph = context.evaluated_depsgraph_get()
    with shapes.evaluated_mesh(obj, depsgraph) as mesh:
        corners, polygons = shapes.mesh_triangles(mesh), shapes.triangle_polygons(mesh)
        bad = np.array([t for t in triangles if t < len(corners)], np.int64)
        places = shapes.offsets(obj, mesh)[np.unique(corners[bad])]
        same = len(mesh.polygons) == len(obj.data.polygons)
        chosen = set(np.unique(polygons[bad]).tolist()) if same else set()
    _select(context, obj)
    bpy.ops.object.mode_set(mode="EDIT")
    _select_faces(context, obj, chosen)
    _frame(context, places, max(obj.dimensions) * _FRAMED)


def _select(context, obj):
    for other in context.view_layer.objects:
        other.select_set(other == obj)
    context.view_layer.objects.active = obj


def _show_place(context, obj, place):
    """obj: the object that it is of, or None. place: (x, y, z), or (x, y) in the middle of the heights of
    the object or of all data, in model coordinates."""
    scene, items = context.scene, [obj]
    if obj is None:
        items = data_objects.objects(scene) + project_settings.user_objects(scene)
    around = viewports.corners(items)
    offset = np.zeros(3)
    offset[: len(place)] = np.asarray(place) - project_settings.model_origin(scene)[: len(place)]
    at = (exaggeration.matrix(scene) @ np.append(offset, 1.0))[:3]
    if len(place) < 3 and len(around):
        at[2] = (around[:, 2].min() + around[:, 2].max()) / 2
    scene.cursor.location = at
    if obj is not None:
        _select(context, obj)
    size = np.ptp(around, axis=0).max() if len(around) else 1.0
    _frame(context, at[None], size * _FRAMED)


def _open_eyes(layer, obj):
    """The collections that an object stands in are shown, or it could not be edited."""
    is_inside = obj.name in layer.collection.objects
    for child in layer.children:
        if _open_eyes(child, obj):
            is_inside = True
    if is_inside:
        layer.hide_viewport = False
    return is_inside


def _select_faces(context, obj, chosen):
    context.tool_settings.mesh_select_mode = (False, False, True)
    mesh = bmesh.from_edit_mesh(obj.data)
    for sequence in (mesh.verts, mesh.edges, mesh.faces):
        for element in sequence:
            element.select = False
    for face in mesh.faces:
        if face.index in chosen:
            face.select_set(True)
    mesh.select_flush_mode()
    bmesh.update_edit_mesh(obj.data, loop_triangles=False, destructive=False)


def _frame(context, places, least):
    if not len(places):
        return
    low, high = places.min(axis=0), places.max(axis=0)
    size = max(float(np.linalg.norm(high - low)), least)
    viewports.look_at(context, (low + high) / 2, size)
