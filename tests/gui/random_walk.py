# SPDX-License-Identifier: GPL-3.0-or-later
"""A walk of random steps through a real window, under Xvfb: edits, undo, redo, opening, building, Esc,
deleting, edit mode, mostly with Auto on; undo, redo and Esc come in the middle of what the one before has
begun.
scripts/random_walk.sh starts it:

    blender --factory-startup --enable-event-simulate -P tests/gui/random_walk.py -- FOLDER STEPS SEED

It ends at the first traceback, and where the scene says what is not so (`check_scene`). FOLDER/walk.log has
the steps and all that Blender wrote.
"""

import ctypes
import faulthandler
import os
import random
import sys
import time
from pathlib import Path

import bpy
import numpy as np

FOLDER = Path(__file__).resolve().parent
sys.path[:0] = [str(FOLDER.parents[1] / "addon"), str(FOLDER)]

import realmodel  # noqa: E402
from driver import Walk  # noqa: E402
from realmodel.bl.display import cuts, preparing  # noqa: E402
from realmodel.bl.host import afterwards  # noqa: E402
from realmodel.bl.objects import meshes, model_tree, shapes, viewports  # noqa: E402
from realmodel.bl.project import project_settings, results, settings  # noqa: E402
from realmodel.bl.scene import live  # noqa: E402
from realmodel.core import (  # noqa: E402
    Body,
    Fault,
    Library,
    Project,
    Property,
    RealModelError,
    Rock,
    Surface,
    build,
)
from realmodel.core.project.project_writer import save_project  # noqa: E402

_WALL = [[0, 1, 2], [0, 2, 3]]
_BOX = [(0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)]  # faces
COLORS = ("PROPERTY", "BLOCK", "AGE", "ELEVATION", "THICKNESS", "COMPARTMENT")
DISPLAYS = ("BLOCKS", "SURFACES", "AREAS", "LINES", "POINTS", "POLYHEDRA")
_TRACES = ("Traceback (most recent call last)", "Error: Python", "EXCEPTION_", "Segmentation")
_ops = bpy.ops.realmodel


def model():
    return bpy.context.scene.realmodel


def is_idle():
    scene, is_building = bpy.context.scene, bpy.context.window_manager.realmodel.running
    is_showing = cuts.is_working(scene) or preparing.is_working(scene)
    return not (
        is_building or is_showing or live.is_working() or live.is_checking() or afterwards.is_waiting()
    )


def faulted_project(folder):
    """The file of a small project: three surfaces from points, displaced by a fault, a shaft, and another
    rock mass from a mesh."""
    steps = np.arange(7.0, 100.0, 17.0)
    x, y = (each.ravel() for each in np.meshgrid(steps, steps))
    heights = 0.05 * y - np.where(x > 50.0, 4.0, 0.0)
    points = [np.column_stack([x, y, heights + 10.0 * n]) for n in range(3)]
    surfaces = [Surface(f"S{n}", points=p, method="idw", property=n + 1) for n, p in enumerate(points)]
    ring = np.array([(0.0, 0.0), (100.0, 0.0), (100.0, 100.0), (0.0, 100.0)])
    wall = np.array([(50.0, -20.0, -60.0), (50.0, 120.0, -60.0), (50.0, 120.0, 60.0), (50.0, -20.0, 60.0)])
    corners = np.array([(*(20.0 + 0.1 * at), z) for z in (-10.0, 12.0) for at in ring])
    sides = np.array([triangle for a, b, c, d in _BOX for triangle in ((a, b, c), (a, c, d))])
    sheet = np.column_stack([ring + 200.0, (5.0, 6.0, 7.0, 8.0)])
    rocks = [
        Rock("west", surfaces, region=ring, edge_length=12.0, base_elevation=-20.0),
        Rock("east", [Surface("top", vertices=sheet, triangles=_WALL, property=1)], base_elevation=0.0),
    ]
    library = Library([Property(n, f"rock {n}") for n in range(1, 4)])
    faults = [Fault("F", wall, np.array(_WALL), rocks=("west",))]
    bodies = [Body("shaft", corners, sides, void=True, rock="west")]
    path = folder / "faulted" / "project.toml"
    path.parent.mkdir(exist_ok=True)
    save_project(Project("faulted", rocks, library, faults=faults, bodies=bodies), path)
    return path


def field_data(folder):
    """The folder of small files: boreholes with a row the wrong way round, a log, heights of the ground,
    and a DXF of two surfaces."""
    data = folder / "field data"
    data.mkdir(exist_ok=True)
    collars, intervals = ["hole,x,y,z"], ["hole,from,to,block"]
    for n in range(9):
        collars.append(f"B{n},{40 * (n % 3)},{40 * (n // 3)},{50 + n % 2}")
        depths = (0, 8 + n % 5, 20 + n % 3, 34, 45)
        rows = list(zip(depths[:-1], depths[1:], ("Clay", "Sand", "Marl", "Chalk"), strict=True))
        intervals += [
            f"B{n},{a},{b},{c}" for a, b, c in ([(8, 0, "Clay")] if n == 3 else rows[:1]) + rows[1:]
        ]
    heights = [f"{x},{y},{52 + 0.02 * x}" for x in range(-20, 110, 20) for y in range(-20, 110, 20)]
    las = ["~V", "VERS. 2.0", "WRAP. NO", "~W", "STRT.M 0", "STOP.M 40", "STEP.M 1", "NULL. -999", "WELL. B1"]
    las += ["~C", "DEPT.M", "GR.API", "~A", *(f"{d} {30 + d % 7}" for d in range(41))]
    dxf = ["0", "SECTION", "2", "ENTITIES"]
    for k in range(2):
        dxf += ["0", "3DFACE", "8", f"TOP_{k}"]
        for corner, (x, y) in enumerate([(-20, -20), (110, -20), (110, 110), (-20, 110)]):
            dxf += [f"1{corner}", str(x), f"2{corner}", str(y), f"3{corner}", str(10 * k)]
    dxf += ["0", "ENDSEC", "0", "EOF"]
    files = {"collars.csv": collars, "intervals.csv": intervals, "terrain.csv": ["x,y,z", *heights]}
    for name, lines in (files | {"B1.las": las, "tops.dxf": dxf}).items():
        (data / name).write_text("\n".join(lines) + "\n")
    return data


class Log:
    """All that Blender writes, C and Python alike; `check` looks for tracebacks in what is new."""

    def __init__(self, path):
        self.terminal = os.fdopen(os.dup(1), "w")
        file = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_TRUNC | os.O_APPEND)
        for descriptor in (1, 2):
            os.dup2(file, descriptor)
        self._path, self._read = path, 0
        faulthandler.enable(2)

    def check(self):
        for stream in (sys.stdout, sys.stderr):
            stream.flush()
        ctypes.CDLL(None).fflush(None)
        new = self._path.read_bytes()[self._read :].decode(errors="replace")
        self._read += len(new.encode())
        assert not any(trace in new for trace in _TRACES), new


class Steps:
    """What a person may do next; each method is a step."""

    def __init__(self, walk, chance, faulted, data):
        self.walk, self.chance, self._faulted, self._data = walk, chance, faulted, data

    def _changed(self, what):
        bpy.ops.ed.undo_push(message=what)  # as Blender does after an edit in a panel

    def _surface(self):
        rows = [row for _, row in settings.surface_rows(bpy.context.scene)]
        return self.chance.choice(rows) if rows else None

    def edit_a_surface(self):
        row = self._surface()
        if row is None:
            return
        what = self.chance.randrange(4)
        if what == 0:
            row.use_minimum_thickness = True
            row.minimum_thickness = self.chance.uniform(0.0, 8.0)
        elif what == 1:
            row.rule = self.chance.choice(("erosional", "conformable"))
        elif what == 2:
            row.name = f"{row.name[:8]} {self.chance.randrange(9)}"
        else:
            row.use_minimum_thickness = not row.use_minimum_thickness
        self._changed("surface")

    def edit_a_rock(self):
        if len(model().rocks):
            rock = self.chance.choice(list(model().rocks))
            rock.use_base = self.chance.random() < 0.8
            rock.base_elevation -= self.chance.choice((0.5, 1.0, -0.5))
            self._changed("rock mass")

    def edit_the_library(self):
        if len(model().library):
            row = self.chance.choice(list(model().library))
            if self.chance.random() < 0.5:
                row.name = f"rock {self.chance.randrange(99)}"
            else:
                row.color = [self.chance.random() for _ in range(3)]
            self._changed("library")

    def move_through_the_list(self):
        group = model()
        if len(group.rocks):
            group.active_rock = self.chance.randrange(len(group.rocks))
            rock = group.rocks[group.active_rock]
            rock.active_surface = self.chance.randrange(max(len(rock.surfaces), 1))
            what = self.chance.randrange(4)
            if what == 0 and len(rock.surfaces) > 2:
                _ops.surface_remove("EXEC_DEFAULT", True)
            elif what == 1 and _ops.surface_move.poll():
                _ops.surface_move("EXEC_DEFAULT", True, direction=self.chance.choice(("UP", "DOWN")))
            elif what == 2 and _ops.surface_copy.poll():
                _ops.surface_copy("EXEC_DEFAULT", True)
            else:
                row = self._surface()
                if row is not None:
                    row.hide = not row.hide
                    self._changed("hide")

    def look_differently(self):
        group, view = model(), model().view
        what = self.chance.randrange(6)
        if what == 0:
            group.color_by = self.chance.choice(
                ("PROPERTY", "BLOCK", "AGE", "ELEVATION", "THICKNESS", "COMPARTMENT")
            )
        elif what == 1:
            group.display = self.chance.choice(
                ("BLOCKS", "SURFACES", "AREAS", "LINES", "POINTS", "POLYHEDRA")
            )
        elif what == 2:
            group.stage = self.chance.randrange(settings.last_stage(bpy.context.scene) + 1)
        elif what == 3:
            group.explode = self.chance.choice((0.0, 0.3))
        elif what == 4 and len(group.results):
            if view.plane is None:
                _ops.section_plane("EXEC_DEFAULT", True)
            view.use_section = not view.use_section
        else:
            group.stage = settings.last_stage(bpy.context.scene)
        self._changed("view")

    def undo(self):
        for _ in range(self.chance.choice((1, 1, 1, 2, 4))):
            self.walk.key("Z", ctrl=True)

    def redo(self):
        for _ in range(self.chance.choice((1, 1, 2))):
            self.walk.key("Z", ctrl=True, shift=True)

    def open_a_sample(self):
        if bpy.context.mode == "OBJECT" and _ops.open_sample.poll():
            is_faulted = self.chance.random() >= 0.6
            if is_faulted:
                _ops.open_project("EXEC_DEFAULT", True, filepath=str(self._faulted))
            else:
                _ops.open_sample("EXEC_DEFAULT", True, sample="two_layers")
            model().live = self.chance.random() < 0.8
            self._changed("Auto")
            if is_faulted:
                _ops.build("INVOKE_DEFAULT", True)

    def build(self):
        if _ops.build.poll():
            _ops.build("INVOKE_DEFAULT", True)
            if self.chance.random() < 0.4:
                self.walk.key("ESC")

    def press_escape(self):
        self.walk.key("ESC")

    def delete_objects(self):
        items = [item for item in bpy.context.scene.objects if item.name in bpy.context.view_layer.objects]
        if bpy.context.mode == "OBJECT" and items:
            with bpy.context.temp_override(selected_objects=self.chance.sample(items, min(len(items), 2))):
                bpy.ops.object.delete("EXEC_DEFAULT", True)

    def delete_a_collection(self):
        found = [c for c in bpy.context.scene.collection.children_recursive if model_tree.TAG in c]
        if bpy.context.mode == "OBJECT" and found:
            bpy.data.collections.remove(self.chance.choice(found))
            self._changed("collection")

    def edit_mode(self):
        if bpy.context.mode != "OBJECT":
            if self.chance.random() < 0.6 and bpy.context.mode == "EDIT_MESH":
                z = self.chance.choice((0.2, -0.2))
                bpy.ops.transform.translate("EXEC_DEFAULT", True, value=(0.0, 0.0, z))
            else:
                bpy.ops.object.mode_set("EXEC_DEFAULT", True, mode="OBJECT")
            return
        layer = bpy.context.view_layer
        rows = [row.interface for _, row in settings.interface_rows(bpy.context.scene)]
        items = [i for i in rows if i is not None and i.name in layer.objects and i.type == "MESH"]
        if items:
            item = self.chance.choice(items)
            item.hide_viewport = False
            item.hide_set(False)
            layer.objects.active = item
            if item.visible_get():
                bpy.ops.object.mode_set("EXEC_DEFAULT", True, mode="EDIT")

    def move_an_object(self):
        items = list(bpy.context.scene.objects)
        if items:
            self.chance.choice(items).location.x += self.chance.choice((1.0, -1.0))
            self._changed("move")

    def rename_an_object(self):
        items = list(bpy.context.scene.objects)
        if items:
            self.chance.choice(items).name = f"thing {self.chance.randrange(99)}"
            self._changed("rename")

    def take_field_data(self):
        """Tables of boreholes and a log, imported or proposed; a terrain; surfaces of one DXF."""
        what = self.chance.randrange(4)
        tables = [{"name": name} for name in ("collars.csv", "intervals.csv", "B1.las")]
        if bpy.context.mode != "OBJECT":
            return
        if what < 2:
            is_proposed = what == 0 and _ops.propose_project.poll()
            folder = str(self._data)
            _ops.boreholes_read("EXEC_DEFAULT", True, directory=folder, files=tables, propose=is_proposed)
        elif what == 2:
            _ops.surface_add("EXEC_DEFAULT", True, filepath=str(self._data / "terrain.csv"), as_terrain=True)
        else:
            _ops.surface_add("EXEC_DEFAULT", True, filepath=str(self._data / "tops.dxf"))
        model().live = self.chance.random() < 0.3

    def decide_on_field_data(self):
        rocks = [rock for rock in model().rocks if len(rock.codes)]
        if not rocks or bpy.context.mode != "OBJECT":
            return
        model().active_rock = list(model().rocks).index(rocks[0])
        what = self.chance.randrange(6)
        codes = [row.name for row in rocks[0].codes]
        if what < 2:
            unit = self.chance.choice([*codes, "New"])
            _ops.codes_assign("EXEC_DEFAULT", True, pattern=self.chance.choice(codes), unit=unit)
        elif what == 2:
            _ops.codes_ignore("EXEC_DEFAULT", True, pattern=self.chance.choice(codes))
        elif what == 3:
            _ops.codes_reset("EXEC_DEFAULT", True, pattern="*")
        elif what == 4 and len(rocks[0].hole_problems):
            decision = self.chance.choice(("REPAIR", "WRITTEN", "LEFT_OUT"))
            _ops.hole_problem_decide("EXEC_DEFAULT", True, index=0, decision=decision)
        else:
            view = model().view
            view.show_boreholes = self.chance.random() < 0.7
            view.show_hole_curves = self.chance.random() < 0.7
            view.show_contacts = self.chance.random() < 0.5
            self._changed("view of field data")

    def switch_auto(self):
        model().live = self.chance.random() < 0.8
        self._changed("Auto")


WEIGHTS = {
    Steps.edit_a_surface: 20,
    Steps.edit_a_rock: 5,
    Steps.edit_the_library: 5,
    Steps.move_through_the_list: 8,
    Steps.look_differently: 12,
    Steps.undo: 30,
    Steps.redo: 10,
    Steps.open_a_sample: 3,
    Steps.build: 10,
    Steps.press_escape: 2,
    Steps.delete_objects: 3,
    Steps.delete_a_collection: 1,
    Steps.edit_mode: 12,
    Steps.move_an_object: 3,
    Steps.rename_an_object: 2,
    Steps.switch_auto: 4,
    Steps.take_field_data: 4,
    Steps.decide_on_field_data: 12,
}

BY_KEY = {Steps.undo, Steps.redo, Steps.press_escape}


def check_scene(scene):
    """The scene says what is so: rows and objects belong together; what is not marked as out of date is what
    a build makes now, and out of date is what is marked so."""
    group = scene.realmodel
    try:
        composed = project_settings.compose(scene, viewports.updated_layer(scene).depsgraph)
    except RealModelError:
        composed = None
    if not len(group.results):
        assert not group.is_outdated
        return
    differs = composed is None or composed.fingerprint != group.built_from
    assert group.is_outdated == differs, f"out of date: {differs}, and it says {group.is_outdated}"
    if group.live and differs:
        assert bpy.context.window_manager.realmodel.problem, (
            "Auto is on, the model out of date, and nothing says why"
        )
    for row in group.results:
        if row.object is not None and not results.is_missing(row):
            said = [row.object[key] for key in (model_tree.ROCK, model_tree.SURFACE, model_tree.BLOCK)]
            assert said == [row.rock, row.surface, row.name], (said, row.rock, row.surface, row.name)
    if cuts.is_shown(scene):
        assert group.built_stamp in group.view.cut, "the cut is one of another model"
    if differs or group.is_coarse:
        return
    made = build(composed.project, cells="blocks", threads=1)
    shown = {(row.rock, row.name): float(row.volume_exact) for row in group.results}
    volumes = {(made.project.rocks[block.rock].name, block.name): block.volume for block in made.blocks}
    same = shown.keys() == volumes.keys() and np.allclose(
        list(shown.values()), [volumes[key] for key in shown], rtol=1e-9, atol=1e-9
    )
    assert same, (shown, volumes)
    if group.stage < settings.last_stage(scene) or group.view.message:
        return
    for row in group.results:
        if row.object is not None and not results.is_missing(row) and row.object.mode == "OBJECT":
            of_mesh, of_row = volume_of(row.object.data), float(row.volume_exact)
            assert abs(of_mesh - of_row) < 1e-4 * of_row + 1.0, (row.name, of_mesh, of_row)


def volume_of(mesh):
    """The volume within a closed mesh."""
    corners = meshes.mesh_coordinates(mesh).astype(float)[shapes.mesh_triangles(mesh)]
    return float(np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])).sum()) / 6.0


def steps_of(count, seed, log):
    chance = random.Random(seed)

    def walk_at_random(walk):
        steps = Steps(walk, chance, faulted_project(walk.folder), field_data(walk.folder))
        walk.over_viewport()
        yield walk.redrawn()
        steps.open_a_sample()
        for number in range(count):
            walk.over_viewport()
            step = chance.choices(list(WEIGHTS), WEIGHTS.values())[0]
            if step not in BY_KEY:
                yield is_idle  # Blender 3.4 reads an override while other threads run Python (driver.py)
            print(f"step {number} {step.__name__} {time.monotonic():.1f}", flush=True)
            if step in BY_KEY:
                step(steps)
            else:
                with bpy.context.temp_override(
                    window=walk.window, area=walk.area, region=walk.region("WINDOW")
                ):
                    try:
                        step(steps)
                    except RuntimeError as refused:  # an operator's report of an error
                        assert "Traceback" not in str(refused), refused
            if chance.random() < 0.4:
                yield is_idle  # in time: nothing keeps itself at work
                log.check()
                check_scene(bpy.context.scene)
            else:
                until = time.monotonic() + chance.choice((0.0, 0.05, 0.3))
                yield lambda until=until: time.monotonic() >= until
            log.check()
        if bpy.context.mode != "OBJECT":
            bpy.ops.object.mode_set(mode="OBJECT")
        yield is_idle
        log.check()
        check_scene(bpy.context.scene)

    return walk_at_random


def main():
    folder, count, seed = sys.argv[sys.argv.index("--") + 1 :]
    log = Log(Path(folder) / "walk.log")
    preferences = bpy.context.preferences
    preferences.view.show_splash = False
    preferences.system.viewport_aa = "OFF"
    preferences.edit.undo_steps = 32
    realmodel.register()
    walk = Walk(Path(folder), Path(folder) / "Xvfb_screen0")
    walk.shot = lambda name: None
    begun = time.monotonic()

    def at_end(walk):
        print(walk.failure or "ok", flush=True)
        how = f"FAILED: {walk.failure}" if walk.failure else "no failure"
        said = f"Blender {bpy.app.version_string}, {count} steps of seed {seed}: {how}"
        print(f"{said}, {time.monotonic() - begun:.0f} s", file=log.terminal, flush=True)
        os._exit(1 if walk.failure else 0)

    walk.run([("a walk at random", steps_of(int(count), int(seed), log))], at_end)


main()
