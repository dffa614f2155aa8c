# SPDX-License-Identifier: GPL-3.0-or-later
"""The folder of a proposed project: project.toml with its reasons, tables, library, proposal.json."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ..base.atomic import Outputs, explained
from ..base.errors import OutputFailed
from ..base.units import MODEL_UNIT
from ..project.entry import changed_values
from ..project.project import Project, Rock, Surface
from ..project.project_file import load_project
from ..project.project_writer import library_text, off_text, points_text, region_text, toml_value
from ..project.structure_entries import Body
from ..readers.map_input import map_companions
from ..readers.point_input import companions
from ..settings.data_files import MapLayer, MeshFile, PointFile, is_wkt, list_of
from .choices import Proposal

_PROJECT, _LIBRARY, _PROPOSAL, _GROUND = "project.toml", "library.toml", "proposal.json", "ground.csv"
_WIDTH = 110  # of comments


def save_folder(project: Project, proposal: Proposal, folder: str | Path) -> Path:
    """Writes a proposed project to a new folder; the path of its project file. Raises OutputFailed."""
    folder = Path(folder)
    require_new(folder)
    with Outputs() as outputs, outputs.folder(folder, _PROJECT) as waiting:
        files = _Files(waiting, folder)
        text = "\n".join(_project_lines(project, proposal, files)) + "\n"
        files.write(_LIBRARY, library_text(project.library).encode() if project.library else b"")
        files.write(_PROPOSAL, json.dumps(_as_json(proposal), indent=1, ensure_ascii=False).encode())
        files.write(_PROJECT, text.encode())
        load_project(waiting / _PROJECT)  # what it says is right
    return folder / _PROJECT


def require_new(folder: Path) -> None:
    """Raises OutputFailed if the path of a new folder exists."""
    if folder.exists():
        raise OutputFailed(f"{folder}: it exists; choose a new folder")


class _Files:
    """The files of the folder. taken: their names."""

    def __init__(self, waiting: Path, folder: Path):
        self._waiting, self._folder = waiting, folder
        self._copies: dict[Path, str] = {}
        self.taken: set[str] = set()
        self._reserved = {_PROJECT, _LIBRARY, _PROPOSAL, _GROUND}

    def write(self, name: str, content: bytes) -> str:
        with explained(self._folder / name):
            (self._waiting / name).write_bytes(content)
        self.taken.add(name)
        return name

    def free(self, stem: str, ending: str) -> str:
        """A name that no file has."""
        name, number = stem + ending, 2
        lower = {other.casefold() for other in (*self.taken, *self._reserved)}
        while name.casefold() in lower:
            name, number = f"{stem}_{number}{ending}", number + 1
        return name

    def copy(self, file: str | Path, beside: Callable[[Path], list[Path]] = companions) -> str:
        """Copies a file, with those that are read with it, once."""
        file = Path(file)
        if file.resolve() not in self._copies:
            name = self.free(file.stem, file.suffix)
            self._copies[file.resolve()] = self.write(name, file.read_bytes())
            for other in beside(file):
                ending = (
                    other.name.removeprefix(file.stem) if other.name.startswith(file.stem) else other.suffix
                )
                self.write(Path(name).stem + ending, other.read_bytes())
        return self._copies[file.resolve()]


def _project_lines(project: Project, proposal: Proposal, files: _Files) -> list[str]:
    rock = project.rocks[0]
    lines = [
        *_comment(
            "Made by `realmodel new`. Change what you like: the comments say why each choice was made, and "
            "docs/reference/project_file.md what else there is. All that was found is in proposal.json."
        ),
        "format = 1",
        f"name = {toml_value(project.name)}",
        *([f"units = {toml_value(project.units)}"] if project.units != MODEL_UNIT else []),
        *_comment(f"The coordinate system: {proposal.reasons['crs']}"),
        *([f"crs = {toml_value(project.crs)}"] if project.crs is not None else []),
        "# A color for each unit, by the rock in its name",
        f'library = "{_LIBRARY}"',
        "",
        "[[rock]]",
        f"name = {toml_value(rock.name)}",
        *_rock_lines(rock, proposal.reasons, files),
        *(line for series in rock.series for line in ("", "[[rock.series]]", *_keys(series))),
        "",
        *_order_comment(proposal),
    ]
    reasons = {choice.unit: choice.reason for choice in proposal.rules}
    for surface in rock.surfaces:
        unit = surface.block or surface.name
        why = reasons.get(unit) if surface is not rock.surfaces[-1] else proposal.reasons.get("ground")
        lines += ["", *_surface_lines(surface, why, files)]
    for body, lens in zip(project.bodies, proposal.lenses, strict=True):
        holes = ", ".join(f"'{hole}'" for hole, _ in lens.parts)
        lines += [
            "",
            *_comment(f"'{lens.unit}' in hole {holes} lies in '{lens.host}', out of order: a lens"),
            "[[body]]",
            f"name = {toml_value(body.name)}",
            *_body_shape(body, files),
            *([] if body.after is None else [f"after = {toml_value(body.after)}"]),
            f"property = {body.property}",
        ]
    return lines


def _body_shape(body: Body, files: _Files) -> list[str]:
    if body.vertices is None or body.triangles is None:
        return [f"reach = {toml_value(body.reach)}  # beyond the intervals that bear its name"]
    mesh = files.write(files.free("lens", ".off"), off_text(body.vertices, body.triangles))
    return [f'mesh = "{mesh}"']


def _rock_lines(rock: Rock, why: Mapping[str, str], files: _Files) -> list[str]:
    lines = [*_comment(f"The region is {why['region']}"), f"region = {_region_text(rock.region, files)}"]
    lines += [
        *_comment(f"Interpolation: {why['method']}"),
        *_comment(f"The edge length of the triangles: {why['edge_length']}"),
        f"edge_length = {toml_value(rock.edge_length)}",
        *_comment(f"The base: {why['base_elevation']}"),
        f"base_elevation = {toml_value(rock.base_elevation)}",
    ]
    if rock.boreholes is not None:
        lines += ["# The tables as they were given", f"boreholes = {_inline(rock.boreholes, files)}"]
    if rock.map is not None:
        lines += ["# The polygons of units on the ground", f"map = {_inline(rock.map, files)}"]
    if rock.dips is not None:
        lines.append(f"dips = {_inline(rock.dips, files)}")
    if rock.names:
        lines += ["# What codes in the tables mean, as given", f"names = {toml_value(rock.names)}"]
    return lines


def _order_comment(proposal: Proposal) -> list[str]:
    lines = _comment(
        "The order of units, oldest first, by which lies over which: " + ", ".join(proposal.order)
    )
    for other in proposal.alternatives:
        lines += _comment(
            f"Not decided: '{other.younger}' is taken to be younger than '{other.older}' "
            f"({'; '.join(other.reasons)}). Otherwise exchange their surfaces: {', '.join(other.order)}"
        )
    for conflict in proposal.conflicts:
        lines += _comment(
            f"Against this order, and not used: '{conflict.upper}' over '{conflict.lower}' in hole "
            f"'{conflict.hole}' at depth {conflict.depth:.9g}"
        )
    return lines


def _surface_lines(surface: Surface, why: str | None, files: _Files) -> list[str]:
    lines = [] if why is None else _comment(f"{surface.rule}: {why}" if surface.points is None else why)
    lines += ["[[rock.surface]]", f"name = {toml_value(surface.name)}"]
    for key in ("points", "mesh"):
        shape = getattr(surface, key)
        if isinstance(shape, (PointFile, MeshFile)):
            lines += [f"{k} = {v}" for k, v in _entries(shape, files, key).items()]
        elif shape is not None:
            lines.append(f"{key} = {toml_value(files.write(_GROUND, points_text(np.asarray(shape))))}")
    if surface.method is not None:
        lines.append(f"method = {toml_value(surface.method)}")
    if surface.series is not None:
        lines.append(f"series = {toml_value(surface.series)}")
    lines.append(f"rule = {toml_value(surface.rule)}")
    if surface.block is not None:
        lines.append(f"block = {toml_value(surface.block)}")
    return [*lines, f"property = {surface.property}"]


def _keys(entry: Any) -> list[str]:
    return [f"{part.key} = {toml_value(value)}" for part, value in changed_values(entry)]


def _region_text(region: Any, files: _Files) -> str:
    if isinstance(region, MapLayer):
        return _inline(region, files)
    if isinstance(region, (str, Path)):
        is_text = isinstance(region, str) and is_wkt(region)
        return toml_value(region if is_text else files.copy(region, map_companions))
    return region_text(region)


def _entries(given: Any, files: _Files, name: str = "file") -> dict[str, str]:
    """The keys of a file and how it is read, as TOML. name: the key of the file."""
    entries = {}
    for part, value in changed_values(given):
        if part.setting.kind == "file":
            beside = map_companions if not isinstance(given, PointFile) else companions
            text = toml_value(files.copy(value, beside))
        elif isinstance(value, Path):
            text = toml_value(files.copy(value))
        else:
            text = _inline(value, files) if is_dataclass(value) else toml_value(_copied(part, value, files))
        entries[name if part.key == "file" else part.key] = text
    return entries


def _copied(part: Any, value: Any, files: _Files) -> Any:
    """A file as a text, several as a list, or a value that is none."""
    if part.setting.kind == "files":
        return [files.copy(file) for file in list_of(value)]
    is_file = part.setting.kind in ("ground", "layer_file") and isinstance(value, str) and not is_wkt(value)
    return files.copy(value) if is_file else value


def _inline(given: Any, files: _Files) -> str:
    """A file, or a table of it and its keys."""
    entries = _entries(given, files)
    if list(entries) == ["file"]:
        return entries["file"]
    return "{ " + ", ".join(f"{key} = {text}" for key, text in entries.items()) + " }"


def _comment(text: str) -> list[str]:
    """Lines of a comment."""
    lines, line = [], "#"
    for word in " ".join(text.split()).split(" "):
        if len(line) + len(word) >= _WIDTH and line != "#":
            lines.append(line)
            line = "#"
        line += f" {word}"
    return [*lines, line]


def _as_json(value: Any) -> Any:
    if is_dataclass(value) and not isinstance(value, type):
        return {field.name: _as_json(getattr(value, field.name)) for field in fields(value)}
    if isinstance(value, Mapping):
        return {str(key): _as_json(part) for key, part in value.items()}
    if isinstance(value, (list, tuple)):
        return [_as_json(part) for part in value]
    if isinstance(value, np.ndarray):
        return value.tolist()
    return None if isinstance(value, float) and value != value else value
