# SPDX-License-Identifier: GPL-3.0-or-later
"""The 3D viewports on the screens.

What a user asks for in one viewport happens in that one: its `space_data` is the context's. Scripts and
background mode have none; then it happens in all of them.
"""

import math

import bpy
import numpy as np
from mathutils import Matrix, Vector

from . import scene

# Where the usual view of a model is from. Azimuths are clockwise from north (+y).
CAMERA_AZIMUTH = math.radians(152.0)
CAMERA_ELEVATION = math.radians(27.0)


def towards(azimuth, elevation):
    """Unit vector towards an azimuth (clockwise from north) and elevation, radians."""
    flat = math.cos(elevation)
    return Vector((flat * math.sin(azimuth), flat * math.cos(azimuth), math.sin(elevation)))


def view_rotation():
    """How the usual view is turned, (3, 3): its columns point right, up, and back from where it looks."""
    back = towards(CAMERA_AZIMUTH, CAMERA_ELEVATION)
    right = Vector((0.0, 0.0, 1.0)).cross(back).normalized()
    return Matrix((right, back.cross(right), back)).transposed()


def areas():
    """The areas of all 3D viewports that are on a screen."""
    for window in bpy.context.window_manager.windows:
        yield from (area for area in window.screen.areas if area.type == "VIEW_3D")


def spaces(context):
    """The viewport that a context belongs to; else those of the windows, or of all screens where there is no
    window."""
    space = context.space_data
    if space is not None and space.type == "VIEW_3D":
        return [space]
    return [area.spaces.active for area in areas()] or all_spaces()


def all_spaces():
    """The viewports of all screens of the file."""
    return [
        space
        for screen in bpy.data.screens
        for area in screen.areas
        for space in area.spaces
        if space.type == "VIEW_3D"
    ]


def updated_layer(scene):
    """The view layer of a scene that a window shows, else its first one, brought up to date."""
    windows = bpy.context.window_manager.windows
    layer = next((w.view_layer for w in windows if w.scene == scene), scene.view_layers[0])
    layer.update()
    return layer


def still_open(remembered):
    """Those viewports of some that are still there, by their pointers."""
    return [space for space in all_spaces() if space.as_pointer() in remembered]


def frame(current, shown):
    """Turns viewports to the model of a scene, and lets them see that far."""
    frame_items(scene.model_objects(current), shown)


def frame_items(items, shown):
    """Turns viewports to objects, and lets them see that far."""
    corners = [item.matrix_world @ Vector(corner) for item in items for corner in item.bound_box]
    if not corners:
        return
    corners = np.array(corners)
    middle = 0.5 * (corners.min(axis=0) + corners.max(axis=0))
    diagonal = float(np.linalg.norm(np.ptp(corners, axis=0)))
    for space in shown:
        space.clip_start, space.clip_end = diagonal / 1e4, diagonal * 10.0
        space.region_3d.view_location = middle
        space.region_3d.view_distance = diagonal
        space.region_3d.view_rotation = view_rotation().to_quaternion()


def redraw():
    """The viewports and their sidebars show what has changed."""
    for area in areas():
        area.tag_redraw()


def redraw_sidebars():
    """The sidebars show what has changed; the scene is not drawn anew for it."""
    for area in areas():
        for region in area.regions:
            if region.type == "UI":
                region.tag_redraw()
