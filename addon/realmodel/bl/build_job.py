# SPDX-License-Identifier: GPL-3.0-or-later
"""One build of a scene's model: composed on the main thread, built in another, put into the scene by the main
thread again. Nothing of Blender is held in between but the scene's name: undo may change all else.
"""

import os
import threading

import bpy

from ..core import BuildFailed, Cancelled, InputRefused, RealModelError, build
from ..core.project import surface_item
from . import built_models, built_scene, display, project_settings, settings

_LEFT_FREE = 1  # cores, so that the window stays alive


class BuildJob:
    """A build of the model of a scene.

    `run()` builds at once; `start()` builds in a thread, `done` tells when it has ended, `state()` how far it
    is, `cancel()` stops it. `finish()` then puts the model into the scene, or raises what went wrong and
    leaves the scene as it was.
    """

    def __init__(self, current, depsgraph, cells=None, whole=True):
        """Composes the project. Raises InputRefused."""
        self.scene_name = current.name
        self.cells = cells or current.realmodel.cells.lower()
        if not len(current.realmodel.rocks):
            raise InputRefused("there is no rock mass", advice="add one, or open a project file")
        self.composed = project_settings.compose(current, depsgraph, whole)
        self.prepared = None
        self.error = None
        self.cancelled = False
        self._told = (0.0, "starting")
        self._thread = None
        self._ended = threading.Event()

    def run(self, progress=None):
        """Builds in this thread and puts the model into the scene."""
        model = build(self.composed.project, cells=self.cells, progress=progress)
        self.prepared = built_scene.prepare(model, self.composed)
        return self._put()

    def start(self):
        self._thread = threading.Thread(target=self._work, name="realmodel build")
        self._thread.start()

    def _work(self):
        try:
            model = build(
                self.composed.project,
                cells=self.cells,
                threads=max(1, (os.cpu_count() or 1) - _LEFT_FREE),
                progress=self._tell,
                cancel=lambda: self.cancelled,
            )
            self.prepared = built_scene.prepare(model, self.composed)
        except BaseException as error:  # handed to the main thread, which raises it
            self.error = error
        finally:
            self._ended.set()

    def _tell(self, fraction, text):
        self._told = (fraction, text)

    @property
    def done(self):
        return self._ended.is_set()

    def state(self):
        """(fraction done, what is being done)."""
        return self._told

    def cancel(self):
        self.cancelled = True

    def wait(self, seconds=None):
        """Waits for the thread."""
        if self._thread is not None:
            self._thread.join(seconds)

    def finish(self, in_place=False):
        """Puts the model that the thread has built into the scene; returns it."""
        self.wait()
        if self.cancelled:
            raise Cancelled("the build was cancelled")
        if self.error is not None:
            raise self.error
        return self._put(in_place)

    def _put(self, in_place=False):
        current = bpy.data.scenes.get(self.scene_name)
        if current is None:
            raise BuildFailed(
                f"scene '{self.scene_name}' is gone; build again in the scene that has the model"
            )
        last = settings.last_stage(current)
        group = current.realmodel
        whole = group.stage >= last or not len(group.results)
        built_scene.put(current, self.prepared, self.composed, in_place)
        model = self.prepared.model
        with settings.filling():
            group.exists = True
            group.version = settings.VERSION
            group.built_stamp = built_models.remember(model)
            group.warnings = "\n".join(str(warning) for warning in model.warnings)
            if whole:
                group.stage = last
        display.built(current)
        return model


def refused_surface(current, error):
    """The row of the surface that a refusal speaks of, or None."""
    if not isinstance(error, InputRefused) or not error.item:
        return None
    for rock, row in settings.surface_rows(current):
        if surface_item(rock, row) == error.item:
            return row
    return None


def message(error):
    """An error in one line for a person; defects are told as such."""
    if isinstance(error, RealModelError):
        return str(error)
    return f"this is a defect of RealModel, please report it: {type(error).__name__}: {error}"
