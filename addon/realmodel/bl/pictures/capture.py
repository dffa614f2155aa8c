# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of a viewport in any size: with a window as the viewport is seen, without one by a render of the
same view in the same display mode."""

import bpy
import numpy as np
from mathutils import Matrix

from ...core import InputRefused, OutputFailed
from ...core.base.atomic import Outputs
from ..display import drawing, modes, viewpoints
from ..objects import viewports
from ..overlay import WIDTH
from ..overlay import viewport as overlay
from . import batch, picture

LARGEST = 16384  # pixels along a side
_SAMPLES = 16


def write(context, path, size):
    """Writes a PNG. size: (width, height) in pixels. Raises OutputFailed where it cannot be written."""
    with Outputs() as outputs, outputs.path(path) as place:
        if bpy.app.background:
            _render(context, place, size)
        else:
            _draw(context, place, size)


def viewport(context):
    """(area, region, space) of the 3D viewport that is captured: the context's, or the largest one; None
    where there is none."""
    areas = list(viewports.areas())
    if context.area is not None and context.area.type == "VIEW_3D":
        areas = [context.area]
    if not areas:
        return None
    area = max(areas, key=lambda a: a.width * a.height)
    return area, next(region for region in area.regions if region.type == "WINDOW"), area.spaces.active


def _draw(context, path, size):
    """Draws the viewport into an offscreen picture."""
    import gpu

    viewport_parts = viewport(context)
    if viewport_parts is None:
        raise OutputFailed(f"{path}: there is no 3D viewport to capture; open one")
    _, region, space = viewport_parts
    view = space.region_3d
    view.update()  # its matrices may be of the last time it was drawn
    looking, frame = view.view_matrix.copy(), _window_matrix(region, view, size)
    try:
        target = gpu.types.GPUOffScreen(*size, format="RGBA8")
    except RuntimeError as error:
        raise OutputFailed(f"{path}: no picture of {size[0]} x {size[1]} pixels: {error}") from error
    try:
        target.draw_view3d(
            context.scene, context.view_layer, space, region, looking, frame, do_color_management=True
        )
        with target.bind():
            with gpu.matrix.push_pop(), gpu.matrix.push_pop_projection():
                gpu.matrix.load_matrix(looking)
                gpu.matrix.load_projection_matrix(frame)
                mode = context.scene.realmodel.display
                drawing.draw_items(modes.drawn(context.scene), mode, context.view_layer)
                gpu.matrix.load_matrix(Matrix.Identity(4))
                gpu.matrix.load_projection_matrix(overlay.pixel_matrix(*size))
                overlay.draw_for(context.scene, size, view, max(size) / WIDTH, projection=frame)
            pixels = gpu.state.active_framebuffer_get().read_color(0, 0, *size, 4, 0, "UBYTE")
            pixels.dimensions = size[0] * size[1] * 4
    finally:
        target.free()
    _save(np.array(pixels, np.uint8), path, size)


def _window_matrix(region, view, size):
    """The viewport's projection, widened to the right and left, or above and below, for a picture of another
    aspect ratio."""
    matrix = view.window_matrix.copy()
    wider = (size[0] / size[1]) / (region.width / region.height)
    if wider >= 1.0:
        return Matrix.Diagonal((1.0 / wider, 1.0, 1.0, 1.0)) @ matrix
    return Matrix.Diagonal((1.0, wider, 1.0, 1.0)) @ matrix


def _save(pixels, path, size):
    image = bpy.data.images.new("RealModel capture", *size, alpha=False)
    try:
        image.colorspace_settings.name = "sRGB"
        flat = pixels.astype(np.float32) / 255.0
        flat[3::4] = 1.0
        image.pixels.foreach_set(flat)
        image.filepath_raw, image.file_format = str(path), "PNG"
        image.save()
    except RuntimeError as error:
        raise OutputFailed(f"{path}: {' '.join(str(error).split())}") from error
    finally:
        bpy.data.images.remove(image)


def _render(context, path, size):
    """Renders the view of the first viewport of the screens, in a copy of the scene."""
    scene = context.scene
    points = viewpoints.model_points(scene)
    if not modes.shows_something(scene):
        raise InputRefused("nothing is visible", advice="build a model")
    spaces = viewports.spaces(context)
    try:
        with picture.discard_scene(scene.copy()) as stage:
            for obj in [obj for obj in stage.collection.objects if picture.KEY in obj]:
                stage.collection.objects.unlink(obj)
            stage.world = None
            picture.set_up(stage, points, size, spaces[0] if spaces else None, sun=None)
            picture.set_renderer(stage, path, size, _SAMPLES, picture.TIME_LIMIT)
            with batch.silenced_stdout():
                bpy.ops.render.render(write_still=True, scene=stage.name)
    except RuntimeError as error:
        raise OutputFailed(f"{path}: {' '.join(str(error).split())}") from error
