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
    ("POINTS_FILE", "Points File", "File with the points that the surface is interpolated from"),
    ("POINTS_OBJECT", "Points Object", "The surface is interpolated from the vertices of a mesh object"),
    ("MESH_OBJECT", "Mesh Object", "A mesh object, with its modifiers, is the surface"),
    (
        "MESH_FILE",
        "Mesh File",
        f"File with the triangles of the surface ({', '.join(known.name for known in MESH_FORMATS)})",
    ),
    ("NONE", "No Points", "For the methods that need no points: Constant and Parallel"),
)

_VARIOGRAMS = {
    "spherical": ("Spherical", "Linear at the origin, reaches the sill at the range: for rough elevations"),
    "exponential": ("Exponential", "Linear at the origin, approaches the sill: for rough elevations"),
    "gaussian": (
        "Gaussian",
        "Parabolic at the origin: for very smooth elevations; unstable with many close points",
    ),
    "cubic": ("Cubic", "Parabolic at the origin, reaches the sill at the range: for smooth elevations"),
    "matern32": ("Matern 3/2", "Between exponential and Gaussian, rougher than Matern 5/2"),
    "matern52": ("Matern 5/2", "Between exponential and Gaussian, smoother than Matern 3/2"),
}


def _items(names, labels=None):
    """Enum items; a name without a label of its own gets one made from it."""
    labels = labels or {}
    return [(name, *labels.get(name, (name.replace("_", " ").capitalize(), ""))) for name in names]


class RealModelStructure(bpy.types.PropertyGroup):
    """A structure of a nested variogram, added to the nugget and the other structures."""

    model: EnumProperty(
        name="Model",
        description="Model of this structure",
        items=_items(VARIOGRAM_MODELS, _VARIOGRAMS),
        update=changes.setting,
        options=set(),
    )
    range: FloatProperty(
        name="Range",
        description="Practical range of this structure",
        default=100.0,
        min=0.0,
        subtype="DISTANCE",
        update=changes.setting,
        options=set(),
    )
    sill: FloatProperty(
        name="Sill",
        description="Variance that this structure contributes",
        default=1.0,
        min=0.0,
        update=changes.setting,
        options=set(),
    )
    use_anisotropy: BoolProperty(
        name="Anisotropy",
        description="Give this structure its own anisotropy; off: that of the variogram",
        update=changes.setting,
        options=set(),
    )
    ratio: FloatProperty(
        name="Ratio",
        description="Range along the azimuth divided by the range across it",
        default=2.0,
        min=0.001,
        update=changes.setting,
        options=set(),
    )
    azimuth: FloatProperty(
        name="Azimuth",
        description="Direction of the longest range, in degrees clockwise from north (+Y)",
        update=changes.setting,
        options=set(),
    )
    exact: StringProperty(options={"HIDDEN"})


class RealModelSurface(props_method.MethodSettings, props_reading.ReadingSettings, bpy.types.PropertyGroup):
    """A surface: the source of its shape, its rule, and the block beneath it."""

    name: StringProperty(name="Name", description="Name of the surface", update=changes.setting)
    source: EnumProperty(
        name="Source",
        description="Source of the shape of the surface",
        items=SOURCES,
        default="POINTS_FILE",
        update=changes.source,
        options=set(),
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
        description="Mesh object with the points or the surface, with its modifiers",
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
        description="What the surface does to the rock that was there before",
        items=[(name, rule.label, rule.tip) for name, rule in RULES.items()],
        default=DEFAULT_RULE,
        update=changes.setting,
        options=set(),
    )
    property_id: IntProperty(
        name="Property",
        description="Library ID of the rock deposited beneath this surface; 0: none",
        update=changes.setting,
        options=set(),
    )
    block: StringProperty(
        name="Block",
        description='Name of the block beneath this surface; empty: the name of the surface and "block"',
        update=changes.setting,
    )
    hide: BoolProperty(
        name="Hide",
        description="Hide this interface in the viewport; it is still built",
        update=changes.hide,
        options=set(),
    )
    use_minimum_thickness: BoolProperty(
        name="Minimum Thickness",
        description="Keep the surface at least this far above the next older one",
        update=changes.setting,
        options=set(),
    )
    minimum_thickness: FloatProperty(
        name="Minimum Thickness",
        description="Minimum distance above the next older surface",
        min=0.0,
        subtype="DISTANCE",
        update=changes.setting,
        options=set(),
    )
    exact: StringProperty(options={"HIDDEN"})
    figures: StringProperty(options={"HIDDEN"})

    method: EnumProperty(
        name="Method",
        description="How elevations are interpolated from the points",
        items=[(name, method.label, method.tip) for name, method in METHODS.items()],
        default=DEFAULT_METHOD,
        update=changes.setting,
        options=set(),
    )
    fit_variogram: BoolProperty(
        name="Fit Variogram",
        description="Fit the variogram to the points; turn off to set your own",
        default=True,
        update=changes.setting,
        options=set(),
    )
    variogram_model: EnumProperty(
        name="Variogram",
        description="Variogram model",
        items=_items(VARIOGRAM_MODELS, _VARIOGRAMS),
        update=changes.setting,
        options=set(),
    )
    variogram_range: FloatProperty(
        name="Range",
        description="Practical range: the distance at which correlation vanishes",
        default=100.0,
        min=0.0,
        subtype="DISTANCE",
        update=changes.setting,
        options=set(),
    )
    variogram_sill: FloatProperty(
        name="Sill",
        description="Variance between points farther apart than the range, including the nugget",
        default=1.0,
        min=0.0,
        update=changes.setting,
        options=set(),
    )
    variogram_nugget: FloatProperty(
        name="Nugget",
        description="Variance at distance zero; 0: every point is honored",
        min=0.0,
        update=changes.setting,
        options=set(),
    )
    structures: CollectionProperty(type=RealModelStructure)
    use_anisotropy: BoolProperty(
        name="Anisotropy",
        description=(
            "Set a direction of longer correlation. Off: found with a fitted variogram, else isotropic"
        ),
        update=changes.setting,
        options=set(),
    )
    anisotropy_ratio: FloatProperty(
        name="Ratio",
        description="Range along the azimuth divided by the range across it",
        default=2.0,
        min=0.001,
        update=changes.setting,
        options=set(),
    )
    anisotropy_azimuth: FloatProperty(
        name="Azimuth",
        description="Direction of the longest range, in degrees clockwise from north (+Y)",
        update=changes.setting,
        options=set(),
    )
    other_options: StringProperty(options={"HIDDEN"})


CLASSES = (RealModelStructure, RealModelSurface)
