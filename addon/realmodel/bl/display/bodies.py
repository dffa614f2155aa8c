# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects for display only: cut halves of blocks, single cells, points and lines of renders. They are in the
collection "<project> view" beside the model, each a child of the block that it stands for, and move with
it."""

import bpy
import numpy as np
from mathutils import Matrix

from ..objects import exaggeration, meshes, model_tree
from . import replacing

KIND = "realmodel_view"  # on an object: its purpose
CUT, CELLS, MARKS, PLANE, SECTION = "cut", "cells", "marks", "plane", "section"
SURVIVING, RESIDUALS = "surviving", "residuals"


def of_kind(scene, kind):
    """{block object: body} of the bodies of a kind."""
    return {body.parent: body for body in listed(scene, kind) if body.parent is not None}


def listed(scene, kind):
    """All bodies of a kind, also those whose block was removed."""
    collection = scene.realmodel.view.collection
    return [] if collection is None else [body for body in collection.objects if body.get(KIND) == kind]


def put(scene, kind, shapes, material=None):
    """Makes the bodies of a kind, in place of the present ones.

    shapes: for each block that has one (block object, PolygonMesh). material: if it is not the block's.
    """
    bodies_of_blocks = of_kind(scene, kind)
    wanted = {block for block, _ in shapes}
    remove(scene, kind, [body for body in listed(scene, kind) if body.parent not in wanted])
    for block, shape in shapes:
        body = bodies_of_blocks.get(block)
        if body is not None and body.data.users == 1:
            replacing.give_shape(body, shape)
        else:
            body = add(scene, kind, f"{block.name} {kind}", shape)
            body[model_tree.BLOCK] = block.get(model_tree.BLOCK, "")
            body.hide_viewport = kind == MARKS  # viewports draw marks themselves
            body.parent = block
        if kind == SURVIVING:  # its mesh is in the coordinates of the model, not in those of the interface
            body.matrix_parent_inverse = Matrix(np.linalg.inv(exaggeration.true_matrix(block)))
        if material is None:
            _take_material(body, block)
        elif not len(body.data.materials):
            body.data.materials.append(material)


def add(scene, kind, name, shape):
    """A new body of a kind; shape: PolygonMesh. Returns its object."""
    body = bpy.data.objects.new(name, meshes.new_mesh(name, shape))
    body[KIND], body[model_tree.TAG] = kind, "view"
    body.hide_select = True
    view_collection(scene).objects.link(body)
    return body


def give_materials(mesh, materials, faces):
    """The material of each part of a mesh, which has so many faces."""
    slots = {}
    for material in materials:
        if material.name not in slots:
            slots[material.name] = len(slots)
            mesh.materials.append(material)
    slots_of_parts = np.array([slots[material.name] for material in materials], np.int32)
    mesh.polygons.foreach_set("material_index", np.repeat(slots_of_parts, faces))
    mesh.update()


def _take_material(body, block):
    material = block.material_slots[0].material if len(block.material_slots) else None
    slots = body.data.materials
    if not len(slots):
        slots.append(material)
    elif slots[0] != material:
        slots[0] = material


def follow_materials(scene):
    """The bodies take the materials that their blocks have now."""
    for kind in (CUT, CELLS, SURVIVING):
        for block, body in of_kind(scene, kind).items():
            _take_material(body, block)


def remove(scene, kind, items=None):
    """Removes the bodies of a kind, or of them only some, with their meshes."""
    for body in listed(scene, kind) if items is None else items:
        replacing.remove(body)
    remove_collection_if_empty(scene)


def remove_collection_if_empty(scene):
    collection = scene.realmodel.view.collection
    if collection is not None and collection.library is None and not len(collection.objects):
        bpy.data.collections.remove(collection)


def view_collection(scene):
    """The collection of objects for display only; made and linked if it does not exist."""
    view, group = scene.realmodel.view, scene.realmodel
    collection = view.collection
    if collection is None or collection.library is not None:
        collection = bpy.data.collections.new(f"{group.name} view")
        collection[model_tree.TAG] = "view"
        view.collection = collection
    if collection not in list(scene.collection.children_recursive):
        parent = group.collection if group.collection is not None else scene.collection
        parent.children.link(collection)
    return collection
