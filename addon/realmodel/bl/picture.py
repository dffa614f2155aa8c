# SPDX-License-Identifier: GPL-3.0-or-later
"""A picture of a model, rendered without a window or a graphics card.

It is set up in a scene of its own that shares the blocks' materials and is removed afterwards, so
that nothing of it reaches the model's scene or a saved file. The camera looks from the south-east,
the sun stands further east, and the model is opened between the two. Of the ways to open it the
first is taken in which every block is seen; that is found out by casting rays from the camera.
"""

import math
from dataclasses import dataclass
from functools import partial

import bpy
import numpy as np
from mathutils import Matrix, Vector

from . import arrangement, meshes, versions

# Azimuths are clockwise from north (+y).
CAMERA_AZIMUTH = math.radians(152.0)
CAMERA_ELEVATION = math.radians(27.0)
FIELD_OF_VIEW = math.radians(26.0)  # across the longer side of the picture
MARGIN = 1.06
OPEN_AZIMUTH = math.radians(125.0)

# Sun and sky add up to about 1 on a face turned to the sun, so library colours read true there.
SUN_AZIMUTH = math.radians(112.0)
SUN_ELEVATION = math.radians(40.0)
SUN_ANGLE = math.radians(4.0)  # softens the shadows' edges
SUN_STRENGTH = 2.35
SKY_COLOUR = (0.92, 0.96, 1.0)
SKY_STRENGTH = 0.42
FLOOR_COLOUR = (0.8, 0.8, 0.8)

SAMPLES = 64
TIME_LIMIT = 30.0  # seconds of sampling; a slow machine gets a grainier picture, not a late one
RAYS = 240  # across the longer side, to find out which blocks are seen
MOST_SECTIONS = 3  # sections that are tried to bring hidden blocks to light
SEEN = 12  # rays that must meet a block: some 500 pixels of the picture in its usual size


@dataclass
class Picture:
    """What was rendered: how the model was opened, its heights exaggerated, blocks that stay hidden."""

    arrangement: str
    exaggeration: float
    hidden_blocks: list


class Stage:
    """A scene for one picture and the datablocks made for it."""

    def __init__(self):
        self.scene = bpy.data.scenes.new("RealModel picture")
        self._made = []
        self._images = list(bpy.data.images)

    def remove(self):
        bpy.data.scenes.remove(self.scene)
        for image in [i for i in bpy.data.images if i.type == "RENDER_RESULT" and i not in self._images]:
            image.user_clear()  # Blender counts itself as one
            bpy.data.images.remove(image)
        for store, datablock in reversed(self._made):
            store.remove(datablock)

    def keep(self, store, datablock):
        self._made.append((store, datablock))
        return datablock

    def add(self, name, data):
        """An object for a mesh, camera or light, standing in the scene."""
        item = self.keep(bpy.data.objects, bpy.data.objects.new(name, data))
        self.scene.collection.objects.link(item)
        return item

    def add_triangles(self, name, triangles, material):
        """A mesh object from a triangle soup, (T, 3, 3)."""
        coordinates = triangles.reshape(-1, 3)
        corners = np.arange(len(coordinates)).reshape(-1, 3)
        mesh = self.keep(bpy.data.meshes, meshes.triangle_mesh(name, coordinates, corners))
        mesh.materials.append(material)
        return self.add(name, mesh)


def render_picture(block_objects, path, size=(1600, 1000), samples=SAMPLES, time_limit=TIME_LIMIT):
    """Render blocks to a PNG file.

    block_objects: the model's block objects, oldest first. path: the file, whatever its ending.
    size: (width, height) in pixels. samples: rays per pixel. time_limit: seconds after which no
    more of them are begun, 0 for no limit. Returns a Picture.
    Raises RuntimeError where there is nothing to see or Blender cannot render or write.
    """
    if not block_objects:
        raise RuntimeError("there is no block to render: the model is empty")
    bodies, exaggeration = arrangement.centred(_bodies(block_objects))
    layout, hidden = _choose_layout(bodies, size)
    stage = Stage()
    try:
        camera = _set_up(stage, layout, size)
        _add_light(stage, layout, camera)
        set_renderer(stage.scene, path, size, samples, time_limit)
        bpy.ops.render.render(write_still=True, scene=stage.scene.name)
    finally:
        stage.remove()
    return Picture(layout.name, exaggeration, hidden)


def _bodies(block_objects):
    ranks = {}
    bodies = []
    for item in block_objects:
        rock = item.get("realmodel_rock")
        bodies.append(arrangement.Body.of(item, ranks.get(rock, 0)))
        ranks[rock] = ranks.get(rock, 0) + 1
    return bodies


def _choose_layout(bodies, size):
    """The first way to open the model in which all blocks are seen, or else the one that hides fewest.

    Returns the layout and the names of the blocks hidden in it.
    """

    def judged(layout):
        stage = Stage()
        try:
            return layout, _hidden(stage.scene, _set_up(stage, layout, size), layout.bodies, size)
        finally:
            stage.remove()

    towards = _towards(OPEN_AZIMUTH, 0.0)
    best = judged(arrangement.peeled(bodies, towards))
    others = [partial(arrangement.section_through, bodies, towards, name) for name in best[1][:MOST_SECTIONS]]
    others += [partial(arrangement.exploded, bodies, gap) for gap in arrangement.GAPS]
    for layout in others:
        if not best[1]:
            break
        best = min(best, judged(layout()), key=lambda found: len(found[1]))
    return best


def _set_up(stage, layout, size):
    """Put bodies and camera into the scene; returns the camera object."""
    for number, body in enumerate(layout.bodies):
        stage.add_triangles(f"block {number}", body.triangles, body.material)["block"] = number
    camera = stage.keep(bpy.data.cameras, bpy.data.cameras.new("RealModel picture"))
    matrix, distance = camera_matrix(layout.points(), size)
    camera.sensor_fit = "HORIZONTAL" if size[0] >= size[1] else "VERTICAL"
    camera.angle = FIELD_OF_VIEW
    camera.clip_start, camera.clip_end = distance / 100.0, distance * 100.0
    item = stage.add("camera", camera)
    item.matrix_world = matrix
    stage.scene.camera = item
    return item


def _towards(azimuth, elevation):
    """Unit vector towards an azimuth (clockwise from north) and elevation, radians."""
    flat = math.cos(elevation)
    return Vector((flat * math.sin(azimuth), flat * math.cos(azimuth), math.sin(elevation)))


def camera_matrix(points, size):
    """World matrix of a camera that has all points centred in its frame, and its distance.

    points: (N, 3) float64. size: (width, height) in pixels. The place follows from the four planes
    of the frame: in camera axes, z towards the camera, a point is inside where
    |x - cx| <= tx (d - z) and |y - cy| <= ty (d - z).
    """
    rotation = view_rotation()
    axes = np.array(rotation).T
    local = points @ axes.T
    tangents = np.array(size, float) / max(size) * math.tan(FIELD_OF_VIEW / 2.0) / MARGIN
    distance, centre = 0.0, []
    for axis, tangent in enumerate(tangents):
        high = (local[:, axis] + tangent * local[:, 2]).max()
        low = (tangent * local[:, 2] - local[:, axis]).max()
        distance = max(distance, (high + low) / (2.0 * tangent))
        centre.append((high - low) / 2.0)
    position = Vector(axes.T @ np.array([*centre, distance]))
    return Matrix.Translation(position) @ rotation.to_4x4(), distance


def view_rotation():
    """How the camera is turned, (3, 3): its columns point right, up, and back from where it looks."""
    back = _towards(CAMERA_AZIMUTH, CAMERA_ELEVATION)
    right = Vector((0.0, 0.0, 1.0)).cross(back).normalized()
    return Matrix((right, back.cross(right), back)).transposed()


def _hidden(scene, camera, bodies, size):
    """Names of the blocks that fewer than SEEN rays from the camera meet."""
    view_layer = scene.view_layers[0]
    view_layer.update()
    matrix = np.array(camera.matrix_world, np.float64)
    columns, rows = (max(2, round(RAYS * length / max(size))) for length in size)
    tangents = np.array(size, float) / max(size) * math.tan(FIELD_OF_VIEW / 2.0)
    x = (np.arange(columns) + 0.5) / columns * 2.0 - 1.0
    y = (np.arange(rows) + 0.5) / rows * 2.0 - 1.0
    grid = np.stack([*np.meshgrid(x * tangents[0], y * tangents[1]), -np.ones((rows, columns))], axis=-1)
    rays = grid.reshape(-1, 3) @ matrix[:3, :3].T
    origin = Vector(matrix[:3, 3])
    met = np.zeros(len(bodies), int)
    for ray in rays:
        hit, _, _, _, item, _ = scene.ray_cast(view_layer.depsgraph, origin, Vector(ray))
        if hit:
            met[item["block"]] += 1
    return [body.name for body, rays_met in zip(bodies, met, strict=True) if rays_met < SEEN]


def _add_light(stage, layout, camera):
    """A sun, an even sky, and a light floor that takes the shadow."""
    sun = stage.keep(bpy.data.lights, bpy.data.lights.new("RealModel picture", "SUN"))
    sun.energy, sun.angle = SUN_STRENGTH, SUN_ANGLE
    direction = _towards(SUN_AZIMUTH, SUN_ELEVATION)
    stage.add("sun", sun).rotation_euler = direction.to_track_quat("Z", "Y").to_euler()
    world = stage.keep(bpy.data.worlds, bpy.data.worlds.new("RealModel picture"))
    world.use_nodes = True
    sky = next(node for node in world.node_tree.nodes if node.type == "BACKGROUND")
    sky.inputs["Color"].default_value = (*SKY_COLOUR, 1.0)
    sky.inputs["Strength"].default_value = SKY_STRENGTH
    # Left to the rays that bounce off: then each sample asks the sun, and an open floor has no noise.
    versions.leave_sky_to_bounces(world)
    stage.scene.world = world
    points = layout.points()
    low, extent = points[:, 2].min(), np.ptp(points, axis=0).max()
    # Far enough that its rim is beyond the frame, which looks down on it.
    reach = 10.0 * camera.location.length
    z = low - 0.002 * extent
    corners = np.array([[-reach, -reach, z], [reach, -reach, z], [reach, reach, z], [-reach, reach, z]])
    floor = stage.keep(bpy.data.materials, bpy.data.materials.new("RealModel picture"))
    floor.use_nodes = True
    principled = next(node for node in floor.node_tree.nodes if node.type == "BSDF_PRINCIPLED")
    principled.inputs["Base Color"].default_value = (*FLOOR_COLOUR, 1.0)
    versions.make_matt(principled)
    stage.add_triangles("floor", corners[[[0, 1, 2], [0, 2, 3]]], floor)


def set_renderer(scene, path, size, samples, time_limit):
    """Has a scene render a PNG by what renderer this Blender has, in the colours as they are."""
    render = scene.render
    render.resolution_x, render.resolution_y = size
    render.resolution_percentage = 100
    render.filepath = str(path)
    render.use_file_extension = False
    render.image_settings.file_format = "PNG"
    render.image_settings.color_mode = "RGB"
    versions.plain_colours(scene)
    if not versions.cycles_available(scene):
        # Workbench knows the materials' viewport colours; light and shadow are plainer.
        render.engine = "BLENDER_WORKBENCH"
        shading = scene.display.shading
        shading.light, shading.color_type = "STUDIO", "MATERIAL"
        shading.show_shadows = shading.show_cavity = True
        return
    render.engine = "CYCLES"
    cycles = scene.cycles
    cycles.device = "CPU"
    cycles.samples = samples
    cycles.time_limit = time_limit
    cycles.use_adaptive_sampling = True  # the even floor needs few samples, the shadows many
    cycles.adaptive_threshold = 0.02
    cycles.adaptive_min_samples = min(samples, 8)
    cycles.max_bounces = 2
    cycles.seed = 0
    versions.denoise(scene)
