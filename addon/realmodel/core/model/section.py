# SPDX-License-Identifier: GPL-3.0-or-later
"""Sections and fences, and their files."""

from __future__ import annotations

from io import BytesIO
from pathlib import Path

from ..drawing.svg import write_svg
from ..exporters import SECTION
from ..results.sections.section_data import FenceData, SectionData
from ..results.sections.section_drawing import draw_section


class Section(SectionData):
    """Convex polygons on a cutter."""

    def save(self, path: str | Path, exaggeration: float = 1.0, hole_width: float = 0.0) -> None:
        """Writes the polygons, with block and property, to a file in the format of its ending, or a drawing
        of them to a .svg, .dxf or .png. exaggeration: of heights in drawings. hole_width: drawings have the
        boreholes within this distance of the section, model units. The file appears whole or not at all.
        Raises UsageError, OutputFailed."""
        SECTION.save(self, path, exaggeration=exaggeration, hole_width=hole_width)

    def _repr_svg_(self) -> str | None:
        """The drawing that `save` writes; None where there is none, as of the section by a surface."""
        if not len(self) or not (self.plane or isinstance(self, FenceData)):
            return None
        file = BytesIO()
        write_svg(draw_section(self), file)
        return file.getvalue().decode()


class Fence(Section, FenceData):
    """Vertical sections along a polyline in plan."""
