# SPDX-License-Identifier: GPL-3.0-or-later
"""The window of a tile in a file. Reading it runs no code of the file, as pickle would, and makes objects of
known classes only."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from ..core import Body, BuildFailed, BuildWarning, Fault, InputRefused, Rock, Surface
from ..core.base.mapped_arrays import read_mapped, write_mapped
from ..core.base.sheet import Sheet
from ..core.cells.reach import Reach
from ..core.structures.parts.parts import Structures
from ..core.surfaces.rock_input import RockInput
from ..core.surfaces.rock_structure import RockStructure
from ..core.surfaces.sides import FaultShape, RockFaults
from ..core.tiles.faulted_windows import Window

_STORED: tuple[type, ...] = (
    *(Window, RockInput, Rock, Surface, RockStructure, RockFaults, FaultShape, Structures, Fault, Body),
    *(Reach, Sheet, BuildWarning, InputRefused),
)
_CLASSES = {kind.__name__: kind for kind in _STORED}
_OBJECTS = "objects"  # the table of objects, as JSON; arrays have numbers for names
_ARRAY, _PATH, _LIST, _TUPLE, _DICT = "array", "path", "list", "tuple", "dict"


def write_object(value: object, file: BinaryIO) -> None:
    """Writes a value of these classes, lists, tuples, dicts, paths, arrays, numbers and texts.

    What is one object in several places is one again when it is read.
    """
    table: list[list] = []  # each entry after those that it names
    arrays: dict[str, np.ndarray] = {}
    known: dict[int, int] = {}

    def number_of(value: Any) -> Any:
        """A plain value, or [number of its entry]."""
        if value is None or isinstance(value, (bool, int, float, str)):
            return value
        if isinstance(value, np.generic):
            return value.item()
        if id(value) not in known:
            entry = entry_of(value)
            known[id(value)] = len(table)
            table.append(entry)
        return [known[id(value)]]

    def entry_of(value: Any) -> list:
        kind = type(value)
        if kind is np.ndarray:
            name = str(len(arrays))
            arrays[name] = value
            return [_ARRAY, name]
        if isinstance(value, Path):
            return [_PATH, str(value)]
        if kind in (list, tuple):
            return [_LIST if kind is list else _TUPLE, [number_of(each) for each in value]]
        if kind is dict:
            return [_DICT, [[number_of(key), number_of(each)] for key, each in value.items()]]
        if kind not in _STORED:
            raise TypeError(f"{kind} cannot be written")
        if isinstance(value, tuple):
            return [kind.__name__, [number_of(each) for each in value]]
        return [kind.__name__, [[key, number_of(each)] for key, each in vars(value).items()]]

    root = number_of(value)
    text = json.dumps([table, root]).encode()
    write_mapped({_OBJECTS: np.frombuffer(text, np.uint8), **arrays}, file)


def read_object(path: Path) -> Any:
    """The value of a file of write_object; changes of its arrays stay in memory. Raises BuildFailed."""
    arrays = read_mapped(path)
    found: list[Any] = []

    def value_of(given: Any) -> Any:
        return found[given[0]] if isinstance(given, list) else given

    try:
        table, root = json.loads(arrays[_OBJECTS].tobytes())
        for kind, content in table:
            found.append(_made(kind, content, arrays, value_of))
        return value_of(root)
    except (KeyError, IndexError, ValueError, TypeError) as error:
        raise BuildFailed(f"{path}: cannot be read; delete it and start again") from error


def _made(kind: str, content: Any, arrays: dict[str, np.ndarray], value_of: Callable[[Any], Any]) -> Any:
    """An object of an entry; no constructor runs but that of a tuple."""
    if kind == _ARRAY:
        return arrays[content]
    if kind == _PATH:
        return Path(content)
    if kind in (_LIST, _TUPLE):
        values = [value_of(each) for each in content]
        return values if kind == _LIST else tuple(values)
    if kind == _DICT:
        return {value_of(key): value_of(each) for key, each in content}
    made: Any = _CLASSES[kind]
    if issubclass(made, tuple):
        return made(*(value_of(each) for each in content))
    instance = made.__new__(made)
    vars(instance).update((key, value_of(each)) for key, each in content)
    return instance
