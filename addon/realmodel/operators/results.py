# SPDX-License-Identifier: GPL-3.0-or-later
"""The table of blocks."""

import bpy

from ..bl.project import results
from ..core.base.errors import counted
from .reporting import Reporting, a_model


class REALMODEL_OT_copy_table(Reporting, bpy.types.Operator):
    """Copy the table of blocks to the clipboard, to be pasted into a spreadsheet"""

    bl_label = "Copy Table"
    bl_options = {"REGISTER"}
    needs = (a_model,)

    def act(self, context):
        context.window_manager.clipboard = results.as_text(context.scene, "\t")
        self.report({"INFO"}, f"Copied {counted(len(context.scene.realmodel.results), 'row')}")
