# SPDX-License-Identifier: GPL-3.0-or-later
"""The rows of `scene.realmodel`: the active one, valid pointers, names, numbers in full precision."""

from contextlib import contextmanager

import numpy as np

from ... import preferences
from ..host.versions import GREASE_PENCIL

VERSION = 7  # of the settings in a .blend

DATA = "realmodel_data"  # on an object: it shows data of a model, and is no input of one

IMAGE = "realmodel_image"  # on an object: it is an image that was placed by its coordinates
LINE_OBJECTS = ("TRACE_OBJECT", "STICKS_OBJECT")  # sources of faults: objects with lines
OF_OBJECTS = ("POINTS_OBJECT", "MESH_OBJECT", *LINE_OBJECTS)  # sources that are objects of the user
TRACES = ("TRACE_OBJECT", "TRACE_FILE")  # sources of faults that are lines

_quiet = 0  # how many blocks of code fill in settings at the moment


@contextmanager
def filling():
    """While it is active, changes of settings are made by the program, and update callbacks do nothing."""
    global _quiet
    _quiet += 1
    try:
        yield
    finally:
        _quiet -= 1


def is_filling():
    return _quiet > 0


def begin(group):
    """A model is in the scene from now on; the first one is displayed as the preferences say."""
    with filling():
        if not group.exists:
            chosen = preferences.current()
            group.display, group.cells = chosen.display, chosen.cells
        group.exists, group.version = True, VERSION


def is_mesh_object(_row, item):
    """Poll of pointers to objects with vertices."""
    return item.type == "MESH" and DATA not in item


def is_region_object(_row, item):
    """Poll of pointers to objects that can bound a region."""
    return item.type in {"MESH", "CURVE"} and DATA not in item


def is_drawn_object(item):
    """Whether contacts and sticks can be taken from an object: it has lines, or strokes."""
    return is_region_object(None, item) or item.type in GREASE_PENCIL


def is_fault_object(row, item):
    """Poll of the pointer of a fault: to a mesh, or to a curve or mesh with its trace or its sticks."""
    return (is_region_object if row.source in LINE_OBJECTS else is_mesh_object)(row, item)


def active_rock(scene):
    """The active rock mass's row, or None."""
    rows = scene.realmodel.rocks
    return rows[min(scene.realmodel.active_rock, len(rows) - 1)] if len(rows) else None


def active_surface(scene):
    """The active surface's row, or None."""
    rock = active_rock(scene)
    return None if rock is None else _active_surface_in(rock)


def _active_surface_in(rock):
    if not len(rock.surfaces):
        return None
    return rock.surfaces[min(max(rock.active_surface, 0), len(rock.surfaces) - 1)]


def terrain_of(rock):
    """The surface's row that is the terrain of a rock mass, or None."""
    return next((row for row in rock.surfaces if row.is_terrain), None)


def keep_terrains(scene):
    """Moves terrains above all other surfaces, in whatever order these were added or moved."""
    for rock in scene.realmodel.rocks:
        terrain, last = terrain_of(rock), len(rock.surfaces) - 1
        if terrain is not None and terrain != rock.surfaces[last]:
            active = _active_surface_in(rock).name
            with filling():
                rock.surfaces.move(list(rock.surfaces).index(terrain), last)
                rock.active_surface = rock.surfaces.find(active)


def surface_of(row):
    """The surface that a row is, or is of: a filter."""
    return row.id_data.path_resolve(row.path_from_id().partition(".filters[")[0])


def rock_of(row):
    """The rock mass that the row of a surface or of a series belongs to."""
    within = ".series[" if kind_of(row) == "series" else ".surfaces["
    return row.id_data.path_resolve(row.path_from_id().rpartition(within)[0])


def surface_rows(scene):
    """(rock row, surface row) of every surface, in the model's order."""
    for rock in scene.realmodel.rocks:
        for surface in rock.surfaces:
            yield rock, surface


def structure_rows(scene):
    """(place, row) of every fault, then of every body: places are ("fault", n) and ("body", n)."""
    for kind in ("fault", "body"):
        for number, row in enumerate(structures_of(scene, kind)):
            yield (kind, number), row


def structures_of(scene, kind):
    """The rows of the faults, or of the bodies."""
    return scene.realmodel.faults if kind == "fault" else scene.realmodel.bodies


def interface_rows(scene):
    """(place, row) of all that has an interface: surfaces, whose places are (rock, surface) numbers, then
    faults and bodies."""
    for r, rock in enumerate(scene.realmodel.rocks):
        for s, surface in enumerate(rock.surfaces):
            yield (r, s), surface
    yield from structure_rows(scene)


def row_at(scene, place):
    """The row of a place; of (rock, None) the rock mass."""
    first, number = place
    if isinstance(first, str):
        return structures_of(scene, first)[number]
    rock = scene.realmodel.rocks[first]
    return rock if number is None else rock.surfaces[number]


def kind_of(row):
    """ "surface", "series", "fault", "body" or "rock"."""
    path = row.path_from_id()
    for kind, within in (("surface", ".surfaces["), ("series", ".series[")):
        if within in path:
            return kind
    return "fault" if ".faults[" in path else "body" if ".bodies[" in path else "rock"


def active_structure(scene):
    """The active row of the list of faults and bodies that is shown; None where it is empty."""
    group = scene.realmodel
    rows = structures_of(scene, group.structure_kind.lower())
    number = getattr(group, f"active_{group.structure_kind.lower()}")
    return rows[min(max(number, 0), len(rows) - 1)] if len(rows) else None


def row_of_block(scene, block):
    """The row of the surface that a block (a row of the results) lies beneath, or of the body that it is;
    None where it is gone."""
    if block.is_body:
        return next((body for body in scene.realmodel.bodies if body.name == block.surface), None)
    rows = (row for rock, row in surface_rows(scene) if (rock.name, row.name) == (block.rock, block.surface))
    return next(rows, None)


def time_of_block(scene, block):
    """The number, from the oldest, of the surface with which a block came."""
    rows = next((list(r.surfaces) for r in scene.realmodel.rocks if r.name == block.rock), [])
    names, name = [row.name for row in rows], block.surface
    if block.is_body:
        body = row_of_block(scene, block)
        below = [row.name for row in rows if not row.is_terrain] or [""]
        name = below[-1] if body is None or not body.after else body.after
    return names.index(name) if name in names else 0


def property_rows(scene):
    """The rows that have a property: surfaces, then bodies."""
    yield from (row for _, row in surface_rows(scene))
    yield from scene.realmodel.bodies


def last_stage(scene):
    """The number of the youngest surface, counted from 0; 0 where there is none."""
    return (
        max((len(rock.surfaces) for rock in scene.realmodel.rocks), default=1) - 1 if has_rows(scene) else 0
    )


def follow_youngest(scene):
    """The stage goes with the youngest surface, where it was there before rows were added or removed, or
    there is no model yet."""
    group, last = scene.realmodel, last_stage(scene)
    before = last if group.known_last < 0 else group.known_last
    with filling():
        if group.stage != last and (group.stage >= min(before, last) or not len(group.results)):
            group.stage = last
        if group.known_last != last:
            group.known_last = last


def has_rows(scene):
    return any(len(rock.surfaces) for rock in scene.realmodel.rocks)


def free_name(rows, wanted, own=None):
    """The wanted name, or with the next free number where another row has it."""
    taken = {row.name for row in rows if row != own}
    if wanted not in taken:
        return wanted
    number = 2
    while f"{wanted} {number}" in taken:
        number += 1
    return f"{wanted} {number}"


def number(row, key):
    """A number of a row in full precision: Blender's properties have 32 bits, about seven digits.

    A number from `set_number` is returned unchanged while the property still shows it; a typed number is
    returned as the shortest decimal that the property stands for, so 0.1 is 0.1.
    """
    shown = np.float32(getattr(row, key))
    exact = row.exact.get(key)
    if exact is not None and np.float32(exact) == shown:
        return float(exact)
    return plain(shown)


def plain(value):
    """A typed number, of 32 bits in Blender, as the shortest decimal that it stands for: 0.1 is 0.1."""
    return float(str(np.float32(value)))


def set_number(row, key, value):
    """Sets a number of a row, and keeps all its digits."""
    setattr(row, key, value)
    exact = {name: exact_value for name, exact_value in row.exact.items() if name != key}
    if plain(getattr(row, key)) != float(value):
        exact[key] = float(value)
    row.exact = exact


def copy_row(source, target):
    """Copies every setting of one row to another of its kind, including rows within it."""
    with filling():
        for prop in source.bl_rna.properties:
            key = prop.identifier
            if prop.type == "COLLECTION":
                for entry in getattr(source, key):
                    copy_row(entry, getattr(target, key).add())
            elif not prop.is_readonly and not prop.is_skip_save:  # derived from other properties
                setattr(target, key, getattr(source, key))
        for key in set(source.keys()) - set(source.bl_rna.properties.keys()):  # arrays
            setattr(target, key, getattr(source, key))
