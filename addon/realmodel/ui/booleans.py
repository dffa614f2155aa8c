# SPDX-License-Identifier: GPL-3.0-or-later
"""Booleans of two mesh objects."""

import bpy

from ..bl.objects.boolean_job import OPERATIONS
from .panel import FoldedPanel, hint

_ICONS = {
    "UNION": "SELECT_EXTEND",
    "INTERSECT": "SELECT_INTERSECT",
    "DIFFERENCE": "SELECT_SUBTRACT",
    "DIVIDE": "MOD_EXPLODE",
}


class REALMODEL_PT_booleans(FoldedPanel, bpy.types.Panel):
    bl_label = "Booleans"
    bl_order = 8

    def draw_in(self, layout, context, _group):
        if len(context.selected_objects) < 2:
            hint(layout, "Select two mesh objects; the active one is changed.")
        grid = layout.grid_flow(row_major=True, columns=2, even_columns=True, align=True)
        for operation, name, *_ in OPERATIONS:
            grid.operator("realmodel.boolean", text=name, icon=_ICONS[operation]).operation = operation
