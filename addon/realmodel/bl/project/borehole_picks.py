# SPDX-License-Identifier: GPL-3.0-or-later
"""The picks of boreholes, stored in the row of their rock mass for display."""

import numpy as np

from ..host import caches
from . import observed_blocks

_ARRAYS = ("holes", "surfaces", "places")
_UNKNOWN = (np.nan, np.nan, np.nan)
_paths = caches.new(most=8)  # by the digests of what they are made from: viewports ask at each redraw


def keep(row, holes):
    """Adds holes, as realmodel.core's Picks.holes, to those that a rock mass has."""
    if holes:
        store(row, of_rock(row) | holes)


def rename(row, old, new):
    """Gives the picks of a surface of a rock mass its new name."""
    picks = of_rock(row)
    for _, met in picks.values():
        for pick in met:
            pick[0] = new if pick[0] == old else pick[0]
    store(row, picks)


def move(row, old, new):
    """Moves the picks at a place, (x, y, z) in model coordinates, to another."""
    picks = of_rock(row)
    picks_at_place = [pick for _, met in picks.values() for pick in met if tuple(pick[1]) == tuple(old)]
    for pick in picks_at_place:
        pick[1] = [float(value) for value in new]
    if picks_at_place:
        for _, met in picks.values():
            met.sort(key=lambda pick: -pick[1][2])
        store(row, picks)


def remove_at(row, places):
    """Removes the picks at some places (N, 3), and holes that have no others."""
    removed = {tuple(place) for place in places.tolist()}
    left = {
        hole: [collar, remaining]
        for hole, (collar, met) in of_rock(row).items()
        if (remaining := [pick for pick in met if tuple(pick[1]) not in removed])
    }
    store(row, left)


def paths(row):
    """The line of each hole of a rock mass: its collar, if that is known, and its picks or, where it has
    intervals, all of these, and its end."""
    return list(named_paths(row).values())


def named_paths(row):
    """{hole: its line}, as of `paths`; not to be changed."""
    key = row.hole_picks.digest, row.hole_ends.digest, row.observations.digest
    if key not in _paths:
        _paths[key] = _paths_of(row)
    return _paths[key]


def _paths_of(row):
    logs, _ = observed_blocks.shown(row)
    picked, ends = of_rock(row), ends_of(row)
    lines = {}
    for hole in dict.fromkeys((*picked, *logs)):
        collar, picks = picked.get(hole, (None, []))
        places = logs[hole].places.tolist() if hole in logs else [place for _, place in picks]
        vertices = [*([] if collar is None else [collar]), *places, *([ends[hole]] if hole in ends else [])]
        line = [place for n, place in enumerate(vertices) if n == 0 or place != vertices[n - 1]]
        if line:
            lines[hole] = line
    return lines


def keep_ends(row, ends):
    """Adds the ends of holes, as realmodel.core's Picks.ends, to those that a rock mass has."""
    if ends:
        all_ends = ends_of(row) | ends
        row.hole_ends = {"holes": list(all_ends), "places": np.array(list(all_ends.values()), np.float64)}


def ends_of(row):
    """{hole: (x, y, z)} where holes end, as far as it is known, model coordinates."""
    stored = row.hole_ends
    return dict(zip(stored["holes"].tolist(), stored["places"].tolist(), strict=True)) if stored else {}


def of_rock(row):
    """{hole: [collar or None, [[surface, place], ...]]} in model coordinates, the highest pick first."""
    if not row.hole_picks:
        return {}
    holes = {}
    for hole, surface, place in zip(*(row.hole_picks[name].tolist() for name in _ARRAYS), strict=True):
        if surface:
            holes[hole][1].append([surface, place])
        else:
            holes[hole] = [None if np.isnan(place).any() else place, []]
    return holes


def store(row, holes):
    """Stores what `of_rock` gives: of each hole its collar, as a pick of "", before its picks."""
    rows = [
        (hole, surface, _UNKNOWN if place is None else place)
        for hole, (collar, picks) in holes.items()
        for surface, place in (("", collar), *picks)
    ]
    row.hole_picks = {}
    if rows:
        names, surfaces, places = zip(*rows, strict=True)
        row.hole_picks = {"holes": names, "surfaces": surfaces, "places": np.array(places, np.float64)}
