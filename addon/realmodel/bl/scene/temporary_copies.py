# SPDX-License-Identifier: GPL-3.0-or-later
"""Copies of objects as they are shown, for as long as something is made of them; afterward the scene is as
before."""

import contextlib

import bpy

from ..objects import filled_beds, model_tree, placing
from ..project import library_rows, settings

_KEPT = (
    *(model_tree.TAG, model_tree.ROCK, model_tree.SURFACE, model_tree.BLOCK, model_tree.PROPERTY),
    filled_beds.BED,
)


class Copies:
    """items: the copies, objects with meshes of their own. made: what is removed in the end."""

    def __init__(self, collection):
        self.items, self.made, self._names, self._collection = [], [collection], [], collection

    def take_name(self, datablock):
        """The name of a datablock, which is free until the end; names of other files are no hindrance."""
        name = next((name for taken, name in self._names if taken == datablock), datablock.name)
        if datablock.library is None and name == datablock.name:
            self._names.append((datablock, name))
            datablock.name = f"~{len(self._names)}"
        return name

    def add(self, name, mesh, matrix):
        """A new object."""
        item = bpy.data.objects.new(name, mesh)
        self.made += [item, mesh]
        item.matrix_world = matrix
        self._collection.objects.link(item)
        return item

    def keep(self, datablock):
        """A datablock is not removed in the end."""
        self.made = [made for made in self.made if made != datablock]

    def remove(self):
        bpy.data.batch_remove(list(dict.fromkeys(self.made)))
        for datablock, name in reversed(self._names):
            datablock.name = name


@contextlib.contextmanager
def copied(context, items):
    """Adds copies of mesh objects to the scene for a while; only the copies are selected, and rendered in
    their place. They have the names of the objects and their custom properties."""
    layer = context.view_layer
    selected, active = list(context.selected_objects), layer.objects.active
    rendered = [obj for obj in items if not obj.hide_render and obj.library is None]
    copies = Copies(bpy.data.collections.new("RealModel copies"))
    try:
        context.scene.collection.children.link(copies.made[0])
        depsgraph = context.evaluated_depsgraph_get()
        seen = [obj.evaluated_get(depsgraph) for obj in items]
        new = [
            bpy.data.meshes.new_from_object(obj, preserve_all_data_layers=True, depsgraph=depsgraph)
            for obj in seen
        ]
        copies.made += new  # also where what follows fails
        for obj, mesh in zip(items, new, strict=True):
            mesh.name = copies.take_name(obj.data)
            copies.items.append(copies.add(copies.take_name(obj), mesh, obj.matrix_world))
            _copy_properties(context.scene, obj, copies.items[-1])
        for obj in rendered:
            obj.hide_render = True
        placing.select(copies.items)
        yield copies
    finally:
        for obj in rendered:
            obj.hide_render = False
        copies.remove()
        placing.select(selected, active)


def _copy_properties(scene, obj, copy):
    for key in obj.keys():  # noqa: SIM118 - objects of Blender are not iterable
        if key in _KEPT or not key.startswith(model_tree.TAG):
            copy[key] = obj[key]
    row = library_rows.find(scene, obj.get(model_tree.PROPERTY))
    if row is not None:
        copy[f"{model_tree.TAG}_name"] = row.name
        for key in ("rock", "age", "structure", "description"):
            if getattr(row, key):
                copy[f"{model_tree.TAG}_property_{key}"] = getattr(row, key)
        for key in ("density", "porosity", "permeability"):
            if settings.number(row, key):
                copy[f"{model_tree.TAG}_property_{key}"] = settings.number(row, key)
