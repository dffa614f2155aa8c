# SPDX-License-Identifier: GPL-3.0-or-later
"""Stereonets of the dips that a model was built from."""

from __future__ import annotations

from pathlib import Path

from ..cells.model_data import ModelData
from ..exporters import STEREONET
from ..project.project import Project
from ..results.orientations.stereonet import EQUAL_AREA, StereonetData, dip_sets, normals_of
from ..surfaces.prepare import with_arrays


class Stereonet(StereonetData):
    """Dips on the lower hemisphere."""

    def save(self, path: str | Path, net: str = EQUAL_AREA) -> None:
        """Draws the stereonet to a .svg, .pdf, .dxf or .png, which appears whole or not at all. net:
        "equal_area" (Schmidt) or "equal_angle" (Wulff). Raises UsageError, OutputFailed."""
        STEREONET.save(self, path, net=net)


def stereonet(model: ModelData, of: str | None = None) -> Stereonet:
    """The dips that the model was built from, those that are switched off left out.

    of: the name of a surface, a block, a series, a rock mass, or a fault; None: all but those of faults.
    Raises UsageError where there are none; InputRefused for a model without its project.
    """
    model.require_project("a stereonet")
    return _of_read(model.project, of)


def _stereonet(project: Project, of: str | None = None) -> Stereonet:
    """The dips of this project, which needs no build: its tables are read. As of Model.stereonet; raises
    UsageError where there are none, InputRefused for what cannot be read."""
    return _of_read(with_arrays(project), of)


def _of_read(project: Project, of: str | None) -> Stereonet:
    return Stereonet(normals_of(dip_sets(project), of), of or project.name)


Project.stereonet = _stereonet
