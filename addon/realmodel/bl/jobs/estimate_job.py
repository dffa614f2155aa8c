# SPDX-License-Identifier: GPL-3.0-or-later
"""The estimate of a build: made in a thread, kept until the input of the model changes."""

import json

import bpy

from ... import preferences
from ...core import estimate
from ..host.thread_job import ThreadJob
from ..project import project_settings


class EstimateJob(ThreadJob):
    """Estimates what building the model of a scene takes, and returns the core's Estimate."""

    def __init__(self, scene, depsgraph):
        """Composes the project. Raises InputRefused."""
        self._scene_name, self._cells = scene.name, scene.realmodel.cells.lower()
        self._project = project_settings.compose(scene, depsgraph).project

    def _work(self, _job):
        return estimate(self._project, self._cells, threads=self._threads)

    def _put(self, made):
        limit = preferences.build_memory() or made.available
        table = {"scene": self._scene_name, "rows": made.rows(), "fits": made.memory <= limit}
        bpy.context.window_manager.realmodel.estimate = json.dumps(table)
        return made


def found(scene):
    """(rows, fits) of the estimate of a scene's model as it is now: (name, value) each, and whether a build
    may take so much memory; None where it is not known."""
    table = json.loads(bpy.context.window_manager.realmodel.estimate or "{}")
    return (table["rows"], table["fits"]) if table.get("scene") == scene.name else None
