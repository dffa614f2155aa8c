# SPDX-License-Identifier: GPL-3.0-or-later
"""The model cut open along a movable plane: exactly, by the core, when the hand rests.

What stands on the side of the plane's Z axis is taken off; of each block its other half is shown, a closed
body whose cut is filled. The blocks themselves stay whole, only hidden.
"""

import json
import os
import threading
import time

import bpy
import numpy as np

from ...core import Cancelled, InputRefused, RealModelError
from .. import meshes, project_settings, scene, settings
from ..origin import offsets_from
from . import bodies, explosion, replacing, shown_models

REST_SECONDS = 0.08  # without a movement of the plane, after which the hand is taken to rest
_LOOK_SECONDS = 0.02
_changed_at = {}  # by the name of a scene: when its plane was moved
_jobs = {}  # by the name of a scene: the _Job that is under way
_halves = {}  # by the name of a scene: (what it was cut from and where, the half as a Model)


def is_on(current):
    """Whether a scene asks for the cut."""
    view = current.realmodel.view
    return view.use_section and plane_of(current) is not None and len(current.realmodel.results) > 0


def is_shown(current):
    """Whether the cut was made and is what is to be seen."""
    return is_on(current) and bool(current.realmodel.view.cut)


def plane_of(current):
    """The plane object, where it is still in the scene, or None."""
    item = current.realmodel.view.plane
    return item if item is not None and current in item.users_scene else None


def plane_in_model(current, matrix=None):
    """(point, normal) of the plane in model coordinates, (3,) float64 each. matrix: where it is in the world,
    if not where Blender last had it."""
    matrix = np.array(plane_of(current).matrix_world if matrix is None else matrix, np.float64)
    normal = np.cross(matrix[:3, 0], matrix[:3, 1])  # square to the plane, also where it is sheared
    length = np.linalg.norm(normal)
    if not length > 0.0:
        raise InputRefused("the section plane has no extent", advice="set its scale to 1")
    return matrix[:3, 3] + project_settings.model_origin(current), normal / length


def add_plane(current):
    """A plane through the middle of the model, upright, looking south; returns its object."""
    explosion.remember_bounds(current)
    low, high = explosion.bounds(current)
    middle, size = (low + high) / 2, 0.6 * float(np.linalg.norm(high - low))
    corners = size * np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], np.float32)
    mesh = meshes.new_mesh("Section plane", corners, np.array([0, 4]), np.arange(4))
    item = bpy.data.objects.new("Section plane", mesh)
    item[scene.TAG] = "view"
    item[bodies.KIND] = bodies.PLANE
    item.display_type = "WIRE"
    item.hide_render = True
    item.location = middle
    item.rotation_euler = (np.pi / 2, 0.0, 0.0)  # its Z axis to the south, where the standard front is
    bodies.view_collection(current).objects.link(item)
    return item


def remove_plane(current):
    """Removes the plane where it was made for this, lets go of it where it is an object of the user's."""
    view, item = current.realmodel.view, current.realmodel.view.plane
    with settings.filling():
        view.plane, view.use_section = None, False
    if item.get(bodies.KIND) == bodies.PLANE:
        mesh = item.data
        bpy.data.objects.remove(item)
        if not mesh.users:
            bpy.data.meshes.remove(mesh)
    bodies.remove_collection_if_empty(current)


def _state(current, stage, matrix=None):
    """What a cut is made of, as text: [point, normal, stage, stamp of the model]."""
    point, normal = plane_in_model(current, matrix)
    return json.dumps([point.tolist(), normal.tolist(), stage, current.realmodel.built_stamp])


def half(current, state, cells=None):
    """The half that is left by a cut, as a realmodel.core.Model. state: as `view.cut` has it. Raises
    RealModelError."""
    known, model = _halves.get(current.name, ("", None))
    if known == state and (cells is None or model.cell_kind == cells):
        return model
    point, normal, stage, _ = json.loads(state)
    model = shown_models.at_stage(current, stage, cells).cut_by_plane(point, normal).below
    _halves[current.name] = (state, model)
    return model


def cut_now(current, stage=None, matrix=None):
    """Makes the cut in this thread. Raises RealModelError; then the earlier one stays."""
    if matrix is None:
        _layer(current).update()  # the plane's matrix may be of before it was moved
    state = _state(current, current.realmodel.stage if stage is None else stage, matrix)
    model = half(current, state, _wanted_cells(current))
    _put(current, _shapes(model, project_settings.model_origin(current)), state)


def follow(current, depsgraph):
    """Another frame: whether the plane is elsewhere than where the cut was made; then it is made anew."""
    if not is_on(current):
        return False
    plane = plane_of(current)
    matrix = plane.matrix_world if depsgraph is None else plane.evaluated_get(depsgraph).matrix_world
    cut = json.loads(current.realmodel.view.cut or "[[], []]")
    if [found.tolist() for found in plane_in_model(current, matrix)] == cut[:2]:
        return False
    if bpy.app.background or replacing.is_rendering():
        cut_now(current, cut[2] if len(cut) > 2 else None, matrix)
        return True
    touch(current)
    return False


def refresh(current, stage=None):
    """Makes the cut anew: at once where nobody waits for the window, else when the hand rests."""
    if bpy.app.background or replacing.is_rendering():
        cut_now(current, stage)
    else:
        touch(current)


def _layer(current):
    windows = bpy.context.window_manager.windows
    return next((w.view_layer for w in windows if w.scene == current), current.view_layers[0])


def _wanted_cells(current):
    return "columns" if current.realmodel.display == "POLYHEDRA" else None


def _shapes(model, origin):
    """{(rock mass, block): arrays} of the blocks of a half."""
    found = {}
    for number, block in enumerate(model.blocks):
        if block.cells:
            shell = model.block_boundary(number)
            found[model.project.rocks[block.rock].name, block.name] = (
                offsets_from(origin, shell.vertices),
                shell.face_offsets.astype(np.int32),
                shell.face_vertices,
                shell.face_surface,
            )
    return found


def _put(current, shapes, state):
    rows = {(row.rock, row.name): row.object for row in current.realmodel.results}
    wanted = [(rows[key], *arrays) for key, arrays in shapes.items() if rows.get(key) is not None]
    bodies.put(current, bodies.CUT, wanted)
    current.realmodel.view.cut = state


def take_off(current):
    """Forgets the cut: the blocks are whole again."""
    bodies.remove(current, bodies.CUT)
    current.realmodel.view.cut = ""
    _halves.pop(current.name, None)


def touch(current):
    """The plane was moved, or the model is another: the cut is made when the hand rests."""
    _changed_at[current.name] = time.perf_counter()
    if not bpy.app.timers.is_registered(_look):
        bpy.app.timers.register(_look, first_interval=_LOOK_SECONDS)


class _Job:
    """One cut in a thread of its own."""

    def __init__(self, current):
        self.state = _state(current, current.realmodel.stage)
        self.shapes = self.model = self.error = None
        self.cancelled = False
        base = shown_models.at_stage(current, current.realmodel.stage, _wanted_cells(current))
        self._arguments = (base, *plane_in_model(current), project_settings.model_origin(current))
        self._thread = threading.Thread(target=self._work, name="realmodel section")
        self._thread.start()

    def _work(self):
        base, point, normal, origin = self._arguments
        try:
            threads = max(1, (os.cpu_count() or 1) - 1)  # one core is left to the window
            cut = base.cut_by_plane(point, normal, threads, cancel=lambda: self.cancelled)
            self.model = cut.below
            self.shapes = _shapes(cut.below, origin)
        except BaseException as error:  # told by the main thread
            self.error = error

    @property
    def done(self):
        return not self._thread.is_alive()

    def wait(self):
        self._thread.join()


def _look():
    """The timer: begins and finishes cuts; ends when there is nothing to do."""
    if not hasattr(bpy.types.Scene, "realmodel"):
        return None
    for name in list(_jobs):
        job = _jobs[name]
        if name in _changed_at:
            job.cancelled = True
        if job.done:
            del _jobs[name]
            _finish(name, job)
    for name, at in list(_changed_at.items()):
        if name not in _jobs and time.perf_counter() - at >= REST_SECONDS:
            del _changed_at[name]
            _begin(name)
    return _LOOK_SECONDS if _jobs or _changed_at else None


def _begin(name):
    current = bpy.data.scenes.get(name)
    if current is None or not is_on(current):
        return
    try:
        _layer(current).update()
        if _state(current, current.realmodel.stage) != current.realmodel.view.cut:
            _jobs[name] = _Job(current)
    except RealModelError as error:
        _tell(current, error)


def _finish(name, job):
    current = bpy.data.scenes.get(name)
    if current is None or not is_on(current) or isinstance(job.error, Cancelled):
        return
    if job.error is not None:
        _tell(current, job.error)
        return
    _halves[name] = (job.state, job.model)
    _put(current, job.shapes, job.state)
    _tell(current, None)
    from . import mode_changed

    mode_changed(current)


def _tell(current, error):
    current.realmodel.view.message = "" if error is None else str(error)
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "VIEW_3D":
                area.tag_redraw()


def is_working(current):
    """Whether a cut is under way."""
    return current.name in _jobs or current.name in _changed_at


def forget():
    """Lets go of halves; for another file, or another model."""
    _halves.clear()


def stop():
    """Ends what is under way."""
    for job in _jobs.values():
        job.cancelled = True
    for job in _jobs.values():
        job.wait()
    _jobs.clear()
    _changed_at.clear()
    forget()
    if bpy.app.timers.is_registered(_look):
        bpy.app.timers.unregister(_look)
