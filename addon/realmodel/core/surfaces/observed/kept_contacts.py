# SPDX-License-Identifier: GPL-3.0-or-later
"""Contacts that were observed bound the younger surfaces: none of these cuts below them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...project.project import Rock, Surface
from ...readers.tables.observations import Bounds
from .columns import Succession
from .surface_data import SurfaceData


def observed_contacts(surface: Surface, data: SurfaceData) -> np.ndarray:
    """(C, 3) the points of a surface that is read which no younger one removes: all of one that is observed
    or belongs to a series, else the picks of boreholes. What observations of blocks say of it is not among
    them: they bound all surfaces themselves."""
    if surface.observed or surface.series is not None:
        return data.own
    return data.own[sorted(data.picks)]


def kept_bounds(rock: Rock, data: Sequence[SurfaceData]) -> list[Bounds]:
    """For each surface of a rock mass that is read the contacts of older ones, where it would cut these: it
    lies at them or above. Of level sets of one field only the lowest is used; the sheets of a series keep off
    one another."""
    surfaces = rock.surfaces
    succession = Succession([surface.rule for surface in surfaces])
    places: list[list[np.ndarray]] = [[np.empty((0, 3))] for _ in surfaces]
    for older, surface in enumerate(surfaces):
        contacts = observed_contacts(surface, data[older])
        done = {surface.series} - {None}
        for number in succession.cut_later(older) if len(contacts) else []:
            younger = surfaces[number]
            if number != rock.terrain_number and younger.has_points and younger.series not in done:
                places[number].append(contacts)
                done |= {younger.series} if rock.is_level_set(younger) else set()
    return [
        Bounds.at_or_above(np.concatenate(parts), rock.is_level_set(surface))
        for parts, surface in zip(places, surfaces, strict=True)
    ]
