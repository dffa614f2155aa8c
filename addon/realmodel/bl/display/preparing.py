# SPDX-License-Identifier: GPL-3.0-or-later
"""Prepares shapes for the view in a thread while the window stays responsive: a stage that was not shown yet,
the cells of a large model. Then the view is updated again and finds them in the cache."""

import bpy

from ...core import Cancelled, RealModelError
from ...core.base import work
from ..host.debounce import DebouncedJob
from ..host.threads import threads
from ..objects import meshes, viewports
from . import cells, modes, replacing, shown_models


def lacks(scene, stage, mode):
    """Whether something is yet to be made to show a scene at a stage in a display mode; stage: None where the
    blocks have their shapes already. Where a window would freeze for it, it is begun."""
    if replacing.must_finish_now() or not scene.realmodel.built_stamp:  # without a stamp nothing is cached
        return False
    if not _is_missing(scene, stage, mode):
        return False
    _work.touch(scene.name)
    return True


def _is_missing(scene, stage, mode):
    if stage is not None and not shown_models.has_shapes(scene, stage):
        return True
    stage = scene.realmodel.stage if stage is None else stage
    return modes.needs_cells(scene, mode, stage) and not cells.CellRequest(scene, stage).is_ready


def _begin(name, _changed_at):
    scene = bpy.data.scenes.get(name)
    if scene is None or not len(scene.realmodel.results):
        return None
    group = scene.realmodel
    try:
        stage = shown_models.StageRequest(scene, group.stage)
        needs_cells = modes.needs_cells(scene, group.display, group.stage)
        wanted = cells.CellRequest(scene, group.stage) if needs_cells else None
    except RealModelError as error:
        group.view.message = str(error)
        return None

    def task(_):
        shapes = stage.make_shapes()
        if wanted is not None:
            wanted.make()
        return stage, shapes, wanted

    return work.start(task, threads())


def _hand_over(name, job):
    """Makes some of the meshes of cells that will be shown. Returns whether all are made. (The blocks' meshes
    are updated in place for a stage, so that references to them stay valid.)"""
    scene = bpy.data.scenes.get(name)
    if scene is None or not job.succeeded:
        return True
    if name not in _slices:
        _, _, wanted = job.result()
        coming = {} if wanted is None else wanted.shapes
        _slices[name] = meshes.slices((f"{block} cells", shape) for (_, block), shape in coming.items())
    return _slices[name].make(_SLICE)


def _finish(name, job, changed_at):
    try:
        _take(name, job)
    finally:
        slices = _slices.pop(name, None)
        if slices is not None:
            slices.clear()


def _take(name, job):
    scene = bpy.data.scenes.get(name)
    if scene is None or not len(scene.realmodel.results):
        return
    try:
        stage, shapes, wanted = job.result()
    except Cancelled:
        return
    except RealModelError as error:
        scene.realmodel.view.message = str(error)
        return
    if stage.stamp != scene.realmodel.built_stamp:
        return  # another model was built meanwhile, and shown
    stage.keep(shapes)
    if wanted is not None:
        wanted.keep()
    _show_all(scene)
    viewports.redraw()


def is_working(scene):
    """Whether something is being made for a scene."""
    return _work.is_working(scene.name)


def show_with(show_all):
    """Sets show_all(scene), which is called when the missing shapes have been made."""
    global _show_all
    _show_all = show_all


def stop():
    """Stops the running jobs."""
    _work.stop()
    for slices in _slices.values():
        slices.clear()
    _slices.clear()


_SLICE = 0.05  # seconds of making meshes, before the window is updated again
_slices = {}  # by the name of a scene: the meshes that are being made for it
_show_all = None
_work = DebouncedJob(lambda: 0.0, _begin, _finish, hand_over=_hand_over)
