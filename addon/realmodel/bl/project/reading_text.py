# SPDX-License-Identifier: GPL-3.0-or-later
"""Texts, and lists of them, in the panel: of names, numbers, columns, filters and values of files."""

import re

from ...core import InputRefused
from ...core.settings.data_files import list_of

_SEPARATORS = {"tab": "\t", "blank": " "}
_PAIR = re.compile(r'\s*("[^"]*"|[^=;]*?)\s*(?:=\s*("[^"]*"|[^;]*?)\s*)?(?:;|$)')  # of name = text; ...
_ENTRY = re.compile(r'\s*("[^"]*"|[^,"]+?)\s*(?:,|$)')  # of a list with commas


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


def columns(parts):
    """The three columns of a file; None where none is set. Raises InputRefused where some are."""
    if parts and len(parts) < 3:
        raise InputRefused("only some of its columns x, y and z are set", advice="set all three, or none")
    return list(parts.values()) or None


def parts_of(setting, content):
    """The values of the parts of a setting. Columns are a list, and one unit is that of all coordinates."""
    if setting.kind == "columns":
        return dict(zip(setting.parts, content or (None,) * 3, strict=True))
    if setting.kind == "units":
        of_all = {} if isinstance(content, dict) else dict.fromkeys(setting.parts, content)
        return {**dict.fromkeys(setting.parts), **(of_all or content)}
    return content or {}


def _number_or_text(text):
    text = text.strip()
    try:
        return float(text)
    except ValueError:
        return text


def _separator(text):
    return _SEPARATORS.get(text.lower(), text)


def _values(text):
    return _one_or_all([value(part) for part in _ENTRY.findall(text)]) if text else None


def _filters(rows):
    where = {}
    for entry in rows:
        if entry.column.strip() and entry.value:
            where.setdefault(entry.column.strip(), []).append(value(entry.value))
    return {name: _one_or_all(wanted) for name, wanted in where.items()} or None


def _names(rows):
    return tuple(entry.name for entry in rows if entry.name)


def _set_text(text_of):
    """Sets a text from what stands for it; None is no text."""
    return lambda row, name, content: setattr(row, name, "" if content is None else text_of(content))


def _fill_filters(row, name, where):
    rows = getattr(row, name)
    rows.clear()
    for column_name, wanted in (where or {}).items():
        for text in map(value_text, list_of(wanted)):
            entry = rows.add()
            entry.column, entry.value = column_name, text


def _fill_names(row, key, names):
    rows = getattr(row, key)
    rows.clear()
    for name in names or ():
        rows.add().name = name


def named_columns(given):
    """{name: column} of "hole = BHID; depth = 3; dip ="; False for nothing: no column is read."""
    return {name: column(text) if text else False for name, text in _pairs(given)}


def named_texts(given):
    """{name: text} of "SST = Sandstone; LC ="; either may stand in quotes."""
    return {_unquoted(name): _unquoted(text) for name, text in _pairs(given)}


def _pairs(line):
    return [(name.strip(), text.strip()) for name, text in _PAIR.findall(line) if name.strip()]


def _unquoted(text):
    return text[1:-1] if len(text) > 1 and text[0] == text[-1] == '"' else text


def of_named(texts):
    """The text that `named_texts` reads, and `named_columns` of columns."""
    return "; ".join(f"{_quoted(name)} = {_quoted(text or '')}" for name, text in texts.items())


def _quoted(text):
    text = column_text(text)
    return f'"{text}"' if set(text) & set(";=") and text[0] != '"' else text


# By the kinds of settings that are texts or rows in the panel.
READ = {
    "surface": _number_or_text,
    "direction": _number_or_text,
    "column": column,
    "separator": _separator,
    "values": _values,
    "where": _filters,
    "names": _names,
}
FILL = {
    "surface": _set_text(lambda content: content if isinstance(content, str) else repr(content)),
    "direction": _set_text(lambda content: content if isinstance(content, str) else repr(content)),
    "column": _set_text(column_text),
    "separator": _set_text(lambda sign: next((w for w, s in _SEPARATORS.items() if s == sign), sign)),
    "values": _set_text(lambda content: ", ".join(map(value_text, list_of(content)))),
    "where": _fill_filters,
    "names": _fill_names,
}
