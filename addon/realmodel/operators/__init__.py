# SPDX-License-Identifier: GPL-3.0-or-later
"""Everything that the panel does, as operators: `bpy.ops.realmodel.*`, for scripts and F3 as well."""

import bpy

from . import build, files, library, results, rocks, sections, start, surfaces, view

_MODULES = (start, rocks, surfaces, build, files, library, results, view, sections)


def register():
    for module in _MODULES:
        for cls in module.CLASSES:
            bpy.utils.register_class(cls)
        if hasattr(module, "register"):
            module.register()


def unregister():
    for module in reversed(_MODULES):
        if hasattr(module, "unregister"):
            module.unregister()
        for cls in reversed(module.CLASSES):
            bpy.utils.unregister_class(cls)


def by_module():
    """The operators of each module, for menus; those that make sense inside others only are left out."""
    for module in _MODULES:
        yield [
            cls
            for cls in module.CLASSES
            if issubclass(cls, bpy.types.Operator) and "INTERNAL" not in getattr(cls, "bl_options", ())
        ]
