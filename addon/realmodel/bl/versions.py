# SPDX-License-Identifier: GPL-3.0-or-later
"""Every difference between the Blender versions RealModel runs in (3.4 to 5.2), in one place.

The rest of the add-on asks this module and never looks at `bpy.app.version` itself.
"""

import bpy
import numpy as np

OLDEST = (3, 4, 0)


READS_CORNERS_SLOWLY = bpy.app.version < (3, 6, 0)  # one by one, not in one piece


def fill_mesh(mesh, coordinates, offsets, corners):
    """Give an empty mesh its vertices and polygons.

    mesh: bpy.types.Mesh. coordinates: (V, 3) float32. offsets: (F+1,) int32, where each polygon's
    corners begin in `corners`. corners: (sum,) int32, vertex indices, counter-clockwise seen from
    outside.

    Polygons are flat shaded: strata break along their edges, and smooth shading, which is the
    default from 4.1 on, would round them off.
    """
    count = len(offsets) - 1
    if not len(coordinates):
        return  # nor would newer versions have the attributes then
    mesh.vertices.add(len(coordinates))
    mesh.loops.add(len(corners))
    mesh.polygons.add(count)
    if bpy.app.version < (3, 6, 0):
        mesh.vertices.foreach_set("co", coordinates.ravel())
        mesh.loops.foreach_set("vertex_index", corners)
        mesh.polygons.foreach_set("loop_total", np.diff(offsets))  # read-only later: it follows
    else:  # as attributes the arrays are copied in one piece, three times as fast
        mesh.attributes["position"].data.foreach_set("vector", coordinates.ravel())
        mesh.attributes[".corner_vert"].data.foreach_set("value", corners)
    mesh.polygons.foreach_set("loop_start", np.ascontiguousarray(offsets[:-1]))
    if bpy.app.version >= (4, 1, 0):
        mesh.attributes.new("sharp_face", "BOOLEAN", "FACE").data.foreach_set("value", np.ones(count, bool))
    mesh.update(calc_edges=True)


def corner_vertices(mesh):
    """(C,) int32: the vertex of each corner of a mesh's polygons, one polygon after the other."""
    found = np.empty(len(mesh.loops), np.int32)
    if READS_CORNERS_SLOWLY:
        mesh.loops.foreach_get("vertex_index", found)
    elif len(found):
        mesh.attributes[".corner_vert"].data.foreach_get("value", found)
    return found


def layer_collections(view_layer):
    """The topmost bpy.types.LayerCollection of a view layer.

    In 5.2 a scene that was never on screen has none before its first update.
    """
    if view_layer.layer_collection is None:
        view_layer.update()
    return view_layer.layer_collection


def shade_smooth(mesh):
    """Shade all polygons of a mesh smooth, as a surface without breaks."""
    if bpy.app.version < (4, 1, 0):
        mesh.polygons.foreach_set("use_smooth", np.ones(len(mesh.polygons), bool))
    elif "sharp_face" in mesh.attributes:
        mesh.attributes.remove(mesh.attributes["sharp_face"])
    mesh.update()


def make_matt(principled):
    """Take the shine off a Principled shader; its socket was renamed in 4.0."""
    principled.inputs["Roughness"].default_value = 1.0
    principled.inputs["Specular" if bpy.app.version < (4, 0, 0) else "Specular IOR Level"].default_value = 0.0


def leave_sky_to_bounces(world):
    """Have Cycles not sample the sky as a lamp of its own."""
    if hasattr(world, "cycles"):
        world.cycles.sampling_method = "NONE"


def cycles_available(scene):
    """Whether the Cycles renderer can be chosen; some builds of Blender come without it."""
    engine = scene.render.engine
    try:
        scene.render.engine = "CYCLES"
    except TypeError:
        return False
    scene.render.engine = engine
    return True


def denoise(scene):
    """Have Cycles remove the noise of its picture where this build can (Debian's 3.4 cannot)."""
    try:
        scene.cycles.denoiser = "OPENIMAGEDENOISE"
    except TypeError:  # the build has no denoiser
        scene.cycles.use_denoising = False
        return False
    scene.cycles.use_denoising = True
    return True


def plain_colours(scene):
    """Show colours as they are: the film-like transforms would shift the library's colours."""
    scene.display_settings.display_device = "sRGB"
    scene.view_settings.view_transform = "Standard"
    scene.view_settings.look = "None"
    scene.view_settings.exposure = 0.0
    scene.view_settings.gamma = 1.0


def plain_shader(points):
    """The built-in shader of one colour, for points or for lines; its names changed in 4.0 and 4.5."""
    import gpu

    names = ["UNIFORM_COLOR"] if bpy.app.version >= (4, 0, 0) else ["3D_UNIFORM_COLOR"]
    if points and bpy.app.version >= (4, 5, 0):
        names.insert(0, "POINT_UNIFORM_COLOR")
    for name in names[:-1]:
        try:
            return gpu.shader.from_builtin(name)
        except ValueError:
            continue  # this version does not have it yet
    return gpu.shader.from_builtin(names[-1])
