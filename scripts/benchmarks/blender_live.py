# SPDX-License-Identifier: GPL-3.0-or-later
"""Inside Blender: how soon the blocks follow a live edit. In background, where nothing is drawn: what follows
is called as Blender's timer calls it.

    blender -b --factory-startup --python-exit-code 1 -P blender_live.py -- ROUNDS
    python blender_live.py -- ROUNDS                                        (the module bpy)

Prints one line of JSON: by plan mesh the seconds from each edit to the new blocks.
"""

import json
import sys
import time
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "addon"))

import realmodel
from realmodel.bl.objects import meshes
from realmodel.bl.scene import live

from benchmarks.made_stacks import StackSpec

SIZE = 100.0  # the stacks are over the unit square


def begin(spec):
    """A live model of mesh objects; returns the youngest."""
    bpy.ops.realmodel.new()
    for item in list(bpy.data.objects):
        bpy.data.objects.remove(item)
    for number, (vertices, triangles) in enumerate(spec.make()):
        mesh = meshes.triangle_mesh(f"S{number}", SIZE * vertices, triangles)
        item = bpy.data.objects.new(f"S{number}", mesh)
        bpy.context.scene.collection.objects.link(item)
        item.select_set(True)
    bpy.context.view_layer.update()
    bpy.ops.realmodel.from_selected()
    bpy.ops.realmodel.build()
    bpy.context.scene.realmodel.live = True
    rest()
    return item


def rest():
    """Does what Blender's timer does, until nothing is left to do."""
    while (wait := live._work.look()) is not None:
        time.sleep(wait)


def edits(item, rounds):
    """One vertex is raised, and Blender told; the hand rests; again."""
    seconds = []
    for _ in range(rounds + 1):
        item.data.vertices[len(item.data.vertices) // 2].co.z += 0.5
        item.data.update()
        bpy.context.view_layer.update()
        rest()
        seconds.append(live.measured[bpy.context.scene.name])
    return seconds[1:]


def main():
    rounds = int(sys.argv[sys.argv.index("--") + 1])
    realmodel.register()
    told = {plan: edits(begin(StackSpec(10, 60, plan)), rounds) for plan in ("shared", "own")}
    print(json.dumps({"blender": bpy.app.version_string, "seconds": told}), flush=True)


if __name__ == "__main__":
    main()
