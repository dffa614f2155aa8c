# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes a project to a project file, with its library, meshes and points in files beside it.

Numbers have as many digits as they need: the project that is read back is the same, bit for bit.
"""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Callable, Mapping
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..base.atomic import Outputs
from ..base.errors import UsageError
from ..base.triangles import checked_triangulation
from ..base.units import MODEL_UNIT
from ..readers import UnitNames
from ..settings.dips import Dips, SpaceDips, as_given
from ..settings.meshers import DEFAULT_MESHER
from ..settings.point_file import PointFile
from ..settings.rules import DEFAULT_RULE
from ..settings.series import AUTO, FIELD
from .library import Library, Property
from .plan_input import map_layer
from .project import Project, Rock, Surface
from .project_checks import check_project
from .region_rings import is_several
from .series import Series
from .structure_entries import Body, Fault

_NOT_IN_FILE_NAMES = re.compile(r"[^\w.-]+")


def save_project(project: Project, path: str | Path) -> list[Path]:
    """Writes a project whose shapes are arrays to a project file; returns all files written.

    Its library goes to NAME_library.toml beside it, each mesh to an OFF and the points of each surface to a
    CSV file, named after the project file, the rock mass and the surface; faults and bodies to OFF files. All
    appear whole or none does.
    Raises UsageError for another ending than .toml, InputRefused for a project that could not be built,
    OutputFailed.
    """
    path = Path(path)
    if path.suffix.lower() != ".toml":
        raise UsageError(f"{path}: a project file ends in .toml")
    check_project(project)
    taken: set[str] = {path.name.lower()}

    def beside(*parts: str, ending: str) -> Path:
        """A free name beside the project file, the same for the same project."""
        stem = "_".join(_NOT_IN_FILE_NAMES.sub("_", part).strip("._") or "x" for part in (path.stem, *parts))
        name, number = stem + ending, 2
        while name.lower() in taken:
            name, number = f"{stem}_{number}{ending}", number + 1
        taken.add(name.lower())
        return path.parent / name

    with Outputs() as outputs:
        written = [path]

        def write(target: Path, content: bytes) -> str:
            with outputs.file(target) as file:
                file.write(content)
            written.append(target)
            return target.name

        lines = ["format = 1", f"name = {toml_value(project.name)}"]
        if project.units != MODEL_UNIT:
            lines.append(f"units = {toml_value(project.units)}")
        if project.crs is not None:
            lines.append(f"crs = {toml_value(project.crs)}")
        if project.library is not None:
            library = write(beside("library", ending=".toml"), library_text(project.library).encode())
            lines.append(f"library = {toml_value(library)}")
        for rock in project.rocks:
            unread = {
                "boreholes": rock.boreholes,
                "map": rock.map,
                "observations": rock.observation_file,
                "dips": rock.dip_file,
                "file of constraints": next(
                    (c for c in rock.constraints if isinstance(c, str) or map_layer(c) is not None), None
                ),
            }
            for what, given in unread.items():
                if given is not None:
                    raise UsageError(f"rock '{rock.name}': its {what} was not read yet; build it first")
            lines += ["", "[[rock]]", *_rock_lines(rock)]
            if rock.observed is not None and len(rock.observed):
                target = beside(rock.name, "observations", ending=".csv")
                lines.append(f"observations = {toml_value(write(target, observations_text(rock)))}")
            if isinstance(rock.dips, Dips) and len(rock.dips):
                target = beside(rock.name, "dips", ending=".csv")
                lines.append(f"dips = {toml_value(write(target, _named_dips_text(rock, rock.dips)))}")
            for series in rock.series:
                lines += ["", "[[rock.series]]", *_series_lines(rock, series, beside, write)]
            for surface in rock.surfaces:
                files = _surface_files(rock, surface, beside, write)
                lines += ["", "[[rock.surface]]", *_surface_lines(surface, files)]
        for kind, entries in (("fault", project.faults), ("body", project.bodies)):
            for entry in entries:
                lines += ["", f"[[{kind}]]", *_structure_lines(kind, entry, beside, write)]
        with outputs.file(path) as file:
            file.write(("\n".join(lines) + "\n").encode())
    return written


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
        values = {field.name: getattr(entry, field.name) for field in fields(Property)}
        tables.append("\n".join(["[[property]]", *_lines(values)]))
    return "\n\n".join(tables) + "\n"


def _rock_lines(rock: Rock) -> list[str]:
    lines = _lines(
        {
            "name": rock.name,
            "edge_length": rock.edge_length,
            "triangles": rock.triangles,
            "size": list(rock.size) or None,
            "mesher": rock.mesher if rock.mesher != DEFAULT_MESHER else None,
            "base_elevation": rock.base_elevation,
        }
    )
    if rock.region is not None:
        if rock.region_file is not None or isinstance(rock.region, str):
            raise UsageError(f"rock '{rock.name}': its region has not been read; build the model first")
        several = is_several(rock.region)
        lines.append(f"region = {_rings_text(rock.region) if several else _ring_text(rock.region)}")
        if len(rock.holes):
            lines.append(f"holes = {_rings_text(rock.holes)}")
    if len(rock.constraints):
        lines.append(f"constraints = {_rings_text(rock.constraints)}")
    return lines


def _rings_text(rings: Any) -> str:
    return "[\n  " + ",\n  ".join(_ring_text(ring) for ring in rings) + ",\n]"


def _ring_text(ring: Any) -> str:
    corners = [_point_text(point) for point in np.asarray(ring, np.float64).tolist()]
    rows = [", ".join(corners[start : start + 4]) for start in range(0, len(corners), 4)]
    return "[" + ",\n  ".join(rows) + "]"


def _point_text(point: list[float]) -> str:
    """A point of two or three numbers; without z where there is none."""
    return "[" + ", ".join(repr(value) for value in point if value == value) + "]"


def _series_lines(rock: Rock, series: Series, beside: Callable, write: Callable) -> list[str]:
    if series.dip_file is not None:
        raise UsageError(f"{series.item}: its file has not been read; build the model first")
    dips, file = series.dips, None
    if isinstance(dips, (Dips, SpaceDips)) and len(dips):
        text = space_dips_text(dips) if isinstance(dips, SpaceDips) else _named_dips_text(rock, dips)
        file = write(beside(rock.name, series.name, "dips", ending=".csv"), text)
    values = {
        "name": series.name,
        "kind": series.kind if series.kind != FIELD else None,
        "dips": file,
        "resolution": series.resolution if series.resolution != AUTO else None,
        "thickness": series.thickness if series.thickness != AUTO else None,
    }
    return _lines(values)


def _surface_files(rock: Rock, surface: Surface, beside: Callable, write: Callable) -> dict[str, str]:
    """The names of the files of a surface, by their keys."""
    if surface.input_file is not None or surface.dip_file is not None:
        raise UsageError(f"surface '{surface.name}': its file has not been read; build the model first")
    if surface.has_points:
        points = surface.own_points()  # its contacts follow from the observations again
        dips, files = surface.own_dips(), {}
        if points is not None and len(points):
            target = beside(rock.name, surface.name, ending=".csv")
            files["points"] = write(target, points_text(points))
        if dips is not None and len(dips):
            target = beside(rock.name, surface.name, "dips", ending=".csv")
            files["dips"] = write(target, dips_text(dips))
        return files
    target = beside(rock.name, surface.name, ending=".off")
    return {"mesh": write(target, off_text(*surface.triangulation()))}


def _surface_lines(surface: Surface, files: Mapping[str, str]) -> list[str]:
    given = surface
    values: dict[str, object] = {"name": given.name, "series": given.series, **files}
    # for a ready mesh the method is only for its continuation to faults
    values |= {"method": given.method, **given.options}
    if given.left_out is not None and len(given.left_out):
        values["left_out"] = np.asarray(given.left_out, np.float64).tolist()
    values |= {
        "minimum_thickness": given.minimum_thickness,
        "true_thickness": given.true_thickness or None,
        "tie": None if given.tie else False,
        "observed": given.observed or None,
        "correlation": given.correlation,
        "rule": given.rule if given.rule != DEFAULT_RULE else None,
        "property": given.property or None,
        "block": given.block,
    }
    return _lines(values)


def _structure_lines(kind: str, entry: Fault | Body, beside: Callable, write: Callable) -> list[str]:
    trace = entry.trace if isinstance(entry, Fault) else None
    if entry.input_file is not None or isinstance(trace, str):
        raise UsageError(f"{kind} '{entry.name}': its file has not been read; build the model first")
    keys = ("youngest", "ends_at", "dies_out", "rocks")
    keys = keys if kind == "fault" else ("after", "property", "void", "rock")
    values = {key: getattr(entry, key) or None for key in keys}
    if isinstance(entry, Fault) and trace is not None:
        assert not isinstance(trace, (Path, PointFile))  # it has no input file
        own = {key: getattr(entry, key) for key in ("dip", "dip_direction", "elevation")}
        lines = _lines({"name": entry.name} | own | {"extend": entry.extend or None} | values)
        several = len(trace) and np.ndim(trace[0]) > 1
        return [*lines, f"trace = {_rings_text(trace) if several else _ring_text(trace)}"]
    if entry.vertices is None:
        raise UsageError(
            f"{kind} '{entry.name}': no surface is fitted to its points yet; build the model first"
        )
    mesh = write(beside(kind, entry.name, ending=".off"), off_text(*entry.triangulation()))
    return _lines({"name": entry.name, "mesh": mesh} | values)


def _lines(values: Mapping) -> list[str]:
    return [f"{key} = {toml_value(value)}" for key, value in values.items() if value is not None]


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
        return "{" + ", ".join(f"{key} = {toml_value(part)}" for key, part in value.items()) + "}"
    if isinstance(value, (list, tuple, np.ndarray)):
        return "[" + ", ".join(toml_value(part) for part in value) + "]"
    raise UsageError(f"{value!r} cannot be written to a project file")


def _text(value: str) -> str:
    escaped = value.replace("\\", "\\\\").replace('"', '\\"')
    return '"' + "".join(c if ord(c) >= 32 and ord(c) != 127 else f"\\u{ord(c):04x}" for c in escaped) + '"'


def points_text(points: ArrayLike) -> bytes:
    """Points (P, 3) as CSV."""
    return b"x,y,z\n" + _rows(np.asarray(points, np.float64), ",")


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
        name: next((each for each in (name, block) if units.block(each) == name), name)
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
    given = rock.observed
    assert given is not None
    written = _block_codes(rock)
    text = io.StringIO()
    table = csv.writer(text, lineterminator="\n")
    more = {}
    if not given.in_use.all():
        more["use"] = given.in_use.astype(int).tolist()
    if (given.seen_on != "").any():
        more["seen_on"] = given.on.tolist()
    if given.errors.any():
        more["height_error"] = given.errors.tolist()
    table.writerow(("x", "y", "z", "block", "hole", "depth", *more))
    for place, block, hole, depth, *others in zip(
        given.places.tolist(),
        given.blocks.tolist(),
        given.holes.tolist(),
        given.depths.tolist(),
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
