# SPDX-License-Identifier: GPL-3.0-or-later
"""The settings of one surface; the options of every method come from props_method."""

import bpy
from bpy.props import (
    BoolProperty,
    CollectionProperty,
    EnumProperty,
    FloatProperty,
    IntProperty,
    PointerProperty,
    StringProperty,
)

from . import props_method, props_reading
from .bl import changes, settings
from .core.methods import DEFAULT_METHOD, METHODS
from .core.readers.mesh_file import MESH_FORMATS
from .core.rules import DEFAULT_RULE, RULES
from .core.variogram import VARIOGRAM_MODELS

SOURCES = (
    ("POINTS_FILE", "Points file", "Text file with x, y and z of points that the surface is laid through"),
    ("POINTS_OBJECT", "Points object", "The vertices of a mesh object are points of the surface"),
    ("MESH_OBJECT", "Mesh object", "A mesh object of the scene, with its modifiers, is the surface"),
    (
        "MESH_FILE",
        "Mesh file",
        f"File with the triangles of the surface ({', '.join(known.name for known in MESH_FORMATS)})",
    ),
    ("NONE", "No points", "For methods that make a surface without points: constant, parallel"),
)

_VARIOGRAMS = {
    "spherical": ("Spherical", "Rises straight, and ends at the range: for heights that change often"),
    "exponential": ("Exponential", "Rises ever more slowly: for rough heights"),
    "gaussian": (
        "Gaussian",
        "Begins level: for very smooth heights; many points near each other suit it ill",
    ),
    "cubic": ("Cubic", "Begins level and ends at the range: for smooth heights"),
    "matern32": ("Matern 3/2", "Between exponential and Gaussian, the rougher one"),
    "matern52": ("Matern 5/2", "Between exponential and Gaussian, the smoother one"),
}


def _items(names, labels=None):
    """Enum items; a name without a label of its own gets one made from it."""
    labels = labels or {}
    return [(name, *labels.get(name, (name.replace("_", " ").capitalize(), ""))) for name in names]


class RealModelStructure(bpy.types.PropertyGroup):
    """A part of a nested variogram: what it adds to the nugget and the other parts."""

    model: EnumProperty(
        name="Model",
        description="Shape of this part",
        items=_items(VARIOGRAM_MODELS, _VARIOGRAMS),
        update=changes.setting,
    )
    range: FloatProperty(
        name="Range",
        description="Distance beyond which this part adds nothing more",
        default=100.0,
        min=0.0,
        subtype="DISTANCE",
        update=changes.setting,
    )
    sill: FloatProperty(
        name="Sill",
        description="How much variance this part adds",
        default=1.0,
        min=0.0,
        update=changes.setting,
    )
    use_anisotropy: BoolProperty(
        name="Anisotropy",
        description="Its range is longer along one direction; off: as for the whole variogram",
        update=changes.setting,
    )
    ratio: FloatProperty(
        name="Ratio",
        description="How many times its range along the azimuth is longer than across",
        default=2.0,
        min=0.001,
        update=changes.setting,
    )
    azimuth: FloatProperty(
        name="Azimuth",
        description="Direction of its longest range, in degrees clockwise from north (+y)",
        update=changes.setting,
    )
    exact: StringProperty(options={"HIDDEN"})


class RealModelSurface(props_method.MethodSettings, props_reading.ReadingSettings, bpy.types.PropertyGroup):
    """A surface: where its shape comes from, its rule, and what lies beneath it."""

    name: StringProperty(name="Name", description="Name of the surface", update=changes.setting)
    source: EnumProperty(
        name="Source",
        description="Where the shape of the surface comes from",
        items=SOURCES,
        default="POINTS_FILE",
        update=changes.source,
    )
    filepath: StringProperty(
        name="File",
        description="File with the points or the mesh",
        subtype="FILE_PATH",
        update=changes.source,
    )
    object: PointerProperty(
        name="Object",
        type=bpy.types.Object,
        poll=settings.is_mesh_object,
        description="Mesh object that gives the points or the surface; modifiers on it count",
        update=changes.source,
    )
    interface: PointerProperty(type=bpy.types.Object, options={"HIDDEN"})
    interface_digest: StringProperty(options={"HIDDEN"})
    reading: StringProperty(options={"HIDDEN"})
    stored: StringProperty(options={"HIDDEN"})
    stored_stamp: StringProperty(options={"HIDDEN"})
    stored_mesh: StringProperty(options={"HIDDEN"})
    rule: EnumProperty(
        name="Rule",
        description="What the surface does to what is there when it comes",
        items=[(name, rule.label, rule.tip) for name, rule in RULES.items()],
        default=DEFAULT_RULE,
        update=changes.setting,
    )
    property_id: IntProperty(
        name="Property",
        description="ID, in the library, of what was deposited beneath this surface; 0: none",
        update=changes.setting,
    )
    block: StringProperty(
        name="Block",
        description="Name of the block beneath this surface; empty: the surface's name and 'block'",
        update=changes.setting,
    )
    hide: BoolProperty(
        name="Hide",
        description="Do not show this interface in the viewport; it is built all the same",
        update=changes.hide,
    )
    use_minimum_thickness: BoolProperty(
        name="Thinnest",
        description="Keep the surface at least so far above the next older one",
        update=changes.setting,
    )
    minimum_thickness: FloatProperty(
        name="Thinnest",
        description="Least distance above the next older surface",
        min=0.0,
        subtype="DISTANCE",
        update=changes.setting,
    )
    exact: StringProperty(options={"HIDDEN"})
    figures: StringProperty(options={"HIDDEN"})

    method: EnumProperty(
        name="Method",
        description="How heights are made from the points",
        items=[(name, method.label, method.tip) for name, method in METHODS.items()],
        default=DEFAULT_METHOD,
        update=changes.setting,
    )
    fit_variogram: BoolProperty(
        name="Fit the variogram",
        description="Fit the variogram to the points; switch it off to give your own",
        default=True,
        update=changes.setting,
    )
    variogram_model: EnumProperty(
        name="Variogram",
        description="Shape of the variogram",
        items=_items(VARIOGRAM_MODELS, _VARIOGRAMS),
        update=changes.setting,
    )
    variogram_range: FloatProperty(
        name="Range",
        description="Distance beyond which points tell nothing of each other",
        default=100.0,
        min=0.0,
        subtype="DISTANCE",
        update=changes.setting,
    )
    variogram_sill: FloatProperty(
        name="Sill",
        description="Variance between points farther apart than the range; it includes the nugget",
        default=1.0,
        min=0.0,
        update=changes.setting,
    )
    variogram_nugget: FloatProperty(
        name="Nugget",
        description="Variance between points at one place; 0 honours every point",
        min=0.0,
        update=changes.setting,
    )
    structures: CollectionProperty(type=RealModelStructure)
    use_anisotropy: BoolProperty(
        name="Anisotropy",
        description=(
            "Points along one direction are more alike than across it. Off: found together with a variogram "
            "that is fitted, else the same in all directions"
        ),
        update=changes.setting,
    )
    anisotropy_ratio: FloatProperty(
        name="Ratio",
        description="How many times the range along the azimuth is longer than across",
        default=2.0,
        min=0.001,
        update=changes.setting,
    )
    anisotropy_azimuth: FloatProperty(
        name="Azimuth",
        description="Direction of the longest range, in degrees clockwise from north (+y)",
        update=changes.setting,
    )
    other_options: StringProperty(options={"HIDDEN"})


CLASSES = (RealModelStructure, RealModelSurface)
