#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes addon/realmodel/_native.pyi, by which mypy checks calls of the native module, from the signatures
that pybind11 gives its functions. A test compares them (tests/core/test_package.py).

    PYTHONPATH=addon python3 scripts/write_stub.py
"""

import re
from pathlib import Path

STUB = Path(__file__).resolve().parents[1] / "addon" / "realmodel" / "_native.pyi"
_HEAD = '''\
# SPDX-License-Identifier: GPL-3.0-or-later
# Written by scripts/write_stub.py from the module.
from collections.abc import Sequence
from typing import Any, SupportsFloat, SupportsIndex, SupportsInt

import numpy as np
from numpy.typing import ArrayLike, NDArray

Real = SupportsFloat | SupportsIndex
Whole = SupportsInt | SupportsIndex
Numbers = Sequence[float] | Sequence[int] | NDArray[Any]
Rows = Sequence[Numbers] | NDArray[Any]

class Native:
    """The module itself, as native_module() returns it."""

'''
_ATTRIBUTES = {
    "InputError": [
        "    kind: str",
        "    surface: int",
        "    items: list[int]",
        "    place: tuple[float, float, float] | None",
    ]
}
_TYPES = (  # what pybind11 writes, and what a caller may give or gets
    (r"typing\.SupportsFloat \| typing\.SupportsIndex", "Real"),
    (r"typing\.SupportsInt \| typing\.SupportsIndex", "Whole"),
    (r"typing\.Annotated\[numpy\.typing\.ArrayLike, [\w.]+\]|numpy\.ndarray\[[\w.]+\]", "ArrayLike"),
    (r"numpy\.typing\.NDArray\[numpy\.(\w+)\]", r"NDArray[np.\1]"),
    (r"numpy\.ndarray$", "NDArray[Any]"),
    (r"collections\.abc\.", ""),
    (r"(?<!\w)list(?!\[)", "list[Any]"),
    (r'typing\.Annotated\[(list\[bool\]), "FixedSize\(\d+\)"\]', r"\1"),
    (r'typing\.Annotated\[Sequence\[Real\], "FixedSize\(\d+\)"\]|Sequence\[(?:Real|Whole)\]', "Numbers"),
    (r'typing\.Annotated\[Sequence\[Numbers\], "FixedSize\(\d+\)"\]|Sequence\[Numbers\]', "Rows"),
    (r"realmodel\._native\.(\w+)( = None)", r"Native.\1 | None\2"),
    (r"realmodel\._native\.", "Native."),
    (r"\(self: [\w.]+", "(self"),
    (r" = (?!None)(?:'[^']*'|(?:array)?\(.*?\)|[^,)]+)", " = ..."),
    (r"\bdict\b(?!\[)", "dict[str, Any]"),
    (r"-> object", "-> Any"),  # of numpy.vectorize: a number for numbers, an array for arrays
)


def _definition(function):
    signature = function.__doc__.splitlines()[0]
    for pattern, type_ in _TYPES:
        signature = re.sub(pattern, type_, signature)
    arguments, returned = signature.rsplit(" -> ", 1)
    return f"def {arguments} -> {returned}: ..."


def _class(kind):
    error = f"({kind.__bases__[0].__name__})" if issubclass(kind, Exception) else ""
    lines = [f"class {kind.__name__}{error}:", *_ATTRIBUTES.get(kind.__name__, [])]
    for name, member in sorted(vars(kind).items()):
        if isinstance(member, property):
            lines.append(f"    {name}: {_definition(member.fget).rpartition(' -> ')[2][:-5]}")
        elif not name.startswith("_") or (name == "__init__" and "->" in member.__doc__):
            lines.append(f"    {_definition(member)}")
    return lines if len(lines) > 1 else [f"{lines[0]} ..."]


def stub(module):
    """The text of the stub of a module."""
    members = [(name, value) for name, value in sorted(vars(module).items()) if not name.startswith("_")]
    lines = []
    for name, value in members:
        if isinstance(value, type):
            lines += _class(value)
        elif callable(value):
            lines.append(_definition(value).replace("(", "(self, ", 1).replace("(self, )", "(self)"))
        else:
            lines.append(f"{name}: {type(value).__name__}")
    return _HEAD + "".join(f"    {line}\n" for line in lines)


if __name__ == "__main__":
    from realmodel import _native

    STUB.write_text(stub(_native), encoding="utf-8")
