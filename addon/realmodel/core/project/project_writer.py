# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes a project to a project file, with its library, meshes and points in files beside it.

Numbers have as many digits as they need: the project that is read back is the same, bit for bit.
"""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ..base.atomic import Outputs, make_folder
from ..base.errors import UsageError
from ..base.triangles import checked_triangulation
from ..readers import UnitNames
from ..settings.dips import Dips, SpaceDips, as_given
from .entry import changed_values
from .library import Library
from .plan_input import is_several, map_layer
from .project import PROJECT_FILE, Project, Rock, Surface
from .project_checks import check_project
from .structure_entries import Body, Fault

_NOT_IN_FILE_NAMES = re.compile(r"[^\w.-]+")


def save_project(project: Project, path: str | Path) -> list[Path]:
    """Writes a project whose shapes are arrays to a project file; returns all files written.

    Its library goes to NAME_library.toml beside it, each mesh to an OFF file, points and dips to CSV files,
    named after the project file, the rock mass and the surface, or the fault. All appear whole or none does.
    Raises UsageError for another ending than .toml, InputRefused for a project that could not be built,
    OutputFailed.
    """
    path = Path(path)
    if path.suffix.lower() != ".toml":
        raise UsageError(f"{path}: a project file ends in .toml")
    project = check_project(project)
    with Outputs() as outputs:
        files = _Beside(path, outputs)
        lines = ["format = 1", *_entry_lines(project, files, (), "")]
        with outputs.file(path) as file:
            file.write(("\n".join(lines) + "\n").encode())
    return [path, *files.written]


def _save(self: Project, folder: str | Path) -> Path:
    """Writes the project into a folder, which is made if needed: project.toml, whose path is returned,
    and beside it the arrays as tables and meshes. load_project of it, or of the folder, is the same
    project. Files that were there under these names are replaced; all appear whole or none does.

    Raises UsageError where a file that the project names was not read yet (the project of its built
    model has all), InputRefused for a project that could not be built, OutputFailed.
    """
    path = Path(folder) / PROJECT_FILE
    make_folder(folder)
    save_project(self, path)
    return path


Project.save = _save


class _Beside:
    """The files that are written beside a project file."""

    def __init__(self, path: Path, outputs: Outputs):
        self._path, self._outputs = path, outputs
        self._taken = {path.name.lower()}
        self.written: list[Path] = []

    def write(self, parts: tuple[str, ...], ending: str, content: bytes) -> str:
        """Writes a file to a free name, the same for the same project, which it returns."""
        named = (self._path.stem, *parts)
        stem = "_".join(_NOT_IN_FILE_NAMES.sub("_", part).strip("._") or "x" for part in named)
        name, number = stem + ending, 2
        while name.lower() in self._taken:
            name, number = f"{stem}_{number}{ending}", number + 1
        self._taken.add(name.lower())
        target = self._path.parent / name
        with self._outputs.file(target) as file:
            file.write(content)
        self.written.append(target)
        return name


def save_library(library: Library, path: str | Path) -> None:
    """Writes a library file. Raises UsageError for another ending than .toml, OutputFailed."""
    path = Path(path)
    if path.suffix.lower() != ".toml":
        raise UsageError(f"{path}: a library file ends in .toml")
    with Outputs() as outputs, outputs.file(path) as file:
        file.write(library_text(library).encode())


def library_text(library: Library) -> str:
    """A library as TOML."""
    tables = []
    for entry in library:
        values = {part.key: value for part, value in changed_values(entry)}
        tables.append("\n".join(["[[property]]", *_lines(values)]))
    return "\n\n".join(tables) + "\n"


class _Value(NamedTuple):
    """A value to be written: its key, the names of its entry and of those around it, the rock mass around it,
    the tables that the entry is in, and the files."""

    value: Any
    key: str
    names: tuple[str, ...]
    rock: Rock | None
    tables: str
    files: _Beside

    def text(self) -> str:
        return toml_value(self.value)


def _entry_lines(
    entry: Any, files: _Beside, names: tuple[str, ...], tables: str, rock: Rock | None = None
) -> list[str]:
    """The lines of a project, rock mass, surface, series, fault or body."""
    lines: list[str] = []
    for part, value in changed_values(entry):
        field = _Value(value, part.key, names, rock, tables, files)
        if part.setting.kind == "tables":
            lines += _tables(field)
        elif part.setting.kind == "options":
            lines += _lines(value)
        elif (text := WRITE.get(part.setting.kind, _Value.text)(field)) is not None:
            lines.append(f"{part.key} = {text}")
    return lines


def _tables(field: _Value) -> list[str]:
    lines, tables = [], f"{field.tables}.{field.key}".strip(".")
    for entry in field.value:
        rock = entry if isinstance(entry, Rock) else field.rock
        names = (*field.names, entry.name) if rock else (field.key, entry.name)
        _require_read(entry)
        lines += ["", f"[[{tables}]]", *_entry_lines(_as_written(entry), field.files, names, tables, rock)]
    return lines


def _require_read(entry: Any) -> None:
    """Refuses an entry with files that were not read."""
    if isinstance(entry, Rock):
        unread = {
            "boreholes": entry.boreholes,
            "map": entry.map,
            "observations": entry.observation_file,
            "dips": entry.dip_file,
            "file of constraints": next(
                (c for c in entry.constraints if isinstance(c, str) or map_layer(c) is not None), None
            ),
        }
        for what, file in unread.items():
            if file is not None:
                raise UsageError(f"{entry.item}: its {what} was not read yet; build it first")
        if entry.region_file is not None or isinstance(entry.region, str):
            raise UsageError(f"{entry.item}: its region has not been read; build the model first")
        return
    files = [getattr(entry, name, None) for name in ("input_file", "dip_file")]
    if any(files) or isinstance(getattr(entry, "trace", None), str):
        raise UsageError(f"{entry.item}: its file has not been read; build the model first")


def _as_written(entry: Any) -> Any:
    """An entry with the arrays that it is made from: those of its mesh, if no others."""
    if isinstance(entry, Rock):
        return replace(entry, names={})  # what they mean is in the observations
    is_not_read = isinstance(entry, Fault) and entry.vertices is None
    is_of_intervals = isinstance(entry, Body) and not entry.has_shape  # which are in the observations
    if (isinstance(entry, Surface) and entry.has_points) or is_not_read or is_of_intervals:
        return entry
    if isinstance(entry, Fault):
        entry = replace(entry, points=None, dips=None, stick=None, extend=0.0)
    if isinstance(entry, (Surface, Fault, Body)):
        return replace(entry, mesh=entry.triangulation())  # type: ignore[arg-type]  # instead of a file
    return entry


def _library(field: _Value) -> str:
    return toml_value(field.files.write(("library",), ".toml", library_text(field.value).encode()))


def _points(field: _Value) -> str | None:
    if not len(field.value):
        return None
    is_sticks = np.ndim(field.value[0]) > 1
    text = sticks_text(field.value) if is_sticks else points_text(field.value)
    return toml_value(field.files.write(field.names, ".csv", text))


def _mesh(field: _Value) -> str:
    return toml_value(field.files.write(field.names, ".off", off_text(*field.value)))


def _table_file(field: _Value) -> str | None:
    """Dips, or observations."""
    table, rock = field.value, field.rock
    if not len(table):
        return None
    if isinstance(table, SpaceDips):
        text = space_dips_text(table)
    else:
        assert rock is not None
        text = _named_dips_text(rock, table) if isinstance(table, Dips) else observations_text(rock)
    return toml_value(field.files.write((*field.names, field.key), ".csv", text))


def _places(field: _Value) -> str | None:
    return toml_value(np.asarray(field.value, np.float64).tolist()) if len(field.value) else None


def _region(field: _Value) -> str:
    return region_text(field.value)


def region_text(region: Any) -> str:
    """An outline (N, 2), or several, as TOML."""
    return _rings_text(region) if is_several(region) else _ring_text(region)


def _trace(field: _Value) -> str:
    line = field.value
    return _rings_text(line) if len(line) and np.ndim(line[0]) > 1 else _ring_text(line)


def _rings_text(rings: Any) -> str:
    return "[\n  " + ",\n  ".join(_ring_text(ring) for ring in rings) + ",\n]"


def _ring_text(ring: Any) -> str:
    corners = [_point_text(point) for point in np.asarray(ring, np.float64).tolist()]
    rows = [", ".join(corners[start : start + 4]) for start in range(0, len(corners), 4)]
    return "[" + ",\n  ".join(rows) + "]"


def _point_text(point: list[float]) -> str:
    """A point of two or three numbers; without z where there is none."""
    return "[" + ", ".join(repr(value) for value in point if value == value) + "]"


def _lines(values: Mapping) -> list[str]:
    return [f"{key} = {toml_value(value)}" for key, value in values.items() if value is not None]


# By the kinds of settings; values of other kinds are written as they are.
WRITE: Mapping[str, Callable[[_Value], str | None]] = {
    "library": _library,
    "points": _points,
    "mesh": _mesh,
    "table_file": _table_file,
    "places": _places,
    "region": _region,
    "rings": lambda field: _rings_text(field.value) if len(field.value) else None,
    "constraints": lambda field: _rings_text(field.value) if len(field.value) else None,
    "trace": _trace,
}


def toml_value(value: Any) -> str:
    """A value as TOML in one line. Raises UsageError for what TOML has no form for."""
    if hasattr(value, "settings"):  # a variogram found by an earlier interpolation
        value = value.settings()
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (int, float)):
        return repr(value)
    if isinstance(value, str):
        return _text(value)
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{_key(str(key))} = {toml_value(part)}" for key, part in value.items()) + "}"
    if isinstance(value, (list, tuple, np.ndarray)):
        return "[" + ", ".join(toml_value(part) for part in value) + "]"
    raise UsageError(f"{value!r} cannot be written to a project file")


def _key(name: str) -> str:
    return name if re.fullmatch(r"[A-Za-z0-9_-]+", name) else _text(name)


def _text(value: str) -> str:
    escaped = value.replace("\\", "\\\\").replace('"', '\\"')
    return '"' + "".join(c if ord(c) >= 32 and ord(c) != 127 else f"\\u{ord(c):04x}" for c in escaped) + '"'


def points_text(points: ArrayLike) -> bytes:
    """Points (P, 3) as CSV."""
    return b"x,y,z\n" + _rows(np.asarray(points, np.float64), ",")


def sticks_text(sticks: Sequence[ArrayLike]) -> bytes:
    """Fault sticks, (N, 3) each, as CSV, numbered from 1."""
    body = [
        b"%d,%s\n" % (number, row)
        for number, stick in enumerate(sticks, 1)
        for row in _rows(np.asarray(stick, np.float64), ",").splitlines()
    ]
    return b"stick,x,y,z\n" + b"".join(body)


def dips_text(dips: Dips) -> bytes:
    """Dips as CSV: their slopes, of which angles would not give back each bit."""
    dips = as_given(dips)
    columns: list = [*dips.positions.T.tolist(), *dips.gradients.T.tolist()]
    names = ["x", "y", "slope_x", "slope_y"]
    if np.isfinite(dips.heights).any():
        names.append("z")
        columns.append(["" if np.isnan(z) else z for z in dips.heights.tolist()])
    for name, texts in zip(("surface", "block"), dips.named, strict=True):
        if (texts != "").any():
            names.append(name)
            columns.append(texts.tolist())
    if not dips.in_use.all():
        names.append("use")
        columns.append(dips.in_use.astype(int).tolist())
    text = io.StringIO()
    table = csv.writer(text, lineterminator="\n")
    table.writerows([names, *zip(*columns, strict=True)])
    return text.getvalue().encode()


def _named_dips_text(rock: Rock, dips: Dips) -> bytes:
    """Dips that may name surfaces and blocks of a rock mass, as CSV."""
    surfaces, blocks = dips.named
    codes = _block_codes(rock)
    meant = np.array([codes.get(block, block) for block in blocks.tolist()], str)
    return dips_text(replace(dips, surfaces=surfaces, blocks=meant))


def _block_codes(rock: Rock) -> dict[str, str]:
    """For each surface of a rock mass, the name that means the block beneath it when a table is read."""
    surfaces = [surface.name for surface in rock.surfaces]
    units = UnitNames(surfaces, rock.block_names())
    return {
        name: next((code for code in (name, block) if units.block(code) == name), name)
        for name, block in zip(surfaces, rock.block_names(), strict=True)
    }


def space_dips_text(dips: SpaceDips) -> bytes:
    """Dips in space as CSV: their normals, of which angles would not give back each bit."""
    dips = as_given(dips)
    names, numbers = "x,y,z,normal_x,normal_y,normal_z", np.hstack([dips.positions, dips.normals])
    if dips.in_use.all():
        return f"{names}\n".encode() + _rows(numbers, ",")
    rows = [[*map(repr, row), str(int(use))] for row, use in zip(numbers.tolist(), dips.in_use, strict=True)]
    return "\n".join(map(",".join, [[f"{names},use"], *rows, [""]])).encode()


def observations_text(rock: Rock) -> bytes:
    """The observations of a rock mass as CSV, each block by a name that means it when the table is read."""
    observations = rock.observed
    assert observations is not None
    written = _block_codes(rock)
    text = io.StringIO()
    table = csv.writer(text, lineterminator="\n")
    more = {}
    if not observations.in_use.all():
        more["use"] = observations.in_use.astype(int).tolist()
    if (observations.seen_on != "").any():
        more["seen_on"] = observations.on.tolist()
    if observations.errors.any():
        more["height_error"] = observations.errors.tolist()
    if not np.isnan(observations.thicknesses_there).all():
        more["thickness"] = ["" if np.isnan(t) else t for t in observations.thicknesses.tolist()]
    table.writerow(("x", "y", "z", "block", "hole", "depth", *more))
    for place, block, hole, depth, *others in zip(
        observations.places.tolist(),
        observations.blocks.tolist(),
        observations.holes.tolist(),
        observations.depths.tolist(),
        *more.values(),
        strict=True,
    ):
        row = (*place, written.get(block, block), hole, "" if np.isnan(depth) else depth)
        table.writerow((*row, *others))
    return text.getvalue().encode()


def off_text(vertices: np.ndarray, triangles: np.ndarray) -> bytes:
    """A triangulation as an OFF file."""
    vertices, triangles = checked_triangulation(vertices, triangles)
    head = f"OFF\n{len(vertices)} {len(triangles)} 0\n".encode()
    corners = np.column_stack([np.full(len(triangles), 3, np.int32), triangles])
    return head + _rows(vertices, " ") + _rows(corners, " ")


def _rows(numbers: np.ndarray, apart: str) -> bytes:
    """One row per line, each number with the fewest digits that identify it."""
    text = io.StringIO()
    for row in numbers.tolist():
        text.write(apart.join(map(repr, row)) + "\n")
    return text.getvalue().encode()
