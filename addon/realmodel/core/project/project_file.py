# SPDX-License-Identifier: GPL-3.0-or-later
"""The project file (TOML, format 1): read strictly, paths relative to the file. The keys of a table and their
kinds are declared by the class of its entry (settings/setting.py); this is how each kind is read."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from ..base.algebra import is_number
from ..base.errors import InputRefused
from ..base.toml_table import Source, TomlDocument, TomlTable
from ..readers import is_mesh_file
from ..settings.data_files import MESH_READING, READING, MapLayer, MeshFile, PointFile, is_wkt, list_of
from ..settings.method_options import checked
from ..settings.setting import Setting, declarations, settings_of
from .entry import check_file, errors_located, is_file
from .library import PROPERTY, Library, Property, check_property
from .plan_input import is_place_elsewhere
from .project import PROJECT, PROJECT_FILE, Project
from .project_checks import check_project

FORMAT = 1


def load_project(path: str | Path) -> Project:
    """The project of a file, or of a folder with a project.toml. Raises InputRefused, naming the line, for
    anything that is not as it must be.

    The files that it names have to exist; they are read when the model is built.
    """
    path = Path(path)
    if path.is_dir():
        path /= PROJECT_FILE
    document = TomlDocument(path)
    top = TomlTable(document, document.content, (), "")
    version = top.integer("format", required=True)
    if version != FORMAT:
        raise top.refuse(f"unknown format {version}", "format", f"this version reads format {FORMAT}")
    top.allow_only(("format", *PROJECT))
    project = Project(path=path, **_values(top, Project, path.parent, _checked))
    return check_project(project)


def load_library(path: str | Path) -> Library:
    """Reads a library file. Raises InputRefused with the line of the error."""
    path = Path(path)
    document = TomlDocument(path)
    top = TomlTable(document, document.content, (), "")
    top.allow_only(("property",))
    properties: dict[int, Property] = {}
    for table in top.tables("property", "property") if "property" in top else []:
        table.allow_only(PROPERTY)
        entry = Property(**_values(table, Property, path.parent, _unchecked))
        with errors_located(table.refuse):
            check_property(entry, properties)
        properties[entry.id] = entry
    return Library(list(properties.values()), path)


class _Key:
    """A key of a table: its name and setting, its value, and the folder at which paths begin."""

    def __init__(self, table: TomlTable, name: str, setting: Setting, folder: Path):
        self.table, self.name, self.setting, self.folder = table, name, setting, folder
        self.value = table.content.get(name)

    def refuse(self, what: str, advice: str | None = None, at: tuple = ()) -> InputRefused:
        """The refusal of its value, or of what is at a place in that; the caller raises it."""
        return self._table({}, at).refuse(what, advice=advice)

    def text(self) -> str:
        return self.table.text(self.name, required=True)

    def path(self) -> Path:
        return self.folder / self.text()

    def inner(self) -> TomlTable:
        """The table that is its value."""
        inner = self._table(self.value, ())
        inner.item = f"{self.table.item}, {self.name}"
        return inner

    def layer(self, number: int, value: Any, *at: str) -> Any:
        """A file, well-known text or a table with a file and its options, in a list that is the value."""
        if isinstance(value, dict):
            return _made(MapLayer, self._table(value, (number, *at)), self.folder)
        if is_wkt(value):
            return value
        return self.folder / self._table({"file": value}, (number, *at)).text("file", required=True)

    def _table(self, content: Any, at: tuple) -> TomlTable:
        return TomlTable(self.table.document, content, (*self.table.path, self.name, *at), self.table.item)


Read = Callable[[_Key], Any]


def _values(table: TomlTable, entry: type, folder: Path, other: Read) -> dict:
    """The values of the fields of a dataclass by the keys of a table that are there. other: reads the kinds
    that are not in READ."""
    values = {}
    for part in declarations(entry):
        if part.is_needed or part.key in table or part.setting.kind == "options":
            read = READ.get(part.setting.kind, other)
            values[part.name] = read(_Key(table, part.key, part.setting, folder))
    return values


def _checked(key: _Key) -> Any:
    with errors_located(key.table.refuse, key.name):
        return checked(key.name, key.setting, key.value)


def _unchecked(key: _Key) -> Any:
    """What a table within a table says is checked with the file that it is about."""
    return key.value


def _made(kind: type, table: TomlTable, folder: Path) -> Any:
    """A file with its options, or several files."""
    table.allow_only(settings_of(kind))
    return kind(**_values(table, kind, folder, _unchecked))


def _entries(key: _Key) -> list:
    """The rock masses, surfaces, series, faults or bodies that are [[tables]] of this key."""
    return [_entry(key, table) for table in key.table.tables(key.name, key.name)]


def _entry(key: _Key, table: TomlTable) -> Any:
    entry_name = f"{key.name} '{table.text('name', required=True)}'"
    table.item = f"{key.table.item}, {entry_name}" if key.table.item else entry_name
    table.allow_only(settings_of(key.setting.of))
    values = _with_reading(table, _values(table, key.setting.of, key.folder, _checked))
    return key.setting.of(**values, source=Source(table.document, table.path))


def _with_reading(table: TomlTable, values: dict) -> dict:
    """The values of an entry, where its files have the keys that say how they are read."""
    reading = {key: table.content[key] for key in READING if key in table}
    files = {key: values[key] for key in ("points", "mesh", "trace") if key in values}
    if list(files) == ["mesh"] and reading.keys() & MESH_READING.keys():
        of_mesh = {key: reading.pop(key) for key in MESH_READING if key in reading}
        values = {**values, "mesh": MeshFile(files["mesh"], **of_mesh)}
    if not reading:
        return values
    for key in ("points", "trace"):
        if isinstance(files.get(key), Path):
            return {**values, key: PointFile(files[key], **reading)}
    key = next(iter(reading))
    raise table.refuse(f"'{key}' needs a file of points", key)


def _options(key: _Key) -> dict:
    return {name: key.table.content[name] for name in key.setting.parts if name in key.table}


def _files(key: _Key) -> list[Path]:
    """A file, or a list of files."""
    files = list_of(_checked(key))
    return [key.folder / file for file in files]


def _line(key: _Key) -> str:
    key.value = key.text()
    return _checked(key)


def _note(key: _Key) -> str | None:
    """Text that may be empty (not given) or have several lines, as descriptions."""
    return (key.value or None) if isinstance(key.value, str) else key.text()


def _library(key: _Key) -> Library:
    check_file(key.path(), key.name, key.table.refuse)
    return load_library(key.path())


def _table_file(key: _Key) -> Any:
    """A file, or a table with files and their options."""
    kind = key.setting.of
    is_of_one = sum(part.is_needed for part in declarations(kind)) <= 1
    if isinstance(key.value, str) and is_of_one:
        return kind(key.path())
    if not isinstance(key.value, dict):
        what = f"'{key.name}' must be {'a file or ' if is_of_one else ''}a table"
        raise key.refuse(what, f"write {key.name} = {key.setting.example}")
    return _made(kind, key.inner(), key.folder)


def _ground(key: _Key) -> Any:
    """A ground or a terrain: a file, a table with one, or the name of a surface of the rock mass."""
    if isinstance(key.value, dict):
        keys = key.inner()
        keys.allow_only(settings_of(PointFile))
        values = _values(keys, PointFile, key.folder, _unchecked)
        is_mesh = is_file(values["file"]) and is_mesh_file(values["file"])
        kind = MeshFile if is_mesh and values.keys() <= settings_of(MeshFile).keys() else PointFile
        return kind(**values)
    of_rocks, number = key.table.path[:2]
    rock = key.table.document.content[of_rocks][number]
    names = [surface.get("name") for surface in rock.get("surface", []) if isinstance(surface, dict)]
    return key.text() if key.text() in names else key.path()


def _region(key: _Key) -> Any:
    if isinstance(key.value, list):
        return _rings(key) if _is_list_of_rings(key.value) else _ring(key, key.value)
    return _layer_file(key)


def _layer_file(key: _Key) -> Any:
    """A file, well-known text, or a table with a file and its options."""
    if isinstance(key.value, dict):
        return _made(MapLayer, key.inner(), key.folder)
    return key.value if isinstance(key.value, str) and is_wkt(key.value) else key.path()


def _rings(key: _Key) -> list[np.ndarray]:
    if not isinstance(key.value, list):
        raise key.refuse(f"'{key.name}' must be a list of outlines", "write [[[x, y], ...], ...]")
    return [_ring(key, ring, number) for number, ring in enumerate(key.value)]


def _is_list_of_rings(region: list) -> bool:
    def is_ring(ring: Any) -> bool:
        return isinstance(ring, list) and bool(ring) and all(isinstance(corner, list) for corner in ring)

    return bool(region) and all(map(is_ring, region))


def _ring(key: _Key, ring: Any, *at: int) -> np.ndarray:
    """One outline of coordinates. Errors name the line of the corner that is not two numbers."""
    advice = "write an outline as [[x, y], [x, y], [x, y], ...]"
    if not isinstance(ring, list):
        raise key.refuse(f"{key.name}: an outline must be a list of corners", advice, at)
    for number, corner in enumerate(ring):
        is_pair = isinstance(corner, list) and len(corner) == 2
        if not is_pair or not all(is_number(c) for c in corner):
            what = f"{key.name}: a corner must be two finite numbers, not {corner!r}"
            raise key.refuse(what, advice, (*at, number))
    return np.array(ring, np.float64).reshape(-1, 2)


def _constraints(key: _Key) -> list:
    advice = 'write constraints = ["rivers.geojson", [[x, y], [x, y], ...], [x, y]]'
    if not isinstance(key.value, list):
        raise key.refuse("'constraints' must be a list of files, lines and points", advice)
    constraints: list[str | Path | MapLayer | np.ndarray] = []
    for number, entry in enumerate(key.value):
        if isinstance(entry, (str, dict)):
            constraints.append(key.layer(number, entry))
        elif isinstance(entry, list) and entry and all(is_number(value) for value in entry):
            constraints.append(_ring(key, [entry], number)[0])
        elif isinstance(entry, list) and entry:
            constraints.append(_ring(key, entry, number))
        else:
            what = "'constraints' has an entry that is not a file, line or point"
            raise key.refuse(what, advice, (number,))
    return constraints


def _sizes(key: _Key) -> list:
    """Local edge lengths; where one is at a file, at a path or a MapLayer."""
    if not isinstance(key.value, list):
        raise key.refuse("'size' must be a list", "write [{ at = ..., length = ..., distance = ... }]")
    sizes = []
    for number, entry in enumerate(key.value):
        at = entry.get("at") if isinstance(entry, dict) else None
        if isinstance(at, dict) or (isinstance(at, str) and is_place_elsewhere(at)):
            entry = {**entry, "at": key.layer(number, at, "at")}
        sizes.append(entry)
    return sizes


def _places(key: _Key) -> np.ndarray:
    rows: Any = key.value
    is_list = isinstance(rows, list) and all(isinstance(row, list) and len(row) == 3 for row in rows)
    if not is_list or not all(is_number(value) for row in rows for value in row):
        raise key.refuse(f"'{key.name}' must be a list of points", f"write {key.name} = [[x, y, z], ...]")
    return np.array(rows, np.float64).reshape(-1, 3)


def _trace(key: _Key) -> Any:
    """A file, well-known text, one line, or several; z of points without one is NaN."""
    if isinstance(key.value, str):
        return _layer_file(key)
    advice = "write [[x, y], [x, y], ...], or [x, y, z] for each"

    def line(points: list, *at: int) -> np.ndarray:
        for number, point in enumerate(points):
            is_point = isinstance(point, list) and len(point) in (2, 3)
            if not is_point or not all(is_number(value) for value in point):
                what = f"trace: a point must be two or three numbers, not {point!r}"
                raise key.refuse(what, advice, (*at, number))
        return np.array([(*point, np.nan)[:3] for point in points], np.float64).reshape(-1, 3)

    if not isinstance(key.value, list):
        raise key.refuse("'trace' must be a file or a list of points", advice)
    if _is_list_of_rings(key.value):
        return [line(points, number) for number, points in enumerate(key.value)]
    return line(key.value)


# By the kinds of settings; values of other kinds are checked as they are.
READ: Mapping[str, Read] = {
    "name": _Key.text,
    "line": _line,
    "method": _Key.text,
    "finite": lambda key: key.table.number(key.name),
    "integer": lambda key: key.table.integer(key.name, required=True),
    "note": _note,
    "file": _Key.path,
    "files": _files,
    "points": _Key.path,
    "mesh": _Key.path,
    "trace": _trace,
    "options": _options,
    "tables": _entries,
    "table_file": _table_file,
    "layer_file": _layer_file,
    "ground": _ground,
    "library": _library,
    "region": _region,
    "rings": _rings,
    "constraints": _constraints,
    "sizes": _sizes,
    "places": _places,
}
