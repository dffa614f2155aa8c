# SPDX-License-Identifier: GPL-3.0-or-later
"""The checks of the series of a rock mass."""

from __future__ import annotations

from functools import partial
from itertools import pairwise

from ..settings.dips import Dips, SpaceDips
from ..settings.series import AUTO, FIELD, SHEET_METHODS
from .entry import (
    Refuse,
    check_file,
    check_table_file,
    check_values,
    keys_without_effect,
    named_once,
    refused_by,
)
from .project import Rock, Surface
from .series import Series


def check_series(rock: Rock) -> None:
    """Refuses series that make no sense. Raises InputRefused."""
    for series in named_once(rock.series, "series"):
        refuse = partial(series.refused, item=f"{rock.item}, {series.item}")
        check_values(series, refuse)
        _check_dips(series, refuse)
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
    if series.resolution != AUTO:
        raise refuse("'resolution' has no effect, as sheets have no lattice", "resolution", "leave it out")
    if series.thickness != AUTO:
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


def _check_dips(series: Series, refuse: Refuse) -> None:
    check_table_file(series.dip_file, "dips", refuse)
    allowed = (SpaceDips,) if series.kind == FIELD else (SpaceDips, Dips)
    if series.dip_file is None and series.dips is not None and not isinstance(series.dips, allowed):
        raise refuse("its dips are not in space", "dips", "give a file, or SpaceDips")


def _check_field(rock: Rock, refuse: Refuse) -> None:
    for key, value in (("region", rock.region), ("base_elevation", rock.base_elevation)):
        if value is None:
            what = f"its field has no end: {rock.item} has no {key}"
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
    with refused_by(refuse):
        if surface.point_file is not None:
            surface.point_file.check()


def check_names_series(rock: Rock, surface: Surface, refuse: Refuse) -> None:
    """Refuses a surface of a series that its rock mass does not have. Raises InputRefused."""
    names = [series.name for series in rock.series]
    if surface.series is not None and surface.series not in names:
        advice = f"it has {', '.join(names)}" if names else "add [[rock.series]]"
        raise refuse(f"{rock.item} has no series '{surface.series}'", "series", advice)
