# SPDX-License-Identifier: GPL-3.0-or-later
"""What a project file has a table of, its place there, and checks that all of them share."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ..base.errors import InputRefused
from ..base.toml_table import Source
from ..settings.method_options import OptionRefused, check_fields, is_name
from ..settings.setting import Declaration, declarations
from .library import Library

Refuse = Callable[..., InputRefused]


def same(one: Any, other: Any) -> bool:
    """Whether two values are equal, also where they are arrays, or have some: these are equal as a whole."""
    if isinstance(one, np.ndarray) or isinstance(other, np.ndarray):
        one, other = np.asarray(one), np.asarray(other)
        return np.array_equal(one, other, equal_nan=one.dtype.kind == other.dtype.kind == "f")
    if isinstance(one, (list, tuple)) and isinstance(other, (list, tuple)):
        return len(one) == len(other) and all(map(same, one, other))
    if isinstance(one, dict) and isinstance(other, dict):
        return one.keys() == other.keys() and all(same(value, other[key]) for key, value in one.items())
    if is_dataclass(one) and type(one) is type(other):
        names = [field.name for field in fields(one) if field.compare]
        return all(same(getattr(one, name), getattr(other, name)) for name in names)
    return bool(one == other)


def changed_values(entry: Any) -> list[tuple[Declaration, Any]]:
    """The fields of a dataclass that settings describe, with their values, without those at their default."""
    kind: type = type(entry)
    values = [(part, getattr(entry, part.name)) for part in declarations(kind)]
    return [(part, value) for part, value in values if part.is_needed or not same(value, part.default)]


def keys_without_effect(entry: Any, shape: str) -> list[str]:
    """The keys that are given for a surface or a fault and have no effect on its kind of shape."""
    keys: list[str] = []
    for part, value in changed_values(entry):
        if not part.setting.fits(shape):
            keys += value if part.setting.kind == "options" else [part.key]
    return keys


class Compared:
    """A dataclass (eq=False) whose fields may be arrays."""

    __hash__ = None  # type: ignore[assignment]

    def __eq__(self, other: object) -> bool:
        return same(self, other) if type(self) is type(other) else NotImplemented


class Entry(Compared):
    """A rock mass, a surface, a fault or a body."""

    kind = ""  # the word for it in messages
    name: str
    shape_file: Path | None  # that its arrays were read from
    source: Source | None

    @property
    def item(self) -> str:
        """Its name in messages."""
        return f"{self.kind} '{self.name}'"

    def place_of(self, key: str | None = None) -> tuple[Path | None, int | None]:
        """The project file, and the line of a key of it there; None where it is in no file."""
        return (None, None) if self.source is None else (self.source.document.file, self.source.line(key))

    def shape_source(self, key: str | None = None) -> tuple[Path | None, int | None]:
        """The source of its shape, for messages: its file, or its line in the project file."""
        return self.place_of(key) if self.shape_file is None else (self.shape_file, None)

    def refused(
        self, what: str, key: str | None = None, advice: str | None = None, item: str | None = None
    ) -> InputRefused:
        """The refusal of it, or of an item in it, at a key of it; the caller raises it."""
        file, line = self.place_of(key)
        return InputRefused(what, file=file, line=line, item=item or self.item, advice=advice)


@contextmanager
def errors_located(refuse: Refuse, key: str | None = None, before: str = "") -> Iterator[None]:
    """Within it a wrong setting is refused where it is written: at its own key, or at another."""
    try:
        yield
    except OptionRefused as error:
        raise refuse(before + error.what, key or error.option, error.advice) from error


def named_once(entries: Sequence, kind: str) -> Iterator:
    """The entries, each with a unique name."""
    seen: set[str] = set()
    for entry in entries:
        if not is_name(entry.name):
            raise entry.refused("it has no name", "name", item=f"a {kind}")
        if entry.name in seen:
            raise entry.refused(f"another {kind} has this name", "name", f"give each {kind} a unique name")
        seen.add(entry.name)
        yield entry


def check_values(entry: Any, refuse: Refuse) -> None:
    """Refuses what the declarations of an entry do not allow."""
    with errors_located(refuse):
        check_fields(entry)


def is_file(path: Path) -> bool:
    """Whether a path leads to a file; no for one that cannot be a path at all."""
    try:
        return path.is_file()
    except (OSError, ValueError):
        return False


def check_file(file: str | Path | None, key: str, refuse: Refuse) -> None:
    if file is not None and not is_file(Path(file)):
        if os.path.isdir(file):
            raise refuse(f"a folder, not a file: {file}", key, "name a file in it")
        raise refuse(f"file not found: {file}", key, "check the path")


def check_table_file(table: Any, key: str, refuse: Refuse) -> None:
    """Refuses the table of a key whose options make no sense, or that does not exist; None is no table."""
    if table is not None:
        with errors_located(refuse, key, f"{key}: "):
            table.check()
        for file in table.files:
            check_file(file, key, refuse)


def shapes_given(entry: Any, keys: Sequence[str], refuse: Refuse) -> list[str]:
    """The key that gives an entry its shape; none where it has no shape, refused where it has two."""
    arrays = entry.vertices is not None or entry.triangles is not None
    shapes = [key for key in keys if getattr(entry, key) is not None] + (["vertices"] if arrays else [])
    if len(shapes) > 1:
        raise refuse(f"it has both {shapes[0]} and {shapes[1]}", shapes[1], "use only one of them")
    if arrays and (entry.vertices is None or entry.triangles is None):
        raise refuse("it needs vertices and triangles together")
    return shapes


def check_property(library: Library | None, number: int, refuse: Refuse) -> None:
    if number and library is not None and number not in library:
        ids = ", ".join(str(entry.id) for entry in library.properties)
        raise refuse(f"the library has no property {number}", "property", f"it has {ids}")
