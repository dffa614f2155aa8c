# SPDX-License-Identifier: GPL-3.0-or-later
"""Triangulated surfaces in Gmsh's MSH 2 and 4.1, text or binary (Gmsh Reference Manual, "MSH file format"):
the triangles and quadrangles, whatever their groups."""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path

import numpy as np

from ...base.errors import InputRefused
from ...base.text import Step, line_of_word, no_step, read_bytes
from ..objects.geo_object import ObjectName
from .triangle_mesh import surface_object

# Nodes of each type of element; of those with more nodes than corners the corners come first.
_NODES = {1: 2, 2: 3, 3: 4, 4: 4, 5: 8, 6: 6, 7: 5, 8: 3, 9: 6, 10: 9, 11: 10, 15: 1, 16: 8}
_MOST_IN_A_ROW = 1000
_CORNERS = {2: 3, 9: 3, 3: 4, 10: 4, 16: 4}


def begins_as_msh(head: bytes, _size: int = 0) -> bool:
    """Whether a file that begins so is one."""
    return head.lstrip().startswith(b"$MeshFormat")


def read_msh(file: str | Path, step: Step = no_step) -> list[ObjectName]:
    """Reads the faces of a mesh. Raises InputRefused naming the file."""
    file = Path(file)
    raw = read_bytes(file)
    sections = {}
    for name in (b"MeshFormat", b"Nodes", b"Elements"):
        begin, end = raw.find(b"$" + name), raw.rfind(b"$End" + name)
        if begin < 0 or end < begin:
            what = f"it has no whole section {name.decode()}"
            raise InputRefused(f"{what} (byte {len(raw)})", file=file, advice="the file is cut off")
        sections[name] = raw.find(b"\n", begin) + 1, end
    head = raw[slice(*sections[b"MeshFormat"])]
    words = head.split(None, 3)
    version = words[0].decode("ascii", "replace") if words else ""
    if len(words) < 3 or not re.fullmatch(r"2(\.\d+)?|4\.1", version):
        raise InputRefused(
            f"MSH {version:.10} is not read", file=file, advice="save it as version 4.1 or 2.2"
        )
    is_binary = words[1] == b"1"
    order = ">" if is_binary and head.split(b"\n", 1)[1][:4] == b"\0\0\0\1" else "<"
    read: list[_Numbers] = []
    section = b"Nodes"
    try:
        both = [raw[slice(*sections[name])] for name in (b"Nodes", b"Elements")]
        read = [_Bytes(content, order) if is_binary else _Words(content) for content in both]
        old = version.startswith("2")
        tags, places = (_nodes_2 if old else _nodes_4)(read[0])
        step(0.5)
        section = b"Elements"
        faces = (_elements_2 if old else _elements_4)(read[1])
    except InputRefused:
        raise
    except (ValueError, IndexError, OverflowError, MemoryError, KeyError) as error:
        what, line = f"not a Gmsh file that can be read: {error}", None
        if read:
            at = read[section == b"Elements"].at
            if is_binary:
                what += f" (byte {sections[section][0] + at})"
            else:
                line = line_of_word(raw, at, *sections[section])
        raise InputRefused(what, file=file, line=line) from error
    if not any(map(len, faces)):
        raise InputRefused(
            "it has no triangles or quadrangles", file=file, advice="mesh the surfaces, and save all"
        )
    if not len(tags):
        raise InputRefused("it has no nodes", file=file)
    numbers = [_numbers(file, tags, corners) for corners in faces if len(corners)]
    listed = numbers[0] if len(numbers) == 1 else [row for some in numbers for row in some.tolist()]
    return [surface_object(file, file.stem, places, listed)]


def _numbers(file: Path, tags: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """The numbers from 0 of nodes by their tags. tags: of all nodes. Raises InputRefused."""
    order = np.argsort(tags, kind="stable")
    at = order[np.minimum(np.searchsorted(tags[order], corners), len(tags) - 1)]
    if (tags[at] != corners).any():
        raise InputRefused("an element has a node that is not there", file=file)
    return at


class _Words:
    """The numbers of a section of text, one after another. kinds: those of _Bytes."""

    at = 0  # the word that comes next

    def __init__(self, raw: bytes):
        self._values = np.array(raw.split()).astype(np.float64)

    def take(self, kinds: str, count: int = 1) -> np.ndarray:
        """(count, len(kinds)) float64. Raises ValueError where there are not as many rows."""
        if not 0 <= count <= len(self._values):
            raise ValueError(f"{count} entries are announced, the file is cut off")
        begin, end = self.at, self.at + count * len(kinds)
        if end > len(self._values):
            raise ValueError("the file is cut off")
        self.at = end
        return self._values[begin:end].reshape(count, len(kinds))


class _Bytes:
    """The numbers of a binary section, one after another. kinds: in a row: i int32, s size_t, d float64."""

    at = 0  # the byte that comes next

    def __init__(self, raw: bytes, order: str):
        self._raw, self._order = raw, order

    def take(self, kinds: str, count: int = 1) -> np.ndarray:
        row = _row(self._order, kinds)
        if not 0 <= count <= len(self._raw) or self.at + count * row.itemsize > len(self._raw):
            raise ValueError(f"{count} entries are announced, the file is cut off")
        entries = np.frombuffer(self._raw, row, count, self.at)
        self.at += entries.nbytes
        return np.stack([entries[name].astype(np.float64) for name in row.names or ()], axis=1)

    def line(self) -> int:
        """A number on a line of text."""
        text, _, _ = self._raw[self.at : self.at + 40].partition(b"\n")
        self.at += len(text) + 1
        return int(text)


@cache
def _row(order: str, kinds: str) -> np.dtype:
    types = {"i": f"{order}i4", "s": f"{order}u8", "d": f"{order}f8"}
    return np.dtype([(str(k), types[kind]) for k, kind in enumerate(kinds)])


_Numbers = _Words | _Bytes


def _count(read: _Numbers) -> int:
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


def _nodes_2(read: _Numbers) -> tuple[np.ndarray, np.ndarray]:
    rows = read.take("iddd", _count(read))
    return rows[:, 0], rows[:, 1:]


def _nodes_4(read: _Numbers) -> tuple[np.ndarray, np.ndarray]:
    tags, places = [np.empty(0)], [np.empty((0, 3))]
    blocks, *_ = read.take("ssss")[0]
    for _ in range(_whole(blocks)):
        dimension, _, parametric, count = read.take("iiis")[0]
        more = _few(dimension) if parametric else 0
        tags.append(read.take("s", _whole(count))[:, 0])
        places.append(read.take("ddd" + "d" * more, _whole(count))[:, :3])
    return np.concatenate(tags), np.concatenate(places)


class _Faces:
    """The tags of the corners of triangles and of quadrangles."""

    def __init__(self) -> None:
        self._of_size = {size: [np.empty((0, size))] for size in (3, 4)}

    def add(self, kind: int, nodes: np.ndarray) -> None:
        """Adds elements of a type by their nodes; of others than faces, does nothing."""
        if kind in _CORNERS:
            self._of_size[_CORNERS[kind]].append(nodes[:, : _CORNERS[kind]])

    def arrays(self) -> list[np.ndarray]:
        return [np.concatenate(some) for some in self._of_size.values()]


def _elements_2(read: _Numbers) -> list[np.ndarray]:
    faces, count, done = _Faces(), _count(read), 0
    while done < count:
        if isinstance(read, _Bytes):
            kind, rows, tags = (int(v) for v in read.take("iii")[0])
            first = 1 + _few(tags)
            if rows < 1:
                raise ValueError("a block without elements")
        else:
            _, kind, tags = (int(v) for v in read.take("iii")[0])
            rows, first = 1, _few(tags)
        faces.add(kind, read.take("i" * (first + _NODES[kind]), rows)[:, first:])
        done += rows
    return faces.arrays()


def _elements_4(read: _Numbers) -> list[np.ndarray]:
    faces = _Faces()
    blocks, *_ = read.take("ssss")[0]
    for _ in range(_whole(blocks)):
        _, _, kind, count = read.take("iiis")[0]
        faces.add(int(kind), read.take("s" * (1 + _NODES[int(kind)]), _whole(count))[:, 1:])
    return faces.arrays()
