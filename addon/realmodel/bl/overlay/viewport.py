# SPDX-License-Identifier: GPL-3.0-or-later
"""The overlay in 3D viewports, and in pictures of them, by the graphics card."""

import blf
import bpy
import numpy as np
from mathutils import Matrix
from mathutils.geometry import tessellate_polygon

from ...core.drawing.drawing import ANCHORS, Dots, Line, Polygon, Text
from .. import versions
from . import drawing_for

_FONT = 0  # Blender's own
_handle = None


def draw():
    """The handler of drawing."""
    context = bpy.context
    scene, region, space = context.scene, context.region, context.space_data
    if not hasattr(scene, "realmodel") or not space.overlay.show_overlays:
        return
    scale = context.preferences.system.ui_scale
    draw_for(scene, region.width, region.height, context.region_data, scale, _margins(context.area, scale))


def draw_for(scene, width, height, view, scale, margins=(0.0, 0.0), projection=None):
    """Draws the overlay of a scene into what is bound, so many pixels large. view: RegionView3D. scale:
    pixels for a point. projection: where it is not that of the view."""
    projection = view.window_matrix if projection is None else projection
    size = width / scale, height / scale
    found = drawing_for(scene, projection, view.view_matrix, view.is_perspective, size, margins)
    if found is not None:
        draw_items(found, scale)


def draw_items(drawing, scale):
    """Draws a Drawing with the lower left corner of what is bound as its own."""
    import gpu  # not there in Blender's background mode before 4.0

    shader = versions.plain_shader(False)
    gpu.state.blend_set("ALPHA")
    shader.bind()
    for item in drawing.items:
        if isinstance(item, Polygon):
            if item.fill is not None:
                _triangles(shader, item.rings, item.fill, scale)
            if item.stroke is not None:
                for ring in item.rings:
                    _line(shader, np.concatenate([ring, ring[:1]]), item.stroke, item.width, scale)
        elif isinstance(item, Line):
            _line(shader, item.points, item.color, item.width, scale)
        elif isinstance(item, Text):
            _text(item, scale)
            shader.bind()
        elif isinstance(item, Dots):
            raise NotImplementedError("an overlay has no dots")
    gpu.state.blend_set("NONE")
    gpu.state.line_width_set(1.0)


def _rgba(color):
    return (*color, 1.0)[:4]


def _batch(shader, kind, points, color, scale, indices=None):
    from gpu_extras.batch import batch_for_shader

    places = [(x * scale, y * scale, 0.0) for x, y in points]
    shader.uniform_float("color", _rgba(color))
    batch_for_shader(shader, kind, {"pos": places}, indices=indices).draw(shader)


def _triangles(shader, rings, color, scale):
    points = np.concatenate(rings)
    indices = tessellate_polygon([[(x, y, 0.0) for x, y in ring] for ring in rings])
    _batch(shader, "TRIS", points, color, scale, indices)


def _line(shader, points, color, width, scale):
    import gpu

    gpu.state.line_width_set(max(width * scale, 1.0))
    _batch(shader, "LINE_STRIP", points, color, scale)


def _text(item, scale):
    versions.text_size(_FONT, item.size * scale)
    blf.color(_FONT, *_rgba(item.color))
    left = item.x * scale - ANCHORS[item.anchor] * blf.dimensions(_FONT, item.text)[0]
    blf.position(_FONT, left, item.y * scale, 0.0)
    blf.draw(_FONT, item.text)


def _margins(area, scale):
    """What the tools at the left and the sidebar at the right cover, in points."""
    widths = {region.type: region.width for region in area.regions if region.width > 1}
    if not bpy.context.preferences.system.use_region_overlap:
        return 0.0, 0.0
    return widths.get("TOOLS", 0) / scale, widths.get("UI", 0) / scale


def pixel_matrix(width, height):
    """(4, 4): from pixels to the picture, as handlers of Blender find it."""
    return Matrix(((2 / width, 0, 0, -1), (0, 2 / height, 0, -1), (0, 0, 1, 0), (0, 0, 0, 1)))


def register():
    global _handle
    if not bpy.app.background:
        _handle = bpy.types.SpaceView3D.draw_handler_add(draw, (), "WINDOW", "POST_PIXEL")


def unregister():
    global _handle
    if _handle is not None:
        bpy.types.SpaceView3D.draw_handler_remove(_handle, "WINDOW")
        _handle = None
