# SPDX-License-Identifier: GPL-3.0-or-later
"""Changes of one datum: switched off or on, moved. Raises InputRefused where it is not there any more."""

from dataclasses import replace

import numpy as np

from ...core import InputRefused
from ..project import borehole_picks, method_settings, observed_blocks, settings, surface_dips
from ..scene import borehole_points
from . import data


def find(scene, datum):
    """(Group, number) of a datum. Raises InputRefused where it is not there any more."""
    for group in data.groups(scene, (datum.kind,)):
        if (number := group.find(datum)) is not None:
            return group, number
    what = f"the {datum.kind} of '{datum.name}' is not there any more"
    raise InputRefused(what, advice="choose another datum")


def switch(scene, datum, used):
    """Switches a datum off, or on; returns it as it is now."""
    group, number = find(scene, datum)
    if group.used[number] == used:
        return group.datum(number)
    rock, row = _rows(scene, datum)
    if datum.kind == data.POINT:
        _switch_point(scene, row, np.array(datum.place), used)
    elif datum.kind in data.DIPS:
        surface_dips.keep(row, surface_dips.with_used(surface_dips.of_row(row), group.rows[number], used))
    else:
        observed_blocks.keep(rock, _switched(observed_blocks.of_rock(rock), group.rows[number], used))
    return datum._replace(used=used)


def switch_all_on(scene):
    """Switches on what is switched off; returns how many data that were."""
    off = [group.datum(n) for group in data.groups(scene) for n in np.flatnonzero(~group.used)]
    for datum in off:
        switch(scene, datum, True)
    return len(off)


def move(scene, datum, place):
    """Moves a datum to a place (x, y, z) in model coordinates; returns it as it is now. The upper end of an
    interval stays on its hole, between the ends of the intervals that meet there."""
    group, number = find(scene, datum)
    rock, row = _rows(scene, datum)
    place = np.asarray(place, np.float64)
    if datum.kind == data.INTERVAL:
        observations = observed_blocks.of_rock(rock)
        moved, place = _with_end_moved(observations, int(group.rows[number]), place)
        observed_blocks.keep(rock, moved)
    elif datum.kind == data.PLACE:
        observations = observed_blocks.of_rock(rock)
        places = observations.places.copy()
        places[group.rows[number]] = place
        observed_blocks.keep(rock, replace(observations, places=places))
    elif datum.kind in data.DIPS:
        surface_dips.keep(row, surface_dips.moved(surface_dips.of_row(row), group.rows[number], place))
        place[2] = place[2] if group.places[number, 2] == group.places[number, 2] else np.nan
    elif group.used[number]:
        points = data.own_points(scene, row).copy()
        points[group.rows[number]] = place
        _keep_points(row, points)
    else:
        off = borehole_points.left_out(row).copy()
        off[group.rows[number]] = place
        borehole_points.keep_left_out(row, off)
    borehole_picks.move(rock, datum.place, place)
    return datum._replace(place=tuple(float(value) for value in place))


def _rows(scene, datum):
    """The row of the rock mass of a datum, and that in which it is stored: of the surface or the series, or
    the same."""
    rock = next(rock for rock in scene.realmodel.rocks if rock.name == datum.rock)
    if datum.kind == data.SERIES_DIP:
        return rock, rock.series[datum.name]
    return rock, rock.surfaces[datum.name] if datum.kind in (data.POINT, data.DIP) else rock


def _switch_point(scene, row, place, used):
    off = borehole_points.left_out(row)
    if used:
        borehole_points.keep_left_out(row, off[(off != place).any(axis=1)])
        if row.stored:  # else its file still has the point
            _keep_points(row, np.concatenate([data.own_points(scene, row), place[None]]))
        return
    if row.stored:
        points = data.own_points(scene, row)
        _keep_points(row, points[(points != place).any(axis=1)], stays_of_file=True)
    borehole_points.keep_left_out(row, np.concatenate([off, place[None]]))


def _keep_points(row, points, stays_of_file=False):
    """Stores the points of a surface. Moved ones are not those of its file any more, which the surface does
    not name then."""
    with settings.filling():
        row.stored = {"points": points}
        if row.filepath and not stays_of_file:
            row.source, row.filepath, row.stored_stamp = "POINTS_FILE", "", ""
            method_settings.fill_reading(row)


def _switched(observations, first, used):
    """The interval or the place that begins in a row, switched off or on."""
    in_use = observations.in_use.copy()
    rows = data.interval_rows(observations)
    begin, end = next((a, b) for a, b in rows.tolist() if a == first)
    in_use[begin : end + 1] = used
    return replace(observations, used=in_use)


def _with_end_moved(observations, first, place):
    """The Observations with the upper end of the interval that begins in row `first` moved to a place, as far
    as its hole and its neighbors allow, and the place where it is then."""
    rows = data.interval_rows(observations).tolist()
    number = next(n for n, (begin, _) in enumerate(rows) if begin == first)
    last = rows[number][1]
    meets = number > 0 and (observations.places[first - 1] == observations.places[first]).all()
    meets = meets and observations.holes[first - 1] == observations.holes[first]
    start = rows[number - 1][0] if meets else first
    line = observations.places[start : last + 1]
    steps = np.linalg.norm(np.diff(line, axis=0), axis=1)
    along = np.concatenate([[0.0], np.cumsum(steps)])
    depths = observations.depths[start : last + 1]
    at = min(max(_nearest(line, along, place), 1e-3 * along[-1]), (1.0 - 1e-3) * along[-1])
    new = np.array([np.interp(at, along, line[:, axis]) for axis in range(3)])
    depth = float(np.interp(at, along, depths)) if np.isfinite(depths).all() else float("nan")
    places, all_depths = observations.places.copy(), observations.depths.copy()
    is_kept = np.ones(len(places), bool)
    for row in range(start, last + 1):
        if row in (first, first - 1 if meets else first):
            places[row], all_depths[row] = new, depth
        elif start < row < last:  # between the ends of an inclined interval
            is_kept[row] = along[row - start] < at if row < first else along[row - start] > at
    return replace(observations, places=places, depths=all_depths).some(is_kept), new


def _nearest(line, along, place):
    """How far along a line (N, 3) its nearest place to another one is. along: (N,) of its corners."""
    begin, way = line[:-1], np.diff(line, axis=0)
    length = (way**2).sum(axis=1)
    share = np.clip(((place - begin) * way).sum(axis=1) / np.where(length > 0, length, 1.0), 0.0, 1.0)
    away = np.linalg.norm(begin + share[:, None] * way - place, axis=1)
    best = int(away.argmin())
    return float(along[best] + share[best] * (along[best + 1] - along[best]))
