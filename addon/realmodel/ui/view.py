# SPDX-License-Identifier: GPL-3.0-or-later
"""How the model is looked at."""

import bpy

from .panel import TabPanel, hint


class REALMODEL_PT_view(TabPanel, bpy.types.Panel):
    bl_label = "View"
    bl_idname = "REALMODEL_PT_view"
    bl_order = 4

    def draw_in(self, layout, _context, group):
        if not len(group.results):
            hint(layout, "Build the model first; then choose here how it is shown.")
            return
        layout.prop(group, "display")


CLASSES = (REALMODEL_PT_view,)
