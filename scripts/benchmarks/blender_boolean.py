# SPDX-License-Identifier: GPL-3.0-or-later
"""Inside Blender: the difference of two solids by the Boolean modifier, timed.

blender -b --factory-startup -P blender_boolean.py -- SOLIDS.npz EXACT|FAST
"""

import json
import sys
import time

import bpy
import numpy as np


def solid(name, vertices, triangles):
    mesh = bpy.data.meshes.new(name)
    mesh.vertices.add(len(vertices))
    mesh.vertices.foreach_set("co", vertices.astype(np.float32).ravel())
    mesh.loops.add(3 * len(triangles))
    mesh.loops.foreach_set("vertex_index", triangles.astype(np.int32).ravel())
    mesh.polygons.add(len(triangles))
    mesh.polygons.foreach_set("loop_start", np.arange(0, 3 * len(triangles), 3, dtype=np.int32))
    if bpy.app.version < (3, 6):
        mesh.polygons.foreach_set("loop_total", np.full(len(triangles), 3, np.int32))
    mesh.update(calc_edges=True)
    made = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(made)
    return made


def main():
    path, solver = sys.argv[sys.argv.index("--") + 1 :]
    arrays = np.load(path)
    began = time.perf_counter()  # making the solids counts, as it does for all
    older, younger = (
        solid(name, arrays[f"{name}_vertices"], arrays[f"{name}_triangles"]) for name in ("older", "younger")
    )
    boolean = younger.modifiers.new("difference", "BOOLEAN")
    boolean.operation, boolean.object, boolean.solver = "DIFFERENCE", older, solver
    result = younger.evaluated_get(bpy.context.evaluated_depsgraph_get()).to_mesh()
    seconds = time.perf_counter() - began
    print(json.dumps({"seconds": seconds, "faces": len(result.polygons)}), flush=True)


main()
