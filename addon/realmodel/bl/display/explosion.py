# SPDX-License-Identifier: GPL-3.0-or-later
"""The blocks moved apart. Only the objects' delta locations are used, so the meshes, and where the user puts
the objects, stay as they are."""

import numpy as np
from mathutils import Vector

from ..objects import block_shapes, meshes
from ..project import settings

KEY = "realmodel_exploded"  # on an object: by how much it was moved, three numbers
_LEAST_STEP = 0.25  # of the model's width: thin layers of a wide model come apart too


def apply(scene, amount, direction):
    """Moves the blocks apart.

    amount: 0 leaves them in place; at 1 the youngest is lifted by the model's height or a quarter of its
    width ("Z"), the blocks are as far from the middle again as they were ("CENTER"), or stand one beside the
    other ("BLOCK"). "COMPARTMENT" leaves the blocks in place: `modes` shows their parts in their stead.
    """
    rows = [row for row in scene.realmodel.results if row.object is not None]
    low, high = bounds(scene)
    extent = high - low
    last = settings.last_stage(scene)
    for row in rows:
        if amount <= 0.0 or direction == "COMPARTMENT":  # these are bodies of their own: `cells`
            move(row.object, (0.0, 0.0, 0.0))
            continue
        rank = settings.time_of_block(scene, row)
        if direction == "Z":
            reach = max(extent[2], _LEAST_STEP * extent[:2].max())
            shift = (0.0, 0.0, amount * reach * rank / max(last, 1))
        elif direction == "BLOCK":
            shift = (amount * 1.1 * extent[0] * rank, 0.0, 0.0)
        else:
            shift = amount * (_center(row.object) - (low + high) / 2)
            shift[2] *= max(1.0, _LEAST_STEP * extent[:2].max() / max(extent[2], 1e-9))
        move(row.object, shift)


def move(item, shift):
    """Moves an object by its delta location, in place of an earlier move."""
    if item.library is not None:
        return
    before = np.array(item.get(KEY, (0.0, 0.0, 0.0)))
    shift = np.asarray(shift, np.float64)
    if np.array_equal(before, shift):
        return
    item.delta_location = Vector(np.array(item.delta_location, np.float64) - before + shift)
    if shift.any():
        item[KEY] = shift.tolist()
    else:
        del item[KEY]
        if np.abs(np.array(item.delta_location)).max() < 1e-6 * max(np.abs(before).max(), 1.0):
            item.delta_location = (0.0, 0.0, 0.0)  # remainders of single precision


def set_bounds(scene, low, high):
    """Stores the size of the whole model: stages of it move apart by the same distances."""
    scene.realmodel.view.bounds_low, scene.realmodel.view.bounds_high = low, high


def bounds(scene):
    """(3,) float64 twice: the lowest and highest coordinates of the whole model, in the objects' own."""
    view = scene.realmodel.view
    if tuple(view.bounds_low) == tuple(view.bounds_high):  # it was built by another version, or in batch
        items = [row.object for row in scene.realmodel.results if _has_mesh(row)]
        return block_shapes.bounds([meshes.mesh_coordinates(obj.data) for obj in items])
    return np.array(view.bounds_low, np.float64), np.array(view.bounds_high, np.float64)


def _has_mesh(row):
    return row.object is not None and row.object.type == "MESH"


def _center(obj):
    coordinates = meshes.mesh_coordinates(obj.data) if obj.type == "MESH" else ()
    if not len(coordinates):
        return np.zeros(3)
    return (coordinates.min(axis=0).astype(np.float64) + coordinates.max(axis=0)) / 2
