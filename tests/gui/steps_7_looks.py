# SPDX-License-Identifier: GPL-3.0-or-later
"""The looks of rocks as Eevee renders them, which needs a window: Cycles renders them in tests/blender."""

import bpy
import numpy as np
from realmodel.bl import looks, materials, meshes

CHOSEN = ("FLAT", "SHALE")  # each with a texture takes seconds where a processor draws
COLUMNS, TILE = 2, 40  # looks beside one another, and their pixels
COLOR = "#8090b0"


def eevee_renders_looks(walk):
    """In the color of its property, textured; laminae along the layers."""
    scene = bpy.data.scenes.new("looks")
    rows = -(-len(CHOSEN) // COLUMNS)
    made = [_tile(scene, n % COLUMNS, n // COLUMNS, key) for n, key in enumerate(CHOSEN)]
    camera = bpy.data.cameras.new("looks")
    camera.type, camera.ortho_scale = "ORTHO", float(COLUMNS)
    eye = bpy.data.objects.new("looks", camera)
    eye.location, eye.rotation_euler = (COLUMNS / 2, -50.0, rows / 2), (np.pi / 2, 0.0, 0.0)
    lamp = bpy.data.objects.new("looks", bpy.data.lights.new("looks", "SUN"))
    lamp.rotation_euler, lamp.data.energy = (np.pi / 2 - 0.5, 0.0, 0.4), 3.0
    for item in (eye, lamp):
        scene.collection.objects.link(item)
    scene.camera = eye
    render = scene.render
    render.engine = "BLENDER_EEVEE" if not (4, 2, 0) <= bpy.app.version < (5, 0, 0) else "BLENDER_EEVEE_NEXT"
    scene.eevee.taa_render_samples = 4
    scene.view_settings.view_transform = "Standard"
    render.resolution_x, render.resolution_y = COLUMNS * TILE, rows * TILE
    render.resolution_percentage = 100
    render.image_settings.file_format = "PNG"
    render.filepath = str(walk.folder / "eevee_looks.png")
    bpy.ops.render.render(scene=scene.name, write_still=True)
    yield walk.redrawn()
    image = bpy.data.images.load(render.filepath)
    pixels = np.array(image.pixels[:], np.float32).reshape(rows * TILE, COLUMNS * TILE, -1)[:, :, :3]
    bpy.data.images.remove(image)
    for number, key in enumerate(CHOSEN):
        column, row = number % COLUMNS * TILE, number // COLUMNS * TILE
        tile = pixels[row + 4 : row + TILE - 4, column + 4 : column + TILE - 4]
        red, green, blue = tile.mean(axis=(0, 1))
        assert blue > green > 0.05 and blue > red, (key, red, green, blue)  # else pink or black
        spread = tile.std(axis=(0, 1)).max()
        assert (spread < 0.004) if key == "FLAT" else (spread > 0.004), (key, spread)
        if key == "SHALE":
            level, across = tile.mean(axis=1).std(axis=0).max(), tile.mean(axis=0).std(axis=0).max()
            assert level > 2.0 * across, (level, across)
    for item in [*made, eye, lamp]:
        bpy.data.objects.remove(item)
    bpy.data.scenes.remove(scene)


def _tile(scene, column, row, key):
    """An upright square, the wall of a layer."""
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
    item = bpy.data.objects.new(key, mesh)
    scene.collection.objects.link(item)
    return item


STEPS = (eevee_renders_looks,)
