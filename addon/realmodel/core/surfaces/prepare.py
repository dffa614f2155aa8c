# SPDX-License-Identifier: GPL-3.0-or-later
"""Prepares a rock mass for the stack builder: reads its files, meshes its region, interpolates its
surfaces."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from ..base.errors import BuildWarning, InputRefused, naming, number_list
from ..base.mapped_arrays import StoreArray, unchanged
from ..base.text import no_step
from ..base.triangles import Sheet, median_edge
from ..base.work import Work, run
from ..project.plan_input import map_layer, read_constraints, read_rings, read_sizes, ring_path
from ..project.project import Project, Rock, surface_item
from ..project.series import Series
from ..project.structure_entries import Fault
from ..readers import dip_warnings, read_dips, read_space_dips
from ..readers.rasters.geotiff import geotiff_system
from ..readers.tables.hole_tables import OBSERVED, unit_warnings
from ..settings.crs import epsg_code
from ..settings.dips import Dips, SpaceDips, as_given
from ..settings.meshers import AUTO
from ..settings.series_kinds import SHEETS
from .doubtful_heights import doubtful_heights, require_points_near
from .field_data import (
    FieldData,
    apply_observations,
    bodies_of,
    left_out_warnings,
    read_field_data,
    thicknesses_without_effect,
)
from .likely_unit import surface_unit_warnings
from .observed.conformable import proposals, with_least_thickness
from .observed.kept_contacts import kept_bounds
from .planar_mesh import MeshOptions, crowded_places, mesh_rings, triangulate_rings
from .rock_dips import apply_dips
from .rock_input import RockInput
from .surface_heights import give_heights, interpolation_order
from .surface_input import Reader, SurfaceInput, read_each
from .wrong_sides import points_above_younger, points_too_low

_EDGE_LENGTH_KINDS = (
    "edge_length",
    "triangles",
    "size",
    "density",
    "too_large",
)  # kinds of errors of native meshing that the edge length causes

_REFINEMENTS = 8  # a vertex more moves those around it, so that other contacts may be crowded


def read_rocks(work: Work, project: Project, reader: Reader = read_each) -> list[RockInput]:
    """Reads every file of a project. The surfaces that have points are not interpolated yet: their entry
    in `surfaces` is None. reader: how surfaces are read."""
    fields, all_warnings, asked = [], [], []
    for rock in project.rocks:
        rock, warnings = _read_region(work, rock, project.units)
        rock = _read_constraints(rock, project.units)
        rock = replace(
            rock, series=[_read_series(rock, rock_series, project.units) for rock_series in rock.series]
        )
        field = read_field_data(project, rock)
        warnings += [BuildWarning(text, "points", rock.name) for text in field.picks.warnings]
        warnings += [BuildWarning(text, "map", rock.name) for text in field.map_warnings]
        unused = thicknesses_without_effect(field.rock)
        warnings += [BuildWarning(text, "observations", rock.name) for text in unused]
        asked += [SurfaceInput.of(rock, surface, project.units, met) for surface, met in field.surfaces]
        fields.append(field)
        all_warnings.append((warnings, _unnamed(rock, field)))
    surfaces_by_number = dict(reader(work, asked))
    inputs, first = [], 0
    for project_rock, field, (warnings, of_picks) in zip(project.rocks, fields, all_warnings, strict=True):
        warnings += [
            BuildWarning(text, "points", project_rock.name)
            for text in table_warnings(project_rock, project.units)
        ]
        warnings += _other_systems(project_rock, project.crs)
        rock = field.rock
        surfaces = [surfaces_by_number[number] for number in range(first, first + len(rock.surfaces))]
        first += len(surfaces)
        warnings += [
            BuildWarning(text, "points", rock.name, read.surface.name)
            for read in surfaces
            for text in read.warnings
        ]
        warnings += of_picks
        rock = with_least_thickness(replace(rock, surfaces=[read.surface for read in surfaces]))
        entry = RockInput(
            rock,
            [read.shape for read in surfaces],
            interpolations=[None] * len(surfaces),
            file_faces=[read.faces for read in surfaces],
            warnings=warnings,
            left_out=field.left_out,
            has_faults=bool(project.faults),
            data=[read.data for read in surfaces],
        )
        if (seen := rock.observed) is not None:
            apply_observations(
                work, entry, bodies_of(project, project_rock), (seen, np.ones(len(seen), bool))
            )
        else:
            bounds = kept_bounds(rock, entry.data)
            entry.data = [
                replace(data, bounds=surface_bounds)
                for data, surface_bounds in zip(entry.data, bounds, strict=True)
            ]
        _require_points(entry)
        apply_dips(work, entry, field.ground, field.mapped)
        if not (project.faults or project.bodies):  # else once it is known where these are
            entry.warnings += left_out_warnings(entry)
        entry.warnings += surface_unit_warnings(entry, project_rock, project.units)
        require_points_near(entry, project_rock, project.units)
        inputs.append(entry)
    return inputs


def _require_points(entry: RockInput) -> None:
    """Refuses a surface of a RockInput of which nothing is known."""
    for surface, data in zip(entry.rock.surfaces, entry.data, strict=True):
        if surface.has_points and surface.needs_points and not len(data.points):
            what = "no points, boreholes or observations constrain this surface"
            raise InputRefused(what, file=surface.shape_file, item=surface_item(entry.rock, surface))


def table_warnings(rock: Rock, units: str) -> list[str]:
    """Sentences about the units and the angles in the tables of observations and dips of a rock mass."""
    texts: list[str] = []
    with naming(rock.item):
        if rock.observation_file is not None:
            file = Path(rock.observation_file.file)
            texts += unit_warnings(rock.observation_file, file, OBSERVED, units)
        for dip_file in rock.dip_files:
            texts += dip_warnings(dip_file, units)
    return texts


def _other_systems(rock: Rock, crs: str | None) -> list[BuildWarning]:
    """Warnings about rasters in another coordinate system than the project's."""
    number, warnings = epsg_code(crs), []
    for surface in rock.surfaces:
        path = None if surface.point_file is None else Path(surface.point_file.file)
        system = None if number is None or path is None else geotiff_system(path)
        if system not in (None, number):
            what = f"{path}: it is in EPSG:{system}, the project in {crs}, and nothing is converted"
            warnings.append(BuildWarning(f"{what}: reproject it in a GIS", "crs", rock.name, surface.name))
    return warnings


def _unnamed(rock: Rock, field: FieldData) -> list[BuildWarning]:
    """The warning about picks of names that no surface has."""
    terrain = field.rock.terrain_name
    of_none = [name for name in field.unnamed if name != terrain]
    texts = []
    if of_none:
        texts.append(f"boreholes have picks of {number_list(of_none)}, which no surface from points is named")
    if len(of_none) < len(field.unnamed):
        texts.append(
            f"boreholes have picks of '{terrain}', which is the terrain, so they are not used; if that is "
            "wrong, add a surface without points above it, for the terrain"
        )
    return [BuildWarning(text, "points", rock.name) for text in texts]


def with_arrays(project: Project) -> Project:
    """A project for a scene, which stores one path for each input: its files stay, but for regions of layers
    or of text, boreholes, observations, maps and dips, which are read into arrays. Raises InputRefused."""

    def is_plain(region: Any) -> bool:
        return region is None or (isinstance(region, (str, Path)) and map_layer(region) is not None)

    def task(work: Work) -> list[Rock]:
        rocks = []
        for rock in project.rocks:
            if not is_plain(rock.region):
                rock, _ = _read_region(work, rock, project.units)
            rock = _read_constraints(rock, project.units)
            rock = replace(
                rock, series=[_read_series(rock, rock_series, project.units) for rock_series in rock.series]
            )
            field = read_field_data(project, rock)
            surfaces = []
            for surface, met in field.surfaces:
                if surface.dip_file is not None:
                    with naming(surface_item(rock, surface)):
                        surface = replace(surface, dips=read_dips(surface.dip_file, project.units))
                if met is not None:
                    surface = SurfaceInput.of(rock, surface, project.units, met).read(no_step).surface
                surfaces.append(surface)
            series = [
                replace(rock_series, dips=as_given(rock_series.dips))
                if isinstance(rock_series.dips, (Dips, SpaceDips))
                else rock_series
                for rock_series in field.rock.series
            ]
            dips = field.rock.dips
            dips = as_given(dips) if isinstance(dips, Dips) else dips
            rocks.append(replace(field.rock, surfaces=surfaces, series=series, dips=dips))
        return rocks

    return replace(
        project, rocks=run(task), faults=[_with_dips(fault, project.units) for fault in project.faults]
    )


def _with_dips(fault: Fault, units: str) -> Fault:
    if fault.dip_file is None:
        return fault
    with naming(fault.item):
        return replace(fault, dips=read_space_dips(fault.dip_file, units))


def _read_region(work: Work, rock: Rock, units: str) -> tuple[Rock, list[BuildWarning]]:
    if rock.region is None:
        return rock, []
    try:
        region, holes, left_out = read_rings(rock.region, rock.holes, units, work.native)
    except InputRefused as error:
        file, line = rock.region_file, None
        if file is None and rock.source is not None:
            document = rock.source.document
            path = ring_path(rock.region, getattr(error.__cause__, "items", ()))
            file, line = document.file, document.line((*rock.source.path, *path))
        raise error.within(rock.item, file=file, line=line) from error
    rock = replace(rock, region=region, holes=holes, shape_file=rock.region_file or rock.shape_file)
    return rock, [BuildWarning(text, "left_out", rock.name) for text in left_out]


def _read_constraints(rock: Rock, units: str) -> Rock:
    """The rock mass with its constraints as arrays (N, 2), points with one row, and its mesh sizes read."""
    key = "constraints"
    try:
        lines = read_constraints(rock.constraints, units)
        key = "size"
        return replace(rock, constraints=lines, size=read_sizes(rock.size, units))
    except InputRefused as error:
        file, line = rock.place_of(key)
        raise error.within(rock.item, file=file, line=line) from error


def _read_series(rock: Rock, series: Series, units: str) -> Series:
    """The series with its dips as arrays."""
    if series.kind == SHEETS:  # theirs may name surfaces and blocks: read_field_data reads them
        return series
    with naming(f"{rock.item}, {series.item}"):
        file = series.dip_file
        dips = series.space_dips() if file is None else read_space_dips(file, units)
        return series if dips is None else replace(series, dips=dips.checked())


def mesh_rock(work: Work, entry: RockInput) -> None:
    """Meshes the region of a rock mass, if it has one, as the present phase of the work."""
    rock = entry.rock
    if rock.region is None:
        return
    try:
        entry.region = (
            _planar_mesh(work, entry) if rock.interpolates else Sheet(*triangulate_rings(rock.rings()))
        )
    except InputRefused as error:
        kind = getattr(error.__cause__, "kind", "")
        file, line = (
            rock.place_of("edge_length") if kind in _EDGE_LENGTH_KINDS else rock.shape_source("region")
        )
        if kind.startswith("constraint") and rock.source is not None:
            file, line = rock.place_of("constraints")
        raise error.within(rock.item, file=file, line=line) from error


def mesh_again(work: Work, entry: RockInput, keep: StoreArray = unchanged) -> bool:
    """Meshes the region of a rock mass anew where observations gave its surfaces other contacts since, which
    its mesh cannot tell apart. keep: as of mesh_inputs. Returns whether it did."""
    if entry.region is None or entry.rock.observed is None or not entry.rock.interpolates:
        return False
    if not len(crowded_places(work, entry, entry.region, np.empty((0, 2)))):
        return False
    mesh_rock(work, entry)
    entry.region = Sheet(*map(keep, entry.region))
    return True


def _planar_mesh(work: Work, entry: RockInput) -> Sheet:
    """The planar mesh of a rock mass; contacts that it could not tell apart are vertices."""
    rock = entry.rock
    given_points = [point for point in rock.constraints if len(point) == 1]
    points = np.concatenate(given_points) if given_points else None
    options = MeshOptions(
        rock.edge_length,
        rock.mesher,
        rock.triangles,
        rock.size,
        [line for line in rock.constraints if len(line) > 1],
        points,
        _density_points(entry) if rock.edge_length == AUTO else None,
    )
    mesh = Sheet(*mesh_rings(work, rock.rings(), options))
    fixed = np.empty((0, 2)) if points is None else points
    given_count, outside, entry.edge = len(fixed), np.empty((0, 2)), None
    for _ in range(_REFINEMENTS):
        crowded = crowded_places(work, entry, mesh, np.concatenate([fixed, outside]))
        if not len(crowded):
            break
        entry.edge = entry.edge or median_edge(*mesh)
        fixed = np.concatenate([fixed, crowded])
        while len(fixed) > given_count:
            try:
                mesh = Sheet(*mesh_rings(work, rock.rings(), replace(options, constraint_points=fixed)))
                break
            except InputRefused as error:
                at = getattr(error.__cause__, "items", [-1])[0]
                if getattr(error.__cause__, "kind", "") != "constraint_outside" or at < given_count:
                    raise
                outside = np.vstack([outside, fixed[at]])  # on the outline, but for rounding
                fixed = np.delete(fixed, at, axis=0)
    return mesh


def _density_points(entry: RockInput) -> np.ndarray:
    """(P, 2) the points of all surfaces of a rock mass, which decide an automatic edge length."""
    pairs = zip(entry.rock.surfaces, entry.data, strict=True)
    places = [data.points[:, :2] for surface, data in pairs if entry.rock.is_interpolated(surface)]
    return np.concatenate(places) if places else np.empty((0, 2))


def propose_series(work: Work, entry: RockInput, numbers: Collection[int]) -> None:
    """Adds warnings about surfaces of the method "auto" that are conformable; with faults on either side."""
    chosen = sorted(number for number in numbers if entry.rock.surfaces[number].method == "auto")
    if len(chosen) < 2:
        return
    sides = None
    if (structure := entry.structure) is not None:
        faults = structure.faults
        sides = {number: np.where(faults.active(number), structure.points[number], 0) for number in chosen}
    with work.part(0.0, 0.0), work.phase(0.0, 1.0, "comparing surfaces"):
        entry.warnings += proposals(work, entry.rock, entry.data, chosen, sides)


def interpolate_rock(
    work: Work,
    entry: RockInput,
    stage: int | None = None,
    keep: StoreArray = unchanged,
) -> None:
    """Interpolates the surfaces of a rock mass; for a stage only those that it needs. keep: stores the
    finished surfaces; unless it is unchanged, their interpolations and attributes are dropped."""
    waiting = interpolation_order(entry.rock, stage)
    if entry.draws is None:
        entry.warnings += points_above_younger(entry, waiting)
        propose_series(work, entry, waiting)
    for number in work.share_out(waiting):
        with work.phase(0.0, 1.0, f"interpolating {entry.rock.surfaces[number].name}"):
            give_heights(work, entry, number)
        if keep is not unchanged:
            entry.surfaces[number] = Sheet(*map(keep, entry.surface(number)))
            entry.interpolations[number] = None
            del entry.attributes[number]
    entry.warnings += points_too_low(work, entry, sorted(waiting))
    if keep is unchanged:  # tiles have no such warnings
        entry.warnings += doubtful_heights(work, entry, sorted(waiting))
    entry.untied.clear()
