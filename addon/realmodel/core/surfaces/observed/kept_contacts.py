# SPDX-License-Identifier: GPL-3.0-or-later
"""Contacts that were observed bound the younger surfaces: none of these cuts below them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ...base.algebra import are_among
from ...project.project import Rock
from ...readers.tables.observations import Bounds
from .succession import Succession


def observed_contacts(rock: Rock, number: int) -> np.ndarray:
    """(C, 3) the points of a surface that is read which no younger one removes: all of one that is observed
    or belongs to a series, else the picks of boreholes. What observations of blocks say of it is not among
    them: they bound all surfaces themselves."""
    surface = rock.surfaces[number]
    own = surface.own_points() if surface.has_points else None
    if own is None:
        return np.empty((0, 3))
    if surface.observed or surface.series is not None:
        return own
    picks = [place for _, met in rock.hole_picks.values() for name, place in met if name == surface.name]
    return own[are_among(own, np.array(picks, np.float64))] if picks else own[:0]


def kept_bounds(rock: Rock) -> list[Bounds]:
    """For each surface of a rock mass that is read the contacts of older ones, where it would cut these: it
    lies at them or above. Of level sets of one field only the lowest is asked; the sheets of a series keep
    off one another."""
    surfaces = rock.surfaces
    succession = Succession([surface.rule for surface in surfaces])
    places: list[list[np.ndarray]] = [[np.empty((0, 3))] for _ in surfaces]
    for older, surface in enumerate(surfaces):
        contacts = observed_contacts(rock, older)
        done = {surface.series} - {None}
        for number in succession.cut_later(older) if len(contacts) else []:
            younger = surfaces[number]
            if younger.has_points and younger.series not in done:
                places[number].append(contacts)
                done |= {younger.series} if younger.is_level_set else set()
    return [
        Bounds.at_or_above(np.concatenate(each), surface.is_level_set)
        for each, surface in zip(places, surfaces, strict=True)
    ]


def with_kept_bounds(rock: Rock) -> Rock:
    """A rock mass that is read, without observations, with these bounds beside those that it has."""
    surfaces = [
        replace(each, bounds=own if each.bounds is None else Bounds.joined([each.bounds, own]))
        for each, own in zip(rock.surfaces, kept_bounds(rock), strict=True)
    ]
    return replace(rock, surfaces=surfaces)
