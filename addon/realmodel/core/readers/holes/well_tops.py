# SPDX-License-Identifier: GPL-3.0-or-later
"""Well tops of Petrel: comments with the units, a version, the names of columns one a line between BEGIN
HEADER and END HEADER, and rows of values with blanks between them, texts in quotes, -999 for no value.

Layout: Schlumberger, *Petrel* help, "Well tops (ASCII)"; as Petrel writes it.
"""

from __future__ import annotations

from pathlib import Path

from ...base.errors import InputRefused
from ...base.text import BOM, read_text
from ..tables.hole_tables import RawTable, column_key
from ..tables.table_layout import fields

_PLACE = ("x", "y", "z")
_DEPTHS = ("md", "depth", "tvd", "from")


def begins_as_well_tops(head: bytes, _size: int = 0) -> bool:
    """Whether a file that begins so has well tops of Petrel."""
    return head.removeprefix(BOM).lstrip().lower().startswith(b"# petrel well tops")


def read_well_tops(file: Path) -> dict[str, RawTable]:
    """The picks of a file: at their places where it has them, else by depth. Raises InputRefused naming the
    line."""
    names: list[str] = []
    rows: list[tuple[int, list[str]]] = []
    units = {"x": "", "y": "", "depth": ""}
    where, header_line = "", 1
    for line, text in enumerate(read_text(file).split("\n"), 1):
        stripped = text.strip()
        if stripped.startswith("#"):
            _note_unit(stripped, units)
        elif stripped.upper() in ("BEGIN HEADER", "END HEADER"):
            where, header_line = stripped.upper(), line
        elif where == "BEGIN HEADER" and stripped:
            names.append(stripped.rpartition(",")[2].strip())  # without a type, as in FLOAT,Dip angle
        elif where == "END HEADER" and stripped:
            rows.append((line, fields(stripped, " ")))
    if not rows:
        what = (
            "there are no rows after END HEADER" if names else "it has no names between BEGIN and END HEADER"
        )
        raise InputRefused(what, file=file)
    keys = [column_key(name) for name in names]
    has_places = set(_PLACE) <= set(keys) and any(_has_height(row, keys) for _, row in rows)
    taken_out = _DEPTHS if has_places else _PLACE
    names = ["" if key in taken_out else name for name, key in zip(names, keys, strict=True)]
    of_columns = [units.get(key, units["depth"] if key in ("z", "md") else "") for key in keys]
    return {"picks": RawTable(names, rows, header_line, of_columns)}


def _note_unit(comment: str, units: dict[str, str]) -> None:
    said, _, unit = comment.lower().partition(":")
    if "unit in x" in said:
        units["x"] = units["y"] = unit.strip()
    elif "unit in depth" in said:
        units["depth"] = unit.strip()


def _has_height(row: list[str], keys: list[str]) -> bool:
    at = keys.index("z")
    return at < len(row) and not row[at].startswith("-999")
