# SPDX-License-Identifier: GPL-3.0-or-later
"""Triangulated surfaces as other programs write them: Wavefront OBJ, STL, PLY and GOCAD TSurf.

Coordinates are read as they stand: Z is up. What is not part of the shape (normals, colors, groups,
properties) is left out.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from ..errors import InputRefused
from ..units import METERS
from .text import LINES_AT_ONCE, Step, line_of_word, no_step, read_text
from .triangle_mesh import TriangleMesh, mesh_of_faces

_UNREADABLE = (ValueError, IndexError, KeyError, OverflowError, TypeError)
_STL_CORNER = re.compile(rb"vertex\s+(\S+)\s+(\S+)\s+(\S+)")
_STL_HEAD, _STL_FACET = 84, np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("more", "<u2")])
_PLY_ORDERS = {"ascii": "<", "binary_little_endian": "<", "binary_big_endian": ">"}
_PLY_TYPES = {
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
_PLY_CORNERS = ("vertex_indices", "vertex_index")


def begins_as_obj(head: bytes, _size: int = 0) -> bool:
    """Whether a file that begins so is an OBJ: comments apart, its first line is one of that format."""
    lines = (line.partition(b"#")[0].split() for line in head.removeprefix(b"\xef\xbb\xbf").splitlines())
    words = next((words for words in lines if words), [b""])
    if words[0] in (b"v", b"vt", b"vn"):
        return len(words) >= 3 and all(re.fullmatch(rb"[-+.\deE]+", word) for word in words[1:])
    return words[0] in (b"mtllib", b"usemtl", b"o", b"g") and len(words) > 1 and b"\nv " in head


def begins_as_stl(head: bytes, size: int) -> bool:
    """Whether a file of so many bytes that begins so is an STL, as text or binary."""
    if head.lstrip().startswith(b"solid") and b"facet" in head:
        return True
    count = int.from_bytes(head[_STL_HEAD - 4 : _STL_HEAD], "little")
    return len(head) >= _STL_HEAD and size == _STL_HEAD + count * _STL_FACET.itemsize


def read_obj(file: str | Path, step: Step = no_step) -> TriangleMesh:
    """Reads all faces of a Wavefront OBJ. Raises InputRefused naming file and line."""
    file = Path(file)
    vertices, faces, lines = [], [], []
    for number, words in _rows(file, step):
        try:
            if words[0] == "v":
                vertices.append([float(word) for word in words[1:4]])
                if len(words) < 4:
                    raise ValueError
            elif words[0] == "f":
                corners = [int(word.partition("/")[0]) for word in words[1:]]
                # from 1; below zero from the last vertex so far
                faces.append([c - 1 if c > 0 else len(vertices) + c if c else -1 for c in corners])
                lines.append(number)
        except _UNREADABLE as error:
            raise _unreadable_line(file, number, words) from error
    return mesh_of_faces(file, vertices, faces, lines)


def read_tsurf(file: str | Path, step: Step = no_step) -> TriangleMesh:
    """Reads all surfaces of a GOCAD TSurf file as one. Depths that are positive downward become heights;
    a word says that values at vertices are not read. Raises InputRefused naming file and line."""
    file = Path(file)
    vertices, faces, lines = [], [], []
    index: dict[int, int] = {}  # of a vertex by its number in the present surface
    up = 1.0
    properties: dict[str, None] = {}
    axis_units: set[str] = set()
    for number, words in _rows(file, step):
        try:
            if words[0] == "GOCAD":
                index, up = {}, 1.0
                if words[1] != "TSurf":
                    what = f"it holds a GOCAD {words[1]:.20}, which is no triangulated surface"
                    raise InputRefused(what, file=file, line=number, advice="export the TSurf alone")
            elif words[0] == "ZPOSITIVE":
                up = -1.0 if words[1].lower() == "depth" else 1.0
            elif words[0] == "PROPERTIES":
                properties |= dict.fromkeys(words[1:])
            elif words[0] == "AXIS_UNIT":
                named = re.findall(r'"([^"]*)"', " ".join(words[1:])) or words[1:4]
                axis_units |= {word.strip().lower() for word in named}
            elif words[0] in ("VRTX", "PVRTX"):
                x, y, z = map(float, words[2:5])
                index[int(words[1])] = len(vertices)
                vertices.append([x, y, up * z])
            elif words[0] in ("ATOM", "PATOM"):
                index[int(words[1])] = index[int(words[2])]
            elif words[0] == "TRGL":
                faces.append([index[int(word)] for word in words[1:4]])
                lines.append(number)
        except _UNREADABLE as error:
            raise _unreadable_line(file, number, words) from error
    mesh = mesh_of_faces(file, vertices, faces, lines)
    (unit,) = axis_units if len(axis_units) == 1 else (None,)
    told = [f"its properties {', '.join(properties)} are not read"] if properties else []
    if len(axis_units) > 1:
        told.append(f"its axes have different units ({', '.join(sorted(axis_units))}): say which in 'units'")
    return replace(mesh, unit=unit if unit in METERS else None, warnings=tuple(told))


def read_stl(file: str | Path, step: Step = no_step) -> TriangleMesh:
    """Reads an STL, binary or text; corners at the same position become one vertex. Raises InputRefused."""
    file = Path(file)
    raw = _bytes(file)
    count = int.from_bytes(raw[_STL_HEAD - 4 : _STL_HEAD], "little")
    size = _STL_HEAD + count * _STL_FACET.itemsize
    try:
        if len(raw) == size or not raw.lstrip().startswith(b"solid"):
            if len(raw) < max(size, _STL_HEAD):
                raise ValueError(f"{count} triangles are announced, the file is cut off at byte {len(raw)}")
            corners = np.frombuffer(raw, _STL_FACET, count, _STL_HEAD)["corners"].reshape(-1, 3)
        else:
            corners = np.array(_STL_CORNER.findall(raw)).astype(np.float64).reshape(-1, 3)
            if len(corners) != 3 * raw.count(b"endfacet"):
                raise _Damaged("a triangle does not have three vertices", line=_wrong_facet(raw))
            if not len(corners):
                raise _Damaged("it has no triangles", line=1)
    except _UNREADABLE as error:
        raise _unreadable(file, "STL", error) from error
    step(0.5)
    vertices, index = np.unique(corners, axis=0, return_inverse=True)
    return mesh_of_faces(file, vertices, index.reshape(-1, 3))


def read_ply(file: str | Path, step: Step = no_step) -> TriangleMesh:
    """Reads the vertices and faces of a PLY, binary or text. Raises InputRefused."""
    file = Path(file)
    raw = _bytes(file)
    try:
        head, end, body = raw.partition(b"end_header")
        kind, elements = _ply_header(head.decode("latin-1").splitlines())
        if not (kind and end) or not {"vertex", "face"} <= elements.keys():
            raise ValueError("its header has no format, vertices or faces")
        body = body[2:] if body.startswith(b"\r\n") else body[1:]
        begins, text = len(raw) - len(body), body
        if kind == "ascii":  # the same with numbers of one kind
            body = np.array(body.split()).astype("<f8").tobytes()
        found, at = {}, 0
        for name, (count, properties) in elements.items():
            if name in ("vertex", "face"):
                found[name], at = _ply_rows(body, at, count, properties, name == "face")
            elif len(found) == 2:
                break
            else:
                at += count * np.dtype([(key, form) for key, _, form in properties]).itemsize
            step(0.5)
        vertices = np.column_stack([found["vertex"][axis] for axis in "xyz"])
    except _Cut as error:
        place = {"byte": begins + error.at}
        if kind == "ascii":
            place = {"line": raw.count(b"\n", 0, begins) + line_of_word(text, error.at // 8)}
        damage = _Damaged("it is cut off, or a count is wrong", **place)
        raise _unreadable(file, "PLY", damage) from error
    except _UNREADABLE as error:
        raise _unreadable(file, "PLY", error) from error
    return mesh_of_faces(file, vertices, found["face"])


def _ply_header(lines: list[str]):
    """("ascii" or a kind of binary, {element: (count, [(property, type of its length or None, type)])})."""
    kind, order, elements, properties = "", "", {}, []
    for words in map(str.split, lines):
        if words[:1] == ["format"]:
            kind = words[1]
            order = _PLY_ORDERS[kind]
        elif words[:1] == ["element"]:
            properties = []
            elements[words[1]] = (int(words[2]), properties)
        elif words[:1] == ["property"]:
            *types, name = words[2 if words[1] == "list" else 1 :]
            types = ["<f8" if kind == "ascii" else order + _PLY_TYPES[word] for word in types]
            properties.append((name, types[0] if len(types) > 1 else None, types[-1]))
    return kind, elements


def _ply_rows(body: bytes, at: int, count: int, properties, is_face: bool):
    """The rows of an element from byte `at`, and where it ends: of vertices a structured array, of faces the
    corners of each."""
    if not is_face:
        row = np.dtype([(name, form) for name, _, form in properties])
        if not 0 <= count * row.itemsize <= len(body) - at:
            raise _Cut(min(at, len(body)))
        table = np.frombuffer(body, row, count, at)
        return table, at + table.nbytes
    keys = [name for name, length, _ in properties if length and name in _PLY_CORNERS]
    if len(keys) != 1:
        raise ValueError("its faces have no list of vertices")
    key = keys[0]
    if not count:
        return [], at
    _, sizes, _ = _ply_face(body, at, properties, key)
    fields = []
    for (name, length, form), size in zip(properties, sizes, strict=True):
        fields += [(f"{name} size", length)] if length else []
        fields.append((name, form, (size,)))
    row = np.dtype(fields)
    if at + count * row.itemsize <= len(body):  # mostly all faces have as many corners
        table = np.frombuffer(body, row, count, at)
        lists = [(name, size) for (name, length, _), size in zip(properties, sizes, strict=True) if length]
        if all((table[f"{name} size"] == size).all() for name, size in lists):
            return table[key], at + table.nbytes
    faces = []
    for _ in range(count):
        corners, _, at = _ply_face(body, at, properties, key)
        faces.append(corners)
    return faces, at


def _ply_face(body: bytes, at: int, properties, key: str):
    """One face: its corners, the length of each property, and where it ends."""
    corners, sizes = None, []
    for name, length, form in properties:
        size = 1
        if length:
            if at + np.dtype(length).itemsize > len(body):
                raise _Cut(at)
            size = int(np.frombuffer(body, length, 1, at)[0])
            at += np.dtype(length).itemsize
        if not 0 <= size * np.dtype(form).itemsize <= len(body) - at:
            raise _Cut(at)
        values = np.frombuffer(body, form, size, at) if size else np.empty(0, form)
        at += values.nbytes
        sizes.append(size)
        corners = values if name == key else corners
    return corners, sizes, at


class _Cut(ValueError):
    """What is announced at a byte of the body is not there."""

    def __init__(self, at: int):
        super().__init__(f"byte {at}")
        self.at = at


class _Damaged(ValueError):
    """What is wrong, and the line or the byte where."""

    def __init__(self, what: str, line: int | None = None, byte: int | None = None):
        super().__init__(what if byte is None else f"{what} (byte {byte})")
        self.line = line


def _wrong_facet(raw: bytes) -> int:
    """The line of the first facet of a text STL that has not three vertices."""
    at = 0
    for facet in raw.split(b"endfacet"):
        if len(_STL_CORNER.findall(facet)) != 3:
            break
        at += len(facet) + len(b"endfacet")
    return raw.count(b"\n", 0, max(raw.find(b"facet", at), at)) + 1


def _rows(file: Path, step: Step) -> Iterator[tuple[int, list[str]]]:
    """The number from 1 and the words of each line that has some, without comments."""
    lines = read_text(file).split("\n")
    for number, line in enumerate(lines, 1):
        if number % LINES_AT_ONCE == 0:
            step(number / len(lines))
        words = line.partition("#")[0].split()
        if words:
            yield number, words


def _bytes(file: Path) -> bytes:
    try:
        return file.read_bytes()
    except OSError as error:
        raise InputRefused(f"cannot be read: {error.strerror}", file=file, advice="check the path") from error


def _unreadable_line(file: Path, number: int, words: list[str]) -> InputRefused:
    return InputRefused(f"'{' '.join(words):.40}' cannot be read", file=file, line=number)


def _unreadable(file: Path, kind: str, error: Exception) -> InputRefused:
    reason = " ".join(str(error).split()) or type(error).__name__
    line = getattr(error, "line", None)
    return InputRefused(f"not a {kind} file that can be read: {reason:.200}", file=file, line=line)
