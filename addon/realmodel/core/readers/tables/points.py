# SPDX-License-Identifier: GPL-3.0-or-later
"""Scattered points from tables of text, CSV and similar formats with or without a header, and from arrays
of NumPy."""

from __future__ import annotations

import os
import re
import tokenize
import warnings
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from ...base.errors import InputRefused, number_list
from ...base.mapped_arrays import JoinPieces, in_memory, in_pieces
from ...base.no_value import NO_VALUE
from ...base.text import BOM, Content, FileBytes, Step, encoding_of, no_step, pieces_of, text_content
from ...base.units import unit_of, unit_text_of_column
from ...base.work import NativeError, native_module, on_threads
from ...settings.data_files import PointFile, list_of
from ..objects.geo_object import STICK
from .dialects import DIALECTS
from .dialects.workbook import begins_as_workbook, sheet_text
from .table_layout import (
    Expected,
    TableLayout,
    column_number,
    decimal_comma,
    is_any_number,
    is_number,
    names_shown,
    plain_name,
    table_layout,
    with_whole_rows,
)

_MOST_THREADS = 8
_GROUPED = r"[+-]?(\d{{1,3}}(?:{0}\d{{3}})+)({1}\d*)?"  # by a sign between thousands, and a decimal mark
_NO_ROW = re.compile(rb"\s*(?:[#!%>]|//|$)")
# Parts of numbers that are written otherwise: exponents of Fortran, and the minus sign that is no hyphen.
_UNUSUAL = (
    (re.compile(rb"((?<![\w.])[+-]?\d*\.\d*)[dD](?=[+-]?\d{1,3}(?![\w.]))"), rb"\1e"),
    (re.compile(rb"\xe2\x88\x92(?=[\d.])"), b"-"),
)
_OF_EMPTY_ROWS = b" \t\r\n,;|"
_TAIL = 4096
_JOINED = 1 << 24  # bytes: in longer tables texts do not go on in further lines
_BEGINS_LINE = b"#->"  # of CPS-3, as a comment
_SAY_COLUMNS = 'set columns = ["X", "Y", "Z"]'
# Names of coordinates, and what may stand before or behind them.
_WORDS = {
    "x": (
        *("x", "easting", "eastings", "east", "rechtswert", "ostwert", "este", "abscisse", "abscissa"),
        *("xcoord", "x_wert", "oost", "ost", "est", "e"),
    ),
    "y": (
        *("y", "northing", "northings", "north", "hochwert", "nordwert", "norte", "ordonnée", "ordonnee"),
        *("ordinate", "ycoord", "y_wert", "noord", "nord", "n"),
    ),
    "z": (
        *("z", "elevation", "elev", "altitude", "height", "rl", "höhe", "hoehe", "hoogte", "cota", "kote"),
        *("quota", "altura", "elevación", "elevacion", "élévation", "maaiveld", "zcoord", "z_wert", "alt"),
        *("reduced_level", "groundlevel", "ground_level", "hauteur", "nivel", "h"),
    ),
}
_BESIDE = (
    *("utm", "mga", "lv95", "gk", "map", "grid", "coord", "coordinate", "rd", "coordinates", "coords"),
    *("point", "pos", "position", "koordinate", "koord", "coordonnée", "coordonnee", "coordenada"),
    *("coordinaat", "world", "local", "projected", "nat_grid", "value", "utme", "utmn", "nap", "nn"),
    *("nhn", "asl", "amsl", "msl", "wert", "l93", "loc", "location", "pt", "c", "cen", "center", "centre"),
    *("centroid", "mid"),
)
_DEPTHS = (
    *("depth", "tvdss", "tvd", "sstvd", "z_depth", "depth_z", "tiefe", "teufe", "diepte", "profondeur"),
    *("profundidad", "profundidade", "true_vertical_depth", "subsea_depth", "depth_subsea"),
)
_SYSTEM = re.compile(
    r"(?:utm|mga|lv|gda|epsg|zone|l|gk|cc|rt|osgb|ch|etrs|wgs|nad|nzgd|sweref|dhdn|ed|itrf)?\d+[a-z]{0,2}"
    r"|lambert|dhdn|osgb|bng|nztm|amersfoort|stereo\d*|swissgrid|gauss|krueger|krüger|tm"
)


def _names_of(axis: str) -> tuple[str, ...]:
    """The words of an axis, and these with what may stand beside them."""
    names = list(_WORDS[axis])
    for word in _WORDS[axis]:
        # N_value is another thing
        beside = _BESIDE[:9] if word in ("e", "n") else (*_BESIDE, *(_DEPTHS if word == "z" else ()))
        names += [form.format(word, other) for other in beside for form in ("{1}_{0}", "{0}_{1}")]
        if word in "xyz":
            names += [f"{other}{word}" for other in beside] + [f"{word}{other}" for other in beside]
    return tuple(names)


AXES = {axis: _names_of(axis) for axis in _WORDS}
# Columns that are no coordinates, whose places in a table say nothing: numbers of rows and cells, depths and
# directions of holes.
_NO_COORDINATES = frozenset(
    (
        *(
            "",
            "id",
            "no",
            "nr",
            "index",
            "i",
            "j",
            "k",
            "ijk",
            "ix",
            "iy",
            "iz",
            "row",
            "column",
            "md",
            "dept",
        ),
        *("measured_depth", "inc", "incl", "inclination", "azi", "azim", "azimuth", "dip", "from", "to"),
    )
)
# Columns with the elevations of one surface each.
_OF_SURFACE = re.compile(
    r"(?i:top|base|bottom|btm|bot|roof|floor|surface|surf|horizon|elev|elevation|z|dach|toit|techo|tetto)"
    r"(?:[\s_.-]|(?=[A-Z\d]))|.*[\s_.-](?i:top|base|bottom|btm|bot|roof|floor|elev|elevation|z)$"
)
_MOST_UNNAMED = 30  # columns of a table of points without a header
# As GDAL writes a table of shapes.
_WKT_FIRST = re.compile(rb'(?:\xef\xbb\xbf)?"?WKT"?\s*[,;\t\r\n]', re.IGNORECASE)
# Taken where no column has one of those names, with a warning.
_DEGREES = {
    "x": ("lon", "long", "longitude", "longitud", "länge", "lng"),
    "y": ("lat", "latitude", "latitud", "breite"),
}
_NAMES = {axis: (*AXES[axis], *_DEGREES.get(axis, ()), *(_DEPTHS if axis == "z" else ())) for axis in AXES}
KNOWN = frozenset(name for names in _NAMES.values() for name in names)


@dataclass(frozen=True)
class PointRows:
    """points (P, 3) float64 in the order of the file; how many rows had no value, and how many did not
    hold what was requested. table: that they are from. axes: the numbers from 0 of its columns of x, y and
    z. columns: the names of these, where the header has them; units: the texts of the file that name their
    units, "" for none. decimal: the mark of numbers. doubts: sentences about columns whose choice was a
    guess."""

    points: np.ndarray
    table: TextTable
    axes: Sequence[int]
    decimal: str = "."
    missing: int = 0
    filtered: int = 0
    columns: tuple[str, ...] = ()
    units: tuple[str, ...] = ("", "", "")
    doubts: tuple[str, ...] = ()


def read_point_rows(given: PointFile, step: Step = no_step, gather: JoinPieces = in_memory) -> PointRows:
    """The points of a table of text, read piece by piece.

    By default the separator (semicolon, tab, comma, bar or blanks) is detected from the first line of
    numbers. Earlier lines without numbers are headers; the columns named x, y and z, or easting, northing and
    elevation (any case, a unit in brackets behind it) are read, otherwise the first three. Decimal commas are
    detected where commas are not the separator and cannot separate thousands. '#' begins a comment. Further
    columns are ignored. step(fraction) is called every few milliseconds; its exceptions pass through.

    Raises InputRefused naming file and line.
    """
    if given.columns is None and _WKT_FIRST.match(FileBytes(Path(given.file))[:100]):
        advice = "export columns X, Y and Z (ogr2ogr -lco GEOMETRY=AS_XYZ), or a GeoPackage"
        raise InputRefused("its places are well-known text in a column", file=Path(given.file), advice=advice)
    table = table_of(given, step=step)
    wanted = wanted_columns(table, given.columns)
    rows = _read_rows(table, given, wanted, step, gather)
    if len(rows.points):
        doubts = () if given.columns is not None else _doubts(table, wanted, rows.points[:, 2], given.z_axis)
        names = table.layout.names or ()
        named = tuple(names[column] for column in wanted) if max(wanted) < len(names) else ()
        of_names = [unit_text_of_column(name) for name in named] or [""] * 3
        plan, height = table.layout.units
        units = tuple(of_name or said for of_name, said in zip(of_names, (plan, plan, height), strict=True))
        return replace(rows, columns=named, units=units, doubts=doubts)
    if rows.filtered:
        raise _nothing_matches(table, given.where)
    if rows.missing:
        raise InputRefused("none of its points has a value", file=table.file)
    advice = "a row of points has three numbers at least, x, y and z"
    raise InputRefused("there are no points in it", file=table.file, advice=advice)


def table_of(given: PointFile, *wanted: str | int, step: Step = no_step) -> TextTable:
    """The open table of a file of points. wanted: further columns. Raises InputRefused."""
    columns = (*(given.columns or ()), *wanted, *given.where)
    return open_table(Path(given.file), Expected(given.separator, columns, KNOWN), given.layer, step)


def _has_columns(expected: Expected, cells: list[str]) -> bool:
    """Whether the cells of a row are the names of the columns that are expected: those requested, or else as
    many as are needed."""
    names = [name.lower() for name in expected.wanted if isinstance(name, str)]
    if names:
        return set(names) <= {cell.lower() for cell in cells}
    return sum(_plain(cell) in expected.known for cell in cells) >= expected.columns


@dataclass(frozen=True)
class TextTable:
    """An open table of text: its content and its layout."""

    file: Path
    raw: Content
    encoding: str
    layout: TableLayout

    def column(self, name: str | int) -> int:
        return column_number(self.file, self.layout, name)


def open_table(file: Path, expected: Expected, sheet: str | None = None, step: Step = no_step) -> TextTable:
    """A table of text, or the sheet of a workbook: by its name, or else the only one with the columns that
    are expected. Raises InputRefused where there are no rows."""
    raw: Content
    if begins_as_workbook(FileBytes(file)[:100]):
        raw = sheet_text(file, sheet, expected.is_header or partial(_has_columns, expected), step)
        expected = replace(expected, separator="\t")
    else:
        raw = text_content(file)
    dialect = next((entry for entry in DIALECTS if entry.begins(raw[:4096], len(raw))), None)
    if dialect is not None and dialect.not_rows is not None:
        raw = dialect.not_rows.sub(b"#", raw[:])
    raw = _without_empty_end(raw)
    if len(raw) <= _JOINED:
        raw = with_whole_rows(raw)
    for unusual, sign in _UNUSUAL:
        if unusual.search(raw[:4096]):
            raw = unusual.sub(sign, raw[:])
    start = len(BOM) if raw[: len(BOM)] == BOM else 0
    encoding = encoding_of(raw)
    return TextTable(file, raw, encoding, table_layout(file, raw, start, encoding, expected, dialect))


def _without_empty_end(raw: Content) -> Content:
    """A table without rows at its end that have no entries, as Excel writes them."""
    tail = raw[-_TAIL:]
    _, _, empty = tail[len(tail.rstrip(_OF_EMPTY_ROWS)) :].partition(b"\n")
    return raw[: len(raw) - len(empty)] if empty.strip() else raw


def _plain(name: str) -> str:
    """The name of a column, for comparing, without those of coordinate systems."""
    words = re.split(r"[\s_.-]+", plain_name(name))
    return "_".join([word for word in words if not _SYSTEM.fullmatch(word)] or words)


def _named(table: TextTable) -> list[str]:
    """The names of the columns, for comparing."""
    return [_plain(name) for name in table.layout.names or ()]


def wanted_columns(table: TextTable, columns: Sequence[str | int] | None) -> list[int]:
    """The numbers from 0 of the columns of x, y and z. Raises InputRefused."""
    if columns is not None:
        return [table.column(column) for column in columns]
    names = _named(table)
    headings = {
        axis: next((alias for alias in aliases if alias in names), None) for axis, aliases in _NAMES.items()
    }
    if not any(headings.values()):
        _require_xyz_first(table)
        return [0, 1, 2]
    for axis, alias in headings.items():
        count = names.count(alias) if alias else 0
        if count != 1:
            said = f"{count} columns named {alias}" if count else f"no column {axis}"
            written = table.layout.names or ()
            x, y, _ = (written[names.index(name)] if name else None for name in headings.values())
            raise _without_axis(table, f"the header has {said}", x or "X", y or "Y")
    _require_names_of_entries(table)
    return [names.index(alias) for alias in headings.values() if alias]


def _without_axis(table: TextTable, what: str, x: str = "X", y: str = "Y") -> InputRefused:
    """The error that a header does not name x, y and z. x, y: the columns of the advice."""
    names = table.layout.names or ()
    of_surfaces = [name for name in names if _OF_SURFACE.match(name)] if {x, y} <= set(names) else []
    columns = ", ".join(f'"{name}"' for name in (x, y, *(of_surfaces or ["Z"])[:1]))
    advice = f"name the columns x, y and z, or set columns = [{columns}]"
    if len(of_surfaces) > 1:
        advice = f"each column of elevations is a surface of its own: set columns = [{columns}], "
        advice += f"and so on with {names_shown(of_surfaces[1:])}"
    what += f"; it has {names_shown(names)}" if names else ""
    return InputRefused(what, file=table.file, line=table.layout.name_line, advice=advice)


def _require_names_of_entries(table: TextTable) -> None:
    """Refuses a header whose names are plainly not those of the entries: more of them, some with blanks in
    them, or one less where the first entries count the rows."""
    names, rows = table.layout.names or (), head_rows(table, 1000)
    width = max(map(len, rows), default=0)
    counts = len(rows) > 1 and _count_rows([row[0] for row in rows])
    if (table.layout.separator == " " and 0 < width < len(names)) or (width > len(names) and counts):
        what = f"the header has {len(names)} names, and the rows have {width} entries"
        advice = "say by numbers which columns are x, y and z: columns = [1, 2, 3]"
        raise InputRefused(what, file=table.file, line=table.layout.name_line, advice=advice)


def _count_rows(entries: list[str]) -> bool:
    """Whether entries are 0, 1, 2, ... or 1, 2, 3, ..."""
    return any(entries == [str(n) for n in range(first, first + len(entries))] for first in (0, 1))


def _require_xyz_first(table: TextTable) -> None:
    """Refuses a table whose header names no coordinates and whose first columns count rows, or are as likely
    indices of a grid."""
    names, first = table.layout.names or (), next(iter(head_rows(table, 9)), [])
    if names and not all(map(is_any_number, first[:3])):
        raise _without_axis(table, "no column is named x, y or z")
    if any(name in _NO_COORDINATES or unit_of(name) for name in map(plain_name, names[:3])):
        raise _without_axis(table, "no column is named x, y or z, and the first three are no coordinates")
    rows = [row for row in head_rows(table, 1000) if all(map(is_number, row[:3]))]
    if len(rows) < 2 or min(map(len, rows)) < 4:
        return
    if not names and min(map(len, rows)) > _MOST_UNNAMED:
        what = f"no header names its {len(rows[0])} columns, as many as a grid of values has"
        advice = "save the grid with its place, as an ESRI ASCII grid or x, y, z; or set columns = [1, 2, 3]"
        raise InputRefused(what, file=table.file, advice=advice)
    whole = all(float(entry) % 1 == 0 for row in rows for entry in row[:2])
    what = ""
    if _count_rows([row[0] for row in rows]):
        what = "its first column counts the rows"
    elif {len(row) for row in rows} == {5} and whole:
        what = "its first two columns are whole numbers, coordinates or the indices of a grid"
    if what:
        columns = [2, 3, 4] if "counts" in what else [3, 4, 5]
        advice = f"say which columns are x, y and z: columns = {columns} or columns = [1, 2, 3]"
        raise InputRefused(f"{what}, and no header names x, y and z", file=table.file, advice=advice)


def _doubts(table: TextTable, wanted: Sequence[int], z: np.ndarray, z_axis: str) -> tuple[str, ...]:
    """Sentences about columns that were guessed, or that are read differently from their names."""
    names, called = table.layout.names or (), _named(table)
    doubts = []
    row = next(iter(head_rows(table, 9)), [])
    width = next((n for n, entry in enumerate(row) if entry.startswith("#")), len(row))
    if not KNOWN.isdisjoint(called):
        for axis, column in zip("xyz", wanted, strict=True):
            likely = (n for n, name in enumerate(called) if name in AXES[axis] and len(name) > 1)
            same = [names[n] for n in sorted({column, *likely})]
            if len(same) > 1:
                listed = number_list([f"'{name}'" for name in same])
                doubts.append(f"{listed} may be {axis}, and '{names[column]}' is used: {_SAY_COLUMNS}")
        if {called[wanted[0]], called[wanted[1]]} & {*_DEGREES["x"], *_DEGREES["y"]}:
            doubts.append(
                f"'{names[wanted[0]]}' and '{names[wanted[1]]}' are degrees of longitude and latitude, "
                "elevations are not: project them (to UTM, say) in a GIS, or name others by 'columns'"
            )
        words = re.findall(r"[^\W\d_]+", names[wanted[2]].lower())
        if z_axis == "up" and not set(words).isdisjoint(_DEPTHS):
            doubts.append(
                f"'{names[wanted[2]]}' is read as elevations, upward: if it has depths, set z_axis = \"down\""
            )
        if width > len(names) and is_number(row[-1]):
            doubts.append(
                f"the header has {len(names)} names, the rows have {width} entries: the first are taken for "
                "those; if that is wrong, set columns = [1, 2, 3] with their numbers"
            )
    elif len(names) == width > 2 and not any(map(is_number, names)):
        listed = ", ".join(f"'{name}'" for name in names[:3])
        doubts.append(
            f"no column is named x, y or z: the first three, {listed}, are used; if that is wrong, "
            f"{_SAY_COLUMNS}"
        )
    elif width > max(3, len(names)):
        doubts.append(
            f"no header names its {width} columns: the first three are used as x, y and z; if that is "
            "wrong, set columns = [1, 2, 3] with their numbers"
        )
    return tuple(doubts)


def _values(values: Sequence, encoding: str) -> tuple[list[float], list[bytes]]:
    """The values that native code compares entries with: numbers as numbers, text as in the file."""
    numbers = [float(value) for value in values if not isinstance(value, str)]
    return numbers, [value.strip().encode(encoding, "replace") for value in values if isinstance(value, str)]


def _filters(table: TextTable, point_file: PointFile) -> tuple[list, tuple]:
    """What native code keeps rows by, and which entries mean no value."""
    filters = [
        (table.column(name), _values(list_of(value), table.encoding))
        for name, value in point_file.where.items()
    ]
    return filters, _values(point_file.nodata_values, table.encoding)


def _read_rows(
    table: TextTable, point_file: PointFile, columns: Sequence[int], step: Step, gather: JoinPieces
) -> PointRows:
    """The points of a table. columns: of x, y and z."""
    native = native_module()
    filters, missing = _filters(table, point_file)
    mark = point_file.decimal or "."
    if point_file.decimal is None:
        numeric = [column for column, (numbers, _) in filters if numbers]
        if decimal_comma(_head_entries(table, [*columns, *numeric])):
            mark = ","
    while True:
        try:
            return _pieces(table, (mark, columns, filters, missing), step, gather)
        except native.InputError as error:
            is_no_number = error.kind == "not_a_number"
            # a surface that is not there has no entry
            if is_no_number and error.items[1] == 2 and b"" not in missing[1] and not _entry(table, error):
                missing[1].append(b"")
                continue
            plain = _without_thousands(table, columns, point_file.decimal)
            if error.kind == "not_a_number" and plain is not None:
                table, mark = plain
                continue
            if (
                point_file.decimal is None
                and mark == "."
                and error.kind == "not_a_number"
                and _has_decimal_commas(table, columns, error)
            ):
                mark = ","
                continue
            raise _refused(table, columns, mark, error) from error


def _pieces(
    table: TextTable, reading: tuple[str, Sequence[int], list, tuple], step: Step, gather: JoinPieces
) -> PointRows:
    """native.read_numbers over the whole table, piece by piece on all processors; its errors are relative to
    the beginning of the file. reading: its decimal mark, columns, filters and missing values."""
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
    return PointRows(points, table, columns, mark, missing=int(counts[1]), filtered=int(counts[0]))


def other_columns(given: PointFile, rows: PointRows) -> dict[str, np.ndarray]:
    """(P,) the values of each further column, by its name, or by its number from 1 where it has none: numbers
    (NaN where there is none), or texts if not all are numbers."""
    table, mark = rows.table, rows.decimal
    has_lines = table.raw.find(_BEGINS_LINE, table.layout.body) >= 0
    if (
        not has_lines
        and max(map(len, head_rows(table, 2000)), default=0) <= 3
        and len(table.layout.names or ()) <= 3
    ):
        return {}
    filters, missing = _filters(table, given)
    missing[1].append(b"")  # as _read_rows does where it is needed
    separator = table.layout.separator
    lines = table.raw[table.layout.body :].split(b"\n")
    # which rows are points: each gets its number before it, as one that is no value in any file
    numbered = (
        b"" if _NO_ROW.match(line) else b"%de200%b%b" % (n, separator.encode(), line)
        for n, line in enumerate(lines, 1)
    )
    columns = [0, *(column + 1 for column in rows.axes)]
    shifted = [(column + 1, values) for column, values in filters]
    numbers = native_module().read_numbers(
        b"\n".join(numbered), (separator, mark), columns, shifted, missing
    )[0][:, 0]
    at = np.rint(numbers / 1e200).astype(np.int64) - 1
    texts = [lines[n].decode(table.encoding) for n in at.tolist()]
    entries = [table.layout.fields(text) for text in texts]
    width = max(map(len, entries), default=0)
    names = [*(table.layout.names or ()), *[""] * width]
    by_name: dict[str, np.ndarray] = {}
    if has_lines:
        by_name[STICK] = np.cumsum([line.startswith(_BEGINS_LINE) for line in lines])[at] + 1.0
    for column in sorted(set(range(width)) - set(rows.axes)):
        name = names[column] if names[column] not in ("", *by_name) else str(column + 1)
        values = [row[column] if column < len(row) else "" for row in entries]
        by_name[name] = _column_values(values, mark, table.layout.nodata)
    return by_name


def _column_values(entries: list[str], mark: str, nodata: float | None) -> np.ndarray:
    """(N,) float64, or texts where an entry is neither a number nor a word for no value."""
    has_value = [entry.lower() not in NO_VALUE for entry in entries]
    if not all(is_number(entry, mark) for entry, known in zip(entries, has_value, strict=True) if known):
        return np.array(entries, str)
    numbers = [
        float(entry.replace(",", ".")) if known else np.nan
        for entry, known in zip(entries, has_value, strict=True)
    ]
    values = np.array(numbers, np.float64)
    values[values == nodata] = np.nan
    return values


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
    lines = (line for line in body.split("\n")[:most] if not _NO_ROW.match(line.encode()))
    return [table.layout.fields(line) for line in lines]


def body_rows(table: TextTable) -> Iterator[list[str]]:
    """The entries of each row of a table that is not blank."""
    body = table.raw[table.layout.body :]
    lines = (line for line in body.split(b"\n") if not _NO_ROW.match(line))
    return (table.layout.fields(line.decode(table.encoding, "replace").strip("\r")) for line in lines)


def _without_thousands(
    table: TextTable, columns: Sequence[int], decimal: str | None
) -> tuple[TextTable, str] | None:
    """The table without separators of thousands, and its decimal mark, where its numbers can be read in
    one way only: 451,234.5 or 5.932.425; else None."""
    entries = [entry for entry in _head_entries(table, columns) if entry]
    ways = []
    for mark in ".,":
        for sign in (",", ".", "'", "’", " ", "\xa0", "\u202f"):
            grouped = re.compile(_GROUPED.format(re.escape(sign), re.escape(mark)))
            in_groups = [match for match in map(grouped.fullmatch, entries) if match]
            others = len(entries) - len(in_groups)
            is_sure = sign not in ",." or any(match[1].count(sign) > 1 or match[2] for match in in_groups)
            if sign == mark or not in_groups or not is_sure or decimal not in (None, mark):
                continue
            if others == sum(is_number(entry, mark) and not grouped.fullmatch(entry) for entry in entries):
                ways.append((sign, mark))
    if len(ways) != 1:
        return None
    (sign, mark), encoding = ways[0], table.encoding
    between = re.compile(rb"(?<=\d)%b(?=\d{3}(?!\d))" % re.escape(sign.encode(encoding)))
    body = table.raw[table.layout.body :]
    if sign == table.layout.separator:  # within quotes alone
        body = re.sub(rb'"[^"\n]*"', lambda match: between.sub(b"", match[0]), body)
    else:
        body = between.sub(b"", body)
    return replace(table, raw=table.raw[: table.layout.body] + body), mark


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
    elif not table.layout.names and not entry[:1].isdigit():
        advice = "say which columns are x, y and z: columns = [2, 3, 4]"
    if entry.lower() in NO_VALUE:
        advice = f'remove points without a value, or set nodata = "{entry}"'
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
        raise InputRefused("no point of the array has an elevation", file=file)
    return points
