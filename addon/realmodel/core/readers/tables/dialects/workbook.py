# SPDX-License-Identifier: GPL-3.0-or-later
"""Sheets of workbooks (.xlsx, Office Open XML: ECMA-376) as tables of text, read by openpyxl: a line for each
row, with tabs between its cells."""

from __future__ import annotations

import datetime
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from ....base.errors import InputRefused, RealModelError
from ....base.packages import quiet, vendored
from ....base.text import Step, no_step, reading

_MEMBERS = (b"[Content_Types].xml", b"_rels/", b"docProps/", b"xl/")
_OLD, _OPEN_DOCUMENT = b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1", b"application/vnd.oasis.opendocument"
_STEP = 5000  # rows
_NAMES_IN = 30  # the first rows, among which is the header


def begins_as_workbook(head: bytes, _size: int = 0) -> bool:
    """Whether a file that begins so is one, also of a format that is refused."""
    if head[:4] != b"PK\3\4":
        return head.startswith(_OLD)
    return head[30:100].startswith((*_MEMBERS, b"mimetype" + _OPEN_DOCUMENT))


def is_workbook(file: Path) -> bool:
    """Whether a file is a workbook, also of a format that is refused."""
    with reading(file), file.open("rb") as opened:
        return begins_as_workbook(opened.read(100))


def sheet_names(file: Path) -> list[str]:
    """The names of the sheets that have cells. Raises InputRefused."""
    with _opened(file) as workbook:
        return [sheet.title for sheet in workbook.worksheets if any(map(any, _rows(sheet)))]


def sheet_text(
    file: Path, name: str | None, is_wanted: Callable[[list[str]], bool], step: Step = no_step
) -> bytes:
    """A sheet as a table of text in UTF-8: the one of this name, or the only one with cells, or the only
    one of which is_wanted(cells) is true for one of its first rows. Raises InputRefused, which lists the
    sheets."""
    with _opened(file) as workbook:
        sheets = {sheet.title: sheet for sheet in workbook.worksheets}
        listed = f"it has {', '.join(sheets)}"
        if name is not None:
            named = [
                sheet for title, sheet in sheets.items() if title.strip().lower() == name.strip().lower()
            ]
            if not named:
                raise InputRefused(f"it has no sheet '{name}'", file=file, advice=listed)
            return _text(named[0], step)
        with_cells = [sheet for sheet in sheets.values() if any(map(any, _rows(sheet)))]
        wanted = [sheet for sheet in with_cells if any(map(is_wanted, _rows(sheet, _NAMES_IN)))]
        fitting = with_cells if len(with_cells) == 1 else wanted
        if not with_cells:
            raise InputRefused("its sheets are empty", file=file)
        if len(fitting) != 1:
            count = len(fitting) or "none"
            what = f"it has {len(with_cells)} sheets, and {count} with the columns that are needed"
            raise InputRefused(what, file=file, advice=f'say which: layer = "..."; {listed}')
        return _text(fitting[0], step)


@contextmanager
def _opened(file: Path) -> Iterator[Any]:
    """The workbook, read row by row. Raises InputRefused instead of all errors of openpyxl."""
    with file.open("rb") as opened:
        head = opened.read(100)
    if head.startswith(_OLD) or _OPEN_DOCUMENT in head:
        what = "this is a workbook of Excel 2003 or older" if head.startswith(_OLD) else "this is no .xlsx"
        raise InputRefused(what, file=file, advice="save it as .xlsx or as CSV")
    openpyxl = vendored("openpyxl", "openpyxl", "reading Excel's workbooks", by_its_name=True)
    try:
        with quiet():
            workbook = openpyxl.load_workbook(file, read_only=True, data_only=True)
            yield workbook
            workbook.close()
    except (RealModelError, OSError):
        raise
    except Exception as error:
        what = f"not a workbook that can be read: {error or type(error).__name__}"
        raise InputRefused(what, file=file, advice="save it as .xlsx or as CSV") from error


def _rows(sheet: Any, most: int | None = None) -> Iterator[list[str]]:
    """The cells of its rows, as texts."""
    sheet.reset_dimensions()  # some programs write them wrong
    for row in sheet.iter_rows(max_row=most, values_only=True):
        yield [_cell(value) for value in row]


def _cell(value: object) -> str:
    if value is None:
        return ""
    if isinstance(value, bool):
        return str(int(value))
    if isinstance(value, (int, float)):
        return repr(value)
    if isinstance(value, (datetime.datetime, datetime.date)):
        return value.isoformat().removesuffix("T00:00:00")
    text = " ".join(str(value).split())
    return "" if text in ("#N/A", "#REF!", "#VALUE!", "#DIV/0!", "#NAME?", "#NUM!", "#NULL!") else text


def _text(sheet: Any, step: Step) -> bytes:
    count = sheet.max_row or 0
    lines = []
    for number, row in enumerate(_rows(sheet)):
        if number % _STEP == 0:
            step(min(number / max(count, number + _STEP), 1.0))
        # what begins with # would be a comment
        first = f'"{row[0]}"' if row and row[0].startswith(("#", "!", "%", ">", "//")) else "".join(row[:1])
        lines.append("\t".join([first, *row[1:]]).rstrip("\t"))
    return "\n".join([*lines, ""]).encode()
