# SPDX-License-Identifier: GPL-3.0-or-later
"""The settings of a rock mass: its region, the mesh that surfaces are interpolated on, its surfaces."""

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

from . import props_series, props_surface
from .bl import changes
from .bl.objects.stored_arrays import ArraysProperty
from .bl.project import plan_mesh, settings
from .core.project.project import ROCK
from .core.settings.mesh_sizes import SIZE
from .props_schema import properties_of

_AT = (
    ("OUTLINE", "Outline", "Along the outline of the region and its holes"),
    ("CONSTRAINTS", "Constraints", "Along the constraint lines and at the constraint points"),
    ("OBJECT", "Object", "At the vertices and along the edges of a curve or mesh object"),
    ("STORED", "Coordinates", "At coordinates or lines from the project file"),
)


def _object(description, update=changes.setting):
    return PointerProperty(
        name="Object",
        type=bpy.types.Object,
        poll=settings.is_region_object,
        description=description,
        update=update,
    )


class RealModelSize(properties_of(SIZE), bpy.types.PropertyGroup):
    """A refinement: where the edges of the planar mesh are shorter than elsewhere."""

    at: EnumProperty(
        name="At",
        description="Where the mesh is refined",
        items=_AT,
        update=changes.setting,
        options=set(),
    )
    object: _object("Curve or mesh object, in plan")
    stored = ArraysProperty()  # a place [x, y] or a line, model coordinates
    exact = ArraysProperty()


class RealModelConstraint(bpy.types.PropertyGroup):
    """A constraint: edges and vertices that the planar mesh must contain."""

    object: _object(
        "Curve or mesh object, such as a river or a fault trace; the mesh contains its edges and loose "
        "vertices in plan"
    )


_SETTINGS = properties_of(
    ROCK,
    name=changes.name,
    edge_length=changes.edge_length,
    triangles=changes.triangles,
    use_base=changes.base,
)


class RealModelRock(_SETTINGS, bpy.types.PropertyGroup):
    """A rock mass: a region in plan and its surfaces, oldest first."""

    known_name: StringProperty(options={"HIDDEN"})
    region: PointerProperty(
        name="Region",
        type=bpy.types.Object,
        poll=settings.is_region_object,
        description="Curve or mesh object whose outline in plan bounds the rock mass; inner loops are holes",
        update=changes.region,
    )
    region_file: StringProperty(
        name="Region File",
        description="File with the outline of the rock mass, if no object is set (GeoJSON, WKT, shapefile, "
        "GeoPackage)",
        subtype="FILE_PATH",
        update=changes.region,
    )
    region_stored = ArraysProperty()
    region_stamp: StringProperty(options={"HIDDEN"})
    hole_picks = ArraysProperty()
    hole_ends = ArraysProperty()
    interval_values = ArraysProperty()  # the columns of tables of intervals
    ground: StringProperty(
        name="Ground",
        description="File with the heights of the ground: a raster, points or a mesh. The youngest surface, "
        "whichever it is, is made from it, where it is made from nothing else",
        subtype="FILE_PATH",
        update=changes.ground,
    )
    ground_is_raster: BoolProperty(options={"HIDDEN"})
    ground_stored = ArraysProperty()  # the data of its file
    ground_stamp: StringProperty(options={"HIDDEN"})
    map = ArraysProperty()  # on its ground
    observations = ArraysProperty()  # places and their blocks
    dips = ArraysProperty()  # of realmodel.core.Dips
    series: CollectionProperty(type=props_series.RealModelSeries)
    active_series: IntProperty(
        name="Active Series", description="The series whose settings are shown", options=set()
    )
    region_area: FloatProperty(options={"HIDDEN"}, default=-1.0)
    constraints: CollectionProperty(type=RealModelConstraint)
    constraints_stored = ArraysProperty()
    sizes: CollectionProperty(type=RealModelSize)
    edges_by: EnumProperty(
        name="Mesh Size From",
        description="How the size of the triangles is set on which surfaces are interpolated",
        items=plan_mesh.KINDS,
        default="LENGTH",
        update=changes.setting,
        options=set(),
    )
    surfaces: CollectionProperty(type=props_surface.RealModelSurface)
    active_surface: IntProperty(
        name="Active Surface",
        description="The surface whose settings are shown, counted from the oldest, 0",
        options=set(),
    )
    collection: PointerProperty(type=bpy.types.Collection, options={"HIDDEN"})
    interfaces: PointerProperty(type=bpy.types.Collection, options={"HIDDEN"})
    blocks: PointerProperty(type=bpy.types.Collection, options={"HIDDEN"})
    exact = ArraysProperty()
