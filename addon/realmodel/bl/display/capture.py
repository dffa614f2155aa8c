# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of a viewport in any size: with a window as the viewport is seen, without one by a render of the
same view in the same display mode."""

import bpy
import numpy as np
from mathutils import Matrix

from ...core import InputRefused, OutputFailed
from ...core.atomic import Outputs
from .. import batch, exaggeration, meshes, picture, scene, settings, versions, viewports
from . import bodies, colours, drawing, marks, modes, render_marks, viewpoints

LARGEST = 16384  # pixels along a side
_SAMPLES = 16
_DARK = (0.02, 0.02, 0.02, 1.0)


def write(context, path, size):
    """Writes a PNG. size: (width, height) in pixels. Raises OutputFailed where it cannot be written."""
    with Outputs() as outputs, outputs.path(path) as place:
        if bpy.app.background:
            _render(context, place, size)
        else:
            _draw(context, place, size)


def viewport(context):
    """(area, region, space) of the 3D viewport that is captured: the context's, or the largest one; None
    where there is none."""
    areas = list(viewports.areas())
    if context.area is not None and context.area.type == "VIEW_3D":
        areas = [context.area]
    if not areas:
        return None
    area = max(areas, key=lambda a: a.width * a.height)
    return area, next(region for region in area.regions if region.type == "WINDOW"), area.spaces.active


def _draw(context, path, size):
    """Draws the viewport into a picture that is not on the screen."""
    import gpu

    found = viewport(context)
    if found is None:
        raise OutputFailed(f"{path}: there is no 3D viewport to capture; open one")
    _, region, space = found
    view = space.region_3d
    view.update()  # its matrices may be of the last time it was drawn
    looking, frame = view.view_matrix.copy(), _window_matrix(region, view, size)
    try:
        target = gpu.types.GPUOffScreen(*size, format="RGBA8")
    except RuntimeError as error:
        raise OutputFailed(f"{path}: no picture of {size[0]} x {size[1]} pixels: {error}") from error
    try:
        target.draw_view3d(
            context.scene, context.view_layer, space, region, looking, frame, do_color_management=True
        )
        with target.bind():
            with gpu.matrix.push_pop(), gpu.matrix.push_pop_projection():
                gpu.matrix.load_matrix(looking)
                gpu.matrix.load_projection_matrix(frame)
                mode = context.scene.realmodel.display
                drawing.draw_items(modes.drawn(context.scene), mode, context.view_layer)
            pixels = gpu.state.active_framebuffer_get().read_color(0, 0, *size, 4, 0, "UBYTE")
            pixels.dimensions = size[0] * size[1] * 4
    finally:
        target.free()
    _save(np.array(pixels, np.uint8), path, size)


def _window_matrix(region, view, size):
    """The viewport's projection, with as much to the right and left, or above and below, as a picture of
    another shape asks for."""
    matrix = view.window_matrix.copy()
    wider = (size[0] / size[1]) / (region.width / region.height)
    if wider >= 1.0:
        return Matrix.Diagonal((1.0 / wider, 1.0, 1.0, 1.0)) @ matrix
    return Matrix.Diagonal((1.0, wider, 1.0, 1.0)) @ matrix


def _save(pixels, path, size):
    image = bpy.data.images.new("RealModel capture", *size, alpha=False)
    try:
        image.colorspace_settings.name = "sRGB"
        flat = pixels.astype(np.float32) / 255.0
        flat[3::4] = 1.0
        image.pixels.foreach_set(flat)
        image.filepath_raw, image.file_format = str(path), "PNG"
        image.save()
    except RuntimeError as error:
        raise OutputFailed(f"{path}: {' '.join(str(error).split())}") from error
    finally:
        bpy.data.images.remove(image)


def _render(context, path, size):
    """Renders what the first viewport of the screens looks at."""
    current = context.scene
    stage = picture.Stage()
    try:
        found = viewports.spaces(context)
        space = found[0] if found else None
        triangles = _put_bodies(stage, current, size, space)
        if not len(triangles):
            raise InputRefused("there is nothing to be seen", advice="build a model, or show its blocks")
        camera = _camera(stage, space, triangles, size)
        _light(stage, camera)
        picture.set_renderer(stage.scene, path, size, _SAMPLES, picture.TIME_LIMIT)
        with batch.without_chatter():
            bpy.ops.render.render(write_still=True, scene=stage.scene.name)
    except RuntimeError as error:
        raise OutputFailed(f"{path}: {' '.join(str(error).split())}") from error
    finally:
        stage.remove()


def _put_bodies(stage, current, size, space):
    """Puts all that is shown into the scene of the picture; returns its corners, (N, 3)."""
    items = [(item, item.data) for item in _shown(current)]
    corners = []
    pixel, mode = _pixel_size(current, size, space), current.realmodel.display
    for item, mesh in items:
        matrix = np.array(exaggeration.world_matrix(item), np.float64)
        coordinates = meshes.mesh_coordinates(mesh) @ matrix[:3, :3].T + matrix[:3, 3]
        corners.append(coordinates)
        colour = (*colours.shown_linear(item), 1.0)
        if mode not in modes.DRAWN:
            made = stage.keep(bpy.data.meshes, mesh.copy())
            made.transform(exaggeration.world_matrix(item))
            stage.add("body", made)
            if item.get(scene.TAG) != "section" and not colours.has_shades(item):  # several colours each
                made.materials.clear()
                made.materials.append(_plain(stage, colour))
        if mode == "POINTS":
            shape = marks.points(coordinates, render_marks.POINT_RADIUS * pixel)
        elif mode in ("LINES", "AREAS"):
            edges = versions.edge_vertices(mesh)
            shape = marks.lines(coordinates, edges, render_marks.LINE_RADIUS * pixel)
        else:
            continue
        made = stage.keep(bpy.data.meshes, meshes.new_mesh("marks", shape))
        made.materials.append(_glowing(stage, _DARK if mode == "AREAS" else colour))
        stage.add("marks", made)
    return np.concatenate(corners) if corners else np.empty((0, 3))


def _shown(current):
    """The objects of the model that are to be seen, and the sections that were made of it."""
    group = current.realmodel
    layer = current.view_layers[0]
    found = list(modes.drawn(current))
    if not found:
        items = [row.object for row in group.results]
        items += [surface.interface for _, surface in settings.surface_rows(current)]
        for kind in (bodies.CUT, bodies.CELLS):
            items += bodies.of_kind(current, kind).values()
        found = [item for item in items if item is not None and _in_sight(item, layer)]
    collection = group.view.collection
    if collection is not None:
        found += [o for o in collection.objects if o.get(scene.TAG) == "section" and _in_sight(o, layer)]
    return [item for item in found if item.type == "MESH" and len(item.data.vertices)]


def _in_sight(item, layer):
    return item.name in layer.objects and not item.hide_get(view_layer=layer) and not item.hide_viewport


def _plain(stage, colour):
    made = stage.keep(bpy.data.materials, bpy.data.materials.new("RealModel capture"))
    made.use_nodes = True
    made.diffuse_color = colour
    shader = next(node for node in made.node_tree.nodes if node.type == "BSDF_PRINCIPLED")
    shader.inputs["Base Color"].default_value = colour
    shader.inputs["Roughness"].default_value = 1.0
    return made


def _glowing(stage, colour):
    """A material that no light or shadow changes: marks that lie on each other would shade each other."""
    made = stage.keep(bpy.data.materials, bpy.data.materials.new("RealModel capture"))
    made.use_nodes = True
    made.diffuse_color = colour
    nodes = made.node_tree.nodes
    shader = nodes.new("ShaderNodeEmission")
    shader.inputs["Color"].default_value = colour
    output = next(node for node in nodes if node.type == "OUTPUT_MATERIAL")
    made.node_tree.links.new(shader.outputs[0], output.inputs["Surface"])
    return made


def _pixel_size(current, size, space):
    """About how large a pixel of the picture is at the model, in the units of the scene."""
    if space is not None:
        return viewpoints.width_at_distance(space) * space.region_3d.view_distance / max(size)
    points = viewpoints.model_points(current)
    return float(np.linalg.norm(np.ptp(points, axis=0))) / max(size)


def _camera(stage, space, points, size):
    """A camera that looks as a viewport does, or at all of the model where there is no viewport."""
    camera = stage.keep(bpy.data.cameras, bpy.data.cameras.new("RealModel capture"))
    camera.sensor_fit = "HORIZONTAL" if size[0] >= size[1] else "VERTICAL"
    item = stage.add("camera", camera)
    stage.scene.camera = item
    reach = float(np.linalg.norm(np.ptp(points, axis=0))) or 1.0
    if space is None:
        camera.angle = picture.FIELD_OF_VIEW
        item.matrix_world, distance = picture.camera_matrix(points, size)
        camera.clip_start, camera.clip_end = distance / 100.0, distance * 100.0
        return item
    view = space.region_3d
    away = view.view_distance if view.view_perspective != "ORTHO" else view.view_distance + 2.0 * reach
    turned = view.view_rotation.to_matrix().to_4x4()
    item.matrix_world = Matrix.Translation(view.view_location) @ turned @ Matrix.Translation((0.0, 0.0, away))
    if view.view_perspective != "ORTHO":
        camera.lens, camera.sensor_width, camera.sensor_height = space.lens / 2.0, 36.0, 36.0
    else:
        camera.type = "ORTHO"
        camera.ortho_scale = view.view_distance * viewpoints.width_at_distance(space)
    camera.clip_start, camera.clip_end = away / 1e4, away + 10.0 * reach
    return item


def _light(stage, camera):
    """A lamp at the camera and an even sky: what faces the eye has its own colour."""
    sun = stage.keep(bpy.data.lights, bpy.data.lights.new("RealModel capture", "SUN"))
    sun.energy = 2.0
    stage.add("sun", sun).matrix_world = camera.matrix_world @ Matrix.Rotation(0.5, 4, "Y")
    world = stage.keep(bpy.data.worlds, bpy.data.worlds.new("RealModel capture"))
    world.use_nodes = True
    sky = next(node for node in world.node_tree.nodes if node.type == "BACKGROUND")
    sky.inputs["Color"].default_value = (1.0, 1.0, 1.0, 1.0)
    sky.inputs["Strength"].default_value = 0.4
    stage.scene.world = world
