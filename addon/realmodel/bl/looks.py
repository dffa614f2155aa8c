# SPDX-License-Identifier: GPL-3.0-or-later
"""Procedural materials of rock, for Cycles and Eevee: nodes made from the recipes of realmodel.core.looks.

Laminae follow the attributes of the blocks (realmodel.core.bedding); all other texture is of coordinates of
the model, so that it goes on from block to block.

What other programs read of a material, they should find: Blender's exporters take the value of the shader's
Base Color where what is linked to it says nothing to them; that of glTF takes one of two colors that are
multiplied; that of USD would take the first attribute that it finds on the way, so these are in a group, into
which it does not look. Textures themselves have to be baked (baking.py).
"""

import bpy
import numpy as np

from ..core.looks import LOOKS, look_of
from . import library_rows, materials, meshes, versions

KEY = "realmodel_look"  # on a material: its look
GROUP = "realmodel_bedding"  # on the node group that has the attributes of blocks
UNITS = 250.0  # texture units along the diagonal of a model, at scale 1
_FLAT_LAMINAE = 0.03  # how many times longer than thick laminae are, inverted


def apply(material, look, scale, seed, diagonal):
    """Gives a material a look in the place of the nodes that it has.

    look: a key of LOOKS. scale: of the texture, 1 suits a model of this diagonal. seed: shifts it."""
    color = tuple(material.diffuse_color)
    tree = material.node_tree
    tree.nodes.clear()
    nodes = _Nodes(tree)
    shader = _new_shader(nodes)
    recipe = LOOKS[look]
    _set_gloss(shader, recipe.roughness)
    shader.inputs["Base Color"].default_value = color
    if look != "FLAT":
        _fill(nodes, shader, recipe, color, diagonal / UNITS * scale, seed)
    material[KEY] = look


def level(material):
    """Nothing stands out of a material that has a look any more."""
    for link in list(material.node_tree.links):
        if link.to_socket.name == "Normal" and link.to_node.type == "BSDF_PRINCIPLED":
            material.node_tree.links.remove(link)


def show_picture(material, image):
    """Gives a material that has a look a picture of it in the place of its nodes."""
    tree = material.node_tree
    tree.nodes.clear()
    nodes = _Nodes(tree)
    shader = _new_shader(nodes)
    shader.inputs["Base Color"].default_value = (1.0, 1.0, 1.0, 1.0)  # files multiply both
    _set_gloss(shader, LOOKS[material[KEY]].roughness)
    picture = nodes.new("ShaderNodeTexImage")
    picture.image = image
    nodes.link(picture.outputs["Color"], shader.inputs["Base Color"])


def _new_shader(nodes):
    shader = nodes.new("ShaderNodeBsdfPrincipled")
    nodes.link(shader.outputs["BSDF"], nodes.new("ShaderNodeOutputMaterial").inputs["Surface"])
    return shader


def _set_gloss(shader, roughness):
    """Matt but for smooth rock."""
    versions.make_matt(shader)
    shader.inputs["Roughness"].default_value = roughness
    if roughness < 0.5:
        versions.make_glossy(shader)


def _fill(nodes, shader, look, color, unit, seed):
    place = nodes.of("ShaderNodeTexCoord", "Object")
    place = nodes.vector("MULTIPLY", place, (1.0 / unit,) * 3)
    rng = np.random.default_rng(seed)
    place = nodes.vector("ADD", place, tuple(rng.uniform(-50.0, 50.0, 3)))
    parts = []
    if look.stain:
        parts.append((look.stain, nodes.noise(place, 0.12, 3.0)))
    if look.grain:
        parts.append((look.grain, nodes.noise(place, 1.0 / look.grain_size, 2.0)))
    if look.lamination:
        parts.append((look.lamination, nodes.noise(_in_layer(nodes, place, look.lamina, unit), 1.0, 4.0)))
    if look.clasts:
        parts.append((look.clasts, _clasts(nodes, place, look.clast_size)))
    total = None
    for strength, value in parts:
        value = nodes.math("MULTIPLY", nodes.math("SUBTRACT", value, 0.5), 2.0 * strength)
        total = value if total is None else nodes.math("ADD", total, value)
    tint = nodes.new("ShaderNodeHueSaturation")
    given = nodes.new("ShaderNodeRGB")
    given.name = given.label = materials.COLOR
    given.outputs[0].default_value = color
    base = given.outputs[0]
    if look.top:
        base = _brown_below(nodes, base)
    nodes.link(base, tint.inputs["Color"])
    nodes.link(nodes.math("ADD", nodes.math("MULTIPLY", total, 1.6), 1.0), tint.inputs["Value"])
    nodes.link(nodes.math("SUBTRACT", 1.05, nodes.math("MULTIPLY", total, 0.5)), tint.inputs["Saturation"])
    _multiply(nodes, given.outputs[0], tint.outputs["Color"], shader.inputs["Base Color"])
    if look.bump:
        bump = nodes.new("ShaderNodeBump")
        bump.inputs["Strength"].default_value = 0.7
        bump.inputs["Distance"].default_value = look.bump * unit * 4.0
        nodes.link(total, bump.inputs["Height"])
        nodes.link(bump.outputs["Normal"], shader.inputs["Normal"])


def _multiply(nodes, color, seen, socket):
    """Links a color to a socket as the product of the property's and what is left."""
    mix = nodes.new("ShaderNodeMix")
    mix.data_type, mix.blend_type = "RGBA", "MULTIPLY"
    factor, first, second = (
        next(s for s in mix.inputs if s.name == name and s.enabled) for name in ("Factor", "A", "B")
    )
    nodes.link(1.0, factor)
    nodes.link(color, first)
    nodes.link(nodes.vector("DIVIDE", seen, color), second)
    nodes.link(next(s for s in mix.outputs if s.enabled), socket)


def _in_layer(nodes, place, lamina, unit):
    """Coordinates in which laminae are level: the height above the base of the layer as it was deposited."""
    height = nodes.attribute("height")
    above = nodes.math("MULTIPLY", height, nodes.attribute("thickness"))
    above = nodes.math("MULTIPLY", above, 1.0 / (lamina * unit))
    apart = nodes.new("ShaderNodeSeparateXYZ")
    nodes.link(place, apart.inputs[0])
    age = nodes.math("MULTIPLY", nodes.attribute("age"), 7.3)  # layers differ
    joined = nodes.new("ShaderNodeCombineXYZ")
    nodes.link(nodes.math("MULTIPLY", apart.outputs[0], _FLAT_LAMINAE), joined.inputs[0])
    nodes.link(nodes.math("MULTIPLY", apart.outputs[1], _FLAT_LAMINAE), joined.inputs[1])
    nodes.link(nodes.math("ADD", above, age), joined.inputs[2])
    return joined.outputs[0]


def _clasts(nodes, place, size):
    """From 0 to 1: pebbles that differ from one another, dark where they meet."""
    cells = nodes.new("ShaderNodeTexVoronoi")
    nodes.link(place, cells.inputs["Vector"])
    cells.inputs["Scale"].default_value = 1.0 / size
    apart = nodes.new("ShaderNodeSeparateXYZ")
    nodes.link(cells.outputs["Color"], apart.inputs[0])
    dome = nodes.math("SUBTRACT", 1.0, cells.outputs["Distance"])
    return nodes.math(
        "MULTIPLY", dome, nodes.math("ADD", nodes.math("MULTIPLY", apart.outputs[0], 0.7), 0.45)
    )


def _brown_below(nodes, color):
    """The color on faces that are ground, on others one of earth."""
    earth = nodes.new("ShaderNodeHueSaturation")
    earth.inputs["Hue"].default_value = 0.36
    earth.inputs["Saturation"].default_value = 0.9
    earth.inputs["Value"].default_value = 0.55
    nodes.link(color, earth.inputs["Color"])
    nodes.link(nodes.math("SUBTRACT", 1.0, nodes.attribute("is_top")), earth.inputs["Fac"])
    return earth.outputs["Color"]


class _Nodes:
    """Makes nodes of a tree, in columns by their number."""

    def __init__(self, tree):
        self.tree = tree
        self._bedding = None

    def new(self, kind):
        node = self.tree.nodes.new(kind)
        count = len(self.tree.nodes)
        node.location = (-220.0 * (count // 5), -240.0 * (count % 5))
        return node

    def link(self, value, socket):
        """value: an output, or what an input has without a link."""
        if isinstance(value, (float, int, tuple)):
            socket.default_value = value
        else:
            self.tree.links.new(value, socket)

    def of(self, kind, output):
        return self.new(kind).outputs[output]

    def math(self, operation, first, second):
        node = self.new("ShaderNodeMath")
        node.operation = operation
        self.link(first, node.inputs[0])
        self.link(second, node.inputs[1])
        return node.outputs[0]

    def vector(self, operation, first, second):
        node = self.new("ShaderNodeVectorMath")
        node.operation = operation
        self.link(first, node.inputs[0])
        self.link(second, node.inputs[1])
        return node.outputs[0]

    def noise(self, place, scale, detail):
        node = self.new("ShaderNodeTexNoise")
        self.link(place, node.inputs["Vector"])
        node.inputs["Scale"].default_value, node.inputs["Detail"].default_value = scale, detail
        return node.outputs[0]

    def attribute(self, name):
        if self._bedding is None:
            self._bedding = self.new("ShaderNodeGroup")
            self._bedding.node_tree = _bedding_group()
        return self._bedding.outputs[name]


def _bedding_group():
    """The node group that has the attributes of the bedding, new where there is none."""
    found = next((group for group in bpy.data.node_groups if GROUP in group and not group.library), None)
    if found is not None:
        return found
    group = bpy.data.node_groups.new("RealModel Bedding", "ShaderNodeTree")
    group[GROUP] = True
    nodes = _Nodes(group)
    output = nodes.new("NodeGroupOutput")
    for name in meshes.BEDDING:
        versions.new_output(group, name)
        node = nodes.new("ShaderNodeAttribute")
        node.attribute_name = meshes.PREFIX + name
        nodes.link(node.outputs["Fac"], output.inputs[name])
    return group


def apply_to_scene(scene, rows, look, scale, seed, diagonal):
    """Gives the materials of some properties, rows of the library, a look; look None: that which suits the
    rock. Returns how many materials there were."""
    count = 0
    for row in rows:
        chosen = look_of(row.rock, row.name) if look is None else look
        for material in library_rows.scene_materials(scene, row.id):
            if material.library is None and material.node_tree is not None:
                apply(material, chosen, scale, seed + row.id, diagonal)
                count += 1
    return count
