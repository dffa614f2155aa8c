# SPDX-License-Identifier: GPL-3.0-or-later
"""Vertical exaggeration: the objects of the model are children of an empty that stretches the vertical.
Meshes, exports and coordinates that are read from objects do not change."""

import bpy
import numpy as np
from mathutils import Matrix

KEY = "realmodel_exaggeration"  # on the empty: its scene's model is stretched by it


def factor(scene):
    """The vertical exaggeration with which a scene's model is shown."""
    return float(scene.realmodel.view.exaggeration)


def matrix(scene):
    """(4, 4) float64: from where things are to where they are shown."""
    empty = _empty(scene)
    return np.eye(4) if empty is None else np.array(empty.matrix_basis, np.float64)


def apply(scene, items, base):
    """Shows objects with the vertical exaggeration of the scene, and no others. base: the height that does
    not move."""
    wanted, empty = factor(scene), _empty(scene)
    if wanted == 1.0:
        items = []
    elif empty is None:
        empty = bpy.data.objects.new("Vertical Exaggeration", None)
        empty[KEY] = True
        empty.hide_select = empty.hide_render = True
        empty.empty_display_size = 0.0
        scene.collection.objects.link(empty)
    if empty is None:
        return
    roots = {_root(obj, empty) for obj in items if obj is not None and obj.library is None}
    for obj in [child for child in empty.children if child not in roots]:
        obj.parent = None
    if not roots:
        bpy.data.objects.remove(empty)
        return
    empty.scale.z, empty.location.z = wanted, base * (1.0 - wanted)
    for obj in roots:
        if obj.parent != empty:
            obj.parent = empty
            obj.matrix_parent_inverse = Matrix.Identity(4)


def release(item):
    """An object that stands for the model no more is shown where it is."""
    if item.parent is not None and KEY in item.parent:
        item.parent = None


def world_matrix(item):
    """The world matrix of an object; Blender does not update that of hidden ones."""
    if item.constraints or item.parent_type != "OBJECT":
        return item.matrix_world
    if item.parent is None:
        return item.matrix_basis
    return world_matrix(item.parent) @ item.matrix_parent_inverse @ item.matrix_basis


def true_matrix(item):
    """(4, 4) float64: where an object is, in the coordinates that the model origin is added to."""
    top = item
    while top.parent is not None:
        top = top.parent
    if KEY not in top:
        return np.array(item.matrix_world, np.float64)
    if item.parent == top and not item.constraints:
        return np.array(item.matrix_basis, np.float64)  # exact, where the way there and back would round
    return np.linalg.inv(np.array(top.matrix_basis, np.float64)) @ np.array(item.matrix_world, np.float64)


def _root(obj, empty):
    while obj.parent is not None and obj.parent != empty:
        obj = obj.parent
    return obj


def _empty(scene):
    return next((obj for obj in scene.objects if KEY in obj), None)
