# SPDX-License-Identifier: GPL-3.0-or-later
"""The library: the properties of blocks."""

from __future__ import annotations

import math
import re
from collections.abc import Collection, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from ..base.errors import InputRefused, UsageError
from ..settings.method_options import OptionRefused, check_fields, without
from ..settings.setting import declared, settings_of
from .looks import LOOKS, RGB, rgb

_COLOR = re.compile(r"#[0-9a-fA-F]{6}")
AUTO_LOOK = "auto"  # the look that suits the rock by its name
LOOK_NAMES = (AUTO_LOOK, *(key.lower() for key in LOOKS))


def _checked_id(key: str, number: Any) -> Any:
    if isinstance(number, bool) or not isinstance(number, int) or not -(2**31) <= number < 2**31:
        raise OptionRefused("an id must be a 32-bit whole number", key)
    return number


def _checked_name(key: str, name: Any) -> Any:
    if not isinstance(name, str) or not name.strip():
        raise OptionRefused("it has no name", key)
    return name


def _checked_color(key: str, color: Any) -> Any:
    if color is not None and not _COLOR.fullmatch(color):
        raise OptionRefused(f"{key} '{color}' is not a color", key, 'write it as "#rrggbb"')
    return color


def _checked_look(key: str, look: Any) -> Any:
    if look is not None and look not in LOOK_NAMES:
        raise OptionRefused(f"{key} '{look}' is unknown", key, f"choose from {', '.join(LOOK_NAMES)}")
    return look


def _above_zero(key: str) -> Any:
    return without(lambda value: None if value > 0 else f"{key} must be above 0, not {value:g}")


def _at_most_one(key: str) -> Any:
    return without(
        lambda value: None if 0 < value <= 1 else f"{key} must be above 0 and at most 1, not {value:g}"
    )


@dataclass(frozen=True)
class Property:
    """One entry of a library: a rock or another kind of material, by a unique `id` above 0 and a `name`.

    rock, age, structure, description: texts. color: "#rrggbb" (sRGB). density: in the user's units. For
    simulators: porosity, above 0 and at most 1; permeability, millidarcies. For pictures: `look` one of
    LOOK_NAMES, the size `look_scale` of its texture (1 suits the model) and its seed `look_seed`; `hardness`,
    above 0 and at most 1, is the resistance of the rock to weathering.
    """

    id: int = declared(kind="integer", check=_checked_id, is_needed=True)
    name: str = declared(
        kind="name",
        label="Name",
        tip="Name of the rock, and of the material of its blocks",
        check=_checked_name,
        is_needed=True,
    )
    rock: str | None = declared(kind="note", label="Lithology", tip="Rock type, such as sandstone")
    age: str | None = declared(kind="note", label="Age", tip="Geological age, such as Triassic")
    structure: str | None = declared(kind="note", label="Structure", tip="Bedding, texture, grain size")
    color: str | None = declared(kind="line", check=_checked_color)
    density: float | None = declared(
        kind="finite",
        label="Density",
        tip="Density in any unit, such as kg/m³; 0: unknown",
        low=0.0,
        zero_is_none=True,
        check=_above_zero("density"),
    )
    porosity: float | None = declared(
        kind="finite",
        label="Porosity",
        tip="Share of pores in the rock, at most 1, for reservoir simulators; 0: unknown",
        low=0.0,
        high=1.0,
        zero_is_none=True,
        check=_at_most_one("porosity"),
    )
    permeability: float | None = declared(
        kind="finite",
        label="Permeability",
        tip="Permeability in millidarcies, for reservoir simulators; 0: unknown",
        low=0.0,
        zero_is_none=True,
        check=_above_zero("permeability"),
    )
    description: str | None = declared(kind="note", label="Description", tip="Further notes")
    look: str | None = declared(kind="line", check=_checked_look)
    look_scale: float | None = declared(
        kind="finite",
        label="Texture Scale",
        tip="Size of the texture; 1 suits the model",
        start=1.0,
        low=0.001,
        check=without(
            lambda value: None if 0 < value < math.inf else f"look_scale must be above 0, not {value:g}"
        ),
    )
    look_seed: int | None = declared(
        kind="integer",
        label="Texture Seed",
        tip="Another texture of the same kind",
        low=0,
        zero_is_none=True,
        check=without(
            lambda value: (
                None if 0 <= value < 2**31 else f"look_seed must be from 0 to {2**31 - 1}, not {value}"
            )
        ),
    )
    hardness: float | None = declared(
        kind="finite",
        label="Hardness",
        tip="Resistance of the rock to weathering in pictures, at most 1; 0: that of its look",
        low=0.0,
        high=1.0,
        zero_is_none=True,
        check=_at_most_one("hardness"),
    )

    @property
    def rgb(self) -> RGB | None:
        """Red, green, blue from 0 to 1, sRGB encoded; None without a color."""
        return None if self.color is None else rgb(self.color)


@dataclass
class Library:
    """The `properties`, each with a unique id. `path` is the file that they were read from, if any."""

    properties: list[Property] = field(default_factory=list)
    path: Path | None = None

    def __post_init__(self) -> None:
        self.properties = list(self.properties)
        seen: set[int] = set()
        for entry in self.properties:
            try:
                check_property(entry, seen)
            except OptionRefused as error:
                property_name = f"property {entry.id!r}"
                raise InputRefused(error.what, item=property_name, advice=error.advice) from error
            seen.add(entry.id)

    def __contains__(self, key: int | str) -> bool:
        return any(key in (entry.id, entry.name) for entry in self.properties)

    def __getitem__(self, key: int | str) -> Property:
        """The property with this id or name. Raises UsageError.

        >>> Library([Property(7, "Sandstone")])["Sandstone"].id
        7
        """
        for entry in self.properties:
            if key in (entry.id, entry.name):
                return entry
        names = ", ".join(f"{entry.id} '{entry.name}'" for entry in self.properties)
        raise UsageError(f"the library has no property {key!r}; it has {names}")

    def __iter__(self) -> Iterator[Property]:
        return iter(self.properties)

    def __len__(self) -> int:
        return len(self.properties)

    def get(self, number: int) -> Property | None:
        """The property whose id is `number`, or None."""
        return next((entry for entry in self.properties if entry.id == number), None)


def check_property(entry: Property, seen: Collection[int]) -> None:
    """Refuses a property that makes no sense, or whose id is among those seen. Raises OptionRefused."""
    check_fields(entry)
    if entry.id in seen:
        raise OptionRefused("another property has this id", "id", "give each a unique id")


PROPERTY = settings_of(Property)
