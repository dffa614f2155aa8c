# SPDX-License-Identifier: GPL-3.0-or-later
"""Inside Blender's window: how long the viewport takes to draw a model in each display mode, beside the same
blocks as plain meshes without RealModel, and beside what the mode shows as plain meshes.

    xvfb-run -a -s "-screen 0 1280x800x24" blender --factory-startup -P blender_display.py -- S N FRAMES

The model has S surfaces of N x N squares. Prints one line of JSON: the seconds per frame of each mode, those
of what it shows as plain meshes (with wires over them for AREAS, as wires for LINES; there is nothing like
POINTS), those of the plain blocks before and after, and the polygons of each.
"""

import json
import os
import sys
import time
import traceback
from contextlib import contextmanager
from pathlib import Path

import bpy
import numpy as np
from mathutils import Quaternion

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "addon"))

import realmodel
from realmodel.core import Library, Project, Property, Rock, Surface

MODES = ("POINTS", "LINES", "AREAS", "SURFACES", "POLYHEDRA", "BLOCKS")


def project(count, size):
    node = np.arange((size + 1) ** 2).reshape(size + 1, size + 1)
    a, b, c, d = (part.ravel() for part in (node[:-1, :-1], node[1:, :-1], node[1:, 1:], node[:-1, 1:]))
    triangles = np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)]).astype(np.int32)
    x, y = (part.ravel() * (100.0 / size) for part in np.divmod(node, size + 1))
    surfaces = []
    for number in range(count):
        z = 10.0 * number + np.sin(0.2 * x + number) + np.cos(0.15 * y)
        vertices = np.column_stack([x, y, z])
        surfaces.append(Surface(f"S{number}", vertices=vertices, triangles=triangles, property=number + 1))
    library = Library([Property(number + 1, f"Rock {number}") for number in range(count)])
    return Project("Layers", [Rock("rock", surfaces)], library)


def build(count, size):
    from realmodel.bl.project import project_settings

    scene = bpy.context.scene
    bpy.ops.realmodel.new()
    project_settings.fill(scene, project(count, size))
    scene.realmodel.cells = "COLUMNS"
    bpy.ops.realmodel.build()
    return scene


def seconds_per_frame(area, frames):
    """The view turns a little for each frame, as under a hand."""
    region = next(region for region in area.regions if region.type == "WINDOW")
    view = area.spaces.active.region_3d
    with bpy.context.temp_override(window=bpy.context.window_manager.windows[0], area=area, region=region):
        bpy.ops.wm.redraw_timer(type="DRAW", iterations=1)  # the arrays go to the card
        began = time.perf_counter()
        for _ in range(frames):
            view.view_rotation = Quaternion((0.0, 0.0, 1.0), 0.02) @ view.view_rotation
            bpy.ops.wm.redraw_timer(type="DRAW", iterations=1)
        return (time.perf_counter() - began) / frames


def in_sight():
    return [o for o in bpy.context.scene.objects if o.type == "MESH" and o.visible_get()]


def polygons():
    return sum(len(o.data.polygons) for o in in_sight())


@contextmanager
def plain(items, mode):
    """The same meshes as a user would have them from any importer, the model out of sight."""
    shown, made = in_sight(), []
    for item in items:
        made.append(bpy.data.objects.new("plain", item.data.copy()))
        made[-1].show_wire = made[-1].show_all_edges = mode == "AREAS"
        made[-1].display_type = "WIRE" if mode == "LINES" else "TEXTURED"
        bpy.context.scene.collection.objects.link(made[-1])
    for item in shown:
        item.hide_set(True)
    yield
    for item in made:
        mesh = item.data
        bpy.data.objects.remove(item)
        bpy.data.meshes.remove(mesh)
    for item in shown:
        item.hide_set(False)


def measure():
    from realmodel.bl.display import preparing

    count, size, frames = map(int, sys.argv[sys.argv.index("--") + 1 :])
    realmodel.register()
    for item in list(bpy.data.objects):
        bpy.data.objects.remove(item)
    scene = build(count, size)
    area = next(a for a in bpy.context.window_manager.windows[0].screen.areas if a.type == "VIEW_3D")
    area.spaces.active.region_3d.view_rotation = Quaternion((0.82, 0.45, 0.17, 0.31))
    bpy.ops.realmodel.view_all()
    told = {"blender": bpy.app.version_string, "seconds": {}, "alike": {}, "polygons": {}, "switch": {}}
    blocks = [row.object for row in scene.realmodel.results if row.object is not None]

    def measure_plain(name):
        with plain(blocks, "BLOCKS"):
            told["polygons"][name] = polygons()
            told["seconds"][name] = seconds_per_frame(area, frames)

    measure_plain("plain")
    for mode in MODES:
        began = time.perf_counter()
        scene.realmodel.display = mode
        while preparing.is_working(scene):  # as Blender's timer does it
            preparing._work.look()
            time.sleep(0.005)
        told["switch"][mode] = time.perf_counter() - began
        told["polygons"][mode] = polygons()
        told["seconds"][mode] = seconds_per_frame(area, frames)
        if mode == "LINES":
            scene.realmodel.display = "BLOCKS"  # nothing is drawn over the viewport then
        if mode != "POINTS":
            with plain(in_sight(), mode):
                told["alike"][mode] = seconds_per_frame(area, frames)
    measure_plain("plain again")
    print(json.dumps(told), flush=True)


def run():
    try:
        measure()
        status = 0
    except BaseException:
        traceback.print_exc()
        status = 1
    sys.stdout.flush()
    os._exit(status)  # Blender would ask whether to save


bpy.context.preferences.view.show_splash = False
bpy.app.timers.register(run, first_interval=1.0)
