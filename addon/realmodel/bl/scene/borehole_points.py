# SPDX-License-Identifier: GPL-3.0-or-later
"""Adds the points where boreholes meet surfaces to the surfaces of a rock mass, and stores them in the
.blend."""

import numpy as np

from ...core.surfaces.age_order import age_order
from ..project import borehole_picks, library_rows, method_settings, settings
from . import data_objects


def give(scene, rock, picks, add_surfaces=False, units=()):
    """Adds points to the surfaces of their names; those that are switched off stay with them.

    rock: its row. picks: realmodel.core.Picks in model units. add_surfaces: adds those that are not there,
    the oldest first. units: names of blocks with intervals or observations; their surfaces are called so,
    too. Returns warnings about unused points, and about their order. Raises InputRefused.
    """
    points = picks.points
    surface_names = {row.name for row in rock.surfaces}
    new = [name for name in dict.fromkeys((*points, *units)) if name not in surface_names]
    surface_points = {row.name: own_points(scene, row) for row in rock.surfaces if row.name in points}
    warnings = []
    with settings.filling():
        if add_surfaces:
            order = age_order(new, [points.get(name, _tops(picks, name)) for name in new], picks.holes)
            warnings += [text] if (text := order.warning(new)) else []
            for name in (new[number] for number in order.order):
                row = rock.surfaces.add()
                row.name = name
                row.property_id = library_rows.for_surface(scene, name)
                row.block = name if name in units else ""
                if name in points:
                    surface_points[name] = np.empty((0, 3))
        else:
            warnings += [f"the boreholes met '{name}', which is no surface of {rock.name}" for name in new]
        for row in rock.surfaces:  # Blender may have moved all of them when some were added
            if surface_points.get(row.name) is not None:
                keep_points(row, np.concatenate([surface_points[row.name], points[row.name]]))
            off = picks.switched_off.get(row.name)
            if off is not None and row.source == "POINTS_FILE":
                keep_left_out(row, np.concatenate([left_out(row), off]))
        warnings += [
            f"'{name}' is made of an object or a mesh, and takes no points from boreholes"
            for name, array in surface_points.items()
            if array is None
        ]
        rock.active_surface = len(rock.surfaces) - 1
    return warnings


def forget(rock, holes):
    """Takes the picks of some holes away from the surfaces of a rock mass that have them."""
    earlier = borehole_picks.of_rock(rock)
    places = {tuple(place) for hole in holes if hole in earlier for _, place in earlier[hole][1]}
    with settings.filling():  # drawn again once, by what gives points in their place
        for row in rock.surfaces if places else ():
            if row.source != "POINTS_FILE" or row.filepath or not row.stored:
                continue
            points = row.stored["points"]
            others = np.array([tuple(point) not in places for point in points.tolist()], bool)
            if not others.all():
                keep_points(row, points[others])
                row.source = "POINTS_FILE" if others.any() else "NONE"


def _tops(picks, name):
    """(N, 3) where a unit begins in the intervals of holes; None where it is in none."""
    tops = [place for _, met in picks.holes.values() for surface, place in met if surface == name]
    return np.array(tops) if tops else None


def own_points(scene, row):
    """The points that a surface has from its file; None where it is no surface of such points."""
    if row.source == "NONE":
        return np.empty((0, 3))
    if row.source != "POINTS_FILE":
        return None
    points = data_objects.read_points(scene, row)
    return np.empty((0, 3)) if points is None else points


def keep_points(row, points):
    """Gives a surface points that are stored in the .blend."""
    with settings.filling():
        row.filepath = ""
        method_settings.fill_reading(row)
        row.stored, row.stored_stamp = {"points": points}, ""
        row.interface_digest = ""
    row.source = "POINTS_FILE"  # last and alone: the data are drawn again once, not for each setting


def left_out(row):
    """(Q, 3) the points of a surface that are switched off. Raises InputRefused for damaged arrays."""
    return row.left_out.get("points", np.empty((0, 3)))


def keep_left_out(row, places):
    """Stores the points of a surface that are switched off."""
    row.left_out = {"points": places} if len(places) else {}
