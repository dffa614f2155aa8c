# SPDX-License-Identifier: GPL-3.0-or-later
"""Bounds of a field that contradict other data of it: as few as possible are left out.

What two data say of f differs by a gap, between levels. Where they lie so near each other that f would have
to be many times as steep as elsewhere, one of them is wrong. A wrong one is in conflict with all that lies
around it, which agrees among itself: so the bound with the most conflicts is left out first, until there are
none. Contacts stay.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from ..base.algebra import norm
from ..fields import SolvedField, rises
from .series_data import SeriesData

_STEEP = (8.0, 4.0, 2.0)  # times the usual steepness of f: steeper is a conflict; one after another is tried
_NEAR = 1e-9  # of the range of f: bounds hold to this as the field is solved
_ROWS = 1000  # looked at together


def without_contradictions(
    data: SeriesData, solve: Callable[[SeriesData], SolvedField]
) -> tuple[SolvedField, SeriesData, np.ndarray]:
    """The field that `solve` makes of data, those that it is made of, and the rows of bounds that are left
    out: none where the first field honors all of them. Where none does, that which honors most is taken: a
    lattice may be too coarse for beds between its nodes."""
    none = np.empty(0, np.int64)
    tried = [(solve(data), none)]
    if not _honors_all(tried[0][0]):
        plain = solve(data.without_bounds(np.arange(len(data.bounds))))
        for steep in _STEEP:
            found = _in_conflict(data, plain, steep)
            if len(found) > len(tried[-1][1]):
                tried.append((solve(data.without_bounds(found)), found))
                if _honors_all(tried[-1][0]):
                    break
        tried.append((plain, np.flatnonzero(data.is_off(plain, 0.0))))
        # levels that do not rise are no field; of equal ones the first, with the fewest bounds left out
        rising = [each for each in tried if _rises(each[0])] or tried[:1]
        tried = [min(rising, key=lambda each: int(data.is_off(each[0], _NEAR).sum()))]
    field, left_out = tried[0]
    return field, data.without_bounds(left_out), left_out


def _rises(field: SolvedField) -> bool:
    return bool((np.diff(field.levels) > 0).all())


def _honors_all(field: SolvedField) -> bool:
    return not len(field.bounds_missed) and _rises(field)


def _in_conflict(data: SeriesData, field: SolvedField, steep: float) -> np.ndarray:
    """The rows of the fewest bounds without which no data are in conflict. field: without bounds."""
    low, high = _said(data, field)
    most = steep * _steepness(data, field)
    first = len(data.contacts)
    pairs = [np.empty((0, 2), np.int64), *_conflicts(data, low, high, most)]
    ends = np.concatenate(pairs)
    count = np.bincount(ends[:, 0], minlength=len(low))
    gone = np.zeros(len(low), bool)
    begin = np.searchsorted(ends[:, 0], np.arange(len(low) + 1))
    while len(count) > first and count[first:].max() > 0:
        worst = first + int(count[first:].argmax())
        gone[worst] = True
        others = ends[begin[worst] : begin[worst + 1], 1]
        count[others[~gone[others]]] -= 1
        count[worst] = 0
    return np.flatnonzero(gone[first:])


def _said(data: SeriesData, field: SolvedField) -> tuple[np.ndarray, np.ndarray]:
    """(C + B,) twice: what f is at least, and at most, at contacts and bounds."""
    exact, bound = field.levels[data.surfaces], field.levels[data.bound_surfaces]
    low = np.concatenate([exact, np.where(data.is_lower, -np.inf, bound)])
    return low, np.concatenate([exact, np.where(data.is_lower, bound, np.inf)])


def _steepness(data: SeriesData, field: SolvedField) -> float:
    """How steep f usually is near contacts."""
    rise, _ = rises(field, data.contacts)
    return float(np.median(norm(rise / field.lattice.spacing)))


def _conflicts(data: SeriesData, low: np.ndarray, high: np.ndarray, most: float) -> Iterator[np.ndarray]:
    """(K, 2) pairs of data, each both ways around, between which f would be steeper than `most`. One of them
    is a bound at least."""
    places = np.concatenate([data.contacts, data.bounds])
    is_contact = np.arange(len(places)) < len(data.contacts)
    for begin in range(0, len(places), _ROWS):
        own = slice(begin, begin + _ROWS)
        gap = np.maximum(low[own, None] - high, low - high[own, None])
        far = norm(places[own, None] - places)
        pairs = (gap > most * far) & (gap > 0) & ~(is_contact[own, None] & is_contact)
        row, other = np.nonzero(pairs)
        yield np.column_stack([row + begin, other])
