# SPDX-License-Identifier: GPL-3.0-or-later
"""RealModel: models of sedimentary rock, built from the surfaces that bound its layers.

The package is an add-on of Blender and a plain Python package at once: `realmodel.core` needs NumPy
only. Nothing of Blender is imported before `register()` is called.
"""

import sys
from pathlib import Path

bl_info = {
    "name": "RealModel",
    "author": "The RealModel authors",
    "version": (0, 1, 0),
    "blender": (3, 4, 0),
    "location": "3D Viewport > Sidebar > RealModel",
    "description": "Exact models of sedimentary rock from the surfaces that bound its layers",
    "category": "3D View",
}


def register():
    """Called by Blender when the add-on is enabled. Modules that need Blender are imported here, not
    before."""
    if sys.version_info < (3, 11):  # noqa: UP036 (in Blender it is not ours to choose)
        raise RuntimeError(
            "RealModel needs Python 3.11 or newer, and this Blender has "
            f"{sys.version_info.major}.{sys.version_info.minor}: use Blender 4.1 or newer"
        )
    if __name__ == "realmodel" and (Path(__file__).parent / "wheels").is_dir():
        from .core.base.packages import explanation

        raise RuntimeError(explanation(ImportError()))
    from . import handlers, operators, preferences, props, props_strata, ui
    from .bl import display
    from .bl.field import shown
    from .bl.overlay import viewport

    done = []
    try:
        for part in (
            preferences,
            props,
            props_strata,
            operators,
            ui,
            display,
            shown,
            viewport.handler,
            handlers,
        ):
            part.register()
            done.append(part)
    except BaseException:
        for part in reversed(done):
            part.unregister()
        raise
    _at_exit(True)


def register_for_batch():
    """Registers this copy of RealModel where none is, or another one: build_model.py brings its own along."""
    import bpy

    pointer = bpy.types.Scene.bl_rna.properties.get("realmodel")
    owner = type(pointer.fixed_type).__module__.rpartition(".")[0] if pointer else None
    if owner != __name__:
        if owner:
            sys.modules[owner].unregister()
        register()


def unregister():
    """Called by Blender when the add-on is disabled; nothing stays: no class, property, handler, timer."""
    _at_exit(False)
    from . import handlers, operators, preferences, props, props_strata, ui
    from .bl import display
    from .bl.field import shown
    from .bl.overlay import viewport

    for part in (handlers, viewport.handler, shown, display, ui, operators, props_strata, props, preferences):
        part.unregister()


def _at_exit(wanted):
    """Blender disables its add-ons when it ends. The module bpy does not, and then takes a minute to free
    registered data."""
    import atexit

    import bpy

    if getattr(bpy.app, "module", False):
        atexit.unregister(unregister)
        if wanted:
            atexit.register(unregister)
