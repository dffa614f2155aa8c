# SPDX-License-Identifier: GPL-3.0-or-later
"""How certain it is what a planned hole meets, asked of the realizations of the scene's ensemble in a
thread."""

import bpy

from ...core import BuildFailed, InputRefused
from ...core.ensembles.sampled_blocks import hole_of_realizations
from ..display import ensembles, shown_models
from ..host.thread_job import ThreadJob
from ..project import settings
from ..scene import planned_holes
from .ensemble_job import realizer_of


class PlannedJob(ThreadJob):
    """The realizations of a scene's ensemble along its active planned hole. `finish()` keeps what they say in
    the row of the hole and returns the core's PlannedHole, or raises what went wrong."""

    def __init__(self, scene):
        """Raises InputRefused, UsageError."""
        table = ensembles.table(scene)
        if table is None or ensembles.is_outdated(scene):
            raise InputRefused("the model has no ensemble", advice="make one first (Ensemble)")
        row = planned_holes.active(scene)
        self._scene, self._name = scene.name, row.name
        self._count, self._seed = table["count"], table["seed"]
        self._axis = planned_holes.axis_of(row)
        self._request = shown_models.StageRequest(scene, settings.last_stage(scene))

    def _work(self, job):
        axis = self._axis
        with job.part(0.0, shown_models.BUILT):
            model = self._request.make()
            hole = model.planned_hole(axis.collar, axis.azimuth, axis.dip, axis.length)
        with job.part(shown_models.BUILT, 1.0):
            realizer = realizer_of(model, self._request.stamp, self._seed)
            return hole_of_realizations(job, realizer, self._count, hole)

    def _put(self, hole):
        scene = bpy.data.scenes.get(self._scene)
        row = None if scene is None else scene.realmodel.planned_holes.get(self._name)
        if row is None or scene.realmodel.built_stamp != self._request.stamp:
            raise BuildFailed("the hole or its model is gone; nothing was changed")
        if planned_holes.axis_of(row) != self._axis:
            raise BuildFailed("the hole was moved during the computation; nothing was changed: try again")
        self._request.keep()
        planned_holes.keep(scene, row, hole)
        return hole
