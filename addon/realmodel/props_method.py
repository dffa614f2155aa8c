# SPDX-License-Identifier: GPL-3.0-or-later
"""The settings of a surface that are options of methods, made from their registry (core/methods.py)."""

from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, StringProperty

from .bl import changes, method_settings
from .core.methods import OPTIONS


def _setting(name, option):
    """The property of an option."""
    switch = method_settings.switch_of(name)
    given = {
        "name": option.label,
        "description": option.tip,
        "options": set(),
        "update": changes.switched_on(switch) if switch else changes.setting,
    }
    if option.kind == "word":
        items = [(word, *texts) for word, texts in option.words.items()]
        return EnumProperty(**given, items=items, default=option.default)
    if option.kind == "surface":
        return StringProperty(**given)
    given["default"] = option.start
    given |= {key: bound for key, bound in (("min", option.low), ("max", option.high)) if bound is not None}
    if option.kind == "whole":
        return IntProperty(**given | {"default": int(option.start)})
    return FloatProperty(**given, subtype="DISTANCE" if option.kind == "length" else "NONE")


def _settings():
    for name, option in OPTIONS.items():
        if option.switch is not None:
            label, tip = option.switch
            yield (
                method_settings.switch_of(name),
                BoolProperty(name=label, description=tip, update=changes.setting, options=set()),
            )
        if option.kind != "table":
            yield name, _setting(name, option)


MethodSettings = type(
    "MethodSettings",
    (),
    {
        "__doc__": "For the property group of a surface.",
        "__module__": __name__,
        "__annotations__": dict(_settings()),
    },
)
