# SPDX-License-Identifier: GPL-3.0-or-later
"""The View panel."""

import bpy

from .. import props_view
from ..bl.display import coordinates, cuts, fields, modes, preparing, residuals, viewpoints
from ..bl.project import compartments, library_rows, project_settings, settings, units
from ..core.base.errors import counted
from .lists import draw_swatch
from .panel import FoldedPanel, OfABuiltModel, TabPanel, hint, message

_WITH_SUBJECT = ("POINTS", "LINES", "AREAS")


class REALMODEL_PT_view(OfABuiltModel, TabPanel, bpy.types.Panel):
    bl_label = "View"
    bl_order = 2

    def draw_in(self, layout, context, group):
        column = layout.column(align=True)
        row = column.row(align=True)
        row.prop(group, "display", text="Show")
        if preparing.is_working(context.scene):  # beside it: a line of its own would move all below it
            row.label(icon="SORTTIME")
        if group.display in _WITH_SUBJECT:
            column.prop(group.view, "subject")
        if group.display == "SURFACES":
            column.prop(group.view, "surfaces", text="Part")
        column.prop(group, "color_by")
        if group.color_by == "UNCERTAINTY" and group.view.shade_limits[1] == 0.0:
            hint(layout, "No surface has a standard deviation. It needs kriging and enough points.")
        _stage(layout, context.scene)
        column = layout.column(align=True)
        column.prop(group, "explode", slider=True)
        if group.explode > 0.0:
            column.prop(group, "explode_direction", text="Direction")
        if len(compartments.names(context.scene)) < 2 and "COMPARTMENT" in (
            group.color_by,
            group.explode_direction if group.explode > 0.0 else "",
        ):
            hint(layout, "No fault divides the model into compartments.")
        row = layout.row()
        row.use_property_split = False
        row.prop(group.view, "exaggeration")
        if context.mode == "EDIT_MESH":
            layout.operator("realmodel.edit_done", icon="CHECKMARK")
        elif group.display == "SURFACES":
            layout.operator("realmodel.edit_surface", icon="EDITMODE_HLT")
        layout.prop(group.view, "show_residuals")
        for _, name, count, _, spread, largest, outside in residuals.rows(context.scene):
            column = layout.column(align=True)
            column.label(text=f"{name}: {counted(count, 'point')}")
            values = [units.length_text(context.scene, value) for value in (spread, largest)]
            column.label(text=f"RMS {values[0]}")
            column.label(text=f"Largest {values[1]}")
            if outside:
                column.label(text=f"{outside} outside of the surface")
        grid = layout.grid_flow(row_major=True, columns=2, align=True)
        grid.use_property_split = False
        for name in ("show_legend", "show_north", "show_scale", "show_axes"):
            grid.prop(group.view, name, toggle=True)
        if group.view.message:
            box = layout.box()
            box.alert = True
            message(box, group.view.message)


def _stage(layout, scene):
    """The slider of the stage, the number that can be keyframed beside it, and what the number means."""
    group, last = scene.realmodel, settings.last_stage(scene)
    slider = props_view.stage_slider_name(last)
    if slider is None:
        layout.prop(group, "stage")
    else:
        row = layout.row(align=True)
        row.prop(group.stage_slider, slider, text="Stage", slider=True)
        number = row.row(align=True)
        number.scale_x = 0.6
        number.prop(group, "stage", text="")
    rows = [surface for _, surface in settings.surface_rows(scene)]
    if group.stage < last and len(group.rocks) == 1 and group.stage < len(rows):
        hint(layout, f"just after {rows[group.stage].name} ({group.stage} of {last})")


class REALMODEL_PT_view_properties(OfABuiltModel, FoldedPanel, bpy.types.Panel):
    bl_label = "Blocks by Property"
    bl_parent_id = "REALMODEL_PT_view"

    def draw_in(self, layout, context, group):
        hidden = modes.hidden_properties(context.scene)
        column = layout.column(align=True)
        for property_id in sorted({row.property_id for row in group.results}):
            row = column.row(align=True)
            entry = library_rows.find(context.scene, property_id)
            draw_swatch(row, entry)
            plain = f"Property {property_id}" if property_id else "No property"
            row.label(text=plain if entry is None else entry.name)
            icon = "HIDE_ON" if property_id in hidden else "HIDE_OFF"
            made = row.operator("realmodel.hide_property", text="", icon=icon, emboss=False)
            made.property_id, made.action = property_id, "TOGGLE"
            made = row.operator("realmodel.hide_property", text="", icon="SOLO_OFF", emboss=False)
            made.property_id, made.action = property_id, "ONLY"
        if hidden:
            column.operator("realmodel.hide_property", text="Show All").action = "ALL"


class REALMODEL_PT_view_section(OfABuiltModel, FoldedPanel, bpy.types.Panel):
    bl_label = "Section"
    bl_parent_id = "REALMODEL_PT_view"

    def draw_in(self, layout, context, group):
        view, scene = group.view, context.scene
        plane = cuts.plane_of(scene)
        if plane is None:
            hint(layout, "Add a plane to cut the model. Move and rotate the plane (G, R).")
            layout.operator_menu_enum(
                "realmodel.section_plane", "axis", text="Add Section Plane", icon="MESH_PLANE"
            )
        else:
            row = layout.row(align=True)
            row.prop(view, "use_section")
            if cuts.is_working(scene):
                row.label(icon="SORTTIME")
            column = layout.column(align=True)
            if project_settings.model_origin(scene).any():
                for name in ("plane_x", "plane_y", "plane_z"):
                    column.prop(view, name)
                column.prop(plane, "location", text="Offset")
            else:
                column.prop(plane, "location")
            layout.prop(plane, "rotation_euler", text="Rotation")
            row = layout.row(align=True)
            row.operator_menu_enum("realmodel.section_plane", "axis", text="Turn To")
            row.operator("realmodel.section_flip", text="Flip", icon="ARROW_LEFTRIGHT")
            row.operator("realmodel.section_remove", text="", icon="X")
        layout.prop(view, "plane", text="Plane")
        layout.operator("realmodel.image_place", text="Place Image...", icon="IMAGE_DATA")
        if plane is not None:
            _section_buttons(layout, "section", "PLANE", "Save Section...")
        if any(rock.hole_picks or rock.observations for rock in group.rocks):
            row = layout.row(align=True)
            row.prop(view, "section_holes")
            row.operator("realmodel.pick_holes", text="", icon="EYEDROPPER")
            layout.prop(view, "section_beyond")
            _section_buttons(layout, "fence_holes", "HOLES", "Save Section...", "Through Holes")
        hint(layout, "Sections along a line: draw a curve from above, and select it.")
        _section_buttons(layout, "fence", "LINE", "Save Fence...")
        layout.operator("realmodel.save_sheets", text="Save Sheets...", icon="FILE_TICK")


def _section_buttons(layout, operator, along, saving, making=""):
    """Buttons for the results of a cut: an object in its place, one beside the model, a file."""
    column = layout.column(align=True)
    row = column.split(factor=0.7, align=True)
    named = {"text": making} if making else {}
    row.operator(f"realmodel.{operator}", icon="MOD_BOOLEAN", **named).flat = False
    row.operator(f"realmodel.{operator}", text="Flat").flat = True
    row = column.row(align=True)
    row.enabled = getattr(bpy.ops.realmodel, operator).poll()  # saving a section wants what making it does
    row.operator("realmodel.save_section", text=saving, icon="FILE_TICK").along = along


class REALMODEL_PT_view_fields(OfABuiltModel, FoldedPanel, bpy.types.Panel):
    bl_label = "Fields"
    bl_parent_id = "REALMODEL_PT_view"

    @classmethod
    def poll(cls, context):
        return super().poll(context) and bool(fields.series(context.scene))

    def draw_in(self, layout, context, group):
        view = group.view
        if len(fields.series(context.scene)) > 1:
            layout.prop(view, "field_series")
        row = layout.row(align=True)
        row.prop(view, "show_field_section")
        if fields.is_working(context.scene):
            row.label(icon="SORTTIME")
        if view.show_field_section and not cuts.is_shown(context.scene):
            hint(layout, "Add a section plane, and enable Show Cut (Section).")
        row = layout.row(align=True, heading="Level Sets")
        row.prop(view, "show_field_levels", text="")
        number = row.row()
        number.active = view.show_field_levels
        number.prop(view, "field_levels", text="")
        if view.show_field_levels and group.display == "BLOCKS" and not cuts.is_shown(context.scene):
            hint(layout, "Level sets are inside the blocks: show the cut, or another mode.")


class REALMODEL_PT_view_camera(OfABuiltModel, FoldedPanel, bpy.types.Panel):
    bl_label = "Viewpoint"
    bl_parent_id = "REALMODEL_PT_view"

    def draw_in(self, layout, _context, _group):
        grid = layout.grid_flow(row_major=True, columns=3, align=True)
        for direction in ("FRONT", "LEFT", "TOP", "BACK", "RIGHT", "BOTTOM"):
            grid.operator("realmodel.view", text=direction.capitalize()).direction = direction
        row = layout.row(align=True)
        row.operator("realmodel.view_previous", text="", icon="LOOP_BACK")
        row.operator("realmodel.view_next", text="", icon="LOOP_FORWARDS")
        row.operator("realmodel.view_all", text="Frame", icon="ZOOM_ALL")
        layout.operator("realmodel.capture", text="Capture...", icon="RESTRICT_RENDER_OFF")


class REALMODEL_PT_view_picture(OfABuiltModel, FoldedPanel, bpy.types.Panel):
    bl_label = "Picture and Animation"
    bl_parent_id = "REALMODEL_PT_view"

    def draw_in(self, layout, context, _group):
        if not viewpoints.camera_sees(context.scene):
            hint(layout, "F12 would not show the model: no camera points at it.")
        layout.operator("realmodel.set_up_picture", icon="LIGHT_SUN")
        layout.operator("realmodel.render_picture", icon="RENDER_STILL")
        column = layout.column(align=True)  # side by side their names would be cut
        column.operator("realmodel.turntable", icon="CON_FOLLOWPATH")
        column.operator("realmodel.animate_stages", icon="KEYFRAME_HLT")


class REALMODEL_PT_view_coordinates(OfABuiltModel, FoldedPanel, bpy.types.Panel):
    bl_label = "Coordinates"
    bl_parent_id = "REALMODEL_PT_view"

    def draw_in(self, layout, context, _group):
        column = layout.column(align=True)
        column.operator("realmodel.coordinates", text="Under the Mouse", icon="EYEDROPPER")
        at_cursor = column.column(align=True)
        at_cursor.operator_context = "EXEC_DEFAULT"
        at_cursor.operator("realmodel.coordinates", text="At 3D Cursor", icon="PIVOT_CURSOR")
        place = coordinates.last(context.scene)
        if place is not None:
            column = layout.column(align=True)
            for name, value in _lines(context.scene, place):
                split = column.split(factor=0.35)
                split.label(text=name)
                split.label(text=value)
        layout.operator_menu_enum("realmodel.set_origin", "action", icon="EMPTY_AXIS")


def _lines(scene, place):
    yield "East (x)", f"{place.x:.3f}"
    yield "North (y)", f"{place.y:.3f}"
    yield "Elevation (z)", f"{place.z:.3f}"
    yield "Block", place.block
    yield "Property", place.property or (str(place.property_id) if place.property_id else "none")
    yield "Thickness", units.length_text(scene, place.thickness)
    away = coordinates.from_zero(scene, place)
    if away is not None:
        yield "From origin", "  ".join(f"{value:+.2f}" for value in away)
