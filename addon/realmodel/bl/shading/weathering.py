# SPDX-License-Identifier: GPL-3.0-or-later
"""Weathering for pictures: a geometry nodes modifier on blocks. Their meshes do not change.

Exposed faces (ground and walls) are worn: edges are rounded, soft rock recedes behind hard rock, layer by
layer, and grass and scree lie on level ground, with tufts and stones where wanted. The nodes use the
attributes of blocks (core.display.bedding). Noise is of coordinates of the model, so neighbors of the same
hardness still meet.
"""

import math
from dataclasses import dataclass

import bpy
import numpy as np

from ...core.project.looks import DEFAULT, LOOKS
from ..host import versions
from ..host.nodes import Nodes, group_once
from ..objects import filled_beds, materials, meshes
from ..project import library_rows
from . import edge_wear, looks, scatter

NAME = "Weathering"
KEY = "realmodel_weathering"  # on the group: its version; on a material: its cover
HARDNESS = "realmodel_hardness"  # on a block: the hardness of its modifier from the library
_VERSION = 6
_STEPS = 5  # of smoothing
_ALONE = 0.2  # the share of the faces around a triangle that have its cover, itself counted, if no other has
COVERS = {"Grass": ("GRASS", "#6f8743"), "Scree": ("GRAVEL", "#9b9286")}
# texture units (looks) at 1
_UNITS = {"Strength": 0.8, "Noise Scale": 3.0, "Bed Thickness": 1.6, "Edge Wear": 1.0}
FINEST = 6

# name: kind of the socket, default, lowest, highest
_INPUTS = {
    "Strength": ("NodeSocketFloatDistance", 0.5, 0.0),
    "Edge Rounding": ("NodeSocketFloatFactor", 0.6, 0.0, 1.0),
    "Edge Wear": ("NodeSocketFloatDistance", 0.0, 0.0),
    "Noise Scale": ("NodeSocketFloatDistance", 2.0, 1e-6),
    "Bed Thickness": ("NodeSocketFloatDistance", 0.5, 1e-6),
    "Seed": ("NodeSocketInt", 0, 0),
    "Hardness": ("NodeSocketFloatFactor", 0.5, 0.0, 1.0),
    "Grass Slope": ("NodeSocketFloatAngle", math.radians(28.0), 0.0, math.pi / 2),
    "Scree Slope": ("NodeSocketFloatAngle", math.radians(40.0), 0.0, math.pi / 2),
    "Grass": ("NodeSocketMaterial",),
    "Scree": ("NodeSocketMaterial",),
    "Detail": ("NodeSocketInt", 2, 0, FINEST),
    "Plants and Stones": ("NodeSocketFloat", 0.0, 0.0),
    "Scatter Size": ("NodeSocketFloatDistance", 1.0, 1e-6),
    scatter.TUFT: ("NodeSocketObject",),
    scatter.STONE: ("NodeSocketObject",),
}


def hardness_of(row):
    """The hardness from 0 to 1 of a row of the library, else that of its look."""
    if row is None:
        return 0.5
    return row.hardness or LOOKS[looks.of_row(row) or looks.suiting(row)].hardness


def modifier_of(item):
    """The modifier of a block that weathers it, or None."""
    modifiers = (m for m in item.modifiers if m.type == "NODES" and m.node_group and KEY in m.node_group)
    return next(modifiers, None)


@dataclass(frozen=True)
class Weathering:
    """strength, noise: 1 suits the model. grass, scree: radians, the steepest ground that has them, 0: none.
    detail: the number of subdivisions of polygons; without any, edges do not move. plants: how many tufts and
    stones, 1 suits; 0: none. wear: how far materials show edges worn, 1 suits; 0: not."""

    strength: float
    rounding: float
    noise: float
    seed: int
    grass: float
    scree: float
    detail: int
    plants: float = 0.0
    wear: float = 0.0


def put_on(scene, items, given):
    """Adds Weathering to blocks, and to beds of filled meshes, or changes its settings."""
    group, of_model = _group(), looks.diagonal(scene) / looks.UNITS
    for obj in items:
        is_bed = filled_beds.BED in obj
        unit = filled_beds.size(obj) / looks.UNITS if is_bed else of_model
        modifier = modifier_of(obj)
        if modifier is None:
            modifier = obj.modifiers.new(NAME, "NODES")
            modifier.show_in_editmode = False
        modifier.node_group = group
        for name, value in _values(given, unit).items():
            versions.set_group_input(modifier, name, value)
        if is_bed:
            versions.set_group_input(modifier, "Hardness", hardness_of_bed(obj))
        obj.pop(HARDNESS, None)
    for material in _rocks(items):
        edge_wear.put_on(material)
    follow(scene)


def _rocks(items):
    """The materials of blocks and beds."""
    return {slot.material for obj in items for slot in obj.material_slots if slot.material is not None}


def _values(values, unit):
    """The inputs of the modifier. unit: a texture unit."""
    return {
        "Strength": values.strength * _UNITS["Strength"] * unit,
        "Edge Rounding": values.rounding,
        "Noise Scale": values.noise * _UNITS["Noise Scale"] * unit,
        "Bed Thickness": values.noise * _UNITS["Bed Thickness"] * unit,
        "Edge Wear": values.wear * _UNITS["Edge Wear"] * unit,
        "Seed": values.seed,
        "Grass Slope": values.grass,
        "Scree Slope": values.scree,
        "Detail": values.detail,
        "Plants and Stones": values.plants,
        "Scatter Size": unit,
        **{name: _cover(name, unit) for name in COVERS},
        scatter.TUFT: scatter.item(scatter.TUFT) if values.plants else None,
        scatter.STONE: scatter.item(scatter.STONE) if values.plants else None,
    }


def hardness_of_bed(obj):
    """That of the look of its rock."""
    names = (slot.material.get(looks.KEY) for slot in obj.material_slots if slot.material)
    return LOOKS[next((look for look in names if look in LOOKS), DEFAULT)].hardness


def take_off(items):
    """Removes the weathering of blocks, and worn edges from materials that no weathered block has."""
    for obj in items:
        modifier = modifier_of(obj)
        if modifier is not None:
            obj.modifiers.remove(modifier)
            obj.pop(HARDNESS, None)
    worn = (obj for obj in bpy.data.objects if obj.type == "MESH" and modifier_of(obj) is not None)
    for material in _rocks(items) - _rocks(worn):
        edge_wear.take_off(material)


def follow(scene):
    """Updates the hardness of weathered blocks where that of their properties has changed; values set by hand
    in the modifier stay otherwise."""
    for block in scene.realmodel.results:
        obj = block.object
        if obj is None or obj.library is not None or (modifier := modifier_of(obj)) is None:
            continue
        hardness = float(np.float32(hardness_of(library_rows.find(scene, block.property_id))))
        if obj.get(HARDNESS) != hardness:
            versions.set_group_input(modifier, "Hardness", hardness)
            obj[HARDNESS] = hardness


def _cover(name, unit):
    """The material of grass or scree."""
    candidates = (m for m in bpy.data.materials if m.get(KEY) == name and m.library is None)
    material = next(candidates, None)
    if material is None:
        look, color = COVERS[name]
        material = bpy.data.materials.new(name)
        material.use_nodes = True
        material[KEY] = name
        materials.set_color(material, color)
        looks.apply(material, look, 1.0, 0, unit * looks.UNITS)
    return material


def _group():
    """The node group, of this version of the add-on."""
    return group_once("GeometryNodeTree", NAME, KEY, _fill, _VERSION)


def _fill(group):
    versions.add_group_socket(group, "Geometry", "NodeSocketGeometry", is_output=True)
    versions.add_group_socket(group, "Geometry", "NodeSocketGeometry")
    for name, (kind, *values) in _INPUTS.items():
        versions.add_group_socket(group, name, kind, values)
    nodes = _Nodes(group)
    inputs = nodes.new("NodeGroupInput").outputs
    geometry = nodes.to("GeometryNodeSubdivideMesh", inputs["Geometry"], Level=inputs["Detail"])
    is_top = nodes.named("is_top", "BOOLEAN")
    surface = nodes.named("surface", "INT")
    exposed = nodes.math("MAXIMUM", is_top, nodes.math("COMPARE", surface, -1.0, 0.5))
    at_points = nodes.on("FACE", exposed)  # at a point the share of its faces
    worn = nodes.math("GREATER_THAN", at_points, 0.0)
    position = nodes.of("GeometryNodeInputPosition", "Position")
    part = nodes.to("GeometryNodeSeparateGeometry", geometry, Selection=exposed)
    part.node.domain = "FACE"
    depth = nodes.math("MULTIPLY", _depth(nodes, inputs, position), inputs["Strength"])
    inward = nodes.vector("SCALE", nodes.of("GeometryNodeInputNormal", "Normal"), -1.0)
    # Each vertex goes at least as far inwards as the exposed point beside it: else faces between blocks would
    # stick out of the walls that fell back.
    place, inward, depth = nodes.nearest(part, position, (position, inward, depth))
    reached = nodes.vector("DOT_PRODUCT", nodes.vector("SUBTRACT", position, place), inward)
    push = nodes.math("MAXIMUM", nodes.math("SUBTRACT", depth, reached), 0.0)
    geometry = nodes.to("GeometryNodeSetPosition", geometry, Offset=nodes.vector("SCALE", inward, push))
    is_fine = nodes.math("GREATER_THAN", inputs["Detail"], 0.5)  # coarse polygons would lose their shape
    rounding = nodes.math("MULTIPLY", inputs["Edge Rounding"], is_fine)
    for _ in range(_STEPS):  # each vertex towards the middle of its neighbors
        middle = nodes.on("POINT", nodes.on("EDGE", position))
        shift = nodes.vector("SCALE", nodes.vector("SUBTRACT", middle, position), rounding)
        geometry = nodes.to("GeometryNodeSetPosition", geometry, Selection=worn, Offset=shift)
    geometry = nodes.to("GeometryNodeSetShadeSmooth", geometry, Selection=is_fine)
    geometry = nodes.stored(geometry, edge_wear.ATTRIBUTE, inputs["Edge Wear"])
    geometry = _covered(nodes, inputs, geometry, is_top, position)
    nodes.link(geometry, nodes.new("NodeGroupOutput").inputs["Geometry"])


def _depth(nodes, inputs, position):
    """The depth of erosion, about 0 to 2: larger and uneven in soft rock; by layers in bedded rock."""
    soft = nodes.math("SUBTRACT", 1.0, inputs["Hardness"])
    place = nodes.vector("SCALE", position, nodes.math("DIVIDE", 1.0, inputs["Noise Scale"]))
    shift = nodes.new("ShaderNodeCombineXYZ")
    for axis, step in enumerate((12.7, 7.3, 31.1)):
        nodes.link(nodes.math("MULTIPLY", inputs["Seed"], step), shift.inputs[axis])
    place = nodes.vector("ADD", place, shift.outputs[0])
    uneven = nodes.ramp(nodes.noise(place, 1.0, 4.0), 0.25, 0.75, 0.0, 1.0)
    above = nodes.math("MULTIPLY", nodes.named("height", "FLOAT"), nodes.named("thickness", "FLOAT"))
    above = nodes.math("DIVIDE", above, inputs["Bed Thickness"])
    above = nodes.math("ADD", above, nodes.math("MULTIPLY", nodes.named("age", "FLOAT"), 7.3))
    beds = nodes.new("ShaderNodeCombineXYZ")
    nodes.link(nodes.math("ADD", above, shift.outputs[0]), beds.inputs[2])
    layered = nodes.ramp(nodes.noise(beds.outputs[0], 1.0, 1.0), 0.35, 0.65, 0.0, 1.0)
    level = nodes.math("MULTIPLY", soft, 1.2)
    rest = nodes.math("ADD", nodes.math("MULTIPLY", uneven, 0.5), nodes.math("MULTIPLY", layered, 0.4))
    return nodes.math("ADD", level, nodes.math("MULTIPLY", rest, nodes.math("ADD", soft, 0.35)))


def _covered(nodes, inputs, geometry, is_top, position):
    """Grass, and scree on steeper ground, with a ragged border; tufts and stones on them."""
    place = nodes.vector("SCALE", position, nodes.math("DIVIDE", 1.0, inputs["Noise Scale"]))
    ragged = nodes.about(nodes.noise(place, 1.3, 4.0), 0.5)
    up = nodes.part(nodes.turned(nodes.of("GeometryNodeInputNormal", "Normal")), 2)
    slope = nodes.math("ADD", nodes.math("ARCCOSINE", up), ragged)
    scattered = []
    for name, thing in (("Scree", scatter.STONE), ("Grass", scatter.TUFT)):
        steepest = inputs[f"{name} Slope"]
        here = nodes.math("MULTIPLY", nodes.math("LESS_THAN", slope, steepest), is_top)
        here = nodes.math("MULTIPLY", here, nodes.math("GREATER_THAN", steepest, 0.0))
        around = nodes.on("FACE", nodes.on("POINT", nodes.on("FACE", here)))
        here = nodes.math("MULTIPLY", here, nodes.math("GREATER_THAN", around, _ALONE))
        geometry = nodes.to("GeometryNodeSetMaterial", geometry, Selection=here, Material=inputs[name])
        scattered.append((thing, here))
    joined = nodes.new("GeometryNodeJoinGeometry")
    for thing, here in scattered:
        nodes.link(scatter.on(nodes, inputs, geometry, thing, here), joined.inputs[0])
    nodes.link(geometry, joined.inputs[0])
    return joined.outputs[0]


class _Nodes(Nodes):
    """Makes nodes of a geometry node tree."""

    def to(self, kind, geometry, **given):
        """The geometry that a node makes of another. given: its inputs by their names."""
        node = self.new(kind)
        self.link(geometry, next(s for s in node.inputs if s.type == "GEOMETRY"))
        for name, value in given.items():
            self.link(value, node.inputs[name])
        return next(s for s in node.outputs if s.type == "GEOMETRY")

    def named(self, name, kind):
        """An attribute of blocks."""
        node = self.new("GeometryNodeInputNamedAttribute")
        node.data_type = kind
        node.inputs["Name"].default_value = meshes.PREFIX + name
        return _of_type(node.outputs, {"BOOLEAN": "BOOLEAN", "INT": "INT", "FLOAT": "VALUE"}[kind])

    def stored(self, geometry, name, value):
        """The geometry with a number for each of its points."""
        node = self.new("GeometryNodeStoreNamedAttribute")
        node.data_type, node.domain = "FLOAT", "POINT"
        node.inputs["Name"].default_value = name
        self.link(geometry, next(s for s in node.inputs if s.type == "GEOMETRY"))
        self.link(value, _of_type(node.inputs, "VALUE"))
        return next(s for s in node.outputs if s.type == "GEOMETRY")

    def nearest(self, geometry, place, values):
        """The values of fields at the point of a geometry that is nearest to a position."""
        nearest_node = self.new("GeometryNodeSampleNearest")
        self.link(geometry, next(s for s in nearest_node.inputs if s.type == "GEOMETRY"))
        self.link(place, nearest_node.inputs["Sample Position"])
        sampled = []
        for value in values:
            node = self.new("GeometryNodeSampleIndex")
            kind = "VECTOR" if value.type == "VECTOR" else "VALUE"
            node.data_type = "FLOAT_VECTOR" if kind == "VECTOR" else "FLOAT"
            self.link(geometry, next(s for s in node.inputs if s.type == "GEOMETRY"))
            self.link(value, _of_type(node.inputs, kind))
            self.link(nearest_node.outputs["Index"], node.inputs["Index"])
            sampled.append(_of_type(node.outputs, kind))
        return sampled

    def rotation(self):
        """The rotation of the object, as Euler angles."""
        node = self.new("GeometryNodeObjectInfo")
        self.link(self.of("GeometryNodeSelfObject", 0), node.inputs["Object"])
        return node.outputs["Rotation"]

    def turned(self, vector):
        """A vector of the object's coordinates as the world has it, but for the object's scale."""
        node = self.new("ShaderNodeVectorRotate")
        node.rotation_type = "EULER_XYZ"
        self.link(vector, node.inputs["Vector"])
        self.link(self.rotation(), node.inputs["Rotation"])
        return node.outputs[0]

    def upright(self, instances):
        """Instances turned in their places as if the object were not: the inverse of its rotation, axis by
        axis, as Euler angles have an order."""
        for axis in (2, 1, 0):
            angles = self.new("ShaderNodeCombineXYZ")
            angle = self.math("MULTIPLY", self.part(self.rotation(), axis), -1.0)
            self.link(angle, angles.inputs[axis])
            node = self.new("GeometryNodeRotateInstances")
            for name, value in (
                ("Instances", instances),
                ("Rotation", angles.outputs[0]),
                ("Pivot Point", self.of("GeometryNodeInputPosition", "Position")),
                ("Local Space", False),
            ):
                self.link(value, node.inputs[name])
            instances = node.outputs[0]
        return instances

    def random(self, low, high, number):
        """A random number, or vector, for each point. number: another one has other values."""
        node = self.new("FunctionNodeRandomValue")
        kind = "VECTOR" if isinstance(low, tuple) else "VALUE"
        node.data_type = "FLOAT_VECTOR" if kind == "VECTOR" else "FLOAT"
        for name, value in (("Min", low), ("Max", high)):
            self.link(value, next(s for s in node.inputs if s.name == name and s.enabled))
        self.link(number, node.inputs["Seed"])
        return _of_type(node.outputs, kind)

    def on(self, domain, value):
        """A number or a vector as a domain has it."""
        node = self.new("GeometryNodeFieldOnDomain")
        node.domain = domain
        node.data_type = "FLOAT_VECTOR" if value.type == "VECTOR" else "FLOAT"
        kind = "VECTOR" if value.type == "VECTOR" else "VALUE"
        self.link(value, _of_type(node.inputs, kind))
        return _of_type(node.outputs, kind)


def _of_type(sockets, kind):
    """The socket of a type: before 5.0 nodes have one for each, of which one is in use."""
    return next(s for s in sockets if s.type == kind and s.enabled and s.name != "Exists")
