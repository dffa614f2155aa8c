# SPDX-License-Identifier: GPL-3.0-or-later
"""Legend, north arrow, scale bar and axes over the viewport and in every picture.

Input: the displayed model and a view of it. Output: one drawing of the core (`core.drawing.overlay`),
which `viewport` draws with the graphics card and `rendered` puts before a camera as an image.
"""

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from ...core.drawing.overlay import Eye, Shown, draw_overlay, legend_extent
from ...core.results.hole_log import draw_hole_log
from ...core.results.orientations.stereonet import draw_beside, small_net
from ..display import colors, ensembles, explosion, fields, residuals
from ..field import boreholes, shown_log, shown_net
from ..host import caches
from ..objects import exaggeration
from ..project import project_settings

_BESIDE_LOG = 12.0  # points between a log or a stereonet and what is at its right
_FOOT_OF_NET = 95.0  # points: the north arrow is below it
_FOOT_OF_LOG, _HEIGHT_OF_LOG = 0.12, 0.62  # of the height of a picture: below the north arrow
WIDTH = 900.0  # points across the longer side of a picture
_drawings = caches.new(most=8)  # by their input, as a viewport is redrawn often


class View(NamedTuple):
    """A picture of the world. projection: (4, 4), from the camera's axes to the picture. matrix: (4, 4), from
    the world to these axes. size: of the picture in points."""

    projection: np.ndarray
    matrix: np.ndarray
    is_perspective: bool
    size: tuple[float, float]


def drawing_for(scene, picture, margins=(0.0, 0.0, 0.0), stretched=None):
    """The Drawing of a scene's overlay, or None where nothing is switched on.

    picture: View. margins: what other things cover at the left, at the right and below, in points. stretched:
    (4, 4), the exaggeration of the vertical, if it is not that of the scene.
    """
    group = scene.realmodel
    view_settings = group.view
    keys, labels = _keys(scene), boreholes.labels(scene)
    parts = [part for part in ("north", "scale", "axes") if getattr(view_settings, f"show_{part}")]
    parts = parts if len(group.results) else []
    if group.explode and "axes" in parts:
        parts.remove("axes")
    has_log = view_settings.log_hole in shown_log.names(scene)
    has_net = view_settings.show_stereonet and shown_net.are_there(scene)
    if not (keys or parts or labels or has_log or has_net):
        return None
    if not (parts or labels):
        picture = picture._replace(projection=np.eye(4), matrix=np.eye(4))  # of legends: it may turn
    view = np.array(picture.matrix, np.float64)
    right, up, back = view[:3, :3] / np.linalg.norm(view[:3, :3], axis=1)[:, None]
    at = -view[:3, :3].T @ view[:3, 3]
    eye = Eye(
        np.array(picture.projection, np.float64) @ view,
        np.array([*at, 1.0] if picture.is_perspective else [*back, 0.0]),
        right,
        up,
        tuple(picture.size),
    )
    origin = project_settings.model_origin(scene)
    placed = np.array(exaggeration.matrix(scene) if stretched is None else stretched)
    factor = float(placed[2, 2])
    placed[:3, 3] -= placed[:3, :3] @ origin
    low, high = explosion.bounds(scene)
    shown = Shown(low + origin, high + origin, placed, group.units, factor)
    arrays = eye.projection, eye.back, eye.right, eye.up, shown.low, shown.high, shown.placed
    of_keys = tuple(
        (k.title, *k.entries, k.limits, k.colors is None or k.colors.tobytes(), *k.names) for k in keys
    )
    of_parts = of_keys, *parts, *labels, tuple(margins)
    of_parts += shown_log.key(scene) if has_log else ()
    of_parts += shown_net.key(scene) if has_net else ()
    name = (*(a.tobytes() for a in arrays), eye.size, shown.unit, factor, *of_parts)
    if name not in _drawings:
        drawing = draw_overlay(eye, shown, keys, parts, margins, labels)
        right = drawing.width - margins[1] - _BESIDE_LOG
        if has_net:
            right = _draw_net(scene, drawing, margins) - _BESIDE_LOG
        if has_log:
            place = right, drawing.height * _FOOT_OF_LOG, drawing.height * _HEIGHT_OF_LOG
            draw_hole_log(drawing, shown_log.of_scene(scene), place)
        _drawings[name] = drawing
    return _drawings[name]


def corner_of_net(width, margins):
    return width - margins[1] - _BESIDE_LOG, _FOOT_OF_NET


def _draw_net(scene, drawing, margins):
    """Draws the stereonet; returns its left border."""
    dips, corner = shown_net.beside_the_model(scene), corner_of_net(drawing.width, margins)
    if dips is None:  # there are none of the name
        return corner[0]
    return draw_beside(drawing, dips, scene.realmodel.view.net.lower(), corner, shown_net.marked(scene))


def place_in_net(scene, width, margins, at):
    """(2,) where a place of a picture, so wide, is in the stereonet, whose radius is 1; all in points. None
    beside it, and where there is none."""
    if shown_net.beside_the_model(scene) is None:
        return None
    middle, radius = small_net(corner_of_net(width, margins))
    place = (np.array(at) - middle) / radius
    return place if place @ place <= 1.0 else None


def _keys(scene):
    """The core's ColorKeys of what colors are to be seen."""
    if not scene.realmodel.view.show_legend:
        return ()
    of_model = (colors.key, residuals.key, ensembles.key, fields.key) if len(scene.realmodel.results) else ()
    color_keys = [key(scene) for key in of_model]
    if scene.realmodel.is_outdated:
        color_keys = [key and replace(key, title=f"{key.title}, out of date") for key in color_keys]
    return tuple(key for key in (*color_keys, boreholes.key(scene)) if key is not None)


def legend_shares(scene, size):
    """The shares of the width and height of a picture, of a size in pixels, that the legends of a scene take
    in its lower left corner."""
    extents = [legend_extent(key) for key in _keys(scene)]
    width, height = (
        sum(1.1 * width for width, _ in extents),
        max((1.1 * high for _, high in extents), default=0.0),
    )
    return min(0.4, width / WIDTH * max(size) / size[0]), min(1.0, height / WIDTH * max(size) / size[1])
