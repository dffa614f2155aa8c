# SPDX-License-Identifier: GPL-3.0-or-later
"""Drawing of the rows of the lists."""

import bpy

from ..bl.project import library_rows, results, series_settings, units
from .panel import right_label


class OfRows:
    """A list whose rows draw themselves by `draw_row(context, row, item)`."""

    def draw_item(self, context, layout, _data, item, _icon, _active_data, _active_name):
        self.draw_row(context, layout.row(align=True), item)


class YoungestOnTop(OfRows):
    """A list of what was deposited one on another, the last row first."""

    def filter_items(self, _context, data, name):
        rows = getattr(data, name)
        shown = []
        if self.filter_name:
            shown = bpy.types.UI_UL_list.filter_items_by_name(
                self.filter_name, self.bitflag_filter_item, rows, "name"
            )
        return shown, list(range(len(rows) - 1, -1, -1))


class REALMODEL_UL_rocks(OfRows, bpy.types.UIList):
    """Rock masses."""

    def draw_row(self, _context, row, item):
        row.prop(item, "name", text="", emboss=False, icon="OUTLINER_OB_VOLUME")
        right_label(row, str(len(item.surfaces)))


def draw_swatch(row, entry):
    """The color of an entry of the library, if there is one."""
    if entry is not None:
        swatch = row.row()
        swatch.scale_x = 0.3
        swatch.prop(entry, "color", text="")


class REALMODEL_UL_surfaces(YoungestOnTop, bpy.types.UIList):
    """Surfaces, the youngest on top, as in the field."""

    def draw_row(self, context, row, item):
        draw_swatch(row, library_rows.find(context.scene, item.property_id))
        row.prop(item, "name", text="", emboss=False)
        if item.series:
            row.label(
                text="", icon="OUTLINER_OB_CURVES" if series_settings.is_level_set(item) else "LINENUMBERS_ON"
            )
        if item.rule != "erosional":
            row.label(text=item.bl_rna.properties["rule"].enum_items[item.rule].name)
        row.prop(item, "hide", text="", emboss=False, icon="HIDE_ON" if item.hide else "HIDE_OFF")


class REALMODEL_UL_library(OfRows, bpy.types.UIList):
    """Properties."""

    def draw_row(self, _context, row, item):
        draw_swatch(row, item)
        row.prop(item, "name", text="", emboss=False)
        right_label(row, str(item.id))


def result_columns(layout):
    """The columns of the table of blocks: name, volume, share of all. The usual sidebar has room for them and
    for the list's scroll bar."""
    split = layout.split(factor=0.42)
    name, rest = split.row(), split.split(factor=0.7)
    volume, share = rest.row(), rest.row()
    volume.alignment = share.alignment = "RIGHT"
    return name, volume, share


def share_text(row):
    """The share of a block in the volume of all, in whole percent."""
    return f"{row.share:.0f}" if row.share >= 1.0 or not row.volume else "< 1"


class REALMODEL_UL_results(YoungestOnTop, bpy.types.UIList):
    """Blocks, the youngest on top."""

    def draw_row(self, context, row, item):
        name, volume, share = result_columns(row)
        name.label(text=item.name, icon="UNLINKED" if results.is_missing(item) else "NONE")
        volume.label(text=units.volume_text(context.scene, item) if item.volume else "eroded")
        share.label(text=share_text(item))
