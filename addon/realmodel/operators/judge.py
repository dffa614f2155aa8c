# SPDX-License-Identifier: GPL-3.0-or-later
"""The quality of a surface: its charts, and its worst points."""

import bpy
from bpy.props import EnumProperty, IntProperty

from ..bl.project import project_settings, settings
from ..bl.scene import quality
from ..core import UsageError
from ..core.drawing import DRAWINGS, save_drawing
from .files import Exporting, format_filter, format_menu
from .reporting import Reporting, a_model, a_surface, not_building


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
    """Move the 3D cursor to a point of the active surface, one of those with the largest errors"""

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
