# SPDX-License-Identifier: GPL-3.0-or-later
"""Camera, sun and sky for pictures of a model, and the render of build_model.py.

The camera looks from the south-east, the sun is further east. For build_model.py the picture is set up in a
scene of its own that is removed afterward: the model is cut by one vertical plane, where it meets the most
blocks.
"""

import contextlib
import math

import bpy
import numpy as np
from mathutils import Matrix, Vector

from ...core.display import polygon_mesh
from ..display import shown_models
from ..host import versions
from ..objects import block_shapes, exaggeration, materials, meshes
from ..objects.viewports import towards, view_rotation
from ..overlay import drawing_for, legend_shares, rendered
from ..project import project_settings, settings

KEY = "realmodel_picture"  # on objects and data added here: their purpose
TURNTABLE = "turntable"  # the empty that is the parent of an animation's camera
UNASKED = "realmodel_unasked"  # on a camera that nobody has asked for: see first_picture

# Azimuths are clockwise from north (+y).
FIELD_OF_VIEW = math.radians(26.0)  # across the longer side of the picture
MARGIN = 1.06
OPEN_AZIMUTH = math.radians(125.0)
_OPENED = np.linspace(0.16, 0.7, 19)  # of the model, in front of the cut
_SEEN = 1e-3  # of a cut's area: a block with less is hardly visible in it

# Sun and sky add up to about 1 on a face turned to the sun, so library colors read true there.
SUN_AZIMUTH = math.radians(112.0)
SUN_ELEVATION = math.radians(40.0)
SUN_ANGLE = math.radians(4.0)  # softens the shadows' edges
SUN_STRENGTH = 2.35
LOW_SUN = np.array([1.0, 0.70, 0.44])  # its color where it touches the horizon; white from its usual height
SKY_COLOR = (0.92, 0.96, 1.0)
SKY_STRENGTH = 0.42
GROUND_COLOR = "#e8e8e8"

SAMPLES = 64
TIME_LIMIT = 30.0  # seconds of sampling; a slow machine gets a grainier picture, not a late one
# A model flatter than this (height over width) is shown with its heights exaggerated.
FLATTEST = 0.12


def set_up(
    scene, points, size, space=None, legend=(0.0, 0.0), sun=(SUN_AZIMUTH, SUN_ELEVATION), with_sky=True
):
    """Adds a camera, light, sky and ground to a scene, or updates those that it added before. Cameras and
    lights of the user stay.

    points: (N, 3) that the picture is to show. size: (width, height) of the picture. space: a 3D viewport
    whose view the camera takes; without one it sees all points. legend: the shares of the picture's width and
    height that a legend takes in the lower left corner, where the camera shows no point. sun: its azimuth and
    elevation, radians; None: a lamp beside the camera, a uniform sky and no ground, so that faces toward the
    camera have their own color. with_sky: whether the world is replaced.
    """
    _remove_turntable(scene)
    camera = _own(scene, "camera", lambda: bpy.data.cameras.new("RealModel Camera"))
    camera.parent = None
    camera.pop(UNASKED, None)
    reach = float(np.linalg.norm(np.ptp(points, axis=0))) or 1.0
    camera.data.sensor_fit = "HORIZONTAL" if size[0] >= size[1] else "VERTICAL"
    if space is None:
        left = left_of_points(points, size, legend)
        camera.data.type, camera.data.angle = "PERSP", FIELD_OF_VIEW
        camera.data.shift_x = -left / 2 * size[0] / max(size)
        camera.matrix_world, away = camera_matrix(points, size, left)
    else:
        away = _look_as(camera, space, reach)
    camera.data.clip_start, camera.data.clip_end = away / 1e3, 10.0 * (away + reach)
    scene.camera = camera
    lamp = _own(scene, "sun", lambda: bpy.data.lights.new("RealModel Sun", "SUN"))
    lamp.data.energy, lamp.data.angle = (2.0, 0.0) if sun is None else (SUN_STRENGTH, SUN_ANGLE)
    if sun is None:
        lamp.data.color = (1.0, 1.0, 1.0)
        lamp.matrix_world = camera.matrix_world @ Matrix.Rotation(0.5, 4, "Y")
    else:
        lamp.data.color = LOW_SUN + (1.0 - LOW_SUN) * min(1.0, max(0.0, sun[1]) / SUN_ELEVATION)
        lamp.rotation_euler = towards(*sun).to_track_quat("Z", "Y").to_euler()
        _put_ground(scene, points, 10.0 * (away + reach))
    if with_sky:
        _set_sky(scene, *((1.0, 1.0, 1.0), 0.4) if sun is None else (SKY_COLOR, SKY_STRENGTH))
    return camera


def turntable_of(scene):
    """The empty that is the parent of the camera of a scene's turntable, or None."""
    return next((obj for obj in scene.objects if obj.get(KEY) == TURNTABLE), None)


def _remove_turntable(scene):
    pivot = turntable_of(scene)
    if pivot is None:
        return
    action = pivot.animation_data.action if pivot.animation_data else None
    bpy.data.objects.remove(pivot)
    if action is not None and not action.users:
        bpy.data.actions.remove(action)


def _own(scene, kind, data):
    """The object of a kind that belongs to the picture of a scene; made if it does not exist."""
    obj = next((obj for obj in scene.objects if obj.get(KEY) == kind), None)
    if obj is None:
        made = data()
        obj = bpy.data.objects.new(made.name, made)
        obj[KEY] = kind
        scene.collection.objects.link(obj)
    return obj


def _look_as(camera, space, reach):
    """Aligns a camera with the view of a viewport; returns its distance from the viewport's pivot."""
    view, data = space.region_3d, camera.data
    data.shift_x = 0.0
    is_flat = view.view_perspective == "ORTHO"
    away = view.view_distance + (2.0 * reach if is_flat else 0.0)
    turned = view.view_rotation.to_matrix().to_4x4()
    camera.matrix_world = (
        Matrix.Translation(view.view_location) @ turned @ Matrix.Translation((0.0, 0.0, away))
    )
    data.type = "ORTHO" if is_flat else "PERSP"
    data.lens, data.sensor_width, data.sensor_height = space.lens / 2.0, 36.0, 36.0
    data.ortho_scale = view.view_distance * 72.0 / space.lens  # Blender's viewports show 72 mm
    return away


def _set_sky(scene, color, strength):
    world = scene.world
    if world is None or KEY not in world:
        if world is not None:
            world.use_fake_user = True  # the user's own stays in the file
        world = bpy.data.worlds.new("RealModel Sky")
        world[KEY] = "sky"
        world.use_nodes = True
        # Only bounced rays sample the sky: then each sample includes the sun, and open ground has no noise.
        versions.leave_sky_to_bounces(world)
        scene.world = world
    sky = next(node for node in world.node_tree.nodes if node.type == "BACKGROUND")
    sky.inputs["Color"].default_value = (*color, 1.0)
    sky.inputs["Strength"].default_value = strength


def _put_ground(scene, points, reach):
    """A light plane that takes the shadow, in renders only; its rim is beyond the frame."""
    extent = np.ptp(points, axis=0).max()
    x, y = points[:, :2].mean(axis=0)
    z = points[:, 2].min() - 0.002 * extent
    corners = np.array([[x + a * reach, y + b * reach, z] for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))])
    ground = _own(scene, "ground", lambda: _ground_mesh(corners))
    ground.data.vertices.foreach_set("co", corners.astype(np.float32).ravel())
    ground.data.update()
    ground.hide_viewport = ground.hide_select = True


def _ground_mesh(corners):
    mesh = meshes.triangle_mesh("RealModel Ground", corners, np.array([[0, 1, 2], [0, 2, 3]]))
    material = bpy.data.materials.new("RealModel Ground")
    material.use_nodes = True
    materials.set_color(material, GROUND_COLOR)
    versions.make_matt(next(node for node in material.node_tree.nodes if node.type == "BSDF_PRINCIPLED"))
    mesh.materials.append(material)
    return mesh


@contextlib.contextmanager
def discard_scene(scene):
    """A scene for one picture: it and all datablocks that are made meanwhile are removed at the end."""
    stores = (bpy.data.objects, bpy.data.meshes, bpy.data.cameras, bpy.data.lights, bpy.data.worlds)
    stores += (bpy.data.materials, bpy.data.images, bpy.data.collections)
    before = [set(store) for store in stores]
    try:
        yield scene
    finally:
        bpy.data.scenes.remove(scene)
        for store, earlier in zip(stores, before, strict=True):
            for datablock in [datablock for datablock in store if datablock not in earlier]:
                if isinstance(datablock, bpy.types.Image):
                    datablock.user_clear()  # Blender counts itself as a user of a render's result
                store.remove(datablock)


def render_picture(scene, path, size, samples=SAMPLES, time_limit=TIME_LIMIT):
    """Renders a scene's model, cut open, to a PNG file; the scene stays as it is.

    path: the file, whatever its ending. size: (width, height) in pixels. samples: rays per pixel.
    time_limit: seconds after which no more of them are begun, 0 for no limit. Returns by how much the heights
    were exaggerated. Raises RuntimeError where there is nothing to see or Blender cannot render or write,
    RealModelError.
    """
    rows = {(row.rock, row.name): row.object for row in scene.realmodel.results if row.object is not None}
    if not rows:
        raise RuntimeError("there is no block to render: the model is empty")
    origin = project_settings.model_origin(scene)
    half = _opened(shown_models.at_stage(scene, settings.last_stage(scene)))
    shapes = block_shapes.by_name(half, polygon_mesh.of_blocks(half, origin))
    coordinates = np.concatenate([shape.coordinates for shape in shapes.values()])
    factor = exaggeration_of(np.ptp(coordinates, axis=0))
    if scene.realmodel.view.exaggeration != 1.0:
        factor = exaggeration.factor(scene)
    with discard_scene(bpy.data.scenes.new("RealModel picture")) as stage:
        for key, shape in shapes.items():
            made = bpy.data.objects.new(key[1], meshes.new_mesh(key[1], shape))
            made.data.materials.append(rows[key].data.materials[0])
            made.scale.z = factor
            stage.collection.objects.link(made)
        set_up(stage, coordinates * (1.0, 1.0, factor), size, legend=legend_shares(scene, size))
        set_renderer(stage, path, size, samples, time_limit)
        stretched = np.diag([1.0, 1.0, factor, 1.0])
        rendered.put(stage, lambda _, view: drawing_for(scene, view, stretched=stretched))
        bpy.ops.render.render(write_still=True, scene=stage.name)
    return factor


def exaggeration_of(extent):
    """1, 2, 5, 10, 20, 50, ...: by how much the heights of a model of an extent (3,) are exaggerated."""
    width, height = extent[:2].max(), extent[2]
    if not 0.0 < height < FLATTEST * width:
        return 1.0
    wanted = FLATTEST * width / height
    decade = 10.0 ** math.floor(math.log10(wanted))
    return next(decade * step for step in (1.0, 2.0, 5.0, 10.0) if decade * step >= wanted)


def _opened(model):
    """The model without the part in front of a vertical plane: of some planes the one that removes the fewest
    blocks, meets the most, and shows the smallest of these in the largest area."""
    ahead = np.array(towards(OPEN_AZIMUTH, 0.0))
    reach = model.vertices @ ahead
    nearest = np.full(len(model.blocks) + 1, np.inf)
    of_faces = np.minimum.reduceat(reach[model.face_vertices], model.face_offsets[:-1])
    for side in range(2):
        np.minimum.at(nearest, model.face_blocks[:, side], of_faces)
    planes = []
    for share in _OPENED:
        offset = reach.max() - share * np.ptp(reach)
        areas = model.section(offset * ahead, ahead).area_by_block()
        met = areas[areas > _SEEN * areas.sum()]
        planes.append((np.count_nonzero(nearest[:-1] < offset), len(met), met.min(initial=np.inf), offset))
    return model.cut_by_plane(max(planes)[-1] * ahead, ahead).below


def camera_matrix(points, size, left=0.0, rotation=None):
    """World matrix of a camera that has all points centered in its frame, and its distance.

    points: (N, 3) float64. size: (width, height) in pixels. left: the part of
    the width that is kept free. rotation: (3, 3) of the camera, as `view_rotation`
    where it is not given. The place follows from the four planes
    of the frame: in camera axes, z towards the camera, a point is inside where
    |x - cx| <= tx (d - z) and |y - cy| <= ty (d - z).
    """
    rotation = rotation or view_rotation()
    axes = np.array(rotation).T
    local = points @ axes.T
    tangents = (
        np.array([size[0] * (1.0 - left), size[1]]) / max(size) * math.tan(FIELD_OF_VIEW / 2.0) / MARGIN
    )
    distance, center = 0.0, []
    for axis, tangent in enumerate(tangents):
        high = (local[:, axis] + tangent * local[:, 2]).max()
        low = (tangent * local[:, 2] - local[:, axis]).max()
        distance = max(distance, (high + low) / (2.0 * tangent))
        center.append((high - low) / 2.0)
    position = Vector(axes.T @ np.array([*center, distance]))
    return Matrix.Translation(position) @ rotation.to_4x4(), distance


def left_of_points(points, size, legend, rotation=None):
    """The share of a picture's width that a legend needs left of all points: 0 where a line parts it from the
    points that fill the whole picture. legend: the shares of width and height that it takes in the lower left
    corner."""
    matrix, _ = camera_matrix(points, size, 0.0, rotation)
    local = points @ np.array(matrix.to_3x3()) - np.array(matrix.to_3x3().transposed() @ matrix.translation)
    tangents = np.array(size) / max(size) * math.tan(FIELD_OF_VIEW / 2.0)
    shares = 0.5 + 0.5 * local[:, :2] / (-local[:, 2:] * tangents)
    angles = np.linspace(0.0, 0.5 * math.pi, 91)
    away = (shares - legend) @ np.array([np.cos(angles), np.sin(angles)])
    return 0.0 if (away > 0.0).all(axis=0).any() else legend[0]


def set_renderer(scene, path, size, samples, time_limit):
    """Sets up a scene to render a PNG of a size in pixels."""
    render = scene.render
    render.resolution_x, render.resolution_y = size
    render.resolution_percentage = 100
    render.filepath = str(path)
    render.use_file_extension = False
    versions.write_images(render.image_settings)
    render.image_settings.file_format = "PNG"
    render.image_settings.color_mode = "RGB"
    choose_renderer(scene, samples, time_limit)


def choose_renderer(scene, samples, time_limit):
    """Chooses the render engine that this Blender has, with colors unchanged by a view transform."""
    render = scene.render
    versions.plain_colors(scene)
    if not versions.cycles_available(scene):
        # Workbench knows the materials' viewport colors; light and shadow are plainer.
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
