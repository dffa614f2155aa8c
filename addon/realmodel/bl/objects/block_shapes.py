# SPDX-License-Identifier: GPL-3.0-or-later
"""The blocks of a model as meshes, by what they are blocks of. Nothing here touches Blender."""

import numpy as np


def by_name(model, shapes):
    """{(rock mass, block): PolygonMesh} of the blocks that have a shape. shapes: for each block of the model
    its PolygonMesh, or None."""
    return {
        (model.project.rocks[block.rock].name, block.name): shape
        for block, shape in zip(model.blocks, shapes, strict=True)
        if shape is not None
    }


def bounds(coordinates):
    """(3,) float64 twice: the lowest and highest of coordinates, arrays (V, 3); zeros if there are none."""
    parts = [part for part in coordinates if len(part)]
    if not parts:
        return np.zeros(3), np.zeros(3)
    low = [min(float(part[:, axis].min()) for part in parts) for axis in range(3)]
    high = [max(float(part[:, axis].max()) for part in parts) for axis in range(3)]
    return np.array(low), np.array(high)
