# SPDX-License-Identifier: GPL-3.0-or-later
"""Cross-validation by holes, with progress and Esc, and the way to each hole."""

import bpy
from bpy.props import IntProperty

from ..bl.field import hole_validation
from ..bl.scene import live
from ..core import InputRefused
from .background import InBackground
from .reporting import Reporting, a_model, not_building


def any_holes(context):
    has_holes = any(rock.hole_picks or rock.observations for rock in context.scene.realmodel.rocks)
    return None if has_holes else "there are no boreholes; import some first"


def a_table(context):
    count = len(context.scene.realmodel.left_out_holes)
    return None if count else "no holes were left out yet; press Leave Out Holes first"


class REALMODEL_OT_cross_validate_holes(InBackground, bpy.types.Operator):
    """Make the surfaces again without each borehole, and compare: which share of the hole do the others have
    in the right block, and how far off are its contacts? Esc cancels"""

    bl_label = "Leave Out Holes"
    needs = (not_building, a_model, any_holes)

    folds: IntProperty(
        name="Groups",
        description="In how many groups the holes are left out; 0: each by itself, but in at most 20",
        min=0,
    )

    def begin(self, context):
        live.postpone_work()
        if self.folds == 1:
            raise InputRefused("all holes would be left out at once", advice="use two groups or more")
        return hole_validation.HoleValidationJob(context.scene, self.folds or None)

    def tell_done(self, found):
        self.report({"INFO"}, found.summary())


class REALMODEL_OT_left_out_hole_show(Reporting, bpy.types.Operator):
    """Turn the viewport to the hole of the active row, and show the boreholes with their names"""

    bl_label = "Show Hole"
    needs = (a_table,)

    def act(self, context):
        group = context.scene.realmodel
        if not 0 <= group.active_left_out_hole < len(group.left_out_holes):
            raise InputRefused("no row of the table is active", advice="choose a row")
        hole_validation.show(context)


class REALMODEL_OT_left_out_holes_clear(Reporting, bpy.types.Operator):
    """Remove the table of holes that were left out"""

    bl_label = "Remove Table"
    needs = (a_table,)

    def act(self, context):
        hole_validation.clear(context.scene.realmodel)
