# SPDX-License-Identifier: GPL-3.0-or-later
"""Text fields of the coordinates of a place. They are text, as Blender's numbers have 32 bits, which are too
coarse for map coordinates."""

import numpy as np
from bpy.props import StringProperty


def coordinate_field(name, axis, description, place, move):
    """A property with one coordinate of a place in the model. place(row): (3,), or None where there is none
    yet; move(row, place) takes another. Text that is not a number leaves the place as it is."""

    def get_text(row):
        at = place(row)
        return "" if at is None else f"{at[axis]:.3f}"

    def set_text(row, text):
        try:
            value = float(text.replace(",", ""))
        except ValueError:
            return
        at = place(row)
        if at is None or not np.isfinite(value):
            return
        at[axis] = value
        move(row, at)

    return StringProperty(name=name, description=description, options=set(), get=get_text, set=set_text)
