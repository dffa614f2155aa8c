# SPDX-License-Identifier: GPL-3.0-or-later
"""The model cut open along a movable plane: exactly, by the core, after a short pause.

What stands on the side of the plane's Z axis is taken off; of each block its other half is shown, a closed
body whose cut is filled. The blocks themselves stay whole, only hidden.
"""

import json

import bpy
import numpy as np

from ...core import Cancelled, InputRefused, RealModelError
from ...core.base import work
from ...core.display import polygon_mesh
from ...core.display.polygon_mesh import PolygonMesh
from ..host import caches
from ..host.debounce import DebouncedJob
from ..host.threads import threads
from ..objects import block_shapes, exaggeration, meshes, model_tree, viewports
from ..project import compartments, project_settings, settings
from . import bodies, explosion, replacing, shown_models

REST_SECONDS = 0.08  # pause after a movement of the plane, before it cuts
_halves = caches.new(most=1)  # by model and plane: the half as a Model


def is_on(scene):
    """Whether the cut of a scene is switched on."""
    view = scene.realmodel.view
    return view.use_section and plane_of(scene) is not None and len(scene.realmodel.results) > 0


def is_shown(scene):
    """Whether the cut was made and is displayed."""
    return is_on(scene) and bool(scene.realmodel.view.cut)


def plane_of(scene):
    """The plane object, where it is still in the scene, or None."""
    plane = scene.realmodel.view.plane
    return plane if plane is not None and scene in plane.users_scene else None


def plane_in_model(scene, matrix=None):
    """(point, normal) of the plane in model coordinates, (3,) float64 each. matrix: where it is in the world,
    if not where Blender last had it."""
    matrix = np.array(plane_of(scene).matrix_world if matrix is None else matrix, np.float64)
    stretched = exaggeration.matrix(scene)
    normal = stretched[:3, :3].T @ np.cross(matrix[:3, 0], matrix[:3, 1])  # also of a plane that is sheared
    length = np.linalg.norm(normal)
    if not length > 0.0:
        raise InputRefused("the section plane has no extent", advice="set its scale to 1")
    point = np.linalg.solve(stretched, matrix[:, 3])[:3]
    return point + project_settings.model_origin(scene), normal / length


def place(scene):
    """(3,) where the plane is, in model coordinates; None where there is none."""
    return None if plane_of(scene) is None else plane_in_model(scene)[0]


def move(scene, place):
    """Moves the plane to a place in model coordinates; it stays parallel."""
    plane = plane_of(scene)
    matrix = plane.matrix_world.copy()
    matrix.translation = project_settings.in_world(scene, place)[0]
    plane.matrix_world = matrix


def add_plane(scene):
    """A plane through the middle of the model, upright, looking south; returns its object."""
    low, high = explosion.bounds(scene)
    middle, size = (low + high) / 2, 0.6 * float(np.linalg.norm(high - low))
    mesh = meshes.new_mesh("Section plane", _square(size))
    plane = bpy.data.objects.new("Section plane", mesh)
    plane[model_tree.TAG] = "view"
    plane[bodies.KIND] = bodies.PLANE
    plane.display_type = "WIRE"
    plane.hide_render = True
    plane.location = middle
    plane.rotation_euler = (np.pi / 2, 0.0, 0.0)  # its Z axis to the south, where the standard front is
    bodies.view_collection(scene).objects.link(plane)
    return plane


def _square(size):
    corners = size * np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], np.float32)
    return PolygonMesh(corners, np.array([0, 4], np.int32), np.arange(4, dtype=np.int32))


def remove_plane(scene):
    """Removes the plane if it was made for the cut; an object of the user stays."""
    view, plane = scene.realmodel.view, scene.realmodel.view.plane
    with settings.filling():
        view.plane, view.use_section = None, False
    if plane.get(bodies.KIND) == bodies.PLANE:
        mesh = plane.data
        bpy.data.objects.remove(plane)
        if not mesh.users:
            bpy.data.meshes.remove(mesh)
    bodies.remove_collection_if_empty(scene)


def _state(scene, stage, matrix=None):
    """The state that a cut is made from, as text: [point, normal, stage, stamp of the model]."""
    point, normal = plane_in_model(scene, matrix)
    return json.dumps([point.tolist(), normal.tolist(), stage, scene.realmodel.built_stamp])


def known_half(state, cells=None):
    """The remaining half of a cut, as a realmodel.core.Model; None where it is not in the cache. state: as of
    `view.cut`."""
    model = _halves.get(state)
    return model if cells is None or (model is not None and model.cell_kind == cells) else None


def cut_now(scene, stage=None, matrix=None):
    """Makes the cut in this thread. Raises RealModelError; then the earlier one stays."""
    if matrix is None:
        viewports.updated_layer(scene)  # the plane's matrix may be of before it was moved
    state = _state(scene, scene.realmodel.stage if stage is None else stage, matrix)
    job = _begun(scene, state)
    _take(scene, job.result())


def follow(scene, depsgraph):
    """The frame was changed: updates the cut if the plane has moved."""
    if not is_on(scene):
        return False
    plane = plane_of(scene)
    matrix = plane.matrix_world if depsgraph is None else plane.evaluated_get(depsgraph).matrix_world
    cut = json.loads(scene.realmodel.view.cut or "[[], []]")
    if [vector.tolist() for vector in plane_in_model(scene, matrix)] == cut[:2]:
        return False
    if replacing.must_finish_now():
        cut_now(scene, cut[2] if len(cut) > 2 else None, matrix)
        return True
    touch(scene)
    return False


def refresh(scene, stage=None):
    """Updates the cut: at once in background mode, otherwise after a short pause."""
    if replacing.must_finish_now():
        cut_now(scene, stage)
    else:
        touch(scene)


def _wanted_cells(scene):
    return "columns" if scene.realmodel.display == "POLYHEDRA" else None


def _put(scene, shapes, state):
    rows = {(row.rock, row.name): row.object for row in scene.realmodel.results}
    wanted = [(rows[key], shape) for key, shape in shapes.items() if rows.get(key) is not None]
    bodies.put(scene, bodies.CUT, wanted)
    scene.realmodel.view.cut = state


def take_off(scene):
    """Removes the cut: the blocks are shown whole again."""
    bodies.remove(scene, bodies.CUT)
    _halves.pop(scene.realmodel.view.cut, None)
    scene.realmodel.view.cut = ""


def touch(scene):
    """The plane was moved, or the model is another: the cut is made after a short pause."""
    _work.touch(scene.name)


def _begun(scene, state):
    """A job that makes a cut; its result is what `_take` takes. Raises InputRefused."""
    point, normal, stage, _ = json.loads(state)
    request = shown_models.StageRequest(scene, stage, _wanted_cells(scene))
    names = compartments.names(scene) or None
    half, origin = known_half(state, _wanted_cells(scene)), project_settings.model_origin(scene)

    def task(_):
        model = half
        if model is None:
            model = request.make().cut_by_plane(point, normal, threads=threads()).below
        made = polygon_mesh.of_blocks(model, origin, threads(), compartments=names)
        shapes = block_shapes.by_name(model, made)
        return state, model, shapes, request

    return work.start(task, threads())


def _take(scene, made):
    """Shows the halves that a job has made, and caches them."""
    state, model, shapes, request = made
    request.keep()
    _halves[state] = model
    _put(scene, shapes, state)


def _begin(name, _changed_at):
    scene = bpy.data.scenes.get(name)
    if scene is None or not is_on(scene):
        return None
    try:
        viewports.updated_layer(scene)
        state = _state(scene, scene.realmodel.stage)
        if state != scene.realmodel.view.cut:
            return _begun(scene, state)
    except RealModelError as error:
        _tell(scene, error)
    return None


def _finish(name, job, _changed_at):
    scene = bpy.data.scenes.get(name)
    if scene is None or not is_on(scene):
        return
    try:
        _take(scene, job.result())
    except Cancelled:
        return
    except RealModelError as error:
        _tell(scene, error)
        return
    _tell(scene, None)
    _show(scene)


def _tell(scene, error):
    scene.realmodel.view.message = "" if error is None else str(error)
    viewports.redraw()


def is_working(scene):
    """Whether a cut is under way."""
    return _work.is_working(scene.name)


def show_with(show):
    """Sets show(scene), which is called when a cut was made in the background."""
    global _show
    _show = show


def stop():
    """Stops the running jobs."""
    _work.stop()


_show = None
_work = DebouncedJob(lambda: REST_SECONDS, _begin, _finish)
