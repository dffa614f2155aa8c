#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders the picture of Fill with Strata in the guide: a sculpted boulder filled with strata.

build/venv-bpy/bin/python scripts/draw_filling.py
blender -b --factory-startup -P scripts/draw_filling.py
"""

import math
import sys
from pathlib import Path

import bpy
import numpy as np
from mathutils import Vector

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "addon"))

import realmodel  # noqa: E402
from realmodel.bl import versions  # noqa: E402

PICTURE = ROOT / "docs" / "images" / "guide" / "filled_boulder.jpg"


def boulder():
    """A ball with bumps, as somebody may sculpt one; the active object."""
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=7, radius=1.0)
    item = bpy.context.object
    item.name = "Boulder"
    places = np.empty(3 * len(item.data.vertices), np.float32)
    item.data.vertices.foreach_get("co", places)
    places = places.reshape(-1, 3)
    x, y, z = places.T
    bumps = 0.15 * np.sin(3 * x + 2 * z) * np.cos(4 * y) + 0.03 * np.sin(9 * x - 7 * y + 5 * z)
    bumps += 0.01 * np.sin(23 * x + 17 * z) * np.cos(19 * y)
    item.data.vertices.foreach_set("co", (places * (2.0 + 2.0 * bumps)[:, None]).ravel())
    return item


def light_and_camera(scene):
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.location = (5.2, -6.2, 3.2)
    camera.rotation_euler = (-camera.location).to_track_quat("-Z", "Y").to_euler()
    sun = bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN"))
    sun.data.energy = 3.5
    sun.rotation_euler = Vector((-0.6, 0.5, -0.9)).to_track_quat("-Z", "Y").to_euler()
    for item in (camera, sun):
        scene.collection.objects.link(item)
    scene.camera = camera
    scene.world = bpy.data.worlds.new("World")
    scene.world.color = (0.55, 0.6, 0.68)


def main():
    bpy.ops.wm.read_factory_settings(use_empty=True)
    realmodel.register()
    boulder()
    bpy.ops.realmodel.fill_with_strata(
        preset="FAULTED",
        palette="CANYON",
        beds=18,
        dip=math.radians(25),
        fold_amplitude=0.06,
        unconformity=0.75,
    )
    scene = bpy.context.scene
    light_and_camera(scene)
    versions.plain_colors(scene)
    scene.render.engine = "CYCLES"
    scene.cycles.samples = 24
    versions.denoise(scene)
    scene.render.resolution_x, scene.render.resolution_y = 720, 560
    scene.render.image_settings.file_format, scene.render.image_settings.quality = "JPEG", 88
    scene.render.filepath = str(PICTURE)
    bpy.ops.render.render(write_still=True)


main()
