# SPDX-License-Identifier: GPL-3.0-or-later
"""Small projects of arrays."""

import numpy as np
from realmodel.core import Project, Rock, Surface

PLAN = np.array([[0, 0], [4, 0], [4, 4], [0, 4]])


def three_layers():
    """The model of docs/reference/python.md."""
    layers = {"top of clay": (2, 2, 2, 2, "clay"), "top of sand": (3, 3, 3, 3, "sand")}
    layers["ground"] = (1, 5, 5, 1, "soil")
    surfaces = [
        Surface(name, vertices=np.column_stack([PLAN, z]), triangles=[[0, 1, 2], [0, 2, 3]], block=block)
        for name, (*z, block) in layers.items()
    ]
    return Project("three layers", [Rock("hill", base_elevation=0.0, surfaces=surfaces)])
