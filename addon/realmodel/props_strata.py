# SPDX-License-Identifier: GPL-3.0-or-later
"""The strata of an object: values of its modifier Strata, which Fill with Strata takes, too."""

import math

import bpy
from bpy.props import (
    BoolProperty,
    EnumProperty,
    FloatProperty,
    IntProperty,
    PointerProperty,
    StringProperty,
)

from .bl.shading import strata_modifier
from .core.filling import PALETTES
from .core.filling.erosion import MOST_FACES, MOST_STRENGTH
from .core.filling.strata import MOST_BEDS, MOST_FAULTS, MOST_PEGS, RECUMBENT, STEEPEST, UPRIGHT


def _share(name, description, default=0.0, most=10.0, soft=1.0):
    return FloatProperty(
        name=name, description=description, default=default, min=0.0, max=most, soft_max=soft, precision=3
    )


def _azimuth(name, description, default=0.0):
    return FloatProperty(
        name=name,
        description=f"{description}, clockwise from north, the Y axis",
        subtype="ANGLE",
        default=math.radians(default),
        soft_min=-2 * math.pi,
        soft_max=2 * math.pi,
    )


def with_update(prop, update):
    """A property that calls a function when it changes."""
    return prop.function(**prop.keywords, update=update)


VALUES = {
    "beds": IntProperty(name="Beds", description="Number", default=12, min=2, max=MOST_BEDS, soft_max=60),
    "thickness": _share(
        "Thickness",
        "Mean thickness of a bed, as a share of the height of the mesh. 0: the beds fill it. Otherwise the "
        "lowest and the highest bed fill the rest",
    ),
    "variation": FloatProperty(
        name="Variation",
        description="How much the beds differ in thickness",
        subtype="FACTOR",
        default=0.5,
        min=0.0,
        max=1.0,
    ),
    "dip": FloatProperty(
        name="Dip",
        description="Dip of the beds, before they are folded",
        subtype="ANGLE",
        default=math.radians(10),
        min=0.0,
        max=math.radians(STEEPEST),
    ),
    "dip_direction": _azimuth("Dip Direction", "Direction of the dip", 120.0),
    "fold_amplitude": _share("Fold Amplitude", "As a share of the height of the mesh; 0: no folds", soft=0.5),
    "fold_wavelength": _share("Fold Wavelength", "As a share of the width of the mesh; 0: no folds", 0.5),
    "fold_axis": _azimuth("Fold Axis", "Direction of the fold axes", 30.0),
    "axial_dip": FloatProperty(
        name="Axial Dip",
        description="Dip of the axial planes of folds: 90 upright, 10 recumbent. Folds lean to the right "
        "of their axis. Faults then strike at right angles to it",
        subtype="ANGLE",
        default=math.radians(UPRIGHT),
        min=math.radians(RECUMBENT),
        max=math.radians(UPRIGHT),
    ),
    "faults": IntProperty(
        name="Faults", description="Number", default=0, min=0, max=MOST_FAULTS, soft_max=10
    ),
    "throw": _share("Throw", "Throw of each fault, as a share of the height of the mesh", 0.1, soft=0.5),
    "fault_strike": _azimuth("Fault Strike", "Direction of the faults, which are vertical", 20.0),
    "unconformity": FloatProperty(
        name="Unconformity",
        description="Fraction of the height at which flat beds cover truncated ones. 0: none",
        subtype="FACTOR",
        default=0.0,
        min=0.0,
        max=0.95,
    ),
    "gap": _share(
        "Gap",
        "Gap between beds, and between the two sides of a fault, for a print in parts, as a share of the "
        "height",
        soft=0.05,
    ),
    "pegs": IntProperty(
        name="Pegs",
        description="Largest number of square pegs on each bed. Their holes in the next bed are wider by "
        "the gap on each side",
        default=0,
        min=0,
        max=MOST_PEGS,
        soft_max=6,
    ),
    "peg_size": _share("Peg Size", "Width of a peg, as a share of the height of the mesh", 0.1, soft=0.3),
    "base_depth": _share(
        "Base Depth",
        "For an open mesh: depth of the base below its lowest point, as a share of its height or of a "
        "tenth of its width",
        0.5,
    ),
    "palette": EnumProperty(
        name="Palette",
        description="Rocks of the beds",
        items=tuple(
            (key.upper(), key.title(), ", ".join(name for name, _ in rocks))
            for key, rocks in PALETTES.items()
        ),
    ),
    "rock_looks": BoolProperty(
        name="Rock Looks",
        description="Give the rocks procedural textures. Otherwise they have plain colors",
        default=True,
    ),
    "keep_materials": BoolProperty(
        name="Keep Materials",
        description="Faces of beds on the surface of the mesh have its materials. Otherwise all have that of "
        "their rock",
    ),
    "masks": BoolProperty(
        name="Bed Masks",
        description="Add a hidden copy of the mesh. Its vertices have attributes: the number of their bed, "
        "and a mask of each bed, 0 or 1",
    ),
    "seed": IntProperty(name="Seed", description="Other thicknesses, rocks, folds and faults", min=0),
    "erosion": BoolProperty(
        name="Erosion",
        description="Take off first what hard beds do not protect: these stand out as ledges, soft ones "
        "recede beneath them",
    ),
    "strength": FloatProperty(
        name="Strength",
        description="Depth of the erosion. 1: soft beds recede by about their mean thickness",
        default=1.0,
        min=0.0,
        max=MOST_STRENGTH,
        soft_max=3.0,
    ),
    "joints": FloatProperty(
        name="Joints",
        description="How much hard beds break into blocks at two sets of joints",
        default=1.0,
        min=0.0,
        max=2.0,
    ),
    "roughness": FloatProperty(
        name="Roughness", description="Bays, ribs and bumps", default=1.0, min=0.0, max=2.0
    ),
    "scree": FloatProperty(
        name="Scree",
        description="How high scree lies at the foot of walls. 1: about a third of their height",
        default=0.0,
        min=0.0,
        max=2.0,
    ),
    "stones": FloatProperty(
        name="Stones",
        description="Density of loose stones on the scree. Viewports show a quarter of them",
        default=1.0,
        min=0.0,
        soft_max=4.0,
    ),
    "faces": IntProperty(
        name="Faces",
        description="About how many triangles the eroded mesh has",
        default=300_000,
        min=1000,
        max=MOST_FACES,
        soft_max=1_500_000,
    ),
    "close_holes": BoolProperty(
        name="Close Holes",
        description="Close the holes of the mesh, each by triangles around its middle. Otherwise a mesh with "
        "holes is refused",
    ),
}


# how panels show them
BEDS = (
    ("palette", "rock_looks", "seed"),
    ("beds", "thickness", "variation", "dip", "dip_direction"),
    ("fold_amplitude", "fold_wavelength", "fold_axis", "axial_dip"),
    ("faults", "throw", "fault_strike"),
    ("unconformity",),
)
SHAPE, EROSION = (
    (("base_depth", "close_holes"),),
    (("strength", "joints", "roughness"), ("scree", "stones", "faces")),
)
SOLID = (("keep_materials", "masks", "gap", "pegs", "peg_size"),)


def values_of(values):
    """{name: value} of strata."""
    return {name: getattr(values, name) for name in VALUES}


def copy(values, item):
    """Gives an object the values of an operator, where they differ. Raises RealModelError."""
    before = values_of(item.realmodel_strata)
    differing = {name: value for name, value in values_of(values).items() if value != before[name]}
    if differing:
        strata_modifier.set_values(item, differing)


class RealModelStrata(bpy.types.PropertyGroup):
    """The strata of an object. beds_in: the collection of the beds that Fill with Strata has made of it.
    problem: why the last change had no effect."""

    __annotations__ = {
        **VALUES,
        **{name: with_update(VALUES[name], strata_modifier.changed) for name in strata_modifier.LAYING},
        "stones": with_update(VALUES["stones"], strata_modifier.stones_changed),
        "beds_in": PointerProperty(type=bpy.types.Collection, options={"HIDDEN"}),
        "problem": StringProperty(options={"HIDDEN"}),
    }


def register():
    bpy.utils.register_class(RealModelStrata)
    bpy.types.Object.realmodel_strata = PointerProperty(type=RealModelStrata, name="Strata")


def unregister():
    del bpy.types.Object.realmodel_strata
    bpy.utils.unregister_class(RealModelStrata)
