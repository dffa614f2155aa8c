# SPDX-License-Identifier: GPL-3.0-or-later
"""The tab "Strata" of the 3D viewport's sidebar: the steps of an artist, from a shape to its export."""

import bpy

from .. import props_strata
from ..bl.jobs.fill_job import ErosionJob
from ..bl.objects import filled_beds
from ..bl.shading import strata_modifier, weathering
from ..bl.shading.strata_presets import PRESETS, SHAPES
from ..operators.baking import rocks
from ..operators.filling import draw_presets, draw_values
from .panel import TabPanel, hint


class _Step(TabPanel):
    """A panel of the tab Strata."""

    bl_category = "Strata"

    def draw_in(self, layout, context, _group):
        obj = context.active_object
        is_mesh = obj is not None and obj.type == "MESH"
        has_strata = is_mesh and strata_modifier.modifier_of(obj) is not None
        self.draw_step(layout, obj if is_mesh else None, obj.realmodel_strata if has_strata else None)


class REALMODEL_PT_strata_shape(_Step, bpy.types.Panel):
    bl_label = "Shape"
    bl_order = 0

    def draw_step(self, layout, obj, values):
        grid = layout.grid_flow(row_major=True, columns=3, even_columns=True, align=True)
        for kind, (name, *_) in SHAPES.items():
            grid.operator("realmodel.strata_rock_add", text=name).kind = kind
        if obj is None:
            hint(layout, "Add a rock, or select a mesh of your own.")
        elif filled_beds.BED in obj:
            hint(layout, f"{obj.name} is a bed. Edit Shape shows the mesh that it was made of.")
        elif values is None:
            hint(layout, f"{obj.name}: choose its beds.")
        else:
            draw_values(layout, values, props_strata.SHAPE)
        layout.operator("realmodel.strata_edit", icon="SCULPTMODE_HLT")


class REALMODEL_PT_strata_beds(_Step, bpy.types.Panel):
    bl_label = "Beds"
    bl_order = 1

    def draw_step(self, layout, obj, values):
        def button(cell, key):
            cell.operator("realmodel.strata_preset", text=PRESETS[key][0]).preset = key

        draw_presets(layout, 2, button)
        if values is None:
            hint(layout, "A preset shows beds on the active mesh. They follow its shape.")
            return
        draw_values(layout, values, props_strata.BEDS)
        line = layout.row(align=True)
        line.operator("realmodel.strata_fit", icon="FULLSCREEN_ENTER")
        line.operator("realmodel.strata_remove", text="", icon="X")
        if values.problem:
            layout.label(text=values.problem, icon="ERROR")


class REALMODEL_PT_strata_erosion(_Step, bpy.types.Panel):
    bl_label = "Erosion"
    bl_order = 2

    def draw_step(self, layout, obj, values):
        if obj is not None and filled_beds.BED in obj:
            hint(layout, "Erosion is of a mesh before it is made solid: click Edit Shape.")
            return
        if values is None:
            hint(layout, "Hard beds stand out, soft ones recede. Choose beds first.")
            return
        draw_values(layout, values, props_strata.EROSION)
        layout.label(text="About " + weathering.cost_text(values.faces, values.faces * ErosionJob.BYTES))
        layout.operator("realmodel.strata_erode", icon="MOD_NOISE")


class REALMODEL_PT_strata_looks(_Step, bpy.types.Panel):
    bl_label = "Looks"
    bl_order = 3

    def draw_step(self, layout, _obj, _values):
        items = rocks(bpy.context)
        if items:
            last = bpy.context.window_manager.operator_properties_last("realmodel.weathering")
            _, faces, size, _ = weathering.cost(items, last.detail, last.most_faces)
            layout.label(text="Up to " + weathering.cost_text(faces, size))
        line = layout.row(align=True)
        line.operator("realmodel.weathering", icon="MOD_NOISE")
        line.operator("realmodel.weathering_remove", text="", icon="X")
        layout.operator("realmodel.unwrap", icon="UV")
        layout.operator("realmodel.bake_looks", icon="RENDER_STILL")
        layout.operator("realmodel.set_up_picture", icon="LIGHT_SUN")


class REALMODEL_PT_strata_export(_Step, bpy.types.Panel):
    bl_label = "Export"
    bl_order = 4

    def draw_step(self, layout, _obj, values):
        if values is not None:
            layout.prop(values, "erosion")
            draw_values(layout, values, props_strata.SOLID)
        made = layout.operator("realmodel.fill_with_strata", text="Make Solid", icon="MESH_CUBE")
        made.use_dialog = False
        layout.operator("realmodel.export_scene", text="Export Looks...", icon="EXPORT")
