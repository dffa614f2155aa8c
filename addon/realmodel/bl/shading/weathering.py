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
from ..host import caches, versions
from ..host.geometry_nodes import GeometryNodes
from ..host.nodes import group_once, modifier_with
from ..objects import filled_beds, materials, meshes, placing
from ..project import library_rows
from . import edge_wear, looks, scatter

NAME = "Weathering"
KEY = "realmodel_weathering"  # on the group: its version; on a material: its cover
HARDNESS = "realmodel_hardness"  # on a block: the hardness of its modifier from the library
_VERSION = 9
_STEPS = 5  # of smoothing
# attributes while the nodes work: where a vertex was and where it goes, how a face faced, how far one may go
_BEFORE, _INWARD, _FACING, _MOST = (f"realmodel_{name}" for name in ("before", "inward", "facing", "most"))
_FAR = 1e9  # no limit
_MERGED = 0.06  # of the bed thickness: vertices that are nearer to each other become one
_EVEN = 4  # passes that even out how far vertices may go
_ROOM = 0.4  # of the way through the rock: how far a vertex may go
_LEAST = 0.05  # of the cosine of the angle by which a face turns
# The passes that turn faces back: the share of erosion that is left there, and how far around, in strengths
_EBBING = tuple(
    zip((0.6, 0.4, 0.2) + (0.0,) * 7, (0.4, 0.6, 0.8, 0.8, 1.0, 1.0, 1.4, 2.0, 4.0, 16.0), strict=True)
)
_OWN = 0.6  # how much beds of a rock differ in hardness
_MARGIN = 0.1  # of the strength: how much farther faces between blocks go than exposed ones
_SKIRT = -3.0  # the surface of faces that are none of the block
_ALONE = 0.2  # the share of the faces around a triangle that have its cover, itself counted, if no other has
COVERS = {"Grass": ("GRASS", "#6f8743"), "Scree": ("GRAVEL", "#9b9286")}
# mean thicknesses of beds at 1
_UNITS = {"Strength": 0.5, "Deepest": 1.0, "Noise Scale": 1.5, "Bed Thickness": 0.4, "Edge Wear": 0.1}
_THICKEST = 1 / 20  # of the diagonal: what counts at most as the thickness of a bed
_BYTES = 300  # of memory for a polygon
_BANDS = (1.0, 2.0)  # of Near: beyond each of these distances from the camera there is one subdivision less
FINEST = 6

# name: kind of the socket, default, lowest, highest
_INPUTS = {
    "Strength": ("NodeSocketFloatDistance", 0.5, 0.0),
    "Deepest": ("NodeSocketFloatDistance", 1.0, 1e-6),
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
    "Camera": ("NodeSocketObject",),
    "Near": ("NodeSocketFloatDistance", _FAR, 0.0),
    "Plants and Stones": ("NodeSocketFloat", 0.0, 0.0),
    "Scatter Size": ("NodeSocketFloatDistance", 1.0, 1e-6),
    scatter.TUFT: ("NodeSocketObject",),
    scatter.STONE: ("NodeSocketCollection",),
}


def hardness_of(row):
    """The hardness from 0 to 1 of a row of the library, else that of its look."""
    if row is None:
        return 0.5
    return row.hardness or LOOKS[looks.of_row(row) or looks.suiting(row)].hardness


def modifier_of(item):
    """The modifier of a block that weathers it, or None."""
    return modifier_with(item, KEY)


@dataclass(frozen=True)
class Weathering:
    """strength, noise: 1 suits the model. grass, scree: radians, the steepest ground that has them, 0: none.
    detail: the number of subdivisions of polygons; without any, edges do not move. plants: how many tufts and
    stones, 1 suits; 0: none. wear: how far materials show edges worn, 1 suits; 0: not. near: how far from the
    scene camera all subdivisions are made; at twice the distance there is one less."""

    strength: float
    rounding: float
    noise: float
    seed: int
    grass: float
    scree: float
    detail: int
    plants: float = 0.0
    wear: float = 0.0
    near: float = _FAR


def put_on(scene, items, given):
    """Adds Weathering to blocks, and to beds of filled meshes, or changes its settings."""
    groups = {}
    for obj in items:
        groups.setdefault(tuple(filled_beds.together(obj)) if filled_beds.BED in obj else None, []).append(
            obj
        )
    for together, members in groups.items():
        if together is None:
            together = [row.object for row in scene.realmodel.results if row.object is not None]
            size = looks.diagonal(scene)
        else:
            size = filled_beds.size(members[0])
        values = _values(given, _thickness(together, size), size / looks.UNITS)
        for obj in members:
            scale = placing.mean_scale(np.array(obj.matrix_world)) or 1.0
            near = {"Camera": scene.camera if given.near < _FAR else None, "Near": given.near / scale}
            _set(obj, values | near)
    for material in _rocks(items):
        edge_wear.put_on(material)
    follow(scene)


def _set(obj, values):
    """Sets the inputs of the modifier of a block, which is added if there is none."""
    modifier = modifier_of(obj)
    if modifier is None:
        modifier = obj.modifiers.new(NAME, "NODES")
        modifier.show_in_editmode = False
    modifier.node_group = _group()
    for name, value in values.items():
        versions.set_group_input(modifier, name, value)
    if any(slot.material and slot.material.get(looks.KEY) == "WATER" for slot in obj.material_slots):
        for name in ("Strength", "Grass Slope", "Scree Slope"):
            versions.set_group_input(modifier, name, 0.0)
    if filled_beds.BED in obj:
        versions.set_group_input(modifier, "Hardness", hardness_of_bed(obj))
    obj.pop(HARDNESS, None)


def _exposed(obj):
    """(C,) bool: the corners of a block on its exposed polygons."""
    mesh, names = obj.data, (meshes.PREFIX + "is_top", meshes.FACE_SURFACE, meshes.PREFIX + "thickness")
    if not all(name in mesh.attributes for name in names):  # without polygons, or of an earlier version
        return np.zeros(len(mesh.loops), bool)
    is_top, surface = (meshes.values(mesh, *each) for each in zip(names[:2], (bool, np.int32), strict=True))
    return np.repeat(is_top | (surface == -1), np.diff(versions.polygon_starts(mesh), append=len(mesh.loops)))


def _thickness(items, size):
    """The mean thickness of beds where blocks are exposed. size: the diagonal of all."""
    found = np.zeros(0, np.float32)
    for obj in items:
        if (exposed := _exposed(obj)).any():
            values = meshes.values(obj.data, meshes.PREFIX + "thickness", np.float32)
            found = np.append(found, values[exposed])
    found = found[found > 0.0]
    return min(float(found.mean(dtype=np.float64)) if len(found) else math.inf, _THICKEST * size)


def cost(items, wanted, most, camera=None):
    """The number of subdivisions, at most the one wanted, that makes no more exposed polygons than `most`,
    how many polygons and bytes of memory these are, about, and how far from a camera all are made."""
    near, less, corners = _FAR, np.zeros(1, int), np.array([sum(map(_exposed_corners, items))])
    if camera is not None and corners[0]:
        away = np.concatenate([_distances(obj, camera) for obj in items])
        near = 2.0 * float(away.min())
        less, corners = np.unique(np.searchsorted(np.array(_BANDS) * near, away), return_counts=True)
    polygons = sum(len(obj.data.polygons) for obj in items)
    detail = wanted
    while True:
        level = np.maximum(detail - less, min(detail, 1))
        # a corner makes a polygon, and without any four are one
        exposed = int((corners * 4.0 ** (level - 1)).sum())
        if exposed <= most or not detail:
            return detail, exposed, (exposed + polygons) * _BYTES, near
        detail -= 1


_known = caches.new(most=200)  # corners of a mesh that are exposed


def _exposed_corners(obj):
    """How many corners of a block are exposed; a panel asks at each redraw."""
    key = obj.data.name_full, len(obj.data.loops)
    if key not in _known:
        _known[key] = int(np.count_nonzero(_exposed(obj)))
    return _known[key]


def _distances(obj, camera):
    """(N,) of the exposed corners of a block from a camera."""
    at = meshes.mesh_coordinates(obj.data)[versions.corner_vertices(obj.data)[_exposed(obj)]]
    matrix = np.array(obj.matrix_world)
    return np.linalg.norm(at @ matrix[:3, :3].T + matrix[:3, 3] - camera.matrix_world.translation, axis=1)


def cost_text(faces, size):
    """A number of faces, and bytes, for people."""
    count = f"{faces / 1e6:.1f} million" if faces >= 1e5 else f"{faces:,}"
    return f"{count} faces, about {size / 1e9:.1f} GB"


def _rocks(items):
    """The materials of blocks and beds."""
    return {slot.material for obj in items for slot in obj.material_slots if slot.material is not None}


def _values(values, thickness, unit):
    """The inputs of the modifier. thickness: of beds; unit: a texture unit."""
    return {
        "Strength": values.strength * _UNITS["Strength"] * thickness,
        "Deepest": _UNITS["Deepest"] * thickness,
        "Edge Rounding": values.rounding,
        "Noise Scale": values.noise * _UNITS["Noise Scale"] * thickness,
        "Bed Thickness": values.noise * _UNITS["Bed Thickness"] * thickness,
        "Edge Wear": values.wear * _UNITS["Edge Wear"] * thickness,
        "Seed": values.seed,
        "Grass Slope": values.grass,
        "Scree Slope": values.scree,
        "Detail": values.detail,
        "Plants and Stones": values.plants,
        "Scatter Size": unit,
        **{name: _cover(name, unit) for name in COVERS},
        scatter.TUFT: scatter.tuft() if values.plants else None,
        scatter.STONE: scatter.stones() if values.plants else None,
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
    nodes = GeometryNodes(group)
    inputs = nodes.new("NodeGroupInput").outputs
    is_top = nodes.named(meshes.PREFIX + "is_top", "BOOLEAN")
    surface = nodes.named(meshes.PREFIX + "surface", "INT")
    exposed = nodes.math("MAXIMUM", is_top, nodes.math("COMPARE", surface, -1.0, 0.5))
    seen, hidden = nodes.separated(inputs["Geometry"], exposed)
    before, geometry = _worn(nodes, inputs, seen)
    hidden = _pushed(nodes, inputs, hidden, before, geometry)
    geometry = nodes.to("GeometryNodeSetShadeSmooth", geometry, Selection=_is_fine(nodes, inputs))
    geometry, hidden = (
        nodes.stored(part, edge_wear.ATTRIBUTE, inputs["Edge Wear"]) for part in (geometry, hidden)
    )
    geometry, scattered = _covered(nodes, inputs, geometry, is_top)
    joined = nodes.new("GeometryNodeJoinGeometry")
    for part in (*scattered, hidden, _with_skirt(nodes, inputs, geometry, surface)):
        nodes.link(part, joined.inputs[0])
    geometry = joined.outputs[0]
    for name in (_BEFORE, _INWARD, _FACING, _MOST):
        geometry = nodes.to("GeometryNodeRemoveAttribute", geometry, Name=name)
    nodes.link(geometry, nodes.new("NodeGroupOutput").inputs["Geometry"])


def _is_fine(nodes, inputs):
    """Whether polygons are subdivided; coarse ones would lose their shape."""
    return nodes.math("GREATER_THAN", inputs["Detail"], 0.5)


def _length(nodes, inputs):
    """About how deep erosion is."""
    return nodes.math("MINIMUM", inputs["Strength"], inputs["Deepest"])


def _worn(nodes, inputs, seen):
    """The exposed faces, subdivided, before and after erosion. Vertices move along the normals of the mesh as
    it was: those of subdivided polygons would be flat within each polygon and break at its edges."""
    position = nodes.of("GeometryNodeInputPosition", "Position")
    normal = nodes.of("GeometryNodeInputNormal", "Normal")
    inward = nodes.vector("SCALE", normal, -1.0)
    distance = nodes.math(
        "MULTIPLY", inputs["Bed Thickness"], nodes.math("MULTIPLY", _is_fine(nodes, inputs), _MERGED)
    )
    seen = nodes.to("GeometryNodeMergeByDistance", seen, Distance=distance)
    seen = nodes.stored(
        seen, _MOST, nodes.math("MINIMUM", _room(nodes, seen, position, inward), inputs["Deepest"])
    )
    for _ in range(_EVEN):  # a single vertex that may not go far would become a spike
        seen = nodes.stored(seen, _MOST, nodes.on("POINT", nodes.on("EDGE", nodes.named(_MOST, "FLOAT"))))
    seen = nodes.stored(seen, _INWARD, inward)
    geometry = _subdivided(nodes, inputs, seen, position)
    geometry = nodes.stored(geometry, _BEFORE, position)
    geometry = before = nodes.stored(geometry, _FACING, normal, "FACE")
    depth = nodes.math("MULTIPLY", _depth(nodes, inputs, position), inputs["Strength"])
    deepest = inputs["Deepest"]
    depth = nodes.math("MULTIPLY", nodes.math("TANH", nodes.math("DIVIDE", depth, deepest)), deepest)
    depth = nodes.math("MINIMUM", depth, nodes.named(_MOST, "FLOAT"))
    shift = nodes.vector("SCALE", nodes.vector("NORMALIZE", nodes.named(_INWARD, "FLOAT_VECTOR")), depth)
    geometry = nodes.to("GeometryNodeSetPosition", geometry, Offset=shift)
    rounding = nodes.math("MULTIPLY", inputs["Edge Rounding"], _is_fine(nodes, inputs))
    # Along its border alone the exposed part keeps meeting its neighbors, which have the same border.
    weight = nodes.math("MULTIPLY_ADD", _is_border(nodes), 1e3, 1.0)
    weighted = nodes.vector("SCALE", nodes.on("EDGE", position), weight)
    whole = nodes.math("DIVIDE", 1.0, nodes.on("POINT", nodes.on("EDGE", weight)))
    middle = nodes.vector("SCALE", nodes.on("POINT", nodes.on("EDGE", weighted)), whole)
    shift = nodes.vector("SCALE", nodes.vector("SUBTRACT", middle, position), rounding)
    for _ in range(_STEPS):  # each vertex towards the middle of its neighbors
        geometry = nodes.to("GeometryNodeSetPosition", geometry, Offset=shift)
    return before, _turned_back(nodes, inputs, geometry, position, normal)


def _subdivided(nodes, inputs, seen, position):
    """The geometry, less subdivided far from the camera. It has borders there, from which skirts hang."""
    camera = nodes.new("GeometryNodeObjectInfo")
    camera.transform_space = "RELATIVE"
    nodes.link(inputs["Camera"], camera.inputs["Object"])
    way = nodes.vector("SUBTRACT", position, camera.outputs["Location"])
    away = nodes.math("SQRT", nodes.vector("DOT_PRODUCT", way, way))
    joined = nodes.new("GeometryNodeJoinGeometry")
    for less, reach in enumerate((*_BANDS, None)):
        here = seen
        if reach:
            is_here = nodes.math("LESS_THAN", away, nodes.math("MULTIPLY", inputs["Near"], reach))
            here, seen = nodes.separated(seen, is_here)
        level = nodes.math("SUBTRACT", inputs["Detail"], float(less))
        level = nodes.math("MAXIMUM", level, nodes.math("MINIMUM", inputs["Detail"], 1.0))
        nodes.link(nodes.to("GeometryNodeSubdivideMesh", here, Level=level), joined.inputs[0])
    return joined.outputs[0]


def _turned_back(nodes, inputs, geometry, position, normal):
    """The eroded geometry without faces that are turned over. Around them erosion becomes less, at first a
    little and nearby, at last wholly and so widely that the change cannot turn any."""
    facing, before = (nodes.named(name, "FLOAT_VECTOR") for name in (_FACING, _BEFORE))
    least = nodes.math("MULTIPLY", nodes.vector("DOT_PRODUCT", facing, facing), _LEAST)
    is_over = nodes.on("FACE", nodes.math("LESS_THAN", nodes.vector("DOT_PRODUCT", normal, facing), least))
    back = nodes.vector("SUBTRACT", before, position)
    strength = _length(nodes, inputs)
    for kept, reach in _EBBING:
        over, _ = nodes.separated(geometry, is_over)
        node = nodes.new("GeometryNodeProximity")
        nodes.link(nodes.to("GeometryNodeSetPosition", over, Position=before), node.inputs[0])
        nodes.link(before, node.inputs["Source Position"])
        count = nodes.new("GeometryNodeAttributeDomainSize")
        nodes.link(over, count.inputs[0])
        gone = nodes.ramp(node.outputs["Distance"], 0.0, 1.0, 1.0 - kept, 0.0)
        nodes.link(nodes.math("MULTIPLY", strength, reach), gone.node.inputs["From Max"])
        gone = nodes.math("MULTIPLY", gone, nodes.math("MINIMUM", count.outputs["Face Count"], 1.0))
        geometry = nodes.to("GeometryNodeSetPosition", geometry, Offset=nodes.vector("SCALE", back, gone))
    return geometry


def _room(nodes, seen, position, inward):
    """How far a point of the surface may go: a share of the way through the rock to the other side."""
    ray = nodes.new("GeometryNodeRaycast")
    nodes.link(seen, next(s for s in ray.inputs if s.type == "GEOMETRY"))
    for name, value in (("Source Position", position), ("Ray Direction", inward), ("Ray Length", _FAR)):
        nodes.link(value, ray.inputs[name])
    leaves = nodes.math("GREATER_THAN", nodes.vector("DOT_PRODUCT", ray.outputs["Hit Normal"], inward), 0.0)
    is_near = nodes.math("MULTIPLY", ray.outputs["Is Hit"], leaves)
    free = nodes.math("MULTIPLY", nodes.math("SUBTRACT", 1.0, is_near), _FAR)
    return nodes.math("MULTIPLY_ADD", ray.outputs["Hit Distance"], _ROOM, free)


def _is_border(nodes):
    """Whether an edge is one of a single face."""
    return nodes.math("COMPARE", nodes.of("GeometryNodeInputMeshEdgeNeighbors", 0), 1.0, 0.5)


def _pushed(nodes, inputs, hidden, before, geometry):
    """The faces between blocks, each vertex at least as far inwards as the exposed point beside it: else they
    would stick out of the walls that fell back. A margin is for the roughness of what is subdivided."""
    position = nodes.of("GeometryNodeInputPosition", "Position")
    taken = [nodes.named(name, "FLOAT_VECTOR") for name in (_BEFORE, _INWARD)]
    index = nodes.nearest(before, position)
    place, inward, worn = (nodes.at(geometry, index, value, "FLOAT_VECTOR") for value in (*taken, position))
    inward = nodes.vector("NORMALIZE", inward)
    depth = nodes.vector("DOT_PRODUCT", nodes.vector("SUBTRACT", worn, place), inward)
    depth = nodes.math(
        "MULTIPLY_ADD",
        nodes.math("GREATER_THAN", depth, 0.0),
        nodes.math("MULTIPLY", _length(nodes, inputs), _MARGIN),
        depth,
    )
    reached = nodes.vector("DOT_PRODUCT", nodes.vector("SUBTRACT", position, place), inward)
    push = nodes.math("MAXIMUM", nodes.math("SUBTRACT", depth, reached), 0.0)
    return nodes.to("GeometryNodeSetPosition", hidden, Offset=nodes.vector("SCALE", inward, push))


def _with_skirt(nodes, inputs, geometry, surface):
    """The exposed faces with a strip inwards from their border: the side of a ledge over rock that is worn
    farther."""
    node = nodes.new("GeometryNodeExtrudeMesh")
    node.mode = "EDGES"
    inward = nodes.vector("NORMALIZE", nodes.named(_INWARD, "FLOAT_VECTOR"))
    reach = nodes.math("MINIMUM", _length(nodes, inputs), nodes.named(_MOST, "FLOAT"))
    border = nodes.math("MULTIPLY", _is_border(nodes), nodes.math("GREATER_THAN", inputs["Strength"], 0.0))
    for name, value in (("Selection", border), ("Offset", inward), ("Offset Scale", reach)):
        nodes.link(value, node.inputs[name])
    nodes.link(geometry, node.inputs["Mesh"])
    side = node.outputs["Side"]
    outer = nodes.math("SUBTRACT", 1.0, side)
    is_top = nodes.math("MULTIPLY", nodes.named(meshes.PREFIX + "is_top", "BOOLEAN"), outer)
    surface = nodes.math("MULTIPLY_ADD", nodes.math("SUBTRACT", surface, _SKIRT), outer, _SKIRT)
    geometry = nodes.stored(node.outputs["Mesh"], meshes.PREFIX + "is_top", is_top, "FACE", "BOOLEAN")
    geometry = nodes.stored(geometry, meshes.FACE_SURFACE, surface, "FACE", "INT")
    return nodes.to("GeometryNodeSetMaterialIndex", geometry, **{"Selection": side, "Material Index": 0})


def _depth(nodes, inputs, position):
    """The depth of erosion, about 0 to 2: larger and uneven in soft rock; of each bed its own, and by layers
    within it."""
    age = nodes.named(meshes.PREFIX + "age", "FLOAT")
    own = nodes.new("ShaderNodeTexWhiteNoise")
    own.noise_dimensions = "1D"
    nodes.link(nodes.math("MULTIPLY_ADD", inputs["Seed"], 31.7, age), own.inputs["W"])
    soft = nodes.math("SUBTRACT", nodes.about(own.outputs["Value"], _OWN), inputs["Hardness"])
    soft = nodes.math("MAXIMUM", nodes.math("ADD", soft, 1.0), 0.0)
    place = nodes.vector("SCALE", position, nodes.math("DIVIDE", 1.0, inputs["Noise Scale"]))
    shift = nodes.new("ShaderNodeCombineXYZ")
    for axis, step in enumerate((12.7, 7.3, 31.1)):
        nodes.link(nodes.math("MULTIPLY", inputs["Seed"], step), shift.inputs[axis])
    place = nodes.vector("ADD", place, shift.outputs[0])
    uneven = nodes.ramp(nodes.noise(place, 1.0, 4.0), 0.25, 0.75, 0.0, 1.0)
    above = nodes.math(
        "MULTIPLY",
        nodes.named(meshes.PREFIX + "height", "FLOAT"),
        nodes.named(meshes.PREFIX + "thickness", "FLOAT"),
    )
    above = nodes.math("DIVIDE", above, inputs["Bed Thickness"])
    above = nodes.math("ADD", above, nodes.math("MULTIPLY", age, 7.3))
    beds = nodes.new("ShaderNodeCombineXYZ")
    nodes.link(nodes.math("ADD", above, shift.outputs[0]), beds.inputs[2])
    layered = nodes.ramp(nodes.noise(beds.outputs[0], 1.0, 1.0), 0.35, 0.65, 0.0, 1.0)
    level = nodes.math("MULTIPLY", soft, 1.2)
    rest = nodes.math("ADD", nodes.math("MULTIPLY", uneven, 0.5), nodes.math("MULTIPLY", layered, 0.4))
    return nodes.math("ADD", level, nodes.math("MULTIPLY", rest, nodes.math("ADD", soft, 0.35)))


def _covered(nodes, inputs, geometry, is_top):
    """The geometry with grass, and scree on steeper ground, with a ragged border, and instances of tufts and
    stones on them."""
    position = nodes.of("GeometryNodeInputPosition", "Position")
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
    return geometry, [scatter.on(nodes, inputs, geometry, thing, here) for thing, here in scattered]
