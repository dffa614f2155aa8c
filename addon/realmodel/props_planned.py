# SPDX-License-Identifier: GPL-3.0-or-later
"""Planned holes and the ensemble of a model: `scene.realmodel.planned_holes`, `scene.realmodel.ensemble`."""

import bpy
from bpy.props import EnumProperty, FloatProperty, IntProperty, PointerProperty, StringProperty

from . import props_view
from .bl import changes
from .bl.display import ensembles
from .bl.objects.stored_arrays import ArraysProperty
from .bl.scene import planned_holes
from .props_view import coordinate_field


def _collar_field(name, axis):
    return coordinate_field(
        name,
        axis,
        "Collar of the hole, in model coordinates",
        planned_holes.collar,
        planned_holes.move_collar,
    )


class RealModelPlannedHole(bpy.types.PropertyGroup):
    """Where a hole is planned, and what it meets."""

    name: StringProperty(name="Name", description="Name of the hole")
    collar = ArraysProperty()  # model coordinates in full
    east: _collar_field("East (x)", 0)
    north: _collar_field("North (y)", 1)
    height: _collar_field("Elevation (z)", 2)
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


MOST = 1000  # realizations; of more than 100 the panel has no slider
_MOST_OF_SLIDER = 100


class RealModelEnsemble(bpy.types.PropertyGroup):
    """Settings of an ensemble, and of its display."""

    realizations: IntProperty(
        name="Realizations",
        description="Number of builds of the model, each with other elevations between the points",
        default=40,
        min=2,
        max=MOST,
        soft_max=100,
        options=set(),
    )
    seed: IntProperty(
        name="Seed",
        description="Seed of the random numbers: another one gives other realizations",
        min=0,
        options=set(),
    )
    color_by: EnumProperty(
        name="Color By",
        description="Meaning of the colors of the section",
        items=ensembles.COLORS,
        update=changes.ensemble,
        options=set(),
    )
    block: StringProperty(
        name="Block",
        description="The block whose probability is shown",
        update=changes.ensemble,
        options=set(),
    )
    realization: IntProperty(
        name="Realization",
        description="The realization that is shown",
        default=1,
        min=1,
        max=MOST,
        update=changes.ensemble,
        options=set(),
    )
    object: PointerProperty(type=bpy.types.Object, options={"HIDDEN"})
    table: StringProperty(options={"HIDDEN"})  # JSON: what display.ensembles.table gives


def slider_of(count):
    """The slider of an ensemble of so many realizations; None where there is none."""
    return props_view.slider_name(count) if 2 <= count <= _MOST_OF_SLIDER else None


RealModelRealization = props_view.slider_group(
    "RealModelRealization",
    lambda group: group.ensemble,
    "realization",
    range(2, _MOST_OF_SLIDER + 1),
    name="Realization",
    description="The realization that is shown",
    min=1,
)
