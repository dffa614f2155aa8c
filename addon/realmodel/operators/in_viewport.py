# SPDX-License-Identifier: GPL-3.0-or-later
"""Operators that take clicks in the 3D viewport until Enter: what was clicked is drawn over it meanwhile."""

import bpy
import numpy as np

from ..bl.host.draw_handler import DrawHandler
from ..bl.objects import viewports
from ..bl.overlay import viewport as overlay
from ..core import RealModelError
from ..core.drawing.drawing import Drawing
from .reporting import Reporting

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
        if len(points) > 1:
            drawing.line(points, _COLOR, 2.0)
        drawing.dots(points, 4.0, _COLOR)
        overlay.draw_items(drawing, 1.0)
