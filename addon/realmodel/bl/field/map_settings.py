# SPDX-License-Identifier: GPL-3.0-or-later
"""Geological maps: read onto their ground, and stored in the row of their rock mass as they are shown."""

from dataclasses import replace
from pathlib import Path

import bpy
import numpy as np

from ...core import InputRefused, MeshFile, PointFile, Project, Rock, Surface
from ...core.readers import UnitNames
from ...core.readers.formats import RASTER, endings
from ...core.readers.unit_polygons import read_unit_polygons
from ...core.surfaces.map_data import DrapedMap, draped_map, map_on_ground, read_map, with_ground
from ..host import caches
from ..objects import viewports
from ..project import method_settings, project_settings, settings
from ..scene import data_objects

_known = caches.new(most=8)  # by digest


def read(scene, row, given, units):
    """(observations, what is not used, DrapedMap, warnings) of a MapFile for the row of a rock mass, None for
    one that is not there yet. Its ground is a file, the name of a surface, or "" for the youngest one. Raises
    InputRefused."""
    project, rock = _begun(scene, row, given)
    observations, left_out, warnings = read_map(project, rock, units)
    return observations, left_out, draped_map(map_on_ground(project, rock), units), warnings


def keep_of_project(scene, project):
    """Stores what the maps of a project show that is read from its file, whose rock masses the scene has.
    Raises InputRefused."""
    bodies = [body.name for body in project.bodies]
    for rock, row in zip(project.rocks, scene.realmodel.rocks, strict=True):
        if rock.map is not None:
            names = [surface.name for surface in rock.surfaces]
            units = UnitNames(names, rock.block_names(), bodies, rock.names)
            keep(row, draped_map(map_on_ground(project, with_ground(rock)), units))


def take_ground(row, given):
    """The file of the ground of a MapFile is the ground of the row of a rock mass. Returns the name of the
    surface that is made from it: the youngest, where it is made from nothing else; or None."""
    if not given.ground or given.ground in [surface.name for surface in row.surfaces]:
        return None
    row.ground = str(given.ground)
    row.ground_is_raster = Path(given.ground).suffix.lower() in endings(RASTER)
    youngest = row.surfaces[-1] if len(row.surfaces) else None
    return youngest.name if youngest is not None and project_settings.is_of_ground(youngest) else None


def take_ground_of_project(scene, given):
    """The data of surfaces that were made from the grounds of the maps of a project, as it is in its file, go
    to their rock masses: so the ground stays on top where surfaces are moved."""
    with settings.filling():
        for rock, row in zip(given.rocks, scene.realmodel.rocks, strict=True):
            ground = rock.ground_file
            has_options = isinstance(ground, (PointFile, MeshFile))  # those stay with the surface
            if ground is None or has_options or with_ground(rock) is rock:
                continue
            surface = row.surfaces[-1]
            row.ground, row.ground_is_raster = str(ground), surface.method == "grid"
            if row.ground_is_raster and not method_settings.options_of(surface):
                surface.property_unset("method")  # of the ground, and not of this surface
            project_settings.forget_shape(surface)
            surface.source, surface.filepath = "NONE", ""


def keep(row, draped):
    """Stores a DrapedMap in the row of its rock mass, in place of the one there."""
    arrays = {key: getattr(draped, key) for key in ("vertices", "triangles", "unit")}
    row.map = {**arrays, "names": np.array(draped.names, str)}


def of_rock(row):
    """The stored DrapedMap; None where there is none. Raises InputRefused for damaged arrays."""
    if not row.map:
        return None
    digest = row.map.digest
    if digest not in _known:
        _known[digest] = DrapedMap(**{**row.map, "names": row.map["names"].tolist()}, warnings=[])
    return _known[digest]


def _begun(scene, row, map_file):
    """The Project and the Rock of a row, as far as reading a map needs them: its region, by default all of
    the map, its edge length, and the surface that is the ground."""
    unit = scene.realmodel.units
    depsgraph = viewports.updated_layer(scene).depsgraph
    rock = Rock("rock mass" if row is None else row.name, [])
    names = [] if row is None else [surface_row.name for surface_row in row.surfaces]
    ground = map_file.ground or (row.ground if row is not None else "") or (names[-1] if names else "")
    if ground in names:
        surface = row.surfaces[ground]
        points = data_objects.row_points(scene, surface, depsgraph)
        if points is None and surface.source != "NONE":
            what = f"the ground of the map is not known: surface '{ground}' has no points or mesh"
            raise InputRefused(what, advice="choose a surface that has some, or a file, as Ground")
        rock.surfaces = [Surface(ground, points=points)]
    elif not ground:
        raise InputRefused("the ground of the map is not known", advice="choose a file of it as Ground")
    else:
        rock.surfaces = [Surface("ground", points=np.zeros((1, 3)))]
        map_file = replace(map_file, ground=ground)
    rock.map = map_file
    if row is not None:
        origin = project_settings.model_origin(scene)
        rings = project_settings.region_rings(row, depsgraph, origin)
        rock.region = rings if rings else None
        rock.edge_length = row.edge_length if row.edge_length > 0.0 else None
    if rock.region is None:
        polygons, _, _ = read_unit_polygons(map_file, unit)
        corners = np.concatenate([ring for polygon in polygons for ring in polygon.rings])
        (west, south), (east, north) = corners.min(axis=0), corners.max(axis=0)
        rock.region = np.array([(west, south), (east, south), (east, north), (west, north)])
    return Project(bpy.path.clean_name(scene.realmodel.name) or "model", [rock], units=unit), rock
