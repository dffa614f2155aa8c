# SPDX-License-Identifier: GPL-3.0-or-later
"""Scattered points from tables of text, CSV and similar formats with or without a header, and from arrays
of NumPy."""

from __future__ import annotations

import os
import tokenize
import warnings
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from ...base.errors import InputRefused, number_list
from ...base.mapped_arrays import JoinPieces, in_memory, in_pieces
from ...base.text import BOM, Content, Step, encoding_of, no_step, pieces_of, text_content
from ...base.work import NativeError, native_module, on_threads
from ...settings.data_files import PointFile, list_of
from .table_layout import (
    Expected,
    TableLayout,
    column_number,
    decimal_comma,
    fields,
    is_number,
    names_shown,
    plain_name,
    table_layout,
)

_MOST_THREADS = 8
AXES = {
    "x": (
        *("x", "easting", "east", "x_coord", "xcoord", "coord_x", "utm_x", "x_utm", "point_x"),
        *("rechtswert", "este"),
    ),
    "y": (
        *("y", "northing", "north", "y_coord", "ycoord", "coord_y", "utm_y", "y_utm", "point_y"),
        *("hochwert", "norte"),
    ),
    "z": (
        *("z", "elevation", "elev", "altitude", "height", "z_coord", "zcoord", "coord_z", "point_z"),
        *("höhe", "hoehe", "cota", "rl"),
    ),
}
KNOWN = frozenset(name for names in AXES.values() for name in names)


@dataclass(frozen=True)
class PointRows:
    """points (P, 3) float64 in the order of the file; how many rows had no value, and how many did not
    hold what was asked for; the names of the columns that were taken for x, y and z although they say
    nothing of the kind. columns: the names of x, y and z in the header, where there is one."""

    points: np.ndarray
    missing: int = 0
    filtered: int = 0
    taken_for_xyz: tuple[str, ...] = ()
    columns: tuple[str, ...] = ()


def read_points(file: str | Path, step: Step = no_step) -> np.ndarray:
    """(P, 3) float64 points of a table of text: read_point_rows with default options."""
    return read_point_rows(PointFile(file), step).points


def read_point_rows(given: PointFile, step: Step = no_step, gather: JoinPieces = in_memory) -> PointRows:
    """The points of a table of text, read piece by piece.

    By default the separator (semicolon, tab, comma, bar or blanks) is detected from the first line of
    numbers. Earlier lines without numbers are headers; the columns named x, y and z, or easting, northing and
    elevation (any case, a unit in brackets behind it) are read, otherwise the first three. Decimal commas are
    detected where commas are not the separator and cannot separate thousands. '#' begins a comment. Further
    columns are ignored. step(fraction) is called every few milliseconds; its exceptions pass through.

    Raises InputRefused naming file and line.
    """
    file = Path(given.file)
    table = open_table(file, Expected(given.separator, (*(given.columns or ()), *given.where), KNOWN))
    wanted = wanted_columns(table, given.columns)
    rows = _read_rows(table, given, wanted, step, gather)
    if len(rows.points):
        guessed = () if given.columns is not None else _guessed_names(table)
        names = table.layout.names or ()
        named = tuple(names[column] for column in wanted) if max(wanted) < len(names) else ()
        return replace(rows, taken_for_xyz=guessed, columns=named)
    if rows.filtered:
        raise _nothing_matches(table, given.where)
    what = "none of its points has a value" if rows.missing else "there are no points in it"
    raise InputRefused(what, file=file)


@dataclass(frozen=True)
class TextTable:
    """An open table of text: its content and its layout."""

    file: Path
    raw: Content
    encoding: str
    layout: TableLayout

    def column(self, name: str | int) -> int:
        return column_number(self.file, self.layout, name)


def open_table(file: Path, expected: Expected) -> TextTable:
    """A table of text. Raises InputRefused where there are no rows."""
    raw = text_content(file)
    start = len(BOM) if raw[: len(BOM)] == BOM else 0
    encoding = encoding_of(raw)
    return TextTable(file, raw, encoding, table_layout(file, raw, start, encoding, expected))


def wanted_columns(table: TextTable, columns: Sequence[str | int] | None) -> list[int]:
    """The numbers from 0 of the columns of x, y and z. Raises InputRefused."""
    if columns is not None:
        return [table.column(column) for column in columns]
    names = [plain_name(name) for name in table.layout.names or ()]
    headings = {
        axis: next((alias for alias in aliases if alias in names), None) for axis, aliases in AXES.items()
    }
    if not any(headings.values()):
        return [0, 1, 2]
    for axis, alias in headings.items():
        count = names.count(alias) if alias else 0
        if count != 1:
            said = f"{count} columns named {alias}" if count else f"no column {axis}"
            advice = 'name the columns x, y and z, or set columns = ["X", "Y", "Z"]'
            raise InputRefused(
                f"the header has {said}", file=table.file, line=table.layout.name_line, advice=advice
            )
    return [names.index(alias) for alias in headings.values() if alias]


def _guessed_names(table: TextTable) -> tuple[str, ...]:
    """The names of the first three columns where the header names the columns of the table, and none of them
    as a coordinate."""
    names = table.layout.names or ()
    first_row = head_rows(table, 1)
    if len(names) < 3 or not first_row or len(names) != len(first_row[0]):
        return ()
    if KNOWN.intersection(plain_name(name) for name in names) or any(is_number(name) for name in names):
        return ()
    return tuple(names[:3])


def _values(values: Sequence, encoding: str) -> tuple[list[float], list[bytes]]:
    """The values that native code compares entries with: numbers as numbers, text as in the file."""
    numbers = [float(value) for value in values if not isinstance(value, str)]
    return numbers, [value.strip().encode(encoding, "replace") for value in values if isinstance(value, str)]


def _read_rows(
    table: TextTable, point_file: PointFile, columns: Sequence[int], step: Step, gather: JoinPieces
) -> PointRows:
    """The points of a table. columns: of x, y and z."""
    native = native_module()
    filters = [
        (table.column(name), _values(list_of(value), table.encoding))
        for name, value in point_file.where.items()
    ]
    missing = _values(point_file.nodata_values, table.encoding)
    mark = point_file.decimal or "."
    if point_file.decimal is None and table.layout.separator != ",":
        numeric = [column for column, (numbers, _) in filters if numbers]
        if decimal_comma(_head_entries(table, [*columns, *numeric])):
            mark = ","
    while True:
        try:
            return _pieces(table, (mark, columns, filters, missing), step, gather)
        except native.InputError as error:
            undecided = point_file.decimal is None and mark == "." and table.layout.separator != ","
            if undecided and error.kind == "not_a_number" and _has_decimal_commas(table, columns, error):
                mark = ","
                continue
            raise _refused(table, columns, mark, error) from error


def _pieces(
    table: TextTable, reading: tuple[str, Sequence[int], list, tuple], step: Step, gather: JoinPieces
) -> PointRows:
    """native.read_numbers over the whole table, piece by piece on all processors; its errors count from the
    beginning of the file. reading: its decimal mark, columns, filters and missing values."""
    native = native_module()
    mark, columns, filters, missing = reading
    begin, line, counts = table.layout.body, table.layout.body_line, np.zeros(2, np.int64)

    def read(piece: bytes) -> Any:
        return native.read_numbers(
            piece, (table.layout.separator, mark), columns, filters, missing, on_threads(1)
        )

    def numbers() -> Iterator[np.ndarray]:
        nonlocal begin, line, counts
        for end, future in _in_order(pool, read, pieces_of(table.raw, begin), 2 * threads):
            values, lines, filtered, without = future.result()
            counts += filtered, without
            begin, line = end, line + lines
            yield values
            step(end / len(table.raw))

    threads = min(os.cpu_count() or 1, _MOST_THREADS)
    pool = ThreadPoolExecutor(threads, "realmodel reading")
    try:
        points = gather(numbers(), np.empty((0, 3)))
    except native.InputError as error:
        error.items = [error.items[0] + line, *error.items[1:2], *(byte + begin for byte in error.items[2:])]
        raise
    finally:
        pool.shutdown(cancel_futures=True)
    return PointRows(points, missing=int(counts[1]), filtered=int(counts[0]))


def _in_order(
    pool: Executor, function: Callable, pieces: Iterable[tuple[int, bytes]], most: int
) -> Iterator[tuple[int, Future]]:
    """For each piece its end and its result of the function, in order; at most this many are processed at a
    time."""
    waiting: deque[tuple[int, Future]] = deque()
    for begin, piece in pieces:
        waiting.append((begin + len(piece), pool.submit(function, piece)))
        if len(waiting) > most:
            yield waiting.popleft()
    while waiting:
        yield waiting.popleft()


def _head_entries(table: TextTable, columns: Sequence[int], most: int = 2000) -> list[str]:
    """The entries of some columns in the first rows."""
    return [row[column] for row in head_rows(table, most) for column in columns if column < len(row)]


def head_rows(table: TextTable, most: int) -> list[list[str]]:
    """The entries of the first rows of a table."""
    body = table.raw[table.layout.body : table.layout.body + (1 << 18)].decode(table.encoding, "replace")
    return [fields(line, table.layout.separator) for line in body.split("\n")[:most] if line.strip()]


def body_rows(table: TextTable) -> Iterator[list[str]]:
    """The entries of each row of a table that is not blank."""
    body = table.raw[table.layout.body :].decode(table.encoding, "replace")
    return (table.layout.fields(line) for line in body.splitlines() if line.strip())


def _has_decimal_commas(table: TextTable, columns: Sequence[int], error: NativeError) -> bool:
    entry = _entry(table, error)
    if "," not in entry:
        return False
    others = _head_entries(table, columns)
    is_comma = decimal_comma([*others, entry])
    if is_comma is None and is_number(entry, ",") and not any("." in other for other in others):
        raise InputRefused(
            f"'{entry}' may have a decimal comma or a thousands separator",
            file=table.file,
            line=error.items[0],
            advice='set decimal = "," for decimal commas, or remove the separators',
        )
    return bool(is_comma)


def _entry(table: TextTable, error: NativeError) -> str:
    begin, end = error.items[2:4]
    return table.raw[begin:end].decode(table.encoding, "replace").strip()


def _refused(table: TextTable, columns: Sequence[int], decimal: str, error: NativeError) -> InputRefused:
    line = error.items[0]
    if error.kind == "too_few":
        needed = max(columns) + 1
        return InputRefused(
            f"{needed} values are needed, there are {error.items[1]}", file=table.file, line=line
        )
    name, entry = "xyz"[error.items[1]], _entry(table, error)
    if error.kind == "not_finite":
        return InputRefused(
            f"{name} is {entry}, not a finite number",
            file=table.file,
            line=line,
            advice="remove points without a value, or set nodata = nan",
        )
    if error.kind == "too_large":
        return InputRefused("a number is too large", file=table.file, line=line)
    advice: str | None = None
    if decimal == "." and "," in entry:
        advice = "write decimals with a point"
    elif decimal == "," and "." in entry:
        advice = "this file has decimal commas: use them in all numbers"
    elif not entry:
        advice = 'remove points without a value, or set nodata = ""'
    return InputRefused(f"{name} is not a number: '{entry:.40}'", file=table.file, line=line, advice=advice)


def _nothing_matches(table: TextTable, where: Mapping) -> InputRefused:
    """The error that no row matches `where`; it lists the values that there are."""
    conditions = ", ".join(f"{name} = {value!r}" for name, value in where.items())
    contents = []
    for name in where:
        seen = dict.fromkeys(_head_entries(table, [table.column(name)], 100_000))
        contents.append(f"{name} has {names_shown(list(seen))}")
    return InputRefused(
        f"no row has {conditions}", file=table.file, advice=f"among the first rows {number_list(contents)}"
    )


# Errors that NumPy raises for a damaged header, which it parses as Python.
_DAMAGED_ARRAY = (
    *(ValueError, OSError, EOFError, SyntaxError, TypeError),
    *(tokenize.TokenError, OverflowError, MemoryError, RecursionError),
)


def begins_as_array(head: bytes, _size: int = 0) -> bool:
    """Whether a file that begins so is an array of NumPy."""
    return head.startswith(b"\x93NUMPY")


def read_point_array(file: Path, gather: JoinPieces) -> np.ndarray:
    """(P, 3) float64 of an array of NumPy, rows without a height left out. Raises InputRefused."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of headers that Python 2 wrote; they are read right
            array = np.load(file, mmap_mode="r", allow_pickle=False)
    except _DAMAGED_ARRAY as error:
        raise InputRefused(f"a damaged array: {error}", file=file) from error
    if array.ndim != 2 or array.shape[1] != 3 or array.dtype.kind not in "iuf":
        what = f"an array of shape {array.shape} of {array.dtype} is not one of points (x, y, z in a row)"
        raise InputRefused(what, file=file)

    def known() -> Iterator[np.ndarray]:
        for piece in in_pieces(array):
            points = np.array(piece, np.float64)
            if not np.isfinite(points[:, :2]).all():
                raise InputRefused("a place in plan is not finite", file=file)
            yield points[np.isfinite(points[:, 2])]

    points = gather(known(), np.empty((0, 3)))
    if not len(points):
        raise InputRefused("no point of the array has a height", file=file)
    return points
