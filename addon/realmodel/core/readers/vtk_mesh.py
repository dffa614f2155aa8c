# SPDX-License-Identifier: GPL-3.0-or-later
"""Triangulated surfaces in VTK's XML formats, PolyData (.vtp) and UnstructuredGrid (.vtu), with arrays as
text,
in base64 or appended, compressed by zlib or not ("VTK File Formats")."""

from __future__ import annotations

import base64
import re
import zlib
from itertools import pairwise
from pathlib import Path
from xml.etree import ElementTree

import numpy as np

from ..errors import InputRefused
from .text import Step, no_step, read_bytes
from .triangle_mesh import TriangleMesh, mesh_of_faces
from .xml_text import parse_xml

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
_TRIANGLE, _STRIP, _POLYGON, _PIXEL, _QUAD = 5, 6, 7, 8, 9
_APPENDED = re.compile(rb'<AppendedData\s+encoding="(raw|base64)"\s*>\s*_')
_MOST_COMPRESSED = 1100  # the largest compression ratio of zlib


def begins_as_vtk_xml(head: bytes) -> bool:
    """Whether a file that begins so is one."""
    return bool(_BEGINNING.match(head))


def read_vtk_xml(file: str | Path, step: Step = no_step) -> TriangleMesh:
    """Reads the polygons, and the nodes that they use. Raises InputRefused."""
    file = Path(file)
    raw = read_bytes(file)
    appended, kind = b"", "raw"
    if found := _APPENDED.search(raw):
        end = raw.rfind(b"</AppendedData>")
        appended, kind = raw[found.end() : end if end > 0 else len(raw)], found[1].decode()
        raw = raw[: found.start()] + b"</VTKFile>"
    root = parse_xml(file, raw)
    try:
        arrays = _Arrays(root, appended, kind)
        vertices, faces, begin = [], [], 0
        for piece in root.iter("Piece"):
            places = arrays.values(piece.find("Points/DataArray")).reshape(-1, 3)
            faces += [[corner + begin for corner in face] for face in _faces(arrays, piece)]
            vertices.append(places)
            begin += len(places)
            step(0.5)
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
    if not faces:
        advice = "save the surface, not the solid (Extract Surface)"
        raise InputRefused("it has no triangles or polygons", file=file, advice=advice)
    mesh = mesh_of_faces(file, np.concatenate(vertices), faces)
    used, index = np.unique(mesh.triangles, return_inverse=True)
    triangles = index.reshape(-1, 3).astype(np.int32)
    return TriangleMesh(mesh.vertices[used], triangles, mesh.face_of_triangle)


def _faces(arrays: _Arrays, piece: ElementTree.Element) -> list[list[int]]:
    if (cells := piece.find("Cells")) is not None:
        kinds = arrays.named(cells, "types")
        rows = _rows(arrays, cells)
        if len(rows) != len(kinds):
            raise ValueError("there are not as many types as cells")
        faces = []
        for kind, row in zip(kinds.tolist(), rows, strict=True):
            if kind in (_TRIANGLE, _POLYGON, _QUAD):
                faces.append(row)
            elif kind == _PIXEL:
                faces.append([row[0], row[1], row[3], row[2]])
            elif kind == _STRIP:
                faces += _strip(row)
        return faces
    faces = _rows(arrays, piece.find("Polys"))
    for row in _rows(arrays, piece.find("Strips")):
        faces += _strip(row)
    return faces


def _strip(row: list[int]) -> list[list[int]]:
    return [row[k : k + 3] if k % 2 == 0 else [row[k + 1], row[k], row[k + 2]] for k in range(len(row) - 2)]


def _rows(arrays: _Arrays, cells: ElementTree.Element | None) -> list[list[int]]:
    if cells is None or not len(cells):
        return []
    corners, ends = arrays.named(cells, "connectivity"), arrays.named(cells, "offsets")
    ends = [0, *ends.astype(np.int64).tolist()]
    if any(end < begin for begin, end in pairwise(ends)) or ends[-1] > len(corners):
        raise ValueError("offsets go beyond the corners")
    corners = corners.tolist()
    return [corners[begin:end] for begin, end in pairwise(ends)]


class _Arrays:
    """The data arrays of a file."""

    def __init__(self, root: ElementTree.Element, appended: bytes, kind: str):
        self._order = "<" if root.get("byte_order", "LittleEndian") == "LittleEndian" else ">"
        self._size = self._order + _TYPES[root.get("header_type", "UInt32")]
        compressor = root.get("compressor")
        if compressor not in (None, "vtkZLibDataCompressor"):
            raise ValueError(f"its compression, {compressor}, is not supported; save it with zlib or none")
        self._is_compressed = compressor is not None
        self._appended, self._kind = appended, kind

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
            if not 0 <= at <= len(self._appended):
                raise ValueError("an array begins beyond the end: the file is cut off")
            body, coded = self._appended[at:], self._kind == "base64"
        else:
            body, coded = "".join((array.text or "").split()).encode(), True
        data = self._decoded(body, coded)
        return np.frombuffer(data[: len(data) // kind.itemsize * kind.itemsize], kind)

    def _decoded(self, body: bytes, coded: bool) -> bytes:
        size = np.dtype(self._size)

        def part(at: int, length: int) -> bytes:
            """Bytes at..at + length of what `body` stands for."""
            if not coded:
                found = body[at : at + length]
            else:
                found = base64.b64decode(body[at : at + -(-length // 3) * 4])[:length]
            if len(found) < length:
                raise ValueError("an array is cut off")
            return found

        if not self._is_compressed:
            (length,) = np.frombuffer(part(0, size.itemsize), size).tolist()
            if length > len(body):
                raise ValueError("an array is cut off")
            return part(0, size.itemsize + length)[size.itemsize :]
        (blocks,) = np.frombuffer(part(0, size.itemsize), size).tolist()
        if blocks > len(body):
            raise ValueError("an array is cut off")
        head = np.frombuffer(part(0, (3 + blocks) * size.itemsize), size).tolist()
        lengths = head[3:]
        begin = (3 + blocks) * size.itemsize
        if coded:  # the head is coded by itself
            body, begin = body[-(-begin // 3) * 4 :], 0
        packed = part(begin, sum(lengths))
        data, at = [], 0
        for length in lengths:
            most = min(head[1] or head[2], _MOST_COMPRESSED * length)
            data.append(zlib.decompressobj().decompress(packed[at : at + length], most) if most else b"")
            at += length
        return b"".join(data)
