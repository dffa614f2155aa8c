# SPDX-License-Identifier: GPL-3.0-or-later
"""Closed meshes as artists sculpt them, which the pictures of filled meshes are of. Needs Blender."""


def arch():
    """A natural arch, 6 wide and 3.4 high: two legs and what is over them, worn and rough; the active
    object."""
    import bpy

    parts = (
        ((-1.9, 0.0, 0.8), (0.9, 1.0, 1.3)),
        ((1.9, 0.1, 0.7), (1.1, 1.2, 1.3)),
        ((0.0, 0.0, 2.5), (2.7, 0.9, 0.75)),
    )
    for location, scale in parts:
        bpy.ops.mesh.primitive_cube_add(location=location, scale=scale)
    for item in bpy.context.view_layer.objects:
        item.select_set(True)
    bpy.ops.object.join()
    item = bpy.context.object
    item.name = "Arch"
    _voxels(item, 0.05)
    smooth = item.modifiers.new("Smooth", "SMOOTH")
    smooth.factor, smooth.iterations = 0.5, 110
    _clouds(item, 1.1, 0.7)
    _clouds(item, 0.3, 0.12)
    return item


def block():
    """A cube of 2 with worn edges; the active object."""
    import bpy

    bpy.ops.mesh.primitive_cube_add(size=2.0)
    item = bpy.context.object
    item.name = "Block"
    _voxels(item, 0.06)
    smooth = item.modifiers.new("Smooth", "SMOOTH")
    smooth.factor, smooth.iterations = 0.5, 12
    return item


def boulder():
    """A ball with bumps, as somebody may sculpt one; the active object."""
    import bpy
    import numpy as np

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
    item.data.update()
    return item


def _voxels(item, size):
    """Makes one surface of parts that overlap, of quads of this size."""
    remesh = item.modifiers.new("Remesh", "REMESH")
    remesh.mode, remesh.voxel_size = "VOXEL", size


def _clouds(item, size, strength):
    """Bumps of this size and height."""
    import bpy

    displace = item.modifiers.new("Displace", "DISPLACE")
    displace.texture = bpy.data.textures.new("Clouds", "CLOUDS")
    displace.texture.noise_scale, displace.strength = size, strength
