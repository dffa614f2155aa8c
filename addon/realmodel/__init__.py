# SPDX-License-Identifier: GPL-3.0-or-later
"""RealModel: models of sedimentary rock, built from the surfaces that bound its layers.

The package is an add-on of Blender and a plain Python package at once: `realmodel.core` needs NumPy
only. Nothing of Blender is imported before `register()` is called.
"""

bl_info = {
    "name": "RealModel",
    "author": "The RealModel authors",
    "version": (0, 1, 0),
    "blender": (3, 4, 0),
    "location": "Batch: build_model.py",
    "description": "Exact models of sedimentary rock from the surfaces that bound its layers",
    "category": "3D View",
}


def register():
    """Called by Blender when the add-on is enabled.

    The parts that need Blender are imported here and not before. They register no classes of Blender
    yet: the add-on gives scripts `realmodel.core` and `realmodel.bl`.
    """
    from . import bl  # noqa: F401


def unregister():
    """Called by Blender when the add-on is disabled; nothing was registered that would stay."""
