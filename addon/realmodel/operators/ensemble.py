# SPDX-License-Identifier: GPL-3.0-or-later
"""Ensembles: many realizations of the model, with progress and Esc."""

import bpy
from bpy.props import EnumProperty, IntProperty

from ..bl import display
from ..bl.display import ensembles
from ..bl.jobs import ensemble_job
from ..bl.objects import visible
from ..bl.scene import live
from ..core import InputRefused
from ..core.base.errors import counted
from ..props_planned import MOST
from .reporting import InBackground, Reporting, a_model, an_ensemble, an_outline_object, not_building


class REALMODEL_OT_ensemble(InBackground, bpy.types.Operator):
    """Build the model many times, each time with other elevations between the points, as the data and the
    variograms permit. Shows how certain the volumes are, and how probable each block is. Esc cancels and
    leaves the scene unchanged"""

    bl_label = "Make Ensemble"
    needs = (not_building, a_model)

    realizations: IntProperty(
        name="Realizations",
        description="Number of times that the model is built",
        default=40,
        min=2,
        max=MOST,
    )
    seed: IntProperty(name="Seed", description="Of the random numbers", min=0)
    along: EnumProperty(
        name="Along",
        description="Where the blocks are shown",
        items=(
            ("PLANE", "Section Plane", "The section plane, or a plane through the middle of the model"),
            ("LINE", "Active Curve", "Vertical sections along the active curve or mesh of edges"),
        ),
    )

    def begin(self, context):
        live.postpone_work()
        line = None
        if self.along == "LINE":
            if reason := an_outline_object(context):
                raise InputRefused(reason)
            line = context.active_object
        group = context.scene.realmodel.ensemble
        count, seed = (
            getattr(self if self.properties.is_property_set(key) else group, key)
            for key in ("realizations", "seed")
        )
        return ensemble_job.EnsembleJob(context.scene, count, seed, line, context.evaluated_depsgraph_get())

    def tell_done(self, found):
        display.exaggeration_changed(bpy.context.scene)
        obj = ensembles.item_of(bpy.context.scene)
        if obj is not None:
            visible.select_alone(bpy.context, obj)
        self.report({"INFO"}, f"Made {counted(len(found.volumes), 'realization')}")


class REALMODEL_OT_ensemble_remove(Reporting, bpy.types.Operator):
    """Remove the ensemble with its section and its table; the model stays"""

    bl_label = "Remove Ensemble"
    needs = (an_ensemble, not_building)

    def act(self, context):
        ensembles.remove(context.scene)
