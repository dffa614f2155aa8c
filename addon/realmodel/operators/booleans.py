# SPDX-License-Identifier: GPL-3.0-or-later
"""Exact Booleans of two mesh objects."""

import bpy
from bpy.props import BoolProperty, EnumProperty

from ..bl.objects.boolean_job import DIVIDE, OPERATIONS, BooleanJob
from ..core import InputRefused
from ..core.base.errors import counted, number_list
from .reporting import InBackground, not_building


def _object_mode(context):
    return None if context.mode == "OBJECT" else "this works in Object Mode; leave the other mode first"


def _selected(context):
    active = context.active_object
    if active is None or active.type != "MESH":
        return "the active object is no mesh; make the object that is to be changed active"
    others = [obj for obj in context.selected_objects if obj != active and obj.type == "MESH"]
    if len(others) != 1:
        return "select one other mesh object beside the active one"
    return None


def _two_meshes(context):
    """Valid also after the operation, when the other object is hidden: Blender polls before it repeats the
    operation with settings of the redo panel."""
    done = context.window_manager.operators
    if len(done) and done[-1].bl_idname == REALMODEL_OT_boolean.__name__:
        return None
    return _selected(context)


def _editable(context):
    obj = context.active_object
    if obj is None or (obj.library is None and obj.override_library is None):
        return None
    return f"{obj.name} is linked from another file; make it local first"


class REALMODEL_OT_boolean(InBackground, bpy.types.Operator):
    """Join, intersect, subtract or divide the active mesh object and one other selected, exactly. Materials,
    attributes, UV maps and vertex groups of both stay on their parts. Esc cancels"""

    bl_label = "Boolean"
    needs = (not_building, _object_mode, _two_meshes, _editable)

    operation: EnumProperty(
        name="Operation",
        description="Operation on the two objects",
        items=OPERATIONS,
        default="DIFFERENCE",
    )
    keep_operands: BoolProperty(
        name="Keep Operands",
        description="Keep both objects unchanged and add a new one with the result. Otherwise the active "
        "object becomes the result, its modifiers are applied, and the other object is hidden",
    )

    def begin(self, context):
        reason = _selected(context)
        if reason:
            raise InputRefused(reason)
        active = context.active_object
        other = next(obj for obj in context.selected_objects if obj != active and obj.type == "MESH")
        depsgraph = context.evaluated_depsgraph_get()
        return BooleanJob(context.scene, active, other, self.operation, depsgraph, self.keep_operands)

    def tell_done(self, result):
        made, left_out = result
        if left_out:
            self.report(
                {"WARNING"},
                f"Not taken over, as the first object has others of these names: {number_list(left_out)}",
            )
        if self.operation == DIVIDE:
            self.report({"INFO"}, f"Divided into {counted(len(made.all_objects), 'object')}: see {made.name}")
        else:
            self.report({"INFO"}, f"{made.name} has {counted(len(made.data.polygons), 'face')}")
