# SPDX-License-Identifier: GPL-3.0-or-later
"""A small mesh with every kind of element, two blocks, a pinch-out and all kinds of patches."""

import numpy as np
from realmodel.core.simulation import PlanMesh, VolumeMesh

# In plan two squares of two triangles each, the second of them with a hexahedron over it.
PLAN = np.array([[0.0, 0], [1, 0], [2, 0], [0, 1], [1, 1], [2, 1]])
LOW, MIDDLE, HIGH = 0.0, 1.0, 2.0


def mixed_mesh(shift=(0.0, 0.0, 0.0)):
    """Below z = 1, block 0 "Clay": a hexahedron at x > 1, two prisms at x < 1. On it, block 1 "Gres a": over
    the hexahedron a pyramid with the tip over (1, 0); over the prisms tetrahedra up to that tip."""
    points = np.array(
        [
            *((x, y, LOW) for x, y in PLAN),
            *((x, y, MIDDLE) for x, y in PLAN),
            (1.0, 0.0, HIGH),
        ]
    )
    tip = 12
    elements = {
        "hexahedron": np.array([[1, 2, 5, 4, 7, 8, 11, 10]]),
        "prism": np.array([[0, 1, 4, 6, 7, 10], [0, 4, 3, 6, 10, 9]]),
        "pyramid": np.array([[7, 8, 11, 10, tip]]),
        "tetrahedron": np.array([[6, 7, 10, tip]]),
    }
    block = {"hexahedron": [0], "prism": [0, 0], "pyramid": [1], "tetrahedron": [1]}
    triangles = [
        *((0, 4, 1), (0, 3, 4)),  # the base
        (6, 10, 9),  # the top of the clay where nothing lies on it
        (6, 7, 10),  # inside, clay below the sandstone
        *((6, 7, tip), (7, 8, tip)),  # walls at y = 0
        *((6, tip, 10), (10, tip, 11), (8, 11, tip)),  # the top of the sandstone
    ]
    quadrilaterals = [
        (1, 4, 5, 2),  # the base
        (7, 8, 11, 10),  # inside
        *((0, 1, 7, 6), (1, 2, 8, 7), (2, 5, 11, 8), (5, 4, 10, 11), (4, 3, 9, 10), (3, 0, 6, 9)),  # walls
    ]
    return VolumeMesh(
        points + shift,
        {kind: np.array(rows, np.int32) for kind, rows in elements.items()},
        {kind: np.array(rows, np.int32) for kind, rows in block.items()},
        {"triangle": np.array(triangles, np.int32), "quadrilateral": np.array(quadrilaterals, np.int32)},
        {
            "triangle": np.array([-2, -2, 0, 0, -1, -1, 1, 1, 1], np.int32),
            "quadrilateral": np.array([-2, 0, -1, -1, -1, -1, -1, -1], np.int32),
        },
        ["Clay", "Grès à"],
        np.array([3, 7], np.int32),
        ["Top of clay", "Ground"],
        np.zeros(2, np.int32),
    )


VOLUMES = {0: 2.0, 1: 1 / 3 + 1 / 6}
SETS = {  # faces of each set: triangles, quadrilaterals
    "base": (2, 1),
    "sides": (2, 6),
    "top_Ground": (3, 0),
    "top_Top_of_clay": (1, 0),
    "Top_of_clay": (1, 1),
}


def layered_mesh(n=3, layers=3):
    """Prisms over n x n squares: `layers` layers of two blocks, the top one of them missing over x < 1."""
    x, y = np.meshgrid(np.arange(n + 1.0), np.arange(n + 1.0))
    plan = np.column_stack([x.ravel(), y.ravel()])
    corner = (np.arange(n)[:, None] * (n + 1) + np.arange(n)).ravel()
    below = np.stack([corner, corner + 1, corner + n + 2], axis=1)
    above = np.stack([corner, corner + n + 2, corner + n + 1], axis=1)
    triangles = np.concatenate([below, above]).astype(np.int32)
    count = len(plan)
    points = np.concatenate(
        [np.column_stack([plan, k + 0.1 * plan[:, 0] * (k > 0)]) for k in range(layers + 1)]
    )
    prisms, block, column, layer = [], [], [], []
    for k in range(layers):
        own = np.arange(len(triangles))
        if k == layers - 1:
            own = own[plan[triangles, 0].mean(axis=1) > 1]
        prisms.append(np.concatenate([triangles[own] + k * count, triangles[own] + (k + 1) * count], axis=1))
        block.append(np.full(len(own), int(k > 0)))
        column.append(own)
        layer.append(np.full(len(own), layers - 1 - k))
    prisms, block, column, layer = (
        np.concatenate(rows).astype(np.int32) for rows in (prisms, block, column, layer)
    )
    used, prisms = np.unique(prisms, return_inverse=True)
    faces = {"triangle": np.empty((0, 3), np.int32), "quadrilateral": np.empty((0, 4), np.int32)}
    return VolumeMesh(
        points[used],
        {"prism": prisms.reshape(-1, 6).astype(np.int32)},
        {"prism": block},
        faces,
        {shape: np.empty(0, np.int32) for shape in faces},
        ["Clay", "Sand"],
        np.array([1, 2], np.int32),
        ["Top of clay", "Ground"],
        np.zeros(2, np.int32),
        PlanMesh(plan, triangles, {"prism": column}, {"prism": layer}, layers),
    )
