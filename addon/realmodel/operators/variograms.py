# SPDX-License-Identifier: GPL-3.0-or-later
"""The parts of a nested variogram."""

import bpy
from bpy.props import IntProperty

from ..bl import live, settings
from ..core import InputRefused
from .reporting import Reporting, a_surface


class REALMODEL_OT_structure_add(Reporting, bpy.types.Operator):
    """Add a part to the variogram of the active surface: parts of several ranges make a nested variogram"""

    bl_idname = "realmodel.structure_add"
    bl_label = "Add Part of Variogram"
    needs = (a_surface,)

    def act(self, context):
        surface = settings.active_surface(context.scene)
        with settings.filling():
            surface.fit_variogram = False
            if not len(surface.structures):
                _take_single(surface)
            else:
                last = surface.structures[-1]
                values = last.model, 2.0 * last.range, last.sill
                part = surface.structures.add()
                part.model, part.range, part.sill = values
        live.touch(context.scene)


def _take_single(surface):
    """The variogram that was there is the first part; its sill includes the nugget, a part's does not."""
    part = surface.structures.add()
    part.model, part.range = surface.variogram_model, surface.variogram_range
    part.sill = max(surface.variogram_sill - surface.variogram_nugget, 0.0)


class REALMODEL_OT_structure_remove(Reporting, bpy.types.Operator):
    """Remove a part of the variogram of the active surface"""

    bl_idname = "realmodel.structure_remove"
    bl_label = "Remove Part of Variogram"
    needs = (a_surface,)

    index: IntProperty(name="Number", description="Which of them, counted from 0", min=0)

    def act(self, context):
        rows = settings.active_surface(context.scene).structures
        if not 0 <= self.index < len(rows):
            raise InputRefused(f"there is no part {self.index}", advice="they are counted from 0")
        rows.remove(self.index)
        live.touch(context.scene)


CLASSES = (REALMODEL_OT_structure_add, REALMODEL_OT_structure_remove)
