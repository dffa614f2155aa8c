# SPDX-License-Identifier: GPL-3.0-or-later
"""Sections and fences, and their files."""

from __future__ import annotations

from pathlib import Path

from ..base.atomic import Outputs
from ..exporters.sections import section_writer
from ..results.section_data import FenceData, SectionData


class Section(SectionData):
    """Convex polygons on a cutter."""

    def save(self, path: str | Path, exaggeration: float = 1.0) -> None:
        """Writes the polygons, with block and property, to a file in the format of its ending, or a drawing
        of them to a .svg, .dxf or .png with exaggerated heights. The file appears whole or not at all. Raises
        UsageError, OutputFailed."""
        writer = section_writer(path, exaggeration)
        with Outputs() as outputs, outputs.file(path) as file:
            writer(self, file)


class Fence(Section, FenceData):
    """Vertical sections along a polyline in plan."""
