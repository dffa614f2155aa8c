# SPDX-License-Identifier: GPL-3.0-or-later
"""The list of rock masses and the settings of the active one."""

import bpy

from ..bl import region_size, settings
from .panel import TabPanel, hint


class REALMODEL_PT_rocks(TabPanel, bpy.types.Panel):
    bl_label = "Rock Masses"
    bl_idname = "REALMODEL_PT_rocks"
    bl_order = 1

    def draw_in(self, layout, context, group):
        if not len(group.rocks):
            hint(layout, "A rock mass is a piece of ground with its layers. Add one to begin:")
            layout.operator("realmodel.rock_add", icon="ADD")
            return
        row = layout.row()
        row.template_list("REALMODEL_UL_rocks", "", group, "rocks", group, "active_rock", rows=2)
        buttons = row.column(align=True)
        buttons.operator("realmodel.rock_add", text="", icon="ADD")
        buttons.operator("realmodel.rock_remove", text="", icon="REMOVE")
        buttons.operator("realmodel.rock_copy", text="", icon="DUPLICATE")
        rock = settings.active_rock(context.scene)
        layout.prop(rock, "region")
        if rock.region is None:
            layout.prop(rock, "region_file", text="or file")
            if rock.region_stored and not rock.region_file:
                hint(layout, "Its outline is kept in this file.")
        layout.prop(rock, "edge_length")
        if rock.region_area < 0.0:
            region_size.ask()
        count = region_size.expected_triangles(rock)
        if count is not None:
            hint(layout, f"gives about {_rounded(count):,} triangles a surface")
        layout.prop(rock, "mesher")
        base = layout.row(heading="Base")
        base.prop(rock, "use_base", text="")
        height = base.row()
        height.active = rock.use_base
        height.prop(rock, "base_elevation", text="")


def _rounded(count):
    digits = max(0, len(str(int(count))) - 2)
    return round(int(count), -digits)


CLASSES = (REALMODEL_PT_rocks,)
