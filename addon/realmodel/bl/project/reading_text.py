# SPDX-License-Identifier: GPL-3.0-or-later
"""Converts the import options of points and meshes between the settings of a surface and realmodel.core."""

import re

from ...core import InputRefused
from ...core.settings.schema import MESH_READING, READING
from . import method_settings

_SEPARATORS = {"tab": "\t", "blank": " "}
_ENTRY = re.compile(r'\s*("[^"]*"|[^,"]+?)\s*(?:,|$)')  # of a list with commas


def options(row):
    """The keyword arguments of PointFile, or MeshFile, for a surface's row. Raises InputRefused."""
    said = ("decimal", "height", "layer", "units", "z_axis")
    given = {key: method_settings.value(row, key, READING) for key in said}
    given["z_axis"] = None if given["z_axis"] == READING["z_axis"].default else given["z_axis"]
    columns = [column(getattr(row, f"column_{axis}")) for axis in "xyz"]
    if any(columns) and not all(columns):
        raise InputRefused("only some of its columns x, y and z are set", advice="set all three, or none")
    given["columns"] = columns if all(columns) else None
    where = {}
    for entry in row.filters:
        if entry.column.strip() and entry.value:
            where.setdefault(entry.column.strip(), []).append(value(entry.value))
    given["where"] = {name: _one_or_all(values) for name, values in where.items()}
    given["separator"] = _SEPARATORS.get(row.separator.lower(), row.separator)
    given["nodata"] = _one_or_all([value(text) for text in _ENTRY.findall(row.nodata)])
    return {key: part for key, part in given.items() if part not in (None, "", [], {})}


def fill(row, given):
    """Sets a row from the keyword arguments of a PointFile or MeshFile; missing ones are unset."""
    units = given.get("units")
    units = units if isinstance(units, dict) else {"xy": units, "z": units}
    given = {**given, "units": {"xy": None, "z": None} | units}
    for key in MESH_READING:
        method_settings.set_value(row, key, READING, given.get(key))
    if not hasattr(row, "filters"):
        return  # a body: it is no points
    for axis, name in zip("xyz", given.get("columns") or ("", "", ""), strict=True):
        setattr(row, f"column_{axis}", column_text(name))
    row.filters.clear()
    for name, values in (given.get("where") or {}).items():
        for wanted in values if isinstance(values, (list, tuple)) else [values]:
            entry = row.filters.add()
            entry.column, entry.value = name, value_text(wanted)
    separator = given.get("separator") or ""
    row.separator = next((word for word, sign in _SEPARATORS.items() if sign == separator), separator)
    nodata = given.get("nodata", ())
    row.nodata = ", ".join(map(value_text, nodata if isinstance(nodata, (list, tuple)) else [nodata]))
    method_settings.set_value(row, "decimal", READING, given.get("decimal"))
    row.height_attribute, row.layer = given.get("height") or "", given.get("layer") or ""


def _one_or_all(values):
    return values[0] if len(values) == 1 else values


def column(text):
    """A column as it is written: by number where it is one, else by name; a name may stand in quotes."""
    text = text.strip()
    return int(text) if text.isdecimal() else text.strip('"')


def column_text(name):
    return f'"{name}"' if isinstance(name, str) and name.isdecimal() else str(name)


def value(text):
    """A number, or a text; a value in quotes is text."""
    text = text.strip()
    for kind in (int, float):
        try:
            return kind(text)
        except ValueError:
            continue
    return text[1:-1] if text[:1] == text[-1:] == '"' and len(text) > 1 else text


def value_text(given):
    """A number, or a text; in quotes where it would be taken for something else."""
    if not isinstance(given, str):
        return repr(given)
    plain = given and given == given.strip() and not set(given) & set(',"')
    return given if plain and isinstance(value(given), str) else f'"{given}"'


def named_columns(given):
    """{name: column} of "hole = BHID; depth = 3"."""
    return {name: column(text) for name, text in named_texts(given).items()}


def named_texts(given):
    """{name: text} of "SST = Sandstone; LC ="."""
    parts = (part.partition("=") for part in given.split(";") if part.strip())
    return {name.strip(): text.strip() for name, _, text in parts}
