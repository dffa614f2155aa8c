# SPDX-License-Identifier: GPL-3.0-or-later
"""The residuals of surfaces: points as small bodies, colored by point minus surface; and their statistics."""

import json

import numpy as np

from ...core.drawing import color_scale
from ...core.drawing.overlay import ColorKey
from ...core.project.looks import hex_color
from ...core.results.surface_quality import residuals
from ..host import caches
from ..objects import exaggeration, marks, meshes
from ..project import project_settings
from . import bodies, colors, explosion, shown_models

_MOST = 20_000  # points shown at most: those farthest from their surfaces
_STEPS = 15  # of the color scale: each is a material, which all ways of shading show
_STRETCH = "realmodel_stretch"  # on the object: the vertical exaggeration that its bodies are shaped for


_of_model = caches.of_model(residuals)


def ahead(scene):
    """As of `display.ahead`."""
    return [_of_model] if scene.realmodel.view.show_residuals else []


def show(scene):
    """Shows the residuals of a scene's model, in place of those that are shown. Raises RealModelError."""
    hide(scene)
    results = _of_model(shown_models.whole(scene, None))
    scene.realmodel.view.residuals = json.dumps(
        [
            (
                residual.rock,
                residual.surface,
                len(residual.values),
                residual.mean,
                residual.root_mean_square,
                residual.largest,
                residual.outside,
            )
            for residual in results
        ]
    )
    if not any(len(residual.values) for residual in results):
        return
    points = np.concatenate([residual.points for residual in results]) - project_settings.model_origin(scene)
    values = np.concatenate([residual.values for residual in results])
    order = np.sort(np.argsort(-np.abs(values), kind="stable")[:_MOST])
    shape = _shape(scene, points[order])
    body = bodies.add(scene, bodies.RESIDUALS, "Residuals", shape)
    mesh, body[_STRETCH] = body.data, exaggeration.factor(scene)
    low, high = limits(scene)
    shares = (values[order] - low) / (high - low) if high > low else np.full(len(order), 0.5)
    steps = shares * (_STEPS - 1)
    for color in _colors(_STEPS)[:, :3].tolist():
        code = hex_color(color)
        mesh.materials.append(colors.plain_material(f"Residual {code}", code))
    mesh.polygons.foreach_set("material_index", np.repeat(np.rint(steps).astype(np.int32), 8))


def _shape(scene, points):
    """Bodies around points (N, 3), as long as wide with the vertical exaggeration of the scene."""
    low, high = explosion.bounds(scene)
    return marks.spaced_points(points, float(np.linalg.norm(high - low)), exaggeration.factor(scene))


def follow_exaggeration(scene):
    """Shapes the bodies for the vertical exaggeration of the scene."""
    stretch = exaggeration.factor(scene)
    for body in bodies.listed(scene, bodies.RESIDUALS):
        if body.get(_STRETCH) == stretch:
            continue
        body[_STRETCH] = stretch
        places = marks.places_of(meshes.mesh_coordinates(body.data).astype(np.float64))
        coordinates = _shape(scene, places).coordinates
        body.data.vertices.foreach_set("co", coordinates.ravel())
        body.data.update()


def hide(scene):
    """Removes the residuals from a scene."""
    bodies.remove(scene, bodies.RESIDUALS)
    scene.realmodel.view.residuals = ""


def rows(scene):
    """(rock mass, surface, points, mean, root mean square, largest, points beyond it) of each surface whose
    residuals are shown."""
    text = scene.realmodel.view.residuals
    return [tuple(row) for row in json.loads(text)] if text else []


def limits(scene):
    most = max((abs(row[5]) for row in rows(scene)), default=0.0)
    return -most, most


def key(scene):
    """The core's ColorKey of the residuals, or None where there are none."""
    low, high = limits(scene)
    if not high > low:
        return None
    return ColorKey(f"Residual ({scene.realmodel.units})", limits=(low, high), colors=_colors(_STEPS))


def _colors(count):
    return color_scale.colors(np.linspace(-1.0, 1.0, count), (-1.0, 1.0), color_scale.DIVERGING)
