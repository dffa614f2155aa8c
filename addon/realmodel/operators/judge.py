# SPDX-License-Identifier: GPL-3.0-or-later
"""The quality of a surface: its charts, and its worst points."""

import bpy
from bpy.props import EnumProperty, IntProperty

from ..bl.field import hole_validation
from ..bl.project import project_settings, settings
from ..bl.scene import live, quality
from ..core import InputRefused, UsageError
from ..core.drawing import DRAWINGS, save_drawing
from .files import Exporting, format_filter, format_menu
from .reporting import InBackground, Reporting, a_model, a_surface, not_building, some_holes


def _a_result(context):
    return (
        None
        if quality.found(context.scene) is not None
        else "the quality of this surface was not checked yet"
    )


def _checking(_context):
    return None if quality.state() is not None else "no surface is being checked"


class REALMODEL_OT_check_quality(Reporting, bpy.types.Operator):
    """Check how well the active surface fits its points: estimate each point from the others, and measure the
    triangles"""

    bl_label = "Check Quality"
    bl_options = {"REGISTER"}
    needs = (a_surface, a_model, not_building)

    def act(self, context):
        quality.check(context.scene)

    def invoke(self, context, _event):
        if bpy.app.background:
            return self.execute(context)
        quality.start(context.scene)
        return {"FINISHED"}


class REALMODEL_OT_stop_check(Reporting, bpy.types.Operator):
    """Stop checking the quality of a surface"""

    bl_label = "Cancel"
    bl_options = {"REGISTER", "INTERNAL"}
    needs = (_checking,)

    def act(self, _context):
        quality.stop()


class REALMODEL_OT_save_chart(Exporting, bpy.types.Operator):
    """Save a chart of the active surface as a picture"""

    bl_label = "Save Chart"
    needs = (a_surface, _a_result)

    format: format_menu(DRAWINGS)
    filter_glob: format_filter(DRAWINGS)
    chart: EnumProperty(name="Chart", description="Which chart is saved", items=quality.CHARTS)

    def of_what(self, context):
        return settings.active_surface(context.scene).name, self.chart.lower()

    def write(self, context, path):
        surface_quality = quality.found(context.scene)
        drawn = quality.drawing(surface_quality, self.chart, context.scene.realmodel.units)
        if drawn is None:
            raise UsageError("the surface has no such chart")
        save_drawing(drawn, path)


class REALMODEL_OT_cursor_to_point(Reporting, bpy.types.Operator):
    """Move the 3D cursor to one of the points of the active surface with the largest errors"""

    bl_label = "Cursor to Point"
    needs = (a_surface, _a_result)

    index: IntProperty(name="Point", description="Its row in the table of the largest errors", min=0)

    def act(self, context):
        result = quality.found(context.scene).cross_validation
        worst = result.worst(self.index + 1) if result is not None else ()
        if len(worst) <= self.index:
            raise UsageError(f"there is no point {self.index}")
        place = result.points[worst[self.index]] - project_settings.model_origin(context.scene)
        context.scene.cursor.location = place


def unregister():
    quality.forget()


def a_table(context):
    count = len(context.scene.realmodel.left_out_holes)
    return None if count else "no holes were left out yet; press Leave Out Holes first"


class REALMODEL_OT_cross_validate_holes(InBackground, bpy.types.Operator):
    """Predict each borehole from the others: report the share of the hole in the right block, and the errors
    of its contacts. Esc cancels"""

    bl_label = "Leave Out Holes"
    needs = (not_building, a_model, some_holes)

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
    """Remove the table of left-out holes"""

    bl_label = "Remove Table"
    needs = (a_table,)

    def act(self, context):
        hole_validation.clear(context.scene.realmodel)
