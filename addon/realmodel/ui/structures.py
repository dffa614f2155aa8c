# SPDX-License-Identifier: GPL-3.0-or-later
"""The lists of faults and of bodies, and the settings of the active one."""

import bpy

from ..bl.project import library_rows, project_settings, settings
from ..core.project.structure_entries import BODY, FAULT, OF_TRACES
from ..core.settings.data_files import MESH_READING, READING
from . import panel
from .lists import OfRows, draw_swatch
from .panel import FoldedPanel, OfAModel, file_field, hint, right_label
from .surfaces import draw_drawing, draw_figures, draw_filters, draw_property, draw_removable

_EMPTY = {
    "FAULT": "Faults displace the layers. Select open meshes or lines on the ground, import meshes, fault "
    "sticks or lines, or add a fault (+) and draw its sticks.",
    "BODY": "Bodies are another rock in the layers, or a void: intrusions, domes, tunnels. "
    "Select closed meshes, or import them.",
}


class REALMODEL_PT_structures(OfAModel, FoldedPanel, bpy.types.Panel):
    bl_label = "Faults and Bodies"
    bl_order = 5

    def draw_in(self, layout, context, group):
        kind = group.structure_kind
        row = layout.row(align=True)
        row.use_property_split = False
        row.prop(group, "structure_kind", expand=True)
        rows, name = ("faults", "faults") if kind == "FAULT" else ("bodies", "bodies")
        row = layout.row()
        active = f"active_{kind.lower()}"
        row.template_list("REALMODEL_UL_structures", name, group, rows, group, active, rows=4)
        buttons = row.column(align=True)
        buttons.operator("realmodel.fault_body_add", text="", icon="ADD").empty = True
        buttons.operator("realmodel.fault_body_remove", text="", icon="REMOVE")
        buttons.operator("realmodel.fault_body_copy", text="", icon="DUPLICATE")
        buttons.separator()
        buttons.operator("realmodel.fault_body_move", text="", icon="TRIA_UP").direction = "UP"
        buttons.operator("realmodel.fault_body_move", text="", icon="TRIA_DOWN").direction = "DOWN"
        entry = settings.active_structure(context.scene)
        if entry is None:
            hint(layout, _EMPTY[kind])
        column = layout.column(align=True)
        column.operator("realmodel.fault_body_from_selected", icon="OBJECT_DATA")
        column.operator("realmodel.fault_body_add", text="Import...", icon="IMPORT").empty = False
        if entry is None:
            return
        layout.separator()
        layout.prop(entry, "source")
        if entry.source in settings.OF_OBJECTS:
            layout.prop(entry, "object")
        elif entry.source == "INTERVALS":
            panel.draw(layout, entry, "reach", BODY)
        else:
            file_field(layout, entry, "filepath")
            if project_settings.stored_shape(entry) and not entry.filepath:
                hint(layout, "The shape is stored in the .blend.")
        if kind == "FAULT":
            _draw_fault(layout, context, entry)
        else:
            _draw_body(layout, context, entry)
        if context.mode == "EDIT_MESH":
            layout.operator("realmodel.edit_done", icon="CHECKMARK")
        else:
            text = "Edit Fault" if kind == "FAULT" else "Edit Body"
            layout.operator("realmodel.fault_body_edit", text=text, icon="EDITMODE_HLT")
        draw_figures(layout, context, entry)


def _draw_fault(layout, context, fault):
    draw_drawing(layout, context, "realmodel.draw_stick")
    if fault.source == "POINTS_FILE" and fault.dips:
        draw_removable(layout, "Dips of the fault", "realmodel.fault_dips_remove")
    if fault.source in settings.TRACES:
        for key, setting in FAULT.items():
            if setting.shapes == OF_TRACES:
                panel.draw(layout, fault, key, FAULT)
    panel.draw(layout, fault, "youngest", FAULT)
    panel.draw(layout, fault, "dies_out", FAULT)
    panel.draw(layout, fault, "extend", FAULT)
    _draw_names(layout, fault, "ends_at")
    _draw_names(layout, fault, "rocks")
    row = layout.row(align=True)
    row.operator("realmodel.view_juxtaposition", text="Juxtaposition", icon="IMAGE_DATA")
    row.operator("realmodel.save_juxtaposition", text="Save...", icon="FILE_TICK")


def _draw_names(layout, fault, key):
    """A list of names, each chosen by search."""
    rows, label = getattr(fault, key), FAULT[key].label
    column = layout.column(align=True)
    for number, entry in enumerate(rows):
        row = column.row(align=True)
        row.prop(entry, "name", text=label if number == 0 else " ")
        made = row.operator("realmodel.fault_list_remove", text="", icon="X")
        made.of, made.index = key.upper(), number
    column.operator("realmodel.fault_list_add", text=f"Add to {label}", icon="ADD").of = key.upper()


def _draw_body(layout, context, body):
    panel.draw(layout, body, "after", BODY)
    panel.draw(layout, body, "void", BODY)
    if not body.void:
        draw_property(layout, context, body, "realmodel.body_property")
    panel.draw(layout, body, "rock", BODY)


class REALMODEL_PT_structure_reading(FoldedPanel, bpy.types.Panel):
    bl_label = "Import Options"
    bl_parent_id = "REALMODEL_PT_structures"

    @classmethod
    def poll(cls, context):
        entry = settings.active_structure(context.scene)
        return entry is not None and entry.source not in settings.OF_OBJECTS and bool(entry.filepath)

    def draw_in(self, layout, context, _group):
        entry = settings.active_structure(context.scene)
        hint(layout, "Most files need no options.")
        if entry.source == "MESH_FILE":
            for key in MESH_READING:
                panel.draw(layout, entry, key, READING)
            return
        is_trace = entry.source == "TRACE_FILE"
        if not is_trace:
            panel.draw(layout, entry, "stick", FAULT)
        for key in READING:
            if is_trace and key in ("columns", "separator", "decimal"):
                continue
            if key == "where":
                draw_filters(layout, entry, of_fault=True)
            else:
                panel.draw(layout, entry, key, READING)


class REALMODEL_UL_structures(OfRows, bpy.types.UIList):
    """Faults, or bodies."""

    def draw_row(self, context, row, item):
        if settings.kind_of(item) == "body" and not item.void:
            draw_swatch(row, library_rows.find(context.scene, item.property_id))
        row.prop(item, "name", text="", emboss=False)
        right_label(row, _statement_text(item))
        row.prop(item, "hide", text="", emboss=False, icon="HIDE_ON" if item.hide else "HIDE_OFF")


def _statement_text(row):
    """The special settings of a fault or a body, in two words."""
    if settings.kind_of(row) == "body":
        return "void" if row.void else ""
    return "dies out" if row.dies_out else ""
