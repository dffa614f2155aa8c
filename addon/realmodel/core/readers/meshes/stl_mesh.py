# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes in the format STL, binary and as text."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from ...base.text import Step, no_step, read_bytes
from .triangle_mesh import UNREADABLE, DamagedError, TriangleMesh, mesh_of_corners, unreadable

_CORNER = re.compile(rb"vertex\s+(\S+)\s+(\S+)\s+(\S+)")
_HEAD, _FACET = 84, np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("more", "<u2")])
_END = b"endfacet"


def begins_as_stl(head: bytes, size: int) -> bool:
    """Whether a file of this size that begins with these bytes is an STL, as text or binary."""
    if head.lstrip().startswith(b"solid") and b"facet" in head:
        return True
    count = int.from_bytes(head[_HEAD - 4 : _HEAD], "little")
    return len(head) >= _HEAD and size == _HEAD + count * _FACET.itemsize


def read_stl(file: str | Path, step: Step = no_step) -> TriangleMesh:
    """Reads an STL, binary or text; corners at the same position become one vertex. Raises InputRefused."""
    file = Path(file)
    raw = read_bytes(file)
    count = int.from_bytes(raw[_HEAD - 4 : _HEAD], "little")
    size = _HEAD + count * _FACET.itemsize
    try:
        if len(raw) == size or not raw.lstrip().startswith(b"solid"):
            if len(raw) < max(size, _HEAD):
                raise ValueError(f"{count} triangles are announced, the file is cut off at byte {len(raw)}")
            corners = np.frombuffer(raw, _FACET, count, _HEAD)["corners"].reshape(-1, 3)
        else:
            corners = np.array(_CORNER.findall(raw)).astype(np.float64).reshape(-1, 3)
            if len(corners) != 3 * raw.count(_END):
                raise DamagedError("a triangle does not have three vertices", line=_wrong_facet(raw))
            if not len(corners):
                raise DamagedError("it has no triangles", line=1)
    except UNREADABLE as error:
        raise unreadable(file, "STL", error) from error
    step(0.5)
    return mesh_of_corners(file, corners)


def _wrong_facet(raw: bytes) -> int:
    """The line of the first facet of a text STL that has not three vertices."""
    at = 0
    for facet in raw.split(_END):
        if len(_CORNER.findall(facet)) != 3:
            break
        at += len(facet) + len(_END)
    return raw.count(b"\n", 0, max(raw.find(b"facet", at), at)) + 1
