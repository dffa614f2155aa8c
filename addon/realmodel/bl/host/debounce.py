# SPDX-License-Identifier: GPL-3.0-or-later
"""Debounced jobs for a scene: they begin after a short pause without changes. A timer of Blender runs them; a
change while a job runs cancels the job, and it begins again after the next pause."""

import time

import bpy

from .threads import threads

_LOOK_SECONDS = 0.005  # between two calls of the timer, whose cost is negligible


class DebouncedJob:
    """The pending changes and the running jobs of all scenes.

    pause(): seconds without a change. begin(name, changed_at) returns a job (core.work.Job, or an object with
    its done, cancel and wait) for the scene of that name, or None. finish(name, job, changed_at) uses the
    result of the job. may_begin(): whether a job may start now. hand_over(name, job): work in slices before
    `finish`: called repeatedly when the job is done, until it returns True.
    """

    def __init__(self, pause, begin, finish, may_begin=lambda: True, hand_over=lambda name, job: True):
        self._pause, self._begin, self._finish, self._may_begin = pause, begin, finish, may_begin
        self._hand_over = hand_over
        self._changed_at = {}  # by the name of a scene: when something changed that has no job yet
        self._jobs = {}  # by the name of a scene: (job, when its last change was)
        self._timer = self.look  # Blender knows timers by the object

    def touch(self, name, later=0.0):
        """Reports that input of a scene's job was changed; the pause begins so many seconds later."""
        self._changed_at[name] = time.perf_counter() + later
        if not bpy.app.timers.is_registered(self._timer):
            bpy.app.timers.register(self._timer, first_interval=_LOOK_SECONDS)

    def is_working(self, name=None):
        """Whether there is something to do for a scene, or for any."""
        if name is None:
            return bool(self._jobs or self._changed_at)
        return name in self._jobs or name in self._changed_at

    def forget_changes(self, name=None):
        """Discards the changes that wait: of a scene, or of all."""
        for scene_name in list(self._changed_at) if name is None else [name]:
            self._changed_at.pop(scene_name, None)

    def postpone_jobs(self):
        """Stops the running jobs: they begin anew after a pause, once jobs may begin."""
        for job, _ in self._jobs.values():
            job.cancel()
        for name, (job, _) in self._jobs.items():
            job.wait()
            self._changed_at.setdefault(name, time.perf_counter())
        self._jobs.clear()

    def stop_jobs(self):
        """Stops the running jobs and discards the changes that wait."""
        self.postpone_jobs()
        self.forget_changes()

    def stop(self):
        """Stops all work: the add-on is disabled, or another file was opened."""
        self.stop_jobs()
        if bpy.app.timers.is_registered(self._timer):
            bpy.app.timers.unregister(self._timer)

    def look(self):
        """The timer: finishes jobs that are done, and begins jobs whose pause is over. Returns the seconds
        until the next call, None when there is nothing to do."""
        if not hasattr(bpy.types.Scene, "realmodel"):
            return None
        if not self._may_begin():
            return _LOOK_SECONDS
        for name in list(self._jobs):
            job, changed_at = self._jobs[name]
            if name in self._changed_at:
                job.cancel()  # its input is outdated
            if job.done and (name in self._changed_at or self._hand_over(name, job)):
                del self._jobs[name]
                self._finish(name, job, changed_at)
        for name, changed_at in list(self._changed_at.items()):
            if name not in self._jobs and time.perf_counter() - changed_at >= self._pause():
                del self._changed_at[name]
                threads()  # read here for the job, as its thread must not access Blender
                job = self._begin(name, changed_at)
                if job is not None:
                    self._jobs[name] = (job, changed_at)
        return _LOOK_SECONDS if self._jobs or self._changed_at else None
