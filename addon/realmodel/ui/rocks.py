# SPDX-License-Identifier: GPL-3.0-or-later
"""The list of rock masses and the settings of the active one."""

import bpy

from ..bl.project import method_settings, plan_mesh, settings
from ..bl.scene import region_size
from ..core.base.errors import counted
from ..core.project.project import ROCK
from ..core.settings.meshers import SIZE
from . import panel
from .panel import FoldedPanel, OfAModel, file_field, hint


class REALMODEL_PT_rocks(OfAModel, FoldedPanel, bpy.types.Panel):
    bl_label = "Rock Masses"
    bl_order = 6

    def draw_in(self, layout, context, group):
        if not len(group.rocks):
            hint(layout, "A rock mass is a region with its surfaces. Add one to begin:")
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
            file_field(layout, rock, "region_file", text="or file")
            if rock.region_stored and not rock.region_file:
                hint(layout, "The outline is stored in the .blend.")
        layout.operator("realmodel.region_around", icon="SHADING_BBOX")
        if method_settings.interpolates(rock):
            _draw_density(layout, rock)
        panel.draw(layout, rock, "base_elevation", ROCK)


def _draw_density(layout, rock):
    column = layout.column(align=True)
    column.prop(rock, "edges_by", text="Size From")
    if rock.edges_by == "LENGTH":
        column.prop(rock, "edge_length", text="Length")
        count = region_size.expected_triangles(rock)
        if count is not None:
            hint(layout, f"about {_rounded(count):,} triangles per surface")
    elif rock.edges_by == "TRIANGLES":
        column.prop(rock, "triangles")
    else:
        panel.draw(column, rock, "triangles", ROCK)
    layout.prop(rock, "mesher")


class REALMODEL_PT_rock_mesh(FoldedPanel, bpy.types.Panel):
    bl_label = "Planar Mesh"
    bl_parent_id = "REALMODEL_PT_rocks"

    @classmethod
    def poll(cls, context):
        rock = settings.active_rock(context.scene)
        return rock is not None and method_settings.interpolates(rock)

    def draw_in(self, layout, context, _group):
        rock = settings.active_rock(context.scene)
        hint(layout, "Refinement: shorter edges at")
        for number, entry in enumerate(rock.sizes):
            box = layout.box().column(align=True)
            row = box.row(align=True)
            row.prop(entry, "at")
            row.operator("realmodel.size_remove", text="", icon="X").index = number
            if entry.at == "OBJECT":
                box.prop(entry, "object")
            for key in SIZE:
                panel.draw(box, entry, key, SIZE)
        layout.operator("realmodel.size_add", icon="ADD")
        hint(layout, "Constraints: lines and points that the mesh contains")
        for number, entry in enumerate(rock.constraints):
            row = layout.row(align=True)
            row.prop(entry, "object", text="")
            row.operator("realmodel.constraint_remove", text="", icon="X").index = number
        lines, points = plan_mesh.stored_constraints(rock)
        if lines or points:
            row = layout.row(align=True)
            row.label(text=f"{counted(lines, 'line')}, {counted(points, 'point')} from files")
            row.operator("realmodel.constraint_remove", text="", icon="X").index = -1
        row = layout.row(align=True)
        row.operator("realmodel.constraint_add", text="Add Object", icon="ADD")
        row.operator("realmodel.constraint_read", text="Import File...", icon="FILE_FOLDER")


def _rounded(count):
    digits = max(0, len(str(int(count))) - 2)
    return round(int(count), -digits)
