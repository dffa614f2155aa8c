# SPDX-License-Identifier: GPL-3.0-or-later
"""The tags of a DXF file, text or binary, of any release (Autodesk, "DXF Reference": group codes and their
types), and the entities that they make.
"""

from __future__ import annotations

import re
import struct
from collections.abc import Generator, Iterator
from dataclasses import dataclass, field
from pathlib import Path

from ...base.errors import InputRefused
from ...base.text import LINES_AT_ONCE, Step, read_bytes, require_text, with_newlines

BINARY = b"AutoCAD Binary DXF"
_BEGIN = len(BINARY) + 4  # a mark ends it: CR, LF, SUB and NUL
_CODE_PAGE = re.compile(rb"\$DWGCODEPAGE\s+3\s+ANSI_(\d+)", re.IGNORECASE)
_ESCAPED = re.compile(r"\\U\+([0-9A-Fa-f]{4})")
_INTS = {"<h": (*range(60, 80), *range(170, 180), *range(270, 290), *range(370, 390), *range(400, 410))}
_INTS["<h"] += tuple(range(1060, 1071))
_INTS["<i"] = (*range(90, 100), *range(420, 430), *range(440, 460), 1071)
_INTS["<q"] = tuple(range(160, 170))
_INTS["<B"] = tuple(range(290, 300))
_INTS["<d"] = (*range(10, 60), *range(110, 150), *range(210, 240), *range(460, 470), *range(1010, 1060))
_FORMS = {code: form for form, codes in _INTS.items() for code in codes}
_WITH_ENTITIES, _MARKS = ("ENTITIES", "BLOCKS"), ("", "SECTION", "ENDSEC")
_LISTS = ("LWPOLYLINE", "MESH")  # entities with several values of a code
_CHUNKS = (*range(310, 320), 1004)  # bytes behind their number


@dataclass
class Entity:
    """An entity: its name, the line where it begins, None in a binary file, its values by group code, in
    their order, and the entities within it: the vertices of a POLYLINE, those of a BLOCK."""

    name: str
    line: int | None
    pairs: list[tuple[int, str]] = field(default_factory=list)
    parts: list[Entity] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.codes: dict[int, str] = {}

    def close(self) -> None:
        """Its values are all there: the first of each code is found by it."""
        self.codes = dict(reversed(self.pairs))
        if self.name not in _LISTS:
            self.pairs = []

    def text(self, code: int, default: str = "") -> str:
        """The first value of a code; names may have characters by their numbers."""
        value = self.codes.get(code, default)
        return _ESCAPED.sub(lambda match: chr(int(match[1], 16)), value) if "\\U" in value else value

    def number(self, code: int, default: float = 0.0) -> float:
        """The first value of a code. Raises ValueError."""
        return float(self.codes.get(code, default))

    def whole(self, code: int, default: int = 0) -> int:
        """The same as a whole number. Raises ValueError."""
        return int(self.codes.get(code, default))

    def place(self, corner: int = 0) -> tuple[float, float, float]:
        """The place of a corner. Raises ValueError."""
        return self.number(10 + corner), self.number(20 + corner), self.number(30 + corner)

    def all_of(self, code: int) -> list[float]:
        """All values of a code. Raises ValueError."""
        return [float(value) for key, value in self.pairs if key == code]


@dataclass
class DxfDrawing:
    """A drawing that is read: its blocks by their names in small letters, which come before its entities, and
    the number of the unit in its header."""

    blocks: dict[str, Entity] = field(default_factory=dict)
    unit: int | None = None

    def entities(self, file: Path, step: Step) -> Iterator[Entity]:
        """The entities, one after another. Raises InputRefused naming file and line."""
        raw = read_bytes(file)
        tags = _binary_tags(file, raw) if raw.startswith(BINARY) else _text_tags(file, raw, step)
        section, variable, current = "", "", Entity("", None)
        block: Entity | None = None
        polyline: Entity | None = None
        for code, value, line in tags:
            if code != 0:
                if code == 2 and current.name == "SECTION":
                    section = value.upper()
                elif section == "HEADER" and code == 9:
                    variable = value.upper()
                elif section == "HEADER" and variable == "$INSUNITS" and code == 70 and value.isdecimal():
                    self.unit = int(value)
                elif section in _WITH_ENTITIES:
                    current.pairs.append((code, value))
                continue
            if section in _WITH_ENTITIES and current.name not in _MARKS:
                current.close()
                if current.name == "VERTEX" and polyline is not None:
                    polyline.parts.append(current)
                else:
                    for entity in (polyline, None if current.name == "POLYLINE" else current):
                        block = yield from self._placed(entity, block)
                    polyline = current if current.name == "POLYLINE" else None
            current = Entity(value.upper(), line)
            if current.name in ("SECTION", "ENDSEC"):
                section = ""
            if current.name == "EOF":
                return
        at = None if raw.startswith(BINARY) else raw.count(b"\n") + 1
        raise InputRefused("the file has no EOF", file=file, line=at, advice="it is cut off")

    def _placed(self, entity: Entity | None, block: Entity | None) -> Generator[Entity, None, Entity | None]:
        """Yields an entity of the drawing, or puts it into the block that is open. Returns that which is open
        then."""
        if entity is None or entity.name == "SEQEND":
            return block
        if entity.name == "BLOCK":
            self.blocks[entity.text(2).casefold()] = entity
            return entity
        if entity.name == "ENDBLK":
            return None
        if block is None:
            yield entity
        else:
            block.parts.append(entity)
        return block


def _text_tags(file: Path, raw: bytes, step: Step) -> Iterator[tuple[int, str, int]]:
    """The group code, value and line of each tag."""
    require_text(file, raw)
    lines = _decoded(with_newlines(raw)[:]).replace("\r\n", "\n").split("\n")
    for at in range(0, len(lines) - 1, 2):
        if at % LINES_AT_ONCE == 0:
            step(0.5 * at / len(lines))
        code = lines[at].strip()
        if not code.lstrip("-").isdecimal():
            raise InputRefused(f"'{code:.40}' is no group code", file=file, line=at + 1)
        yield int(code[:9]), lines[at + 1].strip(), at + 2


def _decoded(raw: bytes) -> str:
    """The text: UTF-8, or else of the code page in its header."""
    try:
        return raw.decode("utf-8-sig")
    except UnicodeDecodeError:
        page = _CODE_PAGE.search(raw, 0, 1 << 16)
    try:
        return raw.decode(f"cp{page[1].decode()}" if page else "latin-1")
    except (LookupError, UnicodeDecodeError):
        return raw.decode("latin-1")


def _binary_tags(file: Path, raw: bytes) -> Iterator[tuple[int, str, None]]:
    """The group code and value of each tag. Codes have one byte up to release 12, two later."""
    is_old = raw[_BEGIN + 1 : _BEGIN + 2] not in (b"\0", b"")
    at = _BEGIN
    try:
        while at < len(raw):
            code, at = raw[at], at + 1
            if not is_old or code == 255:
                at -= not is_old
                (code,) = struct.unpack_from("<h", raw, at)
                at += 2
            form = _FORMS.get(code)
            if form is not None:
                value = repr(struct.unpack_from(form, raw, at)[0])
                at += struct.calcsize(form)
            elif code in _CHUNKS:
                value, at = "", at + 1 + raw[at]
            else:
                end = raw.index(b"\0", at)
                value, at = _decoded(raw[at:end]), end + 1
            yield code, value.strip(), None
    except (struct.error, ValueError, IndexError) as error:
        raise InputRefused(f"damaged binary DXF (byte {at})", file=file, advice="it is cut off") from error
