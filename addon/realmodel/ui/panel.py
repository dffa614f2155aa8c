# SPDX-License-Identifier: GPL-3.0-or-later
"""Common parts of all panels of the tab."""

import re

import bpy

from ..core.settings.setting import property_name, switch_name


class TabPanel:
    """A panel of the sidebar, in the tab RealModel unless it says otherwise."""

    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "RealModel"

    def draw(self, context):
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        self.draw_in(layout, context, context.scene.realmodel)


class FoldedPanel(TabPanel):
    """A panel that is closed until it is opened."""

    bl_options = {"DEFAULT_CLOSED"}


def ui_scale():
    """Pixels per unit of Blender's interface, which has none before its first window is drawn."""
    return bpy.context.preferences.system.ui_scale or 1.0


class OfAModel:
    """A panel that has nothing to show before a model is begun."""

    @classmethod
    def poll(cls, context):
        return context.scene.realmodel.exists


class OfABuiltModel:
    """A panel that has nothing to show before a build."""

    @classmethod
    def poll(cls, context):
        return len(context.scene.realmodel.results) > 0


def right_label(layout, text):
    row = layout.row()
    row.alignment = "RIGHT"
    row.label(text=text)


def file_field(layout, row, key, text=""):
    """A field of a file: a button with its name, whose tooltip has the whole path, and one that empties it.
    Blender's own field would show the two ends of the path."""
    path = getattr(row, key)
    if not path:
        layout.prop(row, key, **({"text": text} if text else {}))
        return
    line = layout.split(factor=0.4)
    right_label(line, text or row.bl_rna.properties[key].name)
    field = line.row(align=True)
    for shown, icon in ((re.split(r"[\\\\/]", path)[-1], "FILE_FOLDER"), ("", "X")):
        button = field.operator("realmodel.file_choose", text=shown, icon=icon, translate=False)
        button.row, button.key, button.none = row.path_from_id(), key, not shown


def hint(layout, text):
    """An empty state: what to do first, in as many lines as the sidebar's width asks for."""
    column = layout.column(align=True)
    column.active = False
    message(column, text)


ICON = 5  # letters that are as wide as an icon and the border of a box


def message(layout, text, icon="NONE", taken=0, most=None):
    """A text, whole, in as many lines as it asks for, as `wrapped` parts it. icon: before the first line."""
    has_icon = icon != "NONE"
    for number, line in enumerate(wrapped(text, taken + ICON * has_icon, most)):
        layout.label(text=line, icon="BLANK1" if has_icon and number else icon)


def letters():
    """The number of letters that fit into a line of the sidebar that is being drawn."""
    region = bpy.context.region
    if region is None:
        return 40
    return max(16, int((region.width / ui_scale() - 60) / 5.9))


_UNIT = re.compile(r"(?<=\d) (?=(?:[mck]?m[²³]?|%|ft|mi|yd|in)(?!\w))")  # between a number and its unit


def wrapped(text, taken=0, most=None):
    """The lines of a text, none longer than about the width of the sidebar, or than `most` letters, of which
    something else has `taken` so many; a number stays with its unit."""
    width = max((most or letters()) - taken, 12)
    lines, line = [], ""
    for word in _UNIT.sub("\u00a0", text).split(" "):
        if line and len(line) + 1 + len(word) > width:
            lines.append(line)
            line = ""
        for _ in range((len(word) - 1) // width):  # a path, say
            lines.append(word[:width])
            word = word[width:]
        line = f"{line} {word}".strip()
    return [*lines, line] if line else lines


def draw(layout, row, key, settings):
    """A setting: with its tick, where it has one, and what shares it."""
    setting = settings[key]
    if setting.beside is not None or not setting.label:
        return
    parts = setting.parts or {key: setting} | {
        other: beside for other, beside in settings.items() if beside.beside == key
    }
    names = [property_name(name, part) for name, part in parts.items()]
    switch = switch_name(key, settings)
    if switch is None:
        for name in names:
            layout.prop(row, name)
        return
    line = layout.row(
        heading=min(setting.label, setting.switch[0], key=len) if len(names) == 1 else setting.switch[0]
    )
    line.prop(row, switch, text="")
    if len(names) == 1:
        field = line.row()
        field.active = getattr(row, switch)
        field.prop(row, names[0], text="")
    elif getattr(row, switch):
        for name in names:
            layout.prop(row, name)
