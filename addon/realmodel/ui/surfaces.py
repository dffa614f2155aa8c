# SPDX-License-Identifier: GPL-3.0-or-later
"""The list of surfaces and the settings of the active one."""

import bpy

from ..bl import library_rows, method_settings, project_settings, settings, surface_figures, units
from ..core.methods import METHODS
from .panel import TabPanel, hint, wrapped


class REALMODEL_PT_surfaces(TabPanel, bpy.types.Panel):
    bl_label = "Surfaces"
    bl_idname = "REALMODEL_PT_surfaces"
    bl_order = 2

    def draw_in(self, layout, context, _group):
        rock = settings.active_rock(context.scene)
        if rock is None:
            hint(layout, "Add a rock mass first; its surfaces are listed here, the youngest on top.")
            return
        row = layout.row()
        row.template_list("REALMODEL_UL_surfaces", "", rock, "surfaces", rock, "active_surface", rows=4)
        buttons = row.column(align=True)
        buttons.operator("realmodel.surface_add", text="", icon="ADD").empty = True
        buttons.operator("realmodel.surface_remove", text="", icon="REMOVE")
        buttons.operator("realmodel.surface_copy", text="", icon="DUPLICATE")
        buttons.separator()
        buttons.operator("realmodel.surface_move", text="", icon="TRIA_UP").direction = "UP"
        buttons.operator("realmodel.surface_move", text="", icon="TRIA_DOWN").direction = "DOWN"
        if not len(rock.surfaces):
            hint(
                layout,
                "No surface yet. Begin with the oldest: from a file of points or a mesh, or from a mesh.",
            )
        line = layout.column(align=True)
        line.operator("realmodel.surface_add", text="Add from File...", icon="FILE_FOLDER")
        line.operator("realmodel.surface_add", text="Add Active Mesh", icon="OBJECT_DATA").use_object = True
        line.operator("realmodel.boreholes_read", text="Read Boreholes...", icon="EMPTY_SINGLE_ARROW")
        surface = settings.active_surface(context.scene)
        if surface is not None:
            _draw_surface(layout, context, surface)


def _draw_surface(layout, context, surface):
    layout.separator()
    layout.prop(surface, "source")
    if surface.source in ("POINTS_OBJECT", "MESH_OBJECT"):
        layout.prop(surface, "object")
    elif surface.source in ("POINTS_FILE", "MESH_FILE"):
        layout.prop(surface, "filepath")
        if project_settings.stored_shape(surface) and not surface.filepath:
            hint(layout, "What was read is kept in the .blend.")
    if surface.source not in method_settings.READY_MESHES:
        _draw_method(layout.column(), surface)
    layout.prop(surface, "rule")
    hint(layout, surface.bl_rna.properties["rule"].enum_items[surface.rule].description)
    entry = library_rows.find(context.scene, surface.property_id)
    known = (
        f"{entry.name} ({entry.id})"
        if entry
        else "None"
        if not surface.property_id
        else str(surface.property_id)
    )
    row = layout.split(factor=0.4)
    label = row.row()
    label.alignment = "RIGHT"
    label.label(text="Property")
    row.operator_menu_enum("realmodel.surface_property", "property_id", text=known)
    layout.prop(surface, "block")
    _draw_figures(layout, context, surface)


def _draw_method(layout, surface):
    layout.prop(surface, "method")
    for name in METHODS[surface.method].options:
        switch, shown = method_settings.SHOWN.get(name, (None, ()))
        if name == "variogram":
            _draw_variogram(layout, surface)
            continue
        if switch is not None:
            layout.prop(surface, switch)
            if not getattr(surface, switch):
                continue
        for key in shown:
            layout.prop(surface, key)
    layout.prop(surface, "use_minimum_thickness")
    if surface.use_minimum_thickness:
        layout.prop(surface, "minimum_thickness", text="At least")


def _draw_variogram(layout, surface):
    layout.prop(surface, "fit_variogram")
    if surface.fit_variogram:
        return
    parts = len(surface.structures)
    keys = (
        ("variogram_nugget",)
        if parts
        else ("variogram_model", "variogram_range", "variogram_sill", "variogram_nugget")
    )
    for key in keys:
        layout.prop(surface, key)
    for number, part in enumerate(surface.structures):
        box = layout.box().column(align=True)
        row = box.row(align=True)
        row.prop(part, "model")
        row.operator("realmodel.structure_remove", text="", icon="X").index = number
        box.prop(part, "range")
        box.prop(part, "sill")
        box.prop(part, "use_anisotropy")
        if part.use_anisotropy:
            box.prop(part, "ratio")
            box.prop(part, "azimuth")
    text = "Add Part" if parts else "In Several Parts"
    layout.operator("realmodel.structure_add", text=text, icon="ADD")


def _draw_figures(layout, context, surface):
    figures = surface_figures.read(surface)
    if figures is None:
        return
    scene, column = context.scene, layout.box().column(align=True)
    if figures["points"]:
        column.label(text=f"{figures['points']:,} points, {figures['triangles']:,} triangles")
    else:
        column.label(text=f"{figures['triangles']:,} triangles")
    low, high = (units.length_text(scene, figures[key]) for key in ("low", "high"))
    column.label(text=f"Heights {low} to {high}")
    if figures.get("deviation"):
        column.label(text=f"Standard deviation to {units.length_text(scene, figures['deviation'])}")
    share = "" if figures["share"] is None else f" ({100 * figures['share']:.0f} %)"
    left = f"Survives over {units.area_text(scene, figures['area'])}{share}"
    for line in wrapped(
        left if figures["area"] > 0.0 else "Nothing of it survives: younger surfaces cut it away"
    ):
        column.label(text=line)


class REALMODEL_PT_surface_reading(TabPanel, bpy.types.Panel):
    bl_label = "How the File is Read"
    bl_idname = "REALMODEL_PT_surface_reading"
    bl_parent_id = "REALMODEL_PT_surfaces"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context):
        surface = settings.active_surface(context.scene)
        files = ("POINTS_FILE", "MESH_FILE")
        return surface is not None and surface.source in files and bool(surface.filepath)

    def draw_in(self, layout, context, _group):
        surface = settings.active_surface(context.scene)
        hint(layout, "Most files need nothing here.")
        points = ("columns", "where", "separator", "decimal", "nodata", "height_attribute", "layer")
        for key in (*(points if surface.source == "POINTS_FILE" else ()), "plan_unit", "height_unit"):
            layout.prop(surface, key)


CLASSES = (REALMODEL_PT_surfaces, REALMODEL_PT_surface_reading)
