# SPDX-License-Identifier: GPL-3.0-or-later
"""Operators for rows of a surface: the structures of a nested variogram, the filters of its file."""

import bpy
from bpy.props import BoolProperty

from ..bl import changes
from ..bl.project import settings
from ..bl.scene import live
from ..core import InputRefused
from .reporting import Reporting, a_fault, a_surface, remove_row, row_number


class REALMODEL_OT_structure_add(Reporting, bpy.types.Operator):
    """Add a structure to the variogram of the active surface: structures of several ranges make it nested"""

    bl_label = "Add Structure"
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
    """Remove a structure from the variogram of the active surface"""

    bl_label = "Remove Structure"
    needs = (a_surface,)

    index: row_number()

    def act(self, context):
        remove_row(settings.active_surface(context.scene).structures, self.index, "structure")
        live.touch(context.scene)


_OF_FAULT = BoolProperty(name="Of Fault", description="Of the active fault", options={"SKIP_SAVE"})


def _a_file(context):
    return a_surface(context) and a_fault(context)


def _filtered(context, of_fault):
    """The row whose file the filters are of. Raises InputRefused where there is none."""
    reason = (a_fault if of_fault else a_surface)(context)
    if reason:
        raise InputRefused(reason)
    return (settings.active_structure if of_fault else settings.active_surface)(context.scene)


class REALMODEL_OT_filter_add(Reporting, bpy.types.Operator):
    """Read only the rows of the file that have a value in a column; values of one column are alternatives"""

    bl_label = "Add Filter"
    needs = (_a_file,)

    of_fault: _OF_FAULT

    def act(self, context):
        _filtered(context, self.of_fault).filters.add()


class REALMODEL_OT_filter_remove(Reporting, bpy.types.Operator):
    """Remove a filter from the active surface, or fault"""

    bl_label = "Remove Filter"
    needs = (_a_file,)

    index: row_number()
    of_fault: _OF_FAULT

    def act(self, context):
        surface = _filtered(context, self.of_fault)
        remove_row(surface.filters, self.index, "filter")
        changes.reading(surface, context)
