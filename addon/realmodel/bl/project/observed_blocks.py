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
NAMES = ("places", "blocks", "holes", "depths", "intervals", "used", "on", "height_errors", "thicknesses")


def keep(row, observations):
    """Stores realmodel.core.Observations, or None."""
    has_some = observations is not None and len(observations)
    row.observations = {name: getattr(observations, name) for name in NAMES} if has_some else {}


def add(row, observations):
    """Adds Observations to those that a rock mass has. Those of a hole, or of a place, take the place of the
    ones that it had. Surfaces whose points are still to be chosen are taken from the observations."""
    earlier = of_rock(row)
    with settings.filling():
        for surface in row.surfaces:
            if surface.source == "POINTS_FILE" and not (surface.filepath or surface.stored):
                surface.source = "NONE"
    if earlier is None:
        keep(row, observations)
        return
    places = {tuple(place) for place in observations.places.tolist()}
    again = np.where(
        earlier.holes == "",
        [tuple(place) in places for place in earlier.places.tolist()],
        np.isin(earlier.holes, observations.holes),
    )
    keep(row, Observations.joined([earlier.some(~again), observations]))


def forget(row, holes):
    """Removes the observations of some holes."""
    earlier = of_rock(row)
    if earlier is not None and len(holes):
        keep(row, earlier.some(~np.isin(earlier.holes, list(holes))))


def of_rock(row):
    """The stored Observations; None where there are none. Raises InputRefused for damaged arrays."""
    return Observations(**row.observations) if row.observations else None


def rename(row, old, new):
    """Gives the blocks beneath a surface, or a body, its new name."""
    observations = of_rock(row)
    if observations is None:
        return
    blocks, on = (np.where(names == old, new, names) for names in (observations.blocks, observations.on))
    if (blocks != observations.blocks).any() or (on != observations.on).any():
        keep(row, replace(observations, blocks=blocks, on=on))


def places_of(row):
    """(N, 3) all places that are observed in a rock mass, in model coordinates. Raises InputRefused."""
    observations = of_rock(row)
    return np.empty((0, 3)) if observations is None else observations.places


def shown(row):
    """What is displayed of the observations of a rock mass: {hole: Observations} of its holes with intervals,
    downward along each, and (N, 3) the other places. Damaged arrays, which a build refuses, has neither."""
    digest = row.observations.digest
    if digest not in _shown:
        try:
            observations = of_rock(row)
        except RealModelError:
            observations = None
        _shown[digest] = _divided(Observations.joined([]) if observations is None else observations)
    return _shown[digest]


def _divided(observations):
    ordered = observations.along_holes()
    starts = np.flatnonzero(np.r_[True, ordered.holes[1:] != ordered.holes[:-1]]) if len(ordered) else []
    logs, others = {}, np.ones(len(ordered), bool)
    for begin, end in pairwise([*starts, len(ordered)]):
        if end - begin > 1 and ordered.holes[begin]:
            logs[str(ordered.holes[begin])] = ordered.some(np.arange(begin, end))
            others[begin:end] = False
    return logs, ordered.places[others]


def units_of(scene, row, names=None):
    """UnitNames of a rock mass, or of one that is not there yet. names: {name in tables: its name here}."""
    surfaces = (
        [] if row is None else [Surface(entry.name, block=entry.block or None) for entry in row.surfaces]
    )
    bodies = [body.name for body in scene.realmodel.bodies]
    blocks = Rock("", surfaces).block_names()
    return UnitNames([surface.name for surface in surfaces], blocks, bodies, names or {})
