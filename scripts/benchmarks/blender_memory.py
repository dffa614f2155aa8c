# SPDX-License-Identifier: GPL-3.0-or-later
"""Inside Blender, in background: memory over live builds; the .blend and undo of a surface of many points.

    blender -b --factory-startup --python-exit-code 1 -P blender_memory.py -- ROUNDS POINTS
    python blender_memory.py -- ROUNDS POINTS                               (the module bpy)

Prints one line of JSON.
"""

import json
import os
import sys
import tempfile
import time
from pathlib import Path

import bpy
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "addon"))

import realmodel
from realmodel.bl.objects import built_models, meshes

from benchmarks.made_stacks import StackSpec
from benchmarks.process import resident


def live_builds(rounds):
    """Bytes resident after each of the edits of a live model, and bytes of the models that are kept."""
    from benchmarks.blender_live import begin, edits

    item = begin(StackSpec(10, 100, "own"))
    taken = []
    for _ in range(rounds):
        edits(item, 0)
        taken.append(resident())
    return {"resident": taken, "kept": sum(map(built_models._bytes_of, built_models._models.values()))}


def many_points(number, folder):
    """A surface of so many points from a file: the size of the .blend, and the seconds that a
    change, its undo step, and undoing it take."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    random = np.random.default_rng(1)
    points = random.uniform(0.0, 1000.0, (number, 2))
    heights = 20.0 + 3.0 * np.sin(points[:, 0] / 90.0) + random.normal(0.0, 0.01, number)
    np.savetxt(
        folder / "top.csv", np.column_stack([points, heights]), "%.3f", ",", header="x,y,z", comments=""
    )
    region = bpy.data.objects.new("region", meshes.triangle_mesh("region", *_square(1000.0)))
    bpy.context.scene.collection.objects.link(region)
    ops, model = bpy.ops.realmodel, bpy.context.scene.realmodel
    ops.rock_add()
    rock = model.rocks[0]
    rock.region, rock.edge_length, model.cells = region, 20.0, "BLOCKS"
    rock.use_base, rock.base_elevation = True, 0.0
    ops.surface_add(filepath=str(folder / "top.csv"))
    rock.surfaces[0].method = "idw"
    ops.build()
    before = resident()
    told = {"points": number, "csv": (folder / "top.csv").stat().st_size, "kept": _stored_bytes(rock)}
    seconds = {"change and step": [], "undo": []}
    bpy.ops.ed.undo_push(message="begin")
    for n in range(5):
        began = time.perf_counter()
        model.name = f"name {n}"
        bpy.ops.ed.undo_push(message="name")
        seconds["change and step"].append(time.perf_counter() - began)
    told["five steps"] = resident() - before
    for _ in range(4):
        began = time.perf_counter()
        bpy.ops.ed.undo()
        seconds["undo"].append(time.perf_counter() - began)
    path = folder / "m.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    return {**told, "blend": path.stat().st_size, "seconds": seconds}


def _square(size):
    corners = np.array([[0, 0, 0], [size, 0, 0], [size, size, 0], [0, size, 0]], float)
    return corners, np.array([[0, 1, 2], [0, 2, 3]])


def _stored_bytes(rock):
    stored = (arrays for row in rock.surfaces for arrays in (row.stored, row.stored_mesh))
    return sum(array.nbytes for arrays in stored for array in arrays.values())


def main():
    rounds, number = (int(word) for word in sys.argv[sys.argv.index("--") + 1 :])
    realmodel.register()
    told = {"blender": bpy.app.version_string, "live": live_builds(rounds)}
    with tempfile.TemporaryDirectory() as folder:
        told["points"] = many_points(number, Path(folder))
    print(json.dumps(told), flush=True)
    if getattr(bpy.app, "module", False):
        os._exit(0)  # the module bpy frees what undo has kept one by one, for minutes


main()
