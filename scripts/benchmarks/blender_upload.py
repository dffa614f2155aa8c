# SPDX-License-Identifier: GPL-3.0-or-later
"""Inside Blender: a mesh of N x N quads brought in from arrays, by ours and by Blender's own ways, timed.

    blender -b --factory-startup --python-exit-code 1 -P blender_upload.py -- N ROUNDS
    python blender_upload.py -- N ROUNDS                                        (the module bpy)

Prints one line of JSON: the seconds of each way in each round.
"""

import json
import sys
import time
from pathlib import Path

import bpy
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "addon"))


def quads(size):
    """Coordinates (V, 3) float32, offsets (F + 1,) and corners (4 F,) int32, a surface number per face."""
    node = np.arange((size + 1) ** 2, dtype=np.int32).reshape(size + 1, size + 1)
    corners = np.stack([node[:-1, :-1], node[1:, :-1], node[1:, 1:], node[:-1, 1:]], axis=-1)
    x, y = np.divmod(np.arange(node.size), size + 1)
    coordinates = np.column_stack([x, y, np.sin(0.1 * x) + np.cos(0.1 * y)]).astype(np.float32)
    offsets = np.arange(0, corners.size + 1, 4, dtype=np.int32)
    return coordinates, offsets, corners.reshape(-1), np.zeros(len(offsets) - 1, np.int32)


def ours(coordinates, offsets, corners, surfaces):
    """As the blocks come in: flat shaded, with edges, and each face knows its surface. The edges, which are
    found in the thread that builds, count here too."""
    from realmodel.bl.objects import meshes
    from realmodel.core.base.work import native_module
    from realmodel.core.display.polygon_mesh import PolygonMesh

    edges, corner_edges = native_module().polygon_edges(offsets, corners, len(coordinates))
    shape = PolygonMesh(coordinates, offsets, corners, surfaces, edges, corner_edges)
    return meshes.new_mesh("ours", shape)


def bare_arrays(coordinates, offsets, corners, _surfaces):
    """The least that Blender can be given: foreach_set of vertices and polygons, then the edges."""
    mesh = bpy.data.meshes.new("bare")
    mesh.vertices.add(len(coordinates))
    mesh.vertices.foreach_set("co", coordinates.ravel())
    mesh.loops.add(len(corners))
    mesh.loops.foreach_set("vertex_index", corners)
    mesh.polygons.add(len(offsets) - 1)
    mesh.polygons.foreach_set("loop_start", offsets[:-1])
    if bpy.app.version < (3, 6, 0):
        mesh.polygons.foreach_set("loop_total", np.diff(offsets))
    mesh.update(calc_edges=True)
    return mesh


def from_pydata(coordinates, _offsets, corners, _surfaces):
    """What most add-ons do: lists."""
    mesh = bpy.data.meshes.new("pydata")
    mesh.from_pydata(coordinates.tolist(), [], corners.reshape(-1, 4).tolist())
    return mesh


def main():
    size, rounds = map(int, sys.argv[sys.argv.index("--") + 1 :])
    arrays = quads(size)
    ways = (ours, bare_arrays, from_pydata)
    seconds = {way.__name__: [] for way in ways}
    for number in range(rounds + 1):
        for way in ways if number % 2 else reversed(ways):
            began = time.perf_counter()
            mesh = way(*arrays)
            took = time.perf_counter() - began
            if len(mesh.polygons) != size * size or len(mesh.edges) != 2 * size * (size + 1):
                sys.exit(f"{way.__name__} made another mesh")
            bpy.data.meshes.remove(mesh)
            if number:  # the first round is not counted: modules are imported in it
                seconds[way.__name__].append(took)
    told = {"blender": bpy.app.version_string, "polygons": size * size, "seconds": seconds}
    print(json.dumps(told), flush=True)


main()
