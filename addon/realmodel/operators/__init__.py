# SPDX-License-Identifier: GPL-3.0-or-later
"""Everything that the panel does, as operators: `bpy.ops.realmodel.*`, for scripts and F3 as well."""

import bpy

from ..registration import register_modules, unregister_modules
from . import (
    boreholes,
    build,
    documentation,
    files,
    imports,
    library,
    origin,
    plan_mesh,
    results,
    rocks,
    sections,
    start,
    surfaces,
    variograms,
    view,
)

_MODULES = (
    start,
    origin,
    rocks,
    plan_mesh,
    imports,
    surfaces,
    boreholes,
    variograms,
    build,
    files,
    library,
    results,
    view,
    sections,
    documentation,
)


def register():
    register_modules(_MODULES)


def unregister():
    unregister_modules(_MODULES)


def by_module():
    """The operators of each module, for menus; those that make sense inside others only are left out."""
    for module in _MODULES:
        yield [
            cls
            for cls in module.CLASSES
            if issubclass(cls, bpy.types.Operator) and "INTERNAL" not in getattr(cls, "bl_options", ())
        ]
