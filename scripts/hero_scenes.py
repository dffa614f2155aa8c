# SPDX-License-Identifier: GPL-3.0-or-later
"""The hero scenes, each a function that fills an empty scene. Lengths are meters, Y is north. Needs
Blender."""

import math
from itertools import pairwise

import bpy
import hero_parts as parts
import hero_rocks as rocks
import numpy as np
from hero_parts import ramp_of, rough, rough3
from realmodel.bl.objects.materials import set_color


def _eroded_strata(name, mesh, preset, values, erosion, faces, views):
    """An object with strata, eroded, with so many faces left of it."""
    item = rocks.strata(name, mesh, preset, **values)
    rocks.erode(item, **erosion)
    rocks.thinned(item, faces, views)
    return item


def _weathered(item, dust, scale, colors=None, **how):
    """Weathers the rocks of an object. colors: {number of a rock: "#rrggbb"}."""
    for slot, material in rocks.rock_slots(item).items():
        copy = material.copy()
        if colors and slot in colors:
            set_color(copy, colors[slot])
        parts.weather(copy, dust, scale, **(how | ({"streaks": 0.0} if slot == "Scree" else {})))
        rocks.set_rock(item, slot, copy)


def canyon(scene):
    """A river canyon at evening, seen from its rim."""
    eye, sun = (0.0, 0.0, 328.4), (226.0, 14.0)
    high, spacing = 322.0, 10.0
    x, y = np.arange(-900.0, 960.1, spacing), np.arange(60.0, 1800.1, spacing)
    across, along = np.meshgrid(x, y, indexing="ij")
    river = ((-60, 0), (-70, 250), (120, 560), (60, 860), (-160, 1120), (-60, 1400), (260, 1500), (960, 1380))
    in_river = _from_line(across, along, river) < 18.0
    start = high + 5.0 * rough(across, along, 240.0, 3) + 2.5 * rough(across, along, 40.0, 5)
    start = np.where(in_river, 4.0, start)
    land = rocks.drained(
        start, spacing, lambda z: np.full(len(z), 0.0115), 20, 1.25, fixed=in_river, power=0.42, steepest=0.95
    )
    values = {"beds": 26, "variation": 0.95, "dip": math.radians(0.4), "seed": 4}
    draft = rocks.strata("Draft", parts.block(x, y, land, -20.0), "CANYON", **values)
    levels, hardness = rocks.beds_in(draft)
    bpy.data.objects.remove(draft)
    land = land + 9.0 * rough(across, along, 90.0, 9) * ramp_of(high - 4.0, high - 30.0, land)
    land = rocks.stepped(levels, hardness, 8.0, high - 6.0, land)
    walls = _eroded_strata(
        "Canyon",
        parts.block(x, y, land, -20.0),
        "CANYON",
        values,
        {"faces": 320_000, "strength": 0.75, "joints": 1.2, "roughness": 0.9, "scree": 0.18, "stones": 0.0},
        41_000,
        [eye],
    )
    _weathered(walls, "#8f6248", 14.0, streaks=0.55, ledge=0.72, cover=0.8, tint="#7d3b26")

    def rim_inside(u, v, w):
        edge = 13.0 + 4.0 * rough(u, 0 * v, 11.0, 4) + 6.0 * np.exp(-(((u + 7.5) / 5.0) ** 2))
        edge = edge - 7.0 * np.exp(-(((u - 4.0) / 8.0) ** 2)) + 5.0 * np.exp(-(((u - 22.0) / 7.0) ** 2))
        rise = 327.0 + 0.9 * rough(u, v, 14.0, 8) - 0.1 * v
        slab = np.floor((rise + 0.8 * rough(u, v, 5.0, 2)) / 0.55) * 0.55
        return np.minimum(edge - v + 0.9 * rough3(u, v, w, 4.0, 6), slab - w)

    rim = _eroded_strata(
        "Rim",
        rocks.solid((-34.0, -4.0, 315.0), (36.0, 26.0, 330.0), 0.8, rim_inside),
        "CANYON",
        {"beds": 12, "variation": 0.8, "dip": 0.0, "seed": 2},
        {"faces": 130_000, "strength": 0.5, "joints": 1.3, "roughness": 0.7, "scree": 0.0, "stones": 0.0},
        24_000,
        [eye],
    )
    _weathered(rim, "#a8714e", 1.6, streaks=0.3, ledge=0.8, cover=0.6, tint="#8a4a33")

    sand = parts.rock("Plateau", "#8d6a4c", "SAND", 30.0)
    parts.weather(sand, "#4d4a30", 60.0, streaks=0.0, ledge=0.6, cover=0.75)
    far_x = np.linspace(-60_000.0, 60_000.0, 120)
    far_y = np.concatenate([[1786.0, 1790.0, 1850.0], np.geomspace(2000.0, 60_000.0, 60)])
    u, v = np.meshgrid(far_x, far_y, indexing="ij")
    mesa = ramp_of(0.12, 0.2, rough(u, v, 9_000.0, 4, 4)) * 260.0 * ramp_of(5_000.0, 9_000.0, v)
    mesa += ramp_of(0.0, 0.5, rough(u, v, 16_000.0, 14, 6)) * 1_500.0 * ramp_of(30_000.0, 48_000.0, v)
    far = high - 7.0 + mesa + 4.0 * rough(u, v, 700.0, 2)
    far[:, 0] = 0.0  # its edge stands on the ground behind the canyon
    parts.surface("Far Plateau", far_x, far_y, far, sand)
    for name, side in (
        ("East Plateau", np.array([954.0, 958.0, 4_000.0])),
        ("West Plateau", np.array([-894.0, -898.0, -4_000.0])),
    ):
        flat = np.array([[0.0, 0.0], [high - 5.0] * 2, [high - 5.0] * 2])
        parts.surface(
            name,
            side[::-1] if side[0] < 0 else side,
            np.array([400.0, 1_900.0]),
            flat[::-1] if side[0] < 0 else flat,
            sand,
        )

    water = parts.water_material("#3f5a4a", 14.0, 0.15)
    parts.surface("River", np.array([-900.0, 960.0]), np.array([60.0, 1800.0]), np.full((2, 2), 9.0), water)
    _canyon_details(rim, walls)
    parts.sunlight(scene, sun, "#ffb070", 5.2, 4_000.0)
    parts.sky(scene, sun, "#5f86b8", "#e3c3a6", "#ffcf94", 0.85, 0.55, 2)
    parts.air(7_500.0, "#c9a58e", 0.75)
    parts.camera(scene, eye, (4.0, 100.0, 315.0), 28.0)


def _from_line(x, y, line):
    """The distance of places from a line through points that is rounded off."""
    line = np.array(line, float)
    for _ in range(3):
        cut = np.stack([0.75 * line[:-1] + 0.25 * line[1:], 0.25 * line[:-1] + 0.75 * line[1:]], 1).reshape(
            -1, 2
        )
        line = np.concatenate([line[:1], cut, line[-1:]])
    least = np.full(x.shape, np.inf)
    for (ax, ay), (bx, by) in pairwise(line):
        length = max((bx - ax) ** 2 + (by - ay) ** 2, 1e-9)
        share = np.clip(((x - ax) * (bx - ax) + (y - ay) * (by - ay)) / length, 0.0, 1.0)
        least = np.minimum(least, np.hypot(x - ax - share * (bx - ax), y - ay - share * (by - ay)))
    return least


def _canyon_details(rim, walls):
    random = np.random.default_rng(5)
    ground = parts.Ground(rim)
    stone = parts.rock("Stone", "#a86a4a", "SANDSTONE", 0.6)
    stones = [parts.hidden_source(f"Stone {n}", parts.boulder_mesh(f"Stone {n}", n, stone)) for n in range(3)]
    places = np.column_stack([random.uniform(-26, 26, 420), random.uniform(2.5, 20.0, 420)])
    parts.strewn("Stones", stones, ground, places, 0.08 + 1.1 * random.random(420) ** 7, 2)
    leaf, bark = parts.leaf_material("Juniper Leaves", "#4a5a2c"), parts.painted("Bark", "#5b4a3c")
    tree = parts.hidden_source(
        "Juniper", parts.tree_mesh("Juniper", 3.6, 4, leaf, bark, 1700, 0.5, 0.26, 0.14)
    )
    bush = parts.hidden_source(
        "Sage",
        parts.leaves_mesh("Sage", 0.5, 420, 0.05, 6, parts.leaf_material("Sage Leaves", "#7d8262"), 0.7, 0.2),
    )
    places = np.array([[8.6, 14.0], [-8.2, 13.8], [5.2, 7.4]])
    parts.strewn(
        "Junipers", [tree], ground, places, np.array([1.0, 0.85, 0.4]), 1, sink=1.0, steepest=0.0, tilt=0.05
    )
    places = np.column_stack([random.uniform(-24, 24, 40), random.uniform(4.0, 18.0, 40)])
    parts.strewn("Sage", [bush], ground, places, random.uniform(0.6, 1.3, 40), 7, steepest=0.8, tilt=0.1)
    parts.figure("Figure", ground.spot(-4.2, 14.0, 0.8, 0.4), math.radians(160.0))
    shrubs = np.column_stack([random.uniform(-900, 900, 2600), random.uniform(150, 1850, 2600)])
    parts.strewn(
        "Shrubs",
        [bush],
        parts.Ground(walls),
        shrubs,
        random.uniform(3.0, 8.0, 2600),
        8,
        steepest=0.86,
        tilt=0.05,
    )


def sea_cliff(scene):
    """A chalk cliff with an arch and stacks before it, seen from the beach."""
    eye, sun = (-2.0, 0.0, 4.2), (152.0, 18.0)

    def coast(u, v):
        """How far places in plan are behind the edge of the cliff, about, meters."""
        edge = -34.0 + 11.0 * np.sin(v / 41.0 + 0.8) + 9.0 * rough(0.4 * u, v, 30.0, 5) - 0.03 * v
        head = 116.0 * np.exp(-(((v - 335.0) / 36.0) ** 2))
        return edge + head - u

    def stack(u, v, w, x0, y0, radius, top):
        shape = radius * (1.0 - 0.32 * np.clip(w / top, 0.0, 1.0)) - np.hypot(u - x0, 0.8 * (v - y0))
        return np.minimum(shape, top + 0.25 * (u - x0) - w)

    def inside(u, v, w):
        bumps = 2.4 * rough3(u, v, 0.5 * w, 17.0, 7) + 2.2 * rough(u, v, 9.0, 3)
        wall = coast(u, v) + bumps - 0.1 * w + 2.0 * ramp_of(5.0, 0.0, w)
        top = 62.0 + 5.0 * rough(u, v, 60.0, 2) - 0.09 * np.maximum(u + 20.0, 0.0) - 0.02 * np.abs(v - 120.0)
        body = np.minimum(wall, top - w)
        hole = (np.hypot((u - 53.0 - 0.12 * w) / 10.0, (w - 2.0) / 31.0) - 1.0) * 10.0 + bumps
        body = np.minimum(body, hole)
        body = np.maximum(body, stack(u, v, w, 101.0, 345.0, 14.0, 47.0) + bumps)
        body = np.maximum(body, stack(u, v, w, 132.0, 372.0, 8.0, 33.0) + 0.7 * bumps)
        return np.maximum(body, stack(u, v, w, 30.0, 236.0, 6.0, 13.0) + 0.7 * bumps)

    rock = _eroded_strata(
        "Sea Cliff",
        rocks.solid((-120.0, -40.0, -6.0), (160.0, 470.0, 76.0), 3.2, inside),
        "CLIFF",
        {
            "beds": 34,
            "variation": 0.85,
            "dip": math.radians(2.5),
            "dip_direction": math.radians(20),
            "seed": 6,
        },
        {"faces": 320_000, "strength": 0.7, "joints": 1.7, "roughness": 1.3, "scree": 0.6, "stones": 0.0},
        66_000,
        [eye],
    )
    chalk = {1: "#ece8dc", 2: "#c9c4b6", 3: "#e2dccb", 4: "#d9cfb4", 5: "#8f8a82", "Scree": "#e0dac9"}
    how = {"streaks": 0.45, "ledge": 0.72, "tint": "#c4b898", "above": 38.0, "wet": (5.0, "#4b4a36")}
    _weathered(rock, "#5c6b33", 6.0, chalk, **how)

    def shore(u, v):
        """The elevation of the beach."""
        line = 9.0 + 4.0 * np.sin(v / 31.0) + 2.0 * np.sin(v / 9.0) - 0.035 * v
        return (
            np.minimum(2.6, 0.11 * (line - u))
            + 0.22 * rough(u, v, 7.0, 4)
            + 0.25 * np.sin(0.9 * (line - u)) * ramp_of(0.0, 6.0, line - u) * 0.5
        )

    x, y = (
        np.arange(-60.0, 40.1, 2.0),
        np.concatenate([np.arange(-30.0, 60.0, 2.0), np.arange(60.0, 330.1, 5.0)]),
    )
    across, along = np.meshgrid(x, y, indexing="ij")
    gravel = parts.rock("Shingle", "#bdb29d", "GRAVEL", 0.5)
    parts.weather(gravel, "#8d826c", 5.0, streaks=0.0, cover=0.25, wet=(1.2, "#4d463a"))
    beach = parts.surface("Beach", x, y, shore(across, along), gravel)

    x = np.concatenate([np.arange(-60.0, 200.0, 4.0), np.geomspace(205.0, 40_000.0, 16)])
    y = np.concatenate([np.arange(-30.0, 480.0, 6.0), np.geomspace(490.0, 40_000.0, 16)])
    across, along = np.meshgrid(x, y, indexing="ij")
    swell = (
        0.16
        * np.sin(0.32 * across + 0.1 * along + 2.0 * rough(across, along, 60.0, 3))
        * ramp_of(400.0, 60.0, np.hypot(across, along))
    )
    water = parts.water_material("#1f5663", 9.0, 0.5, 0.08, "#e9efee")
    sea = parts.surface("Sea", x, y, swell, water)
    near = np.exp(-np.maximum(-shore(across, along), 0.0) / 0.28) * ramp_of(340.0, 300.0, along)
    at_sea = inside(across[:, :, None], along[:, :, None], np.full((1, 1, 1), 1.0))[:, :, 0]
    near = np.maximum(near, np.exp(np.minimum(at_sea, 0.0) / 3.5))
    breaker = np.exp(-(((across - 15.0 - 4.0 * np.sin(along / 31.0) + 0.035 * along) / 1.6) ** 2)) * ramp_of(
        300.0, 200.0, along
    )
    sea.data.attributes.new("foam", "FLOAT", "POINT").data.foreach_set(
        "value", np.maximum(near, 0.8 * breaker).astype(np.float32).ravel()
    )
    _beach_details(rock, beach)
    parts.sunlight(scene, sun, "#ffe6c2", 4.4, 900.0)
    parts.sky(scene, sun, "#4f87c4", "#cfdbe0", "#ffe9c4", 0.95, 0.75, 5)
    parts.air(5_000.0, "#c3d2da", 0.8)
    parts.camera(scene, eye, (22.0, 130.0, 15.0), 29.0)


def _beach_details(rock, beach):
    random = np.random.default_rng(9)
    ground = parts.Ground(beach)
    chalk = parts.rock("Chalk Block", "#d8d1bd", "LIMESTONE", 0.7)
    parts.weather(chalk, "#7c7a55", 1.5, streaks=0.0, cover=0.3, wet=(1.0, "#59543f"))
    flint = parts.rock("Flint", "#6f6a63", "LIMESTONE", 0.3)
    blocks = [
        parts.hidden_source(f"Block {n}", parts.boulder_mesh(f"Block {n}", n + 20, chalk)) for n in range(3)
    ]
    pebbles = [
        parts.hidden_source(f"Pebble {n}", parts.boulder_mesh(f"Pebble {n}", n + 40, m, 2))
        for n, m in enumerate((chalk, flint, flint))
    ]
    places = np.column_stack([random.uniform(-12, 9, 1500), 2.0 + 26.0 * random.random(1500) ** 1.6])
    parts.strewn("Pebbles", pebbles, ground, places, 0.05 + 0.22 * random.random(1500) ** 3, 3, tilt=0.5)
    along = random.uniform(8.0, 290.0, 260)
    away = -24.0 + 11.0 * np.sin(along / 41.0 + 0.8) + 15.0 * random.random(260) ** 2
    parts.strewn(
        "Fallen Blocks",
        blocks,
        ground,
        np.column_stack([away, along]),
        0.35 + 3.6 * random.random(260) ** 4,
        4,
    )
    parts.figure("Figure", ground.spot(-4.5, 27.0, 0.5), math.radians(200.0), "#c8452f")
    leaf, bark = parts.leaf_material("Thorn Leaves", "#46572c"), parts.painted("Bark", "#4c4034")
    tree = parts.hidden_source("Thorn", parts.tree_mesh("Thorn", 5.0, 2, leaf, bark, 700, 0.5, 0.35, 0.2))
    top = parts.Ground(rock)
    places = np.column_stack([random.uniform(-95, -32, 90), random.uniform(60, 420, 90)])
    parts.strewn(
        "Thorns", [tree], top, places, random.uniform(0.5, 1.3, 90), 5, sink=1.0, steepest=0.85, tilt=0.05
    )


def arch(scene):
    """A free-standing arch on slickrock, late in the day."""
    eye, sun = (-9.0, -4.0, 2.6), (238.0, 13.0)

    def floor(u, v):
        bowl = (
            0.018 * np.maximum(v - 30.0, 0.0) ** 1.5 * ramp_of(90.0, 60.0, v)
            - 0.004 * np.maximum(-u - 10.0, 0.0) ** 2
        )
        swell = 1.5 * rough(u, v, 26.0, 4, 3) + 0.4 * rough(u + 0.8 * v, 0.3 * v, 6.0, 8, 3)
        swell = 0.35 * swell + 0.65 * np.floor((swell + 0.25 * rough(u, v, 7.0, 9)) / 0.6) * 0.6
        return (
            swell
            + 0.02 * v
            - 0.5 * bowl
            - 16.0 * ramp_of(52.0, 74.0, v + 0.2 * u + 4.0 * rough(u, v, 17.0, 6))
        )

    def inside(u, v, w):
        ground = floor(u, v)
        y0, foot = 42.0 + 0.12 * u, 0.6
        x0, height = u - 1.5, w - foot
        bent = x0 + 0.10 * height - 0.004 * height * height
        ratio = np.hypot(bent / 8.4, height / 14.6)
        away = np.abs(ratio - 1.0) * ratio / np.maximum(np.hypot(bent / 8.4**2, height / 14.6**2), 1e-6)
        thick = 1.75 + 0.55 * ramp_of(10.0, 15.0, height) + 1.6 * ramp_of(6.0, 0.0, height)
        thick = thick - 0.75 * np.exp(-(((bent + 8.0) / 2.5) ** 2) - ((height - 7.5) / 1.6) ** 2)
        thick = (
            thick
            + 0.5 * np.exp(-(((height - 4.5) / 1.2) ** 2))
            + 0.9 * ramp_of(2.0, 7.0, bent) * ramp_of(12.0, 5.0, height)
        )
        ring = thick + 0.55 * rough3(u, v, w, 3.6, 3) - np.hypot(away, 0.85 * (v - y0))
        knob = (
            5.2
            - np.hypot(np.hypot((u + 24.0) / 1.7, (v - 55.0) / 1.4), (w - 0.5) / 1.5)
            + rough3(u, v, w, 5.0, 8)
        )
        fin = (
            7.0
            - np.hypot(np.hypot((u - 31.0) / 1.5, (v - 62.0) / 2.2), (w - 1.0) / 2.0)
            + 1.4 * rough3(u, v, w, 6.0, 4)
        )
        return np.maximum(np.maximum(ring, np.maximum(knob, fin)), ground - w)

    rock = _eroded_strata(
        "Arch",
        rocks.solid((-52.0, -14.0, -17.0), (52.0, 80.0, 19.5), 0.75, inside),
        "CANYON",
        {"beds": 22, "variation": 0.8, "dip": math.radians(1.5), "seed": 11},
        {"faces": 340_000, "strength": 0.27, "joints": 0.6, "roughness": 1.0, "scree": 0.0, "stones": 0.0},
        112_000,
        [eye, (-6.0, 0.0, 9.0)],
    )
    red = {1: "#b8623a", 2: "#c4784a", 3: "#8f4630", 4: "#cf9a6c", 5: "#bd6e43"}
    _weathered(rock, "#c08456", 3.0, red, streaks=0.65, ledge=0.86, cover=0.55, tint="#9c4f31")
    sand = parts.rock("Valley", "#a5714c", "SAND", 20.0)
    parts.weather(sand, "#5d5636", 90.0, streaks=0.25, ledge=0.86, cover=0.7)
    x = np.linspace(-30_000.0, 30_000.0, 150)
    y = np.concatenate([np.linspace(72.0, 900.0, 14), np.geomspace(1_000.0, 36_000.0, 90)])
    u, v = np.meshgrid(x, y, indexing="ij")
    mesa = np.floor(ramp_of(-0.02, 0.16, rough(u, v, 5_000.0, 12, 5)) * 3.2) / 3.2
    land = -60.0 - 0.02 * np.minimum(v, 4_000.0) + 150.0 * mesa * ramp_of(1_200.0, 3_000.0, v)
    land += ramp_of(-0.15, 0.5, rough(u, v, 9_000.0, 3, 6)) * 2_300.0 * ramp_of(20_000.0, 29_000.0, v)
    parts.surface("Valley", x, y, land + 14.0 * rough(u, v, 800.0, 4), sand)
    snow = next(
        node
        for node in bpy.data.objects["Valley"].data.materials[0].node_tree.nodes
        if node.type == "BSDF_PRINCIPLED"
    )
    _snow(sand, snow, 1_350.0)
    _arch_details(rock)
    parts.sunlight(scene, sun, "#ffbd80", 5.0, 400.0)
    parts.sky(scene, sun, "#4a78b8", "#dcc9bd", "#ffd9ac", 0.9, 0.6, 8)
    parts.air(14_000.0, "#b9aaa8", 0.8)
    parts.camera(scene, eye, (1.0, 42.0, 7.2), 27.0)


def _snow(material, shader, line):
    """Snow above an elevation."""
    from realmodel.bl.host.nodes import Nodes

    nodes = Nodes(material.node_tree)
    socket = shader.inputs["Base Color"]
    place = nodes.of("ShaderNodeNewGeometry", "Position")
    edge = nodes.math(
        "MULTIPLY_ADD", nodes.about(nodes.noise(place, 0.0016, 6.0), 1.0), 1_400.0, nodes.part(place, 2)
    )
    share = nodes.ramp(edge, line - 150.0, line + 150.0, 0.0, 0.9)
    nodes.link(parts.mixed(nodes, share, socket.links[0].from_socket, (0.8, 0.82, 0.86)), socket)


def _arch_details(rock):
    random = np.random.default_rng(3)
    ground = parts.Ground(rock)
    stone = parts.rock("Slab", "#a85c38", "SANDSTONE", 0.35)
    stones = [
        parts.hidden_source(f"Slab {n}", parts.boulder_mesh(f"Slab {n}", n + 60, stone)) for n in range(3)
    ]
    places = np.column_stack([random.uniform(-40, 40, 600), random.uniform(0.0, 56.0, 600)])
    parts.strewn("Slabs", stones, ground, places, 0.08 + 1.7 * random.random(600) ** 9, 4)
    leaf, bark = parts.leaf_material("Juniper Leaves", "#4c5a2e"), parts.painted("Bark", "#66503d")
    tree = parts.hidden_source(
        "Juniper", parts.tree_mesh("Juniper", 3.4, 7, leaf, bark, 1500, 0.52, 0.26, 0.2)
    )
    bush = parts.hidden_source(
        "Brush",
        parts.leaves_mesh(
            "Brush", 0.55, 380, 0.05, 2, parts.leaf_material("Brush Leaves", "#767a52"), 0.7, 0.2
        ),
    )
    parts.strewn(
        "Junipers",
        [tree],
        ground,
        np.array([[13.5, 24.0], [-27.0, 40.0], [22.0, 47.0]]),
        np.array([1.0, 0.9, 0.8]),
        1,
        sink=1.0,
        steepest=0.0,
        tilt=0.05,
    )
    places = np.column_stack([random.uniform(-30, 30, 60), random.uniform(6.0, 50.0, 60)])
    parts.strewn("Brush", [bush], ground, places, random.uniform(0.5, 1.1, 60), 7, steepest=0.93, tilt=0.1)
    parts.figure("Figure", ground.spot(-1.5, 37.5, 1.0, 1.0, 5.0), math.radians(190.0), "#d8b13a")


def badlands(scene):
    """Banded badlands in the morning."""
    sun, spacing = (108.0, 15.0), 1.6
    x, y = np.arange(-190.0, 190.1, spacing), np.arange(-14.0, 330.1, spacing)
    u, v = np.meshgrid(x, y, indexing="ij")
    start = 3.0 + 1.2 * rough(u, v, 30.0, 3, 4) + 1.0 * rough(u, v, 5.0, 5)
    washes = (
        ((-190, 40), (-110, 60), (-50, 48), (10, 70), (60, 120), (120, 130), (190, 180)),
        ((10, 70), (-30, 130), (-10, 200), (-60, 260), (-40, 330)),
        ((-50, 48), (-70, 100), (-110, 130), (-120, 190), (-160, 240), (-150, 330)),
        ((60, 120), (50, 180), (70, 230), (40, 280), (60, 330)),
        ((120, 130), (130, 70), (100, 30), (110, -14)),
        ((10, 70), (40, 50), (52, 20), (46, -14)),
        ((-50, 48), (-38, 26), (-44, -14)),
        ((120, 130), (140, 200), (120, 260), (150, 330)),
    )
    wash = np.minimum.reduce([_from_line(u, v, line) for line in washes]) < 2.2
    start = np.where(wash, 1.0 + 0.012 * v, start)
    land = rocks.drained(
        start,
        spacing,
        lambda z: np.full(len(z), 0.2),
        26,
        1.0,
        1.25,
        fixed=wash,
        smooth=0.03,
        power=0.38,
        steepest=0.8,
    )
    land += 0.2 * rough(u, v, 3.0, 7, 3)
    near = np.where((np.abs(u) < 45.0) & (v > -8.0) & (v < 14.0), land, -1.0)
    highest = np.unravel_index(near.argmax(), near.shape)
    eye = (float(u[highest]), float(v[highest]) - 3.0, float(near.max()) + 2.4)
    values = {"beds": 26, "variation": 0.8, "dip": math.radians(3.0), "dip_direction": math.radians(75.0)}
    hills = _eroded_strata(
        "Badlands",
        parts.block(x, y, land, -6.0),
        "FOLDED",
        values | {"fold_amplitude": 0.0, "seed": 5},
        {"faces": 300_000, "strength": 0.22, "joints": 0.3, "roughness": 0.6, "scree": 0.0, "stones": 0.0},
        84_000,
        [eye, (0.0, 0.0, 60.0)],
    )
    bands = {1: "#c48a6a", 2: "#d9cbb0", 3: "#a8a078", 4: "#7a4a44", 5: "#c99a58"}
    _weathered(hills, "#c2a27c", 2.2, bands, streaks=0.35, ledge=0.84, cover=0.6, tint="#a9755a")
    far = parts.rock("Pan", "#c4ac8a", "CLAY", 8.0)
    parts.weather(far, "#8a7560", 300.0, streaks=0.0, ledge=0.9, cover=0.6)
    x = np.linspace(-36_000.0, 36_000.0, 150)
    y = np.concatenate([np.linspace(326.0, 900.0, 24), np.geomspace(950.0, 40_000.0, 80)])
    u, v = np.meshgrid(x, y, indexing="ij")
    land = 22.0 * ramp_of(900.0, 330.0, v) * (0.5 + 0.8 * np.abs(rough(u, v, 120.0, 5, 5)))
    land += ramp_of(-0.1, 0.5, rough(u, v, 7_000.0, 12, 7)) * 1_700.0 * ramp_of(9_000.0, 18_000.0, v)
    parts.surface("Pan", x, y, land - 4.0, far)
    _badlands_details(hills, eye)
    parts.sunlight(scene, sun, "#ffc890", 4.8, 900.0)
    parts.sky(scene, sun, "#5b87bf", "#e6d6c6", "#ffdcae", 0.9, 0.6, 4)
    parts.air(9_000.0, "#c8b9b4", 0.8)
    parts.camera(scene, eye, (eye[0] + 3.0, 100.0, eye[2] - 9.2), 43.5)


def _badlands_details(hills, eye):
    random = np.random.default_rng(12)
    ground = parts.Ground(hills)
    stone = parts.rock("Cobble", "#8f7560", "SANDSTONE", 0.4)
    stones = [
        parts.hidden_source(f"Cobble {n}", parts.boulder_mesh(f"Cobble {n}", n + 80, stone, 2))
        for n in range(3)
    ]
    places = np.column_stack([random.uniform(-90, 90, 1400), -4.0 + 130.0 * random.random(1400) ** 1.7])
    parts.strewn("Cobbles", stones, ground, places, 0.08 + 0.9 * random.random(1400) ** 7, 4)
    bush = parts.hidden_source(
        "Saltbush",
        parts.leaves_mesh(
            "Saltbush", 0.5, 380, 0.05, 2, parts.leaf_material("Saltbush Leaves", "#8d8c6c"), 0.7, 0.2
        ),
    )
    places = np.column_stack([random.uniform(-150, 150, 500), random.uniform(0.0, 300.0, 500)])
    parts.strewn(
        "Saltbushes", [bush], ground, places, random.uniform(0.5, 1.5, 500), 7, steepest=0.9, tilt=0.1
    )
    leaf, bark = parts.leaf_material("Mesquite Leaves", "#5d6a38"), parts.painted("Bark", "#5a4a3b")
    tree = parts.hidden_source(
        "Mesquite", parts.tree_mesh("Mesquite", 3.6, 5, leaf, bark, 1200, 0.55, 0.3, 0.1)
    )
    places = np.array([[-48.0, 49.0], [-44.0, 52.0], [22.0, 82.0], [61.0, 119.0], [-20.0, 118.0]])
    parts.strewn(
        "Mesquites",
        [tree],
        ground,
        places,
        np.array([1.1, 0.8, 1.0, 1.0, 1.0]),
        3,
        sink=1.0,
        steepest=0.0,
        tilt=0.03,
    )
    parts.figure("Figure", ground.spot(eye[0] + 9.0, 42.0, 10.0, 2.0), math.radians(150.0), "#3569a3")


def quarry(scene):
    """A limestone quarry with four benches, seen from a bench."""
    eye, sun = (-38.0, -9.0, 19.5), (236.0, 24.0)
    lift, top = 14.0, 56.0

    def land(u, v):
        """Elevation, with benches of 14 m."""
        pit = np.minimum(
            np.minimum(128.0 - np.abs(u - 6.0) + 10.0 * np.sin(v / 37.0), 196.0 - v + 8.0 * np.sin(u / 31.0)),
            400.0,
        )
        pit = pit - 22.0 * ramp_of(60.0, 110.0, u) * ramp_of(90.0, 150.0, v) + 2.2 * rough(u, v, 14.0, 4)
        level = np.full(np.broadcast(u, v).shape, top) + 2.5 * rough(u, v, 60.0, 6)
        for number in range(4):
            edge = pit - 21.0 * number - 2.0 * rough(u, v, 9.0, 10 + number)
            level = level - lift * ramp_of(0.0, 2.4, edge)
        stand = ramp_of(12.0, 9.5, np.hypot(1.0 * (v + 8.0), 0.0) + 2.0 * rough(u, v, 8.0, 3)) * ramp_of(
            20.0, 17.0, u
        )
        level = np.maximum(level, 17.5 * stand)
        road = 1.0 - ramp_of(6.5, 8.5, np.abs(v - 12.0 - 0.62 * (u - 20.0)))
        slope = np.clip((u - 28.0) * 0.2, 0.0, 42.0)
        level = np.where(
            (road > 0.0) & (u > 20.0) & (level > slope),
            np.minimum(level, slope + (level - slope) * (1.0 - road)),
            level,
        )
        pond = ramp_of(34.0, 22.0, np.hypot(u + 34.0, 0.8 * (v - 112.0)) + 6.0 * rough(u, v, 18.0, 12))
        return level + 0.22 * rough(u, v, 5.0, 8) + 2.6 * (1.0 - pond) * ramp_of(12.0, 3.0, level)

    x, y = np.arange(-150.0, 170.1, 1.6), np.arange(-16.0, 250.1, 1.6)
    u, v = np.meshgrid(x, y, indexing="ij")
    rock = _eroded_strata(
        "Quarry",
        parts.block(x, y, land(u, v), -8.0),
        "CLIFF",
        {
            "beds": 26,
            "variation": 0.9,
            "dip": math.radians(4.0),
            "dip_direction": math.radians(80.0),
            "seed": 3,
        },
        {"faces": 320_000, "strength": 0.42, "joints": 1.5, "roughness": 0.8, "scree": 0.55, "stones": 0.0},
        84_000,
        [eye, (0.0, 60.0, 50.0)],
    )
    stone = {1: "#d8cfb8", 2: "#a9a08c", 3: "#cbbd9c", 4: "#c9ab78", 5: "#8f887c", "Scree": "#b5aa94"}
    _weathered(rock, "#b9ad94", 5.0, stone, streaks=0.35, ledge=0.86, cover=0.9, tint="#b08a5a")
    meadow = parts.rock("Meadow", "#66753c", "GRASS", 3.0)
    x = np.linspace(-9_000.0, 9_000.0, 110)
    y = np.concatenate([np.linspace(246.0, 700.0, 12), np.geomspace(760.0, 16_000.0, 60)])
    u, v = np.meshgrid(x, y, indexing="ij")
    hills = (
        top
        + 10.0 * rough(u, v, 300.0, 3) * ramp_of(250.0, 500.0, v)
        + 420.0 * ramp_of(-0.2, 0.6, rough(u, v, 3_000.0, 5, 6)) * ramp_of(1_200.0, 6_000.0, v)
    )
    field = parts.surface("Hills", x, y, hills, meadow)
    parts.weather(meadow, "#36452a", 90.0, streaks=0.0, ledge=0.75, cover=0.55)
    water = parts.water_material("#2f6a63", 5.0, 0.04, 0.04)
    parts.surface("Pond", np.array([-85.0, 20.0]), np.array([60.0, 165.0]), np.full((2, 2), 0.1), water)
    _quarry_details(rock, field)
    eye = (eye[0], eye[1], parts.Ground(rock).below(*eye[:2])[0].z + 3.6)
    parts.sunlight(scene, sun, "#ffe0b4", 4.6, 700.0)
    parts.sky(scene, sun, "#4f86c2", "#d5dcdc", "#ffeccb", 0.95, 0.8, 6)
    parts.air(6_000.0, "#bcc8cf", 0.8)
    parts.camera(scene, eye, (8.0, 130.0, eye[2] - 2.0), 25.0)


def _box(mesh_parts, low, high, material):
    """Adds a box to lists of vertices, faces and materials."""
    vertices, faces, numbers = mesh_parts
    first = len(vertices)
    vertices += [(x, y, z) for z in (low[2], high[2]) for y in (low[1], high[1]) for x in (low[0], high[0])]
    faces += [
        [first + k for k in quad]
        for quad in ((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5))
    ]
    numbers += [material] * 6


def _truck():
    """A dump truck, 9 m long, as a simple mesh."""
    body = ([], [], [])
    for low, high, number in (
        ((-4.2, -1.5, 1.0), (4.0, 1.5, 1.6), 1),
        ((1.6, -1.6, 1.6), (4.4, 1.6, 3.6), 0),
        ((2.2, -1.4, 2.5), (4.45, 1.4, 3.3), 2),
        ((-4.6, -2.0, 1.9), (1.3, 2.0, 3.5), 0),
        ((-4.4, -1.7, 3.2), (1.1, 1.7, 3.9), 3),
        ((1.0, -2.0, 3.5), (4.2, 2.0, 3.75), 0),
    ):
        _box(body, low, high, number)
    vertices, faces, numbers = body
    for x in (-2.9, 2.9):
        for side in (-1.0, 1.0):
            first, turns = len(vertices), np.linspace(0.0, 2.0 * np.pi, 17)[:-1]
            for depth in (1.1 * side, 1.9 * side):
                vertices += [(x + 0.95 * math.cos(t), depth, 0.95 + 0.95 * math.sin(t)) for t in turns]
            faces += [
                [first + k, first + (k + 1) % 16, first + 16 + (k + 1) % 16, first + 16 + k]
                for k in range(16)
            ]
            faces += [list(range(first, first + 16)), list(range(first + 16, first + 32))]
            numbers += [1] * 18
    mesh = bpy.data.meshes.new("Truck")
    mesh.from_pydata(vertices, [], faces)
    for material in (
        parts.painted("Yellow Paint", "#d9a02b", 0.45),
        parts.painted("Rubber", "#1f1f20"),
        parts.painted("Glass", "#1d2a33", 0.1),
        parts.painted("Load", "#b9ad94"),
    ):
        mesh.materials.append(material)
    mesh.polygons.foreach_set("material_index", numbers)
    return mesh


def _quarry_details(rock, field):
    random = np.random.default_rng(8)
    ground = parts.Ground(rock)
    stone = parts.rock("Block", "#c2b598", "LIMESTONE", 0.5)
    stones = [
        parts.hidden_source(f"Block {n}", parts.boulder_mesh(f"Block {n}", n + 100, stone)) for n in range(3)
    ]
    places = np.column_stack([random.uniform(-80, 40, 700), random.uniform(-4.0, 5.0, 700)])
    parts.strewn("Blocks", stones, ground, places, 0.06 + 0.9 * random.random(700) ** 7, 4)
    places = np.column_stack([random.uniform(-120, 130, 900), random.uniform(30.0, 190.0, 900)])
    parts.strewn("Muck", stones, ground, places, 0.4 + 2.6 * random.random(900) ** 5, 5, steepest=0.6)
    parts.figure("Figure", ground.spot(-30.0, -2.5, 1.0, 0.5), math.radians(170.0), "#d97a1f")
    truck = _truck()
    for number, (x, y, turn) in enumerate(((38.0, 78.0, 0.55), (12.0, 52.0, 2.2))):
        hit = ground.below(x, y)
        item = parts.put(f"Truck {number + 1}", truck)
        item.location, item.rotation_euler.z = hit[0], turn
    leaf, bark = parts.leaf_material("Beech Leaves", "#45602f"), parts.painted("Bark", "#5c5348")
    trees = [
        parts.hidden_source(
            f"Beech {n}", parts.tree_mesh(f"Beech {n}", 11.0, n + 3, leaf, bark, 1100, 0.46, 0.3, 0.03)
        )
        for n in range(2)
    ]
    places = np.column_stack([random.uniform(-148, 166, 260), random.uniform(196.0, 246.0, 260)])
    parts.strewn(
        "Wood", trees, ground, places, random.uniform(0.6, 1.25, 260), 6, sink=1.0, steepest=0.9, tilt=0.03
    )
    places = np.column_stack([random.uniform(-500, 500, 700), random.uniform(250.0, 640.0, 700)])
    parts.strewn(
        "Forest",
        trees,
        parts.Ground(field),
        places,
        random.uniform(0.7, 1.3, 700),
        7,
        sink=1.0,
        steepest=0.7,
        tilt=0.03,
    )


def island(scene):
    """An island and the sea around it in section: each bed is a closed solid."""
    eye, sun = (-14.0, -165.0, 24.0), (218.0, 27.0)
    deep = -62.0

    def land(u, v):
        away = np.hypot(u / 0.88, (v - 34.0) * 0.95) + 9.0 * rough(u, v, 34.0, 4)
        beach = 3.0 * ramp_of(76.0, 60.0, away)
        peaks = 34.0 * ramp_of(62.0, 8.0, away) * (0.75 + 0.45 * rough(u, v, 26.0, 9))
        reef = 9.0 * np.exp(-(((away - 104.0) / 9.0) ** 2))
        return (
            -21.0
            + 19.0 * ramp_of(104.0, 70.0, away)
            + beach
            + peaks
            + reef
            + 1.3 * rough(u, v, 12.0, 5) * ramp_of(70.0, 50.0, away)
        )

    shape = rocks.solid((-150.0, 0.0, deep), (150.0, 170.0, 52.0), 2.0, lambda u, v, w: land(u, v) - w)
    values = {"beds": 15, "variation": 0.7, "dip": math.radians(9.0), "dip_direction": math.radians(265.0)}
    values |= {"fold_amplitude": 0.13, "fold_wavelength": 0.3, "fold_axis": math.radians(12.0)}
    values |= {"faults": 1, "throw": 0.1, "fault_strike": math.radians(8.0), "unconformity": 0.6, "seed": 9}
    values |= {"palette": "CLIFF"}
    base = rocks.strata("Island", shape, "FOLDED", **values)
    solids = rocks.make_solid(base)
    colors = {1: "#e0d6bd", 2: "#8b8f8a", 3: "#c9b386", 4: "#c7884c", 5: "#5b5650"}
    rocks.recolor(
        base, solids, colors, lambda m: parts.weather(m, "#5f7038", 5.0, streaks=0.25, ledge=0.72, above=3.2)
    )
    _island_water(land, deep)
    _island_details(solids)
    parts.sunlight(scene, sun, "#ffe8c8", 4.6, 700.0)
    parts.sky(scene, sun, "#2468bd", "#a9cbe0", "#fff0d4", 1.0, 0.9, 7)
    scene.view_settings.exposure = 0.3
    parts.air(14_000.0, "#c0d4de", 0.8)
    parts.camera(scene, eye, (-2.0, 0.0, 1.5), 34.0)


def _island_water(land, deep):
    x = np.concatenate(
        [-np.geomspace(40_000.0, 152.0, 30), np.arange(-150.0, 150.1, 3.0), np.geomspace(152.0, 40_000.0, 30)]
    )
    y = np.concatenate([np.arange(0.0, 170.0, 3.0), np.geomspace(171.0, 40_000.0, 30)])
    u, v = np.meshgrid(x, y, indexing="ij")
    water = parts.water_material("#1a6f80", 7.0, 0.25, 0.05, "#eaf2ef")
    sea = parts.surface("Sea", x, y, np.zeros(u.shape), water)
    depth = np.where((np.abs(u) < 151.0) & (v < 171.0), -land(u, v), 20.0)
    foam = np.exp(-np.maximum(depth, 0.0) / 0.7)
    sea.data.attributes.new("foam", "FLOAT", "POINT").data.foreach_set(
        "value", foam.astype(np.float32).ravel()
    )
    face = parts.section_material("#1d7a8c", "#0b3145", 24.0)
    x = np.arange(-400.0, 400.1, 1.0)
    bottom = np.where(np.abs(x) < 150.0, np.minimum(land(x, 0.0 * x + 0.3), 0.0), -21.0)
    vertices = np.concatenate(
        [np.column_stack([x, 0.0 * x + 0.02, bottom - 0.3]), np.column_stack([x, 0.0 * x + 0.02, 0.0 * x])]
    )
    first = np.arange(len(x) - 1)
    first = first[bottom[:-1] < -0.05]
    quads = np.stack([first, first + 1, first + 1 + len(x), first + len(x)], 1)
    mesh = bpy.data.meshes.new("Water Section")
    mesh.from_pydata(vertices.tolist(), [], quads.tolist())
    parts.put("Water Section", mesh, face)


def _island_details(solids):
    random = np.random.default_rng(2)
    ground = parts.Ground(*solids)
    leaf, bark = parts.leaf_material("Leaves", "#3f6a30"), parts.painted("Bark", "#5f4f3e")
    trees = [
        parts.hidden_source(
            f"Tree {n}", parts.tree_mesh(f"Tree {n}", 6.5, n + 13, leaf, bark, 700, 0.48, 0.38, 0.08)
        )
        for n in range(2)
    ]
    places = np.column_stack([random.uniform(-85, 85, 420), random.uniform(3.0, 100.0, 420)])
    hits = [ground.below(float(a), float(b)) for a, b in places]
    good = np.array([hit is not None and hit[0].z > 4.5 for hit in hits])
    parts.strewn(
        "Trees",
        trees,
        ground,
        places[good],
        random.uniform(0.5, 1.25, 420)[good],
        6,
        sink=1.0,
        steepest=0.72,
        tilt=0.05,
    )
    for x in np.linspace(-75.0, 0.0, 120):
        hit = ground.below(float(x), 2.5)
        if hit is not None and 2.0 < hit[0].z < 4.0:
            parts.figure("Figure", hit[0], math.radians(190.0), "#c23b2c")
            break
    stone = parts.rock("Rubble", "#a49678", "LIMESTONE", 0.5)
    stones = [
        parts.hidden_source(f"Rubble {n}", parts.boulder_mesh(f"Rubble {n}", n + 120, stone, 2))
        for n in range(2)
    ]
    places = np.column_stack([random.uniform(-85, 85, 500), random.uniform(1.0, 90.0, 500)])
    parts.strewn("Rubble", stones, ground, places, 0.25 + 2.2 * random.random(500) ** 5, 8)
