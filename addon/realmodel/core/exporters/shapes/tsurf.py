# SPDX-License-Identifier: GPL-3.0-or-later
"""GOCAD TSurf: an object for each part, one after another, z upward."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import BinaryIO

import numpy as np

from ..encodings.text_rows import write_rows
from .shape_parts import Part

_HEAD = """GOCAD TSurf 1
HEADER {{
name:{name}
*solid*color:{red:.6g} {green:.6g} {blue:.6g} 1
}}
GOCAD_ORIGINAL_COORDINATE_SYSTEM
NAME Default
AXIS_NAME "X" "Y" "Z"
AXIS_UNIT "{unit}" "{unit}" "{unit}"
ZPOSITIVE Elevation
END_ORIGINAL_COORDINATE_SYSTEM
TFACE
"""


def write_tsurf(
    parts: Sequence[Part], file: BinaryIO, step: Callable[[float], None], unit: str = "m"
) -> None:
    """Writes parts. unit: of their coordinates."""
    for number, part in enumerate(parts, 1):
        red, green, blue = part.color
        file.write(_HEAD.format(name=part.name, red=red, green=green, blue=blue, unit=unit).encode())
        write_rows(file, "VRTX %d %r %r %r", np.arange(1, len(part.vertices) + 1), part.vertices)
        write_rows(file, "TRGL %d %d %d", part.triangles + 1)
        file.write(b"END\n")
        step(number / len(parts))
    step(1.0)
