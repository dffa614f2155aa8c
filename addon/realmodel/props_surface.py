# SPDX-License-Identifier: GPL-3.0-or-later
"""The settings of one surface; most come from their declarations in core/project/project.py and
core/settings."""

import bpy
from bpy.props import BoolProperty, CollectionProperty, EnumProperty, PointerProperty, StringProperty

from .bl import changes
from .bl.objects.stored_arrays import ArraysProperty
from .bl.project import choices, settings
from .core.project.project import SURFACE
from .core.readers.formats import MESH, labels
from .core.settings.methods import STRUCTURE
from .core.settings.point_file import READING
from .props_schema import properties_of

SOURCES = (
    ("POINTS_FILE", "Points File", "File with the points that the surface is interpolated from"),
    ("POINTS_OBJECT", "Points Object", "The surface is interpolated from the vertices of a mesh object"),
    ("MESH_OBJECT", "Mesh Object", "A mesh object, with its modifiers, is the surface"),
    (
        "MESH_FILE",
        "Mesh File",
        f"File with the triangles of the surface ({labels(MESH)})",
    ),
    ("NONE", "No Points", "For the methods that need no points: Constant and Parallel"),
)


class Interface:
    """The properties by which a row knows the object that shows its shape, and keeps what its file had."""

    known_name: StringProperty(options={"HIDDEN"})
    hide: BoolProperty(
        name="Hide",
        description="Hide this interface in the viewport; it is still built",
        update=changes.view,
        options=set(),
    )
    interface: PointerProperty(type=bpy.types.Object, options={"HIDDEN"})
    interface_digest: StringProperty(options={"HIDDEN"})
    stored_stamp: StringProperty(options={"HIDDEN"})
    stored_mesh = ArraysProperty()
    exact = ArraysProperty()
    figures: StringProperty(options={"HIDDEN"})


class RealModelStructure(properties_of(STRUCTURE), bpy.types.PropertyGroup):
    """A structure of a nested variogram, added to the nugget and the other structures."""

    exact = ArraysProperty()


class RealModelFilter(bpy.types.PropertyGroup):
    """A value of a column: only rows that have it are read, or another one given for the same column."""

    column: StringProperty(
        name="Column",
        description="Column of the table, or attribute of the features",
        search=choices.columns,
        update=changes.reading,
    )
    value: StringProperty(
        name="Value",
        description="Value that the rows have; a number in quotes is compared as text",
        search=choices.values,
        update=changes.reading,
    )


_OWN = {key: setting for key, setting in SURFACE.items() if key not in READING}


class RealModelSurface(
    properties_of(_OWN, name=changes.name),
    properties_of(READING, changes.reading),
    Interface,
    bpy.types.PropertyGroup,
):
    """A surface: the source of its shape, its rule, and the block beneath it."""

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
    filters: CollectionProperty(type=RealModelFilter)
    use_continuation: BoolProperty(
        name="Continue By",
        description="Choose the method by which the mesh is continued to faults that it does not reach. Off: "
        "natural neighbors, and beyond its vertices the nearest elevation",
        update=changes.setting,
        options=set(),
    )
    fit_variogram: BoolProperty(
        name="Fit Variogram",
        description="Fit the variogram to the points; turn off to edit the variogram of the last build",
        default=True,
        update=changes.fit_variogram,
        options=set(),
    )
    structures: CollectionProperty(type=RealModelStructure)
    stored = ArraysProperty()  # its points
    dips = ArraysProperty()  # of realmodel.core.Dips
    left_out = ArraysProperty()  # its points that are switched off
    other_options = ArraysProperty()  # heights, or a triangulation, given in a project file
