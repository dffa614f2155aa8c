# SPDX-License-Identifier: GPL-3.0-or-later
"""The choices of the fields for names: surfaces of the rock mass; columns, values and layers of a surface's
file. Blender asks for them when such a field is edited, never while a panel is drawn."""

from ...core import RealModelError
from ...core.readers import contents
from ...core.settings.directions import COMPASS
from ..host import caches
from ..objects import stored_arrays
from . import project_settings, reading_text, settings

_MOST_VALUES = 50
_found = caches.new(most=64)  # by the stamp of a file and the kind of names: recently found names


def surfaces(row, _context, _text):
    """The other surfaces of the rock mass; of a fault those of all rock masses."""
    if settings.kind_of(row) == "fault":
        return all_surfaces(row, _context, _text)
    return [other.name for other in settings.rock_of(row).surfaces if other != row]


def surfaces_of_rock(row, _context, _text):
    """The surfaces of the rock mass of a series, the youngest first, as in the list."""
    return [surface.name for surface in reversed(settings.rock_of(row).surfaces)]


def series(row, _context, _text):
    """The series of the rock mass of a surface."""
    return [series_row.name for series_row in settings.rock_of(row).series]


def all_surfaces(row, _context, _text):
    """The surfaces of all rock masses, the youngest first, as in the list."""
    rocks = row.id_data.realmodel.rocks
    return list(dict.fromkeys(surface.name for rock in rocks for surface in reversed(rock.surfaces)))


def rocks(row, _context, _text):
    return [rock.name for rock in row.id_data.realmodel.rocks]


def directions(_row, _context, _text):
    return list(COMPASS)


def faults(row, _context, _text):
    """The other faults, but for those at which this one ends already."""
    fault = row.id_data.path_resolve(row.path_from_id().rpartition(".ends_at[")[0])
    taken = {fault.name, *(end.name for end in fault.ends_at if end != row)}
    return [other.name for other in row.id_data.realmodel.faults if other.name not in taken]


def columns(row, _context, _text):
    surface = settings.surface_of(row)
    return [
        reading_text.column_text(name) for name in _of_file(surface, contents.column_names, surface.layer)
    ]


def values(row, _context, _text):
    surface = settings.surface_of(row)
    texts = _of_file(surface, contents.column_values, row.column.strip('" '), surface.layer)[:_MOST_VALUES]
    return [reading_text.value_text(reading_text.value(value)) for value in texts]


def layers(row, _context, _text):
    return _of_file(row, contents.layer_names)


def _of_file(surface, ask, *arguments):
    """The contents of a file; empty where it cannot be read: a build reports the reason."""
    path = project_settings.absolute(surface.filepath)
    key = (path and stored_arrays.file_stamp(path), ask.__name__, *arguments)
    if not key[0]:
        return []
    if key not in _found:
        try:
            _found[key] = ask(path, *(argument or None for argument in arguments))
        except RealModelError:
            return []
    return _found[key]
