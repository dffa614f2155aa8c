# SPDX-License-Identifier: GPL-3.0-or-later
"""Errors of the stack builder in the user's terms: rock mass, surface, file, triangles, position."""

from __future__ import annotations

import numpy as np

from ..base.errors import BuildFailed, InputRefused, number_list, place_text
from ..base.work import NativeError
from ..project.project import surface_item
from ..surfaces.rock_input import RockInput

_ONE_HEIGHT = "a surface may have only one elevation at each place"


def refused_stack(error: NativeError, inputs: list[RockInput]) -> InputRefused | BuildFailed:
    """The refusal for a native InputError of build_rock_masses; the caller raises it."""
    place = tuple(error.place) if error.place is not None else None
    near = f" near {place_text(place)}" if place else ""
    if error.kind == "rocks_overlap":
        first, second = (inputs[int(i)].rock for i in error.items)
        file, line = second.shape_source("region") if second.region is not None else (None, None)
        return InputRefused(
            f"it overlaps {first.item} in plan{near}",
            file=file,
            line=line,
            item=second.item,
            advice="rock masses may share borders but no area: correct the regions",
            place=place,
        )
    if error.kind == "bad_region":
        rock = inputs[int(error.items[0])].rock
        file, line = rock.shape_source("region")
        return InputRefused(
            str(error), file=file, line=line, item=rock.item, advice="a region covers each position once"
        )
    if error.kind == "base_not_below":
        rock_input = inputs[int(error.items[0])]
        rock = rock_input.rock
        file, line = rock.place_of("base_elevation")
        what = f"base_elevation {rock.base_elevation:.9g} is not below all of the rock mass"
        lowest = f", whose lowest point is {place_text(place)}" if place else ""
        lower = f"choose one below {place[2]:.9g}" if place else "choose a lower one"
        if place and (beyond := _beyond_its_points(rock_input, place[2])):
            lower = f"{lower}; {beyond}"
        return InputRefused(what + lowest, file=file, line=line, item=rock.item, advice=lower, place=place)
    entry, number = _surface_at(inputs, error.surface)
    if entry is None:
        return InputRefused(str(error), place=place)
    rock = entry.rock
    surface = rock.surfaces[number]
    file, line = surface.shape_source()
    items = tuple(int(i) for i in error.items)
    named = _triangles(items, entry.file_faces[number])
    what, advice = str(error), None
    if error.kind == "vertical_triangle":
        verb = "is" if len(items) == 1 else "are"
        what, advice = (
            f"{named} {verb} vertical{near}",
            f"{_ONE_HEIGHT}: tilt or remove the vertical triangles",
        )
    elif error.kind == "double_valued" and number in entry.overlapping:
        return entry.overlapping[number].within(surface_item(rock, surface), file=file, line=line)
    elif error.kind == "double_valued":
        what, advice = (
            f"{named} overlap in plan{near}",
            f"{_ONE_HEIGHT}: remove the overhang or the double layer",
        )
    return InputRefused(
        what,
        file=file,
        line=line,
        item=surface_item(rock, surface),
        advice=advice,
        triangles=items,
        place=place,
    )


def _surface_at(inputs: list[RockInput], surface: int) -> tuple[RockInput | None, int]:
    """The rock mass of a surface counted through all of them, and its number there."""
    if surface >= 0:
        for entry in inputs:
            if surface < len(entry.surfaces):
                return entry, surface
            surface -= len(entry.surfaces)
    return None, -1


def _beyond_its_points(entry: RockInput, lowest: float) -> str:
    """The advice where the lowest position is not at a point, but extrapolated by a method."""
    for surface, data, shape in zip(entry.rock.surfaces, entry.data, entry.surfaces, strict=True):
        if shape is None or shape.vertices[:, 2].min() > lowest or not entry.rock.is_interpolated(surface):
            continue
        z = data.points[:, 2]
        if len(z) and z.min() > lowest:
            return f"the lowest point of surface '{surface.name}' is {z.min():.6g}, so check its method"
    return ""


def _triangles(items: tuple[int, ...], file_faces: np.ndarray | None) -> str:
    """'triangle 3' or 'triangles 3 and 5'; with the faces of the file where its polygons were divided."""
    text = f"triangle{'s' if len(items) != 1 else ''} {number_list(items)}"
    if file_faces is None:
        return text
    faces = dict.fromkeys(int(file_faces[i]) for i in items)
    return f"{text} (of face{'s' if len(faces) != 1 else ''} {number_list(faces)})"
