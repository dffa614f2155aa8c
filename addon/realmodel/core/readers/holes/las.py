# SPDX-License-Identifier: GPL-3.0-or-later
"""LAS, the format of well logs: sections of a mnemonic, unit, value and description, and curves by depth, one
row a depth or wrapped over several lines; in LAS 3 tops and directions, too.

Canadian Well Logging Society, *LAS Version 1.2* (1990), *2.0* (1992, updated 2017) and *3.0* (1999),
cwls.org.
"""

from __future__ import annotations

import csv
import re
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from ...base.errors import InputRefused
from ...base.text import BOM, read_text
from ...base.units import unit_of
from ..tables.hole_tables import RawTable
from ..tables.table_layout import is_number

_ITEM = re.compile(r"\s*([^.]*?)\s*\.([^\s:]*)\s*(.*)$")
_WITHOUT_POINT = re.compile(r"\s*([^.:\s]+)()\s+(:.*)$")  # which some programs leave out
_FEET = {"F": "ft", "FT.": "ft"}  # as LAS files write it beside the usual spellings
_RUN_ON = re.compile(r"(?<=\d)-(?=\d*\.)")  # 1.25-999.25: columns without a blank between them
_DEPTHS = ("DEPT", "DEPTH", "MD", "DPTH", "TDEP", "BDEP")
_X = ("XCOORD", "X", "EASTING", "EAST", "UTMX", "XWELL", "X-COORD", "XLOC")
_Y = ("YCOORD", "Y", "NORTHING", "NORTH", "UTMY", "YWELL", "Y-COORD", "YLOC")
_Z = ("EKB", "KB", "EREF", "EDF", "ELEV", "EGL", "GL", "ELEVATION")
_NAMES = ("WELL", "UWI", "API", "WELL NAME")
_END = ("TD", "TDD", "TDL", "DTD")


@dataclass
class _Section:
    title: str
    line: int
    items: list[tuple[str, str, str, str]] = field(default_factory=list)  # mnemonic, unit, value, description
    rows: list[tuple[int, str]] = field(default_factory=list)

    def item(self, *mnemonics: str) -> tuple[str, str]:
        """The value and unit of the first of some mnemonics that it has; empty where it has none."""
        for wanted in mnemonics:
            for mnemonic, unit, value, _ in self.items:
                if mnemonic.upper() == wanted and value:
                    return value, unit
        return "", ""


def begins_as_las(head: bytes, _size: int = 0) -> bool:
    """Whether a file that begins so is LAS."""
    plain = head.removeprefix(BOM).removeprefix(b"\xff\xfe").removeprefix(b"\xfe\xff").replace(b"\0", b"")
    lines = (line.strip() for line in plain.split(b"\n"))
    first = next((line for line in lines if line and not line.startswith(b"#")), b"")
    return first[:2].upper() == b"~V"


def read_las(file: Path) -> dict[str, RawTable]:
    """The curves of a file as values of intervals, which meet between depths; and its collar, tops and
    directions where it has them. Raises InputRefused naming the line."""
    sections = _sections(file)
    version, well = _section(sections, "V"), _well(sections)
    hole = well.item(*_NAMES)[0] or file.stem
    sheets = {}
    if (curves := _curves(file, sections, hole)) is not None:
        sheets["intervals"] = curves
    if (collar := _collar([well, _section(sections, "P")], hole)) is not None:
        sheets["collars"] = collar
    if (tops := _data(file, sections, "TOPS", version)) is not None:
        sheets["picks"] = _tops(sections, tops, hole)
    if (ways := _data(file, sections, "INCLINOMETRY", version)) is not None:
        named = {"MD": "depth", "AZIM": "azimuth", "DEVI": "inclination"}
        names = [named.get(name, "") for name in ways.names]
        rows = [(line, [hole, *row]) for line, row in ways.rows]
        sheets["survey"] = RawTable(["hole", *names], rows, ways.line, ["", *ways.units])
    return sheets


def well_names(file: Path) -> list[str]:
    """What a file calls its well: by its name, and by its numbers."""
    well = _well(_sections(file))
    return [name for mnemonic in _NAMES if (name := well.item(mnemonic)[0])]


def _well(sections: list[_Section]) -> _Section:
    well = _section(sections, "W")
    if _section(sections, "V").item("VERS")[0].startswith("1."):
        # descriptions stand where later versions have the values
        texts = ("STRT", "STOP", "STEP", "NULL")
        well.items = [(m, u, v, d) if m.upper() in texts else (m, u, d, v) for m, u, v, d in well.items]
    return well


def _sections(file: Path) -> list[_Section]:
    sections: list[_Section] = []
    for line, text in enumerate(read_text(file).split("\n"), 1):
        stripped = text.strip()
        if stripped.startswith("~"):
            sections.append(_Section(stripped[1:].strip(), line))
        elif stripped and not stripped.startswith("#") and sections:
            sections[-1].rows.append((line, stripped))
    for section in sections:
        for _, text in section.rows if not _is_data(section) else ():
            match = _WITHOUT_POINT.match(text) or _ITEM.match(text)
            if match:
                value, sign, description = match[3].rpartition(":")
                value, description = (value, description) if sign else (match[3], "")
                section.items.append(
                    (match[1].strip(), match[2].strip("."), value.strip(), description.strip())
                )
    return sections


def _is_data(section: _Section) -> bool:
    title = section.title.upper()
    if "DEFINITION" in title.partition("|")[0] or "PARAMETER" in title.partition("|")[0]:
        return False
    return title[:1] in ("A", "O") or "|" in title or "_DATA" in title


def _section(sections: list[_Section], letter: str) -> _Section:
    """The section whose title begins so, of all that are no data; an empty one where there is none."""
    for section in sections:
        if section.title.upper().startswith(letter) and not _is_data(section):
            return section
    return _Section("", 0)


def _curves(file: Path, sections: list[_Section], hole: str) -> RawTable | None:
    """The curves of a file; None where it has none."""
    titles = {"C": "A", "LOG_DEFINITION": "LOG"}
    curve_sections = [
        (s, titles[key]) for s in sections for key in titles if s.title.upper().startswith(key) and s.items
    ]
    curve_sections = [
        (section, data) for section, data in curve_sections if "CORE" not in section.title.upper()
    ]
    if not curve_sections:
        return None
    definition, letter = curve_sections[0]
    data = next((s for s in sections if _is_data(s) and s.title.upper().startswith(letter)), None)
    if data is None or not data.rows:
        return None
    version = _section(sections, "V")
    names = [mnemonic for mnemonic, *_ in definition.items]
    unit = definition.items[0][1]
    if names[0].upper() not in _DEPTHS and unit_of(_FEET.get(unit.upper(), unit)) is None:
        what = f"its first curve is '{names[0]}', which is no depth"
        raise InputRefused(what, file=file, line=definition.line, advice="export the curves by depth")
    rows = _rows(file, data, len(names), version)
    null = _section(sections, "W").item("NULL")[0]
    for line, row in rows:
        if not is_number(row[0]):
            raise InputRefused(f"the depth is not a number: '{row[0]:.40}'", file=file, line=line)
    depths = np.array([float(row[0]) for _, row in rows])
    order = np.argsort(depths, kind="stable")
    middles = 0.5 * (depths[order][1:] + depths[order][:-1])
    first, last = depths[order[0]], depths[order[-1]]
    begins, ends = np.append(first, middles), np.append(middles, last)
    entries = [
        (rows[n][0], [hole, repr(float(begin)), repr(float(end)), *_known(rows[n][1][1:], null)])
        for n, begin, end in zip(order.tolist(), begins, ends, strict=True)
        if begin < end
    ]
    length = _FEET.get(unit.upper(), unit)
    units = ["", length, length, *(unit for _, unit, *_ in definition.items[1:])]
    return RawTable(["hole", "from", "to", *names[1:]], entries, definition.line, units, is_log=True)


def _known(values: list[str], null: str) -> list[str]:
    """Values, empty where they are the one that stands for none."""
    return ["" if _is_null(value, null) else value for value in values]


def _is_null(value: str, null: str) -> bool:
    try:
        return value == null or float(value) == float(null)
    except ValueError:
        return False


def _rows(file: Path, data: _Section, count: int, version: _Section) -> list[tuple[int, list[str]]]:
    """The rows of a section with as many values as curves, each with its line."""
    wrapped = version.item("WRAP")[0].upper() == "YES"
    said = version.item("DLM")[0].upper()
    sign = "\t" if said == "TAB" else " "
    sign = "," if said == "COMMA" or (not (said or wrapped) and "," in data.rows[0][1]) else sign
    rows: list[tuple[int, list[str]]] = []
    values: list[str] = []
    for line, text in data.rows:
        plain = " ".join(text.split()) if sign == " " else text
        entries = [
            entry.strip() for entry in next(csv.reader([plain], delimiter=sign, skipinitialspace=True))
        ]
        if sign != ",":
            entries = [entry.replace(",", ".") if is_number(entry, ",") else entry for entry in entries]
        if len(entries) < count and not wrapped:
            entries = _RUN_ON.sub(" -", text).split()
        values += entries
        if len(values) < count and wrapped:
            continue
        if len(values) != count:
            what = f"{count} values are needed, there are {len(values)}"
            raise InputRefused(what, file=file, line=line)
        rows.append((line, values))
        values = []
    if not rows:
        raise InputRefused("its curves have no values", file=file, line=data.line)
    return rows


def _data(file: Path, sections: list[_Section], kind: str, version: _Section) -> RawTable | None:
    """The table of a kind of data of LAS 3; None where there is none."""
    definition = next((s for s in sections if s.title.upper().startswith(f"{kind}_DEFINITION")), None)
    data = next((s for s in sections if _is_data(s) and s.title.upper().startswith(kind)), None)
    if definition is None or data is None or not data.rows:
        return None
    names = [mnemonic.upper() for mnemonic, *_ in definition.items]
    units = [_FEET.get(unit.upper(), unit) for _, unit, *_ in definition.items]
    return RawTable(names, _rows(file, data, len(names), version), definition.line, units)


def _tops(sections: list[_Section], tops: RawTable, hole: str) -> RawTable:
    """Tops as picks: by depth, or by height where the file counts them from the sea."""
    parameters = next((s for s in sections if s.title.upper().startswith("TOPS_PARAMETER")), _Section("", 0))
    from_sea = "SUB" in parameters.item("TOPDR")[0].upper()
    named = {"TOPT": "elevation" if from_sea else "depth", "TOPN": "surface"}
    names = [named.get(name, "") for name in tops.names]
    rows = [(line, [hole, *row]) for line, row in tops.rows]
    return RawTable(["hole", *names], rows, tops.line, ["", *tops.units])


def _collar(sections: list[_Section], hole: str) -> RawTable | None:
    """The collar of the well; None where the file does not say its place."""
    values, units = [hole], [""]
    for mnemonics in (_X, _Y, _Z, _END):
        value, unit = next((item for s in sections if (item := s.item(*mnemonics))[0]), ("", ""))
        values.append(value)
        units.append(_FEET.get(unit.upper(), unit))
    if not all(values[1:4]):
        return None
    return RawTable(("hole", "x", "y", "z", "end"), [(sections[0].line, values)], sections[0].line, units)
