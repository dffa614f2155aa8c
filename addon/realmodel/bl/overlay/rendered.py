# SPDX-License-Identifier: GPL-3.0-or-later
"""The overlay in renders: while one is under way, an image on a plane close before the camera."""

import bpy
import numpy as np

from ...core.drawing.png import rasterize
from ..host import versions
from ..objects import exaggeration, meshes
from . import WIDTH, View, drawing_for

KEY = "realmodel_overlay"  # on the plane and the image
_CORNERS = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
_NEAR = 0.01  # of the way from the camera to the zero of the scene


def put(scene, draw=drawing_for, depsgraph=None):
    """Places the overlay of a scene in front of its camera, in place of the previous one. draw: as
    `drawing_for`. depsgraph: the evaluated one, where the camera may be animated."""
    camera, size = scene.camera, _pixels(scene)
    if camera is None or camera.type != "CAMERA" or camera.data.type == "PANO":
        return
    matrix = exaggeration.world_matrix(camera)
    if depsgraph is not None:
        matrix = camera.evaluated_get(depsgraph).matrix_world
    depsgraph = depsgraph or versions.depsgraph(scene)
    projection = np.array(
        camera.calc_matrix_camera(depsgraph, x=size[0], y=size[1], scale_x=1.0, scale_y=1.0), np.float64
    )
    scale = max(size) / WIDTH
    view = np.linalg.inv(np.array(matrix.normalized(), np.float64))
    seen = View(projection, view, camera.data.type == "PERSP", (size[0] / scale, size[1] / scale))
    drawing = draw(scene, seen)
    if drawing is None:
        remove(scene)
        return
    pixels = rasterize(drawing, scale, None)[::-1]
    plane = _plane(scene)
    image = plane.data.materials[0].node_tree.nodes[KEY].image
    if tuple(image.size) != (pixels.shape[1], pixels.shape[0]):
        image.scale(pixels.shape[1], pixels.shape[0])
    image.pixels.foreach_set(np.ascontiguousarray(pixels).ravel())
    image.update()
    plane.parent = camera
    depth = max(1.01 * camera.data.clip_start, _NEAR * float(np.linalg.norm(view[:3, 3])))
    plane.data.vertices.foreach_set("co", _at_depth(projection, depth).astype(np.float32).ravel())
    plane.data.update()


def _pixels(scene):
    render = scene.render
    share = render.resolution_percentage / 100.0
    return max(1, round(render.resolution_x * share)), max(1, round(render.resolution_y * share))


def _at_depth(projection, depth):
    """(4, 3): the corners of the picture so far before the camera, in its axes."""
    clip = projection @ (0.0, 0.0, -depth, 1.0)
    corners = np.column_stack([_CORNERS, np.full(4, clip[2] / clip[3]), np.ones(4)])
    homogeneous = corners @ np.linalg.inv(projection).T
    return homogeneous[:, :3] / homogeneous[:, 3:]


def _plane(scene):
    plane = next((obj for obj in scene.objects if KEY in obj), None)
    if plane is not None:
        return plane
    mesh = meshes.triangle_mesh("RealModel Overlay", np.zeros((4, 3)), np.array([[0, 1, 2], [0, 2, 3]]))
    layer = mesh.uv_layers.new(name=KEY)
    layer.data.foreach_set("uv", (_CORNERS[[0, 1, 2, 0, 2, 3]].ravel() + 1.0) / 2.0)
    image = bpy.data.images.new("RealModel Overlay", 4, 4, alpha=True)
    image[KEY] = True
    image.alpha_mode = "STRAIGHT"
    mesh.materials.append(_material(image))
    plane = bpy.data.objects.new(mesh.name, mesh)
    plane[KEY] = True
    plane.hide_viewport = True
    for rays in ("diffuse", "glossy", "transmission", "volume_scatter", "shadow"):
        setattr(plane, f"visible_{rays}", False)  # it lights nothing
    scene.collection.objects.link(plane)
    return plane


def _material(image):
    """The image as it is, whatever the light."""
    made = bpy.data.materials.new("RealModel Overlay")
    made.use_nodes = True
    versions.let_through(made)
    nodes, links = made.node_tree.nodes, made.node_tree.links
    output = next(node for node in nodes if node.type == "OUTPUT_MATERIAL")
    picture = nodes.new("ShaderNodeTexImage")
    picture.name, picture.image, picture.interpolation, picture.extension = KEY, image, "Linear", "EXTEND"
    clear, color, mix = (
        nodes.new(f"ShaderNode{kind}") for kind in ("BsdfTransparent", "Emission", "MixShader")
    )
    links.new(picture.outputs["Color"], color.inputs["Color"])
    links.new(picture.outputs["Alpha"], mix.inputs[0])
    links.new(clear.outputs[0], mix.inputs[1])
    links.new(color.outputs[0], mix.inputs[2])
    links.new(mix.outputs[0], output.inputs["Surface"])
    return made


def remove(scene):
    """Removes the overlay from the camera, with all data made for it."""
    for plane in [obj for obj in scene.objects if KEY in obj]:
        mesh, material = plane.data, plane.data.materials[0]
        image = material.node_tree.nodes[KEY].image
        bpy.data.objects.remove(plane)
        bpy.data.meshes.remove(mesh)
        bpy.data.materials.remove(material)
        bpy.data.images.remove(image)
