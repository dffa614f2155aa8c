# SPDX-License-Identifier: GPL-3.0-or-later
"""Planned holes: where they begin, what they meet, and how certain that is."""

import bpy
import numpy as np

from ..bl.display import explosion
from ..bl.jobs import planned_job
from ..bl.objects import exaggeration
from ..bl.project import project_settings, settings
from ..bl.scene import planned_holes
from ..core import InputRefused
from ..core.base.errors import counted
from ..core.exporters import PLANNED_HOLE
from .files import Exporting, format_filter, format_menu
from .reporting import InBackground, Reporting, a_model, an_ensemble, not_building

_LONGER = 1.1  # a new hole goes so far below the model


def a_planned_hole(context):
    has_hole = planned_holes.active(context.scene) is not None
    return None if has_hole else "there is no planned hole; add one first"


class REALMODEL_OT_planned_hole_add(Reporting, bpy.types.Operator):
    """Plan a hole that goes straight down through the middle of the model, or at the 3D cursor if it is over
    the model. Change its collar, azimuth, dip and length afterward"""

    bl_label = "Plan Hole"
    needs = (a_model,)

    def act(self, context):
        scene = context.scene
        low, high = (np.asarray(corner, np.float64) for corner in explosion.bounds(scene))
        at = _cursor(scene)
        is_placed = any(scene.cursor.location)  # else it is where a new file has it
        if not (is_placed and ((at[:2] > low[:2]) & (at[:2] < high[:2])).all()):
            at = (low + high) / 2
        rows = scene.realmodel.planned_holes
        with settings.filling():
            row = rows.add()
            row.name = settings.free_name(rows, f"P{len(rows)}", own=row)
            origin = project_settings.model_origin(scene)
            planned_holes.set_collar(row, np.array([at[0], at[1], high[2]]) + origin)
            settings.set_number(row, "length", float(_LONGER * (high[2] - low[2])))
            scene.realmodel.active_planned_hole = len(rows) - 1
        planned_holes.update(scene, row)
        planned_holes.begin_on_ground(row)


def _cursor(scene):
    """(3,) the 3D cursor in the scene without vertical exaggeration."""
    matrix = exaggeration.matrix(scene)
    return np.linalg.solve(matrix, np.append(np.array(scene.cursor.location, np.float64), 1.0))[:3]


class REALMODEL_OT_planned_hole_remove(Reporting, bpy.types.Operator):
    """Remove the active planned hole"""

    bl_label = "Remove Planned Hole"
    needs = (a_planned_hole,)

    def act(self, context):
        scene = context.scene
        rows, row = scene.realmodel.planned_holes, planned_holes.active(context.scene)
        number = list(rows).index(row)
        rows.remove(number)
        scene.realmodel.active_planned_hole = max(0, min(number, len(rows) - 1))
        planned_holes.show(scene)


class REALMODEL_OT_planned_hole_collar(Reporting, bpy.types.Operator):
    """Move the collar of the active planned hole to the 3D cursor"""

    bl_label = "Collar at 3D Cursor"
    needs = (a_planned_hole,)

    def act(self, context):
        scene, row = context.scene, planned_holes.active(context.scene)
        planned_holes.move_collar(row, _cursor(scene) + project_settings.model_origin(scene))


class REALMODEL_OT_planned_hole_certainty(InBackground, bpy.types.Operator):
    """Draw the surfaces of the ensemble's realizations again, and compute along the active planned hole how
    probable each block is, and how far each contact may move. Esc cancels"""

    bl_label = "How Certain"
    needs = (not_building, a_model, a_planned_hole, an_ensemble)

    def begin(self, context):
        return planned_job.PlannedJob(context.scene)

    def tell_done(self, hole):
        self.report({"INFO"}, f"Asked the ensemble about {counted(len(hole.contacts), 'contact')}")


class REALMODEL_OT_planned_hole_save(Exporting, bpy.types.Operator):
    """Save the blocks along the active planned hole as a table"""

    bl_label = "Save Planned Hole"
    needs = (a_model, a_planned_hole)

    format: format_menu(PLANNED_HOLE.formats())
    filter_glob: format_filter(PLANNED_HOLE.formats())

    def of_what(self, context):
        return (planned_holes.active(context.scene).name,)

    def write(self, context, path):
        hole = planned_holes.kept(planned_holes.active(context.scene))
        if hole is None:
            raise InputRefused("it is not known what the hole meets", advice="press Build, then save again")
        hole.save(path)
