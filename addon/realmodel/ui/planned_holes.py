# SPDX-License-Identifier: GPL-3.0-or-later
"""Planned holes: where they go, and the table of what the active one meets."""

import bpy

from ..bl.host.notices import in_panel_words
from ..bl.project import library_rows, units
from ..bl.scene import planned_holes
from ..core import RealModelError
from .lists import OfRows, draw_swatch
from .panel import FoldedPanel, OfABuiltModel, hint, right_label


class REALMODEL_UL_planned_holes(OfRows, bpy.types.UIList):
    """Planned holes."""

    def draw_row(self, context, row, item):
        row.prop(item, "name", text="", emboss=False, icon="EMPTY_SINGLE_ARROW")
        right_label(row, units.length_text(context.scene, item.length))


class REALMODEL_PT_planned_holes(OfABuiltModel, FoldedPanel, bpy.types.Panel):
    bl_label = "Planned Holes"
    bl_parent_id = "REALMODEL_PT_results"

    def draw_in(self, layout, context, group):
        scene = context.scene
        row = layout.row()
        row.template_list(
            "REALMODEL_UL_planned_holes", "", group, "planned_holes", group, "active_planned_hole", rows=2
        )
        buttons = row.column(align=True)
        buttons.operator("realmodel.planned_hole_add", text="", icon="ADD")
        buttons.operator("realmodel.planned_hole_remove", text="", icon="REMOVE")
        hole = planned_holes.active(scene)
        if hole is None:
            hint(layout, "Plan a hole to see which blocks it will meet, and how certain they are.")
            return
        column = layout.column(align=True)
        for key in ("east", "north", "height"):
            column.prop(hole, key)
        layout.operator("realmodel.planned_hole_collar", icon="PIVOT_CURSOR")
        column = layout.column(align=True)
        for key in ("azimuth", "dip", "length"):
            column.prop(hole, key)
        _draw_table(layout, scene, hole)
        line = layout.column(align=True)
        line.operator("realmodel.planned_hole_certainty", icon="MOD_ARRAY")
        line.operator("realmodel.planned_hole_save", text="Save Table...", icon="FILE_TICK")


def _draw_table(layout, scene, row):
    try:
        hole = planned_holes.kept(row)
    except RealModelError as error:
        hint(layout, str(error))
        return
    if hole is None:
        hint(layout, "Click Build to see the blocks along the hole.")
        return
    if not hole.intervals:
        hint(layout, "The hole meets no block.")
        return
    box = layout.box().column(align=True)
    unit, factor = units.shown_unit(scene, 1)
    has_shares = hole.probability is not None
    _line(box, "From", "Depth", "±", "%" if has_shares else "")
    for interval in hole.rows():
        deviation = interval["from_deviation"]
        line = box.row(align=True)
        draw_swatch(line, library_rows.find(scene, interval["property"]))
        line.label(text=interval["name"])
        _line(
            box,
            f"{factor * interval['from']:.2f}",
            f"{factor * interval['vertical_from']:.2f}",
            "" if deviation is None else f"{factor * deviation:.2f}",
            f"{100 * interval['probability']:.0f}" if has_shares else "",
        )
    end = hole.rows()[-1]
    deviation = end["to_deviation"]
    box.label(text="End of the rock" if end["to"] < hole.axis.length else "End of the hole")
    _line(
        box,
        f"{factor * end['to']:.2f}",
        f"{factor * end['vertical_to']:.2f}",
        "" if deviation is None else f"{factor * deviation:.2f}",
        "",
    )
    hint(layout, f"From: along the hole; Depth: below its collar; in {unit}.")
    for text in hole.remarks:
        hint(layout, in_panel_words(text))


def _line(layout, *texts):
    """Depth along the hole, vertical depth, standard deviation of the depth, probability."""
    cells = layout.grid_flow(columns=len(texts), even_columns=True, align=True)
    for text in texts:
        right_label(cells, text)
