# SPDX-License-Identifier: GPL-3.0-or-later
"""AGS 3 and 4, the format of ground investigations: groups of a heading, units and rows in quotes.

Association of Geotechnical and Geoenvironmental Specialists, *Electronic Transfer of Geotechnical and
Geoenvironmental Data*, editions 3.1 (2004) and 4.1 (2020), ags.org.uk.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path

from ...base.errors import InputRefused
from ...base.text import BOM, read_text
from ..tables.hole_tables import RawTable

_KINDS = {"collars": ("LOCA", "HOLE"), "intervals": ("GEOL",), "survey": ("HORN", "HDPH")}
# Where a column has no value in any row, the first of these that has is meant.
_INSTEAD = {
    "LOCA_NATE": ("LOCA_LOCX",),
    "LOCA_NATN": ("LOCA_LOCY",),
    "LOCA_GL": ("LOCA_LOCZ",),
    "HOLE_NATE": ("HOLE_LOCX",),
    "HOLE_NATN": ("HOLE_LOCY",),
    "HOLE_GL": ("HOLE_LOCZ",),
    "GEOL_GEOL": ("GEOL_LEG", "GEOL_GEO2"),
    "HORN_ORNT": ("HDPH_ORNT",),
}

# Grids by the abbreviations of AGS and of common use, as EPSG numbers them.
_GRIDS = {
    "OSGB": 27700,
    "OSGB36": 27700,
    "BNG": 27700,
    "OSI": 29902,
    "ITM": 2157,
    "HK80": 2326,
    "HK1980": 2326,
}


_NAMES = re.compile(r'"?(HEADING\b|\*\??[A-Z])')  # a line with the names of columns


@dataclass
class _Group:
    line: int
    names: list[str] = field(default_factory=list)
    units: list[str] = field(default_factory=list)
    rows: list[tuple[int, list[str]]] = field(default_factory=list)


def begins_as_ags(head: bytes, _size: int = 0) -> bool:
    """Whether a file that begins so is AGS 3 or 4."""
    text = head.removeprefix(BOM).lstrip()
    return re.match(rb'"GROUP"|"\*\*|\*\*PROJ|GROUP[,;|\t]', text) is not None


def read_ags(file: Path) -> dict[str, RawTable]:
    """The collars of a file, its intervals and survey where it has them. Raises InputRefused naming the
    line."""
    groups = _groups(file)
    sheets = {}
    for kind, names in _KINDS.items():
        group = next((groups[name] for name in names if name in groups and groups[name].rows), None)
        if group is not None:
            sheets[kind] = _sheet(group)
    survey = sheets.get("survey")
    if survey is not None and not any(name.endswith("_INCL") for name in survey.names):
        del sheets["survey"]
    if "collars" not in sheets:
        raise InputRefused("it has no rows of LOCA or HOLE", file=file)
    sheets["collars"] = replace(sheets["collars"], system=_system(groups))
    return sheets


def _system(groups: dict[str, _Group]) -> str:
    """The grid of the places; "" where the file names none, or the places are those of a grid of the site."""
    if not (_values(groups, "LOCA", "LOCA_NATE") or _values(groups, "HOLE", "HOLE_NATE")):
        return ""
    grids = _values(groups, "LOCA", "LOCA_GREF") or _values(groups, "PROJ", "PROJ_GRID")
    codes = {grid: _GRIDS.get(grid.upper().replace(" ", "")) for grid in grids}
    return ", ".join(sorted({f"EPSG:{code}" if code else grid for grid, code in codes.items()}))


def _values(groups: dict[str, _Group], name: str, column: str) -> set[str]:
    """The entries of a column of a group that are not empty."""
    group = groups.get(name)
    if group is None or column not in group.names:
        return set()
    at = group.names.index(column)
    return {_entry(row, at) for _, row in group.rows} - {""}


def _groups(file: Path) -> dict[str, _Group]:
    """The groups of a file by their names."""
    groups: dict[str, _Group] = {}
    group = _Group(0)
    for line, entries in _entries(file):
        first = entries[0].strip()
        if first.startswith("**"):
            group = groups.setdefault(first.lstrip("*?").strip().upper(), _Group(line))
        elif first == "GROUP":
            group = groups.setdefault(entries[1].strip().upper() if len(entries) > 1 else "", _Group(line))
        elif first.startswith("*"):  # the heading of AGS 3 may continue in further lines
            group.names += [name.strip().lstrip("*?").strip().upper() for name in entries if name.strip()]
        elif first == "HEADING":
            group.names = [entry.strip().upper() for entry in entries[1:]]
        elif first == "UNIT":
            group.units = [entry.strip() for entry in entries[1:]]
        elif first == "<UNITS>":
            group.units = ["", *(entry.strip() for entry in entries[1:])]
        elif first == "<CONT>":
            _continue(file, line, group, entries)
        elif first == "DATA":
            group.rows.append((line, entries[1:]))
        elif first != "TYPE":
            group.rows.append((line, entries))
    for group in groups.values():  # spaces count where a text goes on in a further line
        group.rows = [(line, [entry.strip() for entry in row]) for line, row in group.rows]
    return groups


def _entries(file: Path) -> Iterator[tuple[int, list[str]]]:
    """The entries of the lines that are not empty. Programs that open the file as a table may write it with
    semicolons, tabs or bars in the place of commas."""
    lines = read_text(file).split("\n")
    names = next((text for text in lines if _NAMES.match(text.strip())), ",")
    separator = max(",;\t|", key=names.count)
    for line, text in enumerate(lines, 1):
        stripped = text.strip()
        if stripped.strip(separator):
            row = next(csv.reader([stripped], delimiter=separator, skipinitialspace=True)) or [""]
            yield line, row


def _continue(file: Path, line: int, group: _Group, entries: list[str]) -> None:
    """Texts of AGS 3 that continue in a further line are added to those of the row before."""
    if not group.rows:
        raise InputRefused("<CONT> continues no row", file=file, line=line)
    before = group.rows[-1][1]
    before += [""] * (len(entries) - len(before))
    for at, entry in enumerate(entries[1:], 1):
        before[at] += entry


def _sheet(group: _Group) -> RawTable:
    names = list(group.names)
    for name, others in _INSTEAD.items():
        known = [other for other in others if _is_filled(group, names, other)]
        if name in names and known and not _is_filled(group, names, name):
            names[names.index(name)], names[names.index(known[0])] = "", name
    return RawTable(names, group.rows, group.line, group.units, _choice(names, group.rows))


def _is_filled(group: _Group, names: list[str], name: str) -> bool:
    """Whether there is a column of this name with a value."""
    return name in names and any(_entry(row, names.index(name)) for _, row in group.rows)


def _choice(names: list[str], rows: list[tuple[int, list[str]]]) -> tuple[str, str] | None:
    """The column of units and what is said of it, where two name them otherwise."""
    if not {"GEOL_GEOL", "GEOL_LEG"} <= set(names):
        return None
    pairs = {(_entry(row, names.index("GEOL_GEOL")), _entry(row, names.index("GEOL_LEG"))) for _, row in rows}
    if all(legend in ("", code) for code, legend in pairs):
        return None
    empty = sum(not code for code, _ in pairs)
    text = "GEOL_LEG names them otherwise" + (", also where GEOL_GEOL is empty" if empty else "")
    return "GEOL_GEOL", f'blocks are named by GEOL_GEOL; {text}: columns = {{ block = "GEOL_LEG" }}'


def _entry(row: list[str], at: int) -> str:
    return row[at] if at < len(row) else ""
