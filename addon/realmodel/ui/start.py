# SPDX-License-Identifier: GPL-3.0-or-later
"""The first panel: how a model begins."""

import bpy

from ..bl.host import native
from .panel import FoldedPanel, OfAModel, TabPanel, hint, message


class REALMODEL_PT_start(TabPanel, bpy.types.Panel):
    bl_label = "Start"
    bl_order = 0

    def draw_header_preset(self, _context):
        self.layout.operator("realmodel.documentation", text="", icon="HELP", emboss=False)

    def draw_in(self, layout, _context, group):
        missing = native.missing()
        if missing:
            box = layout.box()
            box.alert = True
            box.label(text="RealModel cannot build here", icon="ERROR")
            message(box, missing)
        if group.exists:
            row = layout.row(align=True)
            row.prop(group, "name", text="")
            row.menu("REALMODEL_MT_start", text="", icon="FILE_FOLDER")
            return
        hint(layout, "Open an example to see what RealModel does, or begin with your own data:")
        column = layout.column(align=True)
        column.operator_menu_enum("realmodel.open_sample", "sample", text="Open Example", icon="EXPERIMENTAL")
        column.operator("realmodel.surface_add", text="Import Surfaces...", icon="IMPORT")
        column.operator("realmodel.boreholes_read", text="Import Field Data...", icon="EMPTY_SINGLE_ARROW")
        column.operator("realmodel.from_selected", text="From Selected Meshes", icon="OUTLINER_OB_MESH")
        column.operator("realmodel.open_project", text="Open Project...", icon="FILE_FOLDER")
        column.operator("realmodel.tiles_read", text="Import Tiles...", icon="MESH_GRID")
        column.operator("realmodel.new", icon="FILE_NEW")


class REALMODEL_MT_start(bpy.types.Menu):
    """Another model, and this one to a project file"""

    bl_label = "Model"

    def draw(self, _context):
        layout = self.layout
        layout.operator_context = "INVOKE_DEFAULT"
        layout.operator("realmodel.new", icon="FILE_NEW")
        layout.operator_menu_enum("realmodel.open_sample", "sample", text="Open Example", icon="EXPERIMENTAL")
        layout.operator("realmodel.open_project", text="Open Project...", icon="FILE_FOLDER")
        layout.operator("realmodel.from_selected", text="From Selected Meshes", icon="OUTLINER_OB_MESH")
        layout.operator("realmodel.tiles_read", text="Import Tiles...", icon="MESH_GRID")
        layout.separator()
        layout.operator("realmodel.save_project", text="Save Project...", icon="FILE_TICK")


class REALMODEL_PT_start_origin(OfAModel, FoldedPanel, bpy.types.Panel):
    bl_label = "Units and Origin"
    bl_parent_id = "REALMODEL_PT_start"

    def draw_in(self, layout, _context, group):
        layout.prop(group, "units")
        layout.prop(group, "crs")
        layout.prop(group, "show_data")
        column = layout.column()
        column.enabled = not len(group.results)
        column.prop(group, "origin")
        layout.operator("realmodel.move_to_zero", icon="EMPTY_AXIS")
