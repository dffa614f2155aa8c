# SPDX-License-Identifier: GPL-3.0-or-later
"""References by name from settings and picks to surfaces, series, faults and rock masses: renaming a row
updates them."""

from ...core import Dips
from ...core.settings.methods import OPTIONS
from ...core.settings.setting import property_name
from . import borehole_picks, imported, observed_blocks, settings, surface_dips

_OF_SURFACES = [property_name(key, option) for key, option in OPTIONS.items() if option.kind == "surface"]


def store(scene):
    """Stores the present names of all rows."""
    for row in _named(scene):
        if row.known_name != row.name:
            row.known_name = row.name


def update_references(row):
    """Updates references to a row when it is renamed, unless another row has the old name."""
    scene, old = row.id_data, row.known_name
    row.known_name = row.name
    kind = settings.kind_of(row)
    rows = settings.rock_of(row).series if kind == "series" else _named(scene)
    alike = [other for other in rows if settings.kind_of(other) == kind]
    if not old or any(other.name == old for other in alike):
        return
    if kind == "surface":
        imported.rename(settings.rock_of(row), old, row.name)
        borehole_picks.rename(settings.rock_of(row), old, row.name)
        observed_blocks.rename(settings.rock_of(row), old, row.name)
        rock = settings.rock_of(row)
        named = [series for series in rock.series if isinstance(surface_dips.of_row(series), Dips)]
        for owner in (rock, *named):
            surface_dips.rename(owner, old, row.name)
    if kind == "body":
        for rock in scene.realmodel.rocks:
            observed_blocks.rename(rock, old, row.name)
    with settings.filling():
        for owner, key in _references(scene, row, kind):
            if getattr(owner, key) == old:
                setattr(owner, key, row.name)


def _named(scene):
    for rock in scene.realmodel.rocks:
        yield rock
        yield from rock.series
    yield from (row for _, row in settings.interface_rows(scene))


def _references(scene, row, kind):
    """(row, property) of all that may refer to a row."""
    group = scene.realmodel
    if kind == "surface":
        rock = settings.rock_of(row)
        yield from ((other, key) for other in rock.surfaces for key in _OF_SURFACES)
        yield from ((fault, key) for fault in group.faults for key in ("youngest", "elevation"))
        yield from ((body, "after") for body in group.bodies)
    elif kind == "series":
        yield from ((surface, "series") for surface in settings.rock_of(row).surfaces)
    elif kind == "fault":
        yield from ((end, "name") for fault in group.faults for end in fault.ends_at)
    elif kind == "rock":
        yield from ((rock, "name") for fault in group.faults for rock in fault.rocks)
        yield from ((body, "rock") for body in group.bodies)
