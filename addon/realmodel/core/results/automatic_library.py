# SPDX-License-Identifier: GPL-3.0-or-later
"""A library for projects that have none: a property with its own color for the rock of each surface and
body."""

from __future__ import annotations

import copy
import itertools
from collections.abc import Iterator
from dataclasses import replace

from ..cells.blocks import named_blocks
from ..cells.model_data import SomeModel
from ..project.library import Library, Property
from ..project.looks import hex_color, rgb
from ..project.project import Project

# Colors of rocks for what has none: any two differ, and most of all neighbors, also for people who confuse
# red and green or blue and yellow (CIE76 of 21 or more in the simulations of Machado et al., 2009).
PALETTE = (
    *("#efd951", "#ac5132", "#b6dae3", "#663428", "#acb960", "#1f515c"),
    *("#e6a396", "#e45d20", "#6d7365", "#f4f7d7", "#6aa7c7", "#432f7e"),
)


def palette() -> Iterator[str]:
    """The colors of PALETTE, then mixed with white, then with black: no two are equal."""
    yield from PALETTE
    for other in (1.0, 0.0):
        for color in PALETTE:
            yield hex_color(0.6 * channel + 0.4 * other for channel in rgb(color))


def with_library(project: Project) -> Project:
    """The project with a library. Where it has none, an entry for each property that it names, and one, by
    its name, for each surface or body without a property."""
    if project.library is not None:
        return project
    owners = list(_owners(project))
    free = max([0, *(int(owner.property) for owner in owners)]) + 1
    entries: dict[int, Property] = {}
    colors = itertools.cycle(palette())
    by_name: dict[str, int] = {}
    for owner in owners:
        number = int(owner.property)
        name = f"property {number}"
        if not number:
            number, name = by_name.setdefault(owner.name.casefold(), free + len(by_name)), owner.name
        if number not in entries:
            entries[number] = Property(number, name, color=next(colors))
    rocks = [replace(rock, surfaces=_given(rock.surfaces, by_name)) for rock in project.rocks]
    bodies = _given(project.bodies, by_name)
    return replace(project, library=Library(list(entries.values())), rocks=rocks, bodies=bodies)


def _owners(project: Project) -> Iterator:
    """The surfaces and bodies whose rock has a property."""
    for rock in project.rocks:
        yield from rock.surfaces
    yield from (body for body in project.bodies if not body.void)


def _given(owners: list, by_name: dict[str, int]) -> list:
    """Surfaces or bodies; those without a property have that of their name."""
    return [
        owner
        if owner.property or getattr(owner, "void", False)
        else replace(owner, property=by_name[owner.name.casefold()])
        for owner in owners
    ]


def model_with_library(model: SomeModel) -> SomeModel:
    """The model, of a project with a library. The arrays are the same ones."""
    project = with_library(model.project)
    if project is model.project:
        return model
    made = copy.copy(model)
    made.project = project
    made.rock_inputs = [
        replace(entry, rock=replace(entry.rock, surfaces=rock.surfaces))
        for entry, rock in zip(model.rock_inputs, project.rocks, strict=False)
    ]
    numbers = [surface.property for rock in project.rocks for surface in rock.surfaces]
    made.structures = replace(model.structures, bodies=project.bodies)
    numbers += [0] * len(project.faults) + [body.property for body in project.bodies]
    made.blocks = named_blocks([replace(block, property=numbers[block.surface]) for block in model.blocks])
    return made
