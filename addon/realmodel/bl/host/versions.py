# SPDX-License-Identifier: GPL-3.0-or-later
"""Every difference between the Blender versions RealModel runs in (3.4 to 5.2), in one place.

The rest of the add-on asks this module and never looks at `bpy.app.version` itself.
"""

import math

import blf
import bpy
import numpy as np

from . import mesh_memory


def fill_mesh(mesh, shape):
    """Give an empty mesh its vertices and polygons.

    mesh: bpy.types.Mesh. shape: core.display.polygon_mesh.PolygonMesh; edges that it does not have are
    found by Blender, which takes ten times as long as all the rest.

    Polygons are flat shaded unless the shape is smooth: strata break along their edges, and smooth shading,
    which is the default from 4.1 on, would round them off.
    """
    if not len(shape.coordinates):
        return  # nor would newer versions have the attributes then
    with_edges = shape.edges is not None
    mesh.vertices.add(len(shape.coordinates))
    mesh.loops.add(len(shape.corners))
    mesh.polygons.add(shape.polygons)
    if with_edges:
        mesh.edges.add(len(shape.edges))
    if bpy.app.version >= (3, 6, 0):
        _fill_attributes(mesh, shape)
    elif mesh_memory.is_known():
        _fill_memory(mesh, shape)
    else:
        _fill_slowly(mesh, shape)
    mesh.update(calc_edges=not with_edges)


def _fill_attributes(mesh, shape):
    attributes = mesh.attributes
    attributes["position"].data.foreach_set("vector", shape.coordinates.ravel())
    attributes[".corner_vert"].data.foreach_set("value", shape.corners)
    mesh.polygons.foreach_set("loop_start", shape.offsets[:-1])  # loop_total follows from it
    if shape.edges is not None:
        attributes[".edge_verts"].data.foreach_set("value", shape.edges.ravel())
        attributes[".corner_edge"].data.foreach_set("value", shape.corner_edges)
    if bpy.app.version >= (4, 1, 0):
        if not shape.smooth:
            sharp = attributes.new("sharp_face", "BOOLEAN", "FACE")
            sharp.data.foreach_set("value", np.ones(shape.polygons, bool))
    elif shape.smooth:
        mesh.polygons.foreach_set("use_smooth", np.ones(shape.polygons, bool))


def _fill_memory(mesh, shape):
    mesh.vertices.foreach_set("co", shape.coordinates.ravel())
    corners, polygons = mesh_memory.corners(mesh), mesh_memory.polygons(mesh)
    corners["vertex"] = shape.corners
    polygons["start"], polygons["count"] = shape.offsets[:-1], np.diff(shape.offsets)
    if shape.smooth:
        polygons["flag"] |= mesh_memory.SMOOTH
    if shape.edges is not None:
        edges = mesh_memory.edges(mesh)
        edges["vertices"], edges["flag"] = shape.edges, mesh_memory.DRAWN
        corners["edge"] = shape.corner_edges


def _fill_slowly(mesh, shape):
    mesh.vertices.foreach_set("co", shape.coordinates.ravel())
    mesh.loops.foreach_set("vertex_index", shape.corners)
    mesh.polygons.foreach_set("loop_start", shape.offsets[:-1])
    mesh.polygons.foreach_set("loop_total", np.diff(shape.offsets))
    mesh.polygons.foreach_set("use_smooth", np.full(shape.polygons, shape.smooth))
    if shape.edges is not None:
        mesh.edges.foreach_set("vertices", shape.edges.ravel())
        mesh.loops.foreach_set("edge_index", shape.corner_edges)


def corner_vertices(mesh):
    """(C,) int32: the vertex of each corner of a mesh's polygons, as the mesh keeps them."""
    if mesh_memory.is_known():
        return np.array(mesh_memory.corners(mesh)["vertex"])
    vertices = np.empty(len(mesh.loops), np.int32)
    if ".corner_vert" in mesh.attributes:  # neither before 3.6 nor in edit mode
        mesh.attributes[".corner_vert"].data.foreach_get("value", vertices)
    else:
        mesh.loops.foreach_get("vertex_index", vertices)
    return vertices


def edge_vertices(mesh):
    """(E, 2) int32 edges of a mesh."""
    if mesh_memory.is_known():
        return np.array(mesh_memory.edges(mesh)["vertices"])
    vertices = np.empty(2 * len(mesh.edges), np.int32)
    if ".edge_verts" in mesh.attributes:
        mesh.attributes[".edge_verts"].data.foreach_get("value", vertices)
    else:
        mesh.edges.foreach_get("vertices", vertices)
    return vertices.reshape(-1, 2)


def polygon_starts(mesh):
    """(F,) int32: where the corners of each polygon of a mesh begin."""
    if mesh_memory.is_known():
        return np.array(mesh_memory.polygons(mesh)["start"])
    starts = np.empty(len(mesh.polygons), np.int32)
    mesh.polygons.foreach_get("loop_start", starts)
    return starts


def marks():
    """{domain: {name: dtype}}: what vertices, edges and polygons of a mesh are marked with, where that is no
    attribute; creases and bevel weights became attributes in 4.0."""
    wanted = {
        "POINT": (bpy.types.MeshVertex, {"bevel_weight": np.float32}),
        "EDGE": (
            bpy.types.MeshEdge,
            {
                "use_seam": bool,
                "use_edge_sharp": bool,
                "use_freestyle_mark": bool,
                "crease": np.float32,
                "bevel_weight": np.float32,
            },
        ),
        "FACE": (bpy.types.MeshPolygon, {"use_smooth": bool, "use_freestyle_mark": bool}),
    }
    return {
        domain: {name: dtype for name, dtype in names.items() if name in kind.bl_rna.properties}
        for domain, (kind, names) in wanted.items()
    }


def break_at_flat(mesh):
    """Shades smooth polygons as if those beside them that are flat were not there, which is the rule from 4.1
    on."""
    if bpy.app.version < (4, 1, 0):
        mesh.use_auto_smooth, mesh.auto_smooth_angle = True, math.pi


def make_glossy(principled):
    """Set a Principled shader to the gloss of most rock, water and glass."""
    principled.inputs["Specular" if bpy.app.version < (4, 0, 0) else "Specular IOR Level"].default_value = 0.5


def make_matt(principled):
    """Remove the specular reflection of a Principled shader; its socket was renamed in 4.0."""
    principled.inputs["Roughness"].default_value = 1.0
    principled.inputs["Specular" if bpy.app.version < (4, 0, 0) else "Specular IOR Level"].default_value = 0.0


def add_group_socket(group, name, kind, values=(), is_output=False):
    """Adds a socket to a node group. kind: the name of its class; kinds of numbers are subtypes from 4.0
    on. values: its default, and the lowest and highest one, as far as there are any."""
    if bpy.app.version < (4, 0, 0):
        socket = (group.outputs if is_output else group.inputs).new(kind, name)
    else:
        plain = next((p for p in ("NodeSocketFloat", "NodeSocketInt") if kind.startswith(p)), kind)
        way = "OUTPUT" if is_output else "INPUT"
        socket = group.interface.new_socket(name, in_out=way, socket_type=plain)
        if plain != kind:
            socket.subtype = kind[len(plain) :].upper()
    for key, value in zip(("default_value", "min_value", "max_value"), values, strict=False):
        setattr(socket, key, value)


def set_group_input(modifier, name, value):
    """Sets an input of a modifier of geometry nodes."""
    key = _group_key(modifier, name)
    if hasattr(modifier, "properties"):  # from 5.2 on
        getattr(modifier.properties.inputs, key).value = value
    else:
        modifier[key] = value
        if isinstance(value, bpy.types.ID):
            modifier.node_group = modifier.node_group  # or Blender would not evaluate what is new to it
    modifier.id_data.update_tag()


def group_input(modifier, name):
    """The value of an input of a geometry nodes modifier."""
    key = _group_key(modifier, name)
    return (
        getattr(modifier.properties.inputs, key).value if hasattr(modifier, "properties") else modifier[key]
    )


def _group_key(modifier, name):
    group = modifier.node_group
    if bpy.app.version < (4, 0, 0):
        sockets = group.inputs
    else:
        sockets = [s for s in group.interface.items_tree if s.item_type == "SOCKET" and s.in_out == "INPUT"]
    return next(socket.identifier for socket in sockets if socket.name == name)


def add_asset_library(name, folder):
    """Adds a folder to the asset libraries of the preferences."""
    libraries = bpy.context.preferences.filepaths.asset_libraries
    if hasattr(libraries, "new"):
        libraries.new(name=name, directory=folder)
    else:
        bpy.ops.preferences.asset_library_add(directory=folder)
        libraries[-1].name = name


def leave_sky_to_bounces(world):
    """Turn off Cycles' sampling of the sky as a lamp."""
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
    """Turn on Cycles' denoiser where this build has one (Debian's 3.4 has none)."""
    try:
        scene.cycles.denoiser = "OPENIMAGEDENOISE"
    except TypeError:  # the build has no denoiser
        scene.cycles.use_denoising = False
        return False
    scene.cycles.use_denoising = True
    return True


def plain_colors(scene):
    """Show colors as they are: the film-like transforms would shift the library's colors."""
    scene.display_settings.display_device = "sRGB"
    scene.view_settings.view_transform = "Standard"
    scene.view_settings.look = "None"
    scene.view_settings.exposure = 0.0
    scene.view_settings.gamma = 1.0


def write_images(settings):
    """Image settings of a scene that write images: since 5.0 a scene that writes a video has no format of
    images to choose."""
    if hasattr(settings, "media_type"):
        settings.media_type = "IMAGE"


GREASE_PENCIL = ("GPENCIL", "GREASEPENCIL")  # types of objects; since Blender 4.3 it is the second


def strokes(item):
    """The strokes of a grease pencil object that are seen at the present frame, each (N, 3) float64 in the
    coordinates of the object."""
    lines = []
    for layer in item.data.layers:
        if layer.hide:
            continue
        if item.type == "GPENCIL":
            frame, matrix, key = layer.active_frame, layer.matrix_layer, "co"
            frame_strokes = [] if frame is None else frame.strokes
        else:
            frame, matrix, key = layer.current_frame(), layer.matrix_local, "position"
            frame_strokes = [] if frame is None else frame.drawing.strokes
        turn = np.array(matrix, np.float64)
        for stroke in frame_strokes:
            places = np.array([tuple(getattr(point, key)) for point in stroke.points], np.float64)
            if len(places):
                lines.append(places @ turn[:3, :3].T + turn[:3, 3])
    return lines


def curves(datablock):
    """The F-curves of a datablock's keyframes, or None where it has none; actions have slots since 4.4."""
    animated = datablock.animation_data
    if animated is None or animated.action is None:
        return None
    if bpy.app.version < (4, 4, 0):
        return animated.action.fcurves
    strips = [strip for layer in animated.action.layers for strip in layer.strips]
    bags = [strip.channelbag(animated.action_slot) for strip in strips] if animated.action_slot else []
    return next((bag.fcurves for bag in bags if bag is not None), None)


def text_size(font, size):
    """Sets the size of blf's text in pixels; the resolution went in 4.0."""
    if bpy.app.version >= (4, 0, 0):
        blf.size(font, size)
    else:
        blf.size(font, size, 72)


def depsgraph(scene):
    """The dependency graph of a scene's first view layer; one that was never shown has none before an
    update."""
    layer = scene.view_layers[0]
    if layer.depsgraph is None:
        layer.update()
    return layer.depsgraph


def let_through(material):
    """Enables transparency of a material in Eevee; Cycles always has it."""
    if hasattr(material, "surface_render_method"):  # from 4.2 on
        material.surface_render_method = "BLENDED"
    else:
        material.blend_method, material.shadow_method = "BLEND", "NONE"


def colored_shader():
    """The built-in shader of triangles whose corners have colors."""
    import gpu

    return gpu.shader.from_builtin("SMOOTH_COLOR" if bpy.app.version >= (4, 0, 0) else "3D_SMOOTH_COLOR")


def plain_shader(points):
    """The built-in shader of one color, for points or for lines; its names changed in 4.0 and 4.5."""
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
