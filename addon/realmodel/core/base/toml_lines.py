# SPDX-License-Identifier: GPL-3.0-or-later
"""The lines of the keys of a TOML text.

tomllib reads values without their lines. This walks the same text, already known to be valid, and records the
line of every table, key and array element.
"""

from __future__ import annotations

import bisect
import re
import tomllib

Path = tuple[str | int, ...]

_BARE_KEY = re.compile(r"[A-Za-z0-9_-]+")
_BLANK = re.compile(r"(?:[ \t\r\n]+|#[^\n]*)*")
_SPACE = re.compile(r"[ \t]*")
_SCALAR = re.compile(r"[^,\]}#\n]*")
_BASIC = re.compile(r'"(?:[^"\\]|\\.)*"')
_LITERAL = re.compile(r"'[^']*'")
_LONG_BASIC = re.compile(r'"""(?:[^\\]|\\.)*?"""(?:"(?!")|""(?!"))?', re.DOTALL)
_LONG_LITERAL = re.compile(r"'''.*?'''(?:'(?!')|''(?!'))?", re.DOTALL)


def key_lines(text: str) -> dict[Path, int]:
    """{path: line from 1} for a valid TOML text.

    A path is what one would write to index the parsed document: ("rock", 0, "surface", 2, "mesh").
    """
    return _Walk(text).lines


class _Walk:
    def __init__(self, text: str):
        self.text = text
        self.at = 0
        self.newlines = [match.start() for match in re.finditer("\n", text)]
        self.lines: dict[Path, int] = {}
        self.tables_in_array: dict[Path, int] = {}
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
        table: Path = ()
        while True:
            self._skip(_BLANK)
            if self.at >= len(self.text):
                return
            if self.text[self.at] == "[":
                table = self._header()
            else:
                self._pair(table)

    def _header(self) -> Path:
        line = self._line()
        is_array = self.text.startswith("[[", self.at)
        self.at += 2 if is_array else 1
        *outer, last = self._key()
        self._skip(_SPACE)
        self.at += 2 if is_array else 1
        path: Path = ()
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

    def _pair(self, table: Path) -> None:
        line = self._line()
        path = table
        for part in self._key():
            path += (part,)
            self.lines.setdefault(path, line)
        self.at += 1  # the equals sign
        self._skip(_SPACE)
        self._value(path)

    def _value(self, path: Path) -> None:
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

    def _array(self, path: Path) -> None:
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

    def _inline_table(self, path: Path) -> None:
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
