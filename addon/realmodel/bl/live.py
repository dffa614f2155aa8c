# SPDX-License-Identifier: GPL-3.0-or-later
"""Building again on its own after a change, when the hand rests (`scene.realmodel.live`).

A handler of Blender's dependency graph tells of changed objects, the settings of changed rows. A timer waits
until nothing has changed for a moment, builds in a thread, and puts the result into the meshes that are
there. No undo step is made of it: an undone edit is an edit again, and is built from.
"""

import time
from contextlib import contextmanager

import bpy

from ..core import Cancelled

REST_SECONDS = 0.06  # without a change, after which the hand is taken to rest
_LOOK_SECONDS = 0.015  # between two looks at what goes on

_changed_at = {}  # by the name of a scene: when something changed that has not been built from yet
_jobs = {}  # by the name of a scene: (BuildJob, when its last change was)
_at_work = False  # what Blender tells of now is our own doing
measured = {}  # by the name of a scene: seconds from the last change to the new blocks


def touch(scene):
    """Something that the model of a scene depends on was changed."""
    if scene.realmodel.live:
        _changed_at[scene.name] = time.perf_counter()
        _look_soon()


def switched():
    """`live` was switched on or off in some scene, or another file was opened."""
    _changed_at.clear()
    for scene in bpy.data.scenes:
        touch(scene)


def changed(scene, depsgraph):
    """Blender has evaluated changed objects."""
    group = scene.realmodel
    if _at_work or not len(group.rocks):
        return
    edited = {update.id.original.name_full for update in depsgraph.updates if _counts(update)}
    if not edited:
        return
    for rock in group.rocks:
        if rock.region is not None and _names(rock.region) & edited:
            rock.region_area = -1.0
            touch(scene)
        for surface in rock.surfaces:
            made = surface.interface if surface.interface_digest else None
            if made is not None and _names(made) & edited:
                touch(scene)
            source = surface.object if surface.source in ("MESH_OBJECT", "POINTS_OBJECT") else None
            if source is not None and _names(source) & edited:
                touch(scene)


def _counts(update):
    is_shape = isinstance(update.id, (bpy.types.Object, bpy.types.Mesh, bpy.types.Curve))
    return is_shape and (update.is_updated_geometry or update.is_updated_transform)


def _names(item):
    return {item.name_full, item.data.name_full} if item.data is not None else {item.name_full}


def undone():
    """Blender has undone or redone something: what is on the screen may be of another build."""
    for scene in bpy.data.scenes:
        touch(scene)


def stop_work():
    """Stops builds that are under way, and forgets what they were for."""
    for job, _ in _jobs.values():
        job.cancel()
    for job, _ in _jobs.values():
        job.wait()
    _jobs.clear()
    _changed_at.clear()


def stop():
    """Ends everything: the add-on is disabled."""
    stop_work()
    measured.clear()
    if bpy.app.timers.is_registered(_look):
        bpy.app.timers.unregister(_look)


def _look_soon():
    if not bpy.app.timers.is_registered(_look):
        bpy.app.timers.register(_look, first_interval=_LOOK_SECONDS)


def _look():
    """The timer: finishes what is built, begins what waits; ends when there is nothing to do."""
    if not hasattr(bpy.types.Scene, "realmodel"):
        return None
    if bpy.context.window_manager.realmodel.running:
        return _LOOK_SECONDS
    for name in list(_jobs):
        _look_at_job(name)
    for name, at in list(_changed_at.items()):
        if name not in _jobs and time.perf_counter() - at >= REST_SECONDS:
            _begin(name)
    return _LOOK_SECONDS if _jobs or _changed_at else None


def _look_at_job(name):
    job, at = _jobs[name]
    if name in _changed_at:
        job.cancel()  # it is built from what is no longer so
    if not job.done:
        return
    del _jobs[name]
    try:
        with _our_own(bpy.data.scenes.get(name)):
            job.finish(in_place=True)
    except Cancelled:
        return
    except Exception as error:
        _tell(error)
    else:
        measured[name] = time.perf_counter() - at
        _tell(None)


@contextmanager
def _our_own(scene):
    """What is changed within is no edit. Blender's timers run when it has told of all edits before."""
    global _at_work
    _at_work = True
    try:
        yield
    finally:
        for layer in scene.view_layers if scene is not None else ():
            layer.update()  # Blender tells of it now
        _at_work = False


def _begin(name):
    from . import build_job

    at = _changed_at.pop(name)
    scene = bpy.data.scenes.get(name)
    if scene is None or not scene.realmodel.live:
        return
    layer = next((w.view_layer for w in bpy.context.window_manager.windows if w.scene == scene), None)
    layer = layer or scene.view_layers[0]
    try:
        with _our_own(scene):
            layer.update()
            job = build_job.BuildJob(scene, layer.depsgraph, "blocks", whole=False)
    except Exception as error:
        _tell(error)
        return
    job.start()
    _jobs[name] = (job, at)


def _tell(error):
    """The panel shows what is wrong, or no longer is; nothing is selected or moved for it."""
    from . import problems

    context = bpy.context
    problems.forget(context)
    if error is not None:
        problems.remember(context, error)
    for window in context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "VIEW_3D":
                area.tag_redraw()
