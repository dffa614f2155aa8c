# SPDX-License-Identifier: GPL-3.0-or-later
"""Edit > Preferences > Add-ons > RealModel: settings for all files of a user. Where the add-on runs without
being enabled, as in a script that registers it, the defaults are used."""

from types import SimpleNamespace

import bpy
from bpy.props import EnumProperty, FloatProperty, IntProperty

CELLS = (
    ("COLUMNS", "Simulation", "Many small cells, one below each facet of a surface"),
    ("BLOCKS", "Pictures", "One cell for each connected part of a block: faster, and less memory"),
)
DISPLAYS = (
    ("POINTS", "Points", "Vertices of the interfaces and blocks"),
    ("LINES", "Lines", "Edges of the interfaces and blocks"),
    ("AREAS", "Faces", "Faces of the blocks, separate and flat, with their edges"),
    ("SURFACES", "Surfaces", "The interfaces that the model is built from"),
    ("POLYHEDRA", "Cells", "The polyhedral cells of the blocks"),
    ("BLOCKS", "Blocks", "The blocks as solids"),
)
_DEVICES = (
    ("CPU", "CPU", "Threads of the processor"),
    ("CUDA", "CUDA", "An NVIDIA GPU helps with kriging and joined parts; needs the module _native_cuda"),
)
_GIGABYTE = 1 << 30


class RealModelPreferences(bpy.types.AddonPreferences):
    """Called as the package is, which an extension's folder gives its name."""

    bl_idname = __package__

    threads: IntProperty(
        name="Threads",
        description="Threads of a build. 0: all processors, but one while you keep working in the window",
        min=0,
        max=1024,
    )
    device: EnumProperty(
        name="Device",
        description="What computes a build; the model is the same. Where a device cannot be used, a "
        "warning of the build says why",
        items=_DEVICES,
        default="CPU",
    )
    memory_limit: FloatProperty(
        name="Memory Limit",
        description="Memory that a build may use, in gigabytes; a build that needs more is refused. "
        "0: the memory that is free",
        min=0.0,
        soft_max=256.0,
        precision=1,
    )
    live_pause: FloatProperty(
        name="Auto Pause",
        description="Time without a change after which Auto builds again",
        subtype="TIME_ABSOLUTE",
        unit="TIME_ABSOLUTE",
        min=0.0,
        max=60.0,
        soft_max=5.0,
        default=0.03,
        precision=2,
    )
    display: EnumProperty(
        name="Show", description="How a new model is displayed", items=DISPLAYS, default="BLOCKS"
    )
    cells: EnumProperty(
        name="For",
        description="Purpose of a new model, which decides how its blocks are divided into cells",
        items=CELLS,
        default="COLUMNS",
    )

    def draw(self, _context):
        layout = self.layout
        layout.use_property_split = True
        for heading, names in (
            ("Build", ("threads", "device", "memory_limit", "live_pause")),
            ("New Models", ("display", "cells")),
        ):
            column = layout.column(heading=heading)
            for name in names:
                column.prop(self, name)
        layout.operator("realmodel.install_looks", icon="ASSET_MANAGER")
        _draw_profiles(layout)


def _draw_profiles(layout):
    """The profiles of imports, with buttons."""
    from .bl.field import profiles  # its module needs this one

    column = layout.column(heading="Import Profiles", align=True)
    for profile in profiles.all_of_user():
        row = column.row(align=True)
        row.label(text=f"{profile.name}: {', '.join(profile.header)}")
        row.operator("realmodel.profile_rename", text="", icon="GREASEPENCIL").name = profile.name
        row.operator("realmodel.profile_remove", text="", icon="X").name = profile.name
    row = layout.row(align=True)
    row.operator("realmodel.profiles_import", icon="IMPORT")
    row.operator("realmodel.profiles_export", icon="EXPORT")


def current():
    """The preferences, or their defaults where the add-on is not enabled."""
    addon = bpy.context.preferences.addons.get(__package__)
    if addon is not None and addon.preferences is not None:
        return addon.preferences
    annotations = RealModelPreferences.__annotations__
    return SimpleNamespace(**{name: made.keywords.get("default", 0) for name, made in annotations.items()})


def build_memory():
    """Memory that a build may use, in bytes; None: the free memory."""
    return round(current().memory_limit * _GIGABYTE) or None


def build_device():
    """The device of a build, as `build` calls it."""
    return current().device.lower()


def register():
    bpy.utils.register_class(RealModelPreferences)


def unregister():
    bpy.utils.unregister_class(RealModelPreferences)
