# SPDX-License-Identifier: GPL-3.0-or-later
"""The blocks of a model as Blender's meshes take them. Nothing here touches Blender."""

import numpy as np

from .origin import offsets_from


def of_model(model, origin):
    """For each block of a model the arrays that `meshes.new_mesh` takes (coordinates, offsets, corners,
    face_surface); None where it has no cells.

    model: realmodel.core.Model. origin: (3,) float64, the model origin.
    """
    shapes = []
    for number, block in enumerate(model.blocks):
        shell = model.block_boundary(number) if block.cells else None
        shapes.append(
            None
            if shell is None
            else (
                offsets_from(origin, shell.vertices),
                shell.face_offsets.astype(np.int32),
                shell.face_vertices,
                shell.face_surface,
            )
        )
    return shapes


def by_name(model, shapes):
    """{(rock mass, block): arrays} of the blocks that have a shape."""
    return {
        (model.project.rocks[block.rock].name, block.name): arrays
        for block, arrays in zip(model.blocks, shapes, strict=True)
        if arrays is not None
    }


def bounds(shapes):
    """(3,) float64 twice: the lowest and highest coordinates of all shapes; zeros where there are none."""
    found = [arrays[0] for arrays in shapes if arrays is not None and len(arrays[0])]
    if not found:
        return np.zeros(3), np.zeros(3)
    low = [min(float(part[:, axis].min()) for part in found) for axis in range(3)]
    high = [max(float(part[:, axis].max()) for part in found) for axis in range(3)]
    return np.array(low), np.array(high)


def polygons(shapes):
    """How many polygons there are in all."""
    return sum(len(arrays[1]) - 1 for arrays in shapes if arrays is not None)
