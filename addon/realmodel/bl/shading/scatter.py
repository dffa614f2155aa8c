# SPDX-License-Identifier: GPL-3.0-or-later
"""Plants and stones on weathered ground: what is scattered, and the nodes that scatter it.

Tufts of grass are a mesh made here, one unit high and wide; stones are pieces of beds
(core.filling.rubble). They are in no collection of the scene, so that it shows their instances alone.
"""

import bpy
import numpy as np

from ...core.base import work
from ...core.filling import PIECES, broken_piece
from ..host.nodes import Nodes
from ..objects import materials, meshes

KEY = "realmodel_scatter"  # on an object: what it is
TUFT, STONE = "Grass Tuft", "Stone"  # of a tuft; of a collection of stones, and of each of them
DOWN = "realmodel_down"  # on vertices of scree: from 0, where it begins at a wall, to 1, where it ends
# attributes of a tuft: how far along its blade a vertex is, and a number of the blade
_SHARE, _OWN = "realmodel_blade_share", "realmodel_blade_own"
_BLADES, _STALKS = 90, 3  # of a tuft; stalks have ears
_FOOT, _LEAN = 0.45, 1.1  # how far from the middle blades begin; how far they lean, of their height
_WIDTH = 0.013  # half of that of a blade
_STEPS = (0.0, 0.3, 0.55, 0.8, 1.0)  # along a blade
_PER_UNIT = {TUFT: 8.0, STONE: 2.5}  # on a square texture unit, at density 1
_IN_VIEWPORT = {TUFT: 0.25, STONE: 0.25}  # the share of them that viewports show, to stay fast
_HIGH = {TUFT: (0.1, 0.42), STONE: (0.04, 0.32)}  # texture units: least and greatest size
_SMALL = {TUFT: 1.5, STONE: 3.0}  # the power of a random number that sizes follow: most are small
_HIGHEST = 0.4  # of that of the lowest: the greatest size of the stones that lie highest on scree
_TILT = 0.35  # radians: how far a stone may be from lying flat
_FLAT = 0.6  # least upward part of the normal of ground with stones
_THROUGH = 0.3  # the share of the light that passes through blades
_GRASS, _ROCK = "#7d9440", "#9b9286"


def tuft():
    """The object of tufts, made if the file has none."""
    obj = _of_file(bpy.data.objects, TUFT)
    if obj is None:
        mesh = bpy.data.meshes.new(TUFT)
        vertices, faces, numbers = _tuft()
        mesh.from_pydata(vertices.tolist(), [], faces)
        for attribute, values in zip((_SHARE, _OWN), numbers, strict=True):
            mesh.attributes.new(attribute, "FLOAT", "POINT").data.foreach_set("value", values)
        mesh.materials.append(_grass())
        obj = bpy.data.objects.new(TUFT, mesh)
        obj[KEY] = TUFT
    return obj


def stones():
    """The collection of gray stones, made if the file has none."""
    found = _of_file(bpy.data.collections, STONE)
    if found is None:
        pieces = [work.run(lambda job, n=n: broken_piece(job, 1.0, n)) for n in range(PIECES)]
        material = _rock()
        found = collection(STONE, [(*piece, material) for piece in pieces])
        found[KEY] = STONE
    return found


def collection(name, pieces):
    """A new collection of stones. pieces: (vertices, triangles, material) each."""
    made = bpy.data.collections.new(name)
    for vertices, triangles, material in pieces:
        mesh = meshes.triangle_mesh(STONE, vertices, triangles)
        mesh.materials.append(material)
        obj = bpy.data.objects.new(STONE, mesh)
        obj[KEY] = STONE
        made.objects.link(obj)
    return made


def remove(found):
    """Removes a collection of stones that nothing has any more."""
    if found is not None and not found.users:
        for obj in list(found.objects):
            bpy.data.meshes.remove(obj.data)  # and its object with it
        bpy.data.collections.remove(found)


def _of_file(datablocks, name):
    return next((made for made in datablocks if made.get(KEY) == name and made.library is None), None)


def _new_material(name, color):
    """A material of no property, its nodes, its shader and the random number of each instance."""
    material = materials.new_material(name, materials.NO_PROPERTY, color)
    del material[materials.KEY]
    nodes = Nodes(material.node_tree)
    shader = next(node for node in material.node_tree.nodes if node.type == "BSDF_PRINCIPLED")
    return material, nodes, shader, nodes.of("ShaderNodeObjectInfo", "Random")


def _grass():
    """Blades from fresh to dry, each tuft of its own, darker at the foot and lighter at the tip, which light
    passes through. Stalks are dry."""
    material, nodes, shader, tuft = _new_material("Grass Blades", _GRASS)
    share, blade_number = (_attribute(nodes, name) for name in (_SHARE, _OWN))
    tint = nodes.new("ShaderNodeHueSaturation")
    tint.inputs["Color"].default_value = shader.inputs["Base Color"].default_value
    is_dry = nodes.math("GREATER_THAN", nodes.math("MULTIPLY_ADD", tuft, 0.12, blade_number), 0.97)
    hue = nodes.math("MULTIPLY", nodes.math("MULTIPLY_ADD", blade_number, 0.6, tuft), 0.05)
    hue = nodes.math("MULTIPLY_ADD", is_dry, 0.06, hue)
    nodes.link(nodes.math("SUBTRACT", 0.54, hue), tint.inputs["Hue"])
    nodes.link(nodes.math("MULTIPLY_ADD", is_dry, -0.35, 1.0), tint.inputs["Saturation"])
    value = nodes.math("ADD", nodes.ramp(share, 0.0, 0.9, 0.6, 1.5), nodes.about(blade_number, 0.4))
    nodes.link(nodes.math("MULTIPLY_ADD", is_dry, 0.6, value), tint.inputs["Value"])
    nodes.link(tint.outputs["Color"], shader.inputs["Base Color"])
    through, mix = nodes.new("ShaderNodeBsdfTranslucent"), nodes.new("ShaderNodeMixShader")
    output = next(node for node in material.node_tree.nodes if node.type == "OUTPUT_MATERIAL")
    nodes.link(tint.outputs["Color"], through.inputs["Color"])
    mix.inputs[0].default_value = _THROUGH
    for shade, socket in zip((shader, through), mix.inputs[1:], strict=True):
        nodes.link(shade.outputs[0], socket)
    nodes.link(mix.outputs[0], output.inputs["Surface"])
    return material


def _attribute(nodes, name):
    node = nodes.new("ShaderNodeAttribute")
    node.attribute_name = name
    return node.outputs["Fac"]


def _rock():
    """Stones that differ in tone, with rough sides."""
    material, nodes, shader, stone = _new_material("Stones", _ROCK)
    place = nodes.of("ShaderNodeTexCoord", "Object")
    rough = nodes.noise(place, 6.0, 6.0)
    tint = nodes.new("ShaderNodeHueSaturation")
    tint.inputs["Color"].default_value = shader.inputs["Base Color"].default_value
    value = nodes.total([nodes.about(stone, 0.5), nodes.about(rough, 0.7), 1.0])
    nodes.link(value, tint.inputs["Value"])
    nodes.link(nodes.math("MULTIPLY_ADD", stone, -0.02, 0.51), tint.inputs["Hue"])
    nodes.link(tint.outputs["Color"], shader.inputs["Base Color"])
    bump = nodes.new("ShaderNodeBump")
    bump.inputs["Distance"].default_value = 0.02
    nodes.link(rough, bump.inputs["Height"])
    nodes.link(bump.outputs["Normal"], shader.inputs["Normal"])
    return material


def _tuft():
    """Blades that lean outward from one place and bend, tapering to a point, and a few stalks with ears that
    are higher. Vertices, faces, and of each vertex its share of the blade and a number of the blade from 0 to
    1, which is 1 for stalks."""
    random = np.random.default_rng(4)
    vertices, faces, shares, blade_numbers = [], [], [], []
    count = _BLADES + _STALKS
    for number, azimuth in enumerate(2.0 * np.pi * random.random(count)):
        is_stalk = number >= _BLADES
        out = np.array([np.cos(azimuth), np.sin(azimuth), 0.0])
        turned = azimuth + random.normal(0.0, 0.6)
        across = np.array([-np.sin(turned), np.cos(turned), 0.0]) * _WIDTH * (0.6 + 0.8 * random.random())
        foot = np.array([*random.normal(0.0, _FOOT, 2), 0.0])
        high, lean = 0.25 + 0.6 * random.random() ** 1.5, _LEAN * random.random() ** 0.7
        widths = (0.8, 1.0, 0.85, 0.5)
        if is_stalk:
            high, lean, widths = 0.85 + 0.15 * random.random(), 0.4 * lean, (0.25, 0.25, 0.25, 0.9)
        first = len(vertices)
        for share, width in zip(_STEPS, (*widths, 0.0), strict=True):
            bent = lean * share**2  # outward and, the farther, the more down
            place = foot + out * bent * high + (0.0, 0.0, high * (share - 0.45 * lean * share**3))
            ends = (-1.0, 1.0) if width else (0.0,)
            vertices += [place + end * width * across for end in ends]
            shares += [share] * len(ends)
        blade_numbers += [1.0 if is_stalk else 0.95 * random.random()] * (len(vertices) - first)
        faces += [(first + k, first + k + 1, first + k + 3, first + k + 2) for k in (0, 2, 4)]
        faces.append((first + 6, first + 7, first + 8))
    return np.array(vertices), faces, (np.array(shares), np.array(blade_numbers))


def on(nodes, given, geometry, name, here, scale=None, down=1.0):
    """The geometry with instances on its faces. given: inputs of the group: Plants and Stones, Scatter Size,
    Seed, and the object or collection of this name. here: (field) where they are. scale: of the instances;
    None: Scatter Size. down: (field) how far down a slope, from 0 to 1."""
    size = given["Scatter Size"]
    if name == STONE:
        up = nodes.part(nodes.turned(nodes.of("GeometryNodeInputNormal", "Normal")), 2)
        here = nodes.math("MULTIPLY", here, nodes.math("GREATER_THAN", up, _FLAT))
    made = nodes.new("GeometryNodeDistributePointsOnFaces")
    nodes.link(geometry, made.inputs["Mesh"])
    nodes.link(here, made.inputs["Selection"])
    density = nodes.math("MULTIPLY", given["Plants and Stones"], _PER_UNIT[name])
    in_viewport = nodes.of("GeometryNodeIsViewport", "Is Viewport")
    shown = nodes.math("MULTIPLY_ADD", in_viewport, _IN_VIEWPORT[name] - 1.0, 1.0)
    density = nodes.math("MULTIPLY", density, shown)
    density = nodes.math("DIVIDE", density, nodes.math("MULTIPLY", size, size))
    nodes.link(density, next(s for s in made.inputs if s.name == "Density" and s.enabled))
    nodes.link(nodes.math("ADD", given["Seed"], float(len(name))), made.inputs["Seed"])
    low, high = _HIGH[name]
    placed = nodes.new("GeometryNodeInstanceOnPoints")
    nodes.link(made.outputs["Points"], placed.inputs["Points"])
    share = nodes.math("POWER", nodes.random(0.0, 1.0, 2), _SMALL[name])
    if name == STONE:  # lies flat on the slope; large ones have fallen far
        what = nodes.new("GeometryNodeCollectionInfo")
        what.inputs["Separate Children"].default_value = what.inputs["Reset Children"].default_value = True
        nodes.link(given[name], what.inputs["Collection"])
        nodes.link(what.outputs[0], placed.inputs["Instance"])
        placed.inputs["Pick Instance"].default_value = True
        nodes.link(made.outputs["Rotation"], placed.inputs["Rotation"])
        share = nodes.math("MULTIPLY", share, nodes.mixed(_HIGHEST, 1.0, down))
    else:
        what = nodes.new("GeometryNodeObjectInfo")
        nodes.link(given[name], what.inputs["Object"])
        nodes.link(what.outputs["Geometry"], placed.inputs["Instance"])
        nodes.link(nodes.random((-0.25, -0.25, 0.0), (0.25, 0.25, 6.28), 1), placed.inputs["Rotation"])
    scale = nodes.math("MULTIPLY", nodes.math("MULTIPLY_ADD", share, high - low, low), scale or size)
    if name == TUFT:  # low ones are about as wide as high ones, so that they cover the ground
        wide = nodes.math("MULTIPLY", nodes.random(0.6 * high, high, 3), size)
        sides = nodes.new("ShaderNodeCombineXYZ")
        for value, socket in zip((wide, wide, scale), sides.inputs, strict=True):
            nodes.link(value, socket)
        scale = sides.outputs[0]
    nodes.link(scale, placed.inputs["Scale"])
    if name == TUFT:
        return nodes.upright(placed.outputs["Instances"])
    turned = nodes.new("GeometryNodeRotateInstances")
    nodes.link(placed.outputs["Instances"], turned.inputs["Instances"])
    nodes.link(nodes.random((-_TILT, -_TILT, 0.0), (_TILT, _TILT, 6.28), 1), turned.inputs["Rotation"])
    return turned.outputs[0]
