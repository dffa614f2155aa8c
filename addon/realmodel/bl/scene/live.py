# SPDX-License-Identifier: GPL-3.0-or-later
"""Live updates: the model is rebuilt after each change, after a short pause (`scene.realmodel.live`).

A handler of Blender's dependency graph reports changed objects; the update callbacks of the settings report
changed rows. A timer waits until nothing has changed for the length of the pause, builds in a thread, and
updates the existing meshes. Of series whose surfaces are level sets of a field, it first builds a coarse one,
which follows the hand, and once nothing changes any more the whole. It adds no undo step: undoing an edit is
one more edit, and starts a rebuild.

With live updates or without, a model is out of date where the fingerprint of what it was built from is not
that of the settings, objects and files as they are now.
"""

import time
from contextlib import contextmanager

import bpy

from ... import preferences
from ...core import Cancelled, RealModelError
from ..host import caches
from ..host.debounce import DebouncedJob
from ..objects import stored_arrays, viewports
from ..project import names, plan_mesh, project_settings, settings
from . import build_job, built_scene, problems, region_size

_SHORT_SECONDS = 0.5  # of the last rebuild: the next may take all processors

_at_work = False  # the changes that Blender reports now are the add-on's own
_stamps = caches.new()  # by the name of a scene: those of the files that its model is made from
measured = caches.new()  # by the name of a scene: seconds from the last change to the new blocks
_REFINE_SECONDS = 0.3  # without a change, after a coarse model, before the whole one is built
_CHECK_SECONDS = 0.3  # without a change, before the fingerprint of what a model is made from is taken
_WATCH_SECONDS = 2.0  # between two looks at the files
_CANCELLED = "the build was cancelled: press Build, or Auto builds after the next change"
_DIFFERS = "the model still differs from its input after a build: click Build"
_to_refine, _refined = set(), set()  # names of scenes: with a coarse model of the last change; in work
_again = set()  # names of scenes that are built though nothing was reported


def touch(scene):
    """Reports that input of a scene's model was changed."""
    _set_outdated(scene, len(scene.realmodel.results) > 0)
    _look_at(scene)


def check(scene):
    """Whether a scene's model is out of date: it was made from other settings, objects or files than there
    are now. `is_outdated` is set so."""
    group = scene.realmodel
    if len(group.results) and scene.library is None:
        try:
            now = project_settings.compose(scene, viewports.updated_layer(scene).depsgraph).fingerprint
        except RealModelError:
            now = None  # nothing is built from that
        _set_outdated(scene, now != group.built_from)
    return group.is_outdated


def _set_outdated(scene, is_outdated):
    if scene.realmodel.is_outdated != is_outdated:
        scene.realmodel.is_outdated = is_outdated
        viewports.redraw()


def _look_at(scene):
    """Reports that a scene's model may be another one than its input makes."""
    settings.keep_terrains(scene)
    names.store(scene)
    settings.follow_youngest(scene)
    _again.discard(scene.name)
    bpy.context.window_manager.realmodel.estimate = ""
    _checks.touch(scene.name)
    if scene.realmodel.live:
        _to_refine.discard(scene.name)
        _work.touch(scene.name)


def switched():
    """`live` was switched on or off in some scene, or another file was opened."""
    _work.forget_changes()
    undone()


def is_working():
    """Whether a rebuild is under way, or waits for a pause."""
    return _work.is_working()


def is_checking():
    """Whether it is still to be found out if a model is out of date."""
    return _checks.is_working()


def is_at_work():
    """Whether the changes that Blender reports now are the add-on's own."""
    return _at_work


def changed(scene, edited):
    """Blender has evaluated what has these names, as of `display.evaluated`, with another shape or place."""
    for rock in scene.realmodel.rocks:
        if rock.region is not None and _names(rock.region) & edited:
            rock.region_area = -1.0
            region_size.ask()
    for obj in _inputs(scene):
        if _names(obj) & edited:
            _edited(scene, obj)


def evaluate_sculpted(scene, depsgraph):
    """Has Blender evaluate objects of a model after a stroke in Sculpt Mode: by itself it does so only for
    objects with modifiers, and when the mode ends."""
    strokes = {
        update.id.original
        for update in depsgraph.updates
        if isinstance(update.id, bpy.types.Object)
        and update.is_updated_shading
        and not update.is_updated_geometry
        and update.id.original.mode == "SCULPT"
    }
    for obj in strokes.intersection(_inputs(scene)) if strokes else ():
        obj.update_tag(refresh={"DATA"})


def _inputs(scene):
    """The objects that a scene's model is made from."""
    for rock in scene.realmodel.rocks:
        if rock.region is not None:
            yield rock.region
        yield from plan_mesh.objects(rock)
    for _, row in settings.interface_rows(scene):
        if row.interface is not None and row.interface_digest:
            yield row.interface
        if row.object is not None and row.source in settings.OF_OBJECTS:
            yield row.object


def _edited(scene, obj):
    """Blender has evaluated an object that a model is made from. Only in these modes it is sure that it has
    another shape now."""
    if obj.mode in {"EDIT", "SCULPT"}:
        touch(scene)
    else:
        _look_at(scene)


def _names(obj):
    keys = {(True, obj.name_full)}
    return keys | {(False, obj.data.name_full)} if obj.data is not None else keys


def undone():
    """After undo and redo: the displayed blocks may be of another build."""
    for scene in bpy.data.scenes:
        if scene.library is None:
            _look_at(scene)


def stop_work():
    """Stops running builds and discards the changes that wait."""
    _work.stop_jobs()


def postpone_work(but=""):
    """Stops running builds for other work: they begin anew once it has ended. but: the name of a scene whose
    changes are discarded, as the other work builds it."""
    _work.postpone_jobs()
    _work.forget_changes(but)


def cancelled(name):
    """The build of a scene by hand was cancelled, and with it what Auto would have built: the panel says why
    the model stays out of date."""
    scene = bpy.data.scenes.get(name)
    if scene is not None and scene.realmodel.live and check(scene) and not _work.is_working(name):
        problems.tell(_CANCELLED)
        viewports.redraw()


def look_again(name):
    """The window of a build of a scene by hand was closed: Auto builds what it would have built."""
    _checks.touch(name)


def start():
    """The add-on is enabled: files are watched from now on."""
    if not bpy.app.background:
        bpy.app.timers.register(_watch, first_interval=_WATCH_SECONDS, persistent=True)


def stop():
    """Stops all work: the add-on is disabled."""
    _work.stop()
    _checks.stop()
    if bpy.app.timers.is_registered(_watch):
        bpy.app.timers.unregister(_watch)


def _watch():
    """The timer: looks whether the files of models are others now."""
    for scene in bpy.data.scenes:
        if len(scene.realmodel.results) and scene.library is None:
            stamps = [stored_arrays.file_stamp(path) for path in project_settings.files(scene)]
            if _stamps.setdefault(scene.name, stamps) != stamps:
                _stamps[scene.name] = stamps
                _checks.touch(scene.name)
    return _WATCH_SECONDS


def _begin_check(name, _changed_at):
    scene = bpy.data.scenes.get(name)
    if scene is None:
        return
    with _our_own(scene):
        is_outdated = check(scene)
    if not is_outdated or not scene.realmodel.live:
        _again.discard(name)
    elif not _work.is_working(name) and not bpy.context.window_manager.realmodel.problem:
        if name in _again:
            problems.tell(_DIFFERS)
            viewports.redraw()
        else:  # the input was changed as the build ended, or by what no handler sees
            _again.add(name)
            _work.touch(name)


def _finish(name, job, changed_at):
    try:
        with _our_own(bpy.data.scenes.get(name)):
            job.finish(in_place=True)
    except Cancelled:
        return
    except Exception as error:
        _tell(bpy.data.scenes.get(name), error)
    else:
        if name not in _refined:
            measured[name] = time.perf_counter() - changed_at
        _tell(None, None)
        _checks.touch(name)
        if job.is_coarse:
            _to_refine.add(name)
            _work.touch(name, later=_REFINE_SECONDS)


@contextmanager
def _our_own(scene):
    """Changes made within are the add-on's own, not edits."""
    global _at_work
    _report(scene)  # edits that Blender has not evaluated yet would be taken for ours
    _at_work = True
    try:
        yield
    finally:
        _report(scene)
        _at_work = False


def _report(scene):
    """Blender reports the changes of a scene now."""
    for layer in scene.view_layers if scene is not None else ():
        layer.update()


def _begin(name, _changed_at):
    scene = bpy.data.scenes.get(name)
    refines = name in _to_refine
    _to_refine.discard(name)
    (_refined.add if refines else _refined.discard)(name)
    if scene is None or not scene.realmodel.live:
        return None
    try:
        with _our_own(scene):
            layer = viewports.updated_layer(scene)
            built_scene.check_modes(scene)
            job = build_job.BuildJob(scene, layer.depsgraph, "blocks", whole=False, coarse=not refines)
    except Exception as error:
        _tell(scene, error)
        return None
    group = scene.realmodel
    if len(group.results) and not group.is_coarse and group.built_from == job.composed.fingerprint:
        _tell(None, None)
        _checks.touch(name)
        return None  # it is what is displayed: colors were written, or an edit was undone
    job.start(is_short=not refines and measured.get(name, 0.0) < _SHORT_SECONDS)
    return job


def _tell(scene, error):
    """Shows the error of a scene's model in the panel, or removes it; the selection and the view do not
    change."""
    problems.forget()
    if scene is not None:
        problems.remember(scene, error)
    viewports.redraw()


_work = DebouncedJob(
    lambda: preferences.current().live_pause,
    _begin,
    _finish,
    lambda: not bpy.context.window_manager.realmodel.running,
)
_checks = DebouncedJob(
    lambda: _CHECK_SECONDS,
    _begin_check,
    lambda *_: None,
    lambda: not bpy.context.window_manager.realmodel.running,
)
