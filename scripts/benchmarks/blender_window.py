# SPDX-License-Identifier: GPL-3.0-or-later
"""Inside Blender's window: how long it stands still at most while something long is done.

    xvfb-run -a -s "-screen 0 1280x800x24" blender --factory-startup -P blender_window.py -- QUADS

QUADS: along a side of each of the 4 surfaces of the model. Prints one line of JSON: by what goes on (seconds
without a sign of life of the main thread, at most; the most of them without those of drawing; seconds in
which Blender was given the meshes; seconds that drawing the window once takes; polygons).
"""

import json
import os
import sys
import time
import traceback
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "addon"))

import realmodel
from realmodel.core import Library, Project, Property, Rock, Surface

from benchmarks.made_stacks import StackSpec

PATIENCE = 300.0


class Watch:
    """Longest time between two calls of a timer of Blender, with and without what drawing takes of it, and
    what was spent in giving meshes to it.

    Blender's loop calls timers, does what is to be done, evaluates what has changed, draws, and begins anew;
    so what follows the beginning of that evaluation, until the next call, is taking the meshes to the screen.
    """

    def __init__(self):
        from realmodel.bl import display
        from realmodel.bl.scene import build_job

        build_job.BuildJob._put = self._timed(build_job.BuildJob._put)
        display._show = self._timed(display._show)
        bpy.types.SpaceView3D.draw_handler_add(self._drawing, (), "WINDOW", "PRE_VIEW")
        bpy.app.handlers.depsgraph_update_pre.append(self._drawing)
        self.begin()

    def _timed(self, function):
        def timed(*arguments, **options):
            began = time.perf_counter()
            self._within += 1
            try:
                return function(*arguments, **options)
            finally:
                self._within -= 1
                if not self._within:  # one calls the other
                    self.upload += time.perf_counter() - began

        return timed

    def _drawing(self, *_arguments):
        if self._draws is None and not self._within:
            self._draws = time.perf_counter()

    def begin(self):
        self.longest = self.beside_drawing = self.upload = 0.0
        self._within, self._draws = 0, None
        self._last = time.perf_counter()

    def tick(self):
        now = time.perf_counter()
        self.longest = max(self.longest, now - self._last)
        self.beside_drawing = max(self.beside_drawing, (self._draws or now) - self._last)
        self._last, self._draws = now, None


watch = None


def scene():
    return bpy.context.scene


def large(quads):
    layers = [
        Surface(f"S{n}", 1.0 * vertices + [0, 0, n], triangles, property=n + 1)
        for n, (vertices, triangles) in enumerate(StackSpec(4, quads, "shared").make())
    ]
    library = Library([Property(n + 1, f"Rock {n}") for n in range(4)])
    from realmodel.bl.project import project_settings

    bpy.ops.realmodel.new()
    project_settings.fill(scene(), Project("Layers", [Rock("rock", layers)], library))
    scene().realmodel.cells = "COLUMNS"


def still(quads):
    """What takes long, as a person does it: each while a timer looks how long the window stands still."""
    from realmodel.bl.display import preparing

    def idle():
        running = bpy.context.window_manager.realmodel.running
        return not running and not preparing.is_working(scene())

    large(quads)
    area = next(a for a in bpy.context.window_manager.windows[0].screen.areas if a.type == "VIEW_3D")
    region = next(r for r in area.regions if r.type == "WINDOW")
    for what in ("first build", "building again", "a stage", "polyhedra"):
        watch.begin()
        if what.endswith(("build", "again")):
            with bpy.context.temp_override(
                window=bpy.context.window_manager.windows[0], area=area, region=region
            ):
                bpy.ops.realmodel.build("INVOKE_DEFAULT")
        elif what == "a stage":
            scene().realmodel.stage = 2
        else:
            scene().realmodel.display = "POLYHEDRA"
        yield idle
        found = [watch.longest, watch.beside_drawing, watch.upload]
        with bpy.context.temp_override(
            window=bpy.context.window_manager.windows[0], area=area, region=region
        ):
            bpy.ops.wm.redraw_timer(type="DRAW", iterations=1)
            began = time.perf_counter()
            bpy.ops.wm.redraw_timer(type="DRAW", iterations=3)
        told[what] = [*found, (time.perf_counter() - began) / 3, polygons()]


def polygons():
    return sum(len(o.data.polygons) for o in scene().objects if o.type == "MESH" and o.visible_get())


told = {}


def steps():
    yield from still(int(sys.argv[sys.argv.index("--") + 1]))


class Run:
    """Goes through the steps, each when its condition holds, as one of Blender's timers."""

    def __init__(self):
        self.steps = steps()
        self.condition = next(self.steps)
        self.deadline = time.monotonic() + PATIENCE

    def __call__(self):
        try:
            watch.tick()
            if not self.condition():
                if time.monotonic() > self.deadline:
                    raise TimeoutError("a step does not end")
                return 0.001
            self.condition = next(self.steps)
            self.deadline = time.monotonic() + PATIENCE
            return 0.001
        except StopIteration:
            print(json.dumps(told), flush=True)
            status = 0
        except BaseException:
            traceback.print_exc()
            status = 1
        sys.stdout.flush()
        os._exit(status)  # Blender would ask whether to save


def begin():
    global watch
    realmodel.register()
    watch = Watch()
    bpy.app.timers.register(Run(), first_interval=0.1)


bpy.context.preferences.view.show_splash = False
bpy.app.timers.register(begin, first_interval=1.0)
