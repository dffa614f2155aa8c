# SPDX-License-Identifier: GPL-3.0-or-later
"""Drawings for charts, sections, and legends, and the files that they are written to.

Input: polygons, lines, dots and texts in points. Output: pixels, or files in SVG, PDF, DXF and PNG.
"""

from __future__ import annotations

from pathlib import Path

from ..base.atomic import Outputs
from ..base.formats import Format, by_ending
from ..base.text import no_step
from .drawing import Drawing
from .dxf_file import write_dxf
from .pdf import write_pdf
from .png import write_png
from .svg import write_svg

_OPTIONS = ("exaggeration", "hole_width", "hole_column", "net")
DRAWINGS = (
    Format(".svg", "SVG", ("drawing",), "Scalable drawing, for documents and web pages", write_svg, _OPTIONS),
    Format(".pdf", "PDF", ("drawing",), "Page to print, with searchable text", write_pdf, _OPTIONS),
    Format(".dxf", "DXF", ("drawing",), "Lines on layers, for CAD programs", write_dxf, _OPTIONS),
    Format(".png", "PNG", ("drawing",), "Picture, 200 dots per inch", write_png, _OPTIONS),
)


def save_drawing(drawing: Drawing, path: str | Path) -> None:
    """Writes a drawing to an SVG, PDF, DXF, or PNG file, which appears whole or not at all. Raises
    UsageError, OutputFailed."""
    drawing_format = by_ending(path, DRAWINGS, "drawings are not written as {}")
    with Outputs() as outputs, outputs.file(path) as file:
        drawing_format.write(drawing, file, no_step)


__all__ = ["Drawing", "save_drawing"]
