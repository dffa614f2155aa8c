# SPDX-License-Identifier: GPL-3.0-or-later
"""Booleans of surfaces in the manner of the thesis (G. Mei, RealModel, Freiburg 2014, figures 4.7 to 4.11):
a sheet divides a sculpture, two cylinders cross, and two tori. All shapes are formulas.

    blender -P blend_samples/booleans/scene.py
    blender -b -P blend_samples/booleans/scene.py -- booleans.blend
    blender -b -P blend_samples/booleans/scene.py -- booleans.png
"""

import math
import sys
from pathlib import Path

import bpy
import numpy as np

APART = 0.45  # how far the parts are drawn apart, of their distance from the middle
COLORS = {
    "clay": (0.62, 0.23, 0.11, 1),
    "slate": (0.09, 0.22, 0.36, 1),
    "brass": (0.95, 0.62, 0.13, 1),
    "ink": (0.01, 0.01, 0.015, 1),
}
NAMES = ("A sheet divides a sculpture", "Two cylinders", "Two tori")
TOWARDS_CAMERA = (1.16, 0.0, 0.0)


def grid(n, m, is_closed, place):
    """n by m quads between places of place(u, v), u and v from 0 to 1; is_closed: whether these go around."""
    counts = [count + (not closed) for count, closed in zip((n, m), is_closed, strict=True)]
    u, v = (a.ravel() for a in np.meshgrid(*(np.arange(c) for c in counts), indexing="ij"))
    vertices = np.stack(place(u / n, v / m), axis=1)
    i, j = (a.ravel() for a in np.meshgrid(np.arange(n), np.arange(m), indexing="ij"))
    k, w = (i + 1) % counts[0], (j + 1) % counts[1]
    return vertices, np.stack([a * counts[1] + b for a, b in ((i, j), (k, j), (k, w), (i, w))], axis=1)


def torus(radius=1.0, tube=0.36):
    def place(u, v):
        along = radius + tube * np.cos(2 * np.pi * v)
        return along * np.cos(2 * np.pi * u), along * np.sin(2 * np.pi * u), tube * np.sin(2 * np.pi * v)

    return grid(96, 36, (True, True), place)


def cylinder(radius=0.6, length=2.8):
    def place(u, v):
        angle = 2 * np.pi * u
        return radius * np.cos(angle), radius * np.sin(angle), length * (v - 0.5)

    vertices, quads = grid(96, 1, (True, False), place)
    rim = np.arange(96) * 2
    return vertices, [*quads.tolist(), (rim + 1).tolist(), rim[::-1].tolist()]


def sculpture():
    """A twisted column with five ribs and a waist."""

    def place(u, v):
        angle, height = 2 * np.pi * u, 2.6 * (v - 0.5)
        around = 0.72 + 0.13 * np.cos(5 * angle + 2.2 * height) + 0.14 * np.cos(2.4 * height + 0.6)
        return around * np.cos(angle), around * np.sin(angle), height

    vertices, quads = grid(180, 90, (True, False), place)
    foot = np.arange(180) * 91
    return vertices, [*quads.tolist(), (foot + 90).tolist(), foot[::-1].tolist()]


def sheet(size=2.6):
    def place(u, v):
        return size * (u - 0.5), size * (v - 0.5), np.zeros_like(u)

    return grid(8, 8, (False, False), place)


def add(name, shape, color, at, turned=(0.0, 0.0, 0.0)):
    vertices, faces = shape
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(vertices.tolist(), [], [list(face) for face in faces])
    mesh.materials.append(bpy.data.materials.get(color) or _material(color))
    if hasattr(mesh, "use_auto_smooth"):  # before 4.1 sharp edges count only so
        mesh.use_auto_smooth, mesh.auto_smooth_angle = True, math.pi
    for polygon in mesh.polygons:
        polygon.use_smooth = len(polygon.vertices) == 4 and len(faces) > 64
    item = bpy.data.objects.new(name, mesh)
    item.location, item.rotation_euler = at, turned
    bpy.context.scene.collection.objects.link(item)
    return item


def _material(color):
    material = bpy.data.materials.new(color)
    material.use_nodes = True
    principled = material.node_tree.nodes["Principled BSDF"]
    principled.inputs["Base Color"].default_value = material.diffuse_color = COLORS[color]
    principled.inputs["Roughness"].default_value = 0.6
    return material


def divide(first, second):
    """Divides two objects; returns the collection of their parts."""
    for item in bpy.context.view_layer.objects:
        item.select_set(item in (first, second))
    bpy.context.view_layer.objects.active = first
    known = set(bpy.data.collections)
    bpy.ops.realmodel.boolean(operation="DIVIDE")
    return next(c for c in bpy.data.collections if c not in known and c.children)


def show(parts, middle):
    """Draws the solids and the parts of open surfaces apart, and the loops as tubes."""
    solids = [item for item in parts.all_objects if item["realmodel"] == "sub_block"]
    kept = {"sub_block"} if len(solids) > 2 else {"sub_block", "sub_surface"}
    for item in list(parts.all_objects):
        kind = item["realmodel"]
        if kind == "loop":
            _as_tube(item)
            continue
        is_open = kind == "sub_surface" and item.name.startswith("Sheet")
        if kind not in kept or (kind == "sub_surface" and not is_open):
            item.hide_set(True)
            item.hide_render = True
            continue
        if not is_open:
            matrix = np.array(item.matrix_world)
            at = np.array([vertex.co for vertex in item.data.vertices])
            center = at.mean(axis=0) @ matrix[:3, :3].T + matrix[:3, 3]
            item.location += type(item.location)(APART * (center - np.array(middle)))


def _as_tube(item):
    """A loop as a curve that can be seen in pictures, where it is."""
    mesh = item.data
    curve = bpy.data.curves.new(item.name, "CURVE")
    curve.dimensions, curve.bevel_depth = "3D", 0.018
    spline = curve.splines.new("POLY")
    spline.points.add(len(mesh.vertices) - 1)
    for point, vertex in zip(spline.points, mesh.vertices, strict=True):
        point.co = (*vertex.co, 1.0)
    spline.use_cyclic_u = len(mesh.edges) == len(mesh.vertices)
    curve.materials.append(bpy.data.materials.get("brass") or _material("brass"))
    tube = bpy.data.objects.new(f"{item.name}, Tube", curve)
    tube.matrix_world = item.matrix_world
    item.users_collection[0].objects.link(tube)
    tube["realmodel"] = "loop"


def label(parts, name, x):
    """Writes beneath a pair what came of it."""
    kinds = [item["realmodel"] for item in parts.all_objects if item.type == "MESH" and "realmodel" in item]
    loops = sum(kind == "loop" for kind in kinds)
    counts = f"{kinds.count('sub_block')} sub-blocks, {loops} loop{'s' if loops > 1 else ''}"
    for line, (text, size) in enumerate(((name, 0.34), (counts, 0.26))):
        curve = bpy.data.curves.new(text, "FONT")
        curve.body, curve.size, curve.align_x = text, size, "CENTER"
        curve.materials.append(bpy.data.materials.get("ink") or _material("ink"))
        item = bpy.data.objects.new(text, curve)
        item.location, item.rotation_euler = (x, -1.5, -2.0 - 0.4 * line), TOWARDS_CAMERA
        bpy.context.scene.collection.objects.link(item)


def make():
    """The three scenes side by side; returns the collections of their parts."""
    quarter = math.pi / 2
    pairs = [
        (
            add("Sheet", sheet(), "slate", (-4.0, 0.0, 0.0), (0.35, 0.5, 0.0)),
            add("Sculpture", sculpture(), "clay", (-4.0, 0.0, 0.0)),
        ),
        (
            add("Cylinder 1", cylinder(), "clay", (0.0, 0.0, 0.0)),
            add("Cylinder 2", cylinder(0.5), "slate", (0.0, 0.0, 0.0), (quarter, 0.0, 0.6)),
        ),
        (
            add("Torus 1", torus(), "clay", (3.4, 0.0, 0.0), (0.6, -0.2, 0.0)),
            add("Torus 2", torus(), "slate", (4.6, 0.0, 0.3), (1.0, 0.5, 0.0)),
        ),
    ]
    bpy.context.view_layer.update()
    made = []
    for (first, second), name in zip(pairs, NAMES, strict=True):
        parts = divide(first, second)
        middle = (first.location + second.location) / 2
        show(parts, middle)
        label(parts, name, middle.x)
        made.append(parts)
    return made


def light_and_camera(scene):
    sun = bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN"))
    sun.rotation_euler, sun.data.energy, sun.data.angle = (0.7, 0.2, 0.5), 3.5, 0.1
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.location, camera.rotation_euler = (0.2, -14.0, 5.9), TOWARDS_CAMERA
    camera.data.lens = 42
    for item in (sun, camera):
        scene.collection.objects.link(item)
    scene.camera = camera
    scene.world = bpy.data.worlds.new("World")
    scene.world.use_nodes = True
    scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.9, 0.93, 1.0, 1.0)
    scene.render.engine = "CYCLES"
    scene.cycles.samples = 32
    scene.render.resolution_x, scene.render.resolution_y = 1280, 600
    scene.view_settings.view_transform = "Standard"


def main(file=None):
    sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "addon"))
    import realmodel

    realmodel.register_for_batch()
    scene = bpy.context.scene
    for item in list(scene.objects):
        bpy.data.objects.remove(item)
    for parts in make():
        print(parts.name)
        for item in parts.all_objects:
            if "realmodel_volume" in item:
                print(f"    {item.name}: {item['realmodel_volume']:.4f}")
    light_and_camera(scene)
    if file is None:
        return
    if file.endswith(".blend"):
        bpy.ops.wm.save_as_mainfile(filepath=str(Path(file).resolve()))
    else:
        scene.render.filepath = str(Path(file).resolve())
        bpy.ops.render.render(write_still=True)


if __name__ == "__main__":
    main(*(sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else ()))
