# SPDX-License-Identifier: GPL-3.0-or-later
"""Boreholes as tubes in the colors of their picks: below the pick of a surface, the color of the layer
beneath it."""

from itertools import pairwise

import numpy as np

from .. import borehole_picks, project_settings
from . import bodies, colors, explosion, marks

_RADIUS = 0.005  # of the model's size
_SIDES = 8


def show(scene):
    """Shows the boreholes of a scene's model, in place of those that are shown."""
    bodies.remove(scene, bodies.BOREHOLES)
    places, properties = [], []
    for rock in scene.realmodel.rocks:
        ids = [surface.property_id for surface in rock.surfaces]
        below = {surface.name: number for surface, number in zip(rock.surfaces, ids, strict=True)}
        above = {surface.name: number for surface, number in zip(rock.surfaces, ids[1:], strict=False)}
        for collar, picks in borehole_picks.of_rock(rock).values():
            stops = [] if collar is None else [(above.get(picks[0][0]), collar)]
            stops += [(below.get(name), place) for name, place in picks]
            for (layer, begin), (_, end) in pairwise(stops):
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
