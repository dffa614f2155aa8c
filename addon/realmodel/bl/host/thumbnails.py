# SPDX-License-Identifier: GPL-3.0-or-later
"""Square pictures that come with the add-on, those of one file beside one another in it."""

from pathlib import Path

import bpy
import bpy.utils.previews
import numpy as np

_FOLDER = Path(__file__).parents[2] / "previews"
_icons = None  # previews by their file and number


def pictures(name):
    """(pictures, side, side, 4) float32 of a file, the bottom row first."""
    image = bpy.data.images.load(str(_FOLDER / name))
    try:
        width, side = image.size
        pixels = np.empty(4 * width * side, np.float32)
        image.pixels.foreach_get(pixels)
    finally:
        bpy.data.images.remove(image)
    return np.ascontiguousarray(pixels.reshape(side, width // side, side, 4).swapaxes(0, 1))


def icon(name, number):
    """The icon of one picture of a file, which Blender keeps until `forget`."""
    global _icons
    if _icons is None:
        _icons = bpy.utils.previews.new()
    key = f"{name} {number}"
    if key not in _icons:
        for index, shown in enumerate(pictures(name)):
            preview = _icons.new(f"{name} {index}")
            preview.image_size = shown.shape[1], shown.shape[0]
            preview.image_pixels_float.foreach_set(shown.ravel())
    return _icons[key].icon_id


def forget():
    """Gives the icons back: the add-on is disabled."""
    global _icons
    if _icons is not None:
        bpy.utils.previews.remove(_icons)
        _icons = None
