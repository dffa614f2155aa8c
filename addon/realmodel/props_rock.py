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

from . import props_surface
from .bl import changes, plan_mesh, settings
from .core.meshers import DEFAULT_MESHER, MESHERS

_AT = (
    ("OUTLINE", "Outline", "Along the outline of the region and its holes"),
    ("CONSTRAINTS", "Constraints", "Along the constraint lines and at the constraint points"),
    ("OBJECT", "Object", "At the vertices and along the edges of a curve or mesh object"),
    ("STORED", "Coordinates", "At coordinates or lines from the project file"),
)


class RealModelSize(bpy.types.PropertyGroup):
    """A refinement: where the edges of the planar mesh are shorter than elsewhere."""

    at: EnumProperty(
        name="At",
        description="Where the mesh is refined",
        items=_AT,
        update=changes.setting,
        options=set(),
    )
    object: PointerProperty(
        name="Object",
        type=bpy.types.Object,
        poll=settings.is_region_object,
        description="Curve or mesh object, in plan",
        update=changes.setting,
    )
    stored: StringProperty(options={"HIDDEN"})  # JSON: places [x, y] or lines, model coordinates
    length: FloatProperty(
        name="Length",
        description="Edge length there",
        default=1.0,
        min=1e-6,
        subtype="DISTANCE",
        update=changes.setting,
        options=set(),
    )
    distance: FloatProperty(
        name="Influence Distance",
        description="Distance within which edges are this short; beyond, they grow by a quarter of it",
        min=0.0,
        subtype="DISTANCE",
        update=changes.setting,
        options=set(),
    )
    exact: StringProperty(options={"HIDDEN"})


class RealModelConstraint(bpy.types.PropertyGroup):
    """A constraint: edges and vertices that the planar mesh must contain."""

    object: PointerProperty(
        name="Object",
        type=bpy.types.Object,
        poll=settings.is_region_object,
        description="Curve or mesh object, such as a river or a fault trace; the mesh contains its edges and "
        "loose vertices in plan",
        update=changes.setting,
    )


class RealModelRock(bpy.types.PropertyGroup):
    """A rock mass: a region in plan and its surfaces, oldest first."""

    name: StringProperty(name="Name", description="Name of the rock mass", update=changes.setting)
    region: PointerProperty(
        name="Region",
        type=bpy.types.Object,
        poll=settings.is_region_object,
        description=(
            "Curve or mesh object whose outline in plan bounds the rock mass; inner loops are holes"
        ),
        update=changes.region,
    )
    region_file: StringProperty(
        name="Region File",
        description="File with the outline of the rock mass, if no object is set (GeoJSON, WKT, shapefile, "
        "GeoPackage)",
        subtype="FILE_PATH",
        update=changes.region,
    )
    region_stored: StringProperty(options={"HIDDEN"})
    region_stamp: StringProperty(options={"HIDDEN"})
    constraints: CollectionProperty(type=RealModelConstraint)
    constraints_stored: StringProperty(options={"HIDDEN"})
    sizes: CollectionProperty(type=RealModelSize)
    mesh_options: StringProperty(
        options={"HIDDEN"}
    )  # JSON: "triangles", and "edge_length" where it is "auto"
    region_area: FloatProperty(options={"HIDDEN"}, default=-1.0)
    edges_by: EnumProperty(
        name="Mesh Size From",
        description="How the size of the triangles is set on which surfaces are interpolated",
        items=plan_mesh.KINDS,
        options={"SKIP_SAVE"},  # it is kept in `edge_length` and `mesh_options`
        get=plan_mesh.kind,
        set=plan_mesh.set_kind,
    )
    triangles: IntProperty(
        name="Triangles",
        description="Number of triangles of the planar mesh, within 5 %",
        min=1,
        options={"SKIP_SAVE"},
        get=plan_mesh.triangles,
        set=plan_mesh.set_triangles,
    )
    edge_length: FloatProperty(
        name="Edge Length",
        description=(
            "Edge length of the triangles on which surfaces are interpolated; 0: not set. "
            "Half the length gives four times as many triangles"
        ),
        min=0.0,
        subtype="DISTANCE",
        update=changes.setting,
        options=set(),
    )
    mesher: EnumProperty(
        name="Mesher",
        description="Algorithm that divides the region into triangles",
        items=[(name, mesher.label, mesher.tip) for name, mesher in MESHERS.items()],
        default=DEFAULT_MESHER,
        update=changes.setting,
        options=set(),
    )
    base_elevation: FloatProperty(
        name="Base Elevation",
        description="Elevation of the flat base of the oldest block; below all surfaces",
        subtype="DISTANCE",
        update=changes.base_elevation,
        options=set(),
    )
    use_base: BoolProperty(
        name="Base",
        description="Add a block between the oldest surface and the base elevation",
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
    exact: StringProperty(options={"HIDDEN"})


CLASSES = (RealModelSize, RealModelConstraint, RealModelRock)
