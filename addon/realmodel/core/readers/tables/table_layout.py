# SPDX-License-Identifier: GPL-3.0-or-later
"""The layout of a table of text, detected from its first lines."""

from __future__ import annotations

import csv
import re
from collections.abc import Callable, Container, Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import zip_longest
from pathlib import Path

from ...base.errors import InputRefused
from ...base.text import NOT_FINITE, NUMBER, Content
from ...base.units import unit_of, unit_text_of_column, unknown_unit
from .dialects.dialect import Dialect, comment_units

HEAD_BYTES = 1 << 18
_SEPARATORS = (";", "\t", "|", ",", " ")  # in the order of preference: a comma may stand for a point
_COMMENTS = ("#", "!", "%", ">", "//")
_SIGNS = "#!%/"
_COMMA_NUMBER = re.compile(NUMBER.pattern.replace(r"\.", ","))
_THOUSANDS = re.compile(r"[+-]?\d{1,3}(?:,\d{3})+")
_GROUPED = re.compile(r"[+-]?\d{1,3}(?:([,.'’\xa0\u202f ])\d{3})(?:\1\d{3})*(?:[.,]\d*)?")
WITH_UNIT = re.compile(r"([+-]?\d[\d.,]*)\s*([^\W\d][\w.]*|'|\")")  # a number with its unit
_COMMENT = re.compile(r"(^|(?<=[\s,;|]))#.*$")
_TRAILING = re.compile(r"\s#(\s.*)?$")  # of a header: "Hole #,X,Y" is one
_NAMES_SHOWN = 12


_QUOTED = re.compile(rb'(?:(?<=^)|(?<=[,;\t|]))\s*"(?:[^"]|"")*"(?=\s*(?:[,;\t|]|$))')
_OPENS = re.compile(rb'(?:^|[,;\t|])\s*"')
_CLOSES = re.compile(rb'"\s*(?:[,;\t|]|$)')
_MOST_LINES = 200  # of a text


@dataclass(frozen=True)
class TableLayout:
    """separator: one character, " " for blanks and tabs. names: of the columns, where there is a header.
    body: the byte where the rows begin; body_line: its line from 1; name_line: that of the header. units:
    the texts that say the unit of x and y, and that of z, outside of the names of columns; "" where there
    is none. nodata: the number of no value in this kind of table."""

    separator: str
    names: tuple[str, ...] | None
    body: int
    body_line: int
    name_line: int | None
    units: tuple[str, str] = ("", "")
    nodata: float | None = None

    def fields(self, line: str) -> list[str]:
        return fields(line, self.separator)


def fields(line: str, separator: str) -> list[str]:
    """The entries of a line, without blanks and quotes around them."""
    if '"' in line:
        text = re.sub(r"\s+", " ", line.strip()) if separator == " " else line
        try:
            return [entry.strip() for entry in next(csv.reader([text], delimiter=separator))]
        except csv.Error:  # quotes that do not fit together in a long line: they are no quotes
            pass
    if separator == " ":
        return line.split()
    return [entry.strip() for entry in line.split(separator)]


def is_number(entry: str, decimal: str = ".") -> bool:
    pattern = NUMBER if decimal == "." else _COMMA_NUMBER
    return bool(pattern.fullmatch(entry) or NOT_FINITE.fullmatch(entry))


def is_any_number(entry: str) -> bool:
    """Whether an entry of a row is a number, with a decimal point or comma, or in groups of thousands. Where
    commas separate, an entry that has one stands in quotes."""
    return is_number(entry) or is_number(entry, ",") or bool(_GROUPED.fullmatch(entry))


def _has_unit(entry: str) -> bool:
    """Whether an entry is a length with its unit."""
    written = WITH_UNIT.fullmatch(entry)
    return written is not None and unit_of(written[2]) is not None


@dataclass(frozen=True)
class Expected:
    """What is known of a table before it is read. separator: None where it is to be found. wanted: the
    requested columns; texts are names that the header must have. known: names that make a line a header,
    in small letters. numbers, columns: how many of them a row has at least. is_header: whether texts are
    the names of the columns that are needed, by which a sheet of a workbook is chosen; None: by wanted and
    known."""

    separator: str | None = None
    wanted: Sequence[str | int] = ()
    known: Container[str] = ()
    numbers: int = 3
    columns: int = 3
    is_header: Callable[[list[str]], bool] | None = None


def with_whole_rows(raw: Content) -> Content:
    """A table in which texts in quotes do not go on in further lines: each such row is one line, and empty
    lines after it keep the numbers of the others."""
    if raw.find(b'"') < 0:
        return raw
    lines = raw[:].split(b"\n")
    if not any(line.count(b'"') % 2 for line in lines):
        return raw
    out: list[bytes] = []
    number = 0
    while number < len(lines):
        end = _end_of_row(lines, number)
        out += [b" ".join(line.strip(b"\r") for line in lines[number : end + 1]), *[b""] * (end - number)]
        number = end + 1
    return b"\n".join(out)


def _end_of_row(lines: list[bytes], first: int) -> int:
    """The line in which a row ends, the same line where no text in quotes is open at its end."""
    if lines[first].count(b'"') % 2 == 0 or not _OPENS.search(_QUOTED.sub(b"", lines[first])):
        return first
    count = 0
    for number in range(first, min(first + _MOST_LINES, len(lines))):
        count += lines[number].count(b'"')
        if count % 2 == 0:
            return number if _CLOSES.search(lines[number]) else first
    return first


def table_layout(
    file: Path, raw: Content, start: int, encoding: str, expected: Expected, dialect: Dialect | None = None
) -> TableLayout:
    """The layout of a table that begins at byte `start` of its file. dialect: its kind, if it has a special
    header. Raises InputRefused where there are no rows."""
    separator, known_names = expected.separator, expected.known
    head = raw[start : start + HEAD_BYTES]
    if start + HEAD_BYTES < len(raw):
        head = head[: head.rfind(b"\n") + 1] or head
    lines = head.split(b"\n")
    texts = [line.decode(encoding, "replace").strip("\r") for line in lines]

    def layout(
        separator: str, names: tuple[str, ...] | None, first: int, name_line: int | None
    ) -> TableLayout:
        body = min(start + sum(len(line) + 1 for line in lines[:first]), len(raw))
        return TableLayout(separator, names, body, first + 1, None if name_line is None else name_line + 1)

    if dialect is not None:
        header = dialect.header(file, texts)
        found_layout = layout(separator or " ", header.names, header.rows, header.name_line)
        return replace(found_layout, units=header.units, nodata=header.nodata)
    content = [n for n, text in enumerate(texts) if text.strip() and not _is_comment(text)]
    if not content:
        raise InputRefused("there are no rows in it", file=file)
    if _is_count(content, texts, expected.numbers):
        content = content[1:]
    if separator is None:
        separator = _separator([texts[n] for n in content], expected.numbers, expected.columns)
    first, headings, count = len(lines), [], 0
    for n in content:
        entries = fields(_TRAILING.sub("", texts[n]), separator)
        numbers = sum(is_any_number(entry) or _has_unit(entry) for entry in entries)
        if numbers and not (
            numbers < expected.numbers and any(plain_name(entry) in known_names for entry in entries)
        ):
            first, count = n, len(entries)
            break
        headings.append((n, entries))
    commented = [(n, _commented(texts[n], separator, count)) for n in range(first) if _is_comment(texts[n])]
    units = [text if _is_unit(text) else "" for text in comment_units(texts[n] for n, _ in commented)]
    if len(headings) > 1 and all(entry in ("", "-") or _is_unit(entry) for entry in headings[-1][1]):
        of_columns = headings.pop()[1]  # a row of units beneath the names
        headings[-1] = (
            headings[-1][0],
            [_with_unit(*pair) for pair in zip_longest(headings[-1][1], of_columns, fillvalue="")],
        )
    wanted = [name for name in expected.wanted if isinstance(name, str)]
    name_line, names = _header(headings, commented, wanted, known_names)
    if names is not None and len(names) + 1 == count and _are_row_names(content, first, texts):
        names = ("", *names)  # as R writes tables
    return replace(layout(separator, names, first, name_line), units=(units[0], units[1]))


def _is_count(content: list[int], texts: list[str], numbers: int) -> bool:
    """Whether the first line is the number of points, as of clouds of points."""
    first = texts[content[0]].strip()
    return (
        numbers > 1
        and len(content) > 1
        and first.isdecimal()
        and len(re.split(r"[\s,;]+", texts[content[1]])) > 2
    )


def _are_row_names(content: list[int], first: int, texts: list[str]) -> bool:
    """Whether the first entries of the first rows are their names, which stand in quotes."""
    return all(texts[n].lstrip().startswith('"') for n in content[:4] if n >= first)


def _is_unit(text: str) -> bool:
    return unit_of(text) is not None or unknown_unit(text)


def _with_unit(name: str, unit: str) -> str:
    return f"{name} ({unit})" if _is_unit(unit) and not unit_text_of_column(name) else name


def _commented(text: str, separator: str, count: int) -> list[str]:
    """The entries of a comment, as many as a row has where the sign that begins it is the name of the first:
    not with blanks between them, where it rather is the sign of a comment."""
    entries = fields(text.lstrip(_SIGNS + " "), separator)
    whole = fields(text, separator)
    return whole if separator != " " and len(whole) == count > len(entries) else entries


def _is_comment(text: str) -> bool:
    return text.lstrip().startswith(_COMMENTS)


def _separator(texts: list[str], numbers: int, columns: int) -> str:
    """The separator of the first line that has enough columns and numbers; else of the first with enough
    columns."""
    for text in texts:
        able = []
        for separator in _SEPARATORS:
            entries = fields(_COMMENT.sub("", text), separator)
            counted = sum(is_any_number(entry) for entry in entries)
            if len(entries) >= columns and counted >= numbers:
                able.append((len(fields(texts[0], separator)) == len(entries), separator))
        if able:  # with decimal commas between blanks the header tells
            return max(able, key=lambda one: one[0])[1]
    for separator in _SEPARATORS:
        if len(fields(_COMMENT.sub("", texts[0]), separator)) >= columns:
            return separator
    return " "


def _header(
    headings: list[tuple[int, list[str]]],
    commented: list[tuple[int, list[str]]],
    wanted: Iterable[str],
    known_names: Container[str],
) -> tuple[int | None, tuple[str, ...] | None]:
    """The line with the names of the columns: the one that has the requested names, if any; a comment counts
    only if it has all of them."""
    asked = [name.strip().lower() for name in wanted]
    for n, entries in [*headings, *commented]:
        if asked and set(asked) <= {entry.lower() for entry in entries}:
            return n, tuple(entries)
    known = [sum(plain_name(entry) in known_names for entry in entries) for _, entries in headings]
    if any(known):
        n, entries = headings[known.index(max(known))]
        return n, tuple(entries)
    for n, entries in commented:
        if {"x", "y", "z"} <= {plain_name(entry) for entry in entries}:
            return n, tuple(entries)
    return (headings[-1][0], tuple(headings[-1][1])) if headings else (None, None)


def plain_name(name: str) -> str:
    """A column's name in small letters, without the unit that stands behind it."""
    plain = re.sub(r"\s*[\[({].*$", "", name).strip("\"' ")
    unit = unit_text_of_column(plain)
    return (plain[: -len(unit)].rstrip(" _.,:/-") if unit else plain).lower()


def column_number(file: Path, layout: TableLayout, column: str | int) -> int:
    """The number from 0 of a column given by name or by number from 1. Raises InputRefused."""
    if isinstance(column, int):
        return column - 1
    names = layout.names
    if names is None:
        if column.strip().isdecimal():
            return int(column) - 1
        advice = "use column numbers, from 1: columns = [1, 2, 3]"
        raise InputRefused(f"there is no header that names a column '{column}'", file=file, advice=advice)
    for same in (str.strip, lambda name: name.strip().lower()):
        matches = [n for n, name in enumerate(names) if same(name) == same(column)]
        if len(matches) == 1:
            return matches[0]
        if matches:
            what = f"the header has {len(matches)} columns named {column}"
            raise InputRefused(what, file=file, line=layout.name_line, advice="give their numbers, from 1")
    if column.strip().isdecimal() and 1 <= int(column) <= len(names):
        return int(column) - 1
    raise InputRefused(
        f"the header has no column {column}",
        file=file,
        line=layout.name_line,
        advice=f"it has {names_shown(names)}",
    )


def names_shown(names: Sequence[str]) -> str:
    named = [name or "(no name)" for name in names]
    more = f" and {len(named) - _NAMES_SHOWN} more" if len(named) > _NAMES_SHOWN else ""
    return f"{', '.join(named[:_NAMES_SHOWN])}{more}"


def decimal_comma(entries: Sequence[str]) -> bool | None:
    """Whether entries of a column of numbers have decimal commas; None where the commas may separate
    thousands, or where some entries have points."""
    with_comma = [entry for entry in entries if "," in entry]
    if not with_comma or any("." in entry for entry in entries):
        return None if with_comma else False
    if not all(is_number(entry, ",") or _THOUSANDS.fullmatch(entry) for entry in with_comma):
        return False
    return True if any(not _THOUSANDS.fullmatch(entry) for entry in with_comma) else None
