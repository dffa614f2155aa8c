# SPDX-License-Identifier: GPL-3.0-or-later
"""What all panels of the tab share."""


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


def hint(layout, text):
    """An empty state: what to do first, in as many lines as the sidebar's width asks for."""
    column = layout.column(align=True)
    column.active = False
    for line in wrapped(text):
        column.label(text=line)


def wrapped(text, width=38):
    """The lines of a text, none longer than about the width of the sidebar."""
    lines, line = [], ""
    for word in text.split():
        if line and len(line) + 1 + len(word) > width:
            lines.append(line)
            line = word
        else:
            line = f"{line} {word}".strip()
    return [*lines, line] if line else lines
