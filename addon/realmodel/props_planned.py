# SPDX-License-Identifier: GPL-3.0-or-later
"""A planned hole: a row of `scene.realmodel.planned_holes`."""

import bpy
from bpy.props import FloatProperty, StringProperty

from .bl import changes
from .bl.objects.stored_arrays import ArraysProperty
from .bl.scene import planned_holes
from .props_coordinates import coordinate_field


def _collar_field(name, axis):
    return coordinate_field(
        name,
        axis,
        "Where the hole begins, in model coordinates",
        planned_holes.collar,
        planned_holes.move_collar,
    )


class RealModelPlannedHole(bpy.types.PropertyGroup):
    """Where a hole is planned, and what it meets."""

    name: StringProperty(name="Name", description="Name of the hole")
    collar = ArraysProperty()  # model coordinates in full
    east: _collar_field("East (x)", 0)
    north: _collar_field("North (y)", 1)
    height: _collar_field("Height (z)", 2)
    azimuth: FloatProperty(
        name="Azimuth",
        description="Degrees clockwise from north",
        soft_min=0.0,
        soft_max=360.0,
        precision=1,
        options=set(),
        update=changes.planned_hole,
    )
    dip: FloatProperty(
        name="Dip",
        description="Degrees below the horizontal; 90 is straight down",
        default=90.0,
        min=-90.0,
        max=90.0,
        precision=1,
        options=set(),
        update=changes.planned_hole,
    )
    length: FloatProperty(
        name="Length",
        description="Length along the hole",
        default=100.0,
        min=0.001,
        subtype="DISTANCE",
        options=set(),
        update=changes.planned_hole,
    )
    exact = ArraysProperty()
    result: StringProperty(options={"HIDDEN"})  # JSON: what it meets, as bl/scene/planned_holes.py keeps it
    shares = ArraysProperty()  # the probability of each block along it
