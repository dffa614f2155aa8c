# SPDX-License-Identifier: GPL-3.0-or-later
"""Building: at once for scripts; with progress and Esc from the panel."""

import bpy

from ..bl import build_job, built_scene, live, problems, viewports
from ..core import Cancelled, RealModelError
from .reporting import Reporting, a_model, building, not_building

_STEP = 0.05  # seconds between two looks at the work
_SLICE = 0.05  # seconds in which Blender is given meshes, before the window is looked after again


class REALMODEL_OT_build(Reporting, bpy.types.Operator):
    """Build the blocks between the surfaces, oldest first. Esc cancels and leaves the scene unchanged"""

    bl_idname = "realmodel.build"
    bl_label = "Build"
    needs = (not_building,)

    _job = None
    _timer = None
    _scene = ""  # whose model is built, and whether it is its first one
    _is_first = False
    _spaces = ()  # pointers of the viewports that are turned to a first model

    def act(self, context):
        live.stop_work()
        problems.forget()
        self._remember_view(context)
        built_scene.check_modes(context.scene)
        job = build_job.BuildJob(context.scene, context.evaluated_depsgraph_get())
        self._tell_done(job.run())

    def invoke(self, context, event):
        if bpy.app.background or context.window is None:
            return self.execute(context)
        live.stop_work()
        problems.forget()
        self._remember_view(context)
        try:
            built_scene.check_modes(context.scene)
            self._job = build_job.BuildJob(context.scene, context.evaluated_depsgraph_get())
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
            self._tell_done(self._job.finish())
        except Cancelled:
            self.report({"WARNING"}, "Cancelled: the scene is as it was")
            return {"CANCELLED"}
        except Exception as error:
            self._leave(context)
            return self._refused(context, error)
        viewports.redraw()
        return {"FINISHED"}

    def cancel(self, context):
        """Blender ends the operator: another file is opened, or the window is closed."""
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
        """The build is over, whichever way; more than once does no harm."""
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
        self.report({"ERROR"}, build_job.message(error))
        problems.remember(bpy.data.scenes.get(self._scene, context.scene), error)
        viewports.redraw()
        return {"CANCELLED"}

    def _remember_view(self, context):
        self._scene = context.scene.name
        self._is_first = len(context.scene.realmodel.results) == 0
        self._spaces = [space.as_pointer() for space in viewports.spaces(context)]

    def _tell_done(self, model):
        scene = bpy.data.scenes.get(self._scene)
        if self._is_first and scene is not None:
            viewports.frame(scene, viewports.still_open(self._spaces))
        present = sum(block.cells > 0 for block in model.blocks)
        for warning in model.warnings:
            self.report({"WARNING"}, str(warning))
        seconds = sum(model.timings.values())
        blocks = "1 block" if present == 1 else f"{present} blocks"
        self.report({"INFO"}, f"Built {blocks} in {seconds:.2f} s")


running = []  # the jobs of builds that are shown with progress


class REALMODEL_OT_cancel(Reporting, bpy.types.Operator):
    """Cancel the running build and leave the scene unchanged"""

    bl_idname = "realmodel.cancel"
    bl_label = "Cancel Build"
    bl_options = {"REGISTER"}
    needs = (building,)

    def act(self, _context):
        for job in running:
            job.cancel()


class REALMODEL_OT_clear(Reporting, bpy.types.Operator):
    """Remove the blocks; keep the interfaces and all settings"""

    bl_idname = "realmodel.clear"
    bl_label = "Clear Blocks"
    needs = (a_model,)

    def act(self, context):
        built_scene.clear(context.scene)


def _a_bad_place(context):
    return None if problems.has_place(context) else "no surface was refused by the last build"


class REALMODEL_OT_show_problem(Reporting, bpy.types.Operator):
    """Select the triangles of the refused surface in Edit Mode, and frame them"""

    bl_idname = "realmodel.show_problem"
    bl_label = "Zoom to Error"
    needs = (_a_bad_place,)

    def act(self, context):
        problems.show(context)


def a_message(context):
    told = context.window_manager.realmodel.problem or context.scene.realmodel.warnings
    return None if told else "there is no message"


class REALMODEL_OT_dismiss(Reporting, bpy.types.Operator):
    """Take the message out of the panel; the report of the model keeps its warnings"""

    bl_idname = "realmodel.dismiss"
    bl_label = "Dismiss Message"
    bl_options = {"REGISTER", "INTERNAL"}
    needs = (a_message,)

    def act(self, context):
        if context.window_manager.realmodel.problem:
            problems.forget()
        else:
            context.scene.realmodel.warnings = ""


CLASSES = (
    REALMODEL_OT_build,
    REALMODEL_OT_cancel,
    REALMODEL_OT_clear,
    REALMODEL_OT_show_problem,
    REALMODEL_OT_dismiss,
)


def unregister():
    for job in list(running):
        job.cancel()
        job.wait()
        job.leave()
    running.clear()
