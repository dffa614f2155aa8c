# SPDX-License-Identifier: GPL-3.0-or-later
"""What stands around the rocks of the hero scenes: sky, sun, haze, ground, water, plants, a figure, a camera.
Needs Blender. All is procedural: the files have no pictures and no links."""

import math

import bpy
import numpy as np
from mathutils import Vector
from realmodel.bl.host.nodes import Nodes
from realmodel.bl.objects import materials
from realmodel.bl.objects.materials import linear_color
from realmodel.bl.objects.viewports import towards
from realmodel.bl.shading import looks
from realmodel.core.filling.noise import fractal

AIR = "Air"  # the node group of the haze


# -- light, air and camera


def sky(scene, sun, zenith, horizon, glow, strength=1.0, clouds=0.5, seed=0):
    """A sky from the zenith to the horizon, brighter around the sun, with thin clouds. sun: its azimuth and
    elevation in degrees. Colors are "#rrggbb". Eevee of Blender 3.4 has no sky texture of its own."""
    world = bpy.data.worlds.new("Sky")
    world.use_nodes = True
    scene.world = world
    nodes = Nodes(world.node_tree)
    there = nodes.of("ShaderNodeTexCoord", "Generated")
    height = nodes.part(there, 2)
    up = nodes.math("MAXIMUM", height, 0.0)
    near = nodes.math("POWER", nodes.math("SUBTRACT", 1.0, up), 5.0)
    color = mixed(nodes, near, linear_color(zenith), linear_color(horizon))
    toward = nodes.vector("DOT_PRODUCT", there, tuple(towards(*map(math.radians, sun))))
    toward = nodes.math("MAXIMUM", toward, 0.0)
    halo = nodes.math(
        "MULTIPLY", nodes.math("POWER", toward, 7.0), nodes.math("MULTIPLY_ADD", near, 0.6, 0.3)
    )
    color = mixed(nodes, halo, color, linear_color(glow))
    if clouds:
        flat = nodes.vector("DIVIDE", there, nodes.vector("ADD", _gray(nodes, up), (0.16, 0.16, 0.16)))
        stretched = nodes.vector("MULTIPLY", flat, (0.55, 1.3, 0.0))
        stretched = nodes.vector("ADD", stretched, (7.1 * seed, 3.0, 0.0))
        puff = nodes.noise(stretched, 0.9, 7.0)
        shape = nodes.ramp(puff, 0.5, 0.78, 0.0, 1.0)
        fade = nodes.ramp(up, 0.03, 0.2, 0.25, 1.0)
        shape = nodes.math("MULTIPLY", nodes.math("MULTIPLY", shape, fade), clouds)
        lit = mixed(nodes, nodes.math("POWER", toward, 2.0), linear_color("#d9d3d0"), linear_color(glow))
        color = mixed(nodes, shape, color, lit)
    background = next(node for node in world.node_tree.nodes if node.type == "BACKGROUND")
    nodes.link(color, background.inputs["Color"])
    background.inputs["Strength"].default_value = strength
    return world


def _gray(nodes, value):
    node = nodes.new("ShaderNodeCombineXYZ")
    for socket in node.inputs:
        nodes.link(value, socket)
    return node.outputs[0]


def mixed(nodes, share, first, second):
    """A color between two, of which each is an output or a tuple."""
    mix = nodes.new("ShaderNodeMix")
    mix.data_type = "RGBA"
    factor, a, b = (next(s for s in mix.inputs if s.name == n and s.enabled) for n in ("Factor", "A", "B"))
    nodes.link(share, factor)
    for value, socket in ((first, a), (second, b)):
        nodes.link((*value, 1.0) if isinstance(value, (tuple, list)) and len(value) == 3 else value, socket)
    return next(s for s in mix.outputs if s.enabled)


def sunlight(scene, sun, color, energy, reach):
    """The sun. reach: how far from the camera Eevee draws its shadows."""
    lamp = bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN"))
    lamp.data.energy, lamp.data.angle = energy, math.radians(0.7)
    lamp.data.color = linear_color(color)
    lamp.rotation_euler = towards(*map(math.radians, sun)).to_track_quat("Z", "Y").to_euler()
    lamp.data.shadow_cascade_max_distance = reach
    lamp.data.shadow_cascade_count = 4
    lamp.data.use_contact_shadow = True
    scene.collection.objects.link(lamp)
    return lamp


def camera(scene, place, target, lens=32.0, shift=0.0):
    """The camera of the scene. lens: millimeters; shift: of the picture, upward."""
    eye = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    eye.location = place
    eye.rotation_euler = (Vector(target) - Vector(place)).to_track_quat("-Z", "Y").to_euler()
    eye.data.lens, eye.data.shift_y = lens, shift
    eye.data.clip_start, eye.data.clip_end = 0.1, 200_000.0
    scene.collection.objects.link(eye)
    scene.camera = eye
    return eye


def air(distance, color, strength=1.0, base=None):
    """Gives all materials haze: what is far from the camera fades into the color of the air. distance: at
    which about two thirds are air. base: (elevation, height) of air that is denser low down."""
    group = bpy.data.node_groups.new(AIR, "ShaderNodeTree")
    group.inputs.new("NodeSocketShader", "Shader")
    group.outputs.new("NodeSocketShader", "Shader")
    nodes = Nodes(group)
    inlet, outlet = nodes.new("NodeGroupInput"), nodes.new("NodeGroupOutput")
    away = nodes.of("ShaderNodeCameraData", "View Distance")
    deep = nodes.math("DIVIDE", away, -distance)
    if base is not None:
        low = nodes.part(nodes.of("ShaderNodeNewGeometry", "Position"), 2)
        low = nodes.math("DIVIDE", nodes.math("SUBTRACT", base[0], low), base[1])
        deep = nodes.math("MULTIPLY", deep, nodes.math("EXPONENT", nodes.math("MINIMUM", low, 1.0)))
    seen = nodes.math("SUBTRACT", 1.0, nodes.math("EXPONENT", deep))
    share = nodes.math("MULTIPLY", seen, nodes.of("ShaderNodeLightPath", "Is Camera Ray"))
    haze = nodes.new("ShaderNodeEmission")
    haze.inputs["Color"].default_value = (*linear_color(color), 1.0)
    haze.inputs["Strength"].default_value = strength
    mix = nodes.new("ShaderNodeMixShader")
    nodes.link(share, mix.inputs[0])
    nodes.link(inlet.outputs[0], mix.inputs[1])
    nodes.link(haze.outputs[0], mix.inputs[2])
    nodes.link(mix.outputs[0], outlet.inputs[0])
    for material in bpy.data.materials:
        if material.use_nodes:
            tree = material.node_tree
            output = next((n for n in tree.nodes if n.type == "OUTPUT_MATERIAL" and n.is_active_output), None)
            if output is None or not output.inputs["Surface"].links:
                continue
            node = tree.nodes.new("ShaderNodeGroup")
            node.node_tree = group
            tree.links.new(output.inputs["Surface"].links[0].from_socket, node.inputs[0])
            tree.links.new(node.outputs[0], output.inputs["Surface"])


# -- materials


def rock(name, color, look, size, seed=0):
    """A material of a look. size: of a texture unit, meters."""
    made = materials.new_material(name, materials.NO_PROPERTY, color)
    del made[materials.KEY]
    looks.apply(made, look, 1.0, seed, size * looks.UNITS)
    return made


def weather(material, dust, scale, streaks=0.5, ledge=0.55, cover=1.0, tint=None, above=None, wet=None):
    """Dust, soil or grass of this color on what faces up, and vertical streaks of varnish on walls. scale:
    meters, of the patches. ledge: the upward part of the normal above which there is dust. tint: the color
    of large patches. above: the elevation above which there is dust. wet: (elevation, color) of what is wet
    below."""
    tree = material.node_tree
    nodes = Nodes(tree)
    shader = next(node for node in tree.nodes if node.type == "BSDF_PRINCIPLED")
    socket = shader.inputs["Base Color"]
    color = socket.links[0].from_socket if socket.links else tuple(socket.default_value)
    place = nodes.of("ShaderNodeNewGeometry", "Position")
    patches = nodes.noise(place, 1.0 / scale, 6.0)
    upright = nodes.part(nodes.of("ShaderNodeNewGeometry", "Normal"), 2)
    if tint is not None:
        broad = nodes.noise(nodes.vector("MULTIPLY", place, (1.0, 1.0, 0.5)), 0.18 / scale, 3.0)
        share = nodes.ramp(broad, 0.42, 0.62, 0.0, 0.75)
        color = mixed(nodes, share, color, linear_color(tint))
    if streaks:
        fall = nodes.vector("MULTIPLY", place, (1.0, 1.0, 0.09))
        streak = nodes.ramp(nodes.noise(fall, 2.6 / scale, 4.0), 0.45, 0.72, 0.0, 1.0)
        broad = nodes.ramp(nodes.noise(place, 0.35 / scale, 2.0), 0.4, 0.6, 0.15, 1.0)
        wall = nodes.ramp(upright, 0.1, 0.5, 1.0, 0.0)
        share = nodes.math(
            "MULTIPLY", nodes.math("MULTIPLY", streak, broad), nodes.math("MULTIPLY", wall, streaks)
        )
        color = mixed(nodes, share, color, linear_color("#2e201b"))
    if cover:
        lifted = nodes.math("ADD", upright, nodes.about(patches, 0.5))
        share = nodes.math("MULTIPLY", nodes.ramp(lifted, ledge - 0.08, ledge + 0.12, 0.0, 1.0), cover)
        if above is not None:
            edge = nodes.math("MULTIPLY_ADD", nodes.about(patches, 1.0), scale, nodes.part(place, 2))
            share = nodes.math("MULTIPLY", share, nodes.ramp(edge, above, above + 0.5 * scale, 0.0, 1.0))
        tone = nodes.ramp(nodes.noise(place, 4.0 / scale, 4.0), 0.3, 0.7, 0.6, 1.25)
        shade = nodes.vector("SCALE", tuple(linear_color(dust)), tone)
        color = mixed(nodes, share, color, shade)
    if wet is not None:
        edge = nodes.math("MULTIPLY_ADD", nodes.about(patches, 1.0), 0.5 * wet[0], nodes.part(place, 2))
        share = nodes.ramp(edge, 0.3 * wet[0], wet[0], 0.85, 0.0)
        color = mixed(nodes, share, color, linear_color(wet[1]))
    nodes.link(color, socket)
    return material


def painted(name, color, roughness=0.8):
    """A plain material."""
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    made.diffuse_color = (*linear_color(color), 1.0)
    shader = next(node for node in made.node_tree.nodes if node.type == "BSDF_PRINCIPLED")
    shader.inputs["Base Color"].default_value = (*linear_color(color), 1.0)
    shader.inputs["Roughness"].default_value = roughness
    return made


def water_material(deep, wave, height=0.3, roughness=0.06, foam=None):
    """Water that mirrors the sky, with waves of this length and height, meters. foam: (color, share)."""
    made = painted("Water", deep, roughness)
    nodes = Nodes(made.node_tree)
    shader = next(node for node in made.node_tree.nodes if node.type == "BSDF_PRINCIPLED")
    place = nodes.of("ShaderNodeNewGeometry", "Position")
    swell = nodes.noise(nodes.vector("MULTIPLY", place, (1.0, 0.4, 0.0)), 1.0 / wave, 2.0)
    ripple = nodes.noise(nodes.vector("MULTIPLY", place, (1.0, 0.6, 0.0)), 6.0 / wave, 5.0)
    total = nodes.math("MULTIPLY_ADD", ripple, 0.35, swell)
    bump = nodes.new("ShaderNodeBump")
    bump.inputs["Distance"].default_value = height
    nodes.link(total, bump.inputs["Height"])
    nodes.link(bump.outputs["Normal"], shader.inputs["Normal"])
    if foam is not None:
        near = nodes.new("ShaderNodeAttribute")
        near.attribute_name = "foam"
        patchy = nodes.noise(place, 2.2 / wave, 6.0)
        share = nodes.math("ADD", nodes.math("MULTIPLY", near.outputs["Fac"], 1.25), nodes.about(patchy, 1.6))
        share = nodes.ramp(share, 0.55, 0.8, 0.0, 0.9)
        nodes.link(mixed(nodes, share, linear_color(deep), linear_color(foam)), shader.inputs["Base Color"])
        nodes.link(nodes.math("MULTIPLY_ADD", share, 0.7, roughness), shader.inputs["Roughness"])
    return made


def section_material(shallow, deep, depth):
    """The cut face of water: what is behind shines through, less so with the depth, meters."""
    made = painted("Water Section", shallow, 0.15)
    made.blend_method, made.shadow_method = "BLEND", "NONE"
    nodes = Nodes(made.node_tree)
    shader = next(node for node in made.node_tree.nodes if node.type == "BSDF_PRINCIPLED")
    output = next(node for node in made.node_tree.nodes if node.type == "OUTPUT_MATERIAL")
    low = nodes.part(nodes.of("ShaderNodeNewGeometry", "Position"), 2)
    share = nodes.ramp(low, 0.0, -depth, 0.0, 1.0)
    nodes.link(mixed(nodes, share, linear_color(shallow), linear_color(deep)), shader.inputs["Base Color"])
    clear, mix = nodes.new("ShaderNodeBsdfTransparent"), nodes.new("ShaderNodeMixShader")
    clear.inputs["Color"].default_value = (*linear_color("#8fd0d4"), 1.0)
    nodes.link(nodes.math("MULTIPLY_ADD", share, 0.3, 0.62), mix.inputs[0])
    nodes.link(clear.outputs[0], mix.inputs[1])
    nodes.link(shader.outputs[0], mix.inputs[2])
    nodes.link(mix.outputs[0], output.inputs["Surface"])
    return made


# -- meshes


def put(name, mesh, *used):
    """A new object of a mesh datablock with these materials."""
    for material in used:
        mesh.materials.append(material)
    item = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(item)
    return item


def grid(x, y, z):
    """Vertices and triangles of a surface. x (nx,), y (ny,), z (nx, ny)."""
    across, along = np.meshgrid(x, y, indexing="ij")
    vertices = np.stack([across, along, z], axis=-1).reshape(-1, 3)
    i, j = (a.ravel() for a in np.meshgrid(np.arange(len(x) - 1), np.arange(len(y) - 1), indexing="ij"))
    a = i * len(y) + j
    b = a + len(y)
    return vertices, np.concatenate([np.stack([a, b, b + 1], 1), np.stack([a, b + 1, a + 1], 1)])


def block(x, y, z, base):
    """Vertices and triangles of what is between a surface over a grid and a level base: closed."""
    vertices, triangles = grid(x, y, z)
    number = np.arange(len(vertices)).reshape(len(x), len(y))
    rim = np.concatenate([number[:-1, 0], number[-1, :-1], number[:0:-1, -1], number[0, :0:-1]])
    below = vertices[rim] * (1.0, 1.0, 0.0) + (0.0, 0.0, base)
    low = len(vertices) + np.arange(len(rim))
    middle = np.append(below[:, :2].mean(axis=0), base)
    after, low_after = np.roll(rim, -1), np.roll(low, -1)
    walls = [np.stack([rim, low, low_after], 1), np.stack([rim, low_after, after], 1)]
    floor = np.stack([low_after, low, np.full(len(rim), len(vertices) + len(rim))], 1)
    return np.concatenate([vertices, below, middle[None]]), np.concatenate([triangles, *walls, floor])


def surface(name, x, y, z, *used, smooth=True):
    """An object that is a surface over a grid, of quads."""
    vertices, _ = grid(x, y, z)
    i, j = (a.ravel() for a in np.meshgrid(np.arange(len(x) - 1), np.arange(len(y) - 1), indexing="ij"))
    first = i * len(y) + j
    quads = np.stack([first, first + len(y), first + len(y) + 1, first + 1], 1)
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(vertices.tolist(), [], quads.tolist())
    mesh.polygons.foreach_set("use_smooth", np.full(len(quads), smooth))
    return put(name, mesh, *used)


def ramp_of(low, high, value):
    """From 0 to 1 between two values, smooth at both ends."""
    share = np.clip((value - low) / (high - low), 0.0, 1.0)
    return share * share * (3.0 - 2.0 * share)


def rough(x, y, size, seed, octaves=5):
    """Noise from -1 to 1 of this size at places that are broadcast."""
    x, y = np.broadcast_arrays(x, y)
    places = np.column_stack([x.ravel() / size + 31.7, y.ravel() / size + 11.3, np.full(x.size, 5.5)])
    return (2.0 * fractal(places, seed, octaves) - 1.0).reshape(x.shape)


def rough3(x, y, z, size, seed, octaves=4):
    """The same in space."""
    x, y, z = np.broadcast_arrays(x, y, z)
    places = np.stack([x, y, z], axis=-1).reshape(-1, 3) / size + 23.1
    return (2.0 * fractal(places, seed, octaves) - 1.0).reshape(x.shape)


def boulder_mesh(name, seed, material, detail=3):
    """An angular stone, about one meter wide: a body that planes bound, broken and rough."""
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=detail, radius=1.0)
    item = bpy.context.object
    mesh = item.data
    bpy.data.objects.remove(item)
    mesh.name = name
    random = np.random.default_rng(seed)
    places = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.vertices.foreach_get("co", places)
    directions = places.reshape(-1, 3).astype(float)
    normals = random.normal(size=(9, 3)) * (1.0, 1.0, 0.8)
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    reach = 0.55 + 0.35 * random.random(len(normals))
    radius = np.full(len(directions), 1.0)
    for normal, far in zip(normals, reach, strict=True):
        along = directions[:, 0] * normal[0] + directions[:, 1] * normal[1] + directions[:, 2] * normal[2]
        radius = np.where(along > 0.05, np.minimum(radius, far / np.maximum(along, 0.05)), radius)
    bumps = 2.0 * fractal(directions * 2.6 + 9.0 * seed, seed, 4) - 1.0
    shaped = directions * (radius * (1.0 + 0.14 * bumps))[:, None]
    shaped *= 0.5 * np.array([1.0, 0.75 + 0.3 * random.random(), 0.55 + 0.25 * random.random()])
    mesh.vertices.foreach_set("co", shaped.astype(np.float32).ravel())
    mesh.update()
    mesh.materials.append(material)
    return mesh


def leaves_mesh(name, radius, count, size, seed, material, flat=0.8, up=0.0):
    """A crown of leaves that are small quads, in lumps."""
    random = np.random.default_rng(seed)
    lumps = random.normal(size=(9, 3)) * (0.45, 0.45, 0.35)
    centers = lumps[random.integers(0, len(lumps), count)]
    outward = random.normal(size=(count, 3))
    outward /= np.linalg.norm(outward, axis=1)[:, None]
    middle = (centers + outward * 0.42 * random.random((count, 1)) ** 0.35) * radius * (1.0, 1.0, flat)
    middle[:, 2] += up
    first = np.cross(outward, random.normal(size=(count, 3)))
    first /= np.linalg.norm(first, axis=1)[:, None]
    second = np.cross(outward, first)
    scale = size * (0.6 + 0.8 * random.random((count, 1)))
    corners = [
        middle + a * first * scale + 0.6 * b * second * scale for a, b in ((-1, 0), (0, -1), (1, 0), (0, 1))
    ]
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(
        np.stack(corners, 1).reshape(-1, 3).tolist(), [], np.arange(4 * count).reshape(-1, 4).tolist()
    )
    mesh.materials.append(material)
    return mesh


def leaf_material(name, color, spread=0.35):
    """Leaves that differ from plant to plant."""
    made = painted(name, color)
    nodes = Nodes(made.node_tree)
    shader = next(node for node in made.node_tree.nodes if node.type == "BSDF_PRINCIPLED")
    own = nodes.of("ShaderNodeObjectInfo", "Random")
    place = nodes.noise(nodes.of("ShaderNodeTexCoord", "Object"), 3.0, 3.0)
    value = nodes.total([nodes.about(own, spread), nodes.about(place, 0.8), 1.0])
    nodes.link(nodes.vector("SCALE", tuple(linear_color(color)), value), shader.inputs["Base Color"])
    return made


def tree_mesh(name, height, seed, leaf, bark, count=900, crown=0.42, trunk=0.45, lean=0.05):
    """A tree: a trunk that forks and a crown of lumps of leaves."""
    random = np.random.default_rng(seed)
    crown_mesh = leaves_mesh(
        name,
        crown * height,
        count,
        0.028 * height,
        seed,
        leaf,
        flat=0.75,
        up=height * (1.0 - 0.55 * crown) - 0.1 * height,
    )
    vertices, faces = [], []

    def limb(begin, end, thick, thin):
        first = len(vertices)
        axis = (np.array(end) - begin) / np.linalg.norm(np.array(end) - begin)
        side = np.cross(axis, (0.3, 0.9, 0.1))
        side /= np.linalg.norm(side)
        other = np.cross(axis, side)
        for place, radius in ((begin, thick), (end, thin)):
            for turn in np.linspace(0.0, 2.0 * np.pi, 7)[:-1]:
                vertices.append(np.array(place) + radius * (np.cos(turn) * side + np.sin(turn) * other))
        faces.extend(
            [[first + k, first + (k + 1) % 6, first + 6 + (k + 1) % 6, first + 6 + k] for k in range(6)]
        )

    fork = np.array([lean * height, 0.3 * lean * height, trunk * height])
    limb(np.array([0.0, 0.0, -0.05 * height]), fork, 0.035 * height, 0.024 * height)
    for _ in range(5):
        end = (
            fork + random.normal(size=3) * (0.2 * height, 0.2 * height, 0.08 * height) + (0, 0, 0.22 * height)
        )
        limb(fork, end, 0.02 * height, 0.006 * height)
    mesh = bpy.data.meshes.new(name)
    leaf_places = np.empty(3 * len(crown_mesh.vertices), np.float32)
    crown_mesh.vertices.foreach_get("co", leaf_places)
    leaf_places = leaf_places.reshape(-1, 3) + (fork * (1.0, 1.0, 0.0)).astype(np.float32)
    quads = (np.arange(4 * count).reshape(-1, 4) + len(vertices)).tolist()
    mesh.from_pydata([tuple(v) for v in vertices] + leaf_places.tolist(), [], faces + quads)
    mesh.materials.append(bark)
    mesh.materials.append(leaf)
    mesh.polygons.foreach_set("material_index", [0] * len(faces) + [1] * count)
    bpy.data.meshes.remove(crown_mesh)
    return mesh


def figure(name, place, turn=0.0, coat="#b3402e", height=1.78):
    """A hiker of this height: limbs by the modifier Skin, applied."""
    joints = {
        "hip": ((0.0, 0.0, 0.93), 0.14),
        "waist": ((0.0, 0.0, 1.12), 0.13),
        "chest": ((0.0, 0.01, 1.36), 0.165),
        "neck": ((0.0, 0.0, 1.52), 0.06),
        "head": ((0.0, -0.01, 1.63), 0.1),
        "top": ((0.0, -0.01, 1.73), 0.075),
        "l_knee": ((0.12, -0.03, 0.5), 0.075),
        "l_foot": ((0.15, 0.02, 0.07), 0.055),
        "l_toe": ((0.16, -0.14, 0.04), 0.045),
        "r_knee": ((-0.11, -0.01, 0.5), 0.075),
        "r_foot": ((-0.13, 0.05, 0.07), 0.055),
        "r_toe": ((-0.14, -0.12, 0.04), 0.045),
        "l_shoulder": ((0.19, 0.01, 1.42), 0.07),
        "l_elbow": ((0.29, 0.03, 1.15), 0.055),
        "l_hand": ((0.27, -0.08, 0.92), 0.045),
        "r_shoulder": ((-0.19, 0.01, 1.42), 0.07),
        "r_elbow": ((-0.29, 0.04, 1.15), 0.055),
        "r_hand": ((-0.24, -0.1, 0.95), 0.045),
    }
    bones = "hip waist, waist chest, chest neck, neck head, head top, hip l_knee, l_knee l_foot, "
    bones += "l_foot l_toe, hip r_knee, r_knee r_foot, r_foot r_toe, chest l_shoulder, l_shoulder l_elbow, "
    bones += "l_elbow l_hand, chest r_shoulder, r_shoulder r_elbow, r_elbow r_hand"
    names = list(joints)
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(
        [joints[key][0] for key in names],
        [tuple(names.index(key) for key in bone.split()) for bone in bones.split(", ")],
        [],
    )
    item = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(item)
    item.modifiers.new("Skin", "SKIN")
    for vertex, key in zip(mesh.skin_vertices[0].data, names, strict=True):
        vertex.radius = (joints[key][1], joints[key][1] * 0.8)
    mesh.skin_vertices[0].data[0].use_root = True
    smooth = item.modifiers.new("Subdivision", "SUBSURF")
    smooth.levels = smooth.render_levels = 1
    bpy.context.view_layer.update()
    made = bpy.data.meshes.new_from_object(item.evaluated_get(bpy.context.evaluated_depsgraph_get()))
    item.modifiers.clear()
    item.data = made
    bpy.data.meshes.remove(mesh)
    made.name = name
    for material in (
        painted("Coat", coat),
        painted("Trousers", "#3b3f47"),
        painted("Skin", "#b98a6d"),
        painted("Hair", "#2c211b"),
    ):
        made.materials.append(material)
    numbers = []
    for polygon in made.polygons:
        polygon.use_smooth = True
        z = polygon.center.z
        numbers.append(
            3 if z > 1.66 else 2 if z > 1.5 else 1 if z < 0.98 and abs(polygon.center.x) < 0.2 else 0
        )
    made.polygons.foreach_set("material_index", numbers)
    pack = boulder_mesh(f"{name} Pack", 3, painted("Pack", "#56603a"), 2)
    bag = put(f"{name} Pack", pack)
    bag.parent, bag.location, bag.scale = item, (0.0, 0.2, 1.28), (0.42, 0.36, 0.95)
    item.location, item.rotation_euler.z = place, turn
    item.scale = (height / 1.78,) * 3
    return item


def scattered(name, item, places, sizes, turns, tilt=0.0):
    """An object that shows instances of another one at places (N, 3), by a modifier of geometry nodes. The
    sizes, turns and tilts are stored in its mesh."""
    mesh = bpy.data.meshes.new(name)
    mesh.vertices.add(len(places))
    mesh.vertices.foreach_set("co", np.asarray(places, np.float32).ravel())
    mesh.attributes.new("size", "FLOAT", "POINT").data.foreach_set("value", np.asarray(sizes, np.float32))
    random = np.random.default_rng(len(places))
    angles = np.column_stack([*(tilt * random.normal(size=(2, len(places)))), turns]).astype(np.float32)
    mesh.attributes.new("angles", "FLOAT_VECTOR", "POINT").data.foreach_set("vector", angles.ravel())
    group = bpy.data.node_groups.get("Scattered")
    if group is None:
        group = bpy.data.node_groups.new("Scattered", "GeometryNodeTree")
        group.inputs.new("NodeSocketGeometry", "Geometry")
        group.inputs.new("NodeSocketObject", "Instance")
        group.outputs.new("NodeSocketGeometry", "Geometry")
        nodes = Nodes(group)
        inlet, outlet = nodes.new("NodeGroupInput"), nodes.new("NodeGroupOutput")
        info = nodes.new("GeometryNodeObjectInfo")
        info.inputs["As Instance"].default_value = True
        nodes.link(inlet.outputs["Instance"], info.inputs["Object"])
        size, turn = (nodes.new("GeometryNodeInputNamedAttribute") for _ in range(2))
        size.data_type, turn.data_type = "FLOAT", "FLOAT_VECTOR"
        size.inputs[0].default_value, turn.inputs[0].default_value = "size", "angles"
        made = nodes.new("GeometryNodeInstanceOnPoints")
        nodes.link(inlet.outputs["Geometry"], made.inputs["Points"])
        nodes.link(info.outputs["Geometry"], made.inputs["Instance"])
        nodes.link(next(s for s in size.outputs if s.enabled), made.inputs["Scale"])
        nodes.link(next(s for s in turn.outputs if s.enabled), made.inputs["Rotation"])
        nodes.link(made.outputs[0], outlet.inputs[0])
    holder = put(name, mesh)
    modifier = holder.modifiers.new("Scattered", "NODES")
    modifier.node_group = group
    modifier[group.inputs["Instance"].identifier] = item
    return holder


def hidden_source(name, mesh):
    """An object that only instances show."""
    item = bpy.data.objects.new(name, mesh)
    folder = bpy.data.collections.get("Scattered Sources")
    if folder is None:
        folder = bpy.data.collections.new("Scattered Sources")
        bpy.context.scene.collection.children.link(folder)
        folder.hide_viewport = folder.hide_render = True
    folder.objects.link(item)
    return item


class Ground:
    """Where objects lie beneath places in plan: rays from above to what is in the scene now."""

    def __init__(self, *only):
        self._only = {item.name for item in only}

    def below(self, x, y, top=1e5):
        """(place, normal, the object hit) or None."""
        depsgraph = bpy.context.evaluated_depsgraph_get()
        scene = bpy.context.scene
        z = top
        for _ in range(12):
            hit, place, normal, _, item, _ = scene.ray_cast(depsgraph, (x, y, z), (0.0, 0.0, -1.0))
            if not hit:
                return None
            if not self._only or item.name in self._only:
                return place, normal, item
            z = place.z - 1e-3 * max(1.0, abs(place.z))
        return None

    def spot(self, x, y, reach, step=1.0, top=1e5):
        """The highest place around one in plan, of those that are nearly level."""
        found = [
            self.below(x + a, y + b, top)
            for a in np.arange(-reach, reach + 0.1, step)
            for b in np.arange(-reach, reach + 0.1, step)
        ]
        found = [hit for hit in found if hit is not None]
        level = [hit for hit in found if hit[1].z > 0.8]
        return max(level or found, key=lambda hit: hit[0].z)[0]


def strewn(name, items, ground, places, sizes, seed=0, sink=0.25, steepest=0.5, tilt=0.4):
    """Stones or plants on the ground, of each item its share. places: (N, 2); sizes: (N,)."""
    random = np.random.default_rng(seed)
    found = [[] for _ in items]
    for (x, y), size in zip(places, sizes, strict=True):
        hit = ground.below(float(x), float(y))
        if hit is None or hit[1].z < steepest:
            continue
        found[random.integers(len(items))].append((*hit[0][:2], hit[0].z - sink * size * 0.3, size))
    for number, (item, rows) in enumerate(zip(items, found, strict=True), 1):
        if rows:
            rows = np.array(rows)
            turns = 2.0 * np.pi * random.random(len(rows))
            scattered(f"{name} {number}", item, rows[:, :3], rows[:, 3], turns, tilt)
