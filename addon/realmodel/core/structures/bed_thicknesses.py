# SPDX-License-Identifier: GPL-3.0-or-later
"""Measured thicknesses of beds, as data of the field of a series.

A thickness is perpendicular to the beds, whose attitude the field alone tells: so the field is made several
times. In each the bed ends on the normal through the place of a thickness; the one of its two surfaces whose
contacts are nearer stays, and the other one gets a contact at the thickness from it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..base.algebra import norm
from ..base.errors import place_text
from ..fields import Lattice, ScalarField, rises
from ..readers.tables.observations import Observations
from ..surfaces.observed.derived import BlockNumbers
from ..surfaces.rock_input import RockInput
from .series_data import SeriesData

ROUNDS = 3  # in which the field is made
_KNOWN = 0.25  # of a thickness: a contact so near to where it ends a bed says more
_REACH, _STEPS = 3.0, 97  # of the normal, in thicknesses to both sides, and the places on it
_MISSED = 0.1  # of a thickness


@dataclass(frozen=True, eq=False)
class BedThicknesses:
    """places: (T, 3) in beds. tops: (T,) the number in the series of the surface above each bed; the one
    before it is its base. values: (T,) perpendicular to the beds, in model units."""

    places: np.ndarray
    tops: np.ndarray
    values: np.ndarray

    @classmethod
    def of(cls, entry: RockInput, numbers: Sequence[int]) -> BedThicknesses:
        """Those observed of beds between two surfaces of a series, with these numbers in its rock mass."""
        seen = entry.rock.observed or Observations.joined([])
        tops = BlockNumbers(entry.rock).of(seen.blocks) - numbers[0]
        chosen = seen.in_use & ~np.isnan(seen.thicknesses_there) & (tops > 0) & (tops < len(numbers))
        return cls(seen.places[chosen], tops[chosen], seen.thicknesses_there[chosen])

    def __len__(self) -> int:
        return len(self.places)

    def some(self, chosen: np.ndarray) -> BedThicknesses:
        """Those that `chosen`, (T,) bool, says."""
        return BedThicknesses(self.places[chosen], self.tops[chosen], self.values[chosen])

    def contacts(
        self, data: SeriesData, fields: Sequence[ScalarField], where: np.ndarray, lattice: Lattice
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """(N, 3) contacts that follow with fields, (N,) their surfaces in the series, and (N,) the rows of
        their thicknesses. where: (T,) the field of each."""
        normals, base, top = self._ends(fields, where)
        of_base, of_top = (self.places + at[:, None] * normals for at in (base, top))
        stays = _nearest(data, of_base, self.tops - 1) <= _nearest(data, of_top, self.tops)
        way = self.values[:, None] * normals
        places = np.where(stays[:, None], of_base + way, of_top - way)
        surfaces = np.where(stays, self.tops, self.tops - 1)
        low, high = lattice.corners
        use = ((places >= low) & (places <= high)).all(axis=1)
        use &= _nearest(data, places, surfaces) > _KNOWN * self.values
        return places[use], surfaces[use].astype(np.int32), np.flatnonzero(use)

    def missed(self, fields: Sequence[ScalarField], where: np.ndarray) -> list[str]:
        """Of those that fields do not have the place, the thickness there and the given one."""
        _, base, top = self._ends(fields, where)
        off = np.flatnonzero(np.abs(top - base - self.values) > _MISSED * self.values)
        return [
            f"{place_text(self.places[n].tolist())} {top[n] - base[n]:.3g} in place of {self.values[n]:.3g}"
            for n in off.tolist()
        ]

    def _ends(
        self, fields: Sequence[ScalarField], where: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """(T, 3) the normals of beds at the places, and (T,) where the base and the top are along them."""
        normals, ends = np.zeros((len(self), 3)), np.zeros((2, len(self)))
        for number, field in enumerate(fields):
            here = np.flatnonzero(where == number)
            rise, far = rises(field, self.places[here])
            gradient = rise / far
            steepness = np.maximum(norm(gradient), 1e-300)
            normals[here] = gradient / steepness[:, None]
            along = np.linspace(-_REACH, _REACH, _STEPS) * self.values[here, None]
            places = self.places[here, None] + along[..., None] * normals[here, None]
            f = field.at(places.reshape(-1, 3)).reshape(along.shape)
            at_place = field.at(self.places[here])
            for side, tops in enumerate((self.tops[here] - 1, self.tops[here])):
                over = f - field.levels[tops][:, None]
                straight = (field.levels[tops] - at_place) / steepness
                ends[side, here] = _nearest_crossing(over, along, straight)
        return normals, ends[0], ends[1]


def _nearest_crossing(over: np.ndarray, along: np.ndarray, straight: np.ndarray) -> np.ndarray:
    """(T,) where values (T, S) at places (T, S) along lines change their sign, upward and nearest to 0;
    `straight` (T,) where they do not."""
    passes = (over[:, :-1] < 0) & (over[:, 1:] >= 0)
    share = np.divide(-over[:, :-1], over[:, 1:] - over[:, :-1], where=passes, out=np.zeros(passes.shape))
    at = along[:, :-1] + share * (along[:, 1:] - along[:, :-1])
    nearest = np.where(passes, np.abs(at), np.inf).argmin(axis=1)[:, None]
    crossing = np.take_along_axis(at, nearest, axis=1)[:, 0]
    return np.where(passes.any(axis=1), crossing, straight)


def _nearest(data: SeriesData, places: np.ndarray, surfaces: np.ndarray) -> np.ndarray:
    """(T,) how far the nearest contact of surfaces (T,) is from places (T, 3)."""
    out = np.full(len(places), np.inf)
    for surface in np.unique(surfaces).tolist():
        contacts = data.contacts[data.surfaces == surface]
        for row in np.flatnonzero(surfaces == surface).tolist() if len(contacts) else ():
            out[row] = norm(contacts - places[row]).min()
    return out
