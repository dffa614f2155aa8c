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
    ("CONSTRAINTS", "Constraints", "Along the lines and at the points that the mesh must contain"),
    ("OBJECT", "Object", "At the vertices and along the edges of a curve or mesh object"),
    ("STORED", "Places", "At places or lines that came with the project file"),
)


class RealModelSize(bpy.types.PropertyGroup):
    """Where the edges of the region's mesh are shorter than elsewhere."""

    at: EnumProperty(
        name="At", description="Where the triangles are smaller", items=_AT, update=changes.setting
    )
    object: PointerProperty(
        name="Object",
        type=bpy.types.Object,
        poll=settings.is_region_object,
        description="Curve or mesh object, seen from above",
        update=changes.setting,
    )
    stored: StringProperty(options={"HIDDEN"})  # JSON: places [x, y] or lines, model coordinates
    length: FloatProperty(
        name="Length",
        description="Length of the edges there",
        default=1.0,
        min=1e-6,
        subtype="DISTANCE",
        update=changes.setting,
    )
    distance: FloatProperty(
        name="Within",
        description="How far from there edges are so short; beyond, they grow by a quarter of the distance",
        min=0.0,
        subtype="DISTANCE",
        update=changes.setting,
    )
    exact: StringProperty(options={"HIDDEN"})


class RealModelConstraint(bpy.types.PropertyGroup):
    """What the region's mesh must contain as edges and vertices."""

    object: PointerProperty(
        name="Object",
        type=bpy.types.Object,
        poll=settings.is_region_object,
        description="Curve or mesh object whose edges and loose vertices, seen from above, the mesh has, "
        "such as a river or a fault",
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
            "Curve or mesh object whose outline, seen from above, bounds the rock mass; inner loops are holes"
        ),
        update=changes.region,
    )
    region_file: StringProperty(
        name="Region file",
        description="File with the outline of the rock mass, where no object gives it (GeoJSON, WKT, "
        "shapefile, GeoPackage)",
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
        name="Triangles by",
        description="What says how large the triangles are on which surfaces are interpolated",
        items=plan_mesh.KINDS,
        options={"SKIP_SAVE"},  # it is kept in `edge_length` and `mesh_options`
        get=plan_mesh.kind,
        set=plan_mesh.set_kind,
        update=changes.setting,
    )
    triangles: IntProperty(
        name="Triangles",
        description="How many triangles the mesh of the region should have, within 5 %",
        min=1,
        options={"SKIP_SAVE"},
        get=plan_mesh.triangles,
        set=plan_mesh.set_triangles,
        update=changes.setting,
    )
    edge_length: FloatProperty(
        name="Edge length",
        description=(
            "Length of the edges of the triangles on which surfaces are interpolated; 0: not given. "
            "Half of it makes four times as many triangles"
        ),
        min=0.0,
        subtype="DISTANCE",
        update=changes.setting,
    )
    mesher: EnumProperty(
        name="Mesher",
        description="How the region is divided into triangles",
        items=[(name, mesher.label, mesher.tip) for name, mesher in MESHERS.items()],
        default=DEFAULT_MESHER,
        update=changes.setting,
    )
    base_elevation: FloatProperty(
        name="Base elevation",
        description="Height of the flat base of the oldest block; it lies below all surfaces",
        subtype="DISTANCE",
        update=changes.base_elevation,
    )
    use_base: BoolProperty(
        name="Base",
        description="Lay a block beneath the oldest surface, down to the base elevation",
        update=changes.setting,
    )
    surfaces: CollectionProperty(type=props_surface.RealModelSurface)
    active_surface: IntProperty(
        name="Active surface",
        description="The surface whose settings are shown, counted from the oldest, 0",
    )
    collection: PointerProperty(type=bpy.types.Collection, options={"HIDDEN"})
    interfaces: PointerProperty(type=bpy.types.Collection, options={"HIDDEN"})
    blocks: PointerProperty(type=bpy.types.Collection, options={"HIDDEN"})
    exact: StringProperty(options={"HIDDEN"})


CLASSES = (RealModelSize, RealModelConstraint, RealModelRock)
