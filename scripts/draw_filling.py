#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders the pictures of filled meshes in the guide: a sculpted boulder, the cliff of the recipes for
artists, and beds with pegs for a print; and the thumbnails of the presets.

    build/venv-bpy/bin/python scripts/draw_filling.py [NAME ...]      (default: all)

The module bpy has a denoiser, which Debian's Blender lacks.
"""

import math
import os
import sys
import tempfile
from pathlib import Path

import bpy
import numpy as np
from mathutils import Vector

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT / "addon"), str(ROOT / "scripts")]

import gallery_picture  # noqa: E402
import realmodel  # noqa: E402
import sculptures  # noqa: E402
from realmodel.bl.host import versions  # noqa: E402

IMAGES = ROOT / "docs" / "images" / "guide"
THUMBNAILS, SIDE = ROOT / "addon" / "realmodel" / "previews" / "filling.jpg", 128  # pixels
SIZE = (900, 560)
RAYS, SECONDS = 10, 600.0  # of a pixel, and of a picture at most


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


def filled_boulder():
    """A boulder filled with tilted and faulted strata under level ones."""
    sculptures.boulder()
    bpy.ops.realmodel.fill_with_strata(
        preset="FAULTED",
        palette="CANYON",
        beds=18,
        dip=math.radians(25),
        fold_amplitude=0.06,
        unconformity=0.75,
    )
    light_and_camera(bpy.context.scene)
    render(IMAGES / "filled_boulder.jpg", (720, 560))


def cliff():
    """As the recipe says it."""
    bpy.ops.realmodel.strata_rock_add(kind="CLIFF", size=40.0, strength=1.3, faces=600_000)
    bpy.ops.realmodel.set_up_picture(sun_elevation=math.radians(20.0), sun_azimuth=math.radians(235.0))
    corners = np.array([(x, y, z) for x in (-15, 15) for y in (-6, 6) for z in (3, 17)], float)
    size = (1280, 720)
    gallery_picture.aim(bpy.context.scene.camera, corners, size, 195.0, 6.0, (0.0, 0.0))
    render(IMAGES / "cliff.jpg", size)


def print_parts():
    """Beds moved apart, with pegs on them and holes for these."""
    sculptures.boulder().scale = (1.6, 1.2, 0.7)
    bpy.ops.realmodel.fill_with_strata(preset="PRINT", beds=3, peg_size=0.12, rock_looks=False, seed=3)
    beds = sorted(bpy.context.selected_objects, key=lambda item: item.name)
    for number, bed in enumerate(beds):
        bed.location.z += 0.9 * number
    bpy.ops.realmodel.set_up_picture()
    bpy.context.view_layer.update()
    corners = [bed.matrix_world @ Vector(corner) for bed in beds for corner in bed.bound_box]
    gallery_picture.aim(bpy.context.scene.camera, np.array(corners), (900, 750), 150.0, 18.0, (0.0, 0.0))
    render(IMAGES / "print_parts.jpg", (900, 750))


def thumbnails():
    """The same block filled with each preset, beside one another."""
    properties = bpy.ops.realmodel.fill_with_strata.get_rna_type().properties
    presets = [item.identifier for item in properties["preset"].enum_items if item.identifier != "NONE"]
    strip = np.empty((SIDE, SIDE * len(presets), 4), np.float32)
    for number, preset in enumerate(presets):
        bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
        sculptures.block()
        bpy.ops.realmodel.fill_with_strata(preset=preset, fold_axis=math.radians(170.0))
        for height, bed in enumerate(sorted(bpy.context.selected_objects, key=lambda item: item.name)):
            bed.location.z += 0.2 * height if preset == "PRINT" else 0.0
        bpy.ops.realmodel.set_up_picture()
        corners = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float)
        gallery_picture.aim(bpy.context.scene.camera, corners, (SIDE, SIDE), 150.0, 20.0, (0.0, 0.0))
        strip[:, number * SIDE : (number + 1) * SIDE] = rendered((SIDE, SIDE))
    image = bpy.data.images.new("thumbnails", strip.shape[1], strip.shape[0])
    image.pixels.foreach_set(strip.ravel())
    image.filepath_raw, image.file_format = str(THUMBNAILS), "JPEG"
    image.save(quality=88)


def rendered(size):
    """(height, width, 4) the picture of the scene's camera."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "picture.jpg"
        render(file, size)
        image = bpy.data.images.load(str(file))
        pixels = np.empty(4 * size[0] * size[1], np.float32)
        image.pixels.foreach_get(pixels)
        bpy.data.images.remove(image)
    return pixels.reshape(size[1], size[0], 4)


def render(file, size):
    """Writes the picture of the scene's camera."""
    scene = bpy.context.scene
    versions.plain_colors(scene)
    scene.render.engine = "CYCLES"
    scene.cycles.samples, scene.cycles.time_limit = RAYS, SECONDS
    versions.denoise(scene)
    scene.render.resolution_x, scene.render.resolution_y = size
    scene.render.image_settings.file_format, scene.render.image_settings.quality = "JPEG", 88
    scene.render.filepath = str(file)
    bpy.ops.render.render(write_still=True)


def main(names):
    realmodel.register()
    for draw in (filled_boulder, cliff, print_parts, thumbnails):
        if not names or draw.__name__ in names:
            bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
            draw()
    sys.stdout.flush()
    os._exit(0)  # the module bpy may hang as it ends


main(sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else sys.argv[1:])
