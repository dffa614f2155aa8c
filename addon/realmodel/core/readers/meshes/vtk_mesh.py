# SPDX-License-Identifier: GPL-3.0-or-later
"""Triangulated surfaces in VTK's XML formats, PolyData (.vtp) and UnstructuredGrid (.vtu), with arrays as
text, in base64 or appended, compressed by zlib or not ("VTK File Formats")."""

from __future__ import annotations

import base64
import re
import zlib
from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple
from xml.etree import ElementTree

import numpy as np

from ...base.errors import InputRefused
from ...base.text import Step, no_step, parse_xml, read_bytes
from ..objects.geo_object import ObjectName, point_object
from .triangle_mesh import surface_object

_TYPES = {
    f"{name}{bits}": f"{kind}{bits // 8}"
    for name, kind, sizes in (
        ("Int", "i", (8, 16, 32, 64)),
        ("UInt", "u", (8, 16, 32, 64)),
        ("Float", "f", (32, 64)),
    )
    for bits in sizes
}
_BEGINNING = re.compile(
    rb'\s*(?:<\?xml[^>]*>\s*)?(?:<!--.*?-->\s*)*<VTKFile\s[^>]*type="(PolyData|UnstructuredGrid)"', re.DOTALL
)
_VERTEX, _POLY_VERTEX = 1, 2
_TRIANGLE, _STRIP, _POLYGON, _PIXEL, _QUAD = 5, 6, 7, 8, 9
_QUADRATIC = {22: 3, 23: 4, 28: 4, 34: 3}  # by their corners, which come first
_APPENDED = re.compile(rb'<AppendedData\s+encoding="(raw|base64)"\s*>\s*_')
_MOST_COMPRESSED = 1100  # the largest compression ratio of zlib


def begins_as_vtk_xml(head: bytes, _size: int = 0) -> bool:
    """Whether a file that begins so is one."""
    return bool(_BEGINNING.match(head))


def read_vtk_xml(file: str | Path, step: Step = no_step) -> list[ObjectName]:
    """Reads the polygons; it is called as its file. Raises InputRefused."""
    file = Path(file)
    raw = read_bytes(file)
    appended = _Body(b"", False)
    if match := _APPENDED.search(raw):
        end = raw.rfind(b"</AppendedData>")
        appended = _Body(raw[match.end() : end if end > 0 else len(raw)], match[1] == b"base64")
        raw = raw[: match.start()] + b"</VTKFile>"
    root = parse_xml(file, raw, step)
    vertices: list[np.ndarray] = []
    faces: list[_Faces] = []
    first = 0  # vertex of a piece
    try:
        arrays = _Arrays(root, appended)
        for piece in root.iter("Piece"):
            if (points := piece.find("Points/DataArray")) is None:
                raise ValueError("a piece has no points")
            places = arrays.values(points).reshape(-1, 3)
            some = _faces(arrays, piece)
            if isinstance(some, np.ndarray):
                faces.append(some + float(first))
            else:
                faces.append([[corner + first for corner in face] for face in some])
            vertices.append(places)
            first += len(places)
    except (
        ValueError,
        KeyError,
        IndexError,
        TypeError,
        AttributeError,
        OverflowError,
        MemoryError,
        zlib.error,
    ) as error:
        raise InputRefused(f"not a VTK file that can be read: {error}", file=file) from error
    if not sum(map(len, faces)):
        if first and (root.get("type") == "PolyData" or _has_vertices_alone(arrays, root)):
            return [point_object(file.stem, np.concatenate(vertices))]
        advice = "save the surface, not the solid (Extract Surface)"
        raise InputRefused("it has no triangles or polygons", file=file, advice=advice)
    listed = faces[0] if len(faces) == 1 else [face for some in faces for face in some]
    return [surface_object(file, file.stem, np.concatenate(vertices), listed)]


def _has_vertices_alone(arrays: _Arrays, root: ElementTree.Element) -> bool:
    """Whether all cells of an unstructured grid are single points."""
    kinds = [arrays.named(cells, "types") for cells in root.iter("Cells")]
    return all(np.isin(some, (_VERTEX, _POLY_VERTEX)).all() for some in kinds)


_Faces = np.ndarray | list  # corners of faces, (F, K) or of any number


def _faces(arrays: _Arrays, piece: ElementTree.Element) -> _Faces:
    """The corners of the faces of a piece."""
    if (cells := piece.find("Cells")) is None:
        polygons, strips = _cells(arrays, piece.find("Polys")), _cells(arrays, piece.find("Strips"))
        return (
            [*polygons, *(face for row in strips for face in strip_faces(row))] if len(strips) else polygons
        )
    return faces_of_cells(arrays.named(cells, "types"), _cells(arrays, cells))


def faces_of_cells(kinds: np.ndarray, rows: _Faces) -> _Faces:
    """The corners of the faces among cells of these types. Raises ValueError."""
    if len(rows) != len(kinds):
        raise ValueError("there are not as many types as cells")
    if np.isin(kinds, (_TRIANGLE, _POLYGON, _QUAD)).all():
        return rows
    faces = []
    for kind, row in zip(kinds.tolist(), rows, strict=True):
        if kind in (_TRIANGLE, _POLYGON, _QUAD):
            faces.append(row)
        elif kind in _QUADRATIC:
            faces.append(row[: _QUADRATIC[kind]])
        elif kind == _PIXEL:
            faces.append([row[0], row[1], row[3], row[2]])
        elif kind == _STRIP:
            faces += strip_faces(row)
    return faces


def strip_faces(row: Sequence) -> list:
    """The triangles of a strip, each second one turned."""
    return [row[k : k + 3] if k % 2 == 0 else [row[k + 1], row[k], row[k + 2]] for k in range(len(row) - 2)]


def _cells(arrays: _Arrays, cells: ElementTree.Element | None) -> _Faces:
    """The corners of cells. Raises ValueError."""
    if cells is None or not len(cells):
        return []
    corners = arrays.named(cells, "connectivity")
    ends = np.append(0, arrays.named(cells, "offsets").astype(np.int64))
    sizes = np.diff(ends)
    if (sizes < 0).any() or ends[-1] > len(corners):
        raise ValueError("offsets go beyond the corners")
    if len(sizes) and (sizes == sizes[0]).all():
        return corners[: ends[-1]].reshape(len(sizes), int(sizes[0]))
    listed = corners.tolist()
    return [listed[begin:end] for begin, end in pairwise(ends.tolist())]


class _Body(NamedTuple):
    """The bytes that a part of a file stands for. coded: in base64."""

    content: bytes
    coded: bool

    def behind(self, size: int) -> _Body:
        """The rest of it."""
        return _Body(self.content[size:], self.coded)

    def part(self, begin: int, end: int) -> bytes:
        """Bytes begin..end. Raises ValueError where there are not so many."""
        data = self.content[begin:end]
        if self.coded:
            data = base64.b64decode(self.content[begin // 3 * 4 : -(-end // 3) * 4])
            data = data[begin % 3 :][: end - begin]
        if len(data) < end - begin:
            raise ValueError("an array is cut off")
        return data


class _Arrays:
    """The data arrays of a file."""

    def __init__(self, root: ElementTree.Element, appended: _Body):
        self._order = "<" if root.get("byte_order", "LittleEndian") == "LittleEndian" else ">"
        self._size = np.dtype(self._order + _TYPES[root.get("header_type", "UInt32")])
        compressor = root.get("compressor")
        if compressor not in (None, "vtkZLibDataCompressor"):
            raise ValueError(f"its compression, {compressor}, is not supported; save it with zlib or none")
        self._is_compressed = compressor is not None
        self._appended = appended

    def named(self, cells: ElementTree.Element, name: str) -> np.ndarray:
        for array in cells.iter("DataArray"):
            if array.get("Name") == name:
                return self.values(array)
        raise ValueError(f"it has no array '{name}'")

    def values(self, array: ElementTree.Element) -> np.ndarray:
        """The numbers of an array. Raises ValueError naming the array, and the byte where it is appended."""
        try:
            return self._values(array)
        except (ValueError, KeyError, IndexError, OverflowError, zlib.error) as error:
            where = f"array '{array.get('Name', '')}'"
            if array.get("format") == "appended":
                where += f" at byte {array.get('offset', '0'):.20} of the appended data"
            raise ValueError(f"{where}: {error}") from error

    def _values(self, array: ElementTree.Element) -> np.ndarray:
        kind = np.dtype(self._order + _TYPES[array.get("type", "")])
        form = array.get("format", "ascii")
        if form == "ascii":
            return np.array((array.text or "").split()).astype(kind.newbyteorder("="))
        if form == "appended":
            at = int(array.get("offset", "0"))
            if not 0 <= at <= len(self._appended.content):
                raise ValueError("an array begins beyond the end: the file is cut off")
            body = self._appended.behind(at)
        else:
            body = _Body("".join((array.text or "").split()).encode(), True)
        data = self._unpacked(body) if self._is_compressed else self._plain(body)
        return np.frombuffer(data[: len(data) // kind.itemsize * kind.itemsize], kind)

    def _plain(self, body: _Body) -> bytes:
        (length,) = np.frombuffer(body.part(0, self._size.itemsize), self._size).tolist()
        if length > len(body.content):
            raise ValueError("an array is cut off")
        return body.part(self._size.itemsize, self._size.itemsize + length)

    def _unpacked(self, body: _Body) -> bytes:
        (blocks,) = np.frombuffer(body.part(0, self._size.itemsize), self._size).tolist()
        if blocks > len(body.content):
            raise ValueError("an array is cut off")
        begin = (3 + blocks) * self._size.itemsize
        _, size, last, *lengths = np.frombuffer(body.part(0, begin), self._size).tolist()
        packed = body.behind(-(-begin // 3) * 4 if body.coded else begin)  # the head is coded by itself
        content, at, data = packed.part(0, sum(lengths)), 0, []
        for length in lengths:
            most = min(size or last, _MOST_COMPRESSED * length)
            block = content[at : at + length]
            data.append(zlib.decompressobj().decompress(block, most) if most else b"")
            at += length
        return b"".join(data)
