# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks of faults and bodies before anything is read."""

from __future__ import annotations

from collections.abc import Collection
from typing import Any

from .entry import (
    Refuse,
    check_file,
    check_property,
    check_values,
    keys_without_effect,
    named_once,
    refused_by,
    shapes_given,
)
from .project import Project
from .structure_entries import FAULT, OF_TRACES, Body, Fault
from .structure_history import displaced_surfaces


def check_structures(project: Project) -> None:
    """Raises InputRefused, naming the line where it is written."""
    for fault in named_once(project.faults, "fault"):
        _check_fault(project, fault)
    for body in named_once(project.bodies, "body"):
        _check_body(project, body)
    _check_ends(project)


def _check_fault(project: Project, fault: Fault) -> None:
    refuse = fault.refused
    _check_shape(fault, refuse, ("trace", "points", "mesh"))
    check_values(fault, refuse)
    for key in keys_without_effect(fault, fault.shape_kind):
        if FAULT[key].shapes == OF_TRACES:
            raise refuse(f"'{key}' has no effect, as its shape is no trace", key, "add trace = ...")
        shape = "its shape is a trace" if fault.trace is not None else "no surface is fitted through points"
        raise refuse(f"'{key}' has no effect, as {shape}", key)
    _check_trace(project, fault, refuse)
    _check_names(project, refuse, "rocks", fault.rocks, "youngest", fault.youngest)


def _check_trace(project: Project, fault: Fault, refuse: Refuse) -> None:
    """Refuses a trace without a dip, and one on a surface that is not there."""
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
    _check_shape(body, refuse, ("mesh",))
    check_values(body, refuse)
    if body.void and body.property:
        raise refuse("a void has no rock, so 'property' has no effect", "property")
    check_property(project.library, body.property, refuse)
    names = () if body.rock is None else (body.rock,)
    _check_names(project, refuse, "rock", names, "after", body.after)


def _check_shape(entry: Fault | Body, refuse: Refuse, files: tuple[str, ...]) -> None:
    """Refuses an entry without a shape, or with two."""
    shapes = shapes_given(entry, files, refuse)
    if not shapes:
        advice = " or ".join(f"{key} = ..." for key in reversed(files))
        raise refuse("it has no shape", advice=f"add {advice}")
    with refused_by(refuse):
        for file in (entry.mesh_file, entry.point_file, getattr(entry, "trace_file", None)):
            if file is not None:
                file.check()
    check_file(entry.input_file, shapes[0], refuse)


def _check_names(project: Project, refuse: Refuse, key: str, rocks: Any, time_key: str, surface: Any) -> None:
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
