# SPDX-License-Identifier: GPL-3.0-or-later
"""What the tests ask of Blender's data: an empty file, an inventory, meshes as arrays."""

import bpy
import numpy as np

KINDS = ("scenes", "collections", "objects", "meshes", "materials", "cameras", "lights", "worlds", "images")


def empty_file():
    """Start with nothing but one scene."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    return bpy.context.scene


def inventory():
    """All that could change: every datablock's name, users and custom properties, links, coordinates."""
    state = {}
    for kind in KINDS:
        for datablock in getattr(bpy.data, kind):
            properties = {key: str(value) for key, value in datablock.items()}
            state[kind, datablock.name] = (datablock.users, properties)
    for collection in [*bpy.data.collections, *(scene.collection for scene in bpy.data.scenes)]:
        names = sorted(item.name for item in collection.objects), sorted(c.name for c in collection.children)
        state["links", collection.name_full] = names
    for mesh in bpy.data.meshes:
        state["mesh", mesh.name] = coordinates(mesh).tobytes()
    for material in bpy.data.materials:
        state["color", material.name] = tuple(material.diffuse_color)
    return state


def coordinates(mesh):
    """(V, 3) float64."""
    flat = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.vertices.foreach_get("co", flat)
    return flat.reshape(-1, 3).astype(np.float64)


def corners(mesh):
    """Polygons' starts (F+1,) and vertex numbers (sum,)."""
    starts = np.empty(len(mesh.polygons) + 1, np.int32)
    mesh.polygons.foreach_get("loop_start", starts[:-1])
    starts[-1] = len(mesh.loops)
    vertices = np.empty(len(mesh.loops), np.int32)
    mesh.loops.foreach_get("vertex_index", vertices)
    return starts, vertices


def open_edges(mesh):
    """How many edges are not used as often in one direction as in the other."""
    starts, vertices = corners(mesh)
    following = np.arange(len(vertices)) + 1
    following[starts[1:] - 1] = starts[:-1]
    a, b = vertices.astype(np.int64), vertices[following].astype(np.int64)
    key = np.minimum(a, b) * len(mesh.vertices) + np.maximum(a, b)
    _, edge = np.unique(key, return_inverse=True)
    return int(np.count_nonzero(np.bincount(edge, np.where(a < b, 1, -1))))


def volume(mesh):
    """Volume inside a closed mesh by the divergence theorem, over the triangles that Blender draws."""
    mesh.calc_loop_triangles()
    triangles = np.empty(3 * len(mesh.loop_triangles), np.int32)
    mesh.loop_triangles.foreach_get("vertices", triangles)
    at = coordinates(mesh)
    a, b, c = (at - at.mean(axis=0))[triangles].reshape(-1, 3, 3).transpose(1, 0, 2)
    return float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6.0)


def drawn_areas(mesh):
    """Area of each polygon, and of the triangles that Blender draws it with, both (F,)."""
    mesh.calc_loop_triangles()
    area = np.empty(len(mesh.polygons), np.float32)
    mesh.polygons.foreach_get("area", area)
    triangle = np.empty(len(mesh.loop_triangles), np.float32)
    mesh.loop_triangles.foreach_get("area", triangle)
    polygon = np.empty(len(mesh.loop_triangles), np.int32)
    mesh.loop_triangles.foreach_get("polygon_index", polygon)
    return area, np.bincount(polygon, triangle, len(area))


def pixels(path):
    """A picture as (height, width, 3) sRGB values from 0 to 1, top row first."""
    image = bpy.data.images.load(str(path))
    try:
        width, height = image.size
        flat = np.empty(width * height * image.channels, np.float32)
        image.colorspace_settings.name = "Non-Color"
        image.pixels.foreach_get(flat)
    finally:
        bpy.data.images.remove(image)
    return flat.reshape(height, width, -1)[::-1, :, :3]
