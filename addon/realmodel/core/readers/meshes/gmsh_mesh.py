# SPDX-License-Identifier: GPL-3.0-or-later
"""Triangulated surfaces in Gmsh's MSH 2 and 4.1, text or binary (Gmsh Reference Manual, "MSH file format"):
the triangles and quadrangles, whatever their groups."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from functools import cache
from pathlib import Path

import numpy as np

from ...base.errors import InputRefused
from ...base.mapped_arrays import ROWS_AT_ONCE, MakeRows, Rows, in_pieces
from ...base.text import LINES_AT_ONCE, FileBytes, Step, content_of, line_of_word, no_step, pieces_of
from .shared_vertices import share_vertices
from .triangle_mesh import MeshRows, TriangleMesh

# Nodes of each type of element; of those with more nodes than corners the corners come first.
_NODES = {1: 2, 2: 3, 3: 4, 4: 4, 5: 8, 6: 6, 7: 5, 8: 3, 9: 6, 10: 9, 11: 10, 15: 1, 16: 8}
_MOST_IN_A_ROW = 1000
_CORNERS = {2: 3, 9: 3, 3: 4, 10: 4, 16: 4}


def begins_as_msh(head: bytes) -> bool:
    """Whether a file that begins so is one."""
    return head.lstrip().startswith(b"$MeshFormat")


def read_msh(file: str | Path, step: Step = no_step, rows: MakeRows = Rows) -> TriangleMesh:
    """Reads the faces of a mesh, and the nodes that they use. rows: where they are kept. Raises InputRefused
    naming the file."""
    file = Path(file)
    raw = content_of(file)
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
    tags, places, faces = rows(np.empty(0)), rows(np.empty((0, 3))), {n: _Corners(n, rows) for n in (3, 4)}
    read, section = [], b"Nodes"
    try:
        both = [sections[name] for name in (b"Nodes", b"Elements")]
        read = [_Bytes(raw, *each, order) if is_binary else _Words(raw, *each, rows) for each in both]
        old = version.startswith("2")
        (_nodes_2 if old else _nodes_4)(read[0], tags, places)
        step(0.5)
        section = b"Elements"
        (_elements_2 if old else _elements_4)(read[1], faces)
    except (ValueError, IndexError, OverflowError, MemoryError, KeyError) as error:
        what, line = f"not a Gmsh file that can be read: {error}", None
        if read:
            at = read[section == b"Elements"].at
            if is_binary:
                what += f" (byte {sections[section][0] + at})"
            else:
                line = line_of_word(raw, at, *sections[section])
        raise InputRefused(what, file=file, line=line) from error
    corners = [some.array() for some in faces.values()]
    if not any(map(len, corners)):
        raise InputRefused(
            "it has no triangles or quadrangles", file=file, advice="mesh the surfaces, and save all"
        )
    named = tags.array()
    if not len(named):
        raise InputRefused("it has no nodes", file=file)
    pieces = [piece for some in corners for piece in in_pieces(some)]
    index, sizes, mesh = rows(np.empty(0, np.int64)), rows(np.empty(0, np.int64)), MeshRows(file, rows)
    for numbers in _numbers(file, np.asarray(named), pieces):
        index.add(numbers.ravel())
        sizes.add(np.full(*numbers.shape))
    share_vertices(index.array(), sizes.array(), mesh, rows, places.array())
    return mesh.mesh()


def _numbers(file: Path, tags: np.ndarray, pieces: Iterable[np.ndarray]) -> Iterator[np.ndarray]:
    """The numbers from 0 of nodes by their tags, piece by piece. tags: of all nodes. Raises InputRefused."""
    ordered, order = tags, None
    if not _is_ascending(tags):
        order = np.argsort(tags, kind="stable")
        ordered = tags[order]
    for corners in pieces:
        at = np.minimum(np.searchsorted(ordered, corners), len(tags) - 1)
        at = at if order is None else order[at]
        if (tags[at] != corners).any():
            raise InputRefused("an element has a node that is not there", file=file)
        yield at


def _is_ascending(tags: np.ndarray) -> bool:
    pieces = (tags[max(begin - 1, 0) : begin + ROWS_AT_ONCE] for begin in range(0, len(tags), ROWS_AT_ONCE))
    return all((piece[:-1] <= piece[1:]).all() for piece in pieces)


class _Corners:
    """The tags of the corners of faces of one size."""

    def __init__(self, size: int, rows: MakeRows):
        self._rows = rows(np.empty((0, size)))
        self._waiting: list[np.ndarray] = []  # mostly of one face each
        self._count = 0

    def add(self, corners: np.ndarray) -> None:
        self._waiting.append(corners)
        self._count += len(corners)
        if self._count >= LINES_AT_ONCE:
            self._flush()

    def _flush(self) -> None:
        if self._waiting:
            self._rows.add(np.concatenate(self._waiting))
        self._waiting, self._count = [], 0

    def array(self) -> np.ndarray:
        self._flush()
        return self._rows.array()


class _Words:
    """The numbers of a section of text, one after another. kinds: those of _Bytes."""

    at = 0  # the word that comes next

    def __init__(self, raw: FileBytes, begin: int, end: int, rows: MakeRows):
        values = rows(np.empty(0))
        for _, piece in pieces_of(raw, begin, end):
            values.add(np.array(piece.split()).astype(np.float64))
        self._values = np.asarray(values.array())

    def require(self, kinds: str, count: int) -> None:
        """Raises ValueError where there are not as many rows."""
        if not 0 <= count <= len(self._values):
            raise ValueError(f"{count} entries are announced, the file is cut off")
        if self.at + count * len(kinds) > len(self._values):
            raise ValueError("the file is cut off")

    def take(self, kinds: str, count: int = 1) -> np.ndarray:
        """(count, len(kinds)) float64. Raises ValueError."""
        self.require(kinds, count)
        begin, self.at = self.at, self.at + count * len(kinds)
        return self._values[begin : self.at].reshape(count, len(kinds))


class _Bytes:
    """The numbers of a binary section, one after another. kinds: in a row: i int32, s size_t, d float64."""

    at = 0  # the byte that comes next

    def __init__(self, raw: FileBytes, begin: int, end: int, order: str):
        self._raw, self._begin, self._size = raw, begin, max(end - begin, 0)
        self._order = order

    def require(self, kinds: str, count: int) -> None:
        if not 0 <= count <= self._size or self.at + count * _row(self._order, kinds).itemsize > self._size:
            raise ValueError(f"{count} entries are announced, the file is cut off")

    def _some(self, size: int) -> bytes:
        begin = self._begin + self.at
        return self._raw[begin : min(begin + size, self._begin + self._size)]

    def take(self, kinds: str, count: int = 1) -> np.ndarray:
        self.require(kinds, count)
        row = _row(self._order, kinds)
        found = np.frombuffer(self._some(count * row.itemsize), row)
        self.at += found.nbytes
        return np.stack([found[name].astype(np.float64) for name in row.names or ()], axis=1)

    def line(self) -> int:
        """A number on a line of text."""
        text, _, _ = self._some(40).partition(b"\n")
        self.at += len(text) + 1
        return int(text)


@cache
def _row(order: str, kinds: str) -> np.dtype:
    types = {"i": f"{order}i4", "s": f"{order}u8", "d": f"{order}f8"}
    return np.dtype([(str(k), types[kind]) for k, kind in enumerate(kinds)])


_Numbers = _Words | _Bytes


def _pieces(read: _Numbers, kinds: str, count: int) -> Iterator[np.ndarray]:
    """The same as take has, some rows at a time."""
    read.require(kinds, count)
    for begin in range(0, count, ROWS_AT_ONCE):
        yield read.take(kinds, min(ROWS_AT_ONCE, count - begin))


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


def _nodes_2(read: _Numbers, tags: Rows, places: Rows) -> None:
    for found in _pieces(read, "iddd", _count(read)):
        tags.add(found[:, 0])
        places.add(found[:, 1:])


def _nodes_4(read: _Numbers, tags: Rows, places: Rows) -> None:
    blocks, *_ = read.take("ssss")[0]
    for _ in range(_whole(blocks)):
        dimension, _, parametric, count = read.take("iiis")[0]
        more = _few(dimension) if parametric else 0
        for found in _pieces(read, "s", _whole(count)):
            tags.add(found[:, 0])
        for found in _pieces(read, "ddd" + "d" * more, _whole(count)):
            places.add(found[:, :3])


def _elements_2(read: _Numbers, faces: dict[int, _Corners]) -> None:
    count = _count(read)
    done = 0
    while done < count:
        if isinstance(read, _Bytes):
            kind, rows, tags = (int(v) for v in read.take("iii")[0])
            first = 1 + _few(tags)
            if rows < 1:
                raise ValueError("a block without elements")
        else:
            _, kind, tags = (int(v) for v in read.take("iii")[0])
            rows, first = 1, _few(tags)
        for found in _pieces(read, "i" * (first + _NODES[kind]), rows):
            if kind in _CORNERS:
                faces[_CORNERS[kind]].add(found[:, first : first + _CORNERS[kind]])
        done += rows


def _elements_4(read: _Numbers, faces: dict[int, _Corners]) -> None:
    blocks, *_ = read.take("ssss")[0]
    for _ in range(_whole(blocks)):
        _, _, kind, count = read.take("iiis")[0]
        for found in _pieces(read, "s" * (1 + _NODES[int(kind)]), _whole(count)):
            if kind in _CORNERS:
                faces[_CORNERS[int(kind)]].add(found[:, 1 : 1 + _CORNERS[int(kind)]])
