# SPDX-License-Identifier: GPL-3.0-or-later
"""The library: the properties of blocks."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field, fields
from pathlib import Path

from ..base.errors import InputRefused, UsageError
from ..base.toml_table import Table, TomlDocument
from .colors import RGB, rgb
from .looks import LOOKS

_COLOR = re.compile(r"#[0-9a-fA-F]{6}")
AUTO_LOOK = "auto"  # the look that suits the rock by its name
LOOK_NAMES = (AUTO_LOOK, *(key.lower() for key in LOOKS))


@dataclass(frozen=True)
class Property:
    """One entry of a library: a rock or another kind of material, by a unique `id` above 0 and a `name`.

    rock, age, structure, description: texts. color: "#rrggbb" (sRGB). density: in the user's units. For
    pictures: `look` one of LOOK_NAMES, the size `look_scale` of its texture (1 suits the model) and its seed
    `look_seed`; `hardness`, above 0 and at most 1, says how well the rock withstands weathering.
    """

    id: int
    name: str
    rock: str | None = None
    age: str | None = None
    structure: str | None = None
    color: str | None = None
    density: float | None = None
    description: str | None = None
    look: str | None = None
    look_scale: float | None = None
    look_seed: int | None = None
    hardness: float | None = None

    @property
    def rgb(self) -> RGB | None:
        """Red, green, blue from 0 to 1, sRGB encoded; None without a color."""
        return None if self.color is None else rgb(self.color)


@dataclass
class Library:
    """The `properties`, each with an id of its own. `path` is the file that they were read from, if any."""

    properties: list[Property] = field(default_factory=list)
    path: Path | None = None

    def __post_init__(self) -> None:
        self.properties = list(self.properties)
        seen: set[int] = set()
        for entry in self.properties:
            _check_property(entry, seen)
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
        known = ", ".join(f"{entry.id} '{entry.name}'" for entry in self.properties)
        raise UsageError(f"the library has no property {key!r}; it has {known}")

    def __iter__(self) -> Iterator[Property]:
        return iter(self.properties)

    def __len__(self) -> int:
        return len(self.properties)

    def get(self, number: int) -> Property | None:
        """The property whose id is `number`, or None."""
        return next((entry for entry in self.properties if entry.id == number), None)


def _check_property(entry: Property, seen: set[int]) -> None:
    item = f"property {entry.id!r}"
    if isinstance(entry.id, bool) or not isinstance(entry.id, int) or not -(2**31) <= entry.id < 2**31:
        raise InputRefused("an id must be a 32-bit whole number", item=item)
    if entry.id in seen:
        raise InputRefused("another property has this id", item=item, advice="give each a unique id")
    if not isinstance(entry.name, str) or not entry.name.strip():
        raise InputRefused("it has no name", item=item)
    if entry.color is not None and not _COLOR.fullmatch(entry.color):
        raise InputRefused(f"color '{entry.color}' is not a color", item=item, advice='write it as "#rrggbb"')
    if entry.density is not None and not entry.density > 0:
        raise InputRefused(f"density must be above 0, not {entry.density:g}", item=item)
    _check_look(entry, item)


def _check_look(entry: Property, item: str) -> None:
    if entry.look is not None and entry.look not in LOOK_NAMES:
        known = ", ".join(LOOK_NAMES)
        raise InputRefused(f"look '{entry.look}' is unknown", item=item, advice=f"choose from {known}")
    if entry.look_scale is not None and not 0 < entry.look_scale < float("inf"):
        raise InputRefused(f"look_scale must be above 0, not {entry.look_scale:g}", item=item)
    if entry.look_seed is not None and not 0 <= entry.look_seed < 2**31:
        raise InputRefused(f"look_seed must be from 0 to {2**31 - 1}, not {entry.look_seed}", item=item)
    if entry.hardness is not None and not 0 < entry.hardness <= 1:
        raise InputRefused(f"hardness must be above 0 and at most 1, not {entry.hardness:g}", item=item)


def load_library(path: str | Path) -> Library:
    """Reads a library file. Raises InputRefused with the line of the error."""
    document = TomlDocument(Path(path))
    top = Table(document, document.content, (), "")
    top.allow_only(("property",))
    properties: list[Property] = []
    seen: set[int] = set()
    for table in top.tables("property", "property") if "property" in top else []:
        entry = _read_property(table)
        try:
            _check_property(entry, seen)
        except InputRefused as error:
            word = error.what.split()[0]
            raise table.refuse(error.what, word if word in table else "id", error.advice) from error
        seen.add(entry.id)
        properties.append(entry)
    return Library(properties, Path(path))


def _read_property(table: Table) -> Property:
    table.allow_only([entry.name for entry in fields(Property)])
    return Property(
        id=table.integer("id", required=True),
        name=table.text("name", required=True),
        rock=_loose_text(table, "rock"),
        age=_loose_text(table, "age"),
        structure=_loose_text(table, "structure"),
        color=_loose_text(table, "color"),
        description=_loose_text(table, "description"),
        density=table.number("density"),
        look_scale=table.number("look_scale"),
        hardness=table.number("hardness"),
        look=table.text("look"),
        look_seed=table.integer("look_seed"),
    )


def _loose_text(table: Table, key: str) -> str | None:
    """Text that may be empty (not given) or have several lines, as descriptions."""
    value = table.content.get(key)
    if isinstance(value, str) and key != "color":
        return value or None
    return table.text(key)
