# SPDX-License-Identifier: GPL-3.0-or-later
"""Triangulated surfaces in Gmsh's MSH 2 and 4.1, text or binary (Gmsh Reference Manual, "MSH file format"):
the
triangles and quadrangles, whatever their groups."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from ..errors import InputRefused
from .text import Step, line_of_word, no_step, read_bytes
from .triangle_mesh import TriangleMesh, mesh_of_faces

# Nodes of each type of element; of those with more nodes than corners the corners come first.
_NODES = {1: 2, 2: 3, 3: 4, 4: 4, 5: 8, 6: 6, 7: 5, 8: 3, 9: 6, 10: 9, 11: 10, 15: 1, 16: 8}
_MOST_IN_A_ROW = 1000
_CORNERS = {2: 3, 9: 3, 3: 4, 10: 4, 16: 4}


def begins_as_msh(head: bytes) -> bool:
    """Whether a file that begins so is one."""
    return head.lstrip().startswith(b"$MeshFormat")


def read_msh(file: str | Path, step: Step = no_step) -> TriangleMesh:
    """Reads the faces of a mesh, and the nodes that they use. Raises InputRefused naming the file."""
    file = Path(file)
    raw = read_bytes(file)
    sections, begins = {}, {}
    for name in (b"MeshFormat", b"Nodes", b"Elements"):
        begin, end = raw.find(b"$" + name), raw.rfind(b"$End" + name)
        if begin < 0 or end < begin:
            what = f"it has no whole section {name.decode()}"
            raise InputRefused(f"{what} (byte {len(raw)})", file=file, advice="the file is cut off")
        first = raw.find(b"\n", begin) + 1
        begins[name], sections[name] = first, raw[first:end]
    words = sections[b"MeshFormat"].split(None, 3)
    version = words[0].decode("ascii", "replace") if words else ""
    if len(words) < 3 or not re.fullmatch(r"2(\.\d+)?|4\.1", version):
        raise InputRefused(
            f"MSH {version:.10} is not read", file=file, advice="save it as version 4.1 or 2.2"
        )
    is_binary = words[1] == b"1"
    order = "<"
    if is_binary and sections[b"MeshFormat"].split(b"\n", 1)[1][:4] == b"\0\0\0\1":
        order = ">"
    read, section = [], b"Nodes"
    try:
        if is_binary:
            read = [_Bytes(sections[name], order) for name in (b"Nodes", b"Elements")]
        else:
            read = [_Words(sections[name]) for name in (b"Nodes", b"Elements")]
        old = version.startswith("2")
        tags, places = (_nodes_2 if old else _nodes_4)(read[0])
        step(0.5)
        section = b"Elements"
        faces = (_elements_2 if old else _elements_4)(read[1])
    except (ValueError, IndexError, OverflowError, MemoryError, KeyError) as error:
        what, line = f"not a Gmsh file that can be read: {error}", None
        if read:
            at = read[section == b"Elements"].at
            if is_binary:
                what += f" (byte {begins[section] + at})"
            else:
                line = raw.count(b"\n", 0, begins[section]) + line_of_word(sections[section], at)
        raise InputRefused(what, file=file, line=line) from error
    order_of_tags = np.argsort(tags, kind="stable")
    faces = [face for face in faces if len(face)]
    if not faces:
        raise InputRefused(
            "it has no triangles or quadrangles", file=file, advice="mesh the surfaces, and save all"
        )
    if not len(tags):
        raise InputRefused("it has no nodes", file=file)
    number = []
    for corners in faces:
        at = np.minimum(np.searchsorted(tags[order_of_tags], corners), len(tags) - 1)
        at = order_of_tags[at]
        if (tags[at] != corners).any():
            raise InputRefused("an element has a node that is not there", file=file)
        number.append(at)
    used = np.unique(np.concatenate([at.ravel() for at in number]))
    numbers = [np.searchsorted(used, at) for at in number]
    listed = numbers[0] if len(numbers) == 1 else [row for at in numbers for row in at.tolist()]
    return mesh_of_faces(file, places[used], listed)


class _Words:
    """Numbers of a section of text, one after another."""

    def __init__(self, raw: bytes):
        self._values = np.array(raw.split()).astype(np.float64) if raw.split() else np.empty(0)
        self.at = 0

    def take(self, kinds: str, count: int = 1) -> np.ndarray:
        """(count, len(kinds)); kinds are those of _Bytes."""
        if not 0 <= count <= len(self._values):
            raise ValueError(f"{count} entries are announced, the file is cut off")
        end = self.at + count * len(kinds)
        found = self._values[self.at : end]
        if len(found) < count * len(kinds):
            raise ValueError("the file is cut off")
        self.at = end
        return found.reshape(count, len(kinds))


class _Bytes:
    """The numbers of a binary section. kinds: i int32, s size_t, d float64."""

    def __init__(self, raw: bytes, order: str):
        self._raw, self.at = raw, 0
        self._types = {"i": f"{order}i4", "s": f"{order}u8", "d": f"{order}f8"}

    def take(self, kinds: str, count: int = 1) -> np.ndarray:
        row = np.dtype([(str(k), self._types[kind]) for k, kind in enumerate(kinds)])
        if not 0 <= count <= len(self._raw) or self.at + count * row.itemsize > len(self._raw):
            raise ValueError(f"{count} entries are announced, the file is cut off")
        found = np.frombuffer(self._raw, row, count, self.at)
        self.at += count * row.itemsize
        return np.stack([found[name].astype(np.float64) for name in row.names], axis=1)

    def line(self) -> int:
        """A number on a line of text."""
        text, _, _ = self._raw[self.at : self.at + 40].partition(b"\n")
        self.at += len(text) + 1
        return int(text)


def _count(read) -> int:
    return read.line() if isinstance(read, _Bytes) else _whole(read.take("i")[0, 0])


def _whole(value: float) -> int:
    if not (0 <= value < 2**53 and value == int(value)):
        raise ValueError(f"a count of {value:g}")
    return int(value)


def _few(value: float) -> int:
    """A number of entries in each row."""
    if not 0 <= value <= _MOST_IN_A_ROW:
        raise ValueError(f"{value:g} entries in a row")
    return int(value)


def _nodes_2(read):
    rows = read.take("iddd", _count(read))
    return rows[:, 0], rows[:, 1:]


def _nodes_4(read):
    tags, places = [np.empty(0)], [np.empty((0, 3))]
    blocks, *_ = read.take("ssss")[0]
    for _ in range(_whole(blocks)):
        dimension, _, parametric, count = read.take("iiis")[0]
        more = _few(dimension) if parametric else 0
        tags.append(read.take("s", _whole(count))[:, 0])
        places.append(read.take("ddd" + "d" * more, _whole(count))[:, :3])
    return np.concatenate(tags), np.concatenate(places)


def _elements_2(read) -> list[np.ndarray]:
    count = _count(read)
    faces: dict[int, list] = {3: [], 4: []}
    done = 0
    while done < count:
        if isinstance(read, _Bytes):
            kind, rows, tags = (int(v) for v in read.take("iii")[0])
            tags = _few(tags)
            if rows < 1:
                raise ValueError("a block without elements")
            found = read.take("i" * (1 + tags + _NODES[kind]), rows)[:, 1 + tags :]
        else:
            _, kind, tags = (int(v) for v in read.take("iii")[0])
            tags = _few(tags)
            rows, found = 1, read.take("i" * (tags + _NODES[kind]))[:, tags:]
        done += rows
        if kind in _CORNERS:
            faces[_CORNERS[kind]].append(found[:, : _CORNERS[kind]])
    return [np.concatenate(rows) for rows in faces.values() if rows]


def _elements_4(read) -> list[np.ndarray]:
    faces: dict[int, list] = {3: [], 4: []}
    blocks, *_ = read.take("ssss")[0]
    for _ in range(_whole(blocks)):
        _, _, kind, count = read.take("iiis")[0]
        rows = read.take("s" * (1 + _NODES[int(kind)]), _whole(count))
        if kind in _CORNERS:
            faces[_CORNERS[int(kind)]].append(rows[:, 1 : 1 + _CORNERS[int(kind)]])
    return [np.concatenate(rows) for rows in faces.values() if rows]
