# SPDX-License-Identifier: GPL-3.0-or-later
"""The terrain of a rock mass, the boundary above all of its surfaces: from the key `terrain` to a surface."""

from __future__ import annotations

from copy import deepcopy
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

from ..readers import is_mesh_file
from ..readers.formats import RASTER, TABLE, format_of
from ..settings.data_files import MeshFile, PointFile
from ..settings.methods import CONTINUATION, CONTINUATION_OPTIONS
from .entry import check_file, errors_located
from .project import Project, Rock, Surface, surface_item
from .structure_entries import as_point_file

NAME = "terrain"  # of the surface that is made for it, where no other surface is it
_OF_RASTER: dict = {"method": "grid", "options": {"extrapolate": "none"}}
_OF_POINTS: dict = {"method": CONTINUATION, "options": CONTINUATION_OPTIONS}


def with_terrains(project: Project) -> Project:
    """The project whose terrains are surfaces, the youngest of their rock masses, which `terrain` names; the
    project itself where this is so already. Raises InputRefused."""
    rocks = [_with_terrain(rock) for rock in project.rocks]
    is_changed = any(rock is not other for rock, other in zip(rocks, project.rocks, strict=True))
    return replace(project, rocks=rocks) if is_changed else project


def _with_terrain(rock: Rock) -> Rock:
    if rock.terrain is None:
        return rock
    number = rock.terrain_number
    if number is not None:
        others = [surface for at, surface in enumerate(rock.surfaces) if at != number]
        is_youngest = number == len(others)
        return rock if is_youngest else replace(rock, surfaces=[*others, rock.surfaces[number]])
    surface, others = _surface(rock)
    return replace(rock, surfaces=[*others, surface], terrain=surface.name)


def _surface(rock: Rock) -> tuple[Surface, list[Surface]]:
    """The surface of a terrain that is none yet, and those below it. The youngest surface is the terrain, if
    it has no other data."""
    given = rock.terrain
    if isinstance(given, Surface):
        return given, rock.surfaces
    if isinstance(given, (str, Path, PointFile, MeshFile)):
        file = given if isinstance(given, (str, Path)) else given.file
        check_file(file, "terrain", rock.refused)
    shape = terrain_shape(given)
    youngest = rock.surfaces[-1] if rock.surfaces else None
    if youngest is None or youngest.series is not None or not needs_shape(rock, youngest):
        return Surface(NAME, **shape, source=rock.source), rock.surfaces
    if youngest.method is not None:
        shape = {key: shape[key] for key in ("points", "mesh") if key in shape}
    elif "options" in shape:
        shape["options"] = {**shape["options"], **youngest.options}
    return replace(youngest, **shape), rock.surfaces[:-1]


def terrain_shape(given: Any) -> dict:
    """The values of a Surface that is a terrain: as file_shape, points with the method by which they are."""
    shape = file_shape(given)
    if "points" not in shape:
        return shape
    return shape | deepcopy(_OF_RASTER if _is_raster(given) else _OF_POINTS)


def needs_shape(rock: Rock, surface: Surface) -> bool:
    """Whether a surface of a rock mass is made from points and has none, but may have picks."""
    with errors_located(partial(surface.refused, item=surface_item(rock, surface))):
        return rock.is_interpolated(surface) and surface.points is None and surface.needs_points


def file_shape(given: Any) -> dict:
    """The value of a Surface that a file of heights is, or a PointFile or MeshFile of one, or points: its
    mesh or its points."""
    is_mesh = isinstance(given, MeshFile) or (isinstance(given, (str, Path)) and is_mesh_file(given))
    return {"mesh" if is_mesh else "points": given}


def _is_raster(given: Any) -> bool:
    file = as_point_file(given)
    file_format = None if file is None else format_of(file.file, RASTER, TABLE)
    return file_format is not None and file_format.holds == RASTER
