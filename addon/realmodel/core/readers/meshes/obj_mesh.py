# SPDX-License-Identifier: GPL-3.0-or-later
"""Wavefront OBJ ("Object Files", the appendix B1 of the manual of Advanced Visualizer): the faces of each
object (`o`), and of each group (`g`). Coordinates are read as they stand: z is up. Normals, colors and
materials are left out."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

from ...base.errors import InputRefused
from ...base.text import Step, no_step, text_lines
from ..objects.geo_object import ObjectName, point_object
from .triangle_mesh import UNREADABLE, surface_object

_COMMENT = re.compile(r"(?:^|\s)#.*")


def begins_as_obj(head: bytes, _size: int = 0) -> bool:
    """Whether a file that begins so is an OBJ: comments apart, its first line is one of that format."""
    lines = (line.partition(b"#")[0].split() for line in head.removeprefix(b"\xef\xbb\xbf").splitlines())
    words = next((words for words in lines if words), [b""])
    if words[0] in (b"v", b"vt", b"vn"):
        numbers = words[1:-1] if words[-1] == b"\\" else words[1:]
        return len(words) >= 3 and all(re.fullmatch(rb"[-+.\deE]+", word) for word in numbers)
    return words[0] in (b"mtllib", b"usemtl", b"o", b"g", b"s") and len(words) > 1 and b"\nv " in head


def read_obj(file: str | Path, step: Step = no_step) -> list[ObjectName]:
    """The objects of a file; where it has none, its groups. A group within an object is a part of it. A group
    is called by its line, and by each word of that: `g a b` belongs to "a b", to "a" and to "b". Points where
    there are no faces. Raises InputRefused naming file and line."""
    file = Path(file)
    vertices: list[tuple[float, ...]] = []
    blocks: dict[tuple[str, str], list[tuple[tuple[int, ...], int]]] = {}  # by object and group: faces, lines
    label, group = "", ""
    for number, line in _lines(file, step):
        key, *words = line.split()
        try:
            if key == "v":
                x, y, z = words[:3]
                vertices.append((float(x), float(y), float(z)))
            elif key == "f":
                corners = [int(word.partition("/")[0]) for word in words]
                # from 1; below zero from the last vertex so far
                face = tuple([c - 1 if c > 0 else len(vertices) + c if c else -1 for c in corners])
                blocks.setdefault((label, group), []).append((face, number))
            elif key in ("o", "g"):
                name = " ".join(words)
                label, group = (name, "") if key == "o" else (label, name)
        except UNREADABLE as error:
            raise InputRefused(f"'{line:.40}' cannot be read", file=file, line=number) from error
    if not blocks:
        if not vertices:
            raise InputRefused("the mesh has no faces", file=file)
        return [point_object(file.stem, vertices)]
    return [
        surface_object(
            file,
            name,
            vertices,
            [face for faces in some for face, _ in faces],
            [line for faces in some for _, line in faces],
            is_part=is_part,
        )
        for name, (some, is_part) in _named(blocks).items()
    ]


def _named(blocks: dict[tuple[str, str], list]) -> dict[str, tuple[list, bool]]:
    """The blocks of faces of each name, and whether it is a part of what has another name."""
    has_objects = any(label for label, _ in blocks)
    whole = list(dict.fromkeys(label if has_objects else group for label, group in blocks))
    words = [word for _, group in blocks for word in (group, *group.split()) if word]
    named = {}
    for name in dict.fromkeys([*whole, *words]):
        some = [
            faces
            for (label, group), faces in blocks.items()
            if name == (label if has_objects else group) or (name and name in (group, *group.split()))
        ]
        named[name] = some, name not in whole
    return named


def _lines(file: Path, step: Step) -> Iterator[tuple[int, str]]:
    """The number from 1 and the text of each line that has one, without comments; a line that ends in a
    backslash continues in the next one."""
    begun, begin = "", 0
    for first, lines, share in text_lines(file):
        for number, line in enumerate(lines, first):
            text = (_COMMENT.sub("", line) if "#" in line else line).rstrip()
            begin = begin if begun else number
            if text.endswith("\\"):
                begun += text[:-1] + " "
                continue
            text, begun = begun + text, ""
            if text and not text.isspace():
                yield begin, text.lstrip()
        step(share)
    if begun.strip():
        yield begin, begun.strip()
