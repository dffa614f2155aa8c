# SPDX-License-Identifier: GPL-3.0-or-later
"""Plants and stones on weathered ground: what is scattered, and the nodes that scatter it.

Tufts of grass and stones are meshes made here, one unit high and wide. They are in no collection, so that the
scene shows their instances alone.
"""

import bpy
import numpy as np

from ..host.nodes import Nodes
from ..objects import materials

KEY = "realmodel_scatter"  # on an object: what it is
TUFT, STONE = "Grass Tuft", "Stone"
_BLADES, _LEAN, _WIDTH = 70, 0.9, 0.016  # of a tuft; how far blades lean, of their height; half their width
_PER_UNIT = {TUFT: 6.0, STONE: 0.25}  # on a square texture unit, at density 1
_IN_VIEWPORT = {TUFT: 0.25, STONE: 1.0}  # the share of them that viewports show, to stay fast
_HIGH = {TUFT: (0.16, 0.42), STONE: (0.05, 0.3)}  # texture units: least and greatest size
_GRASS = "#7d9440"


def item(name, material=None):
    """The object of tufts or stones, made if the file has none. material: of a stone."""
    known = (found for found in bpy.data.objects if found.get(KEY) == name and found.library is None)
    found = next(known, None)
    if found is None:
        vertices, faces = _tuft() if name == TUFT else _stone()
        mesh = bpy.data.meshes.new(name)
        mesh.from_pydata(vertices.tolist(), [], faces)
        mesh.materials.append(_grass() if name == TUFT else material)
        if name == STONE:
            mesh.polygons.foreach_set("use_smooth", np.ones(len(mesh.polygons), bool))
        found = bpy.data.objects.new(name, mesh)
        found[KEY] = name
    return found


def _grass():
    """Blades from fresh to dry, each tuft of its own, darker at the foot and lighter at the tip."""
    material = materials.new_material("Grass Blades", materials.NO_PROPERTY, _GRASS)
    del material[materials.KEY]
    nodes = Nodes(material.node_tree)
    shader = next(node for node in material.node_tree.nodes if node.type == "BSDF_PRINCIPLED")
    own = nodes.of("ShaderNodeObjectInfo", "Random")
    place = nodes.of("ShaderNodeTexCoord", "Object")
    blade = nodes.noise(place, 9.0, 0.0)
    tint = nodes.new("ShaderNodeHueSaturation")
    tint.inputs["Color"].default_value = shader.inputs["Base Color"].default_value
    dry = nodes.math("MULTIPLY", nodes.math("ADD", own, nodes.about(blade, 1.6)), 0.09)
    nodes.link(nodes.math("SUBTRACT", 0.52, dry), tint.inputs["Hue"])
    high = nodes.ramp(nodes.part(place, 2), 0.0, 0.9, 0.45, 1.25)
    nodes.link(nodes.math("MULTIPLY_ADD", blade, 0.5, high), tint.inputs["Value"])
    nodes.link(tint.outputs["Color"], shader.inputs["Base Color"])
    return material


def _tuft():
    """Blades that lean outward from one place and bend, tapering in three steps to a point."""
    random = np.random.default_rng(4)
    vertices, faces = [], []
    for azimuth in 2.0 * np.pi * (np.arange(_BLADES) + random.random(_BLADES)) / _BLADES:
        out = np.array([np.cos(azimuth), np.sin(azimuth), 0.0])
        turned = azimuth + random.normal(0.0, 0.6)
        across = np.array([-np.sin(turned), np.cos(turned), 0.0]) * _WIDTH * (0.6 + 0.8 * random.random())
        foot = out * 0.6 * random.random() ** 0.7
        high, lean = 0.3 + 0.7 * random.random() ** 1.5, _LEAN * random.random()
        first = len(vertices)
        for share, width in ((0.0, 0.8), (0.4, 1.0), (0.75, 0.65)):
            place = foot + out * lean * high * share**2 + (0.0, 0.0, high * (share - 0.3 * lean * share**3))
            vertices += [place - width * across, place + width * across]
        vertices.append(foot + out * lean * high + (0.0, 0.0, high * (1.0 - 0.3 * lean)))
        faces += [(first + k, first + k + 1, first + k + 3, first + k + 2) for k in (0, 2)]
        faces.append((first + 4, first + 5, first + 6))
    return np.array(vertices), faces


def _stone():
    """A convex pebble with flat sides: a sphere whose far parts are cut off by some planes."""
    random = np.random.default_rng(8)
    rings, around = 7, 12
    polar = np.pi * np.arange(1, rings) / rings
    azimuth = 2.0 * np.pi * np.arange(around) / around
    places = [(0.0, 0.0, 1.0)]
    places += [(np.sin(a) * np.cos(b), np.sin(a) * np.sin(b), np.cos(a)) for a in polar for b in azimuth]
    places = np.array([*places, (0.0, 0.0, -1.0)])
    normals = random.normal(size=(11, 3))
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    reach = (places @ normals.T / (0.72 + 0.2 * random.random(11))).max(axis=1)
    places /= np.maximum(reach, 1.0)[:, None]
    places *= (0.5, 0.38, 0.3)
    last = len(places) - 1
    faces = [(0, 1 + n, 1 + (n + 1) % around) for n in range(around)]
    for ring in range(rings - 2):
        first = 1 + ring * around
        for n in range(around):
            right = (n + 1) % around
            faces.append((first + n, first + around + n, first + around + right, first + right))
    low = last - around
    faces += [(last, low + (n + 1) % around, low + n) for n in range(around)]
    return places, faces


def on(nodes, given, geometry, name, here):
    """The geometry with instances on its faces. given: inputs of the group: Plants and Stones, Scatter Size,
    Seed, and the object of this name. here: (field) where they are."""
    size = given["Scatter Size"]
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
    what = nodes.new("GeometryNodeObjectInfo")
    nodes.link(given[name], what.inputs["Object"])
    low, high = _HIGH[name]
    placed = nodes.new("GeometryNodeInstanceOnPoints")
    nodes.link(made.outputs["Points"], placed.inputs["Points"])
    nodes.link(what.outputs["Geometry"], placed.inputs["Instance"])
    turn = 0.25 if name == TUFT else 6.28
    nodes.link(nodes.random((-turn, -turn, 0.0), (turn, turn, 6.28), 1), placed.inputs["Rotation"])
    scale = nodes.math("MULTIPLY", nodes.random(low, high, 2), size)
    nodes.link(scale, placed.inputs["Scale"])
    return nodes.upright(placed.outputs["Instances"])
