# SPDX-License-Identifier: GPL-3.0-or-later
"""How a file of points, or a mesh, is read, between `reading` of a surface's row - JSON, as
realmodel.core.PointFile and MeshFile take it - and what a person writes in the panel."""

import json

from . import units

DECIMALS = (
    ("", "Automatic", "Detected from the file, except for commas that could separate thousands"),
    (".", "Point", "1234.5"),
    (",", "Comma", "1234,5"),
)
UNITS = (("", "Model Unit", "The unit of the model"), *units.ITEMS)
_NAMES = ("height", "layer")  # taken as they are written, "5" too
_SEPARATORS = {"tab": "\t", "blank": " "}


def options(row):
    """The keyword arguments of PointFile, or MeshFile, that a surface's row asks for."""
    return json.loads(row.reading) if row.reading else {}


def text(row, key):
    """What the panel shows of an option."""
    value = options(row).get(key)
    if value is None:
        return ""
    if key in _NAMES:
        return value
    if key == "separator":
        return next((word for word, sign in _SEPARATORS.items() if sign == value), value)
    if key == "where":
        return "; ".join(f"{column} = {_list_text(values)}" for column, values in value.items())
    return _list_text(value)


def set_text(row, key, given):
    """Sets an option from what was typed; empty: it is not given."""
    given = given.strip() if key != "separator" or given.strip() else given
    if key == "separator":
        value = _SEPARATORS.get(given.lower(), given)
    elif key in _NAMES:
        value = given
    elif key == "where":
        value = {}
        for part in filter(None, (part.strip() for part in given.split(";"))):
            column, _, values = part.partition("=")
            parsed = _values(values)
            value[_name(column)] = parsed[0] if len(parsed) == 1 else parsed
    elif key == "columns":
        value = _values(given)
    else:
        parsed = _values(given)
        value = parsed[0] if len(parsed) == 1 else parsed
    _set(row, key, value)


def choice(row, key, items):
    """The number of the present one of the items of a menu. key: "decimal", or "xy" or "z" of the units."""
    return next((n for n, item in enumerate(items) if item[0] == _choice(row, key)), 0)


def set_choice(row, key, items, number):
    if key == "decimal":
        _set(row, key, items[number][0])
        return
    given = {part: _choice(row, part) for part in ("xy", "z")} | {key: items[number][0]}
    _set(row, "units", {part: unit for part, unit in given.items() if unit})


def _choice(row, key):
    if key == "decimal":
        return options(row).get(key) or ""
    given = options(row).get("units")
    return (given.get(key) if isinstance(given, dict) else given) or ""


def _set(row, key, value):
    from . import changes

    given = options(row)
    given.pop(key, None)
    if value not in ("", [], {}):
        given[key] = value
    row.reading = json.dumps(given) if given else ""
    changes.reading(row)


def _list_text(values):
    return ", ".join(map(_value_text, values if isinstance(values, list) else [values]))


def _value_text(value):
    """A number, or a text; in quotes where it would be taken for something else."""
    if not isinstance(value, str):
        return repr(value)
    plain = value and value == value.strip() and not set(value) & set(',;="')
    return value if plain and isinstance(_value(value), str) else f'"{value}"'


def _values(given):
    """The values of a list with commas; those in quotes are text."""
    found, at = [], 0
    given = given.strip()
    while at < len(given):
        if given[at] == '"':
            end = given.find('"', at + 1)
            end = len(given) if end < 0 else end
            found.append(given[at + 1 : end])
            at = given.find(",", end)
        else:
            end = given.find(",", at)
            found.append(_value(given[at : end if end >= 0 else len(given)].strip()))
            at = end
        if at < 0:
            break
        at += 1
        while at < len(given) and given[at].isspace():
            at += 1
    return [value for value in found if value != ""] if '""' not in given else found


def _value(given):
    for kind in (int, float):
        try:
            return kind(given)
        except ValueError:
            continue
    return given


def _name(column):
    return column.strip().strip('"')


def named_columns(given):
    """{name: column} of "hole = BHID; depth = 3"."""
    found = {}
    for part in filter(None, (part.strip() for part in given.split(";"))):
        name, _, column = part.partition("=")
        found[name.strip()] = _values(column)[0] if _values(column) else ""
    return found
