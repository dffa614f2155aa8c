# SPDX-License-Identifier: GPL-3.0-or-later
"""Boreholes as tubes in the colors of their blocks: those of their intervals; of a hole with picks alone,
below the pick of a surface the color of the layer beneath it."""

from itertools import pairwise

import numpy as np

from .. import borehole_picks, observed_blocks, project_settings
from . import bodies, colors, explosion, marks

_RADIUS = 0.005  # of the model's size
_SIDES = 8


def show(scene):
    """Shows the boreholes of a scene's model, in place of those that are shown."""
    bodies.remove(scene, bodies.BOREHOLES)
    places, properties = [], []
    for rock in scene.realmodel.rocks:
        logs, _ = observed_blocks.shown(rock)
        tubes = [*_of_logs(scene, rock, logs.values()), *_of_picks(rock, logs)]
        for layer, begin, end in tubes:
            if begin != end:
                places += [begin, end]
                properties.append(layer)
    if not places:
        return
    low, high = explosion.bounds(scene)
    places = np.array(places) - project_settings.model_origin(scene)
    pairs = np.arange(len(places)).reshape(-1, 2)
    shape = marks.lines(places, pairs, _RADIUS * float(np.linalg.norm(high - low)), _SIDES)
    mesh = bodies.add(scene, bodies.BOREHOLES, "Boreholes", shape).data
    slots = sorted(set(properties), key=lambda number: -1 if number is None else number)
    for number in slots:
        mesh.materials.append(colors.of_property(scene, number or 0))
    given = np.array([slots.index(number) for number in properties], np.int32)
    mesh.polygons.foreach_set("material_index", np.repeat(given, _SIDES))
    mesh.update()


def _of_picks(rock, logs):
    """(property, begin, end) of the tubes of holes that have no intervals."""
    ids = [surface.property_id for surface in rock.surfaces]
    below = {surface.name: number for surface, number in zip(rock.surfaces, ids, strict=True)}
    above = {surface.name: number for surface, number in zip(rock.surfaces, ids[1:], strict=False)}
    for hole, (collar, picks) in borehole_picks.of_rock(rock).items():
        if hole in logs or not picks:
            continue
        stops = [] if collar is None else [(above.get(picks[0][0]), collar)]
        stops += [(below.get(name), place) for name, place in picks]
        for (layer, begin), (_, end) in pairwise(stops):
            yield layer, begin, end


def _of_logs(scene, rock, logs):
    """(property, begin, end) of the tubes of intervals; between two of them there are none."""
    rows = {row.name: row.property_id for row in (*rock.surfaces, *scene.realmodel.bodies)}
    units = observed_blocks.units_of(scene, rock)
    for log in logs:
        blocks, places = log.blocks.tolist(), log.places.tolist()
        for row in np.flatnonzero(log.goes_on).tolist():
            yield rows.get(units.block(blocks[row])), places[row - 1], places[row]
