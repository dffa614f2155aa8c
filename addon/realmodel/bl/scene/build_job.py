# SPDX-License-Identifier: GPL-3.0-or-later
"""One build of a scene's model: the project is composed on the main thread, the model is built in another
thread, and the main thread updates the scene. In between only the name of the scene is kept, no Blender data:
undo may change everything else."""

from contextlib import suppress

import bpy

from ... import preferences
from ...core import BuildFailed, InputRefused, RealModelError, build
from ...core.project.coarse import coarsened
from ...core.project.project import surface_item
from .. import display
from ..host.thread_job import ThreadJob
from ..host.threads import threads
from ..objects import meshes
from ..project import project_settings, settings
from . import built_scene, planned_holes


class BuildJob(ThreadJob):
    """A build of the model of a scene.

    `run()` builds at once; `start()` builds in a thread. `finish()` then puts the model into the scene, or
    raises what went wrong and leaves the scene as it was.
    """

    def __init__(self, scene, depsgraph, cells=None, whole=True, coarse=False):
        """Composes the project. coarse: with coarse fields, where it has fields that are finer: `is_coarse`.
        Raises InputRefused."""
        self.scene_name = scene.name
        self.cells = cells or scene.realmodel.cells.lower()
        self.composed = project_settings.compose(scene, depsgraph, whole)
        coarser = coarsened(self.composed.project) if coarse else None
        self.is_coarse = coarser is not None
        if self.is_coarse:
            self.composed.project = coarser
        settings.follow_youngest(scene)
        group = scene.realmodel
        is_stage = len(group.results) and group.stage < settings.last_stage(scene)
        self._stage = group.stage if is_stage else None  # the stage that is shown afterwards
        self._ahead = display.ahead(scene) + planned_holes.ahead(scene)
        self._slices = None

    def run(self, progress=None):
        """Builds in this thread and puts the model into the scene."""
        model = build(
            self.composed.project,
            cells=self.cells,
            threads=threads(is_short=True),
            device=preferences.build_device(),
            memory=preferences.build_memory(),
            progress=progress,
        )
        return self._put(built_scene.prepare(model, self.composed))

    def start(self, is_short=False):
        """Builds in a thread. is_short: it is expected to take less than half a second."""
        self._memory, self._device = preferences.build_memory(), preferences.build_device()
        super().start(is_short)

    def _work(self, _):
        model = build(
            self.composed.project,
            cells=self.cells,
            threads=self._threads,
            device=self._device,
            memory=self._memory,
        )
        for ask in self._ahead:
            with suppress(RealModelError):  # what shows it asks again, and tells
                ask(model)
        return built_scene.prepare(model, self.composed, self._stage, self._threads)

    def hand_over(self, seconds):
        """As of ThreadJob: makes some of the meshes that the scene will need."""
        scene = bpy.data.scenes.get(self.scene_name)
        if scene is None or not self._job.succeeded:
            return True  # finish raises the error
        if self._slices is None:
            shapes = built_scene.pending_meshes(scene, self._job.result())
            self._slices = meshes.slices(shapes)
        try:
            return self._slices.make(seconds)
        except BaseException:
            self.leave()
            raise

    def leave(self):
        if self._slices is not None:
            self._slices.clear()
            self._slices = None

    def finish(self, in_place=False):
        """Puts the model that the thread has built into the scene; returns it. Raises Cancelled, and the
        errors of the build."""
        try:
            return self._put(self._job.result(), in_place)
        finally:
            self.leave()

    def _put(self, prepared, in_place=False):
        scene = bpy.data.scenes.get(self.scene_name)
        if scene is None:
            raise BuildFailed(
                f"scene '{self.scene_name}' is gone; build again in the scene that has the model"
            )
        built_scene.put(scene, prepared, self.composed, in_place)
        scene.realmodel.is_coarse = self.is_coarse
        return prepared.model


def refused_surface(scene, error):
    """The row of the surface, fault or body that a refusal speaks of, or None."""
    if not isinstance(error, InputRefused) or not error.item:
        return None
    for rock, row in settings.surface_rows(scene):
        if surface_item(rock, row) == error.item:
            return row
    for (kind, _), row in settings.structure_rows(scene):
        if f"{kind} '{row.name}'" == error.item:
            return row
    return None


def message(error):
    """The message of an error, in one line. Errors that are defects of RealModel are reported as such."""
    if isinstance(error, RealModelError):
        return str(error)
    return f"this is a defect of RealModel, please report it: {type(error).__name__}: {error}"
