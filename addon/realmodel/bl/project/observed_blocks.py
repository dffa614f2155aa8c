# SPDX-License-Identifier: GPL-3.0-or-later
"""The observations of blocks of a rock mass, stored in its row."""

from dataclasses import replace
from itertools import pairwise

import numpy as np

from ...core import Observations, RealModelError, Rock, Surface
from ...core.readers import UnitNames
from ..host import caches
from . import settings

_shown = caches.new(most=8)  # by digest
NAMES = ("places", "blocks", "holes", "depths", "intervals", "used", "on", "height_errors")


def keep(row, observations):
    """Stores realmodel.core.Observations, or None."""
    has_some = observations is not None and len(observations)
    row.observations = {name: getattr(observations, name) for name in NAMES} if has_some else {}


def add(row, observations):
    """Adds Observations to those that a rock mass has. Those of a hole, or of a place, take the place of the
    ones that it had. Surfaces whose points are still to be chosen are taken from the observations."""
    known = of_rock(row)
    with settings.filling():
        for surface in row.surfaces:
            if surface.source == "POINTS_FILE" and not (surface.filepath or surface.stored):
                surface.source = "NONE"
    if known is None:
        keep(row, observations)
        return
    places = {tuple(place) for place in observations.places.tolist()}
    again = np.where(
        known.holes == "",
        [tuple(place) in places for place in known.places.tolist()],
        np.isin(known.holes, observations.holes),
    )
    keep(row, Observations.joined([known.some(~again), observations]))


def of_rock(row):
    """The stored Observations; None where there are none. Raises InputRefused for damaged arrays."""
    return Observations(**row.observations) if row.observations else None


def rename(row, old, new):
    """Gives the blocks beneath a surface, or a body, its new name."""
    found = of_rock(row)
    if found is None:
        return
    blocks, on = (np.where(names == old, new, names) for names in (found.blocks, found.on))
    if (blocks != found.blocks).any() or (on != found.on).any():
        keep(row, replace(found, blocks=blocks, on=on))


def places_of(row):
    """(N, 3) all places that are observed in a rock mass, in model coordinates. Raises InputRefused."""
    found = of_rock(row)
    return np.empty((0, 3)) if found is None else found.places


def shown(row):
    """What is displayed of the observations of a rock mass: {hole: Observations} of its holes with intervals,
    downward along each, and (N, 3) the other places. Damaged arrays, which a build refuses, has neither."""
    digest = row.observations.digest
    if digest not in _shown:
        try:
            found = of_rock(row)
        except RealModelError:
            found = None
        _shown[digest] = _divided(Observations.joined([]) if found is None else found)
    return _shown[digest]


def _divided(observations):
    found = observations.along_holes()
    starts = np.flatnonzero(np.r_[True, found.holes[1:] != found.holes[:-1]]) if len(found) else []
    logs, others = {}, np.ones(len(found), bool)
    for begin, end in pairwise([*starts, len(found)]):
        if end - begin > 1 and found.holes[begin]:
            logs[str(found.holes[begin])] = found.some(np.arange(begin, end))
            others[begin:end] = False
    return logs, found.places[others]


def units_of(scene, row, names=None):
    """UnitNames of a rock mass, or of one that is not there yet. names: {name in tables: its name here}."""
    surfaces = [] if row is None else [Surface(each.name, block=each.block or None) for each in row.surfaces]
    bodies = [body.name for body in scene.realmodel.bodies]
    blocks = Rock("", surfaces).block_names()
    return UnitNames([each.name for each in surfaces], blocks, bodies, names or {})
