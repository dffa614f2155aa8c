# SPDX-License-Identifier: GPL-3.0-or-later
"""Triangulated surfaces in VTK's XML formats, PolyData (.vtp) and UnstructuredGrid (.vtu), with arrays as
text, in base64 or appended, compressed by zlib or not ("VTK File Formats")."""

from __future__ import annotations

import base64
import re
import zlib
from collections.abc import Iterator
from itertools import chain, pairwise
from pathlib import Path
from xml.etree import ElementTree

import numpy as np

from ...base.errors import InputRefused
from ...base.mapped_arrays import MakeRows, Rows, in_pieces
from ...base.text import BYTES_AT_ONCE, LINES_AT_ONCE, FileBytes, Step, content_of, no_step
from ...base.xml_text import no_document_type, parse_xml
from .shared_vertices import faces_of, share_vertices
from .triangle_mesh import MeshRows, TriangleMesh

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
_MOST_BLANKS = 1 << 12  # bytes
_WITH_ARRAYS = {"Points", "Cells", "Polys", "Strips"}  # elements
_MOST_COMPRESSED = 1100  # the largest compression ratio of zlib


def begins_as_vtk_xml(head: bytes) -> bool:
    """Whether a file that begins so is one."""
    return bool(_BEGINNING.match(head))


def read_vtk_xml(file: str | Path, step: Step = no_step, rows: MakeRows = Rows) -> TriangleMesh:
    """Reads the polygons, and the nodes that they use. rows: where they are kept. Raises InputRefused."""
    file = Path(file)
    raw = content_of(file)
    stop, begin, is_coded = _appended(raw)
    end = raw.rfind(b"</AppendedData>") if begin else 0
    appended = _Body(raw, begin, end if end > 0 else len(raw), is_coded)
    tree = _Tree(file, rows)
    pieces = (raw[at : min(at + BYTES_AT_ONCE, stop)] for at in range(0, stop, BYTES_AT_ONCE))
    root = parse_xml(file, chain(pieces, [b"</VTKFile>"] if begin else []), tree)
    places, corners, sizes = rows(np.empty((0, 3))), rows(np.empty(0)), rows(np.empty(0, np.int64))
    try:
        arrays = _Arrays(root, tree, appended, rows)
        first = 0
        for piece in root.iter("Piece"):
            found = arrays.values(piece.find("Points/DataArray")).reshape(-1, 3)
            for faces in _faces(arrays, piece):
                corners.add(np.array(list(chain.from_iterable(faces)), np.float64) + first)
                sizes.add(np.array([len(face) for face in faces]))
            for some in in_pieces(found):
                places.add(some)
            first += len(found)
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
    return _mesh(file, places.array(), corners.array(), sizes.array(), rows)


def _mesh(file: Path, places, corners, sizes, rows: MakeRows) -> TriangleMesh:
    """The mesh of faces with these corners, numbers of places; without the places that they do not use."""
    if not len(sizes):
        advice = "save the surface, not the solid (Extract Surface)"
        raise InputRefused("it has no triangles or polygons", file=file, advice=advice)
    whole, used = MeshRows(file, rows), MeshRows(file, rows)
    for some in in_pieces(places):
        whole.add_vertices(some)
    taken = 0
    for some in in_pieces(sizes):
        faces, count = faces_of(corners[taken : taken + int(some.sum())], some)
        whole.add_faces(faces)
        taken += count
    mesh = whole.mesh()
    share_vertices(mesh.triangles.ravel(), None, used, rows, mesh.vertices)
    found = used.mesh()
    return TriangleMesh(found.vertices, found.triangles, mesh.face_of_triangle)


def _appended(raw: FileBytes) -> tuple[int, int, bool]:
    """Where the appended data are: their element, their first byte, and whether they are coded; the end and 0
    where there are none."""
    at = -1
    while (at := raw.find(b"<AppendedData", at + 1)) >= 0:
        if found := _APPENDED.match(raw[at : at + _MOST_BLANKS]):
            return at, at + found.end(), found[1] == b"base64"
    return len(raw), 0, False


class _Tree(ElementTree.TreeBuilder):
    """Elements without their texts. texts: those of arrays of positions and cells."""

    def __init__(self, file: Path, rows: MakeRows):
        super().__init__()
        self._file, self._rows = file, rows
        self._open: list[str] = []
        self._array: ElementTree.Element | None = None  # whose text comes
        self._waiting: list[str] = []
        self._size = 0
        self._texts: dict[ElementTree.Element, Rows] = {}

    def doctype(self, *_) -> None:
        raise no_document_type(self._file)

    def start(self, tag: str, attributes: dict[str, str]) -> ElementTree.Element:
        self._flush()
        element = super().start(tag, attributes)
        self._array = element if tag == "DataArray" and not _WITH_ARRAYS.isdisjoint(self._open) else None
        self._open.append(tag)
        return element

    def end(self, tag: str) -> ElementTree.Element:
        self._flush()
        self._array = None
        self._open.pop()
        return super().end(tag)

    def data(self, text: str) -> None:
        if self._array is not None:
            self._waiting.append(text)
            self._size += len(text)
            if self._size >= BYTES_AT_ONCE:
                self._flush()

    def _flush(self) -> None:
        if self._waiting and self._array is not None:
            text = "".join(self._waiting)
            if self._array.get("format", "ascii") != "ascii":
                text = "".join(text.split())
            if self._array not in self._texts:
                self._texts[self._array] = self._rows(np.empty(0, np.uint8))
            self._texts[self._array].add(np.frombuffer(text.encode(), np.uint8))
        self._waiting, self._size = [], 0

    def text(self, array: ElementTree.Element) -> np.ndarray:
        """The bytes (N,) of the text of an array; in base64 without blanks."""
        return self._texts[array].array() if array in self._texts else np.empty(0, np.uint8)


def _faces(arrays: _Arrays, piece: ElementTree.Element) -> Iterator[list[list[int]]]:
    """The corners of faces, some faces at a time."""
    if (cells := piece.find("Cells")) is not None:
        kinds = arrays.named(cells, "types")
        found = _Cells(arrays, cells)
        if len(found) != len(kinds):
            raise ValueError("there are not as many types as cells")
        for begin, rows in found.pieces():
            faces = []
            for kind, row in zip(kinds[begin : begin + len(rows)].tolist(), rows, strict=True):
                if kind in (_TRIANGLE, _POLYGON, _QUAD):
                    faces.append(row)
                elif kind == _PIXEL:
                    faces.append([row[0], row[1], row[3], row[2]])
                elif kind == _STRIP:
                    faces += _strip(row)
            yield faces
        return
    for _, rows in _Cells(arrays, piece.find("Polys")).pieces():
        yield rows
    for _, rows in _Cells(arrays, piece.find("Strips")).pieces():
        yield [face for row in rows for face in _strip(row)]


def _strip(row: list[int]) -> list[list[int]]:
    return [row[k : k + 3] if k % 2 == 0 else [row[k + 1], row[k], row[k + 2]] for k in range(len(row) - 2)]


class _Cells:
    """The corners of cells. Raises ValueError."""

    def __init__(self, arrays: _Arrays, cells: ElementTree.Element | None):
        self._corners = self._ends = np.empty(0, np.int64)
        if cells is not None and len(cells):
            self._corners, self._ends = arrays.named(cells, "connectivity"), arrays.named(cells, "offsets")
        last = 0
        for piece in in_pieces(self._ends):
            ends = np.append(last, piece.astype(np.int64))
            if (ends[1:] < ends[:-1]).any() or ends[-1] > len(self._corners):
                raise ValueError("offsets go beyond the corners")
            last = ends[-1]

    def __len__(self) -> int:
        return len(self._ends)

    def pieces(self) -> Iterator[tuple[int, list[list[int]]]]:
        """The number of the first cell, from 0, and the corners of some."""
        last = 0
        for begin in range(0, len(self), LINES_AT_ONCE):
            ends = np.append(last, self._ends[begin : begin + LINES_AT_ONCE].astype(np.int64))
            corners, places = self._corners[last : ends[-1]].tolist(), (ends - last).tolist()
            yield begin, [corners[first:end] for first, end in pairwise(places)]
            last = int(ends[-1])


class _Body:
    """The bytes that a part of a file, or of a text, stands for. coded: in base64."""

    def __init__(self, source: FileBytes | np.ndarray, begin: int, end: int, coded: bool):
        self._source, self._begin, self._end, self.coded = source, begin, end, coded

    def __len__(self) -> int:
        return max(self._end - self._begin, 0)

    def behind(self, size: int) -> _Body:
        """The rest of it."""
        return _Body(self._source, self._begin + size, self._end, self.coded)

    def _given(self, begin: int, end: int) -> bytes:
        return bytes(self._source[self._begin + begin : min(self._begin + end, self._end)])

    def part(self, begin: int, end: int) -> bytes:
        """Bytes begin..end. Raises ValueError where there are not so many."""
        if self.coded:
            found = base64.b64decode(self._given(begin // 3 * 4, -(-end // 3) * 4))
            found = found[begin % 3 :][: end - begin]
        else:
            found = self._given(begin, end)
        if len(found) < end - begin:
            raise ValueError("an array is cut off")
        return found


class _Arrays:
    """The data arrays of a file."""

    def __init__(self, root: ElementTree.Element, tree: _Tree, appended: _Body, rows: MakeRows):
        self._order = "<" if root.get("byte_order", "LittleEndian") == "LittleEndian" else ">"
        self._size = np.dtype(self._order + _TYPES[root.get("header_type", "UInt32")])
        compressor = root.get("compressor")
        if compressor not in (None, "vtkZLibDataCompressor"):
            raise ValueError(f"its compression, {compressor}, is not supported; save it with zlib or none")
        self._is_compressed = compressor is not None
        self._tree, self._appended, self._rows = tree, appended, rows

    def named(self, cells: ElementTree.Element, name: str) -> np.ndarray:
        for array in cells.iter("DataArray"):
            if array.get("Name") == name:
                return self.values(array)
        raise ValueError(f"it has no array '{name}'")

    def values(self, array: ElementTree.Element) -> np.ndarray:
        """The numbers of an array. Raises ValueError naming the array, and the byte where it is appended."""
        try:
            kind = np.dtype(self._order + _TYPES[array.get("type", "")])
            found = self._rows(np.empty(0, kind))
            for piece in self._pieces(array, kind):
                found.add(piece)
            return found.array()
        except (ValueError, KeyError, IndexError, OverflowError, zlib.error) as error:
            where = f"array '{array.get('Name', '')}'"
            if array.get("format") == "appended":
                where += f" at byte {array.get('offset', '0'):.20} of the appended data"
            raise ValueError(f"{where}: {error}") from error

    def _pieces(self, array: ElementTree.Element, kind: np.dtype) -> Iterator[np.ndarray]:
        form = array.get("format", "ascii")
        if form == "ascii":
            for words in _words(self._tree.text(array)):
                yield np.array(words).astype(kind.newbyteorder("="))
            return
        if form == "appended":
            at = int(array.get("offset", "0"))
            if not 0 <= at <= len(self._appended):
                raise ValueError("an array begins beyond the end: the file is cut off")
            body = self._appended.behind(at)
        else:
            text = self._tree.text(array)
            body = _Body(text, 0, len(text), True)
        rest = b""
        for piece in self._packed(body) if self._is_compressed else self._plain(body):
            data = rest + piece
            whole = len(data) // kind.itemsize * kind.itemsize
            yield np.frombuffer(data[:whole], kind)
            rest = data[whole:]

    def _plain(self, body: _Body) -> Iterator[bytes]:
        (length,) = np.frombuffer(body.part(0, self._size.itemsize), self._size).tolist()
        if length > len(body):
            raise ValueError("an array is cut off")
        end = self._size.itemsize + length
        body.part(end - 1, end)  # is there
        for at in range(self._size.itemsize, end, BYTES_AT_ONCE):
            yield body.part(at, min(at + BYTES_AT_ONCE, end))

    def _packed(self, body: _Body) -> Iterator[bytes]:
        (blocks,) = np.frombuffer(body.part(0, self._size.itemsize), self._size).tolist()
        if blocks > len(body):
            raise ValueError("an array is cut off")
        begin = (3 + blocks) * self._size.itemsize
        _, size, last, *lengths = np.frombuffer(body.part(0, begin), self._size).tolist()
        body = body.behind(-(-begin // 3) * 4 if body.coded else begin)  # the head is coded by itself
        end = sum(lengths)
        body.part(max(end - 1, 0), end)  # is there
        at = 0
        for length in lengths:
            most = min(size or last, _MOST_COMPRESSED * length)
            packed = body.part(at, at + length)
            yield zlib.decompressobj().decompress(packed, most) if most else b""
            at += length


def _words(text: np.ndarray) -> Iterator[list[str]]:
    """The words of a text, given as bytes (N,), some at a time."""
    rest = b""
    for at in range(0, len(text), BYTES_AT_ONCE):
        piece = rest + text[at : at + BYTES_AT_ONCE].tobytes()
        end = len(piece)
        if at + BYTES_AT_ONCE < len(text):
            end = max(map(piece.rfind, (b" ", b"\n", b"\t"))) + 1
        yield piece[:end].decode().split()
        rest = piece[end:]
