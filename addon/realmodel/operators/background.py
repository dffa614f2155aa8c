# SPDX-License-Identifier: GPL-3.0-or-later
"""Long work of operators: blocking in scripts; with progress and Esc in a window."""

import bpy

from ..bl.host import notices
from ..bl.objects import viewports
from ..bl.scene import build_job
from ..core import Cancelled, RealModelError
from .reporting import Reporting

_STEP = 0.05  # seconds between two looks at the work
_SLICE = 0.05  # seconds of making meshes, before the window is updated again

running = []  # the jobs that are shown with progress


class InBackground(Reporting):
    """An operator whose work is a job, such as bl.build_job.BuildJob.

    `begin(context)` makes the job, or raises RealModelError. `tell_done(result)` reports what the job
    returns. `refused(context, error)`, `cancelled()`: what is to be done about an error or Esc beside
    reporting it.
    """

    _job = None
    _timer = None

    def refused(self, context, error):
        pass

    def cancelled(self):
        pass

    def act(self, context):
        self.tell_done(self.begin(context).run())

    def invoke(self, context, event):
        if bpy.app.background or context.window is None:
            return self.execute(context)
        try:
            self._job = self.begin(context)
        except RealModelError as error:
            return self._refused(context, error)
        self._job.start()
        running.append(self._job)
        activity = context.window_manager.realmodel
        activity.running, activity.progress, activity.text = True, 0.0, "starting"
        self._timer = context.window_manager.event_timer_add(_STEP, window=context.window)
        context.window_manager.progress_begin(0, 100)
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        if event.type == "ESC" and event.value == "PRESS":
            self._job.cancel()
            return {"RUNNING_MODAL"}
        if event.type != "TIMER":
            return {"PASS_THROUGH"}
        if not self._job.done:
            self._show_progress(context)
            return {"PASS_THROUGH"}
        try:
            if not self._job.hand_over(_SLICE):
                return {"PASS_THROUGH"}
            self._leave(context)
            self.tell_done(self._job.finish())
        except Cancelled:
            self._leave(context)
            self.cancelled()
            self.report({"WARNING"}, "Cancelled: the scene is as it was")
            return {"CANCELLED"}
        except Exception as error:
            self._leave(context)
            return self._refused(context, error)
        viewports.redraw()
        return {"FINISHED"}

    def cancel(self, context):
        """Called when Blender ends the operator: by Esc in its dialog, before there is work, or as another
        file is opened or the window is closed."""
        if self._job is None:
            return
        self._job.cancel()
        self._job.leave()
        self._leave(context)

    def _show_progress(self, context):
        fraction, text = self._job.state()
        activity = context.window_manager.realmodel
        activity.progress, activity.text = 100.0 * fraction, text
        context.window_manager.progress_update(100.0 * fraction)
        if context.workspace is not None:
            context.workspace.status_text_set(f"RealModel: {text}, {100 * fraction:.0f} %     Esc: cancel")
        viewports.redraw_sidebars()

    def _leave(self, context):
        """The work is over, whichever way; more than once does no harm."""
        if self._job not in running:
            return
        running.remove(self._job)
        manager = context.window_manager
        manager.realmodel.running = False
        manager.progress_end()
        if self._timer is not None:
            manager.event_timer_remove(self._timer)
            self._timer = None
        if context.workspace is not None:
            context.workspace.status_text_set(None)
        viewports.redraw()

    def _refused(self, context, error):
        self.report({"ERROR"}, notices.in_panel_words(build_job.message(error)))
        self.refused(context, error)
        viewports.redraw()
        return {"CANCELLED"}


def unregister():
    for job in list(running):
        job.cancel()
        job.wait()
        job.leave()
    running.clear()
