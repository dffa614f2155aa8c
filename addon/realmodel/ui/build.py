# SPDX-License-Identifier: GPL-3.0-or-later
"""Building, its progress, and what it had to tell."""

import bpy

from ..bl import settings
from .panel import TabPanel, hint, wrapped

_MOST_WARNINGS = 4
_ICON = 5  # letters that are as wide as an icon and the border of a box


class REALMODEL_PT_build(TabPanel, bpy.types.Panel):
    bl_label = "Build"
    bl_idname = "REALMODEL_PT_build"
    bl_order = 3

    def draw_in(self, layout, context, group):
        activity = context.window_manager.realmodel
        if not settings.has_rows(context.scene):
            hint(layout, "Add surfaces first; then the blocks between them are built here.")
            return
        if activity.running:
            _draw_progress(layout, activity)
        else:
            row = layout.row(align=True)
            row.use_property_split = False
            row.scale_y = 1.4
            row.operator("realmodel.build", icon="MOD_BUILD")
            row.prop(group, "live", text="Live", toggle=True, icon="RECOVER_LAST")
        layout.prop(group, "cells")
        if len(group.results):
            layout.operator("realmodel.clear", icon="X")
        if activity.problem:
            box = layout.box()
            box.alert = True
            for line in wrapped(activity.problem):
                box.label(text=line)
            box.operator("realmodel.show_problem", icon="VIEWZOOM")
        elif group.warnings:
            _draw_warnings(layout.box(), group.warnings.split("\n"))


def _draw_progress(layout, activity):
    column = layout.column()
    column.prop(activity, "progress", slider=True)
    column.label(text=activity.text)
    column.operator("realmodel.cancel", text="Cancel (Esc)", icon="CANCEL")


def _draw_warnings(box, warnings):
    for warning in warnings[:_MOST_WARNINGS]:
        column = box.column(align=True)
        for number, line in enumerate(wrapped(warning, taken=_ICON)):
            column.label(text=line, icon="INFO" if number == 0 else "BLANK1")
    if len(warnings) > _MOST_WARNINGS:
        box.label(text=f"and {len(warnings) - _MOST_WARNINGS} more: see the report")


CLASSES = (REALMODEL_PT_build,)
