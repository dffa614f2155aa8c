# SPDX-License-Identifier: GPL-3.0-or-later
"""The overlay in 3D viewports, and in pictures of them, by the graphics card."""

from itertools import groupby

import blf
import bpy
import numpy as np
from mathutils import Matrix
from mathutils.geometry import tessellate_polygon

from ...core.drawing.drawing import ANCHORS, Text
from ...core.drawing.png import item_shapes
from ..host import caches, versions
from ..host.draw_handler import DrawHandler
from . import View, drawing_for, place_in_net

_FONT = 0  # Blender's own
_PIXELS = 1.25  # for a point, where Blender's interface is not scaled
_MOST_KEPT = 4
_batches = caches.new(list)  # (drawing, scale, texts and batches), the last one drawn at the end


def draw():
    """The handler of drawing."""
    context = bpy.context
    scene, region, space = context.scene, context.region, context.space_data
    if not hasattr(scene, "realmodel") or not space.overlay.show_overlays:
        return
    scale = _scale()
    size = region.width, region.height
    draw_for(scene, size, context.region_data, scale, _margins(context.area, scale))


def _scale():
    """Pixels for a point."""
    return _PIXELS * bpy.context.preferences.system.ui_scale


def at_net(scene, area, at):
    """(2,) the place in the stereonet of a viewport at a pixel of its window region, as of place_in_net."""
    region, scale = next(r for r in area.regions if r.type == "WINDOW"), _scale()
    return place_in_net(scene, region.width / scale, _margins(area, scale), np.array(at) / scale)


def draw_for(scene, size, view, scale, margins=(0.0, 0.0, 0.0), projection=None):
    """Draws the overlay of a scene into the bound framebuffer, size in pixels. view: RegionView3D. scale:
    pixels per point. projection: if it is not that of the view."""
    projection = view.window_matrix if projection is None else projection
    points = size[0] / scale, size[1] / scale
    picture = View(projection, view.view_matrix, view.is_perspective, points)
    drawing = drawing_for(scene, picture, margins)
    if drawing is not None:
        draw_items(drawing, scale)


def draw_items(drawing, scale):
    """Draws a Drawing, its lower left corner at that of the bound framebuffer."""
    import gpu  # not there in Blender's background mode before 4.0

    if not _batches or _batches[-1][:2] != (drawing, scale):
        prepared = next((entry for entry in _batches if entry[:2] == (drawing, scale)), None)
        _batches.append(prepared or (drawing, scale, list(_prepared(drawing, scale))))
        del _batches[:-_MOST_KEPT]
    shader = versions.colored_shader()
    gpu.state.blend_set("ALPHA")
    for element in _batches[-1][2]:
        if isinstance(element, Text):
            _text(element, scale)
        else:
            element.draw(shader)
    gpu.state.blend_set("NONE")


def _prepared(drawing, scale):
    """Texts, and batches of the shapes between them."""
    for is_text, items in groupby(drawing.items, key=lambda element: isinstance(element, Text)):
        if is_text:
            yield from items
        else:
            yield _batch([shape for element in items for shape in item_shapes(element)], scale)


def _batch(shapes, scale):
    """A gpu batch of shapes (rings, color)."""
    from gpu_extras.batch import batch_for_shader

    places, colors, indices = [], [], []
    for rings, color in shapes:
        triangles = np.array(tessellate_polygon([[(x, y, 0.0) for x, y in ring] for ring in rings]))
        indices += (triangles.reshape(-1, 3) + len(places)).tolist()
        corners = np.concatenate(rings) * scale
        places += [(x, y, 0.0) for x, y in corners.tolist()]
        colors += [(*color, 1.0)[:4]] * len(corners)
    shader = versions.colored_shader()
    return batch_for_shader(shader, "TRIS", {"pos": places, "color": colors}, indices=indices)


def _text(text, scale):
    versions.text_size(_FONT, text.size * scale)
    blf.color(_FONT, *(*text.color, 1.0)[:4])
    left = text.x * scale - ANCHORS[text.anchor] * blf.dimensions(_FONT, text.text)[0]
    blf.position(_FONT, left, text.y * scale, 0.0)
    blf.draw(_FONT, text.text)


def _margins(area, scale):
    """What the toolbar at the left, the sidebar at the right, and the panel of the last operator in the lower
    left corner cover, in points."""
    regions = {region.type: region for region in area.regions if min(region.width, region.height) > 1}
    low = 0
    if "HUD" in regions and "WINDOW" in regions:
        low = regions["HUD"].y + regions["HUD"].height - regions["WINDOW"].y
    low = max(low, 0)  # it may have been moved out of the window
    if 2 * low > area.height:  # unfolded: a legend above it would have no room
        low = 0
    if not bpy.context.preferences.system.use_region_overlap:
        return 0.0, 0.0, low / scale
    left, right = (regions[kind].width if kind in regions else 0 for kind in ("TOOLS", "UI"))
    return left / scale, right / scale, low / scale


def pixel_matrix(width, height):
    """(4, 4): from pixels to the picture, as handlers of Blender find it."""
    return Matrix(((2 / width, 0, 0, -1), (0, 2 / height, 0, -1), (0, 0, 1, 0), (0, 0, 0, 1)))


handler = DrawHandler(draw, "POST_PIXEL")
