# SPDX-License-Identifier: GPL-3.0-or-later
"""Declarations of settings, each in the field of a dataclass that it describes. From one declaration follow
the key of the project file, how it is read, checked and written, the property and the row of the panel, and
the row of the table in docs/reference/project_file.md."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import MISSING, dataclass, field, fields
from functools import cache
from typing import Any, NamedTuple

Words = Mapping[str, tuple[str, str]]  # label and tooltip in the panel, by word


@dataclass(frozen=True)
class Setting:
    """default: its value where it is not given. kind: "number", "length", "whole", "truth" (true or false),
    "word" (one of `words`), "text", "surface" (the name of another one, or an elevation), "any_surface" (of
    any rock mass), "rock_mass", "series" (of the same rock mass), "column" (of a file), "layer", "direction"
    (degrees, or a point of the compass), "table" (of `parts`), "columns" (of the x, y and z of a file); and
    those of READ in project/project_file.py, for what only a file says. above, below: bounds that it does not
    reach; else it is at least low and at most high. check(name, value) instead of these returns the value as
    it is used, or raises OptionRefused.

    key: of the project file, where it is not the name of the field. of: the dataclass of the tables of this
    key, or of the file that it names. example: what a message shows of such a key. shapes: of a surface
    ("sheet", "level set", "mesh") or a fault ("trace", "points", "mesh"), or kinds of a series, on which it
    has an effect; none: on all.

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
    key: str = ""
    of: Any = None
    example: str = ""
    shapes: tuple[str, ...] = ()
    needed: str = ""
    unset: str = "none"
    more: str = ""

    def fits(self, shape: str) -> bool:
        """Whether it has an effect on such a shape."""
        return not self.shapes or shape in self.shapes


Settings = Mapping[str, Setting]

FILE_KINDS = ("points", "mesh", "trace")  # the keys that say how such a file is read are beside its own
_DECLARED = "setting"  # in the metadata of a field


def described(
    setting: Setting, is_needed: bool = False, absent: Any = MISSING, factory: Any = MISSING
) -> Any:
    """A field of a dataclass that a setting describes. is_needed: it has no default; else it has that of the
    setting, or `absent`, or what `factory` makes."""
    default = setting.default if absent is MISSING else absent
    if is_needed or factory is not MISSING:
        default = MISSING
    return field(default=default, default_factory=factory, metadata={_DECLARED: setting})


def declared(
    default: Any = None,
    kind: str = "number",
    *,
    is_needed: bool = False,
    absent: Any = MISSING,
    factory: Any = MISSING,
    **words: Any,
) -> Any:
    """A field of a dataclass with the Setting that describes it alone; see `described`."""
    return described(Setting(default, kind, **words), is_needed, absent, factory)


class Declaration(NamedTuple):
    """A field of a dataclass that a setting describes: its name, the key in a project file, and the value
    where it is not given, unless it `is_needed`."""

    name: str
    key: str
    setting: Setting
    is_needed: bool
    default: Any


@cache
def declarations(entry: type) -> tuple[Declaration, ...]:
    """The fields of a dataclass that settings describe; tables of others come last, as in a file."""
    entries = []
    for part in fields(entry):
        setting = part.metadata.get(_DECLARED)
        if setting is not None:
            default = part.default if part.default_factory is MISSING else part.default_factory()
            key, is_needed = setting.key or part.name, default is MISSING
            entries.append(Declaration(part.name, key, setting, is_needed, default))
    return tuple(sorted(entries, key=lambda part: part.setting.kind == "tables"))


@cache
def settings_of(entry: type) -> Settings:
    """The settings of a dataclass by their keys in a project file."""
    settings: dict[str, Setting] = {}
    for _, key, setting, *_ in declarations(entry):
        if setting.kind == "options":
            settings |= setting.parts
            continue
        settings[key] = setting
        if setting.kind in FILE_KINDS:
            for beside, part in settings_of(setting.of).items():
                if beside != "file":
                    settings.setdefault(beside, part)
    return settings


def property_name(key: str, setting: Setting) -> str:
    return setting.name or key


def switch_name(key: str, settings: Settings) -> str | None:
    """The property that switches a setting on; None where it is always on."""
    setting = settings[key]
    if setting.beside is not None:
        return switch_name(setting.beside, settings)
    return None if setting.switch is None else setting.switch_name or f"use_{key}"
