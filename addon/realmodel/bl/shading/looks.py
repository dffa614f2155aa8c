# SPDX-License-Identifier: GPL-3.0-or-later
"""Procedural materials of rock, for Cycles and Eevee: nodes made from the recipes of core.project.looks.

Laminae follow the attributes of the blocks (core.display.bedding); all other texture is of coordinates of
the model, so that it is continuous from block to block.

Other programs should find the color of a material. Blender's exporters take the value of the shader's Base
Color if they cannot interpret its links; the exporter of glTF takes one of two colors that are multiplied;
that of USD would take the first attribute on the way, so attributes are in a group, which it does not search.
Textures themselves have to be baked (scene/bake.py).
"""

import math
from dataclasses import dataclass, field

import numpy as np

from ...core.project.library import AUTO_LOOK
from ...core.project.looks import LOOKS, look_of
from ..display import explosion
from ..host import versions
from ..host.nodes import Nodes, group_once
from ..objects import materials, meshes
from ..project import library_rows
from . import edge_wear

KEY = "realmodel_look"  # on a material: its look
GROUP = "realmodel_bedding"  # on the node group that has the attributes of blocks
TEXTURE = "realmodel_look_texture"  # its scale and seed
AUTO = AUTO_LOOK.upper()


def says(key, look):
    """A look in one line."""
    return "The color of the property alone" if key == "FLAT" else f"Texture of {look.label.lower()}"


ITEMS = (
    (AUTO, "Automatic", "The look for the lithology, or for the name of the property"),
    *((key, look.label, says(key, look)) for key, look in LOOKS.items()),
)
UNITS = 250.0  # texture units along the diagonal of a model, at scale 1
OCCLUSION = "realmodel_occlusion"  # on the node group of a baked picture
_GLTF = "glTF Material Output"
_BETWEEN = {"NORMAL": "ShaderNodeNormalMap", "DISPLACEMENT": "ShaderNodeDisplacement"}
_INPUTS = {  # that baked pictures go to
    "COLOR": "Base Color",
    "ROUGHNESS": "Roughness",
    "NORMAL": "Color",
    "OCCLUSION": "Occlusion",
    "DISPLACEMENT": "Height",
}
SIZE = "Texture Size"  # the node that says how large a texture unit is
_FLAT_LAMINAE = 0.03  # how many times longer than thick laminae are, inverted
_GROOVE = 0.07  # texture units: half the width of a groove or a crack
_BENT = 0.9  # texture units: how far joints wind
_JOINT_SETS = (((0.93, 0.35, 0.09), 1.9), ((-0.46, 0.88, -0.14), 1.0))  # normals, and how far apart
_CRYSTAL = 0.4  # clasts of this size and smaller touch one another
_CLAST_SIZES, _CLAST_SHARES = (1.0, 0.4), (0.5, 0.8)  # large and small clasts; how far crystals differ
_RADII = 0.26, 0.2  # of pebbles, of the size of a cell: how much they differ, and the least
_ROUND, _ROUNDED = (-3.0, 1.08), 0.5  # how pebbles end at the border of their cell, and how round there
_UNEVEN = 0.08  # texture units: how uneven the outlines of pebbles are
_DOME = 0.42  # how far pebbles stand out, of their radius: their rims are not steeper than 40 degrees
_SEAM, _SHADE = 1.3, 0.16  # of its radius: how far its shade reaches into the matrix; and how dark it is
_OCTAVES = 7.0  # of the relief: a hundredth of its size, so that it is rough at two meters, too
_WAVY = 0.16  # texture units: how far laminae are from straight
_CRUMBS = (1.0, 0.4)  # sizes of crumbs, of the largest
_LITTER = 0.14  # texture units: the size of the places of stalks
_STALK = (0.42, 0.02)  # of that: how long and wide they are
_TUFTS = ((0.21, 6.5), (0.12, 4.5))  # texture units: sizes of tufts of grass; how many blades
_BENT_BLADES = 4.0  # how far blades bend to one side
_NO_LAYER = 1e-9  # a thickness below this: the mesh has no layers


def apply(material, look, scale, seed, diagonal):
    """Replaces the nodes of a material by a look. look: a key of LOOKS. scale: of the texture, 1 suits a
    model of this diagonal. seed: shifts it."""
    color = tuple(material.diffuse_color)
    tree = material.node_tree
    is_worn = edge_wear.has(material)
    tree.nodes.clear()
    nodes = _Nodes(tree)
    shader = _new_shader(nodes)
    recipe = LOOKS[look]
    _set_gloss(shader, recipe.roughness)
    shader.inputs["Base Color"].default_value = color
    if look != "FLAT":
        _fill(nodes, shader, recipe, color, diagonal / UNITS * scale, seed)
    if is_worn:
        edge_wear.put_on(material)
    material[KEY] = look


def reduce(material, kind):
    """Removes what a picture does not show from the shader of a material: it takes long to compute. kind: one
    of scene.bake.KINDS."""
    shown = {"COLOR": "Base Color", "ROUGHNESS": "Roughness", "NORMAL": "Normal"}
    hidden = {*shown.values()} - {shown.get(kind)}
    for link in list(material.node_tree.links):
        if link.to_node.type == "BSDF_PRINCIPLED" and link.to_socket.name in hidden:
            material.node_tree.links.remove(link)


def show_pictures(material, images):
    """Replaces the nodes of a material by baked pictures of its look. images: of some of the kinds of
    scene.bake, by their keys."""
    tree = material.node_tree
    heights = next((node.outputs[0].default_value for node in tree.nodes if node.name == SIZE), 0.0)
    tree.nodes.clear()
    nodes = _Nodes(tree)
    shader = _new_shader(nodes)
    shader.inputs["Base Color"].default_value = (1.0, 1.0, 1.0, 1.0)  # files multiply both
    look = LOOKS.get(material.get(KEY))
    _set_gloss(shader, 1.0 if look is None else look.roughness)
    for kind, image in images.items():
        node = nodes.new("ShaderNodeTexImage")
        node.image = image
        if kind == "OCCLUSION":
            to = nodes.new("ShaderNodeGroup")
            to.node_tree = group_once("ShaderNodeTree", _GLTF, OCCLUSION, _fill_occlusion_group)
        elif kind in _BETWEEN:
            to = nodes.new(_BETWEEN[kind])
        else:
            to = shader
        nodes.link(node.outputs["Color"], to.inputs[_INPUTS[kind]])
        if kind == "NORMAL":
            nodes.link(to.outputs["Normal"], shader.inputs["Normal"])
        elif kind == "DISPLACEMENT":
            to.inputs["Scale"].default_value = 2.0 * heights
            if "NORMAL" not in images:  # Cycles would count the relief twice
                output = next(node for node in tree.nodes if node.type == "OUTPUT_MATERIAL")
                nodes.link(to.outputs[0], output.inputs["Displacement"])


def _fill_occlusion_group(group):
    """Where Blender's exporter of glTF looks for the picture: by the name of the group and of its input."""
    versions.add_group_socket(group, "Occlusion", "NodeSocketFloat", (1.0,))


def show_height(material):
    """A material shines by the height of its relief: 0.5 is the mesh, 1 a texture unit above it."""
    nodes = Nodes(material.node_tree)
    bump = next((node for node in material.node_tree.nodes if node.type == "BUMP"), None)
    height = bump.inputs["Height"].links[0].from_socket if bump and bump.inputs["Height"].is_linked else 0.0
    shine = nodes.new("ShaderNodeEmission")
    nodes.link(nodes.math("MULTIPLY_ADD", height, 0.5, 0.5), shine.inputs["Color"])
    for node in material.node_tree.nodes:
        if node.type == "OUTPUT_MATERIAL":
            nodes.link(shine.outputs[0], node.inputs["Surface"])


def _new_shader(nodes):
    shader = nodes.new("ShaderNodeBsdfPrincipled")
    nodes.link(shader.outputs["BSDF"], nodes.new("ShaderNodeOutputMaterial").inputs["Surface"])
    return shader


def _set_gloss(shader, roughness):
    """Sets the roughness: matte, except for smooth rock."""
    versions.make_matt(shader)
    shader.inputs["Roughness"].default_value = roughness
    if roughness < 0.5:
        versions.make_glossy(shader)


@dataclass
class _Texture:
    """What a recipe adds up to: how bright, how high (texture units), how far in hue, and how pale."""

    tones: list = field(default_factory=list)
    heights: list = field(default_factory=list)
    hues: list = field(default_factory=list)
    pale: list = field(default_factory=list)


def _fill(nodes, shader, look, color, unit, seed):
    """Nodes of all that a recipe has.

    Renderers compute heights three times, for their slope, so few nodes that are slow (three-dimensional
    noise above all) may be in them: Eevee's shaders take long to compile otherwise. Octaves of a noise take
    it no longer: they are what close-ups live on."""
    size = nodes.new("ShaderNodeValue")
    size.name = size.label = SIZE
    size = size.outputs[0]
    size.default_value = unit
    texture = _Texture()
    _fill_texture(nodes, look, _place(nodes, size, seed), size, texture)
    tone = nodes.math("MULTIPLY", nodes.total(texture.tones), 1.6)
    tint = nodes.new("ShaderNodeHueSaturation")
    base_color = nodes.new("ShaderNodeRGB")
    base_color.name = base_color.label = materials.COLOR
    base_color = base_color.outputs[0]
    base_color.default_value = color
    nodes.link(_brown_below(nodes, base_color) if look.grassy else base_color, tint.inputs["Color"])
    nodes.link(nodes.math("MAXIMUM", nodes.math("ADD", tone, 1.0), 0.15), tint.inputs["Value"])
    pale = nodes.total([nodes.math("MULTIPLY", tone, 0.3), *texture.pale])
    nodes.link(nodes.math("SUBTRACT", 0.95, pale), tint.inputs["Saturation"])
    if look.hue and texture.hues:
        hue = nodes.total([nodes.about(hue, 2.0 * look.hue) for hue in texture.hues])
        nodes.link(nodes.math("ADD", hue, 0.5), tint.inputs["Hue"])
    _multiply(nodes, base_color, tint.outputs["Color"], shader.inputs["Base Color"])
    if texture.heights:
        bump = nodes.new("ShaderNodeBump")
        nodes.link(size, bump.inputs["Distance"])
        nodes.link(nodes.total(texture.heights), bump.inputs["Height"])
        nodes.link(bump.outputs["Normal"], shader.inputs["Normal"])


def _place(nodes, size, seed):
    """The position in the object, in texture units, shifted by a seed."""
    place = nodes.of("ShaderNodeTexCoord", "Object")
    rng = np.random.default_rng(seed)
    place = nodes.vector("SCALE", place, nodes.math("DIVIDE", 1.0, size))
    return nodes.vector("ADD", place, tuple(rng.uniform(-50.0, 50.0, 3)))


def _fill_texture(nodes, look, place, size, texture):
    large = nodes.noise(place, 0.12, 2.0)
    rough = nodes.noise(place, 1.0 / look.relief_size, _OCTAVES) if look.relief else None
    if look.stain:
        texture.tones.append(nodes.about(large, 2.0 * look.stain))
    if look.grain:
        grain = nodes.noise(place, 1.0 / look.grain_size, 3.0)
        texture.tones.append(nodes.about(grain, 2.5 * look.grain))
    if look.relief:
        texture.heights.append(nodes.about(rough, 2.0 * look.relief))
        texture.tones.append(nodes.about(rough, min(0.7, 1.4 * look.relief)))  # hollows are dark
    _fill_bedding(nodes, look, place, _above(nodes, place, size), (large, rough), texture)
    free = 1.0
    if look.clasts and look.clast_size <= _CRYSTAL:
        _add_crystals(nodes, place, look, texture)
    elif look.clasts:
        free = _add_pebbles(nodes, place, look, rough, texture)
    if look.crumbs:
        _add_crumbs(nodes, place, look, free, texture)
    if look.grassy:
        _add_blades(nodes, place, texture)
        texture.hues.append(large)
    if look.litter:
        _add_litter(nodes, place, look, texture)


def _fill_bedding(nodes, look, place, above, noises, texture):
    """Laminae, beds, joints and cracks. noises: large ones and those of the relief."""
    large, rough = noises
    worn = nodes.ramp(large, 0.35, 0.6, 0.15, 1.0)  # cracks are filled here, open there
    on_wall = nodes.math("MULTIPLY_ADD", nodes.attribute("is_top"), -0.7, 1.0)  # and hardly seen on top
    if look.lamination:
        lamina = nodes.about(_laminae(nodes, place, above, rough, look.lamina), 1.0)
        texture.heights.append(nodes.math("MULTIPLY", lamina, look.lamination))
        patchy = nodes.ramp(large, 0.3, 0.65, 0.35, 1.0)  # here they stand out, there they are worn away
        tone = nodes.math("MULTIPLY", nodes.math("MULTIPLY", lamina, patchy), 2.0 * look.lamination)
        texture.tones.append(tone)
    bed = None
    if look.bed:
        bed, groove = _beds(nodes, above, rough, look.bed)
        texture.tones.append(nodes.about(bed[0], 0.22))
        texture.hues.append(bed[1])
        _groove(nodes, look, nodes.math("MULTIPLY", groove, on_wall), worn, texture)
    if look.joint and look.cells:
        crack, tone = _cells(nodes, place, rough, look)
        shown = nodes.attribute("is_top") if look.on_top else on_wall
        _groove(nodes, look, nodes.math("MULTIPLY", crack, shown), None if look.on_top else worn, texture)
        if not look.on_top:
            texture.tones.append(nodes.about(tone, 0.15))
    elif look.joint:
        joints = _joints(nodes, place, rough, bed, look.joint)
        _groove(nodes, look, nodes.math("MULTIPLY", joints, on_wall), worn, texture)


def _multiply(nodes, color, seen, socket):
    """Links to a socket the property's color multiplied by the brightness."""
    mix = nodes.new("ShaderNodeMix")
    mix.data_type, mix.blend_type = "RGBA", "MULTIPLY"
    factor, first, second = (
        next(s for s in mix.inputs if s.name == name and s.enabled) for name in ("Factor", "A", "B")
    )
    nodes.link(1.0, factor)
    nodes.link(color, first)
    nodes.link(nodes.vector("DIVIDE", seen, color), second)
    nodes.link(next(s for s in mix.outputs if s.enabled), socket)


def _above(nodes, place, size):
    """The height above the base of the layer as it was deposited, where layers differ, in texture units; that
    in the object where a mesh has no layers."""
    thickness = nodes.attribute("thickness")
    above = nodes.math("DIVIDE", nodes.math("MULTIPLY", nodes.attribute("height"), thickness), size)
    above = nodes.math("ADD", above, nodes.math("MULTIPLY", nodes.attribute("age"), 7.3))
    without = nodes.math("MULTIPLY", nodes.math("LESS_THAN", thickness, _NO_LAYER), nodes.part(place, 2))
    return nodes.math("ADD", above, without)


def _laminae(nodes, place, above, rough, lamina):
    """Noise from 0 to 1 for laminae, which are parallel to the layer, of limited length, and a little wavy:
    that hides where large triangles meet."""
    if rough is not None:
        above = nodes.math("ADD", above, nodes.about(rough, _WAVY))
    joined = nodes.new("ShaderNodeCombineXYZ")
    nodes.link(
        nodes.vector("DOT_PRODUCT", place, (0.8 * _FLAT_LAMINAE, 0.6 * _FLAT_LAMINAE, 0.0)), joined.inputs[0]
    )
    nodes.link(nodes.math("MULTIPLY", above, 1.0 / lamina), joined.inputs[1])
    return nodes.noise(joined.outputs[0], 1.0, 5.0, "2D")


def _bands(nodes, along):
    """Numbers of the bands, of irregular width and about 1 on average, at a coordinate, and the distance from
    the border of the band, from 0 to 0.5. Voronoi textures would give the same, but several of them take
    Eevee minutes to compile."""
    bent = along
    for often, far in (
        (1.9, 0.32),
        (0.83, 0.2),
    ):  # the product of both adds up to less than 1: bands have an order
        wave = nodes.math("SINE", nodes.math("MULTIPLY", along, often))
        bent = nodes.math("MULTIPLY_ADD", wave, far, bent)
    return nodes.math("FLOOR", bent), nodes.math("PINGPONG", bent, 0.5)


def _beds(nodes, above, rough, bed):
    """Three random numbers from 0 to 1 for each bed, and the depth in the groove between two beds (0 to
    1)."""
    level = nodes.math("MULTIPLY", above, 1.0 / bed)
    if rough is not None:
        level = nodes.math("ADD", level, nodes.about(rough, 0.12 / bed))
    number, edge = _bands(nodes, level)
    random = nodes.new("ShaderNodeTexWhiteNoise")
    random.noise_dimensions = "1D"
    nodes.link(number, random.inputs["W"])
    numbers = [nodes.part(random.outputs["Color"], axis) for axis in range(3)]
    open_here = nodes.math("MULTIPLY_ADD", numbers[2], 0.8, 0.2)
    groove = nodes.ramp(edge, 0.0, _GROOVE / bed, 1.0, 0.0)
    return numbers, nodes.math("MULTIPLY", groove, open_here)


def _joints(nodes, place, rough, bed, spacing):
    """The depth in a joint (0 to 1). Joints are steep planes of two sets at irregular distances: those of the
    first set pass through all beds, those of the second only through some, at other positions in each bed."""
    joints = []
    for number, (normal, apart) in enumerate(_JOINT_SETS):
        apart *= spacing
        along = nodes.vector("DOT_PRODUCT", place, tuple(part / apart for part in normal))
        if rough is not None:
            along = nodes.math("ADD", along, nodes.about(rough, _BENT / apart))
        if number and bed is not None:
            along = nodes.math("MULTIPLY_ADD", bed[2], 40.0, along)
        joint = nodes.ramp(_bands(nodes, along)[1], 0.0, _GROOVE / apart, 1.0, 0.0)
        if number and bed is not None:
            joint = nodes.math("MULTIPLY", joint, nodes.ramp(bed[1], 0.35, 0.65, 0.0, 1.0))
        joints.append(joint)
    return nodes.math("MAXIMUM", *joints)


def _cells(nodes, place, rough, look):
    """The depth in an upright crack (0 to 1), and a number from 0 to 1 for each cell between cracks."""
    bent = nodes.vector("SCALE", place, 1.0 / look.joint)
    if rough is not None:
        shift = nodes.new("ShaderNodeCombineXYZ")
        for axis in range(2):
            nodes.link(nodes.about(rough, 0.25), shift.inputs[axis])
        bent = nodes.vector("ADD", bent, shift.outputs[0])
    # The distance to an edge itself would be slower by far, and takes Eevee minutes to compile.
    first, second = (nodes.cells("2D", bent, 0.85, feature) for feature in ("F1", "F2"))
    edge = nodes.math("SUBTRACT", second.outputs["Distance"], first.outputs["Distance"])
    crack = nodes.ramp(edge, 0.0, 2.0 * _GROOVE / look.joint, 1.0, 0.0)
    return crack, nodes.part(first.outputs["Color"], 0)


def _groove(nodes, look, groove, worn, texture):
    """worn: how much of its color is there, or None."""
    texture.heights.append(nodes.math("MULTIPLY", groove, -0.5 * look.crack))
    seen = groove if worn is None else nodes.math("MULTIPLY", groove, worn)
    texture.tones.append(nodes.math("MULTIPLY", seen, -look.crack))


def _add_crystals(nodes, place, look, texture):
    """Crystals that touch one another, large ones and between them small ones."""
    for share, size in zip(_CLAST_SHARES, _CLAST_SIZES, strict=True):
        cell = nodes.cells("3D", nodes.vector("SCALE", place, 1.0 / (look.clast_size * size)), 1.0, "F1")
        first, second = nodes.part(cell.outputs["Color"], 0), nodes.part(cell.outputs["Color"], 1)
        texture.tones.append(nodes.about(first, 2.0 * look.clasts * share))
        texture.hues.append(nodes.math("MULTIPLY_ADD", nodes.math("SUBTRACT", second, 0.5), share, 0.5))


def _add_pebbles(nodes, place, look, rough, texture):
    """Pebbles of many sizes: a large kind, and a small one in the matrix between them. In each cell is one of
    random radius, or none; the relief makes their outlines uneven. Returns where none is: 1, else 0."""
    free = 1.0  # of larger pebbles
    for number, size in enumerate(_CLAST_SIZES):
        size *= look.clast_size
        near = nodes.vector("SCALE", nodes.vector("ADD", place, (3.1 * number, 0.0, 0.0)), 1.0 / size)
        bent = nodes.vector("SINE", nodes.vector("CROSS_PRODUCT", near, (1.9, 2.3, -2.6)))  # not round
        near = nodes.vector("ADD", near, nodes.vector("SCALE", bent, 0.14))
        cell, border = (nodes.cells("3D", near, 0.9, feature) for feature in ("F1", "DISTANCE_TO_EDGE"))
        first, second, third = (nodes.part(cell.outputs["Color"], axis) for axis in range(3))
        away = cell.outputs["Distance"]
        if rough is not None:
            away = nodes.math("ADD", away, nodes.about(rough, _UNEVEN / size))
        radius = nodes.math("MULTIPLY_ADD", second, *_RADII)
        whole = nodes.math("DIVIDE", away, radius)  # 1 on the outline
        # rounded off where they come near the border of their cell, so that none is cut there
        ends = nodes.math("MULTIPLY_ADD", border.outputs["Distance"], *_ROUND)
        away = nodes.math("SMOOTH_MAX", whole, ends, _ROUNDED)
        here = nodes.math("MULTIPLY", nodes.math("LESS_THAN", third, look.packing), free)
        inside = nodes.math("MULTIPLY", nodes.ramp(away, 0.92, 1.0, 1.0, 0.0), here)
        seam = nodes.math("MULTIPLY", nodes.ramp(away, 0.96, _SEAM, 1.0, 0.0), here)
        tone = nodes.math("MULTIPLY", nodes.about(first, 2.0 * look.clasts), inside)
        between = nodes.math("MULTIPLY", nodes.math("SUBTRACT", inside, seam), _SHADE)
        texture.tones.append(nodes.math("ADD", tone, between))
        texture.pale.append(nodes.math("MULTIPLY", nodes.about(second, 1.6 * look.clasts), inside))
        hue = nodes.math("MULTIPLY", nodes.math("SUBTRACT", third, 0.5), 0.5)
        texture.hues.append(nodes.math("MULTIPLY_ADD", hue, inside, 0.5))
        dome = nodes.math("SUBTRACT", 1.0, nodes.math("MULTIPLY", away, away))
        dome = nodes.math("MULTIPLY", nodes.math("MAXIMUM", dome, 0.0), radius)
        texture.heights.append(nodes.math("MULTIPLY", nodes.math("MULTIPLY", dome, _DOME * size), here))
        here = nodes.math("SUBTRACT", 1.0, nodes.math("MAXIMUM", inside, seam))
        free = nodes.math("MULTIPLY", free, here)
    return free


def _add_crumbs(nodes, place, look, free, texture):
    """Crumbs that lie close together between pebbles, large ones and small ones on them, with dark gaps.
    free: of pebbles."""
    for size in _CRUMBS:
        size *= look.crumb_size
        cell = nodes.cells("3D", nodes.vector("SCALE", place, 1.0 / size), 1.0, "F1")
        deep = nodes.math("MULTIPLY", cell.outputs["Distance"], cell.outputs["Distance"])
        deep = nodes.math("MULTIPLY", deep, free)
        texture.heights.append(nodes.math("MULTIPLY", deep, -look.crumbs * size))
        tone = nodes.about(nodes.part(cell.outputs["Color"], 0), 0.25 * look.crumbs)
        texture.tones.append(nodes.math("MULTIPLY", tone, free))
        texture.tones.append(nodes.math("MULTIPLY", deep, -0.2 * look.crumbs))


def _add_litter(nodes, place, look, texture):
    """Dry stalks on ground, one at some of the places, in any direction."""
    cell, away = _around_middle(nodes, nodes.vector("SCALE", place, 1.0 / _LITTER), 0.6)
    first, second = (nodes.part(cell.outputs["Color"], axis) for axis in range(2))
    turn = nodes.math("MULTIPLY", first, 2.0 * math.pi)
    sides = nodes.math("COSINE", turn), nodes.math("SINE", turn)
    parts = [nodes.part(away, axis) for axis in range(2)]
    along = nodes.total([nodes.math("MULTIPLY", *pair) for pair in zip(parts, sides, strict=True)])
    across = nodes.math("MULTIPLY", parts[1], sides[0])
    across = nodes.math("SUBTRACT", across, nodes.math("MULTIPLY", parts[0], sides[1]))
    bent = nodes.math("MULTIPLY", nodes.math("MULTIPLY", along, along), nodes.about(second, 0.8))
    across = nodes.math("ABSOLUTE", nodes.math("ADD", across, bent))
    long, wide = _STALK
    here = nodes.math("LESS_THAN", nodes.part(cell.outputs["Color"], 2), look.litter)
    here = nodes.math("MULTIPLY", here, nodes.attribute("is_top"))
    here = nodes.math("MULTIPLY", here, nodes.ramp(nodes.math("ABSOLUTE", along), 0.9 * long, long, 1.0, 0.0))
    stalk = nodes.math("MULTIPLY", here, nodes.ramp(across, wide, 1.4 * wide, 1.0, 0.0))
    texture.tones.append(nodes.math("MULTIPLY", stalk, nodes.math("MULTIPLY_ADD", second, 0.3, 0.25)))
    texture.pale.append(nodes.math("MULTIPLY", stalk, 0.35))
    texture.heights.append(nodes.math("MULTIPLY", stalk, wide * _LITTER))


def _around_middle(nodes, place, randomness):
    """A plane cell texture, and where in its cell a place is, from the middle."""
    place = nodes.vector("MULTIPLY", place, (1.0, 1.0, 0.0))
    cell = nodes.cells("2D", place, randomness, "F1")
    return cell, nodes.vector("SUBTRACT", place, cell.outputs["Position"])


def _add_blades(nodes, place, texture):
    """Tufts of grass seen from above on faces that are ground: blades that go outward from the middle of each
    and bend to one side. They have no height: Eevee's shaders would take ten times as long to compile."""
    highest, tint = 0.0, 0.0
    for number, (size, around) in enumerate(_TUFTS):
        near = nodes.vector("SCALE", nodes.vector("ADD", place, (0.7 * number, 0.0, 0.0)), 1.0 / size)
        bent = nodes.vector("SINE", nodes.vector("CROSS_PRODUCT", near, (0.0, 0.0, 2.7)))
        near = nodes.vector("ADD", near, nodes.vector("SCALE", bent, 0.3))
        cell, away = _around_middle(nodes, near, 1.0)
        randoms = [nodes.part(cell.outputs["Color"], axis) for axis in range(3)]
        # on a circle in the noise, so that there is no seam; farther out it is another place
        circle = nodes.vector("SCALE", nodes.vector("NORMALIZE", away), around)
        turned = nodes.vector("CROSS_PRODUCT", away, (0.0, 0.0, _BENT_BLADES * around))
        turned = nodes.vector("SCALE", turned, nodes.math("SUBTRACT", randoms[2], 0.5))
        circle = nodes.vector("ADD", nodes.vector("ADD", circle, turned), away)
        circle = nodes.vector("ADD", circle, nodes.vector("SCALE", cell.outputs["Color"], 50.0))
        blade = nodes.ramp(nodes.noise(circle, 1.0, 1.0, "2D"), 0.35, 0.65, 0.0, 1.0)
        far = cell.outputs["Distance"]
        reach = nodes.math(
            "MULTIPLY", nodes.ramp(far, 0.0, 0.35, 0.2, 1.0), nodes.ramp(far, 0.3, 0.8, 1.0, 0.1)
        )
        reach = nodes.math("MULTIPLY", reach, nodes.math("MULTIPLY_ADD", randoms[1], 0.5, 0.6))
        highest = nodes.math("MAXIMUM", highest, nodes.math("MULTIPLY", blade, reach))
        tint = nodes.math("MULTIPLY_ADD", randoms[0], 1.0 / len(_TUFTS), tint)
    is_top = nodes.attribute("is_top")
    highest = nodes.math("MULTIPLY", highest, is_top)
    tone = nodes.math("MULTIPLY", nodes.math("SUBTRACT", highest, 0.6), 0.85)
    texture.tones.append(nodes.math("MULTIPLY", tone, is_top))
    texture.hues.append(tint)


def _brown_below(nodes, color):
    """The color on faces that are ground, on others one of earth."""
    earth = nodes.new("ShaderNodeHueSaturation")
    earth.inputs["Hue"].default_value = 0.36
    earth.inputs["Saturation"].default_value = 0.9
    earth.inputs["Value"].default_value = 0.55
    nodes.link(color, earth.inputs["Color"])
    nodes.link(nodes.math("SUBTRACT", 1.0, nodes.attribute("is_top")), earth.inputs["Fac"])
    return earth.outputs["Color"]


class _Nodes(Nodes):
    """Makes nodes of a material."""

    def cells(self, dimensions, place, randomness, feature):
        node = self.new("ShaderNodeTexVoronoi")
        node.voronoi_dimensions, node.feature = dimensions, feature
        self.link(place, node.inputs["W" if dimensions == "1D" else "Vector"])
        node.inputs["Scale"].default_value = 1.0
        node.inputs["Randomness"].default_value = randomness
        return node

    def attribute(self, name):
        group = next((node for node in self.tree.nodes if node.type == "GROUP"), None)
        if group is None:
            group = self.new("ShaderNodeGroup")
            group.node_tree = group_once("ShaderNodeTree", "RealModel Bedding", GROUP, _fill_bedding_group)
        return group.outputs[name]


def _fill_bedding_group(group):
    """The attributes of the bedding."""
    nodes = Nodes(group)
    output = nodes.new("NodeGroupOutput")
    for name in meshes.BEDDING:
        versions.add_group_socket(group, name, "NodeSocketFloat", is_output=True)
        node = nodes.new("ShaderNodeAttribute")
        node.attribute_name = meshes.PREFIX + name
        nodes.link(node.outputs["Fac"], output.inputs[name])


def suiting(row):
    """The key in LOOKS of the look that suits a row of the library by its names."""
    return look_of(row.rock, row.name)


def of_row(row):
    """The key in LOOKS of the look of a row of the library; None where it has none."""
    if row.look == AUTO:
        return suiting(row)
    return None if row.look == library_rows.NO_LOOK else row.look


def diagonal(scene):
    """The size of the model, which textures are made for."""
    return float(np.linalg.norm(np.subtract(*explosion.bounds(scene)))) or 1.0


def follow(scene, rows=None, anew=False):
    """Updates the looks of materials from the library's rows, all or some, where they have changed. anew:
    also those that have not."""
    for row in scene.realmodel.library if rows is None else rows:
        look = of_row(row)
        if look is None:
            continue
        texture = [float(row.look_scale), float(row.look_seed)]
        for material in library_rows.scene_materials(scene, row.id):
            same = material.get(KEY) == look and list(material.get(TEXTURE, ())) == texture
            if (same and not anew) or material.library is not None or material.node_tree is None:
                continue
            apply(material, look, row.look_scale, row.look_seed + row.id, diagonal(scene))
            material[TEXTURE] = texture
