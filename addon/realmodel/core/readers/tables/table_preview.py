# SPDX-License-Identifier: GPL-3.0-or-later
"""A preview of a table of points, before it is read."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from ...base.errors import InputRefused
from .hole_tables import may_name_units
from .points import AXES, KNOWN, TextTable, head_rows, open_table, wanted_columns
from .table_layout import Expected, is_any_number, plain_name

_ROWS = 3
_PIECES, _PIECE = 64, 1 << 16  # of a long table these are examined, in equal distances
_LEAST, _MOST = 2, 50  # values of a column that names surfaces
_NAMING = frozenset(
    ("horizon", "formation", "surface", "unit", "marker", "layer", "top", "strat", "stratum", "lithology")
)


@dataclass
class TablePreview:
    """names: of the columns; their numbers from 1 without a header (has_header). rows: the first of them, as
    they are written. axes: the columns that are taken for x, y and z; only those that are known where the
    header does not name all. splits: {column: its values in the order of the file}, of columns that may name
    surfaces; those that plainly do come first. is_plain: whether the first does. problem: why the table
    cannot be read. sheet: of a workbook that has several."""

    file: Path
    names: list[str]
    rows: list[list[str]]
    has_header: bool = False
    axes: dict[str, str] = field(default_factory=dict)
    splits: dict[str, list[str]] = field(default_factory=dict)
    is_plain: bool = False
    problem: str = ""
    sheet: str | None = None

    @property
    def key(self) -> str:
        """Which table it is, of all files."""
        return str(self.file) if self.sheet is None else f"{self.file}[{self.sheet}]"

    @property
    def title(self) -> str:
        return Path(self.key).name


def preview_table(
    file: str | Path, columns: Sequence[str | int] | None = None, sheet: str | None = None
) -> TablePreview:
    """A preview of a table of text, or of the sheet of a workbook. columns: as in PointFile. Raises
    InputRefused if it is not a table."""
    file = Path(file)
    table = open_table(file, Expected(None, columns or (), KNOWN), sheet)
    rows = _sampled_rows(table)
    count = max((len(row) for row in rows[:100]), default=0)
    names = list(table.layout.names or ())
    names = [name or str(n + 1) for n, name in enumerate(names)] if len(names) == count else []
    has_header = bool(names)
    names = names or [str(n + 1) for n in range(count)]
    preview = TablePreview(file, names, head_rows(table, _ROWS), has_header, sheet=sheet)
    try:
        used = wanted_columns(table, columns)
        preview.axes = {axis: names[n] for axis, n in zip(AXES, used, strict=True) if n < count}
    except InputRefused as error:
        preview.problem = error.what
        plain = [plain_name(name) for name in names]
        usual = {axis: [name for name in aliases if plain.count(name) == 1] for axis, aliases in AXES.items()}
        preview.axes = {axis: names[plain.index(known[0])] for axis, known in usual.items() if known}
        used = [names.index(name) for name in preview.axes.values()]
    splits = []
    for column in range(count):
        if column in used or names.count(names[column]) > 1:
            continue
        values = list(dict.fromkeys(row[column] for row in rows if column < len(row) and row[column]))
        is_text = not all(is_any_number(value) for value in values)
        named = plain_name(names[column]) in _NAMING and may_name_units(values)
        if _LEAST <= len(values) <= _MOST and (is_text or named or len(values) * 10 <= len(rows)):
            splits.append((not named, not is_text, column, names[column], values))
    splits.sort(key=lambda entry: entry[:3])
    preview.splits = {name: values for *_, name, values in splits}
    preview.is_plain = bool(splits) and not splits[0][0]
    return preview


def _sampled_rows(table: TextTable) -> list[list[str]]:
    """All rows of a table, or of a long one those of pieces of it."""
    body = np.arange(table.layout.body, len(table.raw), _PIECE)
    if len(body) > _PIECES:
        body = body[np.linspace(0, len(body) - 1, _PIECES).astype(np.int64)]
    rows = []
    for begin in body.tolist():
        piece = table.raw[begin : begin + _PIECE].decode(table.encoding, "replace").split("\n")
        whole = (
            piece[1 if begin > table.layout.body else 0 : -1] if begin + _PIECE < len(table.raw) else piece
        )
        rows += [table.layout.fields(line) for line in whole if line.strip() and not line.startswith("#")]
    return rows
