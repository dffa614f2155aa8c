# SPDX-License-Identifier: GPL-3.0-or-later
"""The column of numbers by which boreholes are colored as a curve beside each, in the same colors: its bars
are as wide as the values, and face the section plane or, without a cut, the south."""

import numpy as np

from ...core.display.polygon_mesh import PolygonMesh
from ...core.results.sections.hole_curves import bars, shares_of, sides_of
from ..display import bodies, cuts
from ..project import project_settings
from . import boreholes, heights

CURVES = "hole_curves"
_GAP, _WIDTH = 0.008, 0.05  # from the middle of a tube to the lowest value, and on to the highest, of all
_FROM_SOUTH = np.array([0.0, -1.0, 0.0])


def is_wanted(scene):
    """Whether curves are shown: with the tubes, and where these show numbers."""
    view = scene.realmodel.view
    return view.show_boreholes and view.show_hole_curves and boreholes.limits(scene) is not None


def show(scene):
    """Shows the curves of a scene, in place of those that are shown."""
    bodies.remove(scene, CURVES)
    limits = boreholes.limits(scene)
    normal = cuts.plane_in_model(scene)[1] if boreholes.is_on_cut(scene) else _FROM_SOUTH
    extent = heights.extent(scene)
    right, up = _axes_of(np.array(normal, float))
    lift = boreholes.RADIUS * extent * np.array(normal) if boreholes.is_on_cut(scene) else 0.0
    corners, materials = [], []
    for values, of_values in boreholes.by_column(scene):
        indices, begins, ends = boreholes.near_cut(scene, values.begins, values.ends)
        if not len(indices):
            continue
        sides = sides_of(values.holes[indices], begins, ends, right, up)
        begins, ends = begins + lift, ends + lift
        shares = shares_of(values.columns[boreholes.column(scene)][indices], limits)
        corners.append(bars(begins, ends, sides, shares, _GAP * extent, _WIDTH * extent))
        materials += [of_values[number] for number in indices.tolist()]
    if not materials:
        return
    places = np.concatenate(corners).reshape(-1, 3) - project_settings.model_origin(scene)
    order = np.arange(len(places), dtype=np.int32)
    shape = PolygonMesh(places.astype(np.float32), np.arange(0, len(places) + 1, 4, dtype=np.int32), order)
    bodies.give_materials(bodies.add(scene, CURVES, "Curves of Boreholes", shape).data, materials, 1)


def _axes_of(normal):
    """(3,) of length 1 to the right on the level, and up, on a plane that is seen from where its normal, of
    length 1, points; on a level one to the east and to the north."""
    right = np.array([-normal[1], normal[0], 0.0])
    length = np.linalg.norm(right)
    right = right / length if length > 1e-6 else np.array([1.0, 0.0, 0.0])
    return right, np.cross(normal, right)
