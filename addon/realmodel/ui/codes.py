# SPDX-License-Identifier: GPL-3.0-or-later
"""The table of the codes of units in field data, with buttons that regroup them, and the list of the problems
of boreholes, with a button for each."""

from collections import Counter

import bpy

from ..bl.project import imported, settings, units
from ..core.readers.tables.hole_problems import DECIDED
from .lists import OfRows
from .panel import FoldedPanel, hint, message, right_label


def _columns(layout):
    """Of the table: a tick and the code, holes, length, unit."""
    split = layout.split(factor=0.3)
    code, rest = split.row(), split.split(factor=0.25)
    holes, rest = rest.row(), rest.split(factor=0.55)
    return code, holes, rest.row(), rest.row()


class REALMODEL_UL_codes(OfRows, bpy.types.UIList):
    """Codes of field data."""

    def draw_row(self, context, row, item):
        code, holes, length, unit = _columns(row)
        code.use_property_split = False
        code.prop(item, "chosen", text=item.name)
        right_label(holes, str(item.holes))
        right_label(length, f"{item.length:,.0f}" if item.length else "")
        unit.active = bool(item.unit)
        unit.label(text=imported.unit_text(settings.active_rock(context.scene), item))


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
        unit = units.unit_text(context.scene, 1)
        for part, text in zip(_columns(layout), ("Code", "In", unit, "Unit"), strict=True):
            part.label(text=text) if text in ("Code", "Unit") else right_label(part, text)
        layout.template_list("REALMODEL_UL_codes", "", rock, "codes", rock, "active_code", rows=6)
        chosen = sum(row.chosen for row in rock.codes)
        row = layout.row(align=True)
        row.operator("realmodel.codes_choose", text="None" if chosen else "All", icon="CHECKBOX_HLT")
        row.operator("realmodel.codes_reset", text="Reset", icon="LOOP_BACK")
        row.operator("realmodel.codes_ignore", text="Ignore", icon="X")
        row.operator("realmodel.codes_move", text="", icon="TRIA_UP").direction = "UP"
        row.operator("realmodel.codes_move", text="", icon="TRIA_DOWN").direction = "DOWN"
        text = f"Assign {chosen} to Unit..." if chosen else "Assign by Pattern..."
        layout.operator("realmodel.codes_assign", text=text, icon="FORWARD")
        if 0 <= rock.active_code < len(rock.codes):
            active = rock.codes[rock.active_code]
            length = units.length_text(context.scene, active.length)
            said = f"{active.name}: {active.rows} rows in {active.holes} holes, {length}"
            hint(layout, f"{said}; means {imported.unit_text(rock, active)}")


class REALMODEL_UL_hole_problems(OfRows, bpy.types.UIList):
    """Problems of boreholes; the button refuses the repair of a row, or has it repaired again."""

    def draw_item(self, context, layout, _data, item, _icon, _active_data, _active_name, index):
        split = layout.row(align=True).split(factor=0.4)
        split.label(text=f"{item.hole} {item.depth}".strip() or item.file)
        row = split.row(align=True)
        row.label(text=item.kind.replace("_", " "))
        is_decided = item.kind in DECIDED
        button = row.operator(
            "realmodel.hole_problem_decide", text="", icon="TOOL_SETTINGS" if is_decided else "LOOP_BACK"
        )
        button.index, button.decision = index, "REPAIR" if is_decided else "WRITTEN"


class REALMODEL_PT_hole_problems(FoldedPanel, bpy.types.Panel):
    bl_label = "Problems"
    bl_parent_id = "REALMODEL_PT_field"

    @classmethod
    def poll(cls, context):
        rock = settings.active_rock(context.scene)
        return rock is not None and len(rock.hole_problems) > 0

    def draw_in(self, layout, context, _group):
        rock = settings.active_rock(context.scene)
        kinds = Counter(row.kind.replace("_", " ") for row in rock.hole_problems)
        counted = ", ".join(f"{count} x {kind}" for kind, count in kinds.most_common())
        message(layout.column(align=True), f"{len(rock.hole_problems)} rows: {counted}.")
        layout.template_list(
            *("REALMODEL_UL_hole_problems", "", rock, "hole_problems", rock, "active_hole_problem"), rows=5
        )
        if not 0 <= rock.active_hole_problem < len(rock.hole_problems):
            return
        row = rock.hole_problems[rock.active_hole_problem]
        column = layout.box().column(align=True)
        message(column, f"{row.file}: {row.text}")
        message(column, f"Action: {row.action}")
        column.operator("realmodel.hole_problem_show", text="Show", icon="ZOOM_SELECTED")
        for item in _decisions(row):
            column.operator("realmodel.hole_problem_decide", text=item[1]).decision = item[0]


def _decisions(row):
    """(decision, label) of what else may become of the row of a problem."""
    now = {"unrepaired": "WRITTEN", "switched_off": "LEFT_OUT"}.get(row.kind, "REPAIR")
    words = {"REPAIR": "Repair", "WRITTEN": "Use as Written", "LEFT_OUT": "Leave Out"}
    return [(decision, label) for decision, label in words.items() if decision != now]
