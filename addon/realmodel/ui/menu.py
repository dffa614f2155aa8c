# SPDX-License-Identifier: GPL-3.0-or-later
"""View > RealModel: every operator in a menu, so that F3 finds it and no mouse is needed, in any mode."""

import bpy

from .. import operators


class REALMODEL_MT_all(bpy.types.Menu):
    """Everything that RealModel does"""

    bl_label = "RealModel"
    bl_idname = "REALMODEL_MT_all"

    def draw(self, _context):
        layout = self.layout
        layout.operator_context = "INVOKE_DEFAULT"
        for group in operators.by_module():
            for cls in group:
                described = cls.bl_rna.properties if hasattr(cls, "bl_rna") else {}
                choice = next((n for n in _CHOICES if n in described), None)
                if choice is None:
                    layout.operator(cls.bl_idname)
                else:
                    layout.operator_menu_enum(cls.bl_idname, choice)
            layout.separator()


_CHOICES = ("sample", "direction", "property_id")  # operators that ask which one as a submenu


def _in_view_menu(self, _context):
    self.layout.separator()
    self.layout.menu(REALMODEL_MT_all.bl_idname)


CLASSES = (REALMODEL_MT_all,)


def register():
    bpy.types.VIEW3D_MT_view.append(_in_view_menu)


def unregister():
    bpy.types.VIEW3D_MT_view.remove(_in_view_menu)
