# SPDX-License-Identifier: GPL-3.0-or-later
"""Outlines that are all border, meshed by us and by Gmsh, each in a process of its own (process.alone).

What a mesh can be is set by the outline where that has corners nearer to one another than the edge length:
all of them stay, and so do its angles. Gmsh's figures beside ours tell what the outline permits.
"""

from __future__ import annotations

import time

import numpy as np

from .meshing import figures, gmsh_run
from .process import ROOT, Skipped, peak_resident

_DATA = ROOT.parent / "shared" / "data"
# What is meshed, and at which edge lengths.
CASES = {
    "needles": ("star of 40 needles", (2.0,)),
    "comb": ("comb of 400 teeth", (0.5,)),
    "formation": ("hamersley, the outline of most corners", (2000.0, 500.0, 100.0)),
    "around": ("around pleasant's lakes", (400.0, 100.0, 30.0)),
    "lakes": ("pleasant's 9 lakes", (400.0, 30.0)),
}


def _needles() -> np.ndarray:
    turn = np.arange(80) * np.pi / 40
    radius = np.where(np.arange(80) % 2, 5.0, 50.0)
    return np.column_stack([radius * np.cos(turn), radius * np.sin(turn)])


def _comb(teeth: int) -> np.ndarray:
    feet = np.arange(teeth, dtype=float)
    tooth = np.array([[0, 0], [0.25, 2], [0.5, 0]])
    row = (np.column_stack([feet, 0 * feet])[:, None] + tooth).reshape(-1, 2)
    return np.concatenate([[[0, -1]], row, [[teeth, 0], [teeth, -1]]])


def _lakes() -> list[list[np.ndarray]]:
    from realmodel.core.readers import read_shapes
    from realmodel.core.settings.data_files import MapLayer

    return [lake.rings for lake in read_shapes(MapLayer(_file("pleasant/all_lakes.shp"))).polygons]


def _formation() -> list[np.ndarray]:
    from realmodel.core.readers import read_shapes
    from realmodel.core.settings.data_files import MapLayer

    shapes = read_shapes(MapLayer(_file("hamersley/geology.geojson")))
    return max((polygon.rings for polygon in shapes.polygons), key=lambda rings: len(rings[0]))


def _file(name: str):
    if not (_DATA / name).is_file():
        raise Skipped(f"{_DATA / name} is not there")
    return _DATA / name


def polygons(kind: str) -> list[list[np.ndarray]]:
    """Each polygon as its outline and its holes. Raises Skipped where the data are not there."""
    if kind == "needles":
        return [[_needles()]]
    if kind == "comb":
        return [[_comb(400)]]
    if kind == "formation":
        return [_formation()]
    lakes = _lakes()
    if kind == "lakes":
        return lakes
    shores = [lake[0] for lake in lakes]
    corners = np.concatenate(shores)
    (left, bottom), (right, top) = corners.min(axis=0) - 500, corners.max(axis=0) + 500
    land = [np.array([[left, bottom], [right, bottom], [right, top], [left, top]]), *shores]
    return [land, *([island] for lake in lakes for island in lake[1:])]


def mesh(mesher: str, kind: str, edge: float) -> dict:
    """Seconds of processor time for a mesh of a hard outline, bytes resident at most, and its figures."""
    regions = polygons(kind)
    if mesher == "Gmsh":
        run = gmsh_run(regions, edge)
    else:
        from realmodel.core import mesh_region

        rings = [ring for polygon in regions for ring in polygon]

        def run():
            return mesh_region(rings, edge_length=edge, mesher=mesher)

    began = time.process_time()
    vertices, triangles = run()
    seconds = time.process_time() - began
    resident = peak_resident()
    if len(triangles) == 0:
        raise Skipped("it came back without a triangle")
    return {"seconds": seconds, "resident": resident, **figures(vertices, triangles, edge, False)}
