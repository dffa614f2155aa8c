# SPDX-License-Identifier: GPL-3.0-or-later
"""The real surfaces of ../shared/data as meshes and points, oldest first.

Everything is read where it lies; nothing of it is copied into the repository. Sources and licences
are in that folder's README.
"""

import csv

import numpy as np

from . import places

# oldest first, which is deepest first
CLAUDIUS_HORIZONS = (330.0, 250.0, 60.0, 0.0)
CLAUDIUS_REGION = ((548850.0, 7816600.0), (552500.0, 7816600.0), (552500.0, 7821950.0), (548850.0, 7821950.0))
DROGON_SHAPE = (275, 175)


def claudius_points():
    """{name: (P, 3) points} of the four horizons; rows that carry a normal are orientations, not points."""
    points = {value: [] for value in CLAUDIUS_HORIZONS}
    with open(places.REAL_DATA / "claudius" / "claudius.csv", newline="", encoding="utf-8") as file:
        for row in csv.DictReader(file):
            if not row["nx"]:
                points[float(row["val"])].append([float(row[axis]) for axis in "XYZ"])
    return {f"horizon_{value:.0f}": np.array(rows) for value, rows in points.items()}


def drogon():
    """{name: (vertices, triangles)} of the four horizons on their common rotated grid."""
    names = ("04_basevolantis", "03_topvolon", "02_toptherys", "01_topvolantis")
    row, column = np.indices(DROGON_SHAPE)
    nodes = np.stack([column.ravel(), row.ravel()], axis=1)
    return {name: _grid("drogon", f"drogon_{name}.xyz", nodes) for name in names}


def pleasant():
    """{name: (vertices, triangles)} of the bottoms of four layers; the grid has gaps."""
    return {f"botm{k}": _grid("pleasant", f"pleasant_botm{k}.xyz") for k in (3, 2, 1, 0)}


def shellmound():
    """{name: (vertices, triangles)} of five aquifer surfaces, the youngest of partial extent."""
    return {
        name: _grid("shellmound", f"shellmound_{name}_surf.xyz")
        for name in ("mwaq", "lcaq", "lccu", "mcaq", "mccu")
    }


def _grid(folder, file, nodes=None):
    """A grid of x y z rows as a mesh: two triangles a cell, one where a corner is missing.

    nodes: (P, 2) column and row of each point; None where the grid runs along the axes.
    """
    points = np.loadtxt(places.REAL_DATA / folder / file)
    if nodes is None:
        nodes = np.stack([_steps(points[:, 0]), _steps(points[:, 1])], axis=1)
    number = {(int(i), int(j)): p for p, (i, j) in enumerate(nodes)}
    triangles = []
    for (i, j), a in number.items():
        b, c, d = (number.get(at) for at in ((i + 1, j), (i + 1, j + 1), (i, j + 1)))
        if c is not None:
            triangles += [t for t in ((a, b, c), (a, c, d)) if None not in t]
        elif b is not None and d is not None:
            triangles.append((a, b, d))
    return points, np.array(triangles, np.int32)


def _steps(values):
    """Each value's number in steps of the grid spacing."""
    spacing = np.diff(np.unique(values)).min()
    return np.rint((values - values.min()) / spacing).astype(int)


def claudius_outline():
    """An outline round most of the points, no side of it along an axis."""
    return np.array(
        [(549200.5, 7816700.25), (552400.125, 7817100.75), (552100.0, 7821800.5), (549000.25, 7821500.0)]
    )


def claudius_on_own_meshes(edge_length, outline=None):
    """{name: (vertices, triangles)}: each horizon kriged on a mesh with its own edge length.

    outline: (N, 2), the same for all; None for rectangles that lie askew over each other.
    """
    from realmodel.core import interpolate, mesh_region

    meshes = {}
    for number, (name, points) in enumerate(claudius_points().items()):
        ring = outline
        if outline is None:
            ring = np.array(CLAUDIUS_REGION) + np.array([40.0, -25.0]) * number
        plan, triangles = mesh_region(ring, edge_length=edge_length * (1 + 0.1 * number))
        z = interpolate(points, plan, method="kriging", neighbours=16).z
        meshes[name] = np.column_stack([plan, z]), triangles
    return meshes
