# SPDX-License-Identifier: GPL-3.0-or-later
"""The 3D viewports on the screens.

An operator acts on the viewport in which it was called: its context has the `space_data`. Called from another
editor, a menu of the top bar, or a script, it acts on the largest viewport of the window; in background mode,
on all of them.
"""

import math

import bpy
import numpy as np
from bpy_extras import view3d_utils
from mathutils import Matrix, Vector

from . import model_tree

# Where the usual view of a model is from. Azimuths are clockwise from north (+y).
CAMERA_AZIMUTH = math.radians(152.0)
CAMERA_ELEVATION = math.radians(27.0)


def towards(azimuth, elevation):
    """Unit vector towards an azimuth (clockwise from north) and elevation, radians."""
    flat = math.cos(elevation)
    return Vector((flat * math.sin(azimuth), flat * math.cos(azimuth), math.sin(elevation)))


def view_rotation(azimuth=CAMERA_AZIMUTH, elevation=CAMERA_ELEVATION):
    """The rotation of the default view, (3, 3): its columns point right, up, and backward. azimuth,
    elevation: of the eye, radians."""
    back = towards(azimuth, elevation)
    right = Vector((0.0, 0.0, 1.0)).cross(back).normalized()
    return Matrix((right, back.cross(right), back)).transposed()


_status = {}  # by the pointer of a window: the message in its status bar


def areas():
    """The areas of all 3D viewports that are on a screen."""
    for window in bpy.context.window_manager.windows:
        yield from (area for area in window.screen.areas if area.type == "VIEW_3D")


def spaces(context):
    """The viewport that a context belongs to, or those that stand for it."""
    space = context.space_data
    if space is not None and space.type == "VIEW_3D":
        return [space]
    if bpy.app.background or context.window is None:
        return [area.spaces.active for area in areas()] or all_spaces()
    view_areas = [area for area in context.window.screen.areas if area.type == "VIEW_3D"]
    return [area.spaces.active for area in sorted(view_areas, key=lambda a: a.width * a.height)[-1:]]


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


def is_open(remembered):
    """The viewports of a list that still exist, by their pointers."""
    return [space for space in all_spaces() if space.as_pointer() in remembered]


def frame(scene, shown):
    """Frames the model of a scene in viewports, and extends their clipping; faults and bodies may reach far
    beyond the blocks."""
    frame_items(
        model_tree.model_objects(scene, "interface") + model_tree.model_objects(scene, "block"), shown
    )


def corners(items):
    """(8 N, 3) the corners of the boxes around N objects, where they stand."""
    places = [obj.matrix_world @ Vector(corner) for obj in items for corner in obj.bound_box]
    return np.array(places).reshape(-1, 3)


def frame_items(items, shown):
    """Frames objects in viewports, beside their toolbars and sidebars, and extends their clipping."""
    around = corners(items)
    if not len(around):
        return
    middle = 0.5 * (around.min(axis=0) + around.max(axis=0))
    diagonal = float(np.linalg.norm(np.ptp(around, axis=0)))
    for space in shown:
        space.clip_start, space.clip_end = diagonal / 1e4, diagonal * 10.0
        view = space.region_3d
        view.view_location = middle
        view.view_distance = diagonal
        view.view_rotation = view_rotation().to_quaternion()
        _move_beside(space, diagonal)
        if middle[2] < 0.0:
            space.overlay.show_floor = False  # its lines would lie over a model below it


def _move_beside(space, distance):
    """Moves what a viewport shows from the distance in its middle to the middle of what no toolbar and no
    sidebar covers, and farther away as that is narrower."""
    area = next((area for area in areas() if area.spaces.active == space), None)
    if area is None or bpy.app.background:  # there Blender ends where it looks for a region's pixels
        return
    regions = {region.type: region for region in area.regions}
    region, view = regions["WINDOW"], space.region_3d
    left, right = region.x, region.x + region.width
    for kind in ("TOOLS", "UI"):
        other = regions.get(kind)
        if other is None or other.width <= 1 or other.x + other.width <= left or other.x >= right:
            continue  # it is hidden, or stands beside the region
        if other.x + 0.5 * other.width < region.x + 0.5 * region.width:
            left = max(left, other.x + other.width)
        else:
            right = min(right, other.x)
    if right <= left:
        return
    view.view_distance = distance * region.width / (right - left)
    view.update()
    at = 0.5 * (left + right) - region.x, 0.5 * region.height
    target = Vector(view.view_location)
    view.view_location = 2.0 * target - view3d_utils.region_2d_to_location_3d(region, view, at, target)


def under_mouse(context, event):
    """(area, (x, y) in its window region) of the 3D viewport under the mouse; None where there is none, or
    where a sidebar, a toolbar or a header lies over it."""
    for area in context.screen.areas:
        if area.type != "VIEW_3D":
            continue
        x, y = event.mouse_x, event.mouse_y
        regions = [r for r in area.regions if r.x <= x < r.x + r.width and r.y <= y < r.y + r.height]
        if regions and all(region.type == "WINDOW" for region in regions):
            return area, (x - regions[0].x, y - regions[0].y)
    return None


def ray(area, at):
    """(start, direction) of the ray into a viewport at a position in its window region, as Vectors."""
    region = next(r for r in area.regions if r.type == "WINDOW")
    view = area.spaces.active.region_3d
    start = view3d_utils.region_2d_to_origin_3d(region, view, at)
    along = view3d_utils.region_2d_to_vector_3d(region, view, at)
    if not view.is_perspective:  # the origin of such a ray may lie within the model
        start = start - along * 1e-1 * area.spaces.active.clip_end
    return start, along


def pixels(area, places):
    """(N, 2) of places (N, 3) of the world in the window region of a viewport; what is
    behind the eye is infinitely far."""
    region = next(r for r in area.regions if r.type == "WINDOW")
    matrix = np.array(area.spaces.active.region_3d.perspective_matrix)
    projected = np.column_stack([places, np.ones(len(places))]) @ matrix.T
    with np.errstate(divide="ignore", invalid="ignore"):
        seen = (projected[:, :2] / projected[:, 3:] + 1.0) / 2.0 * (region.width, region.height)
    return np.where(projected[:, 3:] > 0.0, seen, np.inf)


def show_status():
    """Shows in the status bar of each window the message of background work for its scene, which no operator
    reports."""
    problem = bpy.context.window_manager.realmodel.problem
    for window in bpy.context.window_manager.windows:
        group, key = window.scene.realmodel, window.as_pointer()
        text = group.view.message or (problem if group.live else "")
        if text != _status.get(key, ""):
            window.workspace.status_text_set(f"RealModel: {text}" if text else None)
            _status[key] = text


def forget_status():
    """The status bars are Blender's again: another file was opened, or the add-on is disabled."""
    for window in bpy.context.window_manager.windows:
        if _status.get(window.as_pointer()):
            window.workspace.status_text_set(None)
    _status.clear()


def look_at(context, place, size):
    """Turns the viewports of a context to a place (3,), around which they show what has this size."""
    for space in spaces(context):
        space.region_3d.view_location = place
        space.region_3d.view_distance = 2.5 * size
    redraw()


def redraw():
    """Redraws the viewports, their sidebars, and the status bar."""
    show_status()
    for area in areas():
        area.tag_redraw()


def redraw_sidebars():
    """Redraws the sidebars, but not the 3D viewports."""
    for area in areas():
        for region in area.regions:
            if region.type == "UI":
                region.tag_redraw()
