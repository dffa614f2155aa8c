# SPDX-License-Identifier: GPL-3.0-or-later
"""Work that a handler of Blender asks for and a timer does: within undo, redo, loading and the evaluation of
objects Blender is not done yet, and what is read then may be gone, what is written lost."""

import bpy

_waiting = {}  # function: its arguments


def call(function, *arguments):
    """Calls a function once Blender is done, with the arguments of the last request; in background, where
    no timer runs, at once. arguments: no data of Blender's, but names."""
    if bpy.app.background:
        function(*arguments)
        return
    _waiting[function] = arguments
    if not bpy.app.timers.is_registered(_call_all):
        bpy.app.timers.register(_call_all, first_interval=0.0, persistent=True)


def is_waiting():
    return bool(_waiting)


def _call_all():
    while _waiting:
        function = next(iter(_waiting))
        function(*_waiting.pop(function))


def stop():
    """Discards what waits: the add-on is disabled."""
    _waiting.clear()
    if bpy.app.timers.is_registered(_call_all):
        bpy.app.timers.unregister(_call_all)
