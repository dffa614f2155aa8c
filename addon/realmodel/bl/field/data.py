# SPDX-License-Identifier: GPL-3.0-or-later
"""The field data of a scene. A datum is known by what it is of and by its place, which are in the settings:
so it is found again after undo, and after an import of others."""

import json
from contextlib import suppress
from typing import NamedTuple

import numpy as np

from ...core import Dips, RealModelError
from ..host import caches
from ..project import borehole_picks, observed_blocks, settings, surface_dips
from ..scene import borehole_points, data_objects

POINT, DIP, PLACE, INTERVAL = "point", "dip", "place", "interval"
ROCK_DIP = "dip of the rock mass"  # that may name a surface or a block
SERIES_DIP = "dip of the series"  # in its field
DIPS = (DIP, ROCK_DIP, SERIES_DIP)
KINDS = (POINT, *DIPS, PLACE, INTERVAL)


def _bytes_of(group_list):
    return sum(3 * group.places.nbytes for group in group_list or ())


_groups = caches.new(most=256 << 20, size_of=_bytes_of)  # lists of Groups, by what they are made from


class Datum(NamedTuple):
    """kind: POINT, PLACE, INTERVAL, or one of DIPS. rock: the name of the rock mass. name: of the surface or
    the series, of others the block. place: (x, y, z), model coordinates; of an interval its upper end, of a
    dip z may be NaN. hole: its name, "" for none. used: whether it is not switched off."""

    kind: str
    rock: str
    name: str
    place: tuple[float, float, float]
    hole: str = ""
    used: bool = True

    def text(self):
        """It as text for a setting."""
        return json.dumps([*self[:3], [None if v != v else v for v in self.place], *self[4:]])

    @classmethod
    def of_text(cls, text):
        """The datum of `text`; None for an empty text."""
        if not text:
            return None
        *first, place, hole, used = json.loads(text)
        return cls(*first, tuple(float("nan") if v is None else v for v in place), hole, used)


class Group(NamedTuple):
    """Data of one kind and one rock mass, of points and dips of one surface. names: (N,) of Datum. rows: (N,)
    their rows, from 0, in the data that are used or, of what is switched off in a surface's points, there.
    ends: (N, 3) the lower ends of intervals. normals: (N, 3) of dips, toward younger rock, of any length."""

    kind: str
    rock: str
    names: np.ndarray
    places: np.ndarray
    holes: np.ndarray
    used: np.ndarray
    rows: np.ndarray
    ends: np.ndarray | None = None
    normals: np.ndarray | None = None

    def datum(self, number):
        place = tuple(float(value) for value in self.places[number])
        return Datum(
            self.kind,
            self.rock,
            str(self.names[number]),
            place,
            str(self.holes[number]),
            bool(self.used[number]),
        )

    def find(self, datum):
        """The number of a datum in the group; None where it is not there."""
        if (self.kind, self.rock) != (datum.kind, datum.rock) or not len(self.places):
            return None
        same = ((self.places == datum.place) | (np.isnan(self.places) & np.isnan(datum.place))).all(axis=1)
        same &= (self.names == datum.name) & (self.holes == datum.hole)
        numbers = np.flatnonzero(same)
        return int(numbers[0]) if len(numbers) else None


def groups(scene, kinds=KINDS):
    """All Groups of a scene of these kinds. Data that cannot be read are in none: a build reports why."""
    group_list = []
    for rock in scene.realmodel.rocks:
        if POINT in kinds:
            group_list += _all_points(scene, rock)
        if DIP in kinds:
            group_list += [group for row in rock.surfaces for group in _known(_dips, rock, row, row.dips)]
        if ROCK_DIP in kinds:
            group_list += _known(_dips, rock, rock, rock.dips)
        if SERIES_DIP in kinds:
            group_list += [group for row in rock.series for group in _known(_dips, rock, row, row.dips)]
        if PLACE in kinds or INTERVAL in kinds:
            group_list += _known(_observed, rock, rock, rock.observations)
    return [group for group in group_list if group.kind in kinds and len(group.places)]


def _known(make, rock, row, arrays):
    """The Groups of the arrays of a row, made once: panels ask at each redraw."""
    if not arrays:
        return []
    key = (settings.kind_of(row), rock.name, row.name, arrays.digest)
    if key not in _groups:
        _groups[key] = make(rock, row)
    return _groups[key]


def are_there(scene):
    """Whether a scene has field data, without a look at files."""
    rocks = scene.realmodel.rocks
    of_rocks = any(rock.dips or rock.observations or rock.interval_values or rock.map for rock in rocks)
    of_rocks = of_rocks or any(row.dips for rock in rocks for row in rock.series)
    return of_rocks or any(
        row.dips or row.left_out or (row.source == "POINTS_FILE" and (row.stored or row.filepath))
        for rock in rocks
        for row in rock.surfaces
    )


def switched_off(scene):
    """How many data of a scene are switched off."""
    count = sum(int((~group.used).sum()) for group in groups(scene, (*DIPS, PLACE, INTERVAL)))
    for rock in scene.realmodel.rocks:
        for row in rock.surfaces:
            with suppress(RealModelError):  # damaged arrays, which a build refuses
                count += row.left_out.count("points") if row.left_out else 0
    return count


def _all_points(scene, rock):
    holes = None
    for row in rock.surfaces:
        if row.source not in ("POINTS_FILE", "NONE"):
            continue
        stamp = "" if row.stored or not row.filepath else _stamp(row)
        digests = (arrays.digest for arrays in (row.stored, row.left_out, rock.hole_picks))
        key = (rock.name, row.name, row.source, stamp, *digests)
        if key not in _groups:
            holes = _holes_of_points(rock) if holes is None else holes
            _groups[key] = _points(scene, rock, row, holes)
        yield from _groups[key]


def _stamp(row):
    """What says that the file of a surface, or how it is read, has changed."""
    try:
        return data_objects.file_key(row)
    except RealModelError:  # only some of the columns are set yet
        return row.filepath


def own_points(scene, row):
    """(P, 3) the points of a surface that are used. Raises InputRefused."""
    points = borehole_points.own_points(scene, row)
    if points is None:
        return np.empty((0, 3))
    off = set(map(tuple, borehole_points.left_out(row).tolist()))
    return points[[tuple(point) not in off for point in points.tolist()]] if off else points


def interval_rows(observations):
    """(I, 2) the first and last rows of the intervals and places of Observations; what is switched off is not
    in one interval with what is used."""
    used = observations.in_use
    follows = observations.goes_on
    follows[1:] &= used[1:] == used[:-1]
    begin = np.flatnonzero(~follows)
    end = np.append(begin[1:], len(observations)) - 1
    return np.column_stack([begin, end]).reshape(-1, 2)


def _holes_of_points(rock):
    return {
        (name, tuple(place)): hole
        for hole, (_, picks) in borehole_picks.of_rock(rock).items()
        for name, place in picks
    }


def _points(scene, rock, row, holes):
    try:
        used, off = own_points(scene, row), borehole_points.left_out(row)
    except (RealModelError, KeyError):
        return []
    places = np.concatenate([used, off])
    of_hole = [""] * len(places)
    if holes:
        of_hole = [holes.get((row.name, tuple(place)), "") for place in places.tolist()]
    in_use = np.arange(len(places)) < len(used)
    rows = np.concatenate([np.arange(len(used)), np.arange(len(off))])
    names = np.full(len(places), row.name)
    return [Group(POINT, rock.name, names, places, np.array(of_hole, str), in_use, rows)]


def _dips(rock, row):
    """The dips of a surface, of a series or of a rock mass, by its row."""
    is_of_series = settings.kind_of(row) == "series"
    try:
        dips = surface_dips.of_row(row)
    except RealModelError:
        return []
    if is_plan := isinstance(dips, Dips):
        places = np.column_stack([dips.positions, dips.heights])
        normals = np.column_stack([-dips.gradients, np.ones(len(dips))])
    else:
        places, normals = dips.positions, dips.normals
    names, kind = np.full(len(dips), row.name), SERIES_DIP if is_of_series else DIP
    if row == rock and is_plan:
        surfaces, blocks = dips.named
        names, kind = np.where(surfaces != "", surfaces, blocks), ROCK_DIP
    holes, rows = np.full(len(dips), ""), np.arange(len(dips))
    return [Group(kind, rock.name, names, places, holes, dips.in_use, rows, normals=normals)]


def _observed(_rock, row):
    try:
        observations = observed_blocks.of_rock(row)
    except RealModelError:
        return []
    rows = interval_rows(observations)
    is_interval = rows[:, 1] > rows[:, 0]
    group_list = []
    for kind, chosen in ((INTERVAL, rows[is_interval]), (PLACE, rows[~is_interval])):
        first, last = chosen.T
        names, holes = observations.blocks[first], observations.holes[first]
        places, ends = observations.places[first], observations.places[last]
        used = observations.in_use[first]
        group_list.append(Group(kind, row.name, names, places, holes, used, first, ends))
    return group_list
