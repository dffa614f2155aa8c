# SPDX-License-Identifier: GPL-3.0-or-later
"""Drawings of the core as images of Blender, and the image editor that shows one."""

import bpy
import numpy as np

from ...core.drawing.png import rasterize

_SCALE = 2.0  # pixels per point


def image_of(name, drawing):
    """The image of a name, with a Drawing in it; what it showed before is replaced, also where it is open."""
    pixels = rasterize(drawing, _SCALE)[::-1]
    size = pixels.shape[1], pixels.shape[0]
    image = bpy.data.images.get(name) or bpy.data.images.new(name, *size)
    if tuple(image.size) != size:
        image.scale(*size)
    image.pixels.foreach_set(np.ascontiguousarray(pixels).ravel())
    image.update()
    image.pack()
    return image


def show(context, image):
    """Shows an image in the first image editor there is, else in a new window; in background mode nowhere."""
    if bpy.app.background:
        return
    windows = context.window_manager.windows
    areas = [area for window in windows for area in window.screen.areas if area.type == "IMAGE_EDITOR"]
    if not areas:
        bpy.ops.wm.window_new()
        areas = [windows[-1].screen.areas[0]]
        areas[0].type = "IMAGE_EDITOR"
    areas[0].spaces.active.image = image
