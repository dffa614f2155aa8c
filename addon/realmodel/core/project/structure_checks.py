# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks of faults and bodies before anything is read."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from ..base.errors import InputRefused
from ..settings.method_options import OptionRefused, checked, is_name
from ..settings.point_file import ReadingError
from ..settings.schema import FAULT
from .structure_entries import Body, Fault, body_item, fault_item
from .structure_history import displaced_surfaces

_OF_TRACES = ("dip", "dip_direction", "elevation")


def check_structures(project) -> None:
    """Raises InputRefused, naming the line where it is written."""
    for entries, kind, item, check in (
        (project.faults, "fault", fault_item, _check_fault),
        (project.bodies, "body", body_item, _check_body),
    ):
        seen: set[str] = set()
        for entry in entries:
            if not is_name(entry.name):
                raise _refuse(entry, f"a {kind}", "it has no name", "name")
            if entry.name in seen:
                advice = f"give each {kind} a unique name"
                raise _refuse(entry, item(entry), f"another {kind} has this name", "name", advice)
            seen.add(entry.name)
            check(project, entry)
    _check_ends(project)


def _refuse(entry, item: str, what: str, key: str | None = None, advice: str | None = None) -> InputRefused:
    source = entry.source
    file = source.document.file if source else None
    return InputRefused(what, file=file, line=source.line(key) if source else None, item=item, advice=advice)


def _check_fault(project, fault: Fault) -> None:
    def refuse(what: str, key: str | None = None, advice: str | None = None) -> InputRefused:
        return _refuse(fault, fault_item(fault), what, key, advice)

    _check_shape(fault, refuse, ("trace", "points", "mesh"))
    for key in ("rocks", "ends_at"):
        names = getattr(fault, key)
        if isinstance(names, str) or not all(isinstance(name, str) for name in names):
            raise refuse(f"'{key}' must be a list of names, not {names!r}", key, f'write {key} = ["..."]')
    if not isinstance(fault.dies_out, bool):
        raise refuse(f"'dies_out' must be true or false, not {fault.dies_out!r}", "dies_out")
    _check_trace(project, fault, refuse)
    if fault.points is None and fault.stick:
        shape = "its shape is a trace" if fault.trace is not None else "no surface is fitted through points"
        raise refuse(f"'stick' has no effect, as {shape}", "stick")
    if not _is_length(fault.extend):
        raise refuse(f"'extend' must be a length of at least 0, not {fault.extend!r}", "extend")
    _check_names(project, refuse, "rocks", fault.rocks, "youngest", fault.youngest)


def _check_trace(project, fault: Fault, refuse) -> None:
    """Refuses a trace without a dip, and what there is of one without a trace."""
    if fault.trace is None:
        for key in _OF_TRACES:
            if getattr(fault, key) is not None:
                raise refuse(f"'{key}' has no effect, as its shape is no trace", key, "add trace = ...")
        return
    for key in _OF_TRACES:
        try:
            checked(key, FAULT[key], getattr(fault, key))
        except OptionRefused as error:
            raise refuse(error.what, key, error.advice) from error
    if fault.trace_file is None and fault.dip is None:
        raise refuse("a trace needs a dip", "trace", "add dip = ... (90 where the fault is vertical)")
    if fault.elevation is not None and np.ndim(fault.elevation):
        raise refuse("'elevation' must be a number or the name of a surface", "elevation")
    if isinstance(fault.elevation, str):
        rocks = [project.rocks[number] for number in displaced_surfaces(project, fault)]
        names = dict.fromkeys(surface.name for rock in rocks for surface in rock.surfaces)
        if fault.elevation not in names:
            what = f"'elevation' names surface '{fault.elevation}', which the rock that it displaces lacks"
            raise refuse(what, "elevation", _there(names) if names else None)


def _check_body(project, body: Body) -> None:
    def refuse(what: str, key: str | None = None, advice: str | None = None) -> InputRefused:
        return _refuse(body, body_item(body), what, key, advice)

    _check_shape(body, refuse, ("mesh",))
    if not isinstance(body.void, bool):
        raise refuse(f"'void' must be true or false, not {body.void!r}", "void")
    if isinstance(body.property, bool) or not hasattr(body.property, "__index__"):
        raise refuse(f"'property' must be a whole number, not {body.property!r}", "property")
    if body.void and body.property:
        raise refuse("a void has no rock, so 'property' has no effect", "property")
    library = project.library
    if body.property and library is not None and body.property not in library:
        known = ", ".join(str(entry.id) for entry in library.properties)
        raise refuse(f"the library has no property {body.property}", "property", f"it has {known}")
    names = () if body.rock is None else (body.rock,)
    _check_names(project, refuse, "rock", names, "after", body.after)


def _check_shape(entry, refuse, files: tuple[str, ...]) -> None:
    """Refuses an entry without a shape, or with two."""
    arrays = entry.vertices is not None or entry.triangles is not None
    shapes = [key for key in files if getattr(entry, key) is not None] + (["vertices"] if arrays else [])
    if not shapes:
        advice = " or ".join(f"{key} = ..." for key in reversed(files))
        raise refuse("it has no shape", advice=f"add {advice}")
    if len(shapes) > 1:
        raise refuse(f"it has both {shapes[0]} and {shapes[1]}", shapes[1], "use only one of them")
    if arrays and (entry.vertices is None or entry.triangles is None):
        raise refuse("it needs vertices and triangles together")
    try:
        for file in (entry.mesh_file, *(getattr(entry, key, None) for key in ("point_file", "trace_file"))):
            if file is not None:
                file.check()
    except ReadingError as error:
        raise refuse(error.what, error.key, error.advice) from error
    file = entry.input_file
    if file is not None and not _is_file(file):
        raise refuse(f"file not found: {file}", shapes[0], "check the path")


def _is_file(path: Path) -> bool:
    try:
        return path.is_file()
    except (OSError, ValueError):
        return False


def _is_length(value) -> bool:
    if isinstance(value, (bool, str)):
        return False
    try:
        return math.isfinite(value) and value >= 0
    except TypeError:
        return False


def _check_names(project, refuse, key: str, rocks, time_key: str, surface) -> None:
    """Refuses unknown rock masses and surfaces."""
    known = {rock.name: [each.name for each in rock.surfaces] for rock in project.rocks}
    for name in rocks:
        if name not in known:
            raise refuse(f"'{key}' names rock mass '{name}', which does not exist", key, _there(known))
    if surface is None:
        return
    if not isinstance(surface, str):
        raise refuse(f"'{time_key}' must be the name of a surface, not {surface!r}", time_key)
    for name in rocks:
        if surface not in known[name]:
            what = f"'{time_key}' names surface '{surface}', which rock '{name}' does not have"
            raise refuse(what, time_key, f"it has {', '.join(known[name])}")
    if not any(surface in names for names in known.values()):
        every = dict.fromkeys(name for names in known.values() for name in names)
        raise refuse(f"'{time_key}' names surface '{surface}', which does not exist", time_key, _there(every))


def _there(names) -> str:
    return f"there are {', '.join(names)}" if len(names) > 1 else f"there is {', '.join(names)}"


def _check_ends(project) -> None:
    """Refuses faults that end at unknown faults, at each other, or at faults that displace less."""
    faults = {fault.name: fault for fault in project.faults}

    def refuse(fault: Fault, what: str, advice: str | None = None) -> InputRefused:
        return _refuse(fault, fault_item(fault), what, "ends_at", advice)

    for fault in project.faults:
        own = displaced_surfaces(project, fault)
        for name in fault.ends_at:
            if name not in faults:
                what = f"'ends_at' names fault '{name}', which does not exist"
                raise refuse(fault, what, _there(faults))
            if name == fault.name:
                raise refuse(fault, "it cannot end at itself")
            other = displaced_surfaces(project, faults[name])
            for rock in own.keys() & other.keys():
                if own[rock] > other[rock]:
                    surface = project.rocks[rock].surfaces[own[rock]].name
                    what = f"it displaces '{surface}', but fault '{name}', at which it ends, does not"
                    advice = f"give '{name}' a younger 'youngest', or this fault an older one"
                    raise refuse(fault, what, advice)
    for fault in project.faults:
        way = _way_back(fault.name, faults)
        if way:
            through = " at ".join(f"'{name}'" for name in way[1:])
            raise refuse(fault, f"it ends at {through}: no fault of this circle is there first")


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
