# SPDX-License-Identifier: GPL-3.0-or-later
"""How many triangles an edge length gives, told beside it before anything is built."""

import math

import bpy
import numpy as np

from ..core import RealModelError
from ..core.readers import read_region
from . import project_settings, settings, stored_arrays


def expected_triangles(row):
    """About how many triangles the planar mesh of a rock mass will have; None where it cannot be told."""
    if row.region_area <= 0.0 or row.edge_length <= 0.0:
        return None
    equilateral = math.sqrt(3.0) / 4.0 * row.edge_length**2
    return row.region_area / equilateral


def ask():
    """Has all regions measured that have not been, as soon as Blender lets data be changed: a panel that is
    being drawn may not."""
    if not bpy.app.timers.is_registered(_measure_all):
        bpy.app.timers.register(_measure_all, first_interval=0.0)


def stop():
    """Ends what was asked for: the add-on is disabled."""
    if bpy.app.timers.is_registered(_measure_all):
        bpy.app.timers.unregister(_measure_all)


def _measure_all():
    for scene in bpy.data.scenes:
        for row in scene.realmodel.rocks:
            if row.region_area < 0.0 and scene.library is None:
                layer = scene.view_layers[0]
                measure(scene, row, layer.depsgraph)


def measure(scene, row, depsgraph):
    """Measures the region of a rock mass, once for each change of it: model units squared, 0 where it is not
    known."""
    rings = None
    try:
        rings = project_settings.region_rings(row, depsgraph, project_settings.model_origin(scene))
        if rings is None and row.region_stored:
            rings = list(stored_arrays.unpack(row.region_stored).values())
        path = project_settings.absolute(row.region_file)
        if rings is None and path is not None:
            rings, _ = read_region(path)
    except RealModelError:
        rings = None  # the build will say what is wrong
    with settings.filling():
        row.region_area = 0.0 if rings is None else _area(rings)


def _area(rings):
    """Even-odd area of nested rings, each inner one a hole of the next outer one: by their depth."""
    total = 0.0
    for number, ring in enumerate(rings):
        depth = sum(_inside(ring[0], other) for n, other in enumerate(rings) if n != number)
        total += (-1) ** depth * _ring_area(np.asarray(ring))
    return total


def _ring_area(ring):
    x, y = (ring - ring[0]).T
    return abs(float((x * np.roll(y, -1) - np.roll(x, -1) * y).sum())) / 2.0


def _inside(place, ring):
    """Whether a place is inside a ring: how many edges a ray to the east crosses."""
    a, b = np.asarray(ring), np.roll(np.asarray(ring), -1, axis=0)
    spans = (a[:, 1] > place[1]) != (b[:, 1] > place[1])
    with np.errstate(divide="ignore", invalid="ignore"):
        east = a[:, 0] + (place[1] - a[:, 1]) / (b[:, 1] - a[:, 1]) * (b[:, 0] - a[:, 0])
    return bool(np.count_nonzero(spans & (east > place[0])) % 2)
