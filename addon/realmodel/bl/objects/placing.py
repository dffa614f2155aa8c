# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects that an operation makes beside another or from it: where they stand, and what is selected."""

import bpy
import numpy as np


def stand_at(item, other):
    """An object stands where another one does, exactly: a matrix could not be taken apart so."""
    item.rotation_mode = other.rotation_mode
    for name in (
        *("location", "rotation_euler", "rotation_quaternion", "rotation_axis_angle", "scale"),
        *("delta_location", "delta_rotation_euler", "delta_rotation_quaternion", "delta_scale"),
        *("parent", "parent_type", "parent_bone", "parent_vertices", "matrix_parent_inverse"),
    ):
        setattr(item, name, getattr(other, name))
    for constraint in other.constraints:
        item.constraints.copy(constraint)


def mean_scale(matrix):
    """By how much a matrix (4, 4) makes lengths larger, in the geometric mean of the axes."""
    return abs(np.linalg.det(matrix[:3, :3])) ** (1.0 / 3.0)


def hide(item):
    if item.name in bpy.context.view_layer.objects:
        item.hide_set(True)
    item.hide_render = True


def select(items, active=None):
    """Selects objects alone. active: None: the first of them, if there is any."""
    layer = bpy.context.view_layer
    layer.update()  # or it would not know new objects
    items = [obj for obj in items if obj.name in layer.objects]
    for obj in layer.objects:
        obj.select_set(False)
    for obj in items:
        obj.select_set(True)
    layer.objects.active = active or (items[0] if items else layer.objects.active)
