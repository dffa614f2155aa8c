# SPDX-License-Identifier: GPL-3.0-or-later
"""Sliders whose upper end depends on the model.

Blender draws the bar of a slider between bounds that belong to the kind of property, not to the scene. So
there is one for every upper end, and the panel shows the one that fits; all of them are another way to set
one property, which holds the value and the keyframes.
"""

import bpy
from bpy.props import IntProperty


def name_of(most):
    """The slider that ends at `most`."""
    return f"of_{most}"


def slider_group(class_name, holder, key, ends, **shown):
    """A PropertyGroup with a slider for each of some ends. holder: gives, of scene.realmodel, the group with
    the property `key`, which they set. shown: name, description and min."""

    def slider(most):
        return IntProperty(
            max=most,
            get=lambda self: min(getattr(holder(self.id_data.realmodel), key), most),
            set=lambda self, value: setattr(holder(self.id_data.realmodel), key, value),
            options={"SKIP_SAVE"},  # and not ANIMATABLE: the keyframes are those of the property itself
            **shown,
        )

    return type(
        class_name,
        (bpy.types.PropertyGroup,),
        {
            "__doc__": f"`{key}` as a slider.",
            "__module__": __name__,
            "__annotations__": {name_of(most): slider(most) for most in ends},
        },
    )
