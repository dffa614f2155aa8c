# SPDX-License-Identifier: GPL-3.0-or-later
"""The project file (TOML, format 1): read strictly, paths relative to the file."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from ..base.errors import InputRefused
from ..base.finite import is_number
from ..base.toml_table import Source, Table, TomlDocument
from ..base.units import METERS, MODEL_UNIT
from ..readers import is_mesh_file
from ..settings.boreholes import Boreholes
from ..settings.dips import DipFile
from ..settings.field_table import FieldTable
from ..settings.map_file import MapFile
from ..settings.map_layer import MapLayer, is_wkt
from ..settings.method_options import checked
from ..settings.methods import OPTIONS
from ..settings.observation_file import ObservationFile
from ..settings.point_file import MeshFile, PointFile
from ..settings.schema import (
    BODY,
    FAULT,
    MESH_READING,
    PROJECT,
    READING,
    ROCK,
    SERIES,
    SERIES_VALUES,
    SURFACE,
)
from ..settings.setting import Settings
from .entry import check_file, is_file, refused_by
from .library import load_library
from .plan_input import is_place_elsewhere
from .project import Project, Rock, Surface
from .project_checks import check_project
from .series import Series
from .structure_entries import Body, Fault

SomeTable = TypeVar("SomeTable", bound=FieldTable)

FORMAT = 1
_OF_SURFACE = (
    *("series", "rule", "property", "block", "minimum_thickness", "true_thickness", "tie", "observed"),
    "correlation",
)
_BOREHOLES = 'write boreholes = { collars = "collars.csv", picks = "picks.csv" }'


def load_project(path: str | Path) -> Project:
    """The project of a file. Raises InputRefused, naming the line, for anything that is not as it must be.

    The files that it names have to exist; they are read when the model is built.
    """
    path = Path(path)
    document = TomlDocument(path)
    top = Table(document, document.content, (), "")
    version = top.integer("format", required=True)
    if version != FORMAT:
        raise top.refuse(f"unknown format {version}", "format", f"this version reads format {FORMAT}")
    top.allow_only(PROJECT)
    name = top.text("name", required=True)
    library = None
    if (library_file := top.text("library")) is not None:
        library_path = path.parent / library_file
        check_file(library_path, "library", top.refuse)
        library = load_library(library_path)
    rocks = [_read_rock(table, path.parent) for table in top.tables("rock", "rock")]
    faults = [_read_fault(table, path.parent) for table in _optional(top, "fault")]
    bodies = [_read_body(table, path.parent) for table in _optional(top, "body")]
    units = top.text("units") or MODEL_UNIT
    if units not in METERS:
        raise top.refuse(f"unknown unit '{units}'", "units", f"there are {', '.join(METERS)}")
    crs = _values(top, PROJECT, ("crs",)).get("crs")
    project = Project(name, rocks, library, path, units, faults, bodies, crs)
    check_project(project)
    return project


def _read_rock(table: Table, folder: Path) -> Rock:
    name = table.text("name", required=True)
    table.item = f"rock '{name}'"
    table.allow_only((*ROCK, "surface"))
    region, holes = _read_region(table, folder)
    return Rock(
        name=name,
        surfaces=[_read_surface(entry, folder) for entry in table.tables("surface", "surface")],
        region=region,
        holes=holes,
        size=_read_size(table, folder),
        constraints=_read_constraints(table, folder),
        boreholes=_read_boreholes(table, folder),
        observations=_read_field_table(table, "observations", folder, ObservationFile, "outcrops.csv"),
        dips=_read_field_table(table, "dips", folder, DipFile, "dips.csv"),
        map=_read_map(table, folder),
        names=table.content.get("names", {}),
        series=[_read_series(entry, folder) for entry in _optional(table, "series")],
        source=Source(table.document, table.path),
        **_values(table, ROCK, ("edge_length", "triangles", "mesher", "base_elevation")),
    )


def _values(table: Table, settings: Settings, keys: Sequence[str]) -> dict:
    """The values of keys that are there, as the declarations of settings allow."""
    found = {}
    for key in keys:
        if key in table:
            with refused_by(table.refuse, key):
                found[key] = checked(key, settings[key], table.content[key])
    return found


def _read_size(table: Table, folder: Path) -> list:
    size = table.content.get("size", [])
    if not isinstance(size, list):
        raise table.refuse(
            "'size' must be a list", "size", "write [{ at = ..., length = ..., distance = ... }]"
        )
    return [_read_place(table, entry, number, folder) for number, entry in enumerate(size)]


def _read_place(table: Table, entry: Any, number: int, folder: Path) -> Any:
    """An entry of `size`; where it is at a file, at a path or a MapLayer."""
    at = entry.get("at") if isinstance(entry, dict) else None
    if isinstance(at, dict):
        keys = Table(table.document, at, (*table.path, "size", number, "at"), table.item)
        return {**entry, "at": _layer_table(keys, folder)}
    if isinstance(at, str) and is_place_elsewhere(at) and not is_wkt(at):
        return {**entry, "at": folder / at}
    return entry


def _read_region(table: Table, folder: Path) -> Any:
    region = table.content.get("region")
    if isinstance(region, list) and _is_list_of_rings(region):
        region = [_read_ring(table, ring, ("region", number)) for number, ring in enumerate(region)]
    elif isinstance(region, list):
        region = _read_ring(table, region, ("region",))
    elif region is not None:
        region = _read_layer(table, "region", region, folder)
    holes = table.content.get("holes", [])
    if not isinstance(holes, list):
        raise table.refuse("'holes' must be a list of outlines", "holes", "write [[[x, y], ...], ...]")
    return region, [_read_ring(table, ring, ("holes", number)) for number, ring in enumerate(holes)]


def _is_list_of_rings(region: list) -> bool:
    def is_ring(ring: Any) -> bool:
        return isinstance(ring, list) and bool(ring) and all(isinstance(corner, list) for corner in ring)

    return bool(region) and all(map(is_ring, region))


def _read_layer(table: Table, key: str, given: Any, folder: Path) -> Any:
    """Reads a file, well-known text, or a table with a file and its options."""
    if isinstance(given, str) and is_wkt(given):
        return given
    if not isinstance(given, dict):
        return folder / table.text(key, required=True)
    return _layer_table(_inner(table, key, given), folder)


def _layer_table(keys: Table, folder: Path) -> MapLayer:
    keys.allow_only(("file", "layer", "where", "units"))
    values = {name: keys.content[name] for name in ("where", "units") if name in keys}
    return MapLayer(folder / keys.text("file", required=True), keys.text("layer"), **values)


def _read_constraints(table: Table, folder: Path) -> list:
    given = table.content.get("constraints", [])
    advice = 'write constraints = ["rivers.geojson", [[x, y], [x, y], ...], [x, y]]'
    if not isinstance(given, list):
        raise table.refuse("'constraints' must be a list of files, lines and points", "constraints", advice)
    found: list[str | Path | MapLayer | np.ndarray] = []
    for number, entry in enumerate(given):
        inner = Table(table.document, {"file": entry}, (*table.path, "constraints", number), table.item)
        if isinstance(entry, str):
            found.append(entry if is_wkt(entry) else folder / inner.text("file", required=True))
        elif isinstance(entry, dict):
            found.append(_layer_table(Table(table.document, entry, inner.path, table.item), folder))
        elif isinstance(entry, list) and entry and all(is_number(value) for value in entry):
            found.append(_read_ring(table, [entry], ("constraints", number))[0])
        elif isinstance(entry, list) and entry:
            found.append(_read_ring(table, entry, ("constraints", number)))
        else:
            raise inner.refuse("'constraints' has an entry that is not a file, line or point", advice=advice)
    return found


def _read_boreholes(table: Table, folder: Path) -> Boreholes | None:
    given = table.content.get("boreholes")
    if given is None:
        return None
    if isinstance(given, str):
        return Boreholes(folder / table.text("boreholes", required=True))
    if not isinstance(given, dict):
        raise table.refuse("'boreholes' must be a file or a table", "boreholes", _BOREHOLES)
    keys = _inner(table, "boreholes", given)
    said = ("columns", "separator", "decimal", "units", "downward_dip", "layer")
    files = ("picks", "collars", "survey", "intervals")
    keys.allow_only((*files, *said))
    values = {name: given[name] for name in said if name in given}
    for name in files:
        if (file := keys.text(name)) is not None:
            values[name] = folder / file
    return Boreholes(**values)


def _read_field_table(
    table: Table, key: str, folder: Path, kind: type[SomeTable], example: str
) -> SomeTable | None:
    given = table.content.get(key)
    if given is None:
        return None
    if isinstance(given, str):
        return kind(folder / table.text(key, required=True))
    if not isinstance(given, dict):
        raise table.refuse(f"'{key}' must be a file or a table", key, f'write {key} = "{example}"')
    keys = _inner(table, key, given)
    said = ("columns", "separator", "decimal", "units")
    keys.allow_only(("file", *said))
    values = {name: given[name] for name in said if name in given}
    return kind(folder / keys.text("file", required=True), **values)


def _read_map(table: Table, folder: Path) -> MapFile | None:
    given = table.content.get("map")
    if given is None:
        return None
    if not isinstance(given, dict):
        raise table.refuse(
            "'map' must be a table", "map", 'write map = { file = "geology.gpkg", block = "UNIT" }'
        )
    keys = _inner(table, "map", given)
    said = ("where", "units")
    keys.allow_only(("file", "layer", "block", "ground", "faults", "accuracy", *said))
    values = {name: given[name] for name in said if name in given}
    if "accuracy" in given:
        values["accuracy"] = keys.number("accuracy")
    if "faults" in given:
        values["faults"] = _read_layer(keys, "faults", given["faults"], folder)
    names = [entry.get("name") for entry in table.content.get("surface", []) if isinstance(entry, dict)]
    ground = given.get("ground")
    if isinstance(ground, dict):
        values["ground"] = _read_ground(_inner(keys, "ground", ground), folder)
    elif (named := keys.text("ground")) is not None:
        values["ground"] = named if named in names else folder / named
    file, block = (keys.text(key, required=True) for key in ("file", "block"))
    return MapFile(folder / file, block, keys.text("layer"), **values)


def _read_ground(keys: Table, folder: Path) -> PointFile | MeshFile:
    keys.allow_only(("file", *READING))
    file = folder / keys.text("file", required=True)
    said = {key: keys.content[key] for key in READING if key in keys}
    if is_file(file) and is_mesh_file(file) and set(said) <= set(MESH_READING):
        return MeshFile(file, **said)
    return PointFile(file, **said)


def _inner(table: Table, key: str, content: dict) -> Table:
    """A table within one, for reading its keys."""
    return Table(table.document, content, (*table.path, key), f"{table.item}, {key}")


def _read_ring(table: Table, ring: Any, path: tuple) -> np.ndarray:
    """One outline of coordinates. Errors name the line of the corner that is not two numbers."""

    def refuse(what: str, *corner: int) -> InputRefused:
        where = Table(table.document, {}, (*table.path, *path, *corner), table.item)
        return where.refuse(what, advice="write an outline as [[x, y], [x, y], [x, y], ...]")

    if not isinstance(ring, list):
        raise refuse(f"{path[0]}: an outline must be a list of corners")
    for number, corner in enumerate(ring):
        is_pair = isinstance(corner, list) and len(corner) == 2
        if not is_pair or not all(is_number(c) for c in corner):
            raise refuse(f"{path[0]}: a corner must be two finite numbers, not {corner!r}", number)
    return np.array(ring, np.float64).reshape(-1, 2)


def _read_series(table: Table, folder: Path) -> Series:
    name = table.text("name", required=True)
    table.item = f"{table.item.rpartition(', ')[0]}, series '{name}'"
    table.allow_only(SERIES)
    return Series(
        name,
        dips=_read_field_table(table, "dips", folder, DipFile, "dips.csv"),
        source=Source(table.document, table.path),
        **_values(table, SERIES, SERIES_VALUES),
    )


def _read_surface(table: Table, folder: Path) -> Surface:
    name = table.text("name", required=True)
    table.item = f"{table.item.rpartition(', ')[0]}, surface '{name}'"
    table.allow_only(SURFACE)
    options = {key: table.content[key] for key in OPTIONS if key in table}
    return Surface(
        name=name,
        method=table.text("method"),
        dips=_read_field_table(table, "dips", folder, DipFile, "dips.csv"),
        left_out=_read_left_out(table),
        options=options,
        source=Source(table.document, table.path),
        **_values(table, SURFACE, _OF_SURFACE),
        **_shape_files(table, folder),
    )


def _read_left_out(table: Table) -> np.ndarray | None:
    given = table.content.get("left_out")
    if given is None:
        return None
    is_list = isinstance(given, list) and all(isinstance(row, list) and len(row) == 3 for row in given)
    if not is_list or not all(is_number(value) for row in given for value in row):
        what = "'left_out' must be a list of points"
        raise table.refuse(what, "left_out", "write left_out = [[x, y, z], ...]")
    return np.array(given, np.float64).reshape(-1, 3)


def _shape_files(table: Table, folder: Path) -> dict:
    """The files of points, of a trace and of a mesh that a table names, with how they are read."""
    files: dict[str, object] = {
        key: folder / table.text(key, required=True) for key in ("points", "mesh") if key in table
    }
    if "trace" in table:
        files["trace"] = _read_trace(table, folder)
    reading = {key: table.content[key] for key in READING if key in table}
    mesh = files.get("mesh")
    if list(files) == ["mesh"] and isinstance(mesh, Path):
        said = {key: reading.pop(key) for key in MESH_READING if key in reading}
        if said:
            files["mesh"] = MeshFile(mesh, **said)
    if not reading:
        return files
    for key in ("points", "trace"):
        file = files.get(key)
        if isinstance(file, Path):
            return {**files, key: PointFile(file, **reading)}
    key = next(iter(reading))
    raise table.refuse(f"'{key}' needs a file of points", key)


def _read_trace(table: Table, folder: Path) -> Any:
    """A file, well-known text, one line, or several; z of points without one is NaN."""
    given = table.content["trace"]
    if isinstance(given, str):
        return given if is_wkt(given) else folder / table.text("trace", required=True)

    def refuse(what: str, *at: int) -> InputRefused:
        where = Table(table.document, {}, (*table.path, "trace", *at), table.item)
        return where.refuse(what, advice="write [[x, y], [x, y], ...], or [x, y, z] for each")

    def line(points: list, *at: int) -> np.ndarray:
        for number, point in enumerate(points):
            is_point = isinstance(point, list) and len(point) in (2, 3)
            if not is_point or not all(is_number(value) for value in point):
                raise refuse(f"trace: a point must be two or three numbers, not {point!r}", *at, number)
        return np.array([(*point, np.nan)[:3] for point in points], np.float64).reshape(-1, 3)

    if not isinstance(given, list):
        raise refuse("'trace' must be a file or a list of points")
    if _is_list_of_rings(given):
        return [line(points, number) for number, points in enumerate(given)]
    return line(given)


def _optional(top: Table, key: str) -> list[Table]:
    return top.tables(key, key) if key in top else []


def _read_fault(table: Table, folder: Path) -> Fault:
    name = table.text("name", required=True)
    table.item = f"fault '{name}'"
    table.allow_only(FAULT)
    stick = table.content.get("stick")
    if stick is not None and (isinstance(stick, bool) or not isinstance(stick, (str, int))):
        raise table.refuse(f"'stick' must be a column, by name or by number from 1, not {stick!r}", "stick")
    return Fault(
        name,
        stick=stick,
        ends_at=_names(table, "ends_at"),
        rocks=_names(table, "rocks"),
        source=Source(table.document, table.path),
        **_values(table, FAULT, ("youngest", "dies_out", "extend", "dip", "dip_direction", "elevation")),
        **_shape_files(table, folder),
    )


def _read_body(table: Table, folder: Path) -> Body:
    name = table.text("name", required=True)
    table.item = f"body '{name}'"
    table.allow_only(BODY)
    return Body(
        name,
        source=Source(table.document, table.path),
        **_values(table, BODY, ("after", "property", "void", "rock")),
        **_shape_files(table, folder),
    )


def _names(table: Table, key: str) -> tuple[str, ...]:
    names = table.content.get(key, [])
    if not isinstance(names, list) or not all(isinstance(name, str) for name in names):
        raise table.refuse(f"'{key}' must be a list of names", key, f'write {key} = ["..."]')
    return tuple(names)
