# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings of the view beside `display`, `stage`, `explode` and `color_by`: `scene.realmodel.view`."""

import bpy


class RealModelView(bpy.types.PropertyGroup):
    """How the model is looked at."""


CLASSES = (RealModelView,)
