# SPDX-License-Identifier: GPL-3.0-or-later
"""DXF of shapes: triangles as 3DFACE, a layer for each part in the color of its property."""

from __future__ import annotations

from collections.abc import Sequence
from typing import BinaryIO

import numpy as np

from ...base.text import Step
from ...drawing.drawing import BLACK
from ...drawing.dxf_file import ZERO_LAYER, entities, layer_name
from ..encodings.text_rows import write_rows
from .shape_parts import Part

_FACE = "  0\n3DFACE\n  8\n{layer}\n" + "".join(
    f" 1{corner}\n%r\n 2{corner}\n%r\n 3{corner}\n%r\n" for corner in range(4)
)


def write_dxf_faces(parts: Sequence[Part], file: BinaryIO, step: Step) -> None:
    """Writes parts."""
    layers = {ZERO_LAYER: BLACK}
    for part in parts:
        layers[layer_name(part.name, layers)] = part.color
    bounds = np.zeros((2, 3))
    if parts:
        places = np.concatenate([part.vertices for part in parts])
        bounds = np.array([places.min(axis=0), places.max(axis=0)])
    with entities(file, bounds, layers):
        for number, (part, layer) in enumerate(zip(parts, list(layers)[1:], strict=True), 1):
            corners = part.vertices[part.triangles[:, [0, 1, 2, 2]]]  # a triangle repeats its last corner
            write_rows(file, _FACE.format(layer=layer), corners.reshape(-1, 12), ends="")
            step(number / len(parts))
    step(1.0)
