# SPDX-License-Identifier: GPL-3.0-or-later
"""The table of blocks, and the model out to files."""

import bpy

from ..bl import units
from .lists import result_columns
from .panel import TabPanel, hint


class REALMODEL_PT_results(TabPanel, bpy.types.Panel):
    bl_label = "Results"
    bl_idname = "REALMODEL_PT_results"
    bl_order = 6

    def draw_in(self, layout, context, group):
        if not len(group.results):
            hint(layout, "Build the model first; its blocks and their volumes are listed here.")
            return
        for column, heading in zip(result_columns(layout), ("Block", "Volume", "%", "Parts"), strict=True):
            column.label(text=heading)
        layout.template_list("REALMODEL_UL_results", "", group, "results", group, "active_result", rows=4)
        layout.label(text=f"Together {units.total_volume_text(context.scene)}")
        layout.operator("realmodel.copy_table", icon="COPYDOWN")
        line = layout.row(align=True)
        line.operator("realmodel.export", text="Export...", icon="EXPORT")
        line.operator("realmodel.report", text="Report...", icon="TEXT")


CLASSES = (REALMODEL_PT_results,)
