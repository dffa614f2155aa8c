# SPDX-License-Identifier: GPL-3.0-or-later
"""The table of the codes of units in field data, and buttons that regroup them."""

import bpy

from ..bl.project import settings, units
from .lists import OfRows
from .panel import FoldedPanel, hint, message, right_label


def _columns(layout):
    """Of the table: a tick and the code, holes, length, unit."""
    split = layout.split(factor=0.38)
    code, rest = split.row(align=True), split.split(factor=0.18)
    holes, rest = rest.row(), rest.split(factor=0.4)
    return code, holes, rest.row(), rest.row()


class REALMODEL_UL_codes(OfRows, bpy.types.UIList):
    """Codes of field data."""

    def draw_row(self, context, row, item):
        code, holes, length, unit = _columns(row)
        code.prop(item, "chosen", text="")
        code.label(text=item.name)
        right_label(holes, str(item.holes))
        right_label(length, units.length_text(context.scene, item.length) if item.length else "")
        unit.active = bool(item.unit)
        unit.label(text=item.unit or "nothing")


class REALMODEL_PT_codes(FoldedPanel, bpy.types.Panel):
    bl_label = "Codes"
    bl_parent_id = "REALMODEL_PT_field"

    @classmethod
    def poll(cls, context):
        rock = settings.active_rock(context.scene)
        return rock is not None and len(rock.codes) > 0

    def draw_in(self, layout, context, _group):
        rock = settings.active_rock(context.scene)
        means = {row.unit for row in rock.codes if row.unit}
        message(layout.column(align=True), f"{len(rock.codes)} codes mean {len(means)} units.")
        for part, text in zip(_columns(layout), ("Code", "Holes", "Length", "Unit"), strict=True):
            part.label(text=text) if text in ("Code", "Unit") else right_label(part, text)
        layout.template_list("REALMODEL_UL_codes", "", rock, "codes", rock, "active_code", rows=6)
        chosen = sum(row.chosen for row in rock.codes)
        row = layout.row(align=True)
        row.operator("realmodel.codes_choose", text="None" if chosen else "All", icon="CHECKBOX_HLT")
        row.operator("realmodel.codes_reset", text="Reset", icon="LOOP_BACK")
        row.operator("realmodel.codes_ignore", text="Ignore", icon="X")
        text = f"Assign {chosen} to Unit..." if chosen else "Assign by Pattern..."
        layout.operator("realmodel.codes_assign", text=text, icon="FORWARD")
        if 0 <= rock.active_code < len(rock.codes):
            active = rock.codes[rock.active_code]
            rows = f"{active.rows} rows in {active.holes} holes"
            hint(layout, f"{active.name}: {rows}; means {active.unit or 'nothing'}")
