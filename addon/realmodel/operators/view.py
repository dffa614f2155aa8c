# SPDX-License-Identifier: GPL-3.0-or-later
"""Operators of the view: standard views, capture, coordinates, hiding blocks by their property."""

import bpy
import numpy as np
from bpy.props import EnumProperty, IntProperty
from bpy_extras.io_utils import ExportHelper
from mathutils import Matrix, Vector

from ..bl import display
from ..bl.display import coordinates, modes, viewpoints
from ..bl.objects import exaggeration, shapes, viewports, visible
from ..bl.objects.origin import KEY, choose_origin
from ..bl.pictures import capture
from ..bl.project import project_settings, series_settings, settings, units
from ..bl.scene import built_scene, data_objects
from ..core import InputRefused, UsageError
from .drawing import Pointing
from .reporting import (
    Reporting,
    a_model,
    a_surface,
    a_viewport,
    an_edit,
    an_interface,
    any_surface,
    chosen_path,
    file_filter,
    not_building,
    place_property,
)
from .start import invoke

_LOOKING = {
    "FRONT": ("Front", "From the south"),
    "BACK": ("Back", "From the north"),
    "LEFT": ("Left", "From the west"),
    "RIGHT": ("Right", "From the east"),
    "TOP": ("Top", "From above, as a map"),
    "BOTTOM": ("Bottom", "From below"),
}


class REALMODEL_OT_view(Reporting, bpy.types.Operator):
    """Look at the whole model along an axis, without perspective"""

    bl_label = "Look at Model"
    bl_options = {"REGISTER"}
    needs = (a_viewport,)

    direction: EnumProperty(
        name="Direction",
        description="View direction",
        items=[(key, *_LOOKING[key]) for key in viewpoints.DIRECTIONS],
    )

    @classmethod
    def description(cls, _context, properties):
        return f"Look at the whole model without perspective. {_LOOKING[properties.direction][1]}"

    def act(self, context):
        viewpoints.turn(context, self.direction)


class REALMODEL_OT_view_previous(Reporting, bpy.types.Operator):
    """Go back to the previous view of the viewports"""

    bl_label = "Previous View"
    bl_options = {"REGISTER"}
    needs = (a_viewport,)

    def act(self, context):
        viewpoints.step(context, -1)


class REALMODEL_OT_view_next(Reporting, bpy.types.Operator):
    """Go forward to the next view of the viewports, after Previous View"""

    bl_label = "Next View"
    bl_options = {"REGISTER"}
    needs = (a_viewport,)

    def act(self, context):
        viewpoints.step(context, 1)


class REALMODEL_OT_view_all(Reporting, bpy.types.Operator):
    """Zoom to the whole model, without rotating the view"""

    bl_label = "Frame Model"
    bl_options = {"REGISTER"}
    needs = (a_viewport,)

    def act(self, context):
        viewpoints.frame(context)


class REALMODEL_OT_capture(Reporting, bpy.types.Operator, ExportHelper):
    """Save the 3D Viewport as a picture (PNG) of any size"""

    bl_label = "Capture View"
    bl_options = {"REGISTER"}

    filename_ext = ".png"
    filter_glob: file_filter(".png")
    width: IntProperty(
        name="Width",
        description="Width in pixels; 0: that of the viewport",
        min=0,
        max=capture.LARGEST,
        subtype="PIXEL",
    )
    height: IntProperty(
        name="Height",
        description="Height in pixels; 0: that of the viewport",
        min=0,
        max=capture.LARGEST,
        subtype="PIXEL",
    )

    def act(self, context):
        path = chosen_path(self, "the picture")
        if path.suffix.lower() != ".png":
            raise UsageError(f"{path}: a picture ends in .png")
        width, height = self._size(context)
        capture.write(context, path, (width, height))
        self.report({"INFO"}, f"Wrote {path}, {width} x {height} pixels")

    def _size(self, context):
        view = capture.viewport(context)
        usual = (1600, 1000) if view is None or bpy.app.background else (view[1].width, view[1].height)
        if not self.width and not self.height:
            return usual
        width = self.width or round(self.height * usual[0] / usual[1])
        height = self.height or round(self.width * usual[1] / usual[0])
        return max(1, width), max(1, height)


def a_sheet(context):
    surface = settings.active_surface(context.scene)
    is_one = series_settings.is_level_set(surface)
    return "a level set follows from its series: move its contacts and dips (Pick Datum)" if is_one else None


class REALMODEL_OT_edit_surface(Reporting, bpy.types.Operator):
    """Edit the interface of the active surface: show the blocks with it and enter Edit Mode"""

    bl_label = "Edit Surface"
    needs = (a_surface, a_sheet, an_interface)

    def act(self, context):
        edit_interface(context, settings.active_surface(context.scene).interface)


def edit_interface(context, item):
    """Enters Edit Mode on an interface, with the blocks visible."""
    if context.mode != "OBJECT":
        bpy.ops.object.mode_set(mode="OBJECT")
    context.scene.realmodel.display = "BLOCKS"
    visible.show(context.scene, item, True)
    visible.select_alone(context, item)
    bpy.ops.object.mode_set(mode="EDIT")
    display.mode_changed(context.scene)


class REALMODEL_OT_edit_done(Reporting, bpy.types.Operator):
    """Leave Edit Mode and show the surfaces again"""

    bl_label = "Done"
    needs = (an_edit,)

    def act(self, context):
        bpy.ops.object.mode_set(mode="OBJECT")
        display.mode_changed(context.scene)
        context.scene.realmodel.display = "SURFACES"


class REALMODEL_OT_hide_property(Reporting, bpy.types.Operator):
    """Hide the blocks of a property, or show them again, in renders as well"""

    bl_label = "Hide or Show Blocks by Property"
    needs = (a_model,)

    property_id: IntProperty(name="Property", description="ID of the property in the library; 0: none given")
    action: EnumProperty(
        name="Action",
        description="Hide or show the blocks of the property",
        items=(
            ("TOGGLE", "Toggle", "Hide them where they are shown, show them where they are hidden"),
            ("HIDE", "Hide", "Hide them"),
            ("SHOW", "Show", "Show them"),
            ("ONLY", "Only", "Hide all others"),
            ("ALL", "All", "Show the blocks of all properties"),
        ),
    )

    def act(self, context):
        scene = context.scene
        ids = {row.property_id for row in scene.realmodel.results}
        if self.property_id not in ids and self.action != "ALL":
            raise InputRefused(
                f"no block has property {self.property_id}",
                advice=f"choose one of {', '.join(str(i) for i in sorted(ids))}",
            )
        hidden = modes.hidden_properties(scene)
        if self.action == "ONLY":
            hidden = ids - {self.property_id}
        elif self.action == "ALL":
            hidden = set()
        elif self.action == "HIDE" or (self.action == "TOGGLE" and self.property_id not in hidden):
            hidden.add(self.property_id)
        else:
            hidden.discard(self.property_id)
        modes.hide_properties(scene, hidden)
        display.mode_changed(scene)


class REALMODEL_OT_coordinates(Pointing, bpy.types.Operator):
    """Show coordinates, block, property and thickness: under the mouse until you click, or at the 3D
    cursor"""

    bl_label = "Coordinates"
    needs = (a_model,)

    location: place_property(
        "The place in the coordinates of the scene; where it is not given, the 3D cursor"
    )

    def act(self, context):
        has_location = self.properties.is_property_set("location")
        place = coordinates.at_point(
            context.scene, self.location if has_location else context.scene.cursor.location
        )
        if place is None:
            coordinates.remember(context.scene, None)
            raise InputRefused(
                "there is no block at this place", advice="put the 3D cursor or the location inside a block"
            )
        coordinates.remember(context.scene, place)
        self.report({"INFO"}, place_text(context.scene, place))

    def invoke(self, context, event):
        if bpy.app.background or context.region_data is None or context.region.type != "WINDOW":
            view = capture.viewport(context)
            if bpy.app.background or view is None:
                return self.execute(context)
        if not len(context.scene.realmodel.results):
            return self.execute(context)
        return self.wait(
            context, "EYEDROPPER", "Coordinates: point at the model     Click: keep     Esc: leave"
        )

    def modal(self, context, event):
        if event.type in {"ESC", "RIGHTMOUSE"}:
            return self.leave(context, {"CANCELLED"})
        if event.type in {"MOUSEMOVE", "LEFTMOUSE", "RET", "NUMPAD_ENTER"}:
            place = _under_mouse(context, event)
            text = "no block here" if place is None else place_text(context.scene, place)
            context.workspace.status_text_set(f"{text}     Click: keep     Esc: leave")
            if event.type != "MOUSEMOVE" and event.value == "PRESS":
                if place is None:
                    return {"RUNNING_MODAL"}
                coordinates.remember(context.scene, place)
                self.report({"INFO"}, text)
                return self.leave(context, {"FINISHED"})
            return {"RUNNING_MODAL"}
        return {"PASS_THROUGH"}


def _under_mouse(context, event):
    """The place of the model under the mouse, in whatever 3D viewport that is."""
    viewport = viewports.under_mouse(context, event)
    return None if viewport is None else coordinates.under_ray(context.scene, *viewports.ray(*viewport))


def place_text(scene, place):
    """A place in one line, lengths in the units of the scene."""
    parts = [f"x {place.x:.3f}  y {place.y:.3f}  height {place.z:.3f}", place.block]
    parts.append(place.property or f"property {place.property_id}" if place.property_id else "no property")
    parts.append(f"{units.length_text(scene, place.thickness)} thick")
    away = coordinates.from_zero(scene, place)
    if away is not None:
        parts.append("from origin " + "  ".join(f"{value:+.3f}" for value in away))
    return ", ".join(parts)


class REALMODEL_OT_set_origin(Reporting, bpy.types.Operator):
    """Set the point from which distances are measured: the last coordinates, or the 3D cursor. The model does
    not move"""

    bl_label = "Set Origin"

    action: EnumProperty(
        name="Origin",
        description="The point that distances are measured from",
        items=(
            ("PLACE", "Last Place", "The last requested coordinates"),
            ("CURSOR", "3D Cursor", "Where the 3D cursor is"),
            ("NONE", "None", "No distances"),
        ),
    )

    def act(self, context):
        scene = context.scene
        if self.action == "NONE":
            coordinates.set_zero(scene, None)
        elif self.action == "CURSOR":
            origin = project_settings.model_origin(scene)
            coordinates.set_zero(scene, [c + o for c, o in zip(scene.cursor.location, origin, strict=True)])
        else:
            place = coordinates.last(scene)
            if place is None:
                raise InputRefused("no coordinates were asked for yet", advice="use Coordinates first")
            coordinates.set_zero(scene, (place.x, place.y, place.z))


class REALMODEL_OT_move_to_zero(Reporting, bpy.types.Operator):
    """Change the origin so that a distant model moves to the zero point of the scene. The source objects move
    with it. Model coordinates do not change. A built model is built again"""

    bl_label = "Move Model to Scene's Zero"
    needs = (any_surface, not_building)

    def act(self, context):
        scene = context.scene
        context.view_layer.update()
        mine = list(dict.fromkeys(project_settings.user_objects(scene)))
        made = [row.object for row in scene.realmodel.results if row.object is not None]
        rows = [row for _, row in settings.interface_rows(scene)]
        interfaces = [row for row in rows if row.interface is not None and row.interface not in mine]
        made += [row.interface for row in interfaces]
        items = [*mine, *made, *data_objects.objects(scene)]
        corners = [obj.matrix_world @ Vector(corner) for obj in items for corner in obj.bound_box]
        old = project_settings.model_origin(scene)
        if not corners:
            raise InputRefused("there is nothing to move yet", advice="import surfaces first")
        moved = old - (new := choose_origin(np.array(corners, float) + old))
        if not moved.any():
            raise InputRefused("the model stands near the zero of the scene")
        scene[KEY] = [float(value) for value in new]
        for obj in {_top(obj) for obj in mine}:
            obj.matrix_basis = Matrix.Translation(moved) @ obj.matrix_basis
        unchanged = [row for row in interfaces if _digest(context, row) == row.interface_digest]
        for mesh in {obj.data for obj in made}:
            mesh.transform(Matrix.Translation(moved))
            mesh.update()
        with settings.filling():
            for row in unchanged:
                row.interface_digest = _digest(context, row)
        built_scene.move_helpers(scene, moved)
        context.view_layer.update()
        viewports.frame_items(items, viewports.spaces(context))
        self.report({"INFO"}, "Moved by " + ", ".join(f"{value:,.0f}" for value in moved))
        if len(scene.realmodel.results):
            invoke(bpy.ops.realmodel.build, self)


def _digest(context, row):
    return shapes.digest(*shapes.triangulation(row.interface, context.evaluated_depsgraph_get()))


def _top(obj):
    """The object that carries another along, or itself."""
    while obj.parent is not None and exaggeration.KEY not in obj.parent:
        obj = obj.parent
    return obj
