# SPDX-License-Identifier: GPL-3.0-or-later
"""What the scripts of this folder share: the add-on as Blender itself installed it."""

import importlib
import os
import sys
from pathlib import Path

import addon_utils
import bpy


def arguments():
    """What stands after "--", as Blender leaves it, or all of it where bpy is a module."""
    return sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else sys.argv[1:]


def name():
    """What Blender calls the add-on: "realmodel", or "bl_ext.user_default.realmodel" as an extension."""
    names = [m.__name__ for m in addon_utils.modules() if m.__name__.split(".")[-1] == "realmodel"]
    assert len(names) == 1, f"Blender knows {names or 'no add-on'} of that name"
    return names[0]


def package():
    """The add-on's module, after making sure that it is enabled and lies in this user's folder."""
    found = name()
    if not bpy.context.preferences.addons.get(found):
        # The module bpy reads no preferences; only there is it right that it is not enabled yet.
        assert not bpy.app.binary_path, f"{found} is installed but not enabled"
        bpy.ops.preferences.addon_enable(module=found)
    module = importlib.import_module(found)
    home = Path(os.environ["HOME"]).resolve()
    assert Path(module.__file__).resolve().is_relative_to(home), module.__file__
    return module


def part(path):
    """A part of the installed package, e.g. "bl.pictures.batch"."""
    return importlib.import_module(f"{name()}.{path}")


def disabled():
    """Disables it, and makes sure that nothing is left."""
    bpy.ops.preferences.addon_disable(module=name())
    for kind in (bpy.types.Scene, bpy.types.WindowManager):
        assert not hasattr(kind, "realmodel"), kind
    assert dir(bpy.ops.realmodel) == [], dir(bpy.ops.realmodel)


def leave():
    """Ends a script that has succeeded.

    As a module Blender 4.5 may wait for ever then, for one of its own threads, which is never asked to end.
    """
    if not bpy.app.binary_path:
        sys.stdout.flush()
        os._exit(0)


def check(condition, text):
    """An assertion that python -O and a reader see."""
    if not condition:
        raise AssertionError(text)
