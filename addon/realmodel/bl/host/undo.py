# SPDX-License-Identifier: GPL-3.0-or-later
"""Undo and redo of scenes that were changed without an undo step, as live builds do.

Blender does not read datablocks that are the same in both undo steps: they stay as they are in memory, with
their pointers. These may be to datablocks that the step does not have and that Blender therefore frees; the
next look at such a pointer ends Blender. It reads all datablocks of the step while global undo is switched
off in the preferences.
"""

import bpy

_is_off = False  # by `begins`


def begins():
    """Called before undo and redo: Blender is to read all datablocks of the step."""
    edit = bpy.context.preferences.edit
    if edit.use_global_undo and any(scene.realmodel.exists for scene in bpy.data.scenes):
        _switch(False)


def ended():
    """Called after undo and redo."""
    if _is_off:
        _switch(True)


def _switch(is_on):
    global _is_off
    preferences = bpy.context.preferences
    was_dirty = preferences.is_dirty
    preferences.edit.use_global_undo = is_on
    preferences.is_dirty = was_dirty  # there is nothing to save
    _is_off = not is_on
