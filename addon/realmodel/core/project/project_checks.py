# SPDX-License-Identifier: GPL-3.0-or-later
"""The checks of a project, and of the options of a build, before anything is read."""

from __future__ import annotations

import difflib
from collections.abc import Collection, Mapping
from functools import partial
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from ..base.errors import InputRefused, UsageError, naming
from ..readers.tables.unit_names import fits
from ..settings.data_files import MapFile, MapLayer
from ..settings.dips import DipFile, Dips, SpaceDips
from ..settings.meshers import AUTO, local_lengths
from ..settings.method_options import OptionRefused, check_fields, is_name
from ..settings.methods import (
    DEFAULT_METHOD,
    METHODS,
    SURFACE_OPTIONS,
    check_method,
    check_uses_dips,
)
from ..settings.series_kinds import BY_DATA, FIELD, SHEET_METHODS
from .entry import (
    Refuse,
    check_file,
    check_property,
    check_table_file,
    check_values,
    errors_located,
    keys_without_effect,
    named_once,
    shapes_given,
)
from .plan_input import check_layer, is_place_elsewhere
from .project import Project, Rock, Surface, surface_item
from .series import Series
from .structure_entries import FAULT, OF_TRACES, Body, Fault
from .structure_history import body_times, displaced_surfaces
from .terrain import with_terrains

CELL_KINDS = ("columns", "blocks")


def check_cells(cells: object) -> None:
    """Raises UsageError for an unknown kind of cells."""
    if cells not in CELL_KINDS:
        raise UsageError(f"cells must be 'columns' or 'blocks', not {cells!r}")


def check_stage(project: Project, stage: Any) -> None:
    """Raises UsageError for a stage that no rock mass has."""
    youngest = max(len(rock.surfaces) for rock in project.rocks) - 1
    if isinstance(stage, bool) or not hasattr(stage, "__index__") or not 0 <= int(stage) <= youngest:
        raise UsageError(
            f"stage {stage} does not exist: stages run from 0 to {youngest}, the youngest surface"
        )


def check_memory(memory: Any) -> None:
    """Raises UsageError for a memory limit that is not a number of bytes."""
    if memory is None:
        return
    if isinstance(memory, bool) or not hasattr(memory, "__index__") or int(memory) <= 0:
        raise UsageError(f"memory must be a number of bytes above 0, not {memory!r}")


def check_field_data(project: Project, rock: Rock) -> None:
    """Refuses boreholes, observations, a map and names of a rock mass that make no sense. Raises
    InputRefused."""
    refuse = rock.refused
    tables = {"boreholes": rock.boreholes, "observations": rock.observation_file, "dips": rock.dip_file}
    for key, table in tables.items():
        check_table_file(table, key, refuse)
    if rock.map is not None:
        _check_map(rock, rock.map)
    of_intervals = any(not body.has_shape for body in project.bodies)
    for key in ("boreholes", "observations", "map", "dips"):
        has_effect = rock.interpolates or (
            key != "dips" and any(surface.has_points for surface in rock.surfaces)
        )
        has_effect |= key in ("boreholes", "observations") and of_intervals
        if getattr(rock, key) is not None and not has_effect:
            raise refuse(f"'{key}' has no effect, as no surface is interpolated", key)
    _check_names_of_data(project, rock)


def _check_map(rock: Rock, map_file: MapFile) -> None:
    refuse = rock.refused
    with errors_located(refuse, "map", "map: "):
        map_file.check()
    check_layer(map_file.polygons, "map", refuse)
    check_layer(map_file.faults, "map", refuse)
    number = rock.ground_number
    if rock.ground_file is None and number is not None and rock.is_level_set(rock.surfaces[number]):
        what = f"the ground of the map cannot be '{rock.surfaces[number].name}': it is a level set"
        raise refuse(what, "map", 'give its elevations: ground = "dem.tif", or a sheet as youngest surface')
    for file in rock.map_files:
        check_file(file, "map", refuse)


def _check_names_of_data(project: Project, rock: Rock) -> None:
    advice = 'write names = { SST = "Sandstone" }'
    if not isinstance(rock.names, Mapping):
        raise rock.refused(f"'names' must be a table of names, not {rock.names!r}", "names", advice)
    unit_names = project.names_of_units(rock)
    for code, name in rock.names.items():
        with naming(rock.item):
            fits(code, "")  # refuses an invalid regular expression
        if not is_name(code) or not isinstance(name, str):
            raise rock.refused(f"'names' must give a name for each name, not {name!r}", "names", advice)
        if name and name not in unit_names:
            near = difflib.get_close_matches(name, unit_names, n=1)
            what = f"'names' gives {code!r} the name '{name}', which is no block, surface or body"
            raise rock.refused(
                what, "names", f"did you mean '{near[0]}'?" if near else f"there are {', '.join(unit_names)}"
            )


def check_series(rock: Rock) -> None:
    """Refuses series that make no sense. Raises InputRefused."""
    for series in named_once(rock.series, "series"):
        refuse = partial(series.refused, item=f"{rock.item}, {series.item}")
        check_values(series, refuse)
        _check_dips_of_series(series, refuse)
        members = rock.members(series)
        if not members:
            advice = f'write series = "{series.name}" in its surfaces'
            raise refuse("no surface belongs to it", "name", advice)
        for one, other in pairwise(members):
            if other > one + 1:
                between = rock.surfaces[one + 1]
                what = f"its surfaces are not consecutive: '{between.name}' is between them"
                raise refuse(what, "name", "give this surface the same series, or use two series")
        if series.kind == FIELD:
            _check_field(rock, refuse)
        else:
            _check_sheets(rock, series, members, refuse)


def _check_sheets(rock: Rock, series: Series, members: list[int], refuse: Refuse) -> None:
    if series.resolution != BY_DATA:
        raise refuse("'resolution' has no effect, as sheets have no lattice", "resolution", "leave it out")
    for key in ("error", "dip_error", "range"):
        if getattr(series, key):
            what = f"'{key}' is of a field; sheets have the nugget and the range of their variogram"
            raise refuse(what, key, "leave it out, or give the surfaces a variogram")
    if series.thickness != BY_DATA:
        what = "'thickness' has no effect, as sheets always share how their thickness varies"
        raise refuse(what, "thickness", "leave it out")
    for number in members:
        surface = rock.surfaces[number]
        if not surface.has_points or (surface.method or SHEET_METHODS[0]) not in SHEET_METHODS:
            how = f"has method '{surface.method}'" if surface.has_points else "is a mesh"
            what = f"its surfaces are interpolated together, and '{surface.name}' {how}"
            raise refuse(
                what, "name", f"methods of sheets are {', '.join(SHEET_METHODS[:-1])} and {SHEET_METHODS[-1]}"
            )
        if number > members[0] and surface.correlation is not None:
            what = f"'{surface.name}' has a correlation, but sheets are drawn together in ensembles"
            raise refuse(what, "name", "leave correlation out; the oldest sheet may have one")


def _check_dips_of_series(series: Series, refuse: Refuse) -> None:
    if series.kind == FIELD or not isinstance(series.dips, Dips):
        _check_space_dips(series.dips, series.dip_file, refuse)


def _check_space_dips(dips: Any, dip_file: DipFile | None, refuse: Refuse) -> None:
    check_table_file(dip_file, "dips", refuse)
    if dip_file is None and dips is not None and not isinstance(dips, SpaceDips):
        raise refuse("its dips are not in space", "dips", "give a file, or SpaceDips")


def _check_field(rock: Rock, refuse: Refuse) -> None:
    for key, value in (("region", rock.region), ("base_elevation", rock.base_elevation)):
        if value is None:
            what = f"the field is unbounded: {rock.item} has no {key}"
            raise refuse(what, "name", f"give the rock mass a {key}")


def check_level_set(rock: Rock, surface: Surface, refuse: Refuse) -> None:
    """Refuses what makes no sense for a surface of a field. Raises InputRefused."""
    shapes = [key for key in ("mesh", "vertices") if getattr(surface, key) is not None]
    for key in (*shapes, *keys_without_effect(surface, "level set")):
        what = f"'{key}' has no effect: the surface is a level set of series '{surface.series}'"
        advice = "give the dips to the series" if key == "dips" else "use points, and leave this out"
        raise refuse(what, key, advice)
    if surface.points is None and not rock.has_field_data:
        raise refuse("it has no points", advice="add points = ...")
    check_file(surface.input_file, "points", refuse)
    with errors_located(refuse):
        if surface.point_file is not None:
            surface.point_file.check()


def check_names_series(rock: Rock, surface: Surface, refuse: Refuse) -> None:
    """Refuses a surface of a series that its rock mass does not have. Raises InputRefused."""
    names = [series.name for series in rock.series]
    if surface.series is not None and surface.series not in names:
        advice = f"it has {', '.join(names)}" if names else "add [[rock.series]]"
        raise refuse(f"{rock.item} has no series '{surface.series}'", "series", advice)


def check_structures(project: Project) -> None:
    """Raises InputRefused, naming the line where it is written."""
    for fault in named_once(project.faults, "fault"):
        _check_fault(project, fault)
    for body in named_once(project.bodies, "body"):
        _check_body(project, body)
    _check_ends(project)


def _check_fault(project: Project, fault: Fault) -> None:
    refuse = fault.refused
    _check_structure_shape(fault, refuse, ("trace", "points", "mesh"))
    check_values(fault, refuse)
    _check_space_dips(fault.dips, fault.dip_file, refuse)
    for key in keys_without_effect(fault, fault.shape_kind):
        if FAULT[key].shapes == OF_TRACES:
            raise refuse(f"'{key}' has no effect, as its shape is no trace", key, "add trace = ...")
        shape = "its shape is a trace" if fault.trace is not None else "no surface is fitted through points"
        raise refuse(f"'{key}' has no effect, as {shape}", key)
    _check_trace(project, fault, refuse)
    _check_structure_names(project, refuse, "rocks", fault.rocks, "youngest", fault.youngest)


def _check_trace(project: Project, fault: Fault, refuse: Refuse) -> None:
    """Refuses a trace without a dip, and one on a surface that does not exist."""
    if fault.trace is not None and fault.trace_file is None and fault.dip is None:
        raise refuse("a trace needs a dip", "trace", "add dip = ... (90 where the fault is vertical)")
    if isinstance(fault.elevation, str):
        rocks = [project.rocks[number] for number in displaced_surfaces(project, fault)]
        names = dict.fromkeys(surface.name for rock in rocks for surface in rock.surfaces)
        if fault.elevation not in names:
            what = f"'elevation' names surface '{fault.elevation}', which the rock that it displaces lacks"
            raise refuse(what, "elevation", _there(names) if names else None)


def _check_body(project: Project, body: Body) -> None:
    refuse = body.refused
    if body.has_shape or body.triangles is not None:
        _check_structure_shape(body, refuse, ("mesh",))
        for key in keys_without_effect(body, "mesh"):
            raise refuse(f"'{key}' has no effect, as its shape is a mesh", key)
    elif not any(
        rock.boreholes is not None or rock.observations is not None
        for rock in map(project.rocks.__getitem__, body_times(project, body))
    ):
        advice = "add mesh = ..., or boreholes with intervals of it"
        raise refuse("it has no shape", advice=advice)
    check_values(body, refuse)
    if body.void and body.property:
        raise refuse("a void has no rock, so 'property' has no effect", "property")
    check_property(project.library, body.property, refuse)
    names = () if body.rock is None else (body.rock,)
    _check_structure_names(project, refuse, "rock", names, "after", body.after)


def _check_structure_shape(entry: Fault | Body, refuse: Refuse, files: tuple[str, ...]) -> None:
    """Refuses an entry without a shape, or with two."""
    shapes = shapes_given(entry, files, refuse)
    if not shapes:
        advice = " or ".join(f"{key} = ..." for key in reversed(files))
        raise refuse("it has no shape", advice=f"add {advice}")
    with errors_located(refuse):
        for file in (entry.mesh_file, entry.point_file, getattr(entry, "trace_file", None)):
            if file is not None:
                file.check()
    check_file(entry.input_file, shapes[0], refuse)


def _check_structure_names(
    project: Project, refuse: Refuse, key: str, rocks: Any, time_key: str, surface: Any
) -> None:
    """Refuses unknown rock masses and surfaces."""
    names_of_rocks = {
        rock.name: [rock_surface.name for rock_surface in rock.surfaces] for rock in project.rocks
    }
    for name in rocks:
        if name not in names_of_rocks:
            raise refuse(
                f"'{key}' names rock mass '{name}', which does not exist", key, _there(names_of_rocks)
            )
    if surface is None:
        return
    for name in rocks:
        if surface not in names_of_rocks[name]:
            what = f"'{time_key}' names surface '{surface}', which rock '{name}' does not have"
            raise refuse(what, time_key, f"it has {', '.join(names_of_rocks[name])}")
    if not any(surface in names for names in names_of_rocks.values()):
        every = dict.fromkeys(name for names in names_of_rocks.values() for name in names)
        raise refuse(f"'{time_key}' names surface '{surface}', which does not exist", time_key, _there(every))


def _there(names: Collection[str]) -> str:
    return f"there are {', '.join(names)}" if len(names) > 1 else f"there is {', '.join(names)}"


def _check_ends(project: Project) -> None:
    """Refuses faults that end at unknown faults, at each other, or at faults that displace less."""
    faults = {fault.name: fault for fault in project.faults}
    for fault in project.faults:
        displaced = displaced_surfaces(project, fault)
        for name in fault.ends_at:
            if name not in faults:
                what = f"'ends_at' names fault '{name}', which does not exist"
                raise fault.refused(what, "ends_at", _there(faults))
            if name == fault.name:
                raise fault.refused("it cannot end at itself", "ends_at")
            other = displaced_surfaces(project, faults[name])
            for rock in displaced.keys() & other.keys():
                if displaced[rock] > other[rock]:
                    surface = project.rocks[rock].surfaces[displaced[rock]].name
                    what = f"it displaces '{surface}', but fault '{name}', at which it ends, does not"
                    advice = f"give '{name}' a younger 'youngest', or this fault an older one"
                    raise fault.refused(what, "ends_at", advice)
    for fault in project.faults:
        way = _way_back(fault.name, faults)
        if way:
            through = " at ".join(f"'{name}'" for name in way[1:])
            raise fault.refused(f"it ends at {through}: no fault of this circle is there first", "ends_at")


def _way_back(name: str, faults: dict[str, Fault]) -> list[str]:
    """The path from a fault over the faults at which it ends back to itself; [] where there is none."""
    ways, seen = [[name]], set()
    while ways:
        way = ways.pop()
        for other in faults[way[-1]].ends_at:
            if other == name:
                return [*way, other]
            if other not in seen:
                seen.add(other)
                ways.append([*way, other])
    return []


def check_project(project: Project) -> Project:
    """A project as it is built, with its terrains as surfaces. One that cannot be built is refused, before
    anything is read. Raises InputRefused."""
    if not is_name(project.name):
        raise InputRefused("a project needs a name", file=project.path)
    try:
        check_fields(project)
    except OptionRefused as error:
        raise InputRefused(error.what, file=project.path, item=error.option, advice=error.advice) from error
    if not project.rocks:
        raise InputRefused("there is no rock mass", file=project.path, item=f"project '{project.name}'")
    project = with_terrains(project)
    for rock in named_once(project.rocks, "rock mass"):
        _check_rock(project, rock)
    check_structures(project)
    return project


def _check_rock(project: Project, rock: Rock) -> None:
    refuse = rock.refused
    if not rock.surfaces:
        raise refuse("it has no surface", advice="a block needs two surfaces, or one and a base_elevation")
    check_values(rock, refuse)
    _check_mesh(rock, refuse)
    if rock.region is None and len(rock.holes):
        raise refuse("it has holes but no region", "holes", "add the outline as region")
    if isinstance(rock.region, (str, Path, MapLayer)) and len(rock.holes):
        raise refuse(
            "holes need a region given by coordinates", "holes", "put the holes into the region's file"
        )
    check_layer(rock.region, "region", refuse)
    for constraint in rock.constraints:
        check_layer(constraint, "constraints", refuse)
    if len(rock.constraints) and not rock.interpolates:
        what = "constraints have no effect, as no surface is interpolated"
        raise refuse(what, "constraints")
    check_field_data(project, rock)
    check_series(rock)
    names: set[str] = set()
    for surface in rock.surfaces:
        _check_surface(project, rock, surface)
        if surface.name in names:
            advice = "give each surface of a rock mass a unique name"
            item_name = surface_item(rock, surface)
            raise surface.refused("another surface has this name", "name", advice, item_name)
        names.add(surface.name)
    _check_references(rock)


def _check_mesh(rock: Rock, refuse: Refuse) -> None:
    """Refuses settings from which no planar mesh can be made."""
    if rock.triangles is not None and rock.edge_length not in (None, AUTO):
        raise refuse("edge_length and triangles cannot both be given", "triangles", "give one of them")
    try:
        sizes = [_at_a_place(entry, refuse) for entry in rock.size]
        local_lengths(sizes, [np.zeros((1, 2))] if len(rock.constraints) else [], None)
    except InputRefused as error:
        raise refuse(f"{error.item}: {error.what}" if error.item else error.what, "size") from error


def _at_a_place(entry: Any, refuse: Refuse) -> Any:
    """An entry of `size` that is at what a file or a text holds, with a place instead, once there is that
    file; others as they are."""
    if not (isinstance(entry, Mapping) and is_place_elsewhere(entry.get("at"))):
        return entry
    check_layer(entry["at"], "size", refuse)
    return {**entry, "at": [0.0, 0.0]}


def _check_surface(project: Project, rock: Rock, surface: Surface) -> None:
    if not is_name(surface.name):
        raise surface.refused("a surface has no name", "name", item=rock.item)
    refuse = partial(surface.refused, item=surface_item(rock, surface))
    check_names_series(rock, surface, refuse)
    if rock.is_level_set(surface):
        check_level_set(rock, surface, refuse)
    else:
        _check_shape(rock, surface, refuse, bool(project.faults))
        _check_dips(surface, refuse)
    check_values(surface, refuse)
    check_property(project.library, surface.property, refuse)


def _check_shape(rock: Rock, surface: Surface, refuse: Refuse, continues: bool) -> None:
    """Checks the source of the shape. continues: a ready mesh may also have a method, by which it is
    continued to faults."""
    shapes = shapes_given(surface, ("points", "mesh"), refuse)
    no_points = not shapes and not rock.has_field_data
    if no_points and surface.method is None:
        raise refuse("it has neither points nor a mesh", advice="add points = ... or mesh = ...")
    if shapes:
        check_file(surface.input_file, shapes[0], refuse)
    with errors_located(refuse):
        for file in (surface.mesh_file, surface.point_file):
            if file is not None:
                file.check()
    if not surface.has_points:
        idle = keys_without_effect(surface, "mesh")
        if continues:
            idle = [key for key in idle if key != "method" and key not in surface.options]
        if idle:
            raise refuse(f"'{idle[0]}' has no effect, as a mesh is not interpolated", idle[0])
        if continues:
            _check_method(surface, refuse)
            _check_continuation(surface, refuse)
        return
    _check_method(surface, refuse, no_points)
    if surface.true_thickness and not surface.has_thickness:
        what = "'true_thickness' has no effect, as the surface keeps no thickness above another one"
        raise refuse(what, "true_thickness", 'add minimum_thickness, or use method = "parallel"')
    length = rock.edge_length if rock.triangles is None else rock.triangles
    for key, value in (("region", rock.region), ("edge_length", length)):
        if value is None:
            raise refuse(
                f"its points cannot be interpolated: {rock.item} has no {key}",
                "points",
                f"give the rock mass {'an' if key == 'edge_length' else 'a'} {key}",
            )


def _check_dips(surface: Surface, refuse: Refuse) -> None:
    check_table_file(surface.dip_file, "dips", refuse)
    if surface.dips is not None:
        with errors_located(refuse):
            check_uses_dips(surface.method or DEFAULT_METHOD)


def _check_continuation(surface: Surface, refuse: Refuse) -> None:
    """Refuses options that give a ready mesh no heights where it does not reach its faults."""
    for option in SURFACE_OPTIONS:
        if isinstance(surface.options.get(option), str):
            what = f"'{option}' names a surface; a mesh is continued from its own vertices"
            raise refuse(what, option, "choose another method, or a number")
    if surface.options.get("extrapolate") == "none":
        what = 'extrapolate = "none" gives no elevations where the mesh is continued to the faults'
        raise refuse(what, "extrapolate", 'use "nearest" or "method"')


def _check_method(surface: Surface, refuse: Refuse, no_points: bool = False) -> None:
    with errors_located(refuse):
        check_method(surface.method or DEFAULT_METHOD)
        if no_points and surface.needs_points:
            method, _ = surface.method_options()
            option = METHODS[method].instead_of_points
            either = f", or {option} = ..." if option else ""
            raise refuse(f"method '{method}' needs points", "method", f"add points = ...{either}")
        surface.method_options()


def _check_references(rock: Rock) -> None:
    """Refuses unknown names of surfaces, a minimum thickness above nothing, and circular references."""
    numbers = {surface.name: number for number, surface in enumerate(rock.surfaces)}
    needs: list[list[tuple[str, int]]] = []
    for number, surface in enumerate(rock.surfaces):
        item_name, needed = surface_item(rock, surface), []
        for option in SURFACE_OPTIONS:
            name = surface.options.get(option)
            if not isinstance(name, str):
                continue
            if name not in numbers:
                what = f"'{option}' names surface '{name}', which {rock.item} does not have"
                raise surface.refused(what, option, f"it has {', '.join(numbers)}", item_name)
            needed.append((option, numbers[name]))
        for key in ("minimum_thickness", "correlation"):
            if number == 0 and getattr(surface, key) is not None:
                what = f"the oldest surface cannot have a {key}, as there is no surface beneath it"
                raise surface.refused(what, key, item=item_name)
        if surface.minimum_thickness is not None:
            needed.append(("minimum_thickness", number - 1))
        needs.append(needed)
    done: set[int] = set()

    def visit(number: int, above: tuple[int, ...]) -> None:
        for option, needed in needs[number]:
            if needed in (*above, number):
                surface, other = rock.surfaces[number], rock.surfaces[needed]
                what = f"'{option}' names '{other.name}', which depends on this surface"
                raise surface.refused(what, option, item=surface_item(rock, surface))
            if needed not in done:
                visit(needed, (*above, number))
        done.add(number)

    for number in range(len(rock.surfaces)):
        if number not in done:
            visit(number, ())
