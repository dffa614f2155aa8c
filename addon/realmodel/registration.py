# SPDX-License-Identifier: GPL-3.0-or-later
"""Registers the classes of modules with Blender, in the order in which they are defined, then what modules
register on their own; unregisters in reverse order."""

import importlib
import pkgutil

import bpy

_KINDS = tuple(
    getattr(bpy.types, name)
    for name in ("FileHandler", "Menu", "Operator", "Panel", "PropertyGroup", "UIList")
    if hasattr(bpy.types, name)  # Blender 3.4 has no FileHandler
)


def modules_in(package, folders):
    """All modules of a package. folders: its __path__."""
    return [importlib.import_module(f"{package}.{module.name}") for module in pkgutil.iter_modules(folders)]


def classes(modules):
    """The classes of the modules that Blender knows once they are registered, each once."""
    types = (cls for module in modules for cls in vars(module).values() if isinstance(cls, type))
    rna_types = (cls for cls in types if issubclass(cls, _KINDS) and cls.__module__.startswith(__package__))
    return list(dict.fromkeys(rna_types))


def drop_handler(name, tip, label, opens):
    """The class by which files that are dropped into the viewport go to an operator; None before Blender 4.1.
    opens: (the operator, the endings of the files)."""
    if not hasattr(bpy.types, "FileHandler"):
        return None
    in_viewport = classmethod(lambda _cls, context: getattr(context.area, "type", "") == "VIEW_3D")
    operator, endings = opens
    content = {"bl_label": label, "bl_import_operator": operator, "bl_file_extensions": ";".join(endings)}
    content |= {"__doc__": tip, "__module__": __name__, "poll_drop": in_viewport}
    return type(name, (bpy.types.FileHandler,), content)


def register_modules(modules):
    for cls in classes(modules):
        bpy.utils.register_class(cls)
    for module in modules:
        if hasattr(module, "register"):
            module.register()


def unregister_modules(modules):
    for module in reversed(modules):
        if hasattr(module, "unregister"):
            module.unregister()
    for cls in reversed(classes(modules)):
        bpy.utils.unregister_class(cls)
