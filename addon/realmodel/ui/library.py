# SPDX-License-Identifier: GPL-3.0-or-later
"""The library of properties."""

import bpy

from ..bl.project import library_rows
from .panel import FoldedPanel, hint


class REALMODEL_PT_library(FoldedPanel, bpy.types.Panel):
    bl_label = "Library"
    bl_order = 7

    def draw_in(self, layout, _context, group):
        if not len(group.library):
            hint(
                layout,
                "The library says what blocks are made of: name, age, color. Add an entry or import one.",
            )
        row = layout.row()
        row.template_list("REALMODEL_UL_library", "", group, "library", group, "active_property", rows=4)
        buttons = row.column(align=True)
        buttons.operator("realmodel.library_add", text="", icon="ADD")
        buttons.operator("realmodel.library_remove", text="", icon="REMOVE")
        line = layout.row(align=True)
        line.operator("realmodel.library_import", text="Import...", icon="IMPORT")
        line.operator("realmodel.library_export", text="Export...", icon="EXPORT")
        if not len(group.library):
            return
        entry = group.library[min(group.active_property, len(group.library) - 1)]
        for key in ("name", "id", "color", "rock", "age", "structure", "description"):
            layout.prop(entry, key)
        for key in ("density", "porosity", "permeability", "look"):
            layout.prop(entry, key)
        if entry.look not in {library_rows.NO_LOOK, "FLAT"}:
            line = layout.row(align=True)
            line.prop(entry, "look_scale", text="Scale")
            line.prop(entry, "look_seed", text="Seed")
        layout.prop(entry, "hardness")
        layout.operator("realmodel.assign_property", icon="MATERIAL")
        line = layout.row(align=True)
        line.operator("realmodel.rock_looks", text="Rock Looks...", icon="SHADING_RENDERED")
        line.operator("realmodel.install_looks", text="", icon="ASSET_MANAGER")
        line = layout.row(align=True)
        line.operator("realmodel.weathering", icon="MOD_NOISE")
        line.operator("realmodel.weathering_remove", text="", icon="X")
