# SPDX-License-Identifier: GPL-3.0-or-later
"""Field data: what of them is shown, the active datum, and the list of those that do not fit."""

import bpy

from ..bl.field import boreholes, data, handle, shown_log, shown_net
from ..core import RealModelError
from .lists import OfRows
from .panel import FoldedPanel, OfAModel, hint, message, right_label


class REALMODEL_UL_misfits(OfRows, bpy.types.UIList):
    """Data that the model does not have as they say."""

    def draw_row(self, _context, row, item):
        split = row.split(factor=0.4)
        depth = f" {item.depth}" if item.depth else ""
        split.label(text=f"{item.source}{depth}")
        rest = split.split(factor=0.58)
        rest.label(text=item.name)
        right_label(rest, item.by or "left out")


class REALMODEL_PT_field(OfAModel, FoldedPanel, bpy.types.Panel):
    bl_label = "Field Data"
    bl_order = 5

    def draw_in(self, layout, context, group):
        layout.operator("realmodel.boreholes_read", text="Import Field Data...", icon="IMPORT")
        if not data.are_there(context.scene):
            hint(layout, "Boreholes, outcrops, dips and maps: choose all files at once.")
            return
        grid = layout.grid_flow(row_major=True, columns=2, align=True)
        grid.use_property_split = False
        maps = ("show_map",) if any(rock.map for rock in group.rocks) else ()
        for name in (*maps, "show_contacts", "show_dips", "show_boreholes", "show_hole_names"):
            grid.prop(group.view, name, toggle=True)
        column = layout.column(align=True)
        if group.view.show_boreholes and boreholes.columns(context.scene):
            column.prop(group.view, "boreholes_by")
            if boreholes.limits(context.scene) is not None:
                column.prop(group.view, "show_hole_curves")
        if group.view.show_boreholes or group.view.show_contacts or group.view.show_dips:
            column.prop(group.view, "hole_width", text="Within")
        if shown_log.names(context.scene):
            row = layout.row(align=True)
            row.prop(group.view, "log_hole")
            row.operator("realmodel.hole_log", text="", icon="EYEDROPPER")
        _draw_datum(layout, context)
        if shown_net.are_there(context.scene):
            _draw_stereonet(layout, group.view)


def _draw_stereonet(layout, view):
    layout.prop(view, "show_stereonet", toggle=True)
    if not view.show_stereonet:
        return
    column = layout.column(align=True)
    column.prop(view, "stereonet_of")
    column.prop(view, "net")
    row = layout.row(align=True)
    row.operator("realmodel.dips_pick", icon="RESTRICT_SELECT_OFF")
    if view.picked_dips:
        row.operator("realmodel.dips_pick", text="", icon="X").dips = "[]"
    row.operator("realmodel.save_stereonet", text="Save...", icon="FILE_TICK")


def _draw_datum(layout, context):
    row = layout.row(align=True)
    row.operator("realmodel.datum_pick", text="Pick Datum", icon="EYEDROPPER")
    datum = handle.active(context.scene)
    off = data.switched_off(context.scene)
    if datum is not None:
        row.operator("realmodel.datum_show", text="", icon="ZOOM_SELECTED")
        row.operator("realmodel.datum_leave", text="", icon="X")
        box = layout.box().column(align=True)
        try:
            text = handle.text_of(context.scene, datum)
        except RealModelError as error:
            text = str(error)
        message(box, text)
        icon = "HIDE_OFF" if datum.used else "HIDE_ON"
        box.operator("realmodel.datum_switch", text="Switch Off" if datum.used else "Switch On", icon=icon)
        obj = handle.item_of(context.scene)
        if obj is not None:
            box.prop(obj, "location", text="Offset")
        hint(layout, "Move the sphere with G. With Auto the model follows.")
    if off:
        row = layout.row(align=True)
        row.label(text=f"{off:,} switched off")
        row.operator("realmodel.data_switch_on", text="Switch All On")


class REALMODEL_PT_field_misfits(FoldedPanel, bpy.types.Panel):
    bl_label = "Misfits"
    bl_parent_id = "REALMODEL_PT_field"

    @classmethod
    def poll(cls, context):
        return len(context.scene.realmodel.results) > 0

    def draw_header(self, context):
        self.layout.prop(context.scene.realmodel.view, "show_misfits", text="")

    def draw_in(self, layout, context, group):
        column = layout.column(align=True)
        column.prop(group.view, "misfit_tolerance")
        column.prop(group.view, "dip_tolerance", text="Dips")
        if not group.view.show_misfits:
            hint(layout, "Enable to show the data that the model does not honor, in red and in a list.")
            return
        if not len(group.misfits):
            hint(layout, "The model honors all data.")
            return
        more = group.view.misfit_count - len(group.misfits)
        layout.label(
            text=f"Data that do not fit: {group.view.misfit_count:,}" + (", the largest:" if more else "")
        )
        layout.template_list("REALMODEL_UL_misfits", "", group, "misfits", group, "active_misfit", rows=5)
        if 0 <= group.active_misfit < len(group.misfits):
            _draw_misfit(layout, group.misfits[group.active_misfit])


def _draw_misfit(layout, row):
    column = layout.box().column(align=True)
    depth = f" at {row.depth}" if row.depth else ""
    for text in (f"{row.source}{depth}: {row.name}", f"Says: {row.says}", f"Model: {row.has}"):
        message(column, text)
    column.operator("realmodel.misfit_show", text="Show", icon="ZOOM_SELECTED")
