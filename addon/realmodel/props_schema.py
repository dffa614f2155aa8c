# SPDX-License-Identifier: GPL-3.0-or-later
"""The properties of settings, made from their declarations (core/settings/setting.py)."""

from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, StringProperty

from .bl import changes
from .bl.project import choices
from .core.settings.setting import property_name, switch_name

_SEARCH = {
    "surface": choices.surfaces,
    "any_surface": choices.all_surfaces,
    "rock_mass": choices.rocks,
    "series": choices.series,
    "column": choices.columns,
    "attribute": choices.columns,
    "layer": choices.layers,
    "direction": choices.directions,
}


_TEXTS = ("name", "text", "note", "separator", "values")
_ROWS = ("names", "where")  # several rows, of a class of their own


def properties_of(settings, update=changes.setting, **updates):
    """A base of a property group with the properties of settings. update: what follows on a change; updates:
    what else, by key or switch."""
    properties = dict(_all(settings, update, updates))
    return type("Settings", (), {"__module__": __name__, "__annotations__": properties})


def _all(settings, update, updates):
    for key, setting in settings.items():
        switch = switch_name(key, settings)
        if setting.switch is not None:
            label, tip = setting.switch
            follows = updates.get(switch) or update
            yield switch, BoolProperty(name=label, description=tip, update=follows, options=set())
        follows = updates.get(key) or (changes.switched_on(switch) if switch else update)
        if setting.parts:
            yield from _all(setting.parts, follows, {})
        elif setting.label and setting.kind not in _ROWS:
            yield property_name(key, setting), _property(setting, follows)


def _property(setting, update):
    attrs = {"name": setting.label, "description": setting.tip, "options": set(), "update": update}
    if setting.words:
        return EnumProperty(
            **attrs,
            items=items(setting.words),
            default=setting.default or next(iter(setting.words)) or "NONE",
        )
    if setting.kind in _TEXTS or setting.kind in _SEARCH:
        if setting.kind in _SEARCH:
            attrs["search"] = _SEARCH[setting.kind]
        return StringProperty(**attrs)
    if setting.kind == "truth":
        return BoolProperty(**attrs, default=setting.default)
    attrs |= {key: bound for key, bound in (("min", setting.low), ("max", setting.high)) if bound is not None}
    if setting.kind in ("whole", "integer"):
        return IntProperty(**attrs, default=int(setting.start))
    return FloatProperty(
        **attrs, default=setting.start, subtype="DISTANCE" if setting.kind == "length" else "NONE"
    )


def items(words):
    """The items of a menu. Each keeps the number by which Blender stores it; what chooses by itself comes
    first."""
    numbered = [(word or "NONE", *texts, "", number) for number, (word, texts) in enumerate(words.items())]
    return sorted(numbered, key=lambda entry: entry[0] != "auto")
