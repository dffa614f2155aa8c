# SPDX-License-Identifier: GPL-3.0-or-later
"""VTK's older format (.vtk), text or binary, of versions 1 to 5.1 ("VTK File Formats", simple legacy
formats): the faces of a POLYDATA, an UNSTRUCTURED_GRID or a STRUCTURED_GRID of one layer, or the points where
there are none. And its files of several blocks (.vtm), each of which is a separate file."""

from __future__ import annotations

import re
from itertools import pairwise
from pathlib import Path

import numpy as np

from ...base.errors import InputRefused
from ...base.text import Step, local_name, no_step, parse_xml, read_bytes
from ..objects.geo_object import ObjectName, point_object
from .triangle_mesh import UNREADABLE, surface_object, unreadable
from .vtk_mesh import begins_as_vtk_xml, faces_of_cells, read_vtk_xml, strip_faces

_HEAD = re.compile(rb"# *vtk +DataFile +Version +[\d.]+[^\n]*\n[^\n]*\n\s*(ASCII|BINARY)\s*\n", re.IGNORECASE)
_TYPES = {
    "char": "i1",
    "unsigned_char": "u1",
    "short": "i2",
    "unsigned_short": "u2",
    "int": "i4",
    "unsigned_int": "u4",
    "long": "i8",
    "unsigned_long": "u8",
    "float": "f4",
    "double": "f8",
    "vtkidtype": "i4",
    "vtktypeint64": "i8",
    "vtktypeint32": "i4",
}
_CELLS = ("VERTICES", "LINES", "POLYGONS", "TRIANGLE_STRIPS", "CELLS")
_KEYS = (
    *(*_CELLS, "DATASET", "DIMENSIONS", "POINTS", "CELL_TYPES", "POINT_DATA", "CELL_DATA", "FIELD"),
    *("OFFSETS", "CONNECTIVITY"),
)
_ONE = ("DATASET", "CELL_TYPES", "POINT_DATA", "CELL_DATA", "OFFSETS", "CONNECTIVITY")  # with one word
_READ = ("POLYDATA", "UNSTRUCTURED_GRID", "STRUCTURED_GRID")


def begins_as_vtk(head: bytes, _size: int = 0) -> bool:
    """Whether a file that begins so is one of the older format."""
    return bool(_HEAD.match(head))


def begins_as_vtm(head: bytes, _size: int = 0) -> bool:
    """Whether a file that begins so is one of several blocks."""
    return b"<VTKFile" in head and b'type="vtkMultiBlockDataSet"' in head


class _Words:
    """Content as text."""

    def __init__(self, raw: bytes):
        self._words, self._at = raw.split(), 0

    def key(self) -> list[str]:
        """The next keyword, and the words that belong to it; [] at the end."""
        while self._at < len(self._words):
            word = self._words[self._at].decode("latin-1").upper()
            self._at += 1
            if word in _KEYS:
                more = 3 if word == "DIMENSIONS" else 1 if word in _ONE else 2
                end = self._at + more
                words = [text.decode("latin-1") for text in self._words[self._at : end]]
                self._at = end
                return [word, *words]
        return []

    def values(self, count: int, _kind: str) -> np.ndarray:
        """The next numbers. Raises ValueError where there are fewer."""
        if not 0 <= count <= len(self._words) - self._at:
            raise ValueError(f"{count} numbers are announced, the file is cut off")
        words = self._words[self._at : self._at + count]
        self._at += count
        return np.array(words, "S").astype(np.float64)

    def has_offsets(self) -> bool:
        """Whether cells come as of version 5.1: where each begins, then their corners."""
        return self._words[self._at : self._at + 1] == [b"OFFSETS"]

    def name(self) -> list[str]:
        """The four words that begin an array of a FIELD."""
        self._at += 4
        return [text.decode("latin-1") for text in self._words[self._at - 4 : self._at]]


class _Bytes:
    """Binary content: lines of text, and numbers with the largest byte first."""

    def __init__(self, raw: bytes):
        self._raw, self._at = raw, 0

    def _line(self) -> list[str]:
        end = self._raw.find(b"\n", self._at)
        end = len(self._raw) if end < 0 else end
        line, self._at = self._raw[self._at : end], end + 1
        return line.decode("latin-1").split()

    def key(self) -> list[str]:
        """As of _Words."""
        while self._at < len(self._raw):
            words = self._line()
            if words and words[0].upper() in _KEYS:
                return [words[0].upper(), *words[1:]]
        return []

    def values(self, count: int, kind: str) -> np.ndarray:
        """As of _Words. kind: their type."""
        row = np.dtype(">" + _TYPES[kind.lower()])
        if not 0 <= count * row.itemsize <= len(self._raw) - self._at:
            raise ValueError(f"{count} numbers are announced, the file is cut off at byte {len(self._raw)}")
        values = np.frombuffer(self._raw, row, count, self._at)
        self._at += values.nbytes
        return values.astype(np.float64)

    def has_offsets(self) -> bool:
        """As of _Words."""
        return self._raw[self._at : self._at + 16].lstrip()[:7] == b"OFFSETS"

    def name(self) -> list[str]:
        """As of _Words."""
        words: list[str] = []
        while not words and self._at < len(self._raw):
            words = self._line()
        return words


def read_vtk(file: str | Path, step: Step = no_step) -> list[ObjectName]:
    """The faces of a file, or its points; it is called as the file. Raises InputRefused."""
    file = Path(file)
    raw = read_bytes(file)
    match = _HEAD.match(raw)
    try:
        if match is None:
            raise ValueError("it has no header")
        content = _Words(raw[match.end() :]) if match[1].upper() == b"ASCII" else _Bytes(raw[match.end() :])
        places, faces = _dataset(file, content)
    except InputRefused:
        raise
    except (*UNREADABLE, UnicodeDecodeError) as error:
        raise unreadable(file, "VTK", error) from error
    step(0.5)
    if not len(places):
        raise InputRefused("it has no points", file=file)
    return [surface_object(file, file.stem, places, faces) if len(faces) else point_object(file.stem, places)]


def _dataset(file: Path, content: _Words | _Bytes) -> tuple[np.ndarray, list | np.ndarray]:
    """The points (P, 3), and the corners of faces. Raises ValueError, KeyError and IndexError."""
    places, cells, dimensions = np.empty((0, 3)), {}, []
    kinds = np.empty(0)
    while words := content.key():
        key, *rest = words
        if key == "DATASET" and rest[0].upper() not in _READ:
            what = f"its data set is a {rest[0].upper()}, which is no surface"
            raise InputRefused(what, file=file, advice="save a surface (POLYDATA)")
        if key == "POINTS":
            places = content.values(3 * int(rest[0]), rest[1]).reshape(-1, 3)
        elif key == "DIMENSIONS":
            dimensions = [int(word) for word in rest[:3]]
        elif key in _CELLS:
            cells[key] = _rows(content, int(rest[0]), int(rest[1]))
        elif key == "CELL_TYPES":
            kinds = content.values(int(rest[0]), "int")
        elif key == "FIELD":
            for _ in range(int(rest[1])):
                _, components, rows, kind = content.name()
                content.values(int(components) * int(rows), kind)
        elif key in ("POINT_DATA", "CELL_DATA"):
            break
    if dimensions:
        return places, _grid(dimensions, len(places))
    if "CELLS" in cells:
        return places, faces_of_cells(kinds, cells["CELLS"])
    strips = [face for row in cells.get("TRIANGLE_STRIPS", []) for face in strip_faces(row)]
    polygons = cells.get("POLYGONS", [])
    return places, [*polygons, *strips] if strips else polygons


def _rows(content: _Words | _Bytes, count: int, size: int) -> list | np.ndarray:
    """The corners of cells. Raises ValueError where they are not as many as announced."""
    if not content.has_offsets():
        numbers = content.values(size, "int").astype(np.int64)
        if count and size == count * (numbers[0] + 1) and (numbers[:: numbers[0] + 1] == numbers[0]).all():
            return numbers.reshape(count, -1)[:, 1:]
        ends = [0]
        for _ in range(count):
            ends.append(ends[-1] + int(numbers[ends[-1]]) + 1)
        return [numbers[begin + 1 : end].tolist() for begin, end in pairwise(ends)]
    offsets = content.values(count, content.key()[1]).astype(np.int64)
    corners = content.values(size, content.key()[1]).astype(np.int64)
    if (np.diff(offsets) < 0).any() or (len(offsets) and offsets[-1] > len(corners)):
        raise ValueError("offsets go beyond the corners")
    listed, ends = corners.tolist(), offsets.tolist()
    return [listed[begin:end] for begin, end in pairwise(ends)]


def _grid(dimensions: list[int], count: int) -> np.ndarray:
    """(F, 4) the corners of the cells of a grid of one layer. Raises ValueError."""
    sizes = [size for size in dimensions if size > 1]
    if len(sizes) != 2 or int(np.prod(dimensions)) != count:
        raise ValueError("its grid is not one layer of points")
    number = np.arange(count).reshape(sizes[1], sizes[0])
    corners = number[:-1, :-1], number[:-1, 1:], number[1:, 1:], number[1:, :-1]
    return np.column_stack([corner.ravel() for corner in corners])


def read_vtm(file: str | Path, step: Step = no_step) -> list[ObjectName]:
    """The blocks of a file, which are files of VTK beside it, by their names. Raises InputRefused."""
    file = Path(file)
    objects = []
    for element in parse_xml(file, read_bytes(file), step).iter():
        if local_name(element) != "DataSet" or not (path := element.get("file")):
            continue
        block = file.parent / path
        if Path(path).is_absolute() or ".." in Path(path).parts:
            raise InputRefused(f"its block '{path:.80}' is not beside it", file=file)
        head = read_bytes(block)[:4096]
        read = read_vtk_xml if begins_as_vtk_xml(head) else read_vtk
        name = element.get("name") or block.stem
        objects += [ObjectName(name, obj.kind, obj.key) for obj in read(block)]
    if not objects:
        raise InputRefused("it has no blocks", file=file)
    return objects
