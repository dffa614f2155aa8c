# SPDX-License-Identifier: GPL-3.0-or-later
"""Picks of boreholes from the objects of a file: drillholes, lines of boreholes, or points that name their
hole."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import Path

import numpy as np

from ...base.errors import InputRefused
from ...base.text import Step
from ...settings.boreholes import Boreholes
from ..tables.boreholes import Picks
from ..tables.hole_tables import PICKS
from ..tables.table_layout import names_shown, plain_name
from ..tables.unit_names import UnitNames
from .geo_object import HOLE, LINES, POINTS, GeoObject, Values
from .object_file import read_objects

_KINDS = (HOLE, LINES, POINTS)
_BLOCK = "block"  # how intervals are called where no pick is


def read_hole_objects(given: Boreholes, step: Step, scale: np.ndarray, units: UnitNames) -> Picks:
    """The picks of the boreholes of a file, or of the object `layer`. scale (3,): the factors to the model's
    unit. units: what the names in it mean.

    An object's points that name a surface are picks; intervals that name one have it at their top, where the
    interval above has another name. `hole` among its data names the hole, else the object's name does.
    Raises InputRefused naming the file and the object.
    """
    assert given.picks is not None
    file = Path(given.picks)
    picks = Picks()
    found_points: dict[str, list[np.ndarray]] = {}
    missing = 0
    kinds = (HOLE,) if given.layer is None else _KINDS
    found = read_objects(file, given.layer, kinds)
    for number, each in enumerate(found):
        for name, hole, place, collar in _picks_of(each, given):
            surface = units.surface(name)
            if units.says_nothing(name) or not surface:
                continue
            if not np.isfinite(place).all():
                missing += 1
                continue
            here = place * scale
            found_points.setdefault(surface, []).append(here)
            top = None if collar is None else collar * scale
            picks.holes.setdefault(hole, (top, []))[1].append((surface, here))
        step((number + 1) / len(found))
    picks.points.update((surface, np.array(places)) for surface, places in found_points.items())
    if not picks.points:
        raise InputRefused("there are no picks in it", file=file)
    for _, places in picks.holes.values():
        places.sort(key=lambda pick: -pick[1][2])
    if missing:
        picks.warnings.append(f"{file}: {missing} picks have no place and are left out")
    return picks


def _picks_of(found: GeoObject, given: Boreholes) -> Iterator[tuple[str, str, np.ndarray, np.ndarray | None]]:
    """Name of the surface, hole, place (3,) and collar of each pick of an object."""
    values, column = _table(found, given)
    names = _texts(values.columns[column])
    hole = _column(values, given.columns.get("hole"), PICKS["hole"])
    holes = [found.name] * len(names) if hole is None else _texts(values.columns[hole])
    before = ("", "")
    for name, own, place in zip(names, holes, values.places, strict=True):
        repeats = values.are_intervals and (name, own) == before
        before = (name, own)
        if not repeats:
            yield name, own, place, found.collar


def _table(found: GeoObject, given: Boreholes) -> tuple[Values, str]:
    """The data of an object that name surfaces, and under which name."""
    said = given.columns.get("surface")
    for values in found.values:
        column = _column(values, said, (*PICKS["surface"], _BLOCK))
        if column is not None:
            return values, column
    there = [name for values in found.values for name in values.columns]
    what = f"it has no data '{said or 'surface'}'"
    advice = f"it has {names_shown(there)}: " if there else ""
    advice += 'name it: columns = { surface = "..." }'
    raise InputRefused(what, file=given.picks, item=f"object '{found.name}'", advice=advice)


def _column(values: Values, said: object, aliases: Iterable[str]) -> str | None:
    """The name of a column: the one that the user says, or the first that is called as usual."""
    if said is not None:
        return next((name for name in values.columns if name.lower() == str(said).strip().lower()), None)
    plain = {plain_name(name): name for name in reversed(values.columns)}
    return next((plain[alias] for alias in aliases if alias in plain), None)


def _texts(column: np.ndarray) -> list[str]:
    return [value.strip() if isinstance(value, str) else f"{value:g}" for value in column.tolist()]
