# SPDX-License-Identifier: GPL-3.0-or-later
"""Triangulated surfaces in Gmsh's MSH 2, 4.0 and 4.1, text or binary (Gmsh Reference Manual, "MSH file
format"): the triangles and quadrangles of each physical surface that has a name, or all."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
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
_PHYSICAL = re.compile(rb'^\s*2\s+(\d+)\s+"([^"\n]*)"', re.MULTILINE)
_CORNERS = {2: 3, 9: 3, 3: 4, 10: 4, 16: 4}


def begins_as_msh(head: bytes, _size: int = 0) -> bool:
    """Whether a file that begins so is one."""
    return head.lstrip().startswith(b"$MeshFormat")


def read_msh(file: str | Path, step: Step = no_step) -> list[ObjectName]:
    """Reads the faces by the names of their physical groups; those of none have none. Without names it is
    called as its file. Raises InputRefused naming the file."""
    file = Path(file)
    raw = read_bytes(file)
    if b"$MeshFormat" not in raw:
        what = (
            "MSH 1 is not read" if raw.lstrip().startswith(b"$NOD") else "it is no mesh of Gmsh or Leapfrog"
        )
        raise InputRefused(what, file=file, advice="save it as MSH 4.1 or 2.2, STL, OBJ or PLY")
    sections = {name: _section(file, raw, name) for name in (b"MeshFormat", b"Nodes", b"Elements")}
    head = raw[slice(*sections[b"MeshFormat"])]
    words = head.split(None, 3)
    version = words[0].decode("ascii", "replace") if words else ""
    if len(words) < 3 or not re.fullmatch(r"2(\.\d+)?|4(\.[01])?", version):
        raise InputRefused(
            f"MSH {version:.10} is not read", file=file, advice="save it as version 4.1 or 2.2"
        )
    is_binary = words[1] == b"1"
    order = ">" if is_binary and head.split(b"\n", 1)[1][:4] == b"\0\0\0\1" else "<"
    layout = _Layout(version, is_binary, order)
    at = b"Nodes"
    read: dict[bytes, _Numbers] = {}
    try:
        for name in (b"Nodes", b"Elements"):
            read[name] = layout.numbers(raw[slice(*sections[name])])
        tags, places = layout.nodes(read[at])
        step(0.5)
        at = b"Elements"
        faces = layout.elements(read[at], _groups_of_entities(raw, layout))
    except InputRefused:
        raise
    except (ValueError, IndexError, OverflowError, MemoryError, KeyError) as error:
        what, line = f"not a Gmsh file that can be read: {error}", None
        if len(read) == 2:
            place = read[at].at
            if is_binary:
                what += f" (byte {sections[at][0] + place})"
            else:
                line = line_of_word(raw, place, *sections[at])
        raise InputRefused(what, file=file, line=line) from error
    if not faces:
        raise InputRefused(
            "it has no triangles or quadrangles", file=file, advice="mesh the surfaces, and save all"
        )
    if not len(tags):
        raise InputRefused("it has no nodes", file=file)
    return _objects(file, places, _Tags(file, tags), faces, _physical_names(raw))


def _objects(
    file: Path, places: np.ndarray, tags: _Tags, faces: _Faces, names: dict[int, str]
) -> list[ObjectName]:
    """The objects by the names of physical groups, in the order of these."""
    if not names:
        return [surface_object(file, file.stem, places, _joined(tags, faces.of_all()))]
    by_name: dict[str, list[np.ndarray]] = {name: [] for name in names.values()}
    for group, corners in faces.of_groups():
        by_name.setdefault(names.get(group, ""), []).append(corners)
    return [surface_object(file, name, places, _joined(tags, some)) for name, some in by_name.items() if some]


def _joined(tags: _Tags, faces: list[np.ndarray]) -> list | np.ndarray:
    """The corners of faces by the numbers of their nodes. Triangles come before quadrangles."""
    sizes = [np.concatenate(some) for k in (3, 4) if (some := [face for face in faces if face.shape[1] == k])]
    numbers = [tags.numbers(some) for some in sizes]
    return numbers[0] if len(numbers) == 1 else [row for some in numbers for row in some.tolist()]


def _section(file: Path, raw: bytes, name: bytes) -> tuple[int, int]:
    """Where a section begins and ends. Raises InputRefused where it is not whole."""
    begin, end = raw.find(b"$" + name), raw.rfind(b"$End" + name)
    if begin < 0 or end < begin:
        what = f"it has no whole section {name.decode()}"
        raise InputRefused(f"{what} (byte {len(raw)})", file=file, advice="the file is cut off")
    return raw.find(b"\n", begin) + 1, end


def _physical_names(raw: bytes) -> dict[int, str]:
    """The names of physical surfaces by their numbers."""
    section = raw[max(raw.find(b"$PhysicalNames"), 0) : max(raw.find(b"$EndPhysicalNames"), 0)]
    return {int(tag): name.decode("utf-8", "replace") for tag, name in _PHYSICAL.findall(section)}


def _groups_of_entities(raw: bytes, layout: _Layout) -> dict[int, list[int]]:
    """The physical groups of each surface of MSH 4. Raises ValueError."""
    begin, end = raw.find(b"$Entities"), raw.find(b"$EndEntities")
    if layout.is_old or not 0 <= begin < end:
        return {}
    read = layout.numbers(raw[raw.find(b"\n", begin) + 1 : end])
    groups: dict[int, list[int]] = {}
    points, curves, surfaces, _ = (_whole(value) for value in read.take("ssss")[0])
    for dimension, count in enumerate((points, curves, surfaces)):
        for _ in range(count):
            # a point has its place, from 4.1 on; others have a box
            row = read.take("iddd" if dimension == 0 and layout.version == "4.1" else "idddddd")[0]
            (tagged,) = read.take("s")[0]
            some = read.take("i" * _few(tagged))[0] if tagged else []
            if dimension == 2:
                groups[int(row[0])] = [abs(int(value)) for value in some]
            if dimension:
                (bounds,) = read.take("s")[0]
                read.take("i", _whole(bounds))
    return groups


class _Tags:
    """The nodes of a file by their tags (N,)."""

    def __init__(self, file: Path, tags: np.ndarray):
        self._file = file
        self._order = np.argsort(tags, kind="stable")
        self._tags = tags[self._order]

    def numbers(self, corners: np.ndarray) -> np.ndarray:
        """The numbers from 0 of nodes by their tags. Raises InputRefused."""
        at = np.minimum(np.searchsorted(self._tags, corners), len(self._tags) - 1)
        if (self._tags[at] != corners).any():
            raise InputRefused("an element has a node that does not exist", file=self._file)
        return self._order[at]


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


class _Faces:
    """Faces in pieces: the tags of their corners, and their physical groups (0: none)."""

    def __init__(self) -> None:
        self._pieces: list[tuple[np.ndarray, np.ndarray]] = []

    def __len__(self) -> int:
        return len(self._pieces)

    def add(self, kind: int, nodes: np.ndarray, groups: np.ndarray) -> None:
        """Adds elements of a type by their nodes; of others than faces, does nothing."""
        if kind in _CORNERS and len(nodes):
            self._pieces.append((nodes[:, : _CORNERS[kind]], groups))

    def of_all(self) -> list[np.ndarray]:
        """All faces, each once."""
        return [faces for faces, _ in self._pieces]

    def of_groups(self) -> Iterator[tuple[int, np.ndarray]]:
        """Each group that a piece has, and its faces there."""
        for faces, groups in self._pieces:
            for group in dict.fromkeys(groups.ravel().tolist()):
                yield int(group), faces[(groups == group).reshape(len(faces), -1).any(axis=1)]


@dataclass(frozen=True)
class _Layout:
    """How a file is written."""

    version: str
    is_binary: bool
    order: str

    @property
    def is_old(self) -> bool:
        """Whether it is MSH 2."""
        return self.version.startswith("2")

    def numbers(self, section: bytes) -> _Numbers:
        """The numbers of a section."""
        return _Bytes(section, self.order) if self.is_binary else _Words(section)

    def nodes(self, read: _Numbers) -> tuple[np.ndarray, np.ndarray]:
        """The tags (N,) and the places (N, 3) of the nodes. Raises ValueError."""
        if self.is_old:
            rows = read.take("iddd", _count(read))
            return rows[:, 0], rows[:, 1:]
        tags, places = [np.empty(0)], [np.empty((0, 3))]
        blocks, *_ = read.take("ssss" if self.version == "4.1" else "ss")[0]
        for _ in range(_whole(blocks)):
            one, other, parametric, count = read.take("iiis")[0]
            dimension = one if self.version == "4.1" else other
            more = "d" * (_few(dimension) if parametric else 0)
            if self.version == "4.1":
                tags.append(read.take("s", _whole(count))[:, 0])
                places.append(read.take("ddd" + more, _whole(count))[:, :3])
            else:
                rows = read.take("iddd" + more, _whole(count))
                tags.append(rows[:, 0])
                places.append(rows[:, 1:4])
        return np.concatenate(tags), np.concatenate(places)

    def elements(self, read: _Numbers, groups: dict[int, list[int]]) -> _Faces:
        """The faces. groups: the physical ones of each surface. Raises ValueError, KeyError."""
        if self.is_old:
            return _elements_2(read)
        faces = _Faces()
        is_last = self.version == "4.1"
        blocks, *_ = read.take("ssss" if is_last else "ss")[0]
        for _ in range(_whole(blocks)):
            one, other, kind, count = read.take("iiis")[0]
            rows = read.take(("s" if is_last else "i") * (1 + _NODES[int(kind)]), _whole(count))
            some = groups.get(int(other if is_last else one), []) or [0]
            faces.add(int(kind), rows[:, 1:], np.tile(some, (len(rows), 1)))
        return faces


def _elements_2(read: _Numbers) -> _Faces:
    faces, count, done = _Faces(), _count(read), 0
    of_kind: dict[int, list[np.ndarray]] = {}
    while done < count:
        if isinstance(read, _Bytes):
            kind, rows, tags = (int(v) for v in read.take("iii")[0])
            first = 1 + _few(tags)
            if rows < 1:
                raise ValueError("a block without elements")
        else:
            _, kind, tags = (int(v) for v in read.take("iii")[0])
            rows, first = 1, _few(tags)
        numbers = read.take("i" * (first + _NODES[kind]), rows)
        group = numbers[:, first - tags : first - tags + 1] if tags else np.zeros((rows, 1))
        of_kind.setdefault(kind, []).append(np.column_stack([group, numbers[:, first:]]))
        done += rows
    for kind, pieces in of_kind.items():
        numbers = np.concatenate(pieces)
        faces.add(kind, numbers[:, 1:], numbers[:, :1].astype(np.int64))
    return faces
