# SPDX-License-Identifier: GPL-3.0-or-later
"""PLY (Stanford polygon file), binary: triangles with the number of their part, its property and its
color."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import BinaryIO

import numpy as np

from .shape_parts import Part

_FACE = np.dtype(
    [("size", "u1"), ("corners", "<i4", 3), ("block", "<i4"), ("property", "<i4"), ("color", "u1", 3)]
)


def write_ply(parts: Sequence[Part], file: BinaryIO, step: Callable[[float], None]) -> None:
    """Writes parts; the names stand in comments, `comment block NUMBER NAME`."""
    vertices, faces = (
        (
            sum(len(a) for a in of)
            for of in zip(*((part.vertices, part.triangles) for part in parts), strict=True)
        )
        if parts
        else (0, 0)
    )
    lines = ["ply", "format binary_little_endian 1.0", "comment RealModel"]
    lines += [f"comment block {number} {part.name}" for number, part in enumerate(parts)]
    lines += [f"element vertex {vertices}", *(f"property double {axis}" for axis in "xyz")]
    lines += [f"element face {faces}", "property list uchar int vertex_indices"]
    lines += ["property int block", "property int property"]
    lines += [*(f"property uchar {name}" for name in ("red", "green", "blue")), "end_header", ""]
    file.write("\n".join(lines).encode())
    for part in parts:
        file.write(np.ascontiguousarray(part.vertices, "<f8"))
    step(0.5)
    first = 0
    for number, part in enumerate(parts):
        rows = np.zeros(len(part.triangles), _FACE)
        rows["size"] = 3
        rows["corners"] = part.triangles + first
        rows["block"] = number
        rows["property"] = part.property
        rows["color"] = np.rint(255 * np.array(part.color))
        file.write(rows)
        first += len(part.vertices)
    step(1.0)
