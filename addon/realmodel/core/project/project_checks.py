# SPDX-License-Identifier: GPL-3.0-or-later
"""The checks of a project, before anything is read."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from ..base.errors import InputRefused
from ..settings.map_layer import MapLayer
from ..settings.mesh_sizes import AUTO, local_lengths
from ..settings.method_options import OptionRefused, check_fields, is_name
from ..settings.methods import (
    DEFAULT_METHOD,
    METHODS,
    SURFACE_OPTIONS,
    check_method,
    check_uses_dips,
)
from .entry import (
    Refuse,
    check_file,
    check_property,
    check_table_file,
    check_values,
    keys_without_effect,
    named_once,
    refused_by,
    shapes_given,
)
from .field_checks import check_field_data
from .plan_input import check_layer, is_place_elsewhere
from .project import Project, Rock, Surface, surface_item
from .series_checks import check_level_set, check_names_series, check_series
from .structure_checks import check_structures


def check_project(project: Project) -> None:
    """Refuses a project that cannot be built, before anything is read. Raises InputRefused."""
    if not is_name(project.name):
        raise InputRefused("a project needs a name", file=project.path)
    try:
        check_fields(project)
    except OptionRefused as error:
        raise InputRefused(error.what, file=project.path, item=error.option, advice=error.advice) from error
    if not project.rocks:
        raise InputRefused("there is no rock mass", file=project.path, item=f"project '{project.name}'")
    for rock in named_once(project.rocks, "rock mass"):
        _check_rock(project, rock)
    check_structures(project)


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
    with refused_by(refuse):
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
        with refused_by(refuse):
            check_uses_dips(surface.method or DEFAULT_METHOD)


def _check_continuation(surface: Surface, refuse: Refuse) -> None:
    """Refuses options that give a ready mesh no heights where it does not reach its faults."""
    for option in SURFACE_OPTIONS:
        if isinstance(surface.options.get(option), str):
            what = f"'{option}' names a surface; a mesh is continued from its own vertices"
            raise refuse(what, option, "choose another method, or a number")
    if surface.options.get("extrapolate") == "none":
        what = 'extrapolate = "none" gives no heights where the mesh is continued to the faults'
        raise refuse(what, "extrapolate", 'use "nearest" or "method"')


def _check_method(surface: Surface, refuse: Refuse, no_points: bool = False) -> None:
    with refused_by(refuse):
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
