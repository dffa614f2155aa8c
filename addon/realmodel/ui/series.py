# SPDX-License-Identifier: GPL-3.0-or-later
"""The series of the active rock mass."""

import bpy

from ..bl.host import notices
from ..bl.project import series_settings, settings
from ..bl.scene import problems
from ..core import RealModelError
from ..core.base.errors import counted
from ..core.project.project import ROCK
from ..core.project.series import SERIES
from ..core.settings.series_kinds import FIELD, KINDS
from . import panel
from .lists import OfRows
from .panel import FoldedPanel, hint, message, right_label


class REALMODEL_UL_series(OfRows, bpy.types.UIList):
    """Series of a rock mass, with how many surfaces they have."""

    def draw_row(self, _context, row, item):
        row.prop(item, "name", text="", emboss=False)
        count = len(series_settings.members(settings.rock_of(item), item))
        right_label(row, f"{KINDS[item.kind][0]}, {count}")


class REALMODEL_PT_series(FoldedPanel, bpy.types.Panel):
    bl_label = "Series"
    bl_parent_id = "REALMODEL_PT_surfaces"

    @classmethod
    def poll(cls, context):
        return settings.active_surface(context.scene) is not None

    def draw_in(self, layout, context, _group):
        rock = settings.active_rock(context.scene)
        if not len(rock.series):
            hint(
                layout,
                "A series is a run of surfaces that were folded together. In a field they may be vertical, "
                "overturned or recumbent.",
            )
            layout.operator("realmodel.series_add", icon="ADD").kind = FIELD
            return
        row = layout.row()
        row.template_list("REALMODEL_UL_series", "", rock, "series", rock, "active_series", rows=2)
        buttons = row.column(align=True)
        buttons.operator("realmodel.series_add", text="", icon="ADD").kind = FIELD
        buttons.operator("realmodel.series_remove", text="", icon="REMOVE")
        buttons.separator()
        buttons.operator("realmodel.series_move", text="", icon="TRIA_UP").direction = "UP"
        buttons.operator("realmodel.series_move", text="", icon="TRIA_DOWN").direction = "DOWN"
        _draw_series(layout, rock, series_settings.active(rock))


def _draw_series(layout, rock, row):
    layout.prop(row, "kind")
    column = layout.column(align=True)
    column.prop(row, "youngest")
    column.prop(row, "oldest")
    if row.kind == FIELD:
        panel.draw(layout, row, "resolution", SERIES)
        if not row.resolution:
            hint(layout, "0: chosen from the size of the rock mass")
        panel.draw(layout, row, "thickness", SERIES)
        for key in ("error", "dip_error", "range"):
            panel.draw(layout, row, key, SERIES)
    _draw_dips(layout, row)
    if not (row.kind == FIELD and _draw_needs(layout, rock)):
        _draw_refusal(layout, rock, row)


def _draw_dips(layout, row):
    line = layout.row(align=True)
    try:
        text = counted(row.dips.count("positions"), "dip") if row.dips else "No dips"
    except RealModelError as error:
        text = str(error)
    line.label(text=text)
    if row.dips:
        line.operator("realmodel.series_dips_remove", text="", icon="X")
    line = layout.row(align=True)
    line.operator("realmodel.boreholes_read", text="Import Dips...", icon="IMPORT").series = row.name
    line.operator("realmodel.dip_add", text="", icon="PIVOT_CURSOR")


def _draw_needs(layout, rock):
    """What a field needs of its rock mass: here, too, as the panel of rock masses is folded. Returns whether
    something is lacking."""
    lacks_region = rock.region is None and not (rock.region_file or rock.region_stored)
    is_lacking = lacks_region or not rock.use_base
    if is_lacking:
        hint(layout, "The rock mass needs a base elevation and a region, which bound the field.")
    panel.draw(layout, rock, "base_elevation", ROCK)
    if lacks_region:
        layout.operator("realmodel.region_around", icon="SHADING_BBOX")
    return is_lacking


def _draw_refusal(layout, rock, row):
    """Why a build refuses the series, or has refused it."""
    text = notices.in_panel_words(series_settings.refusal(rock, row)) or problems.of_series(rock, row)
    if not text:
        return
    column = layout.box().column(align=True)
    column.alert = True
    message(column, text, taken=2)
