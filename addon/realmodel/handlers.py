# SPDX-License-Identifier: GPL-3.0-or-later
"""Handlers for opening, saving and undo in Blender: registered once, all removed again."""

import functools
import sys
import threading
import time

import bpy
from bpy.app.handlers import persistent

from . import versioning
from .bl import caches, display, live, quality, region_size, viewports
from .bl.display import replacing
from .bl.overlay import rendered
from .core import RealModelError

_PATIENCE = 5.0  # seconds that a render may wait for the window
_WHILE_DRAWING = "Writing to ID classes in this context is not allowed"


def _patient(handler):
    """Makes a handler of renders wait for the window. While Blender draws a panel in Python no other thread
    may write data, not even that of a render, whose handlers run beside the window."""

    @functools.wraps(handler)
    def patient(scene, *arguments):
        if threading.current_thread() is threading.main_thread():
            return handler(scene, *arguments)
        until, interval = time.monotonic() + _PATIENCE, sys.getswitchinterval()
        while True:
            sys.setswitchinterval(_PATIENCE)  # no panel may start to draw in between
            try:
                scene.realmodel.view.message = scene.realmodel.view.message
                return handler(scene, *arguments)
            except AttributeError as error:
                if _WHILE_DRAWING not in str(error) or time.monotonic() > until:
                    raise
            finally:
                sys.setswitchinterval(interval)
            time.sleep(0.002)

    return patient


@persistent
def _loaded(*_arguments):
    viewports.forget_status()
    display.stop()
    quality.stop()
    caches.clear()
    migrate_all()
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
    display.undoing()


@persistent
def _undone(*_arguments):
    display.undone()
    live.undone()


@persistent
def _changed(scene, depsgraph):
    live.changed(scene, depsgraph)
    display.changed(scene, depsgraph)


@persistent
@_patient
def _frame_changed(scene, depsgraph=None, *_arguments):
    display.frame_changed(scene, depsgraph)
    if replacing.is_rendering() and len(scene.realmodel.results) and scene.library is None:
        rendered.put(scene, depsgraph=depsgraph)


def migrate_all():
    """Migrates every scene of the file; a scene that cannot be migrated stays as it is, with a report."""
    for scene in bpy.data.scenes:
        try:
            versioning.migrate(scene)
        except RealModelError as error:
            _tell(f"scene '{scene.name}': {error}")


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


_HANDLERS = (
    ("load_post", _loaded),
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


def _migrate_at_start():
    """Called once, when Blender allows changes of data: not yet while an add-on is enabled."""
    if hasattr(bpy.types.Scene, "realmodel"):
        migrate_all()


def register():
    for name, handler in _HANDLERS:
        getattr(bpy.app.handlers, name).append(handler)
    bpy.app.timers.register(_migrate_at_start, first_interval=0.0)


def unregister():
    if bpy.app.timers.is_registered(_migrate_at_start):
        bpy.app.timers.unregister(_migrate_at_start)
    for name, handler in _HANDLERS:
        registered = getattr(bpy.app.handlers, name)
        if handler in registered:
            registered.remove(handler)
    live.stop()
    region_size.stop()
    viewports.forget_status()
    caches.clear()
