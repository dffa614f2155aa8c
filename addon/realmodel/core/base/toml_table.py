# SPDX-License-Identifier: GPL-3.0-or-later
"""Strict reading of TOML tables: unknown keys and wrong values are refused with their lines."""

from __future__ import annotations

import bisect
import difflib
import re
import tomllib
from collections.abc import Collection, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, Literal, overload

from .algebra import is_finite
from .errors import InputRefused

KeyPath = tuple[str | int, ...]

_BARE_KEY = re.compile(r"[A-Za-z0-9_-]+")
_BLANK = re.compile(r"(?:[ \t\r\n]+|#[^\n]*)*")
_SPACE = re.compile(r"[ \t]*")
_SCALAR = re.compile(r"[^,\]}#\n]*")
_BASIC = re.compile(r'"(?:[^"\\]|\\.)*"')
_LITERAL = re.compile(r"'[^']*'")
_LONG_BASIC = re.compile(r'"""(?:[^\\]|\\.)*?"""(?:"(?!")|""(?!"))?', re.DOTALL)
_LONG_LITERAL = re.compile(r"'''.*?'''(?:'(?!')|''(?!'))?", re.DOTALL)


def key_lines(text: str) -> dict[KeyPath, int]:
    """{path: line from 1} for a valid TOML text.

    A path is what one would write to index the parsed document: ("rock", 0, "surface", 2, "mesh").
    """
    return _Walk(text).lines


class _Walk:
    def __init__(self, text: str):
        self.text = text
        self.at = 0
        self.newlines = [match.start() for match in re.finditer("\n", text)]
        self.lines: dict[KeyPath, int] = {}
        self.tables_in_array: dict[KeyPath, int] = {}
        self._document()

    def _line(self) -> int:
        return bisect.bisect_left(self.newlines, self.at) + 1

    def _skip(self, pattern: re.Pattern) -> str:
        match = pattern.match(self.text, self.at)
        if match is None:
            raise ValueError(f"line {self._line()}: not the TOML that tomllib read")
        self.at = match.end()
        return match.group()

    def _document(self) -> None:
        table: KeyPath = ()
        while True:
            self._skip(_BLANK)
            if self.at >= len(self.text):
                return
            if self.text[self.at] == "[":
                table = self._header()
            else:
                self._pair(table)

    def _header(self) -> KeyPath:
        line = self._line()
        is_array = self.text.startswith("[[", self.at)
        self.at += 2 if is_array else 1
        *outer, last = self._key()
        self._skip(_SPACE)
        self.at += 2 if is_array else 1
        path: KeyPath = ()
        for part in outer:
            path += (part,)
            if path in self.tables_in_array:
                path += (self.tables_in_array[path] - 1,)
            self.lines.setdefault(path, line)
        path += (last,)
        if is_array:
            number = self.tables_in_array.get(path, 0)
            self.tables_in_array[path] = number + 1
            self.lines.setdefault(path, line)
            path += (number,)
        self.lines[path] = line
        return path

    def _key(self) -> list[str]:
        parts = []
        while True:
            self._skip(_SPACE)
            first = self.text[self.at]
            if first == '"':
                parts.append(tomllib.loads(f"key = {self._skip(_BASIC)}")["key"])
            elif first == "'":
                parts.append(self._skip(_LITERAL)[1:-1])
            else:
                parts.append(self._skip(_BARE_KEY))
            self._skip(_SPACE)
            if self.text[self.at] != ".":
                return parts
            self.at += 1

    def _pair(self, table: KeyPath) -> None:
        line = self._line()
        path = table
        for part in self._key():
            path += (part,)
            self.lines.setdefault(path, line)
        self.at += 1  # the equals sign
        self._skip(_SPACE)
        self._value(path)

    def _value(self, path: KeyPath) -> None:
        first = self.text[self.at]
        if first == "[":
            self._array(path)
        elif first == "{":
            self._inline_table(path)
        elif first == '"':
            self._skip(_LONG_BASIC if self.text.startswith('"""', self.at) else _BASIC)
        elif first == "'":
            self._skip(_LONG_LITERAL if self.text.startswith("'''", self.at) else _LITERAL)
        else:
            self._skip(_SCALAR)

    def _array(self, path: KeyPath) -> None:
        self.at += 1
        number = 0
        while True:
            self._skip(_BLANK)
            if self.text[self.at] == "]":
                self.at += 1
                return
            if self.text[self.at] == ",":
                self.at += 1
                continue
            self.lines[(*path, number)] = self._line()
            self._value((*path, number))
            number += 1

    def _inline_table(self, path: KeyPath) -> None:
        self.at += 1
        while True:
            self._skip(_BLANK)
            if self.text[self.at] == "}":
                self.at += 1
                return
            if self.text[self.at] == ",":
                self.at += 1
                continue
            self._pair(path)


class TomlDocument:
    """A TOML file: its parsed content and, when something has to be refused, the lines of its keys."""

    def __init__(self, file: Path):
        self.file = Path(file)
        self.text = _text_of(self.file)
        try:
            self.content = tomllib.loads(self.text)
        except tomllib.TOMLDecodeError as error:
            raise _syntax_refused(self.file, self.text, error) from error
        except (RecursionError, ValueError) as error:
            what = (
                "lists nested too deep"
                if isinstance(error, RecursionError)
                else "a number of too many digits"
            )
            raise InputRefused(f"cannot be read: {what}", file=self.file) from error

    @cached_property
    def _lines(self) -> dict:
        return key_lines(self.text.replace("\r\n", "\n"))

    def line(self, path: Sequence) -> int | None:
        """The line on which `path` stands, or else the nearest table around it."""
        path = tuple(path)
        while path:
            if path in self._lines:
                return self._lines[path]
            path = path[:-1]
        return None


@dataclass(frozen=True)
class Source:
    """The place of a table in a file: of a rock mass, a surface, a fault or a body in a project file."""

    document: TomlDocument
    path: tuple

    def line(self, key: str | None = None) -> int | None:
        """The line of one key ("variogram.range" for a part of one), or of the whole table."""
        return self.document.line(self.path if key is None else (*self.path, *key.split(".")))


def _text_of(file: Path) -> str:
    try:
        raw = file.read_bytes()
    except OSError as error:
        raise InputRefused(f"cannot be read: {error.strerror}", file=file, advice="check the path") from error
    try:
        return raw.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = raw.count(b"\n", 0, error.start) + 1
        raise InputRefused("not UTF-8 text", file=file, line=line, advice="save it as UTF-8") from error


def _syntax_refused(file: Path, text: str, error: tomllib.TOMLDecodeError) -> InputRefused:
    said = str(error)
    place = re.search(r" \(at line (\d+), column \d+\)$", said)
    line = int(place.group(1)) if place else text.rstrip().count("\n") + 1
    what = (
        said[: place.start()] if place else said.replace(" (at end of document)", " at the end of the file")
    )
    return InputRefused(f"not valid TOML: {what[:1].lower()}{what[1:]}", file=file, line=line)


class TomlTable:
    """One table of a document, read key by key. `item`: its name in messages."""

    def __init__(self, document: TomlDocument, content: dict, path: tuple, item: str):
        self.document = document
        self.content = content
        self.path = path
        self.item = item

    def __contains__(self, key: str) -> bool:
        return key in self.content

    def refuse(self, what: str, key: str | None = None, advice: str | None = None) -> InputRefused:
        """The refusal of this table, or of one of its keys; the caller raises it."""
        path = self.path if key is None else (*self.path, key)
        line = self.document.line(path)
        return InputRefused(what, file=self.document.file, line=line, item=self.item, advice=advice)

    def allow_only(self, known: Collection[str]) -> None:
        for key in self.content:
            if key not in known:
                near = difflib.get_close_matches(key, known, n=1)
                advice = f"did you mean '{near[0]}'?" if near else f"valid keys are {', '.join(known)}"
                raise self.refuse(f"unknown key '{key}'", key, advice)

    def _value(self, key: str, required: bool) -> Any:
        if key in self.content:
            return self.content[key]
        if required:
            raise self.refuse(f"key '{key}' is missing", advice=f"add {key} = ...")
        return None

    @overload
    def text(self, key: str, required: Literal[True]) -> str: ...

    @overload
    def text(self, key: str, required: bool = False) -> str | None: ...

    def text(self, key: str, required: bool = False) -> str | None:
        value = self._value(key, required)
        if value is None:
            return None
        if not isinstance(value, str):
            raise self.refuse(f"'{key}' must be text in quotes, not {_kind(value)}", key)
        if not value.strip():
            raise self.refuse(f"'{key}' is empty", key)
        if any(ord(c) < 32 for c in value):
            raise self.refuse(f"'{key}' holds a line break or another control character", key)
        return value

    @overload
    def integer(self, key: str, required: Literal[True]) -> int: ...

    @overload
    def integer(self, key: str, required: bool = False) -> int | None: ...

    def integer(self, key: str, required: bool = False) -> int | None:
        value = self._value(key, required)
        if value is not None and (isinstance(value, bool) or not isinstance(value, int)):
            raise self.refuse(f"'{key}' must be a whole number, not {_kind(value)}", key)
        return value

    def number(self, key: str, required: bool = False) -> float | None:
        value = self._value(key, required)
        if value is None:
            return None
        if isinstance(value, bool) or not isinstance(value, (int, float)):
            raise self.refuse(f"'{key}' must be a number, not {_kind(value)}", key)
        if not is_finite(value):
            raise self.refuse(f"'{key}' must be a finite number, not {value}", key)
        return float(value)

    def tables(self, key: str, item: str) -> list[TomlTable]:
        """The tables of `[[key]]`; at least one is needed. `item` names each by its number from 1."""
        value = self._value(key, False)
        if not value:
            raise self.refuse(
                f"[[{'.'.join([*(p for p in self.path if isinstance(p, str)), key])}]] is missing"
            )
        if not isinstance(value, list) or not all(isinstance(entry, dict) for entry in value):
            raise self.refuse(f"'{key}' must be tables [[{key}]], not {_kind(value)}", key)
        outer = f"{self.item}, " if self.item else ""
        return [
            TomlTable(self.document, entry, (*self.path, key, number), f"{outer}{item} {number + 1}")
            for number, entry in enumerate(value)
        ]


def _kind(value: object) -> str:
    names = {bool: "true or false", int: "a whole number", float: "a number", str: "text", list: "a list"}
    names[dict] = "a table"
    return names.get(type(value), "a date or time")
