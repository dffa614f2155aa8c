# SPDX-License-Identifier: GPL-3.0-or-later
"""The proposal that the model was made from: what was decided, why, and what is not certain."""

import bpy

from .lists import OfRows
from .panel import TabPanel, message, right_label

_ICONS = {
    **dict.fromkeys(("alternative", "lens", "repeat", "warning"), "QUESTION"),
    "conflict": "ERROR",
}


class REALMODEL_UL_proposal(OfRows, bpy.types.UIList):
    """What a proposal has decided, and what it could not decide."""

    def draw_row(self, _context, row, item):
        row.label(text=item.name, icon=_ICONS.get(item.kind, "CHECKMARK"))
        right_label(row, f"{item.hole} {item.depth}".strip())


class REALMODEL_PT_proposal(TabPanel, bpy.types.Panel):
    bl_label = "Proposal"
    bl_parent_id = "REALMODEL_PT_start"

    @classmethod
    def poll(cls, context):
        return len(context.scene.realmodel.proposal) > 0

    def draw_in(self, layout, _context, group):
        layout.template_list("REALMODEL_UL_proposal", "", group, "proposal", group, "active_reason", rows=6)
        if not 0 <= group.active_reason < len(group.proposal):
            return
        row = group.proposal[group.active_reason]
        column = layout.box().column(align=True)
        message(column, f"{row.name}: {row.text}")
        if row.hole:
            column.operator("realmodel.proposal_show", icon="ZOOM_SELECTED")
