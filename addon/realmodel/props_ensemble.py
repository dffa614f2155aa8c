# SPDX-License-Identifier: GPL-3.0-or-later
"""The ensemble of a model: `scene.realmodel.ensemble`."""

import bpy
from bpy.props import EnumProperty, IntProperty, PointerProperty, StringProperty

from . import props_slider
from .bl import changes
from .bl.display import ensembles

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
        description="What the colors of the section show",
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
    return props_slider.name_of(count) if 2 <= count <= _MOST_OF_SLIDER else None


RealModelRealization = props_slider.slider_group(
    "RealModelRealization",
    lambda group: group.ensemble,
    "realization",
    range(2, _MOST_OF_SLIDER + 1),
    name="Realization",
    description="The realization that is shown",
    min=1,
)
