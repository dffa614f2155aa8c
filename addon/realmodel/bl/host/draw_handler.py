# SPDX-License-Identifier: GPL-3.0-or-later
"""A function that draws into every 3D viewport, while the add-on is enabled and there is a window."""

import bpy


class DrawHandler:
    """A draw handler of 3D viewports. draw(): see `bpy.types.SpaceView3D.draw_handler_add`. when: "POST_VIEW"
    or "POST_PIXEL"."""

    def __init__(self, draw, when):
        self._draw, self._when, self._handle = draw, when, None

    def register(self):
        if not bpy.app.background:
            self._handle = bpy.types.SpaceView3D.draw_handler_add(self._draw, (), "WINDOW", self._when)

    def unregister(self):
        if self._handle is not None:
            bpy.types.SpaceView3D.draw_handler_remove(self._handle, "WINDOW")
            self._handle = None
