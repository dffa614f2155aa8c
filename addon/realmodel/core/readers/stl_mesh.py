# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes in the format STL, binary and as text."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from ..mapped_arrays import ROWS_AT_ONCE, MakeRows, Rows, in_pieces
from .damaged_mesh import UNREADABLE, Damaged, unreadable
from .text import BYTES_AT_ONCE, FileBytes, Step, no_step
from .triangle_mesh import MeshRows, TriangleMesh

_CORNER = re.compile(rb"vertex\s+(\S+)\s+(\S+)\s+(\S+)")
_HEAD, _FACET = 84, np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("more", "<u2")])
_END = b"endfacet"
_CORNERS_AT_ONCE = 3 << 16
_OF_PART = 1 << 8  # places that tell where slices end
_PLACED = np.dtype([("place", np.float64, 3), ("corner", np.int64)])
_NAMED = np.dtype([("corner", np.int64), ("vertex", np.int64)])


def begins_as_stl(head: bytes, size: int) -> bool:
    """Whether a file of so many bytes that begins so is an STL, as text or binary."""
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
    _share_vertices(corners.array(), mesh, rows)
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
    """As _of_binary."""
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


def _share_vertices(corners: np.ndarray, mesh: MeshRows, rows: MakeRows) -> None:
    """Adds corners (3 T, 3) to a mesh, each place once, in the order of its coordinates: slice by slice of x,
    and then triangle by triangle."""
    if not len(corners):
        return
    parts = -(-len(corners) // _CORNERS_AT_ONCE)
    some = np.sort(corners[:: -(-len(corners) // (parts * _OF_PART)), 0])
    ends = np.unique(some[[len(some) * part // parts for part in range(1, parts)]])
    slices = [rows(np.empty(0, _PLACED)) for _ in range(len(ends) + 1)]
    begin = 0
    for piece in in_pieces(corners):
        placed = np.empty(len(piece), _PLACED)
        placed["place"], placed["corner"] = piece, np.arange(begin, begin + len(piece))
        begin += len(piece)
        _distribute(placed, np.searchsorted(ends, piece[:, 0], "right"), slices)
    of_triangles = [rows(np.empty(0, _NAMED)) for _ in range(parts)]
    for each in slices:
        placed = each.taken()
        vertices, index = np.unique(placed["place"], axis=0, return_inverse=True)
        named = np.empty(len(placed), _NAMED)
        named["corner"], named["vertex"] = placed["corner"], index.ravel() + mesh.vertices
        mesh.add_vertices(vertices)
        _distribute(named, named["corner"] // _CORNERS_AT_ONCE, of_triangles)
    for part, each in enumerate(of_triangles):
        named = each.taken()
        index = np.empty(len(named), np.int64)
        index[named["corner"] - part * _CORNERS_AT_ONCE] = named["vertex"]
        mesh.add_faces(index.reshape(-1, 3))


def _distribute(table: np.ndarray, part: np.ndarray, parts: list[Rows]) -> None:
    """part: of each row."""
    if not len(part):
        return
    order = np.argsort(part, kind="stable")
    there, begins = np.unique(part[order], return_index=True)
    for number, which in zip(there.tolist(), np.split(order, begins[1:]), strict=True):
        parts[number].add(table[which])
