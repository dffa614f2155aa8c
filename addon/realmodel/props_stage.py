# SPDX-License-Identifier: GPL-3.0-or-later
"""The slider of the stage, from 0 to the number of the youngest surface: another way to set
`scene.realmodel.stage`."""

from . import props_slider

MOST = 100  # a model with more surfaces has the number field alone

DESCRIPTION = (
    "Replay deposition and erosion: 0 shows only the oldest surface, the last stage the whole model. "
    "The number beside the slider can be animated"
)


def name_of(last):
    """The slider of models whose youngest surface has the number `last`; None where there is none."""
    return props_slider.name_of(last) if 1 <= last <= MOST else None


RealModelStage = props_slider.slider_group(
    "RealModelStage",
    lambda group: group,
    "stage",
    range(1, MOST + 1),
    name="Stage",
    description=DESCRIPTION,
    min=0,
)
