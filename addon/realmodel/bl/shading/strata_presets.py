# SPDX-License-Identifier: GPL-3.0-or-later
"""Presets of Fill with Strata: their values, and a material of each for the asset library.

On any object the material shows about what the preset makes of it: beds in the colors of its palette, by the
height in the bounding box. Fill with Strata begins with the preset of the material that its mesh has.
"""

import math

import bpy

from ...core.filling import PALETTES
from ...core.filling.strata import UPRIGHT
from ..host.nodes import Nodes
from ..objects.materials import linear_color

KEY = "realmodel_strata"  # on a material: its preset
PICTURES = "filling.jpg"  # of the presets in their order, made by scripts/draw_filling.py
_PLAIN = {
    "beds": 12,
    "thickness": 0.0,
    "variation": 0.5,
    "dip": 0.0,
    "fold_amplitude": 0.0,
    "fold_wavelength": 0.5,
    "axial_dip": math.radians(UPRIGHT),
    "faults": 0,
    "throw": 0.1,
    "unconformity": 0.0,
    "gap": 0.0,
    "pegs": 0,
}
# Of each its label, and what it sets, beside _PLAIN
PRESETS = {
    "CLIFF": ("Cliff", {"beds": 14, "dip": math.radians(6), "palette": "CLIFF"}),
    "CANYON": ("Canyon", {"beds": 24, "variation": 0.9, "dip": math.radians(2), "palette": "CANYON"}),
    "ISLAND": ("Island", {"beds": 9, "dip": math.radians(18), "unconformity": 0.6, "palette": "VOLCANIC"}),
    "FOLDED": (
        "Folded",
        {"beds": 16, "dip": math.radians(10), "fold_amplitude": 0.15, "palette": "DESERT"},
    ),
    "OVERTURNED": (
        "Overturned",
        {
            "beds": 16,
            "dip": math.radians(4),
            "fold_amplitude": 0.25,
            "fold_wavelength": 0.7,
            "axial_dip": math.radians(30),
            "palette": "CLIFF",
        },
    ),
    "FAULTED": (
        "Faulted",
        {"beds": 14, "dip": math.radians(12), "faults": 3, "throw": 0.12, "palette": "COAL"},
    ),
    "PRINT": ("Print Parts", {"beds": 4, "gap": 0.004, "pegs": 2, "palette": "DESERT"}),
}
# Of each shape of core.filling.SHAPES its label, its description, and a preset with other values
SHAPES = {
    "CLIFF": (
        "Cliff",
        "A plateau that ends in a cliff above a slope",
        {"preset": "CLIFF", "variation": 0.8, "scree": 0.7},
    ),
    "CANYON": ("Canyon", "A river canyon with a mesa beside it", {"preset": "CANYON", "scree": 0.6}),
    "BOULDER": ("Boulder", "A lump with broken faces", {"preset": "FAULTED", "faults": 1, "beds": 10}),
    "ARCH": (
        "Arch",
        "A wall of rock with an opening",
        {"preset": "CANYON", "beds": 12, "variation": 0.8, "scree": 0.3},
    ),
    "ISLAND": ("Island", "An island with a steep coast and stacks", {"preset": "ISLAND", "beds": 12}),
    "TERRAIN": ("Terrain", "Ridges and valleys", {"preset": "FOLDED", "beds": 20}),
}
_UNEVEN, _WAVES = 0.35, 2.4  # how much beds differ in thickness: of a bed; waves, radians of a bed
_ROUGH, _ROUGH_SIZE = 0.012, 7.0  # how rough their borders are, of the height


def values(preset):
    """The properties that a preset sets, by name; nothing where there is none of this key."""
    return _PLAIN | PRESETS[preset][1] if preset in PRESETS else {}


def of_item(item):
    """The preset of the materials of an object, or None."""
    names = (slot.material.get(KEY) for slot in item.material_slots if slot.material is not None)
    return next((preset for preset in names if preset in PRESETS), None)


def material(preset):
    """A new material that shows a preset."""
    label, _ = PRESETS[preset]
    made = bpy.data.materials.new(f"{label} Strata")
    made.use_nodes = True
    made[KEY] = preset
    colors = [linear_color(color) for _, color in PALETTES[values(preset)["palette"].lower()]]
    made.diffuse_color = (*colors[0], 1.0)
    nodes = Nodes(made.node_tree)
    shader = next(node for node in made.node_tree.nodes if node.type == "BSDF_PRINCIPLED")
    shader.inputs["Roughness"].default_value = 0.9
    share = _rock(nodes, _level(nodes, values(preset)), values(preset)["beds"], len(colors))
    ramp = nodes.new("ShaderNodeValToRGB")
    ramp.color_ramp.interpolation = "CONSTANT"
    stops = ramp.color_ramp.elements
    while len(stops) < len(colors):
        stops.new(1.0)
    for number, color in enumerate(colors):
        stops[number].position = number / len(colors)
        stops[number].color = (*color, 1.0)
    nodes.link(share, ramp.inputs["Fac"])
    nodes.link(ramp.outputs["Color"], shader.inputs["Base Color"])
    return made


def _level(nodes, preset):
    """The height in the strata, 0 to 1 in the bounding box where they are level. preset: its settings."""
    place = nodes.of("ShaderNodeTexCoord", "Generated")
    across, height = nodes.part(place, 0), nodes.part(place, 2)
    rough = nodes.about(nodes.noise(place, _ROUGH_SIZE, 4.0), 2.0 * _ROUGH)
    level = nodes.math("ADD", height, rough)
    tilted = nodes.math("MULTIPLY_ADD", across, math.tan(preset["dip"]), level)
    if preset["fold_amplitude"]:
        leaning = nodes.math("MULTIPLY_ADD", height, 1.0 / math.tan(preset["axial_dip"]), across)
        wave = nodes.math("SINE", nodes.math("MULTIPLY", leaning, 2.0 * math.pi / preset["fold_wavelength"]))
        tilted = nodes.math("MULTIPLY_ADD", wave, preset["fold_amplitude"], tilted)
    if preset["faults"]:
        side = nodes.math("FLOOR", nodes.math("MULTIPLY", across, preset["faults"] + 1.0))
        tilted = nodes.math("MULTIPLY_ADD", nodes.math("PINGPONG", side, 2.0), preset["throw"], tilted)
    if preset["unconformity"]:
        is_above = nodes.math("GREATER_THAN", level, preset["unconformity"])
        tilted = nodes.math("MULTIPLY_ADD", is_above, nodes.math("SUBTRACT", level, tilted), tilted)
    return tilted


def _rock(nodes, level, beds, count):
    """A number from 0 to 1 of each bed, which says its rock of so many: another one than that beneath."""
    level = nodes.math("MULTIPLY", level, float(beds))
    wave = nodes.math("SINE", nodes.math("MULTIPLY", level, _WAVES))
    bed = nodes.math("FLOOR", nodes.math("MULTIPLY_ADD", wave, _UNEVEN, level))
    chance = nodes.new("ShaderNodeTexWhiteNoise")
    chance.noise_dimensions = "1D"
    nodes.link(bed, chance.inputs["W"])
    step = nodes.math("FLOOR", nodes.math("MULTIPLY", chance.outputs["Value"], 2.0))
    rock = nodes.math("ADD", nodes.math("MULTIPLY_ADD", bed, 2.0, step), 0.5)
    return nodes.math("FRACT", nodes.math("DIVIDE", rock, float(count)))
