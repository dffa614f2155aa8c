# SPDX-License-Identifier: GPL-3.0-or-later
"""The 3D viewports on the screens."""

import bpy


def areas():
    """The areas of all 3D viewports that are on a screen."""
    for window in bpy.context.window_manager.windows:
        yield from (area for area in window.screen.areas if area.type == "VIEW_3D")


def redraw():
    """The viewports and their sidebars show what has changed."""
    for area in areas():
        area.tag_redraw()


def redraw_sidebars():
    """The sidebars show what has changed; the scene is not drawn anew for it."""
    for area in areas():
        for region in area.regions:
            if region.type == "UI":
                region.tag_redraw()
