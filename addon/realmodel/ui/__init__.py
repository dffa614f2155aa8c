# SPDX-License-Identifier: GPL-3.0-or-later
"""The tab "RealModel" of the 3D viewport's sidebar: one module for each of its panels, in their order."""

import bpy

from . import build, library, lists, menu, results, rocks, start, surfaces, view

_MODULES = (lists, start, rocks, surfaces, build, view, library, results, menu)


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
