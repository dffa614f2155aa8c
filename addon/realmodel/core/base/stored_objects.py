# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects as a table of text, and arrays beside it. Reading one runs no code of the file, as pickle would,
and makes objects of known classes only, each with values of the types that its class declares."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import MISSING, fields, is_dataclass
from functools import cache
from pathlib import Path, PurePath
from types import NoneType, UnionType
from typing import Any, Union, get_args, get_origin, get_type_hints

import numpy as np

NOT_STORED = {"stored": False}  # metadata of a field that is as if it had not been given when it is read
_ARRAY, _PATH, _LIST, _TUPLE, _DICT = "array", "path", "list", "tuple", "dict"
_HEAD = 64  # bytes of an array by which it is looked for


class NamedArrays(dict[str, np.ndarray]):
    """Arrays by name. `name_of` takes up another one, unless there is one that is equal byte by byte."""

    def __init__(self, known: Mapping[str, np.ndarray], prefix: str = ""):
        """known: arrays that are elsewhere, and only named. prefix: of the new names, 0, 1, ..."""
        super().__init__()
        self._prefix = prefix
        self._alike: dict[tuple, list[tuple[str, np.ndarray]]] = {}
        for name, array in known.items():
            self._alike_of(array).append((name, array))

    def name_of(self, array: np.ndarray) -> str:
        alike = self._alike_of(array)
        for name, other in alike:
            if other is array or _bytes(other) == _bytes(array):
                return name
        name = f"{self._prefix}{len(self)}"
        self[name] = array
        alike.append((name, array))
        return name

    def _alike_of(self, array: np.ndarray) -> list[tuple[str, np.ndarray]]:
        """Those that may be equal: of thousands of holes each has its own arrays."""
        return self._alike.setdefault((array.dtype.str, array.shape, bytes(_bytes(array)[:_HEAD])), [])


def _bytes(array: np.ndarray) -> memoryview:
    return memoryview(np.ascontiguousarray(array).reshape(-1).view(np.uint8))


class StoredClasses:
    """Classes whose objects may be in a file, by their names."""

    def __init__(self, kinds: Iterable[type]):
        self._kinds = {kind.__name__: kind for kind in kinds}

    def write(
        self, value: object, arrays: NamedArrays, stored: Callable[[Any], Any] = lambda value: value
    ) -> bytes:
        """The table of a value of these classes, lists, tuples, dicts, paths, arrays, numbers and texts.

        What is one object in several places is one again when it is read; so are equal arrays. stored: what
        is stored instead of a path or an object.
        """
        table: list[list] = []  # each entry after those that it names
        numbers: dict[Any, int] = {}  # by the id of an object, or the name of an array

        def number_of(value: Any) -> Any:
            """A plain value, or [number of its entry]."""
            if value is None or isinstance(value, (bool, int, float, str)):
                return value
            if isinstance(value, np.generic):
                return value.item()
            is_array = isinstance(value, np.ndarray)
            key = arrays.name_of(value) if is_array else id(value)
            if key not in numbers:
                entry = [_ARRAY, key] if is_array else entry_of(value)
                numbers[key] = len(table)
                table.append(entry)
            return [numbers[key]]

        def entry_of(value: Any) -> list:
            value = stored(value)
            name = type(value).__name__
            if self._kinds.get(name) is type(value):
                return [name, [[key, number_of(part)] for key, part in _content(value)]]
            if isinstance(value, PurePath):
                return [_PATH, value.as_posix()]
            if isinstance(value, (list, tuple)):
                kind = _LIST if isinstance(value, list) else _TUPLE
                return [kind, [number_of(element) for element in value]]
            if isinstance(value, Mapping):
                return [_DICT, [[number_of(key), number_of(element)] for key, element in value.items()]]
            raise TypeError(f"{type(value)} cannot be written")

        root = number_of(value)
        return json.dumps([table, root]).encode()

    def read(self, text: bytes, arrays: Mapping[str, np.ndarray]) -> Any:
        """The value of a table of `write`. Raises ValueError where it is something else."""
        objects: list[Any] = []

        def value_of(reference: Any) -> Any:
            return objects[reference[0]] if isinstance(reference, list) else reference

        try:
            table, root = json.loads(text)
            for kind, content in table:
                objects.append(self._made(kind, content, arrays, value_of))
            return value_of(root)
        except (KeyError, IndexError, TypeError, AttributeError, RecursionError) as error:
            raise ValueError(f"a table of objects is damaged: {type(error).__name__} {error}") from error

    def _made(self, kind: str, content: Any, arrays: Mapping, value_of: Callable[[Any], Any]) -> Any:
        """An object of an entry; no constructor runs but that of a tuple."""
        if kind == _ARRAY:
            return arrays[content]
        if kind == _PATH:
            return Path(content)
        if kind in (_LIST, _TUPLE):
            entries = [value_of(entry) for entry in content]
            return entries if kind == _LIST else tuple(entries)
        if kind == _DICT:
            return {value_of(key): value_of(entry) for key, entry in content}
        made: Any = self._kinds[kind]
        values = {key: value_of(entry) for key, entry in content}
        if issubclass(made, tuple):
            return made(**_checked(made, values))
        instance = made.__new__(made)
        if is_dataclass(made):
            values = {**_defaults(made, values), **_checked(made, values)}
        vars(instance).update(values)
        return instance


def _content(value: Any) -> Iterable[tuple[str, Any]]:
    """What is stored of an object of a class, in order."""
    if is_dataclass(value):
        names = [attribute.name for attribute in fields(value) if attribute.metadata != NOT_STORED]
    elif isinstance(value, tuple):
        names = list(value._fields)  # type: ignore[attr-defined]  # a NamedTuple
    else:
        names = list(vars(value))
    return [(name, getattr(value, name)) for name in names]


def _defaults(kind: Any, values: Mapping[str, Any]) -> dict[str, Any]:
    """The values of the fields of a dataclass that are not given."""
    defaults = {}
    for attribute in fields(kind):
        if attribute.name not in values:
            if attribute.default is MISSING and attribute.default_factory is MISSING:
                raise ValueError(f"{kind.__name__} has no {attribute.name}")
            made = attribute.default_factory
            defaults[attribute.name] = attribute.default if made is MISSING else made()
    return defaults


def _checked(kind: Any, values: dict[str, Any]) -> dict[str, Any]:
    """Values of the fields of a class. Raises ValueError where it has no such field, or of another type."""
    hints = hints_of(kind)
    for name, value in values.items():
        if not fits(value, hints[name]):
            raise ValueError(f"{kind.__name__}.{name} is not of the type {hints[name]}")
    return values


@cache
def hints_of(kind: type) -> dict[str, Any]:
    return get_type_hints(kind)


def fits(value: Any, hint: Any) -> bool:
    """Whether a value has a declared type, with all that is in it. Arrays are sequences, too."""
    origin, of = get_origin(hint), get_args(hint)
    if origin in (Union, UnionType):
        return any(fits(value, choice) for choice in of)
    if hint in (int, float):
        return isinstance(value, (int, hint)) and not isinstance(value, bool)
    if origin is None:
        kinds = (Sequence, np.ndarray) if hint is Sequence else NoneType if hint is None else hint
        return hint is Any or isinstance(value, kinds)
    if origin is Sequence and isinstance(value, np.ndarray):
        return True
    if not isinstance(value, origin):
        return False
    if isinstance(value, Mapping):
        return all(fits(key, of[0]) and fits(element, of[1]) for key, element in value.items())
    if origin is tuple and of[-1] is not Ellipsis:
        return len(value) == len(of) and all(map(fits, value, of))
    return all(fits(element, of[0]) for element in value)
