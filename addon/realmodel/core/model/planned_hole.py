# SPDX-License-Identifier: GPL-3.0-or-later
"""Planned holes of a finished model, and their files."""

from __future__ import annotations

from pathlib import Path

from ..cells.model_data import ModelData
from ..exporters import PLANNED_HOLE
from ..results.model_holes import (
    HoleAxis,
    PlannedHoleData,
    contacts_between,
    intervals_on,
    on_surfaces,
    remarks_on,
)
from .cutting import section


class PlannedHole(PlannedHoleData):
    """What a planned hole meets, and how certain that is."""

    def save(self, path: str | Path) -> None:
        """Writes the `rows` to a .csv: lengths in model units, empty where nothing is known. With an ensemble
        columns with the probability of each block follow, on average over the interval. The file appears
        whole or not at all. Raises UsageError, OutputFailed."""
        PLANNED_HOLE.save(self, path)


def planned_hole(
    model: ModelData,
    collar: tuple[float, float, float],
    azimuth: float = 0.0,
    dip: float = 90.0,
    length: float = 100.0,
) -> PlannedHole:
    """What a straight hole would meet: the blocks by depth along it, and the contacts with the surfaces that
    they lie on. Where the heights of a surface have a variance (kriging), its contacts have a standard
    deviation, and where its data show no variogram `remarks` say what is missing; See also
    Ensemble.planned_hole.

    collar: (x, y, z), model units, also beside or above the model. azimuth: degrees clockwise from north
    (+y). dip: degrees below the horizontal, 90 straight down. Raises UsageError, BuildFailed.

    >>> hole = model.planned_hole((0.5, 1.0, 6.0), azimuth=90, dip=45, length=8)
    >>> [(hole.block_names[each.block], round(each.begin, 3)) for each in hole.intervals]
    [('soil', 3.182), ('sand', 4.243)]
    """
    axis = HoleAxis(collar, azimuth, dip, length)
    east, north = axis.heading.tolist()
    vertical_section = section(model, axis.collar, (north, -east, 0.0), threads=model.threads)
    intervals = intervals_on(vertical_section, axis)
    contacts = on_surfaces(model, contacts_between(intervals, axis), axis)
    return PlannedHole(
        axis,
        intervals,
        contacts,
        [block.name for block in model.blocks],
        [block.property for block in model.blocks],
        model.project.units,
        remarks_on(model, contacts),
    )
