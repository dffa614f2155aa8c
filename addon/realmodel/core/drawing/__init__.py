# SPDX-License-Identifier: GPL-3.0-or-later
"""Drawings for charts, sections, and legends, and the files that they are written to.

Comes in: polygons, lines, dots and texts in points. Goes out: pixels, or files in SVG, DXF and PNG.
"""

from __future__ import annotations

from pathlib import Path

from ..base.atomic import Outputs
from ..base.errors import UsageError
from .drawing import Drawing
from .dxf import write_dxf
from .png import write_png
from .svg import write_svg

WRITERS = {".svg": write_svg, ".dxf": write_dxf, ".png": write_png}


def save_drawing(drawing: Drawing, path: str | Path) -> None:
    """Writes a drawing to an SVG, DXF, or PNG file, which appears whole or not at all. Raises UsageError,
    OutputFailed."""
    ending = Path(path).suffix.lower()
    if ending not in WRITERS:
        raise UsageError(f"{path}: drawings are not written as '{ending}'; use one of {', '.join(WRITERS)}")
    with Outputs() as outputs, outputs.file(path) as file:
        WRITERS[ending](drawing, file)


__all__ = ["Drawing", "save_drawing"]
