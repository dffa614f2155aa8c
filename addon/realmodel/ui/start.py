# SPDX-License-Identifier: GPL-3.0-or-later
"""The first panel: how a model begins."""

import bpy

from ..bl import native
from .panel import TabPanel, hint, wrapped


class REALMODEL_PT_start(TabPanel, bpy.types.Panel):
    bl_label = "Start"
    bl_idname = "REALMODEL_PT_start"
    bl_order = 0

    def draw_header_preset(self, _context):
        self.layout.operator("realmodel.documentation", text="", icon="HELP", emboss=False)

    def draw_in(self, layout, _context, group):
        missing = native.missing()
        if missing:
            box = layout.box()
            box.alert = True
            box.label(text="RealModel cannot build here", icon="ERROR")
            for line in wrapped(missing):
                box.label(text=line)
        if group.exists:
            layout.prop(group, "name")
            layout.prop(group, "units")
        else:
            hint(
                layout,
                "No model in this scene yet. Open an example to see what RealModel does, or begin here:",
            )
        column = layout.column(align=True)
        column.operator("realmodel.new", icon="FILE_NEW")
        column.operator("realmodel.open_project", text="Open Project...", icon="FILE_FOLDER")
        column.operator_menu_enum("realmodel.open_sample", "sample", text="Open Example", icon="EXPERIMENTAL")
        column.operator("realmodel.from_selected", text="From Selected Meshes", icon="OUTLINER_OB_MESH")
        if group.exists:
            layout.operator("realmodel.save_project", text="Save Project...", icon="FILE_TICK")


CLASSES = (REALMODEL_PT_start,)
