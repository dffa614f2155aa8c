# SPDX-License-Identifier: GPL-3.0-or-later
"""Sections and fences, and their files."""

from __future__ import annotations

from io import BytesIO
from pathlib import Path

from ..base.atomic import Outputs
from ..drawing.svg import write_svg
from ..exporters.sections import section_writer
from ..results.sections.section_data import FenceData, SectionData
from ..results.sections.section_drawing import draw_section


class Section(SectionData):
    """Convex polygons on a cutter."""

    def save(self, path: str | Path, exaggeration: float = 1.0, hole_width: float = 0.0) -> None:
        """Writes the polygons, with block and property, to a file in the format of its ending, or a drawing
        of them to a .svg, .dxf or .png. exaggeration: of heights in drawings. hole_width: drawings have the
        boreholes within this distance of the section, model units. The file appears whole or not at all.
        Raises UsageError, OutputFailed."""
        writer = section_writer(path, exaggeration, hole_width)
        with Outputs() as outputs, outputs.file(path) as file:
            writer(self, file)

    def _repr_svg_(self) -> str | None:
        """The drawing that `save` writes; None where there is none, as of the section by a surface."""
        if not len(self) or not (self.plane or isinstance(self, FenceData)):
            return None
        file = BytesIO()
        write_svg(draw_section(self), file)
        return file.getvalue().decode()


class Fence(Section, FenceData):
    """Vertical sections along a polyline in plan."""
