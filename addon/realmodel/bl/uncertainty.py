# SPDX-License-Identifier: GPL-3.0-or-later
"""How sure the heights of an interpolated interface are, as attributes of its mesh."""

import numpy as np

# Vertex attributes of an interface: the variance of its height, squared model units, and the distance in
# plan to the nearest point that it was interpolated from, model units. What is not known is -1.
VARIANCE = "variance"
DISTANCE = "distance"
# The colour attribute: the standard deviation, from 0 (dark blue) to the most of the mesh (yellow).
UNCERTAINTY = "uncertainty"
UNKNOWN = -1.0
_UNKNOWN_COLOUR = (0.35, 0.35, 0.35)
# Cividis (Nunez, Anderton, Renslow 2018, PLoS ONE 13): even in lightness, also for the colour-blind. sRGB.
_SCALE = np.array(
    [
        (0.000, 0.135, 0.305),
        (0.215, 0.265, 0.425),
        (0.415, 0.420, 0.450),
        (0.620, 0.580, 0.465),
        (0.835, 0.760, 0.400),
        (0.995, 0.910, 0.215),
    ]
)


def add_attributes(mesh, attributes):
    """Gives the mesh of an interface what is known of its vertices, where anything is.

    mesh: bpy.types.Mesh. attributes: as Model.surface_attributes returns them, of the same vertices.
    """
    for name in (VARIANCE, DISTANCE):
        values = attributes[name]
        if np.isfinite(values).any():
            layer = mesh.attributes.new(name, "FLOAT", "POINT")
            layer.data.foreach_set("value", np.where(np.isfinite(values), values, UNKNOWN).astype(np.float32))
    if np.isfinite(attributes[VARIANCE]).any():
        layer = mesh.color_attributes.new(UNCERTAINTY, "BYTE_COLOR", "POINT")
        layer.data.foreach_set("color_srgb", colours(attributes[VARIANCE]).ravel())
        mesh.color_attributes.active_color_index = 0  # what viewports show


def colours(variance):
    """(V, 4) float32 sRGB colours of variances (V,): the standard deviation on the scale, grey where NaN."""
    known = np.isfinite(variance)
    deviation = np.sqrt(np.where(known, np.maximum(variance, 0.0), 0.0))
    most = deviation.max(initial=0.0)
    share = deviation / most if most > 0 else deviation
    steps = np.linspace(0.0, 1.0, len(_SCALE))
    found = np.ones((len(variance), 4), np.float32)
    for channel in range(3):
        told = np.interp(share, steps, _SCALE[:, channel])
        found[:, channel] = np.where(known, told, _UNKNOWN_COLOUR[channel])
    return found
