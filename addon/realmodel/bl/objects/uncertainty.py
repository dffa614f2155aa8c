# SPDX-License-Identifier: GPL-3.0-or-later
"""The uncertainty of the elevations of an interpolated interface, as attributes of its mesh."""

import numpy as np

# Vertex attributes of an interface: the variance of its height, squared model units, and the distance in
# plan to the nearest point that it was interpolated from, model units. Unknown values are -1.
VARIANCE = "variance"
DISTANCE = "distance"
UNKNOWN = -1.0


def add_attributes(mesh, attributes):
    """Writes the attributes of the vertices of an interface that are known. mesh: bpy.types.Mesh. attributes:
    as of Model.surface_attributes, of the same vertices."""
    for name in (VARIANCE, DISTANCE):
        values = attributes[name]
        if np.isfinite(values).any():
            layer = mesh.attributes.new(name, "FLOAT", "POINT")
            layer.data.foreach_set("value", np.where(np.isfinite(values), values, UNKNOWN).astype(np.float32))


def deviation(item):
    """(V,) float64: the standard deviation at the vertices of an interface, NaN where it is not known; None
    where nothing is known of it."""
    layer = item.data.attributes.get(VARIANCE) if item.type == "MESH" else None
    if layer is None or item.mode != "OBJECT":
        return None
    variance = np.empty(len(layer.data), np.float32)
    layer.data.foreach_get("value", variance)
    return np.sqrt(np.where(variance < 0.0, np.nan, variance.astype(np.float64)))
