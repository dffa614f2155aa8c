# SPDX-License-Identifier: GPL-3.0-or-later
"""The quality of the active surface: charts and statistics."""

import bpy

from ..bl.project import settings, units
from ..bl.scene import quality
from .panel import FoldedPanel, hint, message

_WORST = 5  # points in the table


class REALMODEL_PT_quality(FoldedPanel, bpy.types.Panel):
    bl_label = "Quality"
    bl_parent_id = "REALMODEL_PT_surfaces"

    @classmethod
    def poll(cls, context):
        return len(context.scene.realmodel.results) > 0 and settings.active_surface(context.scene) is not None

    def draw_in(self, layout, context, _group):
        working = quality.state()
        if working is not None:
            row = layout.row(align=True)
            row.label(text=f"{working[1]} {100 * working[0]:.0f} %")
            row.operator("realmodel.stop_check", text="", icon="X")
            return
        surface_quality = quality.found(context.scene)
        if surface_quality is None:
            layout.operator("realmodel.check_quality", icon="VIEWZOOM")
            hint(layout, "Variogram, cross-validation, and mesh of the active surface.")
            return
        chart = context.window_manager.realmodel.chart
        row = layout.row(align=True)
        row.use_property_split = False
        row.prop(context.window_manager.realmodel, "chart", expand=True)
        _draw_picture(layout, context, chart)
        unit = context.scene.realmodel.units
        lines = quality.lines(surface_quality, chart, unit)
        if chart == "CROSS_VALIDATION" and surface_quality.mean_deviation is not None:
            mean, most = (
                units.length_text(context.scene, value)
                for value in (surface_quality.mean_deviation, surface_quality.most_deviation)
            )
            lines.append(f"Standard deviation of the heights: {mean} on average, at most {most}")
        column = layout.column(align=True)
        for line in lines:
            message(column, line)
        if chart == "CROSS_VALIDATION" and surface_quality.cross_validation is not None:
            _draw_worst(layout, surface_quality.cross_validation)
        row = layout.row(align=True)
        saving = row.operator("realmodel.save_chart", text="Save Chart...", icon="FILE_TICK")
        saving.chart = chart
        row.operator("realmodel.check_quality", text="", icon="FILE_REFRESH")


def _draw_picture(layout, context, chart):
    """The chart as wide as the sidebar: Blender leaves a margin of 4 pixels around a picture."""
    unit = 20.0 * (context.preferences.system.ui_scale or 1.0)  # 0 without a window
    width = context.region.width if context.region is not None else 300.0
    size = max(6.0, width / unit - 3.0)
    icon = quality.icon(context.scene, chart, int(size * unit) - 8)
    if icon is not None:
        layout.template_icon(icon_value=icon, scale=size)


def _draw_worst(layout, result):
    """The points with the largest errors, each with a button that moves the 3D cursor there."""
    column = layout.column(align=True)
    column.label(text="Largest errors")
    for number, point in enumerate(result.worst(_WORST)):
        row = column.row(align=True)
        x, y, _ = result.points[point]
        row.label(text=f"{x:,.1f}  {y:,.1f}")
        error = row.row(align=True)
        error.alignment = "RIGHT"
        error.label(text=f"{result.errors[point]:+.3g}")
        error.operator("realmodel.cursor_to_point", text="", icon="PIVOT_CURSOR").index = number
