# SPDX-License-Identifier: GPL-3.0-or-later
"""The rows of settings, from their declarations (core/settings/setting.py)."""

from ..core.settings.setting import property_name, switch_name


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
