# SPDX-License-Identifier: GPL-3.0-or-later
"""STL as text, the variant with names and all digits: a solid for each part."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import BinaryIO

import numpy as np

from ..encodings.text_rows import write_rows
from .shape_parts import Part

_FACET = (
    "facet normal %.6g %.6g %.6g\n outer loop\n"
    "  vertex %r %r %r\n  vertex %r %r %r\n  vertex %r %r %r\n endloop\nendfacet"
)


def write_stl(parts: Sequence[Part], file: BinaryIO, step: Callable[[float], None]) -> None:
    """Writes parts; the normal of a triangle without area is 0 0 0."""
    for number, part in enumerate(parts, 1):
        corners = part.vertices[part.triangles]
        normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        length = np.linalg.norm(normal, axis=1, keepdims=True)
        normal = np.divide(normal, length, out=np.zeros_like(normal), where=length > 0)
        file.write(f"solid {part.name}\n".encode())
        write_rows(file, _FACET, normal, corners.reshape(-1, 9))
        file.write(f"endsolid {part.name}\n".encode())
        step(number / len(parts))
    step(1.0)
