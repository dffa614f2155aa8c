# SPDX-License-Identifier: GPL-3.0-or-later
"""The picks of boreholes, stored in the row of their rock mass for display."""

from itertools import islice

import numpy as np

from ..host import caches
from . import observed_blocks

_paths = caches.new(most=8)  # by the digests of what they are made from: viewports ask at each redraw


def keep(row, holes):
    """Adds holes, as realmodel.core's Picks.holes, to those that a rock mass has."""
    if not holes:
        return
    known = of_rock(row)
    for name, (collar, picks) in holes.items():
        given = [[surface, [float(value) for value in place]] for surface, place in picks]
        known[name] = [None if collar is None else [float(value) for value in collar], given]
    store(row, known)


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
    there = [pick for _, met in picks.values() for pick in met if tuple(pick[1]) == tuple(old)]
    for pick in there:
        pick[1] = [float(value) for value in new]
    if there:
        for _, met in picks.values():
            met.sort(key=lambda pick: -pick[1][2])
        store(row, picks)


def remove_at(row, places):
    """Removes the picks at some places (N, 3), and holes that have no others."""
    removed = {tuple(place) for place in places.tolist()}
    left = {
        hole: [collar, kept]
        for hole, (collar, met) in of_rock(row).items()
        if (kept := [pick for pick in met if tuple(pick[1]) not in removed])
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
    found = {}
    for hole in dict.fromkeys((*picked, *logs)):
        collar, picks = picked.get(hole, (None, []))
        places = logs[hole].places.tolist() if hole in logs else [place for _, place in picks]
        given = [*([] if collar is None else [collar]), *places, *([ends[hole]] if hole in ends else [])]
        line = [place for n, place in enumerate(given) if n == 0 or place != given[n - 1]]
        if line:
            found[hole] = line
    return found


def keep_ends(row, ends):
    """Adds the ends of holes, as realmodel.core's Picks.ends, to those that a rock mass has."""
    if ends:
        known = ends_of(row) | ends
        row.hole_ends = {"holes": list(known), "places": np.array(list(known.values()), np.float64)}


def ends_of(row):
    """{hole: (x, y, z)} where holes end, as far as it is known, model coordinates."""
    stored = row.hole_ends
    return dict(zip(stored["holes"].tolist(), stored["places"].tolist(), strict=True)) if stored else {}


def of_rock(row):
    """{hole: [collar or None, [[surface, place], ...]]} in model coordinates, the highest pick first."""
    if not row.hole_picks:
        return {}
    stored = {name: array.tolist() for name, array in row.hole_picks.items()}
    picks = map(list, zip(stored["surfaces"], stored["places"], strict=True))
    return {
        hole: [None if np.isnan(collar).any() else collar, list(islice(picks, count))]
        for hole, collar, count in zip(stored["holes"], stored["collars"], stored["counts"], strict=True)
    }


def store(row, picks):
    """Stores what `of_rock` gives."""
    collars = [(np.nan,) * 3 if collar is None else collar for collar, _ in picks.values()]
    met = [pick for _, met in picks.values() for pick in met]
    arrays = {
        "holes": np.array(list(picks), str),
        "collars": np.array(collars, np.float64),
        "counts": np.array([len(met) for _, met in picks.values()], np.int32),
        "surfaces": np.array([surface for surface, _ in met], str),
        "places": np.array([place for _, place in met], np.float64).reshape(-1, 3),
    }
    row.hole_picks = arrays if picks else {}
