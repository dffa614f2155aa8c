# SPDX-License-Identifier: GPL-3.0-or-later
"""Points and lines of the model in its colors, drawn over the viewport from arrays on the graphics card.

Blender draws the vertices and wires of objects in the theme's one color; here each block has its own. The
arrays go to the card when they are first drawn, and again when a mesh has changed.
"""

import bpy

from ..host import caches, versions
from ..host.draw_handler import DrawHandler
from ..objects import exaggeration, meshes
from . import colors, modes

POINT_SIZE = 4.0  # pixels
_batches = caches.new()  # (mesh name, "POINTS" or "LINES") -> (vertices, edges of the mesh, gpu batch)


def forget(names=None):
    """Clears the cached arrays of meshes, by their names, or of all."""
    for key in [key for key in _batches if names is None or key[0] in names]:
        del _batches[key]


def draw():
    """The handler of drawing."""
    scene = bpy.context.scene
    if not hasattr(scene, "realmodel") or scene.realmodel.display not in modes.DRAWN:
        return
    draw_items(modes.drawn(scene), scene.realmodel.display, bpy.context.view_layer)


def draw_items(items, mode, layer):
    """Draws objects' points or lines with the matrices that are set.

    items: mesh objects. mode: "POINTS" or "LINES". layer: objects that it does not have are left out.
    """
    import gpu  # not there in Blender's background mode before 4.0

    shader = versions.plain_shader(mode == "POINTS")
    gpu.state.depth_test_set("LESS_EQUAL")
    gpu.state.depth_mask_set(True)
    if mode == "POINTS":
        gpu.state.point_size_set(POINT_SIZE * bpy.context.preferences.system.pixel_size)
    shader.bind()
    for obj in items:
        if obj.name not in layer.objects:
            continue
        batch = _batch(obj.data, mode)
        if batch is None:
            continue
        with gpu.matrix.push_pop():
            gpu.matrix.multiply_matrix(exaggeration.world_matrix(obj))
            shader.uniform_float("color", (*colors.shown_color(obj), 1.0))
            batch.draw(shader)
    gpu.state.depth_test_set("NONE")
    gpu.state.depth_mask_set(False)
    gpu.state.point_size_set(1.0)


def _batch(mesh, mode):
    key, size = (mesh.name_full, mode), (len(mesh.vertices), len(mesh.edges))
    if key in _batches and _batches[key][0] == size:
        return _batches[key][1]
    if not size[0] or (mode == "LINES" and not size[1]):
        return None
    batch = _new_batch(mesh, mode)
    _batches[key] = (size, batch)
    return batch


def _new_batch(mesh, mode):
    import gpu

    form = gpu.types.GPUVertFormat()
    form.attr_add(id="pos", comp_type="F32", len=3, fetch_mode="FLOAT")
    vertices = gpu.types.GPUVertBuf(form, len(mesh.vertices))
    vertices.attr_fill("pos", meshes.mesh_coordinates(mesh))
    if mode == "POINTS":
        return gpu.types.GPUBatch(type="POINTS", buf=vertices)
    indices = gpu.types.GPUIndexBuf(type="LINES", seq=versions.edge_vertices(mesh))
    return gpu.types.GPUBatch(type="LINES", buf=vertices, elem=indices)


handler = DrawHandler(draw, "POST_VIEW")
