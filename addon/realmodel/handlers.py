# SPDX-License-Identifier: GPL-3.0-or-later
"""Handlers for opening, saving and undo in Blender: registered once, all removed again."""

import functools
import sys
import threading
import time

import bpy
from bpy.app.handlers import persistent

from .bl import display
from .bl.display import replacing
from .bl.field import handle
from .bl.host import afterwards, caches, undo
from .bl.objects import viewports
from .bl.overlay import rendered
from .bl.project import settings
from .bl.scene import live, migration, quality, region_size
from .bl.shading import strata_modifier

_PATIENCE = 5.0  # seconds that a render may wait for the window
_evaluated = caches.new()  # by the name of a scene: the names of objects and data that Blender evaluated
_INTERVAL = sys.getswitchinterval()  # not asked for later: another render thread may have set it
_WHILE_DRAWING = "Writing to ID classes in this context is not allowed"


def _patient(handler):
    """Makes a handler of renders wait for the window. While Blender draws a panel in Python no other thread
    may write data, not even that of a render, whose handlers run beside the window: the flag is Blender's
    own, of all threads. So the handler begins where none is drawn (the first line writes, to find out), and
    Python keeps this thread at work until it ends: it changes threads after the switch interval (5 ms) only,
    and a panel that began to draw in between would make the handler fail half way. No lock of ours would do
    that, as the drawing of panels is begun by Blender and takes none but Python's."""

    @functools.wraps(handler)
    def patient(scene, *arguments):
        if threading.current_thread() is threading.main_thread():
            return handler(scene, *arguments)
        until = time.monotonic() + _PATIENCE
        while True:
            sys.setswitchinterval(_PATIENCE)
            try:
                scene.realmodel.view.message = scene.realmodel.view.message
                return handler(scene, *arguments)
            except AttributeError as error:
                if _WHILE_DRAWING not in str(error) or time.monotonic() > until:
                    raise
            finally:
                sys.setswitchinterval(_INTERVAL)
            time.sleep(0.002)

    return patient


@persistent
def _loaded(*_arguments):
    viewports.forget_status()
    display.stop()
    quality.stop()
    caches.clear()
    migration.migrate_all()
    afterwards.call(_take_opened)


def _take_opened():
    check_versions()
    display.opened()
    live.switched()
    region_size.ask()


@persistent
def _before_loading(*_arguments):
    live.stop_work()
    quality.stop()


def _tell(text):
    """The panel shows it, and whoever reads the console."""
    print(f"RealModel: {text}")
    bpy.context.window_manager.realmodel.problem = text


@persistent
def _undoing(*_arguments):
    undo.begins()


@persistent
def _undone(*_arguments):
    undo.ended()
    display.forget_meshes()
    afterwards.call(_take_undone)


def _take_undone():
    display.undone()
    live.undone()


@persistent
def _changed(scene, depsgraph):
    live.evaluate_sculpted(scene, depsgraph)
    item = depsgraph.view_layer.objects.active
    if item is not None and item.mode in strata_modifier.MODES and strata_modifier.shows_erosion(item):
        afterwards.call(strata_modifier.show_edited, item.name)
    names = display.evaluated(depsgraph)
    if names and not live.is_at_work():
        _evaluated.setdefault(scene.name, set()).update(names)
        afterwards.call(_take_evaluated)


def _take_evaluated():
    changed = dict(_evaluated)
    _evaluated.clear()
    for name, names in changed.items():
        scene = bpy.data.scenes.get(name)
        if scene is not None and scene.library is None:
            live.changed(scene, names)
            handle.changed(scene, names)
            display.changed(scene, names)


@persistent
@_patient
def _frame_changed(scene, depsgraph=None, *_arguments):
    display.frame_changed(scene, depsgraph)
    if replacing.is_rendering() and len(scene.realmodel.results) and scene.library is None:
        rendered.put(scene, depsgraph=depsgraph)


def check_versions():
    """Reports scenes whose settings are of a version that `migration` does not know."""
    for scene in bpy.data.scenes:
        group = scene.realmodel
        if group.exists and group.version != settings.VERSION:
            writer = "a newer version" if group.version > settings.VERSION else "a test version"
            _tell(f"scene '{scene.name}' was saved by {writer} of RealModel: check its settings")


@persistent
@_patient
def _render_begins(scene, *_arguments):
    display.render_begins(scene)
    if len(scene.realmodel.results) and scene.library is None:
        rendered.put(scene)


@persistent
@_patient
def _render_ends(scene, *_arguments):
    if scene.library is None:
        rendered.remove(scene)
    display.render_ends(scene)


@persistent
def _imported(*_arguments):
    migration.migrate_all()


_HANDLERS = (
    ("load_post", _loaded),
    ("blend_import_post", _imported),  # of Blender 4.3 and later
    ("load_pre", _before_loading),
    ("undo_pre", _undoing),
    ("redo_pre", _undoing),
    ("undo_post", _undone),
    ("redo_post", _undone),
    ("depsgraph_update_post", _changed),
    ("frame_change_post", _frame_changed),
    ("render_init", _render_begins),
    ("render_complete", _render_ends),
    ("render_cancel", _render_ends),
)


def register():
    for name, handler in _HANDLERS:
        getattr(bpy.app.handlers, name, []).append(handler)
    live.start()


def unregister():
    for name, handler in _HANDLERS:
        registered = getattr(bpy.app.handlers, name, [])
        if handler in registered:
            registered.remove(handler)
    afterwards.stop()
    live.stop()
    region_size.stop()
    viewports.forget_status()
    caches.clear()
