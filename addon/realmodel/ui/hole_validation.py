# SPDX-License-Identifier: GPL-3.0-or-later
"""Cross-validation by holes: a table of the holes, each of which leads there."""

import bpy

from ..bl.field import hole_validation
from ..bl.project import units
from .lists import OfRows
from .panel import FoldedPanel, OfABuiltModel, hint, message, right_label


def _columns(layout):
    split = layout.split(factor=0.45)
    name, rest = split.row(), split.split(factor=0.4)
    return name, rest.row(), rest.row()


class REALMODEL_UL_left_out_holes(OfRows, bpy.types.UIList):
    """Holes that were left out, those that the others tell least of first."""

    def draw_row(self, _context, row, item):
        name, share, error = _columns(row)
        name.label(text=item.name, icon="ERROR" if item.refused else "NONE")
        right_label(share, item.share)
        right_label(error, item.error)


class REALMODEL_PT_hole_validation(OfABuiltModel, FoldedPanel, bpy.types.Panel):
    bl_label = "Cross-Validation by Holes"
    bl_parent_id = "REALMODEL_PT_results"

    @classmethod
    def poll(cls, context):
        rocks = context.scene.realmodel.rocks
        return super().poll(context) and any(rock.hole_picks or rock.observations for rock in rocks)

    def draw_in(self, layout, context, group):
        layout.operator("realmodel.cross_validate_holes", icon="VIEWZOOM")
        if not len(group.left_out_holes):
            hint(layout, "Predicts each borehole from the others.")
            return
        row = layout.row()
        column = row.column(align=True)
        message(column, hole_validation.summary(group), taken=4)
        row.operator("realmodel.left_out_holes_clear", text="", icon="X", emboss=False)
        if hole_validation.is_outdated(group):
            hint(layout, "The model was rebuilt: leave the holes out again.")
        unit = units.unit_text(context.scene, 1)
        for part, text in zip(_columns(layout), ("Hole", "%", f"Worst {unit}"), strict=True):
            part.label(text=text) if text == "Hole" else right_label(part, text)
        layout.template_list(
            *("REALMODEL_UL_left_out_holes", "", group, "left_out_holes", group, "active_left_out_hole"),
            rows=5,
        )
        if 0 <= group.active_left_out_hole < len(group.left_out_holes):
            box = layout.box().column(align=True)
            for text in hole_validation.lines(group.left_out_holes[group.active_left_out_hole]):
                message(box, text)
            box.operator("realmodel.left_out_hole_show", text="Show", icon="ZOOM_SELECTED")
