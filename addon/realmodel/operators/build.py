# SPDX-License-Identifier: GPL-3.0-or-later
"""The build operator: blocking in scripts; with progress and Esc from the panel."""

import bpy

from ..bl.host import notices
from ..bl.jobs.estimate_job import EstimateJob
from ..bl.objects import viewports
from ..bl.project import results
from ..bl.scene import build_job, built_scene, live, problems
from ..core.base.errors import counted
from .pictures import by_hand, set_up_first
from .reporting import InBackground, Reporting, a_model, any_surface, building, not_building, running


class REALMODEL_OT_build(InBackground, bpy.types.Operator):
    """Build the blocks between the surfaces, oldest first. Esc cancels and leaves the scene unchanged"""

    bl_label = "Build"
    needs = (not_building,)

    _scene = ""  # the name of the scene that is built
    _is_first = False
    _spaces = ()  # pointers of the viewports that are turned to a first model

    def begin(self, context):
        problems.forget()
        self._scene = context.scene.name
        live.postpone_work(but=self._scene)
        self._is_first = len(context.scene.realmodel.results) == 0
        self._spaces = [space.as_pointer() for space in viewports.spaces(context)]
        built_scene.check_modes(context.scene)
        return build_job.BuildJob(context.scene, context.evaluated_depsgraph_get())

    def refused(self, context, error):
        problems.remember(bpy.data.scenes.get(self._scene, context.scene), error)

    def cancelled(self):
        live.cancelled(self._scene)

    def cancel(self, context):
        super().cancel(context)
        live.look_again(self._scene)

    def tell_done(self, model):
        scene = bpy.data.scenes.get(self._scene)
        if scene is not None and live.check(scene):
            self.report({"WARNING"}, "The model is out of date: what it is made from was changed meanwhile")
            live.touch(scene)  # Auto builds again
        has_picture = False
        if self._is_first and scene is not None:
            viewports.frame(scene, viewports.is_open(self._spaces))
            has_picture = by_hand(self) and set_up_first(scene)
        present = sum(block.cells > 0 for block in model.blocks)
        for warning in notices.shown(model):
            self.report({"WARNING"}, str(warning))
        seconds = sum(model.timings.values())
        renders = ": F12 renders it" if has_picture else ""
        self.report({"INFO"}, f"Built {counted(present, 'block')} in {seconds:.2f} s{renders}")


class REALMODEL_OT_estimate(InBackground, bpy.types.Operator):
    """Estimate the triangles of all surfaces, the nodes of fields, the memory and the time of a build. Esc
    cancels"""

    bl_label = "Estimate"
    bl_options = {"REGISTER"}
    needs = (any_surface, not_building)

    def begin(self, context):
        return EstimateJob(context.scene, context.evaluated_depsgraph_get())

    def refused(self, context, error):
        problems.remember(context.scene, error)

    def tell_done(self, found):
        self.report({"INFO"}, "; ".join(f"{name}: {value}" for name, value in found.rows()))


class REALMODEL_OT_cancel(Reporting, bpy.types.Operator):
    """Cancel the running build or Boolean and leave the scene unchanged"""

    bl_label = "Cancel"
    bl_options = {"REGISTER"}
    needs = (building,)

    def act(self, _context):
        for job in running:
            job.cancel()


class REALMODEL_OT_clear(Reporting, bpy.types.Operator):
    """Remove the blocks; keep the interfaces and all settings"""

    bl_label = "Clear Blocks"
    needs = (a_model,)

    def act(self, context):
        built_scene.clear(context.scene)


def _a_bad_place(context):
    return None if problems.has_place(context) else "no surface was refused by the last build"


class REALMODEL_OT_show_problem(Reporting, bpy.types.Operator):
    """Select the triangles of the refused surface in Edit Mode, or move the 3D cursor to the error, and zoom
    in"""

    bl_label = "Zoom to Error"
    needs = (_a_bad_place,)

    def act(self, context):
        problems.show(context)


def a_message(context):
    message = context.window_manager.realmodel.problem or context.scene.realmodel.warnings
    return None if message else "there is no message"


class REALMODEL_OT_dismiss(Reporting, bpy.types.Operator):
    """Remove the message from the panel. The report of the model keeps its warnings"""

    bl_label = "Dismiss Message"
    bl_options = {"REGISTER", "INTERNAL"}
    needs = (a_message,)

    def act(self, context):
        if context.window_manager.realmodel.problem:
            problems.forget()
        else:
            context.scene.realmodel.warnings = ""


class REALMODEL_OT_copy_table(Reporting, bpy.types.Operator):
    """Copy the table of blocks to the clipboard, for a spreadsheet"""

    bl_label = "Copy Table"
    bl_options = {"REGISTER"}
    needs = (a_model,)

    def act(self, context):
        context.window_manager.clipboard = results.as_text(context.scene, "\t")
        self.report({"INFO"}, f"Copied {counted(len(context.scene.realmodel.results), 'row')}")
