# SPDX-License-Identifier: GPL-3.0-or-later
"""The list of surfaces and the settings of the active one."""

import bpy

from ..bl.objects import model_tree
from ..bl.project import (
    library_rows,
    method_settings,
    project_settings,
    series_settings,
    settings,
    surface_statistics,
    units,
)
from ..core.project.project import SURFACE
from ..core.settings.data_files import MESH_READING, READING
from ..core.settings.methods import METHODS, OPTIONS, STRUCTURE
from ..core.settings.variogram import VARIOGRAMS
from . import panel
from .panel import FoldedPanel, OfAModel, TabPanel, file_field, hint, message, right_label


class REALMODEL_PT_surfaces(OfAModel, TabPanel, bpy.types.Panel):
    bl_label = "Surfaces"
    bl_order = 4

    def draw_in(self, layout, context, _group):
        rock = settings.active_rock(context.scene)
        if rock is None:
            _draw_adding(layout)
            return
        _draw_terrain(layout, rock)
        if rock.ground or rock.ground_stored or rock.map:
            file_field(layout, rock, "ground")
        row = layout.row()
        row.template_list("REALMODEL_UL_surfaces", "", rock, "surfaces", rock, "active_surface", rows=4)
        buttons = row.column(align=True)
        buttons.operator("realmodel.surface_add", text="", icon="ADD").empty = True
        buttons.operator("realmodel.surface_remove", text="", icon="REMOVE")
        buttons.operator("realmodel.surface_copy", text="", icon="DUPLICATE")
        buttons.separator()
        buttons.operator("realmodel.surface_move", text="", icon="TRIA_UP").direction = "UP"
        buttons.operator("realmodel.surface_move", text="", icon="TRIA_DOWN").direction = "DOWN"
        buttons.operator("realmodel.surface_sort", text="", icon="SORTSIZE")
        if not len(rock.surfaces):
            hint(
                layout,
                "No surfaces yet. Add the oldest first.",
            )
        _draw_adding(layout)
        if rock.observations:
            draw_removable(layout, "Observations of blocks", "realmodel.observations_remove")
        if rock.dips:
            draw_removable(layout, "Dips of the rock mass", "realmodel.rock_dips_remove")
        surface = settings.active_surface(context.scene)
        if surface is not None:
            _draw_surface(layout, context, surface)


def _draw_terrain(layout, rock):
    """The file or the object of the terrain, and the button that removes it; or how to choose one."""
    row, line = settings.terrain_of(rock), layout.row(align=True)
    if row is None:
        right_label(line, "Terrain")
        for text, icon in (("File...", "IMPORT"), ("Active Mesh", "OBJECT_DATA")):
            made = line.operator("realmodel.surface_add", text=text, icon=icon)
            made.as_terrain, made.use_object = True, icon == "OBJECT_DATA"
        return
    if row.source in ("POINTS_OBJECT", "MESH_OBJECT"):
        line.prop(row, "object", text="Terrain")
    else:
        file_field(line, row, "filepath", text="Terrain")
    line.operator("realmodel.surface_remove", text="", icon="X").terrain = True


def _draw_adding(layout):
    line = layout.column(align=True)
    line.operator("realmodel.surface_add", text="Import Surfaces...", icon="IMPORT")
    line.operator("realmodel.surface_add", text="Add Active Mesh", icon="OBJECT_DATA").use_object = True
    line.operator("realmodel.boreholes_read", text="Import Field Data...", icon="EMPTY_SINGLE_ARROW")


def draw_removable(layout, text, operator):
    """Data that are stored in the .blend, and a button that removes them."""
    row = layout.row()
    row.label(text=text)
    row.operator(operator, text="", icon="X")


def _draw_surface(layout, context, surface):
    layout.separator()
    layout.prop(surface, "source")
    if surface.source in ("POINTS_OBJECT", "MESH_OBJECT"):
        layout.prop(surface, "object")
    elif surface.source in ("POINTS_FILE", "MESH_FILE"):
        file_field(layout, surface, "filepath")
        if project_settings.stored_shape(surface) and not surface.filepath:
            hint(layout, "The data are stored in the .blend.")
    rock = settings.active_rock(context.scene)
    if (rock.ground or rock.ground_stored) and surface.name == rock.surfaces[-1].name:
        made = project_settings.is_of_ground(surface)
        hint(layout, "Made from the ground." if made else "Made from its own data, not from the ground.")
    if len(rock.series):
        layout.prop(surface, "series")
    if series_settings.is_level_set(surface):
        hint(layout, "A level set of the field of its series.")
        if surface.dips:
            draw_removable(layout, "Dips of the surface", "realmodel.dips_remove")
            layout.operator("realmodel.series_take_dips", icon="FORWARD")
    elif surface.source not in method_settings.READY_MESHES:
        layout.prop(surface, "method")
        panel.draw(layout, surface, "minimum_thickness", SURFACE)
        if surface.method == "parallel" or surface.use_minimum_thickness:
            panel.draw(layout, surface, "true_thickness", SURFACE)
        panel.draw(layout, surface, "tie", SURFACE)
        if not surface.series:
            panel.draw(layout, surface, "observed", SURFACE)
        panel.draw(layout, surface, "correlation", SURFACE)
        if surface.dips:
            draw_removable(layout, "Dips of the surface", "realmodel.dips_remove")
        _draw_dips_unused(layout, surface)
    elif len(context.scene.realmodel.faults):
        line = layout.row(heading="Continue By")
        line.prop(surface, "use_continuation", text="")
        field = line.row()
        field.active = surface.use_continuation
        field.prop(surface, "method", text="")
    if surface.source in ("NONE", "POINTS_FILE", "POINTS_OBJECT"):
        draw_drawing(layout, context, "realmodel.draw_contacts")
    layout.prop(surface, "rule")
    draw_property(layout, context, surface, "realmodel.surface_property")
    layout.prop(surface, "block")
    draw_figures(layout, context, surface)


def _draw_dips_unused(layout, surface):
    """That the method of a surface uses no dips, before a build refuses them."""
    column = layout.column(align=True)
    column.alert = bool(surface.dips)
    for text in method_settings.dips_unused(surface):
        message(column, text, icon="ERROR")


def draw_drawing(layout, context, operator):
    """The button that draws in the viewport, and where an object with lines is active one that takes
    these."""
    column = layout.column(align=True)
    column.operator(operator, icon="GREASEPENCIL")
    obj = context.active_object
    is_given = obj is not None and obj.select_get() and model_tree.TAG not in obj
    if is_given and settings.is_drawn_object(obj):
        column.operator(
            operator, text="From Active Object", icon="OUTLINER_OB_GREASEPENCIL"
        ).use_object = True


def draw_property(layout, context, row, operator):
    """The property of a surface or a body, and the menu to choose another one."""
    entry = library_rows.find(context.scene, row.property_id)
    text = f"{entry.name} ({entry.id})" if entry else "None" if not row.property_id else str(row.property_id)
    split = layout.split(factor=0.4)
    right_label(split, "Property")
    split.operator_menu_enum(operator, "property_id", text=text)


def draw_figures(layout, context, surface):
    figures = surface_statistics.read(surface)
    if figures is None:
        return
    scene, column = context.scene, layout.box().column(align=True)
    for sentence in _figures(scene, figures):
        message(column, sentence)


def _figures(scene, figures):
    """The statistics of a surface, as sentences."""
    points = f"{figures['points']:,} points, " if figures["points"] else ""
    yield f"{points}{figures['triangles']:,} triangles"
    low, high = (units.length_text(scene, figures[key]) for key in ("low", "high"))
    yield f"Elevation {low} to {high}"
    if figures.get("deviation"):
        yield f"Standard deviation up to {units.length_text(scene, figures['deviation'])}"
    if figures["area"] is None:
        return
    if figures["area"] > 0.0:
        share = "" if figures["share"] is None else f" ({100 * figures['share']:.0f} %)"
        yield f"Survives over {units.area_text(scene, figures['area'])}{share}"
    else:
        yield "Removed by erosion"


class _OfASurface:
    @classmethod
    def shown(cls, surface):
        return True

    @classmethod
    def poll(cls, context):
        surface = settings.active_surface(context.scene)
        return surface is not None and cls.shown(surface)


class _OfTheMethod(_OfASurface):
    fold = ""

    @classmethod
    def shown(cls, surface):
        has_method = method_settings.has_method(surface) and not series_settings.is_level_set(surface)
        return has_method and any(cls.options(surface))

    @classmethod
    def options(cls, surface):
        options = METHODS[surface.method].options
        return [key for key, setting in options.items() if setting.fold == cls.fold]

    def draw_in(self, layout, context, _group):
        surface = settings.active_surface(context.scene)
        for key in self.options(surface):
            if key == "variogram":
                _draw_variogram(layout, context.scene, surface)
            else:
                panel.draw(layout, surface, key, OPTIONS)


class REALMODEL_PT_surface_method(_OfTheMethod, FoldedPanel, bpy.types.Panel):
    bl_label = "Method Options"
    bl_parent_id = "REALMODEL_PT_surfaces"


class REALMODEL_PT_surface_search(_OfTheMethod, FoldedPanel, bpy.types.Panel):
    bl_label = "Search"
    bl_parent_id = "REALMODEL_PT_surface_method"
    fold = "search"


def _draw_variogram(layout, scene, surface):
    layout.row(heading="Variogram").prop(surface, "fit_variogram", text="Fitted")
    if surface.fit_variogram:
        fitted = (surface_statistics.read(surface) or {}).get("variogram")
        if fitted is not None:
            hint(layout, _variogram_text(scene, fitted))
        return
    if len(surface.structures):
        layout.prop(surface, "variogram_nugget")
    else:
        panel.draw(layout, surface, "variogram", OPTIONS)
    for number, part in enumerate(surface.structures):
        box = layout.box().column(align=True)
        row = box.row(align=True)
        row.prop(part, "model")
        row.operator("realmodel.structure_remove", text="", icon="X").index = number
        for key in ("range", "sill", "anisotropy"):
            panel.draw(box, part, key, STRUCTURE)
    text = "Add Structure" if len(surface.structures) else "Nested Structures"
    layout.operator("realmodel.structure_add", text=text, icon="ADD")


def _variogram_text(scene, fitted):
    """The fitted variogram, as text."""
    parts = fitted.get("structures") or [fitted]
    said = [
        f"{VARIOGRAMS[part['model']][0]}, range {units.length_text(scene, part['range'])}, "
        f"sill {part['sill']:.4g}"
        for part in parts
    ]
    return f"{'; '.join(said)}; nugget {fitted['nugget']:.4g}"


class REALMODEL_PT_surface_reading(_OfASurface, FoldedPanel, bpy.types.Panel):
    bl_label = "Import Options"
    bl_parent_id = "REALMODEL_PT_surfaces"

    @classmethod
    def shown(cls, surface):
        return surface.source in ("POINTS_FILE", "MESH_FILE") and bool(surface.filepath)

    def draw_in(self, layout, context, _group):
        surface = settings.active_surface(context.scene)
        hint(layout, "Most files need no options.")
        for key in READING if surface.source == "POINTS_FILE" else MESH_READING:
            if key == "where":
                draw_filters(layout, surface)
            else:
                panel.draw(layout, surface, key, READING)


def draw_filters(layout, surface, of_fault=False):
    """The filters of a surface's or a fault's file."""
    for number, entry in enumerate(surface.filters):
        row = layout.row(align=True)
        row.use_property_split = False
        row.prop(entry, "column", text="")
        row.prop(entry, "value", text="")
        made = row.operator("realmodel.filter_remove", text="", icon="X")
        made.index, made.of_fault = number, of_fault
    layout.operator("realmodel.filter_add", icon="ADD").of_fault = of_fault
