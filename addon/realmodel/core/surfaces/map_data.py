# SPDX-License-Identifier: GPL-3.0-or-later
"""The geological map of a rock mass: its polygons, the ground and the faults, read and put together; and as
triangles on its ground."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from ..base.algebra import norm, twice_area
from ..base.errors import InputRefused, naming
from ..base.text import no_step
from ..base.units import MODEL_UNIT
from ..base.work import native_module
from ..heights.interpolate import interpolate
from ..project.plan_input import read_rings, shapes_of
from ..project.project import Project, Rock, Surface
from ..project.terrain import file_shape, needs_shape
from ..readers import UnitNames
from ..readers.fault_input import read_fault_trace
from ..readers.point_input import read_raster_heights
from ..readers.tables.observations import LeftOut, Observations
from ..readers.unit_polygons import UnitPolygon, read_unit_polygons
from ..settings.data_files import MapFile, MapLayer, PointFile
from ..settings.methods import CONTINUATION, CONTINUATION_OPTIONS
from .observed.map_places import MapFrame, observed_on_map
from .observed.polygon_borders import inside
from .planar_mesh import mesh_region
from .surface_input import SurfaceInput

_PARTS = 100  # of the diagonal of the region: the spacing of places for an automatic edge length


def with_ground(rock: Rock) -> Rock:
    """The rock mass whose youngest surface is made from the ground of its map, where it has no points and no
    mesh."""
    youngest = rock.surfaces[-1]
    if rock.map is None or not needs_shape(rock, youngest):
        return rock
    if (shape := _ground_shape(rock)) is None:
        return rock
    return replace(rock, surfaces=[*rock.surfaces[:-1], replace(youngest, **shape)])


def _ground_shape(rock: Rock) -> dict | None:
    """The points or the mesh of the ground; None where it is a surface."""
    return None if rock.ground_file is None else file_shape(rock.ground_file)


@dataclass(frozen=True, eq=False)
class MapOnGround:
    """A map after reading. polygons: in plan. frame: where it counts, and the ground. warnings: sentences."""

    polygons: list[UnitPolygon]
    frame: MapFrame
    warnings: list[str]


def map_on_ground(project: Project, rock: Rock) -> MapOnGround:
    """The polygons of the map of a rock mass that has a region, and its ground. Raises InputRefused."""
    map_file = rock.map
    assert map_file is not None
    surface = _ground(rock, map_file)
    with naming(rock.item):
        polygons, lines, warnings = read_unit_polygons(map_file, project.units)
        faults = [*lines, *_fault_lines(project, map_file)]
        region, holes, _ = read_rings(rock.region, rock.holes, project.units)
    rings = region if isinstance(region, list) else [region, *holes]
    corners = np.concatenate(rings)
    box = np.array([corners.min(axis=0), corners.max(axis=0)])

    def heights(plan: np.ndarray) -> np.ndarray:
        return _heights(rock, surface, plan, project.units)

    frame = MapFrame(box, _spacing(rock, rings, box), faults, heights, map_file.accuracy)
    return MapOnGround(polygons, frame, warnings)


def read_map(project: Project, rock: Rock, units: UnitNames) -> tuple[Observations, list[LeftOut], list[str]]:
    """The observations of the map of a rock mass, what of it is not used, and warnings, sentences. Raises
    InputRefused."""
    read = map_on_ground(project, rock)
    assert rock.map is not None
    file = rock.map.file
    observations, left_out, more = observed_on_map(read.polygons, units, read.frame)
    if not len(observations) and not left_out:
        what = "no polygon of it lies in the region, or the ground is known nowhere there"
        advice = "check the coordinates of the map, the ground and the region"
        raise InputRefused(what, file=file, item=f"{rock.item}, map", advice=advice)
    return observations, left_out, [*read.warnings, *(f"{file}: {text}" for text in more)]


def blocks_on_map(project: Project, rock: Rock, units: UnitNames, plan: np.ndarray) -> np.ndarray:
    """(N,) texts: the blocks that the map shows at places (N, 2), by the surfaces over them; "" where it
    shows none. Raises InputRefused."""
    assert rock.map is not None
    with naming(rock.item):
        polygons, _, _ = read_unit_polygons(rock.map, project.units)
    blocks = np.full(len(plan), "", object)
    for polygon in polygons:
        block = "" if units.says_nothing(polygon.unit) else units.block(polygon.unit)
        if block in units.surfaces:
            blocks[inside(polygon.rings, plan)] = block
    return blocks


def _ground(rock: Rock, map_file: MapFile) -> Surface:
    """The surface that the map is on."""
    shape = _ground_shape(rock)
    if shape is not None:
        return Surface("ground of the map", **shape)
    names = [surface.name for surface in rock.surfaces]
    return rock.surfaces[names.index(map_file.ground) if map_file.ground in names else -1]


def _spacing(rock: Rock, rings: list[np.ndarray], box: np.ndarray) -> float:
    """About the edge length of the planar mesh."""
    if isinstance(rock.edge_length, (int, float)):
        return float(rock.edge_length)
    if rock.triangles is not None:
        area = abs(sum(twice_area(ring) for ring in rings)) / 2
        return float(np.sqrt(4 / np.sqrt(3) * area / rock.triangles))
    return float(norm(box[1] - box[0])) / _PARTS


def _fault_lines(project: Project, map_file: MapFile) -> list[np.ndarray]:
    """(N, 2) the lines of faults in plan: those of the map, and the traces of the project."""
    lines = []
    if map_file.faults is not None:
        shapes = shapes_of(map_file.faults, project.units)
        if shapes is None or not shapes.lines:
            file = map_file.faults.file if isinstance(map_file.faults, MapLayer) else None
            raise InputRefused("there are no lines of faults in it", file=file)
        lines += [line for _, line in shapes.lines]
    for fault in project.faults:
        trace = fault.trace
        if trace is None:
            continue
        if (traced := fault.trace_file) is not None:
            trace = read_fault_trace(traced, project.units).lines
        elif isinstance(trace, str):
            trace = read_fault_trace(trace).lines
        assert not isinstance(trace, (Path, PointFile))
        several = len(trace) and np.ndim(trace[0]) > 1
        lines += [np.asarray(line, np.float64)[:, :2] for line in (trace if several else [trace])]
    return lines


def _heights(rock: Rock, surface: Surface, plan: np.ndarray, units: str = MODEL_UNIT) -> np.ndarray:
    """(N,) heights of the ground at places (N, 2), NaN where they are not known: bilinear in a raster, on the
    triangles of a mesh, by natural neighbors between points."""
    if surface.point_file is not None:
        z = read_raster_heights(surface.point_file, plan, units)
        if z is not None:
            return z
    level = surface.options.get("value")
    if surface.method == "constant" and isinstance(level, (int, float)):
        return np.full(len(plan), float(level))
    if surface.has_points and surface.points is None:
        what = f"the ground of the map is not known: surface '{surface.name}' has no points or mesh"
        raise rock.refused(what, "map", 'give its elevations: ground = "dem.tif"')
    read = SurfaceInput.of(rock, surface, units).read(no_step)
    if read.shape is not None:
        return native_module().surface_heights(*read.shape.arrays, np.ascontiguousarray(plan))
    options: dict[str, Any] = dict(CONTINUATION_OPTIONS)
    return interpolate(read.data.points, plan, CONTINUATION, **options).z


@dataclass(frozen=True, eq=False)
class DrapedMap:
    """vertices: (V, 3) float64, model units. triangles: (T, 3) int32, counter-clockwise from above. unit:
    (T,) int32, of `names`: the block that a triangle shows or, where there is none, that of the map.
    warnings: sentences about polygons that are not shown."""

    vertices: np.ndarray
    triangles: np.ndarray
    unit: np.ndarray
    names: list[str]
    warnings: list[str]


def draped_map(given: MapOnGround, units: UnitNames) -> DrapedMap:
    """A map on its ground, as densely as it counts. Triangles where the ground is not known are left out."""
    vertices, triangles, numbers = [np.empty((0, 2))], [np.empty((0, 3), np.int32)], [np.empty(0, np.int32)]
    names: dict[str, int] = {}
    warnings, count = [], 0
    for polygon in given.polygons:
        block = polygon.unit if units.says_nothing(polygon.unit) else units.block(polygon.unit)
        number = names.setdefault(block or polygon.unit, len(names))
        try:
            plan, faces = mesh_region(list(polygon.rings), edge_length=given.frame.spacing)
        except InputRefused as error:
            warnings.append(f"{polygon.item} is not shown: {error.what}")
            continue
        vertices.append(plan)
        triangles.append(faces + np.int32(count))
        numbers.append(np.full(len(faces), number, np.int32))
        count += len(plan)
    plan = np.concatenate(vertices)
    z = given.frame.heights(plan) if len(plan) else np.empty(0)
    faces, unit = np.concatenate(triangles), np.concatenate(numbers)
    is_known = np.isfinite(z[faces]).all(axis=1)
    used, corners = np.unique(faces[is_known], return_inverse=True)
    places = np.column_stack([plan, z])[used]
    return DrapedMap(places, corners.reshape(-1, 3).astype(np.int32), unit[is_known], list(names), warnings)
