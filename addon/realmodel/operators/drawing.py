# SPDX-License-Identifier: GPL-3.0-or-later
"""Drawing in the viewport: contacts of surfaces and sticks of faults on a section plane or an image; and
images in their place."""

import re

import bpy
import numpy as np
from bpy.props import BoolProperty, EnumProperty, FloatVectorProperty, StringProperty
from bpy_extras.io_utils import ImportHelper

from ..bl.display import exaggeration_changed
from ..bl.field import drawn_data, placed_images
from ..bl.host.draw_handler import DrawHandler
from ..bl.objects import viewports, visible
from ..bl.overlay import viewport as overlay
from ..bl.project import project_settings, settings
from ..core import InputRefused, RealModelError
from ..core.base.errors import counted
from ..core.drawing.drawing import Drawing
from .reporting import (
    Reporting,
    a_fault,
    a_surface,
    chosen_path,
    file_filter,
    object_mode,
    require_file,
)

_COLOR = (0.95, 0.35, 0.0)
_LEAST_STEP = 10.0  # pixels between two points of a line that is drawn with the button held
_ENTER = {"RET", "NUMPAD_ENTER", "SPACE"}
_BACK = {"BACK_SPACE", "DEL"}


class Pointing(Reporting):
    """An operator that waits for the mouse in a viewport: the cursor and the status bar say so."""

    def wait(self, context, cursor, text):
        context.window_manager.modal_handler_add(self)
        context.window.cursor_modal_set(cursor)
        context.workspace.status_text_set(text)
        return {"RUNNING_MODAL"}

    def cancel(self, context):
        self.leave(context, {"CANCELLED"})

    def leave(self, context, result):
        if context.window is not None:  # it may be closed
            context.window.cursor_modal_restore()
        if context.workspace is not None:
            context.workspace.status_text_set(None)
        return result


class InViewport(Pointing):
    """An operator that is run by clicks.

    `begin(context)` may raise RealModelError. `clicked(context, area, at, is_held)` takes a position in a
    viewport, or returns what is wrong there; `remove_last()` takes it back. `marks(context)` are the places
    of the world (N, 3) that are shown. `act(context)` is called at Enter. `keys`: what the status bar says.
    """

    keys = ""
    has_line = True  # through the marks

    _held = None
    _handler = None

    def begin(self, context):
        pass

    def invoke(self, context, event):
        if bpy.app.background or context.window is None:
            return self.execute(context)
        try:
            self.begin(context)
        except RealModelError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        self._handler = DrawHandler(lambda: self._draw(bpy.context), "POST_PIXEL")
        self._handler.register()
        viewports.redraw()
        return self.wait(context, "CROSSHAIR", self._text())

    def modal(self, context, event):
        if event.type == "ESC" or (event.type == "RIGHTMOUSE" and event.value == "PRESS"):
            return self.leave(context, {"CANCELLED"})
        if event.type in _ENTER and event.value == "PRESS":
            self.leave(context, {})
            return self.execute(context)
        if (event.type in _BACK or (event.type == "Z" and event.ctrl)) and event.value == "PRESS":
            self.remove_last()
            self._say(context)
            return {"RUNNING_MODAL"}
        if event.type == "LEFTMOUSE" and event.value == "RELEASE":
            self._held = None
            return {"RUNNING_MODAL"}
        if event.type == "LEFTMOUSE" or (event.type == "MOUSEMOVE" and self._held is not None):
            return self._take(context, event)
        return {"PASS_THROUGH"}

    def _take(self, context, event):
        viewport = viewports.under_mouse(context, event)
        if viewport is None:
            return {"PASS_THROUGH"}
        area, at = viewport
        is_held = event.type == "MOUSEMOVE"
        if is_held and np.hypot(*(np.array(at) - self._held)) < _LEAST_STEP:
            return {"RUNNING_MODAL"}
        self._held = np.array(at, float)
        self._say(context, self.clicked(context, area, at, is_held))
        return {"RUNNING_MODAL"}

    def _text(self):
        return f"{self.keys}     Backspace: remove the last     Enter: done     Esc: leave"

    def _say(self, context, problem=None):
        text = self._text()
        context.workspace.status_text_set(f"{problem}     {text}" if problem else text)
        for area in viewports.areas():
            area.tag_redraw()

    def leave(self, context, result):
        if self._handler is not None:
            self._handler.unregister()
            self._handler = None
        viewports.redraw()
        return super().leave(context, result)

    def _draw(self, context):
        region = context.region
        points = viewports.pixels(context.area, self.marks(context))
        points = points[np.isfinite(points).all(axis=1)]
        if not len(points):
            return
        drawing = Drawing(region.width, region.height)
        if len(points) > 1 and self.has_line:
            drawing.line(points, _COLOR, 2.0)
        drawing.dots(points, 4.0, _COLOR)
        overlay.draw_items(drawing, 1.0)


_IMAGES = (".png", ".jpg", ".jpeg", ".tif", ".tiff", ".bmp", ".webp")


class _Drawing(InViewport):
    """Draws a line on a plane."""

    bl_options = {"UNDO"}  # no panel of the last operation: what was drawn is no setting
    keys = "Click or draw on the plane"

    use_object: BoolProperty(
        name="From Active Object",
        description="Take the lines of the active curve or mesh, or the strokes of the active grease pencil, "
        "in place of drawing them",
        options={"SKIP_SAVE"},
    )

    _plane = None
    _places = ()

    def begin(self, context):
        self._plane, self._places = drawn_data.plane(context), []

    def invoke(self, context, event):
        return self.execute(context) if self.use_object else super().invoke(context, event)

    def clicked(self, context, area, at, _is_held):
        place = drawn_data.on_plane(context.scene, viewports.ray(area, at), self._plane)
        if place is None:
            return "The plane is seen from its edge: turn the view"
        self._places.append(place)
        return None

    def remove_last(self):
        del self._places[-1:]

    def marks(self, context):
        return project_settings.in_world(context.scene, self._places)

    def drawn(self, context):
        """The lines (N, 3) that were drawn, or those of the active object. Raises InputRefused."""
        if not self.use_object:
            if not len(self._places):
                raise InputRefused("nothing was drawn", advice="click on the plane, or give use_object")
            return [np.array(self._places)]
        obj = context.active_object
        if obj is None or not settings.is_drawn_object(obj):
            advice = "make a curve, a mesh or grease pencil strokes active"
            raise InputRefused("the active object has no lines", advice=advice)
        return drawn_data.lines_of(context.scene, obj, context.evaluated_depsgraph_get())


class REALMODEL_OT_draw_contacts(_Drawing, bpy.types.Operator):
    """Draw contacts of the active surface on the section plane, or on a placed image that is the active
    object: click points, or draw a line with the button held. The contacts are added to the surface"""

    bl_label = "Draw Contacts"
    needs = (a_surface, object_mode)

    def act(self, context):
        row = settings.active_surface(context.scene)
        points = np.concatenate(self.drawn(context))
        drawn_data.add_contacts(context.scene, row, points)
        self.report({"INFO"}, f"Added {counted(len(points), 'point')} to {row.name}")


class REALMODEL_OT_draw_stick(_Drawing, bpy.types.Operator):
    """Draw a stick of the active fault. The surface of the fault is fitted through its sticks"""

    bl_label = "Draw Stick"
    needs = (a_fault, object_mode)

    def act(self, context):
        row = settings.active_structure(context.scene)
        lines = self.drawn(context)
        drawn_data.add_sticks(context.scene, row, lines)
        self.report({"INFO"}, f"Added {len(lines)} stick{'s' * (len(lines) > 1)} to {row.name}")


def _pixel(name):
    return FloatVectorProperty(
        name=name,
        description="Pixel of the image that this point is at, from the lower left corner; 0, 0: the lower "
        "left corner of the image for the first point, the upper right one for the second",
        size=2,
        min=0.0,
        subtype="XYZ",
    )


def _numbers(text, count, what):
    """Numbers of a text field. Raises InputRefused."""
    words = [word for word in re.split(r"[,;\s]+", text.strip()) if word]
    try:
        numbers = [float(word) for word in words]
    except ValueError:
        numbers = []
    if len(numbers) != count or not np.isfinite(numbers).all():
        wanted, advice = (
            ("a number", "such as 350") if count == 1 else ("two numbers", "such as 3500, 5400.5")
        )
        raise InputRefused(f"{what} must be {wanted}, not '{text}'", advice=advice)
    return tuple(numbers)


class REALMODEL_OT_image_place(Reporting, bpy.types.Operator, ImportHelper):
    """Place an image by the coordinates of two of its points: a scanned section upright along a line, a map
    at an elevation. The .blend stores it. You can draw on it while it is the active object"""

    bl_label = "Place Image"
    needs = (object_mode,)

    filepath: StringProperty(name="File", description="The image", subtype="FILE_PATH", options={"SKIP_SAVE"})
    filter_glob: file_filter(*_IMAGES)
    kind: EnumProperty(
        name="Kind",
        description="What the image shows",
        items=(
            (
                "SECTION",
                "Section",
                "A vertical section; it stands along the line through both points",
            ),
            ("MAP", "Map", "A map: the two points are in plan"),
        ),
    )
    first: StringProperty(name="First Point", description="x and y of the first point, model coordinates")
    second: StringProperty(name="Second Point", description="x and y of the second point, model coordinates")
    heights: StringProperty(
        name="Elevations",
        description="Section: the elevations of the first and of the second point. Map: its elevation",
    )
    first_pixel: _pixel("First Pixel")
    second_pixel: _pixel("Second Pixel")

    def act(self, context):
        path = chosen_path(self, "the image")
        require_file(path)
        is_section = self.kind == "SECTION"
        heights = _numbers(self.heights, 2 if is_section else 1, "the elevations")
        placing = placed_images.Placing(
            (tuple(self.first_pixel), tuple(self.second_pixel)),
            _numbers(self.first, 2, "the first point"),
            _numbers(self.second, 2, "the second point"),
            heights if is_section else heights * 2,
            is_section,
        )
        obj = placed_images.place(context.scene, path, placing)
        visible.select_alone(context, obj)
        exaggeration_changed(context.scene)
        self.report({"INFO"}, f"Placed {obj.name}")

    def draw(self, _context):
        layout = self.layout
        layout.use_property_split = True
        for name in ("kind", "first", "second", "heights", "first_pixel", "second_pixel"):
            layout.prop(self, name)
