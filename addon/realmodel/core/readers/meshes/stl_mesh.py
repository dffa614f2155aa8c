# SPDX-License-Identifier: GPL-3.0-or-later
"""STL, binary and as text (3D Systems, "Stereolithography interface specification"): each `solid` of a text
is an object."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from ...base.text import Step, no_step, read_bytes
from ..objects.geo_object import SURFACE, GeoObject, ObjectName
from .triangle_mesh import (
    UNREADABLE,
    DamagedError,
    mesh_of_corners,
    object_of_mesh,
    unreadable,
)

_CORNER = re.compile(rb"vertex\s+(\S+)\s+(\S+)\s+(\S+)", re.IGNORECASE)
_SOLID = re.compile(rb"^[ \t]*solid\b[ \t]*([^\r\n]*)", re.IGNORECASE | re.MULTILINE)
_FACET = re.compile(rb"\bfacet\b", re.IGNORECASE)
_HEAD, _ROW = 84, np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("more", "<u2")])
_END = re.compile(rb"\bend\s*facet", re.IGNORECASE)
_BEHIND = 4096  # bytes that some programs write behind the last facet, at most


def begins_as_stl(head: bytes, size: int) -> bool:
    """Whether a file of this size that begins with these bytes is an STL, as text or binary."""
    if head.lstrip()[:5].lower() == b"solid" and _FACET.search(head):
        return True
    count = int.from_bytes(head[_HEAD - 4 : _HEAD], "little")
    return len(head) >= _HEAD and 0 <= size - _HEAD - count * _ROW.itemsize < (_BEHIND if count else 1)


def read_stl(file: str | Path, step: Step = no_step) -> list[ObjectName]:
    """Reads an STL, binary or text; corners at the same position become one vertex. Raises InputRefused."""
    file = Path(file)
    raw = read_bytes(file)
    try:
        if _is_text(raw):
            solids = _solids(raw)
        else:
            solids = [((raw[:5].lower() == b"solid" and _name(raw[5:80])) or "", _facets(raw))]
    except UNREADABLE as error:
        raise unreadable(file, "STL", error) from error
    step(0.5)
    return [_object(file, name, corners) for name, corners in solids]


def _object(file: Path, name: str, corners: np.ndarray) -> ObjectName:
    def made() -> GeoObject:
        return object_of_mesh(name, mesh_of_corners(file, corners))

    return ObjectName(name, SURFACE, made)


def _is_text(raw: bytes) -> bool:
    """Whether it is text: it begins so, and its size is not that of the facets that a binary file
    announces."""
    if raw.lstrip()[:5].lower() != b"solid":
        return False
    count = int.from_bytes(raw[_HEAD - 4 : _HEAD], "little")
    return b"\0" not in raw[:_HEAD] and not 0 <= len(raw) - _HEAD - count * _ROW.itemsize < _BEHIND


def _facets(raw: bytes) -> np.ndarray:
    """(3 F, 3) corners of the facets of a binary file. Where it announces none, or more than are there but a
    whole number of them is, its size tells how many. Raises ValueError."""
    count, room = int.from_bytes(raw[_HEAD - 4 : _HEAD], "little"), max(len(raw) - _HEAD, 0)
    if (count == 0 or count == 0xFFFFFFFF) and room and room % _ROW.itemsize == 0:
        count = room // _ROW.itemsize
    if len(raw) < _HEAD or count * _ROW.itemsize > room:
        raise ValueError(f"{count} triangles are announced, the file is cut off at byte {len(raw)}")
    return np.frombuffer(raw, _ROW, count, _HEAD)["corners"].reshape(-1, 3)


def _solids(raw: bytes) -> list[tuple[str, np.ndarray]]:
    """The name of each solid of a text that has facets, and their corners. Raises DamagedError,
    ValueError."""
    begins = list(_SOLID.finditer(raw))
    solids = []
    for number, begin in enumerate(begins):
        end = begins[number + 1].start() if number + 1 < len(begins) else len(raw)
        text = raw[begin.end() : end]
        corners = np.array(_CORNER.findall(text)).astype(np.float64).reshape(-1, 3)
        if len(corners) != 3 * len(_END.findall(text)):
            raise DamagedError("a triangle does not have three vertices", line=_wrong_facet(raw))
        if len(corners):
            solids.append((_name(begin[1]), corners))
    if not solids:
        raise DamagedError("it has no triangles", line=1)
    return solids


def _name(text: bytes) -> str:
    return text.replace(b"\0", b" ").decode("utf-8", "replace").strip()


def _wrong_facet(raw: bytes) -> int:
    """The line of the first facet of a text STL that has not three vertices."""
    at = 0
    for end in _END.finditer(raw):
        facet = raw[at : end.start()]
        if len(_CORNER.findall(facet)) != 3:
            break
        at = end.end()
    begin = _FACET.search(raw, at)
    return raw.count(b"\n", 0, max(-1 if begin is None else begin.start(), at)) + 1
