# SPDX-License-Identifier: GPL-3.0-or-later
"""Starts Blender with the add-on of this clone. A button in the header of the 3D Viewport loads the add-on
again after its Python files have changed (docs/dev/first_change.md).

    blender --factory-startup -P scripts/develop.py

--factory-startup ignores an installed RealModel and leaves the preferences alone. After a change of the
native part start Blender again: a process can load a native module only once.
"""

import sys
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "addon"))


class RELOAD_OT_realmodel(bpy.types.Operator):
    """Load the add-on again from its files. The scene and its model stay"""

    bl_idname = "reload.realmodel"
    bl_label = "Reload RealModel"

    def execute(self, _context):
        sys.modules["realmodel"].unregister()
        for name in list(sys.modules):
            if f"{name}.".startswith("realmodel.") and not name.endswith("._native"):
                del sys.modules[name]
        _register()
        self.report({"INFO"}, "RealModel is loaded again")
        return {"FINISHED"}


def _register():
    import realmodel

    realmodel.register()


def _button(self, _context):
    self.layout.operator(RELOAD_OT_realmodel.bl_idname, icon="FILE_REFRESH")


bpy.utils.register_class(RELOAD_OT_realmodel)
bpy.types.VIEW3D_HT_header.append(_button)
_register()
