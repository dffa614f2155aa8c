# SPDX-License-Identifier: GPL-3.0-or-later
"""Converts the series of a rock mass between its rows and realmodel.core; which surfaces belong to them."""

import numpy as np

from ...core import InputRefused, Rock, Series, Surface
from ...core.base.errors import naming
from ...core.project.project import ROCK
from ...core.project.project_checks import check_level_set, check_series
from ...core.settings.series_kinds import FIELD
from . import method_settings, settings, surface_dips

_STANDS_FOR = np.zeros((3, 2))  # any region, where only whether there is one counts


def fill(rock, series):
    """Fills the rows of a rock mass from realmodel.core.Series whose dips are arrays."""
    rock.series.clear()
    rock.active_series = 0
    for entry in series:
        row = rock.series.add()
        method_settings.set_values(row, Series, entry)
        surface_dips.keep(row, entry.dips)


def of_rock(rock):
    """The Series of a rock mass. Raises InputRefused for damaged arrays."""
    return [_series(row, surface_dips.of_row) for row in rock.series]


def _series(row, dips_of):
    values = method_settings.values(row, Series, row.kind)  # what sheets do not have is kept
    with naming(f"series '{row.name}'"):
        return Series(**values, dips=dips_of(row))


def active(rock):
    """The row of the active series of a rock mass; None where it has none."""
    return rock.series[min(max(rock.active_series, 0), len(rock.series) - 1)] if len(rock.series) else None


def fields(rock):
    """The names of the series of a rock mass whose surfaces are level sets."""
    return {row.name for row in rock.series if row.kind == FIELD}


def is_level_set(surface):
    """Whether the row of a surface is of a level set of a field."""
    return bool(surface.series) and surface.series in fields(settings.rock_of(surface))


def of_surface(surface):
    """The row of the series of a surface's row; None where it is in none."""
    return next((row for row in settings.rock_of(surface).series if row.name == surface.series), None)


def members(rock, row):
    """The numbers of the surfaces of a series, from the oldest."""
    return [number for number, surface in enumerate(rock.surfaces) if surface.series == row.name]


def set_run(rock, row, first, last):
    """Makes the surfaces from one number to another those of a series."""
    for number, surface in enumerate(rock.surfaces):
        if first <= number <= last:
            surface.series = row.name
        elif surface.series == row.name:
            surface.series = ""


def refusal(rock, row):
    """Why a build refuses a series as it stands, as one sentence, by what needs no look at its data; empty
    where it does not."""
    surfaces = [_outline_of(surface) for surface in rock.surfaces]
    has_region = rock.region is not None or rock.region_file or rock.region_stored
    try:
        core_rock = Rock(
            rock.name,
            surfaces,
            region=_STANDS_FOR if has_region else None,
            base_elevation=method_settings.value(rock, "base_elevation", ROCK),
            series=[_series(row, surface_dips.outline_of)],
        )
        check_series(core_rock)
        for number in members(rock, row) if row.kind == FIELD else ():
            surface = surfaces[number]
            check_level_set(core_rock, surface, lambda *told, own=surface.item: _refused(own, *told))
    except InputRefused as error:
        about = f"{error.item}: " if (error.item or "").startswith("surface") else ""
        return f"{about}{error.what}; {error.advice}" if error.advice else f"{about}{error.what}"
    return ""


def _outline_of(row):
    """A Surface with what matters to its series."""
    surface = Surface(row.name, series=row.series or None)
    if row.source in method_settings.READY_MESHES:
        surface.vertices, surface.triangles = np.empty((0, 3)), np.empty((0, 3), np.int32)
        return surface
    surface.points = np.empty((0, 3))
    if not is_level_set(row):
        surface.method = row.method
    elif row.dips:
        surface.dips = row.dips
    return surface


def _refused(label, what, _key=None, advice=None):
    return InputRefused(what, item=label, advice=advice)
