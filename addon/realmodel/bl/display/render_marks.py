# SPDX-License-Identifier: GPL-3.0-or-later
"""Points and lines in a final render: while one is under way each block has a body of small octahedra or bars
beside it, as thick as points and lines are on the screen."""

import numpy as np

from ..host import versions
from ..objects import exaggeration, marks, meshes
from . import bodies, colors, modes, viewpoints

POINT_RADIUS, LINE_RADIUS = 2.0, 0.8  # pixels


def put(scene, mode):
    """Makes the bodies for points or lines of a display mode, or removes them in the other modes."""
    if mode not in (*modes.DRAWN, "AREAS"):
        bodies.remove(scene, bodies.MARKS)
        return
    pixel = _pixel_size(scene)
    shapes = []
    for obj in modes.drawn(scene, "LINES" if mode == "AREAS" else mode):
        coordinates = meshes.mesh_coordinates(obj.data)
        if mode == "POINTS":
            stretch = exaggeration.factor(scene)
            shapes.append((obj, marks.points(coordinates, POINT_RADIUS * pixel, stretch)))
        else:
            shapes.append(
                (obj, marks.lines(coordinates, versions.edge_vertices(obj.data), LINE_RADIUS * pixel))
            )
    bodies.put(scene, bodies.MARKS, shapes, colors.dark() if mode == "AREAS" else None)


def _pixel_size(scene):
    """About how large a pixel of a render is at the model, in the units of the scene."""
    render, camera = scene.render, scene.camera
    pixels = max(render.resolution_x, render.resolution_y) * render.resolution_percentage / 100.0
    points = viewpoints.model_points(scene)
    size = float(np.linalg.norm(np.ptp(points, axis=0))) if len(points) else 1.0
    if camera is None or camera.type != "CAMERA":
        return size / pixels
    if camera.data.type == "ORTHO":
        return camera.data.ortho_scale / pixels
    middle = (points.min(axis=0) + points.max(axis=0)) / 2 if len(points) else np.zeros(3)
    away = float(np.linalg.norm(np.array(camera.matrix_world.translation) - middle))
    return 2.0 * np.tan(camera.data.angle / 2.0) * away / pixels
