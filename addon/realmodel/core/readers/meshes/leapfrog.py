# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes of Leapfrog (.msh, ARANZ 1.0): an index of arrays as text, then the arrays in its order, binary."""

from __future__ import annotations

import re
from math import prod
from pathlib import Path

import numpy as np

from ...base.text import Step, no_step, read_bytes
from ..objects.geo_object import ObjectName
from .triangle_mesh import UNREADABLE, surface_object, unreadable

_MAGIC = b"%ARANZ-1.0"
_ARRAY = re.compile(rb"^\s*(\w+) (\w+) (\d{1,9}) (\d{1,9});\s*$", re.MULTILINE)  # name, type, columns, rows
_NAME = re.compile(rb"""^\s*Name\s*[:= ]\s*["']?([^"';\r\n]+)""", re.IGNORECASE | re.MULTILINE)
_BINARY = b"[binary]"
_BEFORE = range(12, 15)  # bytes between that word and the arrays: a mark, behind the end of a line in some
_TYPES = {"Integer": "<i4", "Double": "<f8", "Float": "<f4", "Single": "<f4"}


def begins_as_leapfrog(head: bytes, _size: int = 0) -> bool:
    """Whether a file that begins so is one."""
    return head.startswith(_MAGIC)


def read_leapfrog(file: str | Path, _step: Step = no_step) -> list[ObjectName]:
    """Reads the triangles; it is called as in its index, or else as its file. Raises InputRefused."""
    file = Path(file)
    index, _, content = read_bytes(file).partition(_BINARY)
    arrays: dict[str, np.ndarray] = {}
    try:
        rows = [
            (name.decode(), np.dtype(_TYPES[kind.decode()]), (int(count), int(columns)))
            for name, kind, columns, count in _ARRAY.findall(index)
        ]
        at = len(content) - sum(kind.itemsize * prod(shape) for _, kind, shape in rows)
        if at not in _BEFORE:
            raise ValueError("the sizes of its arrays differ from its index")
        for name, kind, shape in rows:
            arrays[name] = np.frombuffer(content, kind, prod(shape), at).reshape(shape)
            at += arrays[name].nbytes
        vertices, triangles = arrays["Location"], arrays["Tri"]
        if vertices.shape[1] != 3 or triangles.shape[1] != 3:
            raise ValueError("its vertices or triangles have not three numbers")
    except KeyError as error:
        raise unreadable(file, "Leapfrog", ValueError(f"unknown or missing: {error}")) from error
    except UNREADABLE as error:
        raise unreadable(file, "Leapfrog", error) from error
    name = _NAME.search(index)
    label = name[1].decode("utf-8", "replace").strip() if name else file.stem
    return [surface_object(file, label, vertices, triangles)]
