# SPDX-License-Identifier: GPL-3.0-or-later
"""The residuals of surfaces: points as small bodies, colored by point minus surface; and their statistics."""

import json

import numpy as np

from ...core import layer_values
from ...core.drawing.overlay import ColorKey
from ...core.residuals import residuals
from .. import library_rows, project_settings
from . import bodies, colors, explosion, marks, shown_models

_MOST = 20_000  # points shown at most: those farthest from their surfaces
_STEPS = 15  # of the color scale: each is a material, which all ways of shading show
_RADIUS = 0.007  # of the model's size


def show(current):
    """Shows the residuals of a scene's model, in place of those that are shown. Raises RealModelError."""
    hide(current)
    found = residuals(shown_models.whole(current, None))
    current.realmodel.view.residuals = json.dumps(
        [
            (
                each.rock,
                each.surface,
                len(each.values),
                each.mean,
                each.root_mean_square,
                each.largest,
                each.outside,
            )
            for each in found
        ]
    )
    if not any(len(each.values) for each in found):
        return
    points = np.concatenate([each.points for each in found]) - project_settings.model_origin(current)
    values = np.concatenate([each.values for each in found])
    order = np.sort(np.argsort(-np.abs(values), kind="stable")[:_MOST])
    low, high = explosion.bounds(current)
    shape = marks.points(points[order], _RADIUS * float(np.linalg.norm(high - low)))
    mesh = bodies.add(current, bodies.RESIDUALS, "Residuals", shape).data
    low, high = limits(current)
    steps = (values[order] - low) / ((high - low) or 1.0) * (_STEPS - 1)
    for color in _colors(_STEPS)[:, :3].tolist():
        code = library_rows.hex_color(color)
        mesh.materials.append(colors.plain_material(f"Residual {code}", code))
    mesh.polygons.foreach_set("material_index", np.repeat(np.rint(steps).astype(np.int32), 8))


def hide(current):
    """Removes the residuals from a scene."""
    bodies.remove(current, bodies.RESIDUALS)
    current.realmodel.view.residuals = ""


def rows(current):
    """(rock mass, surface, points, mean, root mean square, largest, points beyond it) of each surface whose
    residuals are shown."""
    text = current.realmodel.view.residuals
    return [tuple(row) for row in json.loads(text)] if text else []


def limits(current):
    most = max((abs(row[5]) for row in rows(current)), default=0.0)
    return -most, most


def key(current):
    """The core's ColorKey of the residuals, or None where there are none."""
    low, high = limits(current)
    if not high > low:
        return None
    return ColorKey(f"Residual ({current.realmodel.units})", limits=(low, high), colors=_colors(_STEPS))


def _colors(count):
    return layer_values.colors(np.linspace(-1.0, 1.0, count), (-1.0, 1.0), layer_values.DIVERGING)
