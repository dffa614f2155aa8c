# SPDX-License-Identifier: GPL-3.0-or-later
"""Stanford's PLY, binary and as text (Turk, "The PLY polygon file format"): faces, strips of triangles, and
points where there are none."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np

from ...base.errors import InputRefused
from ...base.mapped_arrays import ROWS_AT_ONCE, MakeRows, Rows
from ...base.text import FileBytes, Step, line_of_word, no_step, pieces_of, with_newlines
from ..objects.geo_object import ObjectName, point_object
from .triangle_mesh import UNREADABLE, DamagedError, MeshRows, TriangleMesh, unreadable

_ORDERS = {"ascii": "<", "binary_little_endian": "<", "binary_big_endian": ">"}
_TYPES = {
    "char": "i1",
    "uchar": "u1",
    "short": "i2",
    "ushort": "u2",
    "int": "i4",
    "uint": "u4",
    "int8": "i1",
    "uint8": "u1",
    "int16": "i2",
    "uint16": "u2",
    "int32": "i4",
    "uint32": "u4",
    "float": "f4",
    "float32": "f4",
    "double": "f8",
    "float64": "f8",
}
_CORNERS = ("vertex_indices", "vertex_index")
_END = b"end_header"
_FACES = re.compile(rb"\n\s*element\s+(?:face|tristrips)\s+[1-9]")
_HEAD_BYTES = 1 << 12


def begins_as_ply(head: bytes, _size: int = 0) -> bool:
    """Whether a file that begins so is one."""
    return bool(re.match(rb"ply\s", head))


def begins_as_ply_points(head: bytes, _size: int = 0) -> bool:
    """Whether a file that begins so is one without faces."""
    header, end, _ = head.replace(b"\r", b"\n").partition(_END)
    return begins_as_ply(head) and bool(end) and not _FACES.search(header)


def read_ply_points(file: str | Path, _step: Step = no_step) -> list[ObjectName]:
    """Reads the vertices of a PLY without faces, binary or text, with their other properties as columns.
    Raises InputRefused."""
    file = Path(file)
    raw = FileBytes(file)
    try:
        kind, begins, elements = _read_header(raw)
        body = _Numbers(raw, begins, Rows) if kind == "ascii" else _Bytes(raw, begins)
        at = 0
        for name, (count, properties) in elements.items():
            if name == "vertex":
                table, _ = _table(body, at, count, properties)
                break
            at = _behind(body, at, count, properties)
        else:
            raise ValueError("its header has no format, vertices or faces")
        places = np.column_stack([table[axis].astype(np.float64) for axis in "xyz"])
        columns = {
            name: np.array(table[name]) for name in table.dtype.names or () if name not in tuple("xyz")
        }
    except UNREADABLE as error:
        raise unreadable(file, "PLY", error) from error
    return [point_object(file.stem, places, columns=columns)]


def read_ply(file: str | Path, step: Step = no_step, rows: MakeRows = Rows) -> TriangleMesh:
    """Reads the vertices and faces of a PLY, binary or text. rows: where they are kept. Raises
    InputRefused."""
    file = Path(file)
    raw = FileBytes(file)
    mesh = MeshRows(file, rows)
    begins, kind = 0, ""
    try:
        kind, begins, elements = _read_header(raw)
        faces = next((name for name in ("face", "tristrips") if name in elements), "")
        if not faces or "vertex" not in elements:
            raise ValueError("its header has no format, vertices or faces")
        body = _Numbers(raw, begins, rows) if kind == "ascii" else _Bytes(raw, begins)
        at, names_read = 0, set()
        for name, (count, properties) in elements.items():
            if name in ("vertex", faces):
                read = _vertices if name == "vertex" else _faces if name == "face" else _strips
                at = read(body, at, count, properties, mesh, step)
                names_read.add(name)
            elif len(names_read) == 2:
                break
            else:
                at = _behind(body, at, count, properties)
    except _CutOffError as error:
        place = {"byte": begins + error.at}
        if kind == "ascii":
            place = {"line": line_of_word(raw, error.at // 8, begins)}
        damage = DamagedError("it is cut off, or a count is wrong", **place)
        raise unreadable(file, "PLY", damage) from error
    except InputRefused:
        raise
    except UNREADABLE as error:
        raise unreadable(file, "PLY", error) from error
    return mesh.mesh()


def _read_header(raw: FileBytes) -> tuple[str, int, dict[str, tuple]]:
    """As _header, with the byte where the rest begins. Raises ValueError."""
    head, begins = _head(raw)
    kind, elements = _header(head.decode("latin-1").splitlines())
    if not (kind and begins):
        raise ValueError("its header has no format, vertices or faces")
    return kind, begins, elements


def _row_of(properties: list[tuple]) -> np.dtype:
    """A row of an element, without its lists."""
    return np.dtype([(name, form) for name, length, form in properties if not length])


def _table(body: _Bytes, at: int, count: int, properties: list[tuple]) -> tuple[np.ndarray, int]:
    """The rows of an element, without its lists, and their end."""
    row, rows = _row_of(properties), []
    if not any(length for _, length, _ in properties):
        size = count * row.itemsize
        return np.frombuffer(body.some(at, size), row), at + size
    for _ in range(count):
        values, at = _face(body, at, properties)
        rows.append(tuple(values[name][0] for name in row.names or ()))
    return np.array(rows, row), at


def _behind(body: _Bytes, at: int, count: int, properties: list[tuple]) -> int:
    """Where the rows of an element end that begin at a byte."""
    if not any(length for _, length, _ in properties):
        return at + count * _row_of(properties).itemsize
    for _ in range(count):
        _, at = _face(body, at, properties)
    return at


def _head(raw: FileBytes) -> tuple[bytes, int]:
    """The header, and where the rest begins; 0 where it has no end."""
    size = _HEAD_BYTES
    while (at := raw[:size].find(_END)) < 0:
        if size >= len(raw):
            return raw[:size], 0
        size *= 2
    begin = at + len(_END)
    return raw[:at], begin + (2 if raw[begin : begin + 2] == b"\r\n" else 1)


class _Bytes:
    """The bytes after the header."""

    def __init__(self, raw: FileBytes, begin: int):
        self._raw, self._begin = raw, begin

    def __len__(self) -> int:
        return max(len(self._raw) - self._begin, 0)

    def some(self, begin: int, size: int) -> bytes:
        return self._raw[self._begin + begin : self._begin + begin + size]


class _Numbers(_Bytes):
    """The text after the header, as numbers of one kind."""

    def __init__(self, raw: FileBytes, begin: int, rows: MakeRows):
        super().__init__(raw, begin)
        numbers = rows(np.empty(0, "<f8"))
        for _, piece in pieces_of(with_newlines(raw), begin):
            numbers.add(np.array(piece.split()).astype("<f8"))
        self._numbers = numbers.array().view(np.uint8)

    def __len__(self) -> int:
        return len(self._numbers)

    def some(self, begin: int, size: int) -> bytes:
        return self._numbers[begin : begin + size].tobytes()


def _header(lines: list[str]) -> tuple[str, dict[str, tuple]]:
    """("ascii" or a kind of binary, {element: (count, [(property, type of its length or None, type)])})."""
    kind, order = "", ""
    elements: dict[str, tuple] = {}
    properties: list[tuple] = []
    for words in map(str.split, lines):
        if words[:1] == ["format"]:
            kind = words[1]
            order = _ORDERS[kind]
        elif words[:1] == ["element"]:
            properties = []
            elements[words[1]] = (int(words[2]), properties)
        elif words[:1] == ["property"]:
            *types, name = words[2 if words[1] == "list" else 1 :]
            types = ["<f8" if kind == "ascii" else order + _TYPES[word] for word in types]
            properties.append((name, types[0] if len(types) > 1 else None, types[-1]))
    return kind, elements


def _vertices(body: _Bytes, at: int, count: int, properties: list[tuple], mesh: MeshRows, step: Step) -> int:
    """Reads the vertices from a byte on; where they end."""
    if any(length for _, length, _ in properties):
        table, at = _table(body, at, count, properties)
        mesh.add_vertices(np.column_stack([table[axis] for axis in "xyz"]))
        return at
    row = _row_of(properties)
    if not 0 <= count * row.itemsize <= len(body) - at:
        raise _CutOffError(min(at, len(body)))
    for begin in range(0, count, ROWS_AT_ONCE):
        some = min(ROWS_AT_ONCE, count - begin)
        table = np.frombuffer(body.some(at + begin * row.itemsize, some * row.itemsize), row)
        mesh.add_vertices(np.column_stack([table[axis] for axis in "xyz"]))
        step((at + begin * row.itemsize) / len(body))
    return at + count * row.itemsize


def _faces(body: _Bytes, at: int, count: int, properties: list[tuple], mesh: MeshRows, step: Step) -> int:
    """Reads the faces from a byte on; where they end."""
    keys = [name for name, length, _ in properties if length and name in _CORNERS]
    if len(keys) != 1:
        raise ValueError("its faces have no list of vertices")
    while count:
        step(at / len(body))
        faces, at = _some_faces(body, at, min(count, ROWS_AT_ONCE), properties, keys[0])
        mesh.add_faces(faces)
        count -= len(faces)
    return at


def _strips(body: _Bytes, at: int, count: int, properties: list[tuple], mesh: MeshRows, step: Step) -> int:
    """Reads strips of triangles from a byte on, each next one turned; -1 begins another. Where they end."""
    keys = [name for name, length, _ in properties if length and name in _CORNERS]
    if len(keys) != 1:
        raise ValueError("its strips have no list of vertices")
    for _ in range(count):
        strip, at = _face(body, at, properties)
        corners = np.asarray(strip[keys[0]], np.float64)
        place = np.arange(len(corners))
        begins = np.maximum.accumulate(np.where(corners == -1, place, -1)) + 1
        odd = ((place - begins)[:-2] % 2 == 1)[:, None]
        faces = np.column_stack([corners[:-2], corners[1:-1], corners[2:]])
        faces = np.where(odd, faces[:, [1, 0, 2]], faces)
        is_face = (faces != -1).all(axis=1) & (faces != faces[:, [1, 2, 0]]).all(axis=1)
        mesh.add_faces(faces[is_face])
        step(at / len(body))
    return at


def _some_faces(body: _Bytes, at: int, count: int, properties: list[tuple], key: str) -> tuple[Any, int]:
    """The corners of this number of faces, and their end."""
    sizes = [len(values) for values in _face(body, at, properties)[0].values()]
    fields: list[tuple] = []
    for (name, length, form), size in zip(properties, sizes, strict=True):
        fields += [(f"{name} size", length)] if length else []
        fields.append((name, form, (size,)))
    row = np.dtype(fields)
    if at + count * row.itemsize <= len(body):  # mostly all faces have as many corners
        table = np.frombuffer(body.some(at, count * row.itemsize), row)
        lists = [(name, size) for (name, length, _), size in zip(properties, sizes, strict=True) if length]
        if all((table[f"{name} size"] == size).all() for name, size in lists):
            return table[key], at + table.nbytes
    faces = []
    for _ in range(count):
        face, at = _face(body, at, properties)
        faces.append(face[key])
    return faces, at


def _face(body: _Bytes, at: int, properties: list[tuple]) -> tuple[dict[str, np.ndarray], int]:
    """One row of an element, as a face: the values of each property, and its end."""
    properties_of: dict[str, np.ndarray] = {}
    for name, length, form in properties:
        size = 1
        if length:
            if at + np.dtype(length).itemsize > len(body):
                raise _CutOffError(at)
            size = int(np.frombuffer(body.some(at, np.dtype(length).itemsize), length)[0])
            at += np.dtype(length).itemsize
        if not 0 <= size * np.dtype(form).itemsize <= len(body) - at:
            raise _CutOffError(at)
        values = (
            np.frombuffer(body.some(at, size * np.dtype(form).itemsize), form) if size else np.empty(0, form)
        )
        at += values.nbytes
        properties_of[name] = values
    return properties_of, at


class _CutOffError(ValueError):
    """The file ends before the data that its header announces."""

    def __init__(self, at: int):
        super().__init__(f"byte {at}")
        self.at = at
