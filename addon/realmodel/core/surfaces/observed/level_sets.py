# SPDX-License-Identifier: GPL-3.0-or-later
"""What observed blocks say of surfaces that are level sets of a field f: contacts, and places where f is at
most or at least that of a surface.

That a surface lies at a place or above it means here that f is at most its level. Levels rise in the order of
the surfaces, so of several that f is below only the lowest counts, and of several that it is above the
highest. The position of a level set over or under the place has no meaning.
"""

from __future__ import annotations

import numpy as np

from ...project.project import Rock
from ...readers.tables.observations import Bounds, Observations
from ...settings.series_kinds import FIELD


class FieldStatements:
    """Of observations that are used, `used` (U,) their rows.

    said: (U, S) bool twice, the surfaces at or above each, and at or below it. at: (U,) the number of the
    place of each, which equal places in one compartment share, and (P,) the first of each place.

    contacts: by the number of a level set, (C,) the observations at contacts on it, the first of each place.
    not_adjacent: (N,) those where blocks of a series meet that no single level set divides: f cannot pass two
    levels at once, so a bed is missing there, by a fault or in the log.
    """

    def __init__(
        self,
        rock: Rock,
        observations: Observations,
        used: np.ndarray,
        said: tuple[np.ndarray, np.ndarray],
        at: tuple[np.ndarray, np.ndarray],
    ):
        self._given, self._used, self._first = observations, used, at[1]
        self.contacts: dict[int, np.ndarray] = {}
        self._lowest: dict[int, tuple[np.ndarray, np.ndarray]] = {}
        self._highest: dict[int, tuple[np.ndarray, np.ndarray]] = {}
        missing = np.zeros(len(self._first), bool)
        self._ways = self._within_intervals()
        for series in rock.series:
            if series.kind == FIELD:
                missing |= self._add(rock.members(series), said, at[0])
        self.not_adjacent = np.sort(self._first[missing])

    def _within_intervals(self) -> np.ndarray:
        """(W,) the observations that are in one interval with the one before, which is used, too."""
        follows = self._given.goes_on[self._used[1:]] & (np.diff(self._used) == 1)
        return np.flatnonzero(follows) + 1

    def _add(self, numbers: list[int], said: tuple[np.ndarray, np.ndarray], place: np.ndarray) -> np.ndarray:
        """Adds what is known of the surfaces of a series. Returns (P,) bool, the places where a bed is
        missing."""
        up, down = (mask[:, numbers] for mask in said)
        at_place = [np.zeros((len(self._first), len(numbers)), bool) for _ in range(2)]
        for met, mask in zip(at_place, (up, down), strict=True):
            np.logical_or.at(met, place, mask)
        lowest, highest = _first_of(at_place[0], len(numbers)), _last_of(at_place[1])
        is_bound = highest < lowest
        ways = self._ways
        of_ways = _first_of(up[ways] & up[ways - 1], len(numbers)), _last_of(down[ways] & down[ways - 1])
        for k, number in enumerate(numbers):
            self.contacts[number] = np.sort(self._first[(lowest == k) & (highest == k)])
            self._lowest[number] = np.sort(self._first[is_bound & (lowest == k)]), ways[of_ways[0] == k]
            self._highest[number] = np.sort(self._first[is_bound & (highest == k)]), ways[of_ways[1] == k]
        return highest > lowest

    def bounds(self, number: int) -> Bounds:
        """The bounds of a level set by its number: of places, and of the ways through intervals."""
        places, used = self._given.places, self._used
        parts = self._lowest[number], self._highest[number]
        begin = np.concatenate([rows for at, ways in parts for rows in (used[at], used[ways - 1])])
        end = np.concatenate([used[rows] for part in parts for rows in part])
        is_lower = np.repeat([True, False], [sum(map(len, part)) for part in parts])
        return Bounds(places[begin], is_lower, self._given.holes[end], self._given.depths[end], places[end])


def _first_of(said: np.ndarray, otherwise: int) -> np.ndarray:
    """(N,) the first true column of each row (N, K); `otherwise` where none is."""
    return np.where(said.any(axis=1), said.argmax(axis=1), otherwise)


def _last_of(said: np.ndarray) -> np.ndarray:
    """(N,) the last true column of each row (N, K); -1 where none is."""
    return np.where(said.any(axis=1), said.shape[1] - 1 - said[:, ::-1].argmax(axis=1), -1)
