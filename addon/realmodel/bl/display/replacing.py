# SPDX-License-Identifier: GPL-3.0-or-later
"""Replaces the shapes of objects, also from the frame handler while an animation is rendered.

A renderer still uses the data of the previous frame, so nothing may be freed while it works: then meshes are
exchanged instead of refilled, and unused ones are removed when the render has ended.
"""

import bpy

from ..host import caches
from ..objects import meshes, meshes_ahead, model_tree

_rendering = False
_left_meshes = caches.new(list)  # names
_left_objects = caches.new(list)


def begin_render():
    global _rendering
    _rendering = True


def end_render():
    """Removes unused data a moment later, as the renderer may still free its own."""
    global _rendering
    _rendering = False
    if bpy.app.background:
        remove_leftovers()
    elif not bpy.app.timers.is_registered(remove_leftovers):
        bpy.app.timers.register(remove_leftovers, first_interval=0.5)


def is_rendering():
    return _rendering


def must_finish_now():
    """Whether things are to be made at once: a script or a renderer needs them now, and there is no window
    that would freeze."""
    return bpy.app.background or _rendering


def give_shape(item, shape):
    """Replaces the contents of an object's mesh. shape: PolygonMesh."""
    if not _rendering and not meshes_ahead.has(shape):
        meshes.refill(item.data, shape)
        return
    old = item.data
    mesh = meshes.new_mesh(old.name, shape)
    for material in old.materials:
        mesh.materials.append(material)
    slots = [(slot.link, slot.material) for slot in item.material_slots]
    item.data = mesh
    for slot, (link, material) in zip(item.material_slots, slots, strict=False):
        if link == "OBJECT":
            slot.link, slot.material = link, material
    _left_meshes.append(old.name)
    if not _rendering:
        name = old.name
        remove_leftovers()
        model_tree.give_name(bpy.data.meshes, mesh, name)


def remove(item):
    """Removes an object that the view has made, with its mesh."""
    if _rendering:
        item.hide_render = True
        _left_objects.append(item.name)
    else:
        _remove(item)


def _remove(obj):
    is_block = obj.get(model_tree.TAG) == "block"
    model_tree.remove_objects([obj])
    if is_block:
        model_tree.remove_unused_materials()


def remove_leftovers():
    """Removes what renders have left over."""
    if _rendering:
        return
    for name in _left_objects:
        obj = bpy.data.objects.get(name)
        if obj is not None:
            _remove(obj)
    for name in _left_meshes:
        mesh = bpy.data.meshes.get(name)
        if mesh is not None and not mesh.users:
            bpy.data.meshes.remove(mesh)
    _left_objects.clear()
    _left_meshes.clear()


def stop():
    global _rendering
    _rendering = False
    if bpy.app.timers.is_registered(remove_leftovers):
        bpy.app.timers.unregister(remove_leftovers)
