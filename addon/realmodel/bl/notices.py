# SPDX-License-Identifier: GPL-3.0-or-later
"""The warnings of a build for the panel: short, equal ones merged, settings by their labels."""

import re
from pathlib import Path

import bpy

from ..core.errors import number_list

# Settings as project files have them, and the property of a surface with the label of each, or the label.
_LABELS = {
    "method": "method",
    "columns": "Columns",
    "where": "Filters",
    "separator": "separator",
    "decimal": "decimal",
    "nodata": "nodata",
    "height": "height_attribute",
    "extrapolate": "extrapolate",
}
_SETTING = re.compile(
    r"(?:\b(?:say|write|give|set) )?\b("
    + "|".join(_LABELS)
    + r') = (".*?"|\[.*?\]|\{.*?\}|[^\s,;]+)'
    + r'(?: or (".*?"))?'
)
_NO_ACTION = "joined"  # the kind of a warning after which nothing is to be done
_PATH = re.compile(r"(?<!\S)/(?:[^\s:]+/)+([^\s:/]+\.\w+)")


def of_model(model):
    """The text that `scene.realmodel.warnings` keeps of a model's warnings: one line for each that differs in
    more than its surface and its numbers."""
    alike = {}
    several = len(model.project.rocks) > 1
    for warning in model.warnings:
        if warning.kind == _NO_ACTION:
            continue
        alike.setdefault(re.sub(r"\d[\d.,e+-]*", "0", warning.text), []).append(warning)
    lines = []
    for group in alike.values():
        names = []
        for warning in group:
            whole = [warning.rock] if warning.rock and (several or not warning.surface) else []
            names.append(" / ".join([*whole, *([warning.surface] if warning.surface else [])]))
        names = [name for name in dict.fromkeys(names) if name]
        where = f"{number_list(names)}: " if names else ""
        lines.append(" ".join(f"{where}{in_panel_words(group[0].text)}".split()))
    return "\n".join(lines)


def read(kept):
    """The lines that `of_model` made."""
    return kept.split("\n") if kept else []


def in_panel_words(text):
    """A message with the labels of the panel in the place of the keys of project files, and files by name."""
    names = bpy.types.Scene.bl_rna.properties
    for key in ("realmodel", "rocks", "surfaces"):
        names = names[key].fixed_type.properties

    def setting(found):
        key = _LABELS[found[1]]
        label = names[key].name if key in names else key
        values = [_value(found[1], value, names) for value in found.groups()[1:] if value]
        return f"set {label} to {' or '.join(values)}"

    return _PATH.sub(lambda found: Path(found[0]).name, _SETTING.sub(setting, text))


def _value(key, value, names):
    value = value.strip('"[]{} ').replace('"', "")
    if key == "method":
        items = names["method"].enum_items
        return items[value].name if value in items else value
    return value or "nothing"
