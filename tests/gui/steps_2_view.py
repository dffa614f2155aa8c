# SPDX-License-Identifier: GPL-3.0-or-later
"""The display modes, the cut, captures and coordinates, by their colors on the screen.

The model is three level layers of made-up colors, in the place of whatever the steps before have left.
"""

import shutil
import sys
import tempfile
from contextlib import contextmanager
from pathlib import Path

import bpy
import numpy as np
from driver import hue_differs, read_alpha, read_picture

sys.path.append(str(Path(__file__).resolve().parents[1] / "blender"))

from made_projects import surface
from realmodel.bl.display import preparing
from realmodel.bl.objects import viewports
from realmodel.core import Library, Project, Property, Rock
from realmodel.core.project.project_writer import save_project

COLORS = {1: "#8a2be2", 2: "#e02020", 3: "#20a040"}
GRID = {"east": 0.0, "north": 0.0, "x0": 0.0, "y0": 0.0, "width": 100.0, "depth": 80.0}
ALIKE = 0.06


def rgb(property_id):
    text = COLORS[property_id]
    return [int(text[k : k + 2], 16) / 255 for k in (1, 3, 5)]


def project():
    rock = Rock(
        "hill",
        [
            surface("S0", lambda x, y: 10.0, property=1, grid=GRID),
            surface("S1", lambda x, y: 25.0, property=2, grid=GRID, block="Sand"),
            surface("S2", lambda x, y: 40.0, property=3, grid=GRID, block="Cap"),
        ],
        base_elevation=-5.0,
    )
    entries = [Property(key, f"Rock {key}", color=color) for key, color in COLORS.items()]
    return Project("Layers", [rock], Library(entries))


def share(shown, property_id):
    """The share of the viewport's pixels that have the hue of a property."""
    flat = shown[::3, ::3].reshape(-1, 3)
    flat = flat[np.ptp(flat, axis=1) > 0.15]
    wanted = np.array(rgb(property_id)) - min(rgb(property_id))
    given = flat - flat.min(axis=1, keepdims=True)
    alike = given @ wanted / np.linalg.norm(given, axis=1) / np.linalg.norm(wanted) > 1.0 - ALIKE
    return np.count_nonzero(alike) / (shown[::3, ::3].size / 3)


def viewport(walk, shown):
    region = walk.region("WINDOW")
    return shown[region.y + 10 : region.y + region.height - 60, region.x + 60 : region.x + region.width - 320]


def layers(walk):
    folder = Path(tempfile.mkdtemp())
    path = folder / "project.toml"
    save_project(project(), path)
    for item in list(bpy.data.objects):
        bpy.data.objects.remove(item)
    space = walk.area.spaces.active
    space.show_region_ui = False
    space.shading.type = "SOLID"
    space.show_gizmo = space.overlay.show_floor = space.overlay.show_axis_x = space.overlay.show_axis_y = (
        False
    )
    with in_the_viewport(walk):
        bpy.ops.realmodel.open_project(filepath=str(path))
        bpy.ops.realmodel.build()
        bpy.ops.realmodel.view(direction="FRONT")
    shutil.rmtree(folder)
    for item in bpy.context.selected_objects:
        item.select_set(False)
    yield walk.redrawn(3)
    walk.plain = walk.shot("BLOCKS")
    for place, key in (((50, 0, 2), 1), ((50, 0, 17), 2), ((50, 0, 32), 3)):
        assert hue_differs(walk.color_at(walk.plain, place), rgb(key)) < ALIKE, place


@contextmanager
def in_the_viewport(walk):
    """For operators; not over a `yield`, see driver.py."""
    ticks = walk.ticks
    with bpy.context.temp_override(window=walk.window, area=walk.area, region=walk.region("WINDOW")):
        yield
    assert walk.ticks == ticks, "Blender's loop went on while the context was overridden"


def modes(walk):
    walk.area.spaces.active.region_3d.view_rotation = viewports.view_rotation().to_quaternion()
    with in_the_viewport(walk):
        bpy.ops.realmodel.view_all()
    seen = {}
    for mode in ("BLOCKS", "POINTS", "LINES", "AREAS", "SURFACES", "POLYHEDRA"):
        bpy.context.scene.realmodel.display = mode
        yield walk.redrawn(3)
        seen[mode] = viewport(walk, walk.shot(mode))
    bpy.context.scene.realmodel.display = "BLOCKS"
    with in_the_viewport(walk):
        bpy.ops.realmodel.view(direction="FRONT")
    names = list(seen)
    for number, one in enumerate(names):
        for other in names[number + 1 :]:
            different = (np.abs(seen[one] - seen[other]).max(axis=2) > 0.08).mean()
            assert different > 0.002, f"{one} and {other} look alike: {different}"
    covered = {mode: [share(shown, key) for key in COLORS] for mode, shown in seen.items()}
    for mode in ("BLOCKS", "AREAS", "POLYHEDRA"):
        assert min(covered[mode]) > 0.02, (mode, covered[mode])
    for mode in ("POINTS", "LINES"):
        for key, one, whole in zip(COLORS, covered[mode], covered["BLOCKS"], strict=True):
            assert 0.0002 < one < 0.5 * whole, (mode, key, one, whole)


def hidden(walk):
    bpy.ops.realmodel.hide_property(property_id=2, action="HIDE")
    yield walk.redrawn(3)
    shown = walk.shot("hidden")
    assert share(viewport(walk, shown), 2) < 0.001, share(viewport(walk, shown), 2)
    assert share(viewport(walk, shown), 3) > 0.02
    bpy.ops.realmodel.hide_property(action="ALL")


def stage_and_explode(walk):
    scene = bpy.context.scene
    scene.realmodel.stage_slider.of_2 = 1
    yield walk.redrawn(3)
    shown = viewport(walk, walk.shot("stage"))
    assert share(shown, 3) < 0.001, share(shown, 3)
    assert share(shown, 2) > 0.02
    scene.realmodel.stage = 2
    scene.realmodel.explode = 1.0
    with in_the_viewport(walk):
        bpy.ops.realmodel.view_all()
    yield walk.redrawn(3)
    shown = walk.shot("explode")
    for name in ("Sand", "Cap"):
        item = bpy.data.objects[name]
        middle = {"Sand": 17.5, "Cap": 32.5}[name]
        place = item.matrix_world @ item.matrix_world.translation.__class__((50.0, 0.0, middle))
        assert hue_differs(walk.color_at(shown, place), rgb({"Sand": 2, "Cap": 3}[name])) < ALIKE
        assert item.matrix_world.translation.z > 5.0
    scene.realmodel.explode = 0.0
    with in_the_viewport(walk):
        bpy.ops.realmodel.view_all()


def cut(walk):
    """Seen from above only the top layer is seen; cut level below it, the layer beneath."""
    with in_the_viewport(walk):
        bpy.ops.realmodel.section_plane(axis="Z")
        plane = bpy.context.scene.realmodel.view.plane
        bpy.ops.realmodel.view(direction="TOP")
    plane.location.z = 20.0
    plane.select_set(False)
    yield lambda: ", 20.0]" in bpy.context.scene.realmodel.view.cut
    yield walk.redrawn(3)
    shown = walk.shot("cut")
    assert hue_differs(walk.color_at(shown, (30, 40, 20)), rgb(2)) < ALIKE
    assert share(viewport(walk, shown), 3) < 0.001
    plane.location.z = 5.0
    yield lambda: ", 5.0]" in bpy.context.scene.realmodel.view.cut
    yield walk.redrawn(3)
    shown = walk.shot("cut_lower")
    assert hue_differs(walk.color_at(shown, (30, 40, 5)), rgb(1)) < ALIKE
    bpy.ops.realmodel.section_remove()
    yield walk.redrawn(3)
    assert hue_differs(walk.color_at(walk.shot("whole"), (30, 40, 40)), rgb(3)) < ALIKE


def captures(walk):
    """What is captured is what is seen, in another size."""
    scene = bpy.context.scene
    for mode, least in (("BLOCKS", 0.05), ("POINTS", 0.0002), ("LINES", 0.0002)):
        scene.realmodel.display = mode
        yield walk.redrawn(2)
        path = walk.folder / f"capture_{mode}.png"
        with in_the_viewport(walk):
            bpy.ops.realmodel.view(direction="FRONT")
            bpy.ops.realmodel.capture(filepath=str(path), width=700, height=300)
        shown = read_picture(path)
        assert shown.shape == (300, 700, 3), shown.shape
        for key in COLORS:
            assert share(shown, key) > least, (mode, key, share(shown, key))
    scene.realmodel.display = "BLOCKS"
    yield walk.redrawn(2)


def an_animation(walk):
    """Rendered from the window as Ctrl-F12 does it, beside the window: each frame has its stage."""
    scene = bpy.context.scene
    before = [(o.name, len(o.data.polygons)) for o in scene.objects if o.type == "MESH"]
    for frame, stage in ((1, 0), (2, 1), (3, 2)):
        scene.realmodel.stage = stage
        scene.keyframe_insert("realmodel.stage", frame=frame)
    camera = bpy.data.cameras.new("camera")
    camera.type, camera.ortho_scale = "ORTHO", 110.0
    item = bpy.data.objects.new("camera", camera)
    item.location, item.rotation_euler = (50.0, -100.0, 20.0), (np.pi / 2, 0.0, 0.0)
    scene.collection.objects.link(item)
    scene.camera, scene.frame_start, scene.frame_end = item, 1, 3
    render = scene.render
    render.engine, render.film_transparent, render.use_lock_interface = "CYCLES", True, True
    render.resolution_x = render.resolution_y = 64
    render.image_settings.color_mode = "RGBA"
    scene.cycles.samples, scene.cycles.use_denoising = 1, False
    bpy.context.preferences.view.render_display_type = "NONE"
    for mode in ("BLOCKS", "LINES"):
        scene.realmodel.display = mode
        render.filepath = str(walk.folder / f"frame_{mode}_")
        with in_the_viewport(walk):
            bpy.ops.render.render("INVOKE_DEFAULT", animation=True)
        last = walk.folder / f"frame_{mode}_0003.png"
        yield lambda last=last: last.exists() and not bpy.app.is_job_running("RENDER")
        yield walk.redrawn(2)
        covered = [
            (read_alpha(walk.folder / f"frame_{mode}_{frame:04d}.png") > 0.5).mean() for frame in (1, 2, 3)
        ]
        assert 0.01 < covered[0] < covered[1] < covered[2], (mode, covered)
    yield lambda: not [o for o in scene.objects if o.get("realmodel_view") == "marks"]
    scene.realmodel.display = "BLOCKS"
    scene.animation_data_clear()
    scene.realmodel.stage = 2
    yield lambda: not preparing.is_working(scene)
    yield walk.redrawn(2)
    bpy.data.objects.remove(item)
    after = [(o.name, len(o.data.polygons)) for o in scene.objects if o.type == "MESH"]
    assert after == before, (before, after)


def coordinates_under_the_mouse(walk):
    with in_the_viewport(walk):
        bpy.ops.realmodel.coordinates("INVOKE_DEFAULT")
    x, y = walk.pixel_of((40, 0, 15))
    walk.move(x + 3, y)
    walk.move(x, y)
    yield walk.redrawn(1)
    walk.click(x, y)
    yield lambda: bool(bpy.context.scene.realmodel.view.place)
    from realmodel.bl.display import coordinates

    place = coordinates.last(bpy.context.scene)
    assert place.block == "Sand", place
    assert abs(place.x - 40) < 1 and abs(place.z - 15) < 1 and abs(place.y) < 1e-3, place
    assert abs(place.thickness - 15.0) < 1e-3, place


def overlays(walk):
    """Each is there when it is on, and nowhere when it is off."""
    view = bpy.context.scene.realmodel.view
    with in_the_viewport(walk):
        bpy.ops.realmodel.view(direction="FRONT")
    names = ("show_legend", "show_north", "show_scale", "show_axes")
    for name in names:
        setattr(view, name, False)
    yield walk.redrawn(3)
    region = walk.region("WINDOW")

    def whole(shown):
        return shown[region.y : region.y + region.height, region.x : region.x + region.width]

    bare = whole(walk.shot("no_overlays"))
    for name in names:
        setattr(view, name, True)
        yield walk.redrawn(3)
        shown = whole(walk.shot(name))
        different = (np.abs(shown - bare).max(axis=2) > 0.2).mean()
        assert 0.002 < different < 0.25, (name, different)
        setattr(view, name, False)
    for name in names:
        setattr(view, name, True)
    walk.area.spaces.active.region_3d.view_rotation = viewports.view_rotation().to_quaternion()
    yield walk.redrawn(3)
    walk.shot("all_overlays")
    path = walk.folder / "capture_overlays.png"
    with in_the_viewport(walk):
        bpy.ops.realmodel.capture(filepath=str(path), width=900, height=600)
    paper = read_picture(path)[8:60, 8:60]
    assert (paper.min(axis=2) > 0.85).mean() > 0.1, "there is no legend in the capture"


def exaggerated(walk):
    """Twice as high in the viewport, and not in the mesh."""
    view = bpy.context.scene.realmodel.view
    for name in ("show_north", "show_scale", "show_axes"):
        setattr(view, name, False)
    item = bpy.data.objects["Cap"]
    with in_the_viewport(walk):
        bpy.ops.realmodel.view(direction="FRONT")
    yield walk.redrawn(3)
    first = walk.shot("true_heights")
    assert hue_differs(walk.color_at(first, (50, 0, 32)), rgb(3)) < ALIKE
    before = [tuple(vertex.co) for vertex in item.data.vertices]
    view.exaggeration = 2.0
    yield walk.redrawn(1)
    with in_the_viewport(walk):
        bpy.ops.realmodel.view(direction="FRONT")
    yield walk.redrawn(3)
    shown = walk.shot("exaggerated")
    for place, key in (((50, 0, 5), 1), ((50, 0, 39), 2), ((50, 0, 69), 3)):
        assert hue_differs(walk.color_at(shown, place), rgb(key)) < ALIKE, place
    assert [tuple(vertex.co) for vertex in item.data.vertices] == before
    view.exaggeration = 1.0
    yield walk.redrawn(1)
    with in_the_viewport(walk):
        bpy.ops.realmodel.view(direction="FRONT")
    yield walk.redrawn(2)


def colors_of_values(walk):
    """The top is yellow, the bottom dark blue, and the legend says so."""
    scene = bpy.context.scene
    scene.realmodel.color_by = "ELEVATION"
    yield walk.redrawn(3)
    shown = walk.shot("ELEVATION")
    high, low = (walk.color_at(shown, (50, 0, z)) for z in (39, -4))
    assert high[0] > high[2] + 0.1 and low[2] > low[0], (high, low)
    for by in ("THICKNESS", "UNCERTAINTY"):
        scene.realmodel.color_by = by
        yield walk.redrawn(3)
        walk.shot(by)
    scene.realmodel.color_by = "PROPERTY"
    yield walk.redrawn(3)
    assert hue_differs(walk.color_at(walk.shot("PROPERTY"), (50, 0, 32)), rgb(3)) < ALIKE


def surfaces_as_they_survive(walk):
    scene = bpy.context.scene
    scene.realmodel.display, scene.realmodel.view.surfaces = "SURFACES", "SURVIVING"
    yield walk.redrawn(3)
    walk.shot("surviving")
    scene.realmodel.rocks[0].active_surface = 2
    with in_the_viewport(walk):
        bpy.ops.realmodel.edit_surface()
    yield walk.redrawn(3)
    walk.shot("edit_surface")
    assert bpy.context.mode == "EDIT_MESH"
    with in_the_viewport(walk):
        bpy.ops.realmodel.edit_done()
    scene.realmodel.display = "BLOCKS"
    yield walk.redrawn(2)


def camera_and_sun(walk):
    """The camera sees what the viewport sees."""
    scene = bpy.context.scene
    with in_the_viewport(walk):
        bpy.ops.realmodel.set_up_picture()
    camera = scene.camera
    view = walk.area.spaces.active.region_3d
    turned = camera.matrix_world.to_quaternion().rotation_difference(view.view_rotation).angle
    assert min(turned, 6.2832 - turned) < 1e-3, turned
    view.view_perspective = "CAMERA"
    yield walk.redrawn(3)
    walk.shot("camera")
    view.view_perspective = "PERSP"
    for item in [item for item in scene.objects if "realmodel_picture" in item]:
        bpy.data.objects.remove(item)
    yield walk.redrawn(1)


STEPS = (
    layers,
    modes,
    hidden,
    stage_and_explode,
    cut,
    captures,
    overlays,
    exaggerated,
    colors_of_values,
    surfaces_as_they_survive,
    camera_and_sun,
    an_animation,
    coordinates_under_the_mouse,
)
