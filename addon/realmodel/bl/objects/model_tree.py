# SPDX-License-Identifier: GPL-3.0-or-later
"""A model as a Blender scene: collections, interfaces, blocks, and what says which is which.

    <project>                     collection, realmodel = "project"
      <rock>                      collection, realmodel = "rock"; one per rock mass
        <rock> interfaces         collection, realmodel = "interfaces"
          <surface>               mesh object, realmodel = "interface": the input triangulation
        <rock> blocks             collection, realmodel = "blocks"
          <block>                 mesh object, realmodel = "block": closed boundary of the block

Names are unique in a .blend file, so Blender may add ".001" to them; the custom properties keep the
names that the project gives: `realmodel_rock`, `realmodel_surface` (for a block the surface it was
deposited beneath), `realmodel_block`, and `realmodel_property`, the library ID.
"""

import bpy

from . import materials

TAG = "realmodel"
ROCK = "realmodel_rock"
SURFACE = "realmodel_surface"
BLOCK = "realmodel_block"
PROPERTY = "realmodel_property"
OBJECT_KINDS = ("interface", "fault", "body", "block")


def is_name_of(name, wanted):
    """Whether a name is the wanted one or what Blender makes of it where it is taken ("S0.001")."""
    base, _, number = name.rpartition(".")
    return name == wanted or (base == wanted and number.isdecimal())


def give_name(store, datablock, name):
    """Name a datablock if the name is free. Otherwise Blender would rename the other datablock. An object
    that is being edited keeps its name: the undo steps of edit mode find it by that, and one that they do not
    find ends Blender."""
    is_edited = isinstance(datablock, bpy.types.Object) and datablock.mode != "OBJECT"
    if datablock.name != name and name not in store and not is_edited:
        datablock.name = name


def model_collection(scene):
    """The collection of the model in a scene, wherever the user may have moved it, or None."""
    return next((c for c in scene.collection.children_recursive if c.get(TAG) == "project"), None)


def model_objects(scene, kind=None):
    """The model's objects in a scene: interfaces, faults and bodies among them, and blocks, or only one kind;
    those of a kind oldest first."""
    project = model_collection(scene)
    if project is None:
        return []
    kinds = OBJECT_KINDS if kind is None else (kind,)
    objects = []
    for collection in project.children_recursive:
        objects += [o for o in collection.objects if o.get(TAG) in kinds]
    return objects


def sections(scene):
    """The objects of sections and fences in a scene."""
    return [obj for obj in scene.objects if obj.get(TAG) == "section"]


def remove_objects(objects):
    """Remove objects with their meshes; those of other files stay. One that is being edited stays as an
    object of the user: undo steps of edit mode that do not find theirs end Blender."""
    for obj in objects:
        if obj.mode != "OBJECT":
            for key in list(obj.keys()):
                if key.startswith(TAG):
                    del obj[key]
        elif obj.library is None:
            mesh = obj.data
            bpy.data.objects.remove(obj)
            if not mesh.users:
                bpy.data.meshes.remove(mesh)


def remove_unused_materials(besides=()):
    """Remove the unused materials of properties, except for some."""
    excepted = set(besides)
    for material in list(bpy.data.materials):
        if materials.KEY in material and not (material.users or material.library or material in excepted):
            bpy.data.materials.remove(material)


def release_collection(collection):
    """Remove a collection of the model, or None; one that is not empty becomes an ordinary collection of the
    user."""
    if collection is None:
        return
    if not len(collection.objects) and not len(collection.children):
        bpy.data.collections.remove(collection)
        return
    for key in (TAG, ROCK):
        collection.pop(key, None)
