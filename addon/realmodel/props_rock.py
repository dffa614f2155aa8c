# SPDX-License-Identifier: GPL-3.0-or-later
"""The settings of a rock mass, and of its surfaces, series, faults and bodies; most come from their
declarations (core/settings/setting.py)."""

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

from .bl import changes
from .bl.objects.stored_arrays import ArraysProperty
from .bl.project import choices, plan_mesh, series_settings, settings
from .core.project.project import ROCK, SURFACE
from .core.project.series import SERIES
from .core.project.structure_entries import BODY, FAULT
from .core.readers.formats import MESH, labels
from .core.settings.data_files import READING
from .core.settings.meshers import SIZE
from .core.settings.methods import STRUCTURE
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
    is_terrain: BoolProperty(options={"HIDDEN"})  # the boundary above all others
    filters: CollectionProperty(type=RealModelFilter)
    use_continuation: BoolProperty(
        name="Continue By",
        description="Choose the method that continues the mesh to faults that it does not reach. Off: "
        "natural neighbors, and the nearest elevation beyond its vertices",
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


def _end(name, description, at):
    """The field of the name of a series' youngest or oldest surface. at: its number among those of the
    series."""

    def get(row):
        rock = settings.rock_of(row)
        numbers = series_settings.members(rock, row)
        return rock.surfaces[numbers[at]].name if numbers else ""

    def set_name(row, wanted):
        rock = settings.rock_of(row)
        numbers = series_settings.members(rock, row)
        chosen = rock.surfaces.find(wanted)
        if chosen < 0:
            return
        ends = sorted((chosen, numbers[-1 - at])) if numbers else (chosen, chosen)
        passed = numbers and (chosen < numbers[0] if at else chosen > numbers[-1])
        changes.series_run(row, *((chosen, chosen) if passed else ends))

    return StringProperty(
        name=name,
        description=description,
        get=get,
        set=set_name,
        search=choices.surfaces_of_rock,
        options={"SKIP_SAVE"},
    )


class RealModelSeries(properties_of(SERIES, name=changes.name), bpy.types.PropertyGroup):
    """A series: level sets of one field in space, or sheets that are interpolated together."""

    known_name: StringProperty(options={"HIDDEN"})
    youngest: _end(
        "Youngest", "Youngest surface of the series, which contains all surfaces down to the oldest", -1
    )
    oldest: _end("Oldest", "Oldest surface of the series, which contains all surfaces up to the youngest", 0)
    dips = ArraysProperty()  # of realmodel.core.SpaceDips, or Dips of sheets
    exact = ArraysProperty()


_MESH_SOURCES = (
    ("MESH_OBJECT", "Mesh Object", "A mesh object, with its modifiers"),
    ("MESH_FILE", "Mesh File", f"File with its triangles ({labels(MESH)})"),
)
_POINTS_SOURCE = (
    "POINTS_FILE",
    "Points File",
    "File with fault sticks or scattered points; a surface is fitted through them",
)
_INTERVALS_SOURCE = (
    "INTERVALS",
    "Boreholes",
    "From the intervals of boreholes with its name: a vein, a sill, a lens",
)
_LINE_SOURCES = (
    (
        "STICKS_OBJECT",
        "Sticks Object",
        "A curve, or a mesh of edges: each line is a fault stick; a surface is fitted through them",
    ),
    ("TRACE_OBJECT", "Trace Object", "A curve, or a mesh of edges, along the fault on the ground"),
    ("TRACE_FILE", "Trace File", "File with the line of the fault on the ground, as of a geological map"),
)


def _shape_properties(sources, poll=settings.is_mesh_object):
    """A base of a property group with where the shape comes from, and with the object that shows it."""
    properties = {
        "source": EnumProperty(
            name="Source",
            description="Source of the shape",
            items=sources,
            default="MESH_OBJECT",
            update=changes.source,
            options=set(),
        ),
        "filepath": StringProperty(
            name="File", description="File with the shape", subtype="FILE_PATH", update=changes.source
        ),
        "object": PointerProperty(
            name="Object",
            type=bpy.types.Object,
            poll=poll,
            description="Object with the shape, including its modifiers",
            update=changes.source,
        ),
    }
    return type("Shape", (Interface,), {"__module__": __name__, "__annotations__": properties})


class RealModelFaultEnd(bpy.types.PropertyGroup):
    """A fault at which another one ends."""

    name: StringProperty(
        name="Ends At",
        description="Fault at which this one ends. The smaller part beyond it is removed",
        search=choices.faults,
        update=changes.setting,
    )


class RealModelFaultRock(bpy.types.PropertyGroup):
    """A rock mass that a fault displaces."""

    name: StringProperty(
        name="Rock Mass",
        description="Rock mass that the fault displaces",
        search=choices.rocks,
        update=changes.setting,
    )


_FAULT = {key: setting for key, setting in FAULT.items() if key not in READING}
_BODY = {key: setting for key, setting in BODY.items() if key not in READING}
_MESH_READING = {key: setting for key, setting in BODY.items() if key in READING}


class RealModelFault(
    properties_of(
        _FAULT,
        name=changes.name,
        extend=changes.extended,
        stick=changes.fitted,
        dies_out=changes.fitted,
        **{key: changes.unset_of_file(key) for key in ("dip", "dip_direction")},
    ),
    properties_of(READING, changes.reading),
    _shape_properties((*_MESH_SOURCES, _POINTS_SOURCE, *_LINE_SOURCES), settings.is_fault_object),
    bpy.types.PropertyGroup,
):
    """A fault: where its surface comes from, and what it displaces."""

    stored_trace = ArraysProperty()
    dips = ArraysProperty()  # of realmodel.core.SpaceDips, of the file of its points
    filters: CollectionProperty(type=RealModelFilter)
    ends_at: CollectionProperty(type=RealModelFaultEnd)
    rocks: CollectionProperty(type=RealModelFaultRock)


class RealModelBody(
    properties_of(_BODY, name=changes.name),
    properties_of(_MESH_READING, changes.reading),
    _shape_properties((*_MESH_SOURCES, _INTERVALS_SOURCE)),
    bpy.types.PropertyGroup,
):
    """A body: where its closed surface comes from, and what is in it."""


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


class RealModelCode(bpy.types.PropertyGroup):
    """A code of units in the field data of a rock mass, and what it means: a unit; "" for nothing."""

    name: StringProperty(name="Code", description="Code in the data")
    unit: StringProperty(
        name="Unit",
        description="The surface above the block that the code means, or a body. Empty: the code is ignored",
    )
    holes: IntProperty(name="Holes", description="Number of boreholes with the code", options=set())
    rows: IntProperty(
        name="Rows", description="Rows of tables, and polygons of maps, with the code", options=set()
    )
    length: FloatProperty(
        name="Length", description="Length of its intervals in all boreholes", options=set()
    )
    chosen: BoolProperty(
        name="Choose", description="Tick the code for the buttons below the list", options=set()
    )


class RealModelHoleProblem(bpy.types.PropertyGroup):
    """Something wrong with a row of a table of boreholes, and what was done about it."""

    kind: StringProperty(name="Kind", description="Kind of error in the row")
    file: StringProperty(name="File", description="Name of the file of the table")
    line: IntProperty(name="Line", description="Line of the row in the file", options=set())
    hole: StringProperty(name="Hole", description="Name of the hole")
    depth: StringProperty(name="Depth", description="Along the hole, as in the table")
    text: StringProperty(name="Problem", description="Description of the error")
    action: StringProperty(name="Action", description="Used as it is, repaired, or left out")


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
    codes: CollectionProperty(type=RealModelCode)
    active_code: IntProperty(name="Active Code", description="The code that is shown in full", options=set())
    hole_problems: CollectionProperty(type=RealModelHoleProblem)
    active_hole_problem: IntProperty(
        name="Active Problem", description="The problem that is shown in full", options=set()
    )
    imports: StringProperty(options={"HIDDEN"})  # JSON: see bl.project.imported
    ground: StringProperty(
        name="Ground",
        description="File with the elevations of the ground: a raster, points or a mesh. The youngest "
        "surface is made from it, unless it has other data",
        subtype="FILE_PATH",
        update=changes.ground,
    )
    ground_is_raster: BoolProperty(options={"HIDDEN"})
    ground_stored = ArraysProperty()  # the data of its file
    ground_stamp: StringProperty(options={"HIDDEN"})
    map = ArraysProperty()  # on its ground
    observations = ArraysProperty()  # places and their blocks
    dips = ArraysProperty()  # of realmodel.core.Dips
    series: CollectionProperty(type=RealModelSeries)
    active_series: IntProperty(
        name="Active Series", description="The series whose settings are shown", options=set()
    )
    region_area: FloatProperty(options={"HIDDEN"}, default=-1.0)
    constraints: CollectionProperty(type=RealModelConstraint)
    constraints_stored = ArraysProperty()
    sizes: CollectionProperty(type=RealModelSize)
    edges_by: EnumProperty(
        name="Mesh Size From",
        description="How the size of the triangles for interpolation is set",
        items=plan_mesh.KINDS,
        default="LENGTH",
        update=changes.setting,
        options=set(),
    )
    surfaces: CollectionProperty(type=RealModelSurface)
    active_surface: IntProperty(
        name="Active Surface",
        description="The surface whose settings are shown, counted from the oldest, 0",
        options=set(),
    )
    collection: PointerProperty(type=bpy.types.Collection, options={"HIDDEN"})
    interfaces: PointerProperty(type=bpy.types.Collection, options={"HIDDEN"})
    blocks: PointerProperty(type=bpy.types.Collection, options={"HIDDEN"})
    exact = ArraysProperty()
