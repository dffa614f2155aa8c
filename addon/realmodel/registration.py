# SPDX-License-Identifier: GPL-3.0-or-later
"""Registers the parts of the add-on with Blender: the CLASSES of modules in their order, then a module's own
register(); unregisters them in reverse order."""

import bpy


def register_modules(modules):
    for module in modules:
        for cls in module.CLASSES:
            bpy.utils.register_class(cls)
        if hasattr(module, "register"):
            module.register()


def unregister_modules(modules):
    for module in reversed(modules):
        if hasattr(module, "unregister"):
            module.unregister()
        for cls in reversed(module.CLASSES):
            bpy.utils.unregister_class(cls)
