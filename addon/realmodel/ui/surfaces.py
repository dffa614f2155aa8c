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
            hint(layout, "Add a rock mass first.")
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
                "No surfaces yet. Add the oldest first.",
            )
        line = layout.column(align=True)
        line.operator("realmodel.surface_add", text="Add from File...", icon="FILE_FOLDER")
        line.operator("realmodel.surface_add", text="Add Active Mesh", icon="OBJECT_DATA").use_object = True
        line.operator("realmodel.boreholes_read", text="Import Boreholes...", icon="EMPTY_SINGLE_ARROW")
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
            hint(layout, "The data are stored in the .blend.")
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
        elif switch is not None:
            _draw_switched(layout, surface, switch, shown)
        else:
            for key in shown:
                layout.prop(surface, key)
    _draw_switched(layout, surface, "use_minimum_thickness", ("minimum_thickness",))


def _draw_switched(layout, surface, switch, keys):
    """A tick, and beside it what it switches on; further settings below."""
    names = surface.bl_rna.properties
    row = layout.row(heading=names[keys[0]].name if len(keys) == 1 else names[switch].name)
    row.prop(surface, switch, text="")
    if len(keys) == 1:
        value = row.row()
        value.active = getattr(surface, switch)
        value.prop(surface, keys[0], text="")
    elif getattr(surface, switch):
        for key in keys:
            layout.prop(surface, key)


def _draw_variogram(layout, surface):
    layout.row(heading="Variogram").prop(surface, "fit_variogram", text="Fitted")
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
        _draw_switched(box, part, "use_anisotropy", ("ratio", "azimuth"))
    text = "Add Structure" if parts else "Nested Structures"
    layout.operator("realmodel.structure_add", text=text, icon="ADD")


def _draw_figures(layout, context, surface):
    figures = surface_figures.read(surface)
    if figures is None:
        return
    scene, column = context.scene, layout.box().column(align=True)
    for sentence in _figures(scene, figures):
        for line in wrapped(sentence):
            column.label(text=line)


def _figures(scene, figures):
    """What a build tells of a surface, in sentences."""
    points = f"{figures['points']:,} points, " if figures["points"] else ""
    yield f"{points}{figures['triangles']:,} triangles"
    low, high = (units.length_text(scene, figures[key]) for key in ("low", "high"))
    yield f"Elevation {low} to {high}"
    if figures.get("deviation"):
        yield f"Standard deviation up to {units.length_text(scene, figures['deviation'])}"
    if figures["area"] > 0.0:
        share = "" if figures["share"] is None else f" ({100 * figures['share']:.0f} %)"
        yield f"Survives over {units.area_text(scene, figures['area'])}{share}"
    else:
        yield "Removed by erosion"


class REALMODEL_PT_surface_reading(TabPanel, bpy.types.Panel):
    bl_label = "Import Options"
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
        hint(layout, "Most files need no options.")
        points = ("columns", "where", "separator", "decimal", "nodata", "height_attribute", "layer")
        for key in (*(points if surface.source == "POINTS_FILE" else ()), "plan_unit", "height_unit"):
            layout.prop(surface, key)


CLASSES = (REALMODEL_PT_surfaces, REALMODEL_PT_surface_reading)
