# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes in the format STL, binary and as text."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from ...base.mapped_arrays import ROWS_AT_ONCE, MakeRows, Rows
from ...base.text import BYTES_AT_ONCE, FileBytes, Step, no_step
from .damaged_mesh import UNREADABLE, Damaged, unreadable
from .shared_vertices import share_vertices
from .triangle_mesh import MeshRows, TriangleMesh

_CORNER = re.compile(rb"vertex\s+(\S+)\s+(\S+)\s+(\S+)")
_HEAD, _FACET = 84, np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("more", "<u2")])
_END = b"endfacet"


def begins_as_stl(head: bytes, size: int) -> bool:
    """Whether a file of this size that begins with these bytes is an STL, as text or binary."""
    if head.lstrip().startswith(b"solid") and b"facet" in head:
        return True
    count = int.from_bytes(head[_HEAD - 4 : _HEAD], "little")
    return len(head) >= _HEAD and size == _HEAD + count * _FACET.itemsize


def read_stl(file: str | Path, step: Step = no_step, rows: MakeRows = Rows) -> TriangleMesh:
    """Reads an STL, binary or text; corners at the same position become one vertex. rows: where they are
    kept. Raises InputRefused."""
    file = Path(file)
    raw = FileBytes(file)
    corners, mesh = rows(np.empty((0, 3))), MeshRows(file, rows)
    count = int.from_bytes(raw[_HEAD - 4 : _HEAD], "little")
    size = _HEAD + count * _FACET.itemsize
    try:
        if len(raw) == size or not raw[:BYTES_AT_ONCE].lstrip().startswith(b"solid"):
            if len(raw) < max(size, _HEAD):
                raise ValueError(f"{count} triangles are announced, the file is cut off at byte {len(raw)}")
            pieces = _of_binary(raw, count)
        else:
            pieces = _of_text(raw)
        for share, piece in pieces:
            corners.add(piece + 0.0)  # zero has one sign
            step(0.5 * share)
    except UNREADABLE as error:
        raise unreadable(file, "STL", error) from error
    share_vertices(corners.array(), None, mesh, rows)
    return mesh.mesh()


def _of_binary(raw: FileBytes, count: int) -> Iterator[tuple[float, np.ndarray]]:
    """Which share is done, and corners (3 T, 3) of triangles."""
    for begin in range(0, count, ROWS_AT_ONCE):
        end = min(begin + ROWS_AT_ONCE, count)
        piece = raw[_HEAD + begin * _FACET.itemsize : _HEAD + end * _FACET.itemsize]
        corners = np.frombuffer(piece, _FACET)["corners"].reshape(-1, 3)
        with np.errstate(invalid="ignore"):  # NaN of any kind is refused
            yield end / count, corners.astype(np.float64)


def _of_text(raw: FileBytes) -> Iterator[tuple[float, np.ndarray]]:
    """The same of a text file."""
    rest, line, triangles = b"", 1, 0
    for at in range(0, len(raw), BYTES_AT_ONCE):
        piece, end, more = (rest + raw[at : at + BYTES_AT_ONCE]).rpartition(_END)
        if not end:
            rest = more
            continue
        piece, rest = piece + end, more
        corners = np.array(_CORNER.findall(piece)).astype(np.float64).reshape(-1, 3)
        if len(corners) != 3 * piece.count(_END):
            raise Damaged("a triangle does not have three vertices", line=line - 1 + _wrong_facet(piece))
        line += piece.count(b"\n")
        triangles += len(corners) // 3
        yield (at + BYTES_AT_ONCE) / len(raw), corners
    if _CORNER.search(rest):
        raise Damaged("a triangle does not have three vertices", line=line - 1 + _wrong_facet(rest))
    if not triangles:
        raise Damaged("it has no triangles", line=1)


def _wrong_facet(raw: bytes) -> int:
    """The line of the first facet of a text STL that has not three vertices."""
    at = 0
    for facet in raw.split(_END):
        if len(_CORNER.findall(facet)) != 3:
            break
        at += len(facet) + len(_END)
    return raw.count(b"\n", 0, max(raw.find(b"facet", at), at)) + 1
