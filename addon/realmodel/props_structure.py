# SPDX-License-Identifier: GPL-3.0-or-later
"""The settings of one fault and of one body; most come from their declarations in
core/project/structure_entries.py."""

import bpy
from bpy.props import CollectionProperty, EnumProperty, PointerProperty, StringProperty

from .bl import changes
from .bl.objects.stored_arrays import ArraysProperty
from .bl.project import choices, settings
from .core.project.structure_entries import BODY, FAULT
from .core.readers.formats import MESH, labels
from .core.settings.point_file import READING
from .props_schema import properties_of
from .props_surface import Interface, RealModelFilter

_MESH_SOURCES = (
    ("MESH_OBJECT", "Mesh Object", "A mesh object, with its modifiers"),
    ("MESH_FILE", "Mesh File", f"File with its triangles ({labels(MESH)})"),
)
_POINTS_SOURCE = (
    "POINTS_FILE",
    "Points File",
    "File with fault sticks or scattered points; a surface is fitted through them",
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
        description="Fault at which this one ends; the smaller part of this one beyond is dropped",
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
    filters: CollectionProperty(type=RealModelFilter)
    ends_at: CollectionProperty(type=RealModelFaultEnd)
    rocks: CollectionProperty(type=RealModelFaultRock)


class RealModelBody(
    properties_of(_BODY, name=changes.name),
    properties_of(_MESH_READING, changes.reading),
    _shape_properties(_MESH_SOURCES),
    bpy.types.PropertyGroup,
):
    """A body: where its closed surface comes from, and what is in it."""
