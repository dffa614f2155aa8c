# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders looks of rocks with Eevee, which needs no window, but OpenGL by EGL; a processor will do:

    blender -b --factory-startup --python-exit-code 1 -P tests/blender/render_eevee.py -- FILE.png [LOOK ...]
    python tests/blender/render_eevee.py -- FILE.png [LOOK ...]

or xvfb-run where there is no EGL. LOOK: keys of core.project.looks.LOOKS (default: all). Each is a tile of
an upright wall, COLUMNS in a row from the lower left, with laminae that are level.
"""

import os
import sys
from pathlib import Path

import bpy
import numpy as np

COLUMNS, TILE = 4, 40  # looks beside one another, and their pixels
COLOR = "#8090b0"


def main(file, *keys):
    sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "addon"))
    import realmodel
    from realmodel.core.project.looks import LOOKS

    realmodel.register_for_batch()
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    keys = keys or tuple(LOOKS)
    scene, rows = bpy.context.scene, -(-len(keys) // COLUMNS)
    for number, key in enumerate(keys):
        _tile(scene, number % COLUMNS, number // COLUMNS, key)
    _light_and_camera(scene, rows)
    render = scene.render
    render.engine = "BLENDER_EEVEE" if not (4, 2, 0) <= bpy.app.version < (5, 0, 0) else "BLENDER_EEVEE_NEXT"
    scene.eevee.taa_render_samples = 1
    scene.view_settings.view_transform = "Standard"
    render.resolution_x, render.resolution_y = COLUMNS * TILE, rows * TILE
    render.resolution_percentage = 100
    render.image_settings.file_format = "PNG"
    render.filepath = str(Path(file).resolve())
    bpy.ops.render.render(write_still=True)


def _light_and_camera(scene, rows):
    camera = bpy.data.cameras.new("camera")
    camera.type, camera.ortho_scale = "ORTHO", float(max(COLUMNS, rows))
    eye = bpy.data.objects.new("camera", camera)
    eye.location, eye.rotation_euler = (COLUMNS / 2, -50.0, rows / 2), (np.pi / 2, 0.0, 0.0)
    lamp = bpy.data.objects.new("lamp", bpy.data.lights.new("lamp", "SUN"))
    lamp.rotation_euler, lamp.data.energy = (np.pi / 2 - 0.5, 0.0, 0.4), 3.0
    for item in (eye, lamp):
        scene.collection.objects.link(item)
    scene.camera, scene.world = eye, None


def _tile(scene, column, row, key):
    """An upright square, the wall of a layer."""
    from realmodel.bl.objects import materials, meshes
    from realmodel.bl.shading import looks

    corners = np.array([[0, 0, 0], [1, 0, 0], [1, 0, 1], [0, 0, 1]], float) + np.array([column, 0.0, row])
    mesh = meshes.triangle_mesh(key, corners, [[0, 1, 2], [0, 2, 3]])
    for name, values in (("height", corners[[0, 1, 2, 0, 2, 3], 2] - row), ("thickness", np.ones(6))):
        attribute = mesh.attributes.new(meshes.PREFIX + name, *meshes.BEDDING[name])
        attribute.data.foreach_set("value", values.astype(np.float32))
    top = mesh.attributes.new(meshes.PREFIX + "is_top", *meshes.BEDDING["is_top"])
    top.data.foreach_set("value", [True, True])
    material = materials.new_material(key, 1, COLOR)
    looks.apply(material, key, 1.0, 3, looks.UNITS / 8.0)
    mesh.materials.append(material)
    scene.collection.objects.link(bpy.data.objects.new(key, mesh))


if __name__ == "__main__":
    main(*sys.argv[sys.argv.index("--") + 1 :])
    sys.stdout.flush()
    os._exit(0)  # the module bpy may hang as it ends
