# SPDX-License-Identifier: GPL-3.0-or-later
"""The slider of the stage, from 0 to the number of the youngest surface.

Blender draws the bar of a slider between bounds that belong to the kind of property, not to the scene. So
there is one for every number of surfaces, and the panel shows the one that fits; all of them are another way
to set `scene.realmodel.stage`, which holds the value and the keyframes.
"""

import bpy
from bpy.props import IntProperty

MOST = 100  # a model with more surfaces has the number field alone

DESCRIPTION = (
    "Replay deposition and erosion: 0 shows only the oldest surface, the last stage the whole model. "
    "The number beside the slider can be animated"
)


def name_of(last):
    """The slider of models whose youngest surface has the number `last`; None where there is none."""
    return f"of_{last}" if 1 <= last <= MOST else None


def _slider(last):
    return IntProperty(
        name="Stage",
        description=DESCRIPTION,
        min=0,
        max=last,
        get=lambda self: min(self.id_data.realmodel.stage, last),
        set=lambda self, value: setattr(self.id_data.realmodel, "stage", value),
        options={"SKIP_SAVE"},  # and not ANIMATABLE: the keyframes are those of the stage itself
    )


RealModelStage = type(
    "RealModelStage",
    (bpy.types.PropertyGroup,),
    {
        "__doc__": "`scene.realmodel.stage` as a slider.",
        "__module__": __name__,
        "__annotations__": {name_of(last): _slider(last) for last in range(1, MOST + 1)},
    },
)

CLASSES = (RealModelStage,)
