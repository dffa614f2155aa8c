# SPDX-License-Identifier: GPL-3.0-or-later
"""The log of the borehole that is chosen by its name, for the overlay."""

import numpy as np

from ...core.base.algebra import norm
from ...core.results.hole_log import HoleLog, LogPart
from ..project import borehole_picks, interval_values, library_rows
from . import boreholes

_UNKNOWN = (0.75, 0.75, 0.75)


def names(scene):
    """The boreholes of a scene."""
    lines = (borehole_picks.named_paths(rock) for rock in scene.realmodel.rocks)
    return list(dict.fromkeys(name for of_rock in lines for name in of_rock))


def of_scene(scene):
    """The core's HoleLog of the chosen borehole; None where none is chosen, or it is not there."""
    hole = scene.realmodel.view.log_hole
    rocks = [rock for rock in scene.realmodel.rocks if hole and hole in borehole_picks.named_paths(rock)]
    if not rocks:
        return None
    parts, picks = [], []
    for rock in rocks:
        path = np.array(borehole_picks.named_paths(rock)[hole])
        for number, begin, end in boreholes.parts_of(scene, rock, hole):
            row = library_rows.find(scene, number) if number else None
            color = tuple(row.color)[:3] if row is not None and row.has_color else _UNKNOWN
            name = "" if row is None else row.name
            parts.append(LogPart(_depth(path, begin), _depth(path, end), name, color))
        _, met = borehole_picks.of_rock(rock).get(hole, (None, []))
        picks += [(_depth(path, place), surface) for surface, place in met]
    values = interval_values.of_scene(scene)
    of_hole = None if values is None else values.some(values.holes == hole)
    return HoleLog(hole, scene.realmodel.units, parts, picks, of_hole)


def key(scene):
    """What the log of a scene follows from."""
    rocks, group = scene.realmodel.rocks, scene.realmodel
    stored = ("hole_picks", "hole_ends", "observations", "interval_values")
    rows = [(row.id, row.name, *row.color, row.has_color) for row in group.library]
    ids = [(row.name, row.property_id, row.block) for rock in rocks for row in rock.surfaces]
    digests = [getattr(rock, name).digest for rock in rocks for name in stored]
    return group.view.log_hole, group.units, str(rows), str(ids), *map(str, digests)


def _depth(path, place):
    """How far along a hole a place is: at the foot of its distance to the line (N, 3)."""
    if len(path) < 2:
        return float(norm(np.array(place) - path[0]))
    begin, way = path[:-1], np.diff(path, axis=0)
    lengths = norm(way)
    share = ((place - begin) * way).sum(axis=1) / np.maximum(lengths**2, 1e-300)
    share[:-1], share[-1] = np.clip(share[:-1], 0.0, 1.0), max(share[-1], 0.0)
    foot = int(norm(begin + share[:, None] * way - place).argmin())
    return float(lengths[:foot].sum() + share[foot] * lengths[foot])
