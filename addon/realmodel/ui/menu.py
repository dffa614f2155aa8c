# SPDX-License-Identifier: GPL-3.0-or-later
"""View > RealModel: every operator in a menu, so that F3 finds it and no mouse is needed, in any mode."""

import bpy

from .. import operators


class REALMODEL_MT_all(bpy.types.Menu):
    """Everything that RealModel does"""

    bl_label = "RealModel"
    bl_idname = "REALMODEL_MT_all"

    def draw(self, context):
        layout = self.layout
        layout.operator_context = "INVOKE_DEFAULT"
        for group in operators.by_module():
            for cls in group:
                _draw(layout, context, cls)
            layout.separator()


_CHOICES = ("sample", "direction", "property_id")  # of operators that have to be told which one


def _draw(layout, context, cls):
    """An entry for an operator, or one for each choice: F3 looks into no submenus of choices."""
    given = getattr(cls, "__annotations__", {})
    choice = next((name for name in _CHOICES if name in given and "items" in given[name].keywords), None)
    if choice is None:
        layout.operator(cls.bl_idname)
        return
    items = given[choice].keywords["items"]
    for identifier, name, *_ in items(None, context) if callable(items) else items:
        entry = layout.operator(cls.bl_idname, text=f"{cls.bl_label}: {name}")
        setattr(entry, choice, identifier)


def _in_view_menu(self, _context):
    self.layout.separator()
    self.layout.menu(REALMODEL_MT_all.bl_idname)


CLASSES = (REALMODEL_MT_all,)


def register():
    bpy.types.VIEW3D_MT_view.append(_in_view_menu)


def unregister():
    bpy.types.VIEW3D_MT_view.remove(_in_view_menu)
