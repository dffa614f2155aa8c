# SPDX-License-Identifier: GPL-3.0-or-later
"""Declarations of settings. From one declaration follow the key of the project file and its check, the
property and the row of the panel, and the row of the table in docs/reference/project_file.md."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

Words = Mapping[str, tuple[str, str]]  # label and tooltip in the panel, by word


@dataclass(frozen=True)
class Setting:
    """default: its value where it is not given. kind: "number", "length", "whole", "truth" (true or false),
    "word" (one of `words`), "text", "surface" (the name of another one, or an elevation), "any_surface" (of
    any rock mass), "rock_mass", "series" (of the same rock mass), "column" (of a file), "layer", "direction"
    (degrees, or a point of the compass), "table" (of `parts`), "columns" (of the x, y and z of a file), and
    "other", with code of its own wherever it is used. above, below: bounds that it does not reach; else it is
    at least low and at most high. check(name, value) instead of these returns the value as it is used, or
    raises OptionRefused.

    For the panel: label and tip; start, low and high: the value before it is given, and its bounds. switch:
    label and tip of a tick, off where the setting is not given; beside: the setting whose tick this one
    shares. zero_is_none: 0 in the panel means that it is not given. name, switch_name: of the properties,
    where they are not the key and "use_" with the key. fold: the fold of the panel that it is in.
    For the documents: needed, whether and where; unset, what None means; more, what there is to say beside
    the tip. A setting without either has its row in the document alone.
    """

    default: object = None
    kind: str = "number"
    label: str = ""
    tip: str = ""
    words: Words = field(default_factory=dict)
    start: float = 0.0
    low: float | None = None
    high: float | None = None
    above: float | None = None
    below: float | None = None
    check: Callable[[str, object], object] | None = None
    switch: tuple[str, str] | None = None
    beside: str | None = None
    zero_is_none: bool = False
    parts: Mapping[str, Setting] = field(default_factory=dict)
    name: str = ""
    switch_name: str = ""
    fold: str = ""
    needed: str = ""
    unset: str = "none"
    more: str = ""


Settings = Mapping[str, Setting]


def property_name(key: str, setting: Setting) -> str:
    return setting.name or key


def switch_name(key: str, settings: Settings) -> str | None:
    """The property that switches a setting on; None where it is always on."""
    setting = settings[key]
    if setting.beside is not None:
        return switch_name(setting.beside, settings)
    return None if setting.switch is None else setting.switch_name or f"use_{key}"
