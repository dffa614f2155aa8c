# SPDX-License-Identifier: GPL-3.0-or-later
"""The view directions of a 3D viewport: the six standard views, previous and next, the whole model in the
frame. In background mode `capture` renders from the turned viewport."""

from dataclasses import dataclass

import bpy
import numpy as np
from bpy_extras.object_utils import world_to_camera_view
from mathutils import Quaternion, Vector

from ...core import InputRefused
from ..host import caches
from ..objects import exaggeration, filled_beds, meshes, viewports
from . import bodies, cuts, explosion, modes

_H = 0.5**0.5
DIRECTIONS = {  # as Blender's own axis views
    "FRONT": Quaternion((_H, _H, 0.0, 0.0)),
    "BACK": Quaternion((0.0, 0.0, _H, _H)),
    "LEFT": Quaternion((0.5, 0.5, -0.5, -0.5)),
    "RIGHT": Quaternion((0.5, 0.5, 0.5, 0.5)),
    "TOP": Quaternion((1.0, 0.0, 0.0, 0.0)),
    "BOTTOM": Quaternion((0.0, 1.0, 0.0, 0.0)),
}
_MARGIN = 1.1
_MOST_KEPT = 50
_history = caches.new(list)  # earlier views, and the present one, the oldest first
_at = -1  # index of the present view


@dataclass(frozen=True)
class _View:
    location: tuple
    rotation: tuple
    distance: float
    perspective: str

    @classmethod
    def of(cls, space):
        view = space.region_3d
        numbers = [
            tuple(round(float(v), 5) for v in values) for values in (view.view_location, view.view_rotation)
        ]
        return cls(*numbers, round(float(view.view_distance), 5), view.view_perspective)

    def show(self, space):
        view = space.region_3d
        view.view_perspective = self.perspective
        view.view_location = self.location
        view.view_rotation = self.rotation
        view.view_distance = self.distance


def turn(context, direction):
    """Looks at the whole model along an axis, in orthographic view. direction: a key of DIRECTIONS."""
    spaces = viewports.spaces(context)
    _remember(spaces[0])
    for space in spaces:
        view = space.region_3d
        view.view_perspective = "ORTHO"
        view.view_rotation = DIRECTIONS[direction]
        _frame(context.scene, space)
    _remember(spaces[0])
    viewports.redraw()


def frame(context):
    """Zooms to the whole model. Raises InputRefused where there is none."""
    spaces = viewports.spaces(context)
    if len(model_points(context.scene)) == 0:
        raise InputRefused("no model is visible", advice="build one first")
    _remember(spaces[0])
    for space in spaces:
        _frame(context.scene, space)
    _remember(spaces[0])
    viewports.redraw()


def step(context, by):
    """Goes back (-1) or forth (+1) in the history of views. Raises InputRefused at the ends."""
    global _at
    spaces = viewports.spaces(context)
    _remember(spaces[0])
    if not 0 <= _at + by < len(_history):
        which = "an earlier" if by < 0 else "a later"
        raise InputRefused(f"there is not {which} view", advice="turn the view first")
    _at += by
    for space in spaces:
        _history[_at].show(space)
    viewports.redraw()


def _remember(space):
    """The view as it is now becomes the one that is shown, after the one before; later ones are dropped."""
    global _at
    now = _View.of(space)
    if 0 <= _at < len(_history) and _history[_at] == now:
        return
    del _history[_at + 1 :]
    _history.append(now)
    del _history[:-_MOST_KEPT]
    _at = len(_history) - 1


def model_points(scene, cut=False):
    """(N, 3) float64: corners of the boxes around all blocks, or interfaces before a build, in the world.
    cut: around what a section plane has left of the blocks. Without a model: of filled meshes and beds."""
    group = scene.realmodel
    framed = modes.body_of if cut and cuts.is_shown(scene) else _framed
    items = [framed(scene, row) for row in group.results]
    if not len(items):
        items = [surface.interface for rock in group.rocks for surface in rock.surfaces]
        items = items or filled_beds.shown(scene)
    items += list(bodies.of_kind(scene, bodies.SECTION).values())
    corners = []
    for obj in items:
        if obj is None or obj.type != "MESH" or not len(obj.data.vertices):
            continue
        coordinates = meshes.mesh_coordinates(obj.data).astype(np.float64)
        low, high = coordinates.min(axis=0), coordinates.max(axis=0)
        box = np.array(
            [[x, y, z] for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])]
        )
        matrix = np.array(exaggeration.world_matrix(obj), np.float64)
        corners.append(box @ matrix[:3, :3].T + matrix[:3, 3])
    return np.concatenate(corners) if corners else np.empty((0, 3))


def camera_sees(scene):
    """Whether the camera of a scene has a corner or the middle of the model in its frame."""
    if scene.camera is None:
        return False
    box = np.array(explosion.bounds(scene))
    places = [box.mean(axis=0), *(box[list(corner), range(3)] for corner in np.ndindex(2, 2, 2))]
    stretched = exaggeration.matrix(scene)
    places = [(stretched @ np.append(place, 1.0))[:3] for place in places]
    seen = (world_to_camera_view(scene, scene.camera, Vector(place)) for place in places)
    return any(0.0 <= at.x <= 1.0 and 0.0 <= at.y <= 1.0 and at.z > 0.0 for at in seen)


def _framed(scene, row):
    """A block, or its parts where compartments are moved apart."""
    return modes.body_of(scene, row) or row.object if modes.apart_shown(scene) else row.object


def _frame(scene, space):
    points = model_points(scene)
    if not len(points):
        return
    middle = (points.min(axis=0) + points.max(axis=0)) / 2
    size = float(np.linalg.norm(np.ptp(points, axis=0))) or 1.0
    view = space.region_3d
    rotation = np.array(Quaternion(view.view_rotation).to_matrix())
    seen = np.ptp((points - middle) @ rotation, axis=0)  # to the right, up, towards the eye
    aspect = _aspect(space)
    reach = max(float(seen[0]), float(seen[1]) * aspect, 1e-3 * size) * max(1.0, 1.0 / aspect)
    view.view_location = Vector(middle)
    before_it = 0.0 if view.view_perspective == "ORTHO" else seen[2] / 2
    view.view_distance = _MARGIN * reach / width_at_distance(space) + before_it
    space.clip_end = max(space.clip_end, 10.0 * (size + view.view_distance))
    space.clip_start = min(space.clip_start, 1e-3 * view.view_distance)


def width_at_distance(space):
    """The width of the longer side of a viewport's view, divided by its distance; Blender's view covers 72
    mm."""
    return 72.0 / space.lens


def _aspect(space):
    """Width divided by height of the region that a viewport is drawn in."""
    for screen in bpy.data.screens:
        for area in screen.areas:
            if area.type == "VIEW_3D" and area.spaces.active == space:
                region = next(region for region in area.regions if region.type == "WINDOW")
                if region.width > 1 and region.height > 1:
                    return region.width / region.height
    return 1.6
