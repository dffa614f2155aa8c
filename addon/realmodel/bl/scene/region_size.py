# SPDX-License-Identifier: GPL-3.0-or-later
"""The number of triangles that an edge length gives; the panel shows it before anything is built."""

import math

import bpy

from ...core import RealModelError
from ...core.project.plan_input import region_rings
from ...core.readers import read_region
from ...core.surfaces.planar_mesh import triangulate_rings
from ..host import versions
from ..project import project_settings, settings
from ..project.surface_statistics import plan_area


def expected_triangles(row):
    """About how many triangles the planar mesh of a rock mass will have; None where it is not known."""
    if row.region_area <= 0.0 or row.edge_length <= 0.0:
        return None
    equilateral = math.sqrt(3.0) / 4.0 * row.edge_length**2
    return row.region_area / equilateral


def ask():
    """Schedules the measurement of all regions that have no area yet, for when Blender allows changes of
    data: while a panel is drawn it does not."""
    if not bpy.app.timers.is_registered(_measure_all):
        bpy.app.timers.register(_measure_all, first_interval=0.0)


def stop():
    """Stops the scheduled measurement: the add-on is disabled."""
    if bpy.app.timers.is_registered(_measure_all):
        bpy.app.timers.unregister(_measure_all)


def _measure_all():
    for scene in bpy.data.scenes:
        for row in scene.realmodel.rocks:
            if row.region_area < 0.0 and scene.library is None:
                measure(scene, row, versions.depsgraph(scene))


def measure(scene, row, depsgraph):
    """Measures the region of a rock mass, once for each change of it: model units squared, 0 where it is not
    known."""
    try:
        rings = project_settings.region_rings(row, depsgraph, project_settings.model_origin(scene))
        if rings is None and row.region_stored:
            rings = list(row.region_stored.values())
        path = project_settings.absolute(row.region_file)
        if rings is None and path is not None:
            rings, _ = read_region(path)
        area = 0.0 if rings is None else plan_area(*triangulate_rings(region_rings(rings)))
    except RealModelError:
        area = 0.0  # the build will report the error
    with settings.filling():
        row.region_area = area
