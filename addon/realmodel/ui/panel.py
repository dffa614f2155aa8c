# SPDX-License-Identifier: GPL-3.0-or-later
"""What all panels of the tab share."""

import re

import bpy


class TabPanel:
    """A panel in the tab RealModel of the sidebar."""

    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "RealModel"

    def draw(self, context):
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        self.draw_in(layout, context, context.scene.realmodel)


def ui_scale():
    """Pixels by Blender's units of the interface, which has none before its first window is drawn."""
    return bpy.context.preferences.system.ui_scale or 1.0


def hint(layout, text):
    """An empty state: what to do first, in as many lines as the sidebar's width asks for."""
    column = layout.column(align=True)
    column.active = False
    for line in wrapped(text):
        column.label(text=line)


def _letters():
    """How many letters fit into a line of the sidebar that is being drawn."""
    region = bpy.context.region
    if region is None:
        return 40
    return max(16, int((region.width / ui_scale() - 60) / 5.9))


_UNIT = re.compile(r"(?<=\d) (?=(?:[mck]?m[²³]?|%|ft|mi|yd|in)(?!\w))")  # between a number and its unit


def wrapped(text, taken=0):
    """The lines of a text, none longer than about the width of the sidebar, of which something else has
    `taken` so many letters; a number stays with its unit."""
    width = max(_letters() - taken, 12)
    lines, line = [], ""
    for word in _UNIT.sub("\u00a0", text).split(" "):
        if line and len(line) + 1 + len(word) > width:
            lines.append(line)
            line = word
        else:
            line = f"{line} {word}".strip()
    return [*lines, line] if line else lines
