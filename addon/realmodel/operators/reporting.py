# SPDX-License-Identifier: GPL-3.0-or-later
"""What every operator shares: errors become reports, and a poll that says why it cannot be used now.

A need is a function of the context: it returns None where the operator can be used, and else why not, in one
sentence. Blender shows it at the grayed-out button; in a script it is the text of the RuntimeError. Needs are
looked at whenever the panel is drawn, so they read nothing but the scene.
"""

import os

import bpy
from bpy.props import FloatVectorProperty, IntProperty, StringProperty

from ..bl.display import cuts
from ..bl.host import notices
from ..bl.objects import filled_beds, model_tree, viewports
from ..bl.project import project_settings, settings
from ..bl.scene import build_job
from ..core import Cancelled, InputRefused, RealModelError


class Reporting:
    """An operator whose `act(context)` may raise RealModelError: it is reported, which is a RuntimeError in a
    script, and nothing was done. `needs`: see above."""

    bl_options = {"REGISTER", "UNDO"}
    needs = ()

    def __init_subclass__(cls, **options):
        super().__init_subclass__(**options)
        cls.bl_idname = f"realmodel.{cls.__name__.removeprefix('REALMODEL_OT_')}"

    @classmethod
    def poll(cls, context):
        scene_needs = (scene_is_local_error,) if "UNDO" in cls.bl_options else ()
        for need in (*scene_needs, *cls.needs):
            reason = need(context)
            if reason:
                cls.poll_message_set(reason)
                return False
        return True

    def execute(self, context):
        try:
            return self.act(context) or {"FINISHED"}
        except RealModelError as error:
            self.report({"ERROR"}, build_job.message(error))
            return {"CANCELLED"}
        except OSError as error:  # what was typed can be no path, or nothing can be read or written there
            self.report({"ERROR"}, f"{str(error.filename or '')[:200]}: {error.strerror}; check the path")
            return {"CANCELLED"}


def scene_is_local_error(context):
    scene = context.scene
    if scene.library is None:
        return None
    return f"scene '{scene.name}' is linked from another file; make it local first"


def a_rock(context):
    row = settings.active_rock(context.scene)
    return "there is no rock mass; add one first (Rock Masses, +)" if row is None else None


def a_surface(context):
    row = settings.active_surface(context.scene)
    return "there is no surface; add one first (Surfaces, +)" if row is None else None


def a_structure(context):
    row = settings.active_structure(context.scene)
    return "the list is empty; add a fault or a body first" if row is None else None


def a_fault(context):
    row = settings.active_structure(context.scene)
    is_fault = row is not None and settings.kind_of(row) == "fault"
    return None if is_fault else "no fault is active; choose one in the list"


def a_body(context):
    row = settings.active_structure(context.scene)
    is_body = row is not None and settings.kind_of(row) == "body"
    return None if is_body else "no body is active; choose one in the list"


def any_surface(context):
    return (
        None if settings.has_rows(context.scene) else "the model has no surface; add one first (Surfaces, +)"
    )


def some_holes(context):
    has_holes = any(rock.hole_picks or rock.observations for rock in context.scene.realmodel.rocks)
    return None if has_holes else "there are no boreholes; import some first (Import Field Data)"


def an_ensemble(context):
    has_ensemble = bool(context.scene.realmodel.ensemble.table)
    return None if has_ensemble else "there is no ensemble; make one first (Ensemble)"


def a_model(context):
    return None if len(context.scene.realmodel.results) else "there is no model yet; press Build first"


def a_model_or_beds(context):
    if len(context.scene.realmodel.results) or filled_beds.shown(context.scene):
        return None
    return "there is no model yet; press Build first, or fill a mesh with strata"


def an_interface(context):
    row = settings.active_surface(context.scene)
    shown = row is not None and row.interface is not None and row.interface.name in context.view_layer.objects
    return None if shown else "the surface has no interface yet; press Build first"


def an_edit(context):
    return None if context.mode == "EDIT_MESH" else "nothing is being edited"


def object_mode(context):
    return None if context.mode == "OBJECT" else "an object is being edited; leave the mode first"


def a_library(context):
    return None if len(context.scene.realmodel.library) else "the library is empty; add a property first"


def a_section_plane(context):
    plane = cuts.plane_of(context.scene)
    return "there is no section plane; add one first (Section Plane)" if plane is None else None


def is_sheet(item):
    """Whether an object can be a surface of a new model: a mesh, and no result of the model that is there."""
    is_result = item.get(model_tree.TAG) in ("block", "section", "view")
    return settings.is_mesh_object(None, item) and not is_result


def selected_sheets(context):
    has_any = any(is_sheet(obj) for obj in context.selected_objects)
    return None if has_any else "no mesh object is selected but results; select surfaces of your model first"


def selected_shapes(context):
    has_shapes = any(settings.is_region_object(None, obj) for obj in context.selected_objects)
    return None if has_shapes else "no mesh object or curve is selected; select faults or bodies first"


def selected_blocks(context):
    selected = set(context.selected_objects)
    has_blocks = any(row.object in selected for row in context.scene.realmodel.results)
    return None if has_blocks else "no block is selected; select blocks of the model first"


def an_outline_object(context):
    obj = context.active_object
    has_lines = obj is not None and settings.is_region_object(None, obj)
    return None if has_lines else "the active object has no lines; make a curve or a mesh object active"


def a_viewport(context):
    return None if viewports.spaces(context) else "there is no 3D viewport; open one"


def building(context):
    return None if context.window_manager.realmodel.running else "nothing is being built"


def not_building(context):
    running = context.window_manager.realmodel.running
    return "RealModel is at work; wait, or cancel with Esc" if running else None


def place_property(description):
    """A property of an operator: a place in the coordinates of the scene."""
    return FloatVectorProperty(name="Location", description=description, subtype="TRANSLATION")


def row_number():
    """A property of an operator: which row of a list it is about."""
    return IntProperty(name="Number", description="Which of them, counted from 0", min=0)


def remove_row(rows, index, what):
    """Removes a row of a list. Raises InputRefused where there is none of this number."""
    if not 0 <= index < len(rows):
        raise InputRefused(f"there is no {what} {index}", advice="they are counted from 0")
    rows.remove(index)


def chosen_path(operator, what):
    """The absolute path of the file of an operator. Raises InputRefused where none was named."""
    if not operator.filepath.strip():
        raise InputRefused(f"no file for {what} was given", advice="choose a file name")
    return project_settings.absolute(operator.filepath)


def file_filter(*endings):
    return StringProperty(default=";".join(f"*{ending}" for ending in endings), options={"HIDDEN"})


def require_file(path):
    """Raises InputRefused where there is no such file."""
    if not os.path.isfile(path):  # also where it can be no path
        raise InputRefused(f"file not found: {path}", advice="check the path")


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
                self._show_progress(context)
                return {"PASS_THROUGH"}
            self._leave(context)
            self.tell_done(self._job.finish())
        except Cancelled:
            self._leave(context)
            self.cancelled()
            self.report({"WARNING"}, "Cancelled: the scene was not changed")
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
