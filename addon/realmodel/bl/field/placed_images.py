# SPDX-License-Identifier: GPL-3.0-or-later
"""Images in their place: scanned sections and maps as image empties, which show in every kind of shading.
They are packed into the .blend."""

from dataclasses import dataclass

import bpy
import numpy as np
from mathutils import Matrix

from ...core import InputRefused
from ..objects import exaggeration
from ..project import project_settings, settings


@dataclass(frozen=True)
class Placing:
    """Where two pixels of an image are in the model: `pixels`, (x, y) each from its lower left corner; the
    second is the upper right corner where it is (0, 0). first, second: (x, y) in plan. heights: of a section
    those of the two pixels; of a map the one at which it lies, twice. is_section: whether the image stands
    upright along the line from first to second."""

    pixels: tuple
    first: tuple
    second: tuple
    heights: tuple
    is_section: bool

    def corner_and_sides(self, size):
        """(3,) each, model coordinates: the lower left corner of an image of size (width, height) pixels, and
        its lower and its left side. Raises InputRefused."""
        (x1, y1), second = self.pixels
        x2, y2 = second if any(second) else size
        first = np.asarray(self.first, np.float64)
        way = np.asarray(self.second, np.float64) - first
        low, high = self.heights
        if not way.any():
            raise InputRefused("both points are one", advice="give two points that are apart")
        if not self.is_section:
            if x1 == x2 and y1 == y2:
                raise InputRefused(
                    "both pixels are one", advice="give the pixels of two points that are apart"
                )
            turn = complex(*way) / complex(x2 - x1, y2 - y1)
            right = np.array([turn.real, turn.imag, 0.0])
            up = np.array([-turn.imag, turn.real, 0.0])
            corner = np.append(first, low) - x1 * right - y1 * up
            return corner, size[0] * right, size[1] * up
        if x1 == x2 or y1 == y2:
            what = "the pixels of a section are one above the other, or at one height"
            raise InputRefused(what, advice="give pixels that differ in x and in y")
        if low == high:
            raise InputRefused("both elevations are the same", advice="give two elevations of the section")
        right = np.append(way, 0.0) / (x2 - x1)
        up = np.array([0.0, 0.0, (high - low) / (y2 - y1)])
        corner = np.append(first, low) - x1 * right - y1 * up
        return corner, size[0] * right, size[1] * up


def place(scene, path, placing):
    """Adds an image to a scene; returns its object. Raises InputRefused."""
    try:
        image = bpy.data.images.load(str(path))
    except RuntimeError as error:
        raise InputRefused("it is no image that Blender reads", file=path) from error
    size = tuple(image.size)
    try:
        if not all(size):
            raise InputRefused("it is no image that Blender reads", file=path)
        corner, right, up = placing.corner_and_sides(size)
    except InputRefused:
        bpy.data.images.remove(image)
        raise
    image.pack()
    empty = bpy.data.objects.new(path.stem, None)
    empty.empty_display_type, empty.data = "IMAGE", image
    empty.empty_display_size, empty.empty_image_offset = 1.0, (0.0, 0.0)
    empty.use_empty_image_alpha, empty.color = True, (1.0, 1.0, 1.0, 0.6)
    empty.empty_image_depth = "FRONT"  # it runs through the blocks; what is drawn on it shows through it
    empty[settings.IMAGE] = True
    longest = max(size)  # is as long as the display size
    normal = np.cross(right, up)
    columns = (
        right * longest / size[0],
        up * longest / size[1],
        normal / np.linalg.norm(normal),
        corner - project_settings.model_origin(scene),
    )
    matrix = np.eye(4)
    matrix[:3] = np.column_stack(columns)
    empty.matrix_basis = Matrix(matrix)
    scene.collection.objects.link(empty)
    return empty


def plane_of(scene, item):
    """(point, normal) of a placed image in model coordinates, wherever it was moved since. Raises
    InputRefused."""
    matrix = exaggeration.true_matrix(item)
    normal = np.cross(matrix[:3, 0], matrix[:3, 1])
    length = np.linalg.norm(normal)
    if not length > 0:
        raise InputRefused(f"image '{item.name}' has no extent", advice="set its scale to 1")
    return matrix[:3, 3] + project_settings.model_origin(scene), normal / length
