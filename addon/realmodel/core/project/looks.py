# SPDX-License-Identifier: GPL-3.0-or-later
"""Looks of rock in pictures: a recipe for each look, and the look for a rock by its name."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass


@dataclass(frozen=True)
class Look:
    """How a rock looks. color: "#rrggbb" of a material that is of no property. words: with which names of
    such rocks begin.

    Strengths are shares of the brightness of a property's color; sizes, depths and heights are in texture
    units.

    lamination: of laminae, which follow the layer as it was deposited; lamina: how thick one is. bed: how
    thick beds are (0: none), which differ in tone and are parted by grooves. joint: how far steep joints are
    apart (0: none); cells: how large are what upright cracks enclose, instead: columns, or on_top: only on
    faces that are ground. crack: how dark and deep cracks and grooves are. stain, grain: of large and of fine
    mottling; grain_size. clasts: of pebbles or crystals that differ from one another; clast_size, of the
    largest; packing: the share of the places that pebbles take. hue: by how much beds and clasts differ in
    hue. crumbs: how high crumbs are, of crumb_size. litter: the share of the places on ground that have a dry
    stalk. relief: how high the surface is rough; relief_size. roughness: how matt. grassy: blades on faces
    that are ground, other faces are brown.
    hardness: from 0 to 1, how well the rock withstands weathering.
    """

    label: str
    color: str
    words: tuple[str, ...] = ()
    hardness: float = 0.5
    lamination: float = 0.0
    lamina: float = 0.5
    bed: float = 0.0
    joint: float = 0.0
    cells: bool = False
    on_top: bool = False
    crack: float = 0.5
    stain: float = 0.12
    grain: float = 0.08
    grain_size: float = 0.06
    clasts: float = 0.0
    clast_size: float = 0.5
    packing: float = 1.0
    hue: float = 0.0
    crumbs: float = 0.0
    crumb_size: float = 0.1
    litter: float = 0.0
    relief: float = 0.2
    relief_size: float = 2.0
    roughness: float = 0.9
    grassy: bool = False


LOOKS = {
    "FLAT": Look("Flat", "#c0b8a8", stain=0.0, grain=0.0, relief=0.0, roughness=1.0),
    "SANDSTONE": Look(
        "Sandstone",
        "#c08a5e",
        ("sandstone", "sand stone", "arkose", "grès"),
        0.6,
        lamination=0.24,
        lamina=0.35,
        bed=2.2,
        joint=7.0,
        hue=0.006,
        relief=0.6,
        crack=0.4,
    ),
    "LIMESTONE": Look(
        "Limestone",
        "#cbc2a8",
        ("limestone", "dolomite", "chalk", "marble", "carbonate"),
        0.75,
        lamination=0.05,
        bed=1.7,
        joint=3.8,
        crack=0.4,
        stain=0.2,
        grain=0.05,
        hue=0.004,
        relief=0.5,
        relief_size=1.2,
    ),
    "SHALE": Look(
        "Shale",
        "#7a7f86",
        ("shale", "mudstone", "claystone", "siltstone", "slate", "marl", "schist", "phyllite"),
        0.25,
        lamination=0.3,
        lamina=0.12,
        bed=0.5,
        crack=0.18,
        grain=0.05,
        hue=0.005,
        relief=0.35,
        relief_size=0.8,
    ),
    "CONGLOMERATE": Look(
        "Conglomerate",
        "#a98c72",
        ("conglomerate", "breccia"),
        0.7,
        lamination=0.08,
        bed=4.0,
        grain=0.22,
        grain_size=0.035,
        clasts=0.3,
        clast_size=0.42,
        packing=0.95,
        hue=0.012,
        crumbs=0.3,
        crumb_size=0.03,
        relief=0.5,
        crack=0.2,
    ),
    "GRANITE": Look(
        "Granite",
        "#c0a79c",
        ("granite", "gneiss", "diorite", "gabbro", "intrusive", "basement", "pluton"),
        0.95,
        joint=6.0,
        crack=0.3,
        stain=0.14,
        grain=0.05,
        clasts=0.36,
        clast_size=0.1,
        hue=0.012,
        relief=0.9,
        relief_size=4.0,
        roughness=0.7,
    ),
    "BASALT": Look(
        "Basalt",
        "#55555a",
        ("basalt", "lava", "andesite", "volcanic", "tuff", "rhyolite"),
        0.9,
        joint=1.5,
        cells=True,
        crack=0.4,
        stain=0.2,
        grain=0.15,
        relief=0.35,
        relief_size=0.7,
        roughness=0.75,
    ),
    "GRAVEL": Look(
        "Gravel",
        "#a39a8c",
        ("gravel", "pebble", "debris", "scree", "till", "moraine"),
        0.3,
        grain=0.2,
        clasts=0.34,
        clast_size=0.45,
        packing=1.0,
        hue=0.012,
        crumbs=0.5,
        crumb_size=0.06,
        relief=0.4,
    ),
    "SAND": Look(
        "Sand", "#dcc48e", ("sand", "dune"), 0.1, 0.06, 0.3, grain=0.14, relief=0.12, relief_size=1.2
    ),
    "CLAY": Look(
        "Clay",
        "#a5785c",
        ("clay", "mud", "silt", "loess", "loam"),
        0.15,
        lamination=0.06,
        lamina=0.4,
        joint=0.9,
        cells=True,
        on_top=True,
        crack=0.22,
        grain=0.04,
        relief=0.4,
    ),
    "COAL": Look(
        "Coal",
        "#38363a",
        ("coal", "lignite", "peat"),
        0.35,
        lamination=0.4,
        lamina=0.12,
        bed=0.6,
        joint=0.7,
        grain=0.1,
        relief=0.25,
        relief_size=0.5,
        roughness=0.4,
        crack=0.25,
    ),
    "SALT": Look(
        "Salt",
        "#dcd3d0",
        ("salt", "halite", "gypsum", "anhydrite", "evaporite"),
        0.2,
        lamination=0.12,
        lamina=0.8,
        stain=0.1,
        clasts=0.12,
        clast_size=0.4,
        relief=0.25,
        relief_size=0.8,
        roughness=0.35,
    ),
    "SOIL": Look(
        "Soil",
        "#6a4a32",
        ("soil", "humus"),
        0.1,
        stain=0.2,
        grain=0.12,
        grain_size=0.25,
        clasts=0.2,
        clast_size=0.42,
        packing=0.1,
        crumbs=0.8,
        crumb_size=0.1,
        litter=0.3,
        relief=0.4,
        relief_size=0.9,
    ),
    "GRASS": Look(
        "Grass",
        "#6d8a3c",
        ("grass", "meadow"),
        0.3,
        stain=0.35,
        grain=0.3,
        grain_size=0.3,
        hue=0.03,
        litter=0.25,
        relief=0.16,
        relief_size=0.5,
        grassy=True,
    ),
    "WATER": Look(
        "Water",
        "#3c6a84",
        ("water", "lake", "sea"),
        1.0,
        stain=0.05,
        grain=0.0,
        relief=0.05,
        relief_size=1.5,
        roughness=0.05,
    ),
}
DEFAULT = "SANDSTONE"


def look_of(*names: str) -> str:
    """The key in LOOKS of the look that suits a rock, by the first of some names - its lithology, then that
    of its property - in which a word of a look begins: of words the longest, then the last, which the others
    say more of. "SANDSTONE" where there is none."""
    for name in names:
        matches = [
            (len(word), match.start(), key)
            for key, look in LOOKS.items()
            for word in look.words
            for match in re.finditer(rf"\b{re.escape(word)}", name.casefold())
        ]
        if matches:
            return max(matches)[2]
    return DEFAULT


RGB = tuple[float, float, float]


def rgb(code: str) -> RGB:
    """Red, green, blue of "#rrggbb", sRGB encoded."""
    red, green, blue = (int(code[at : at + 2], 16) / 255.0 for at in (1, 3, 5))
    return red, green, blue


def hex_color(color: Iterable[float]) -> str:
    """The "#rrggbb" of three sRGB encoded numbers, which are clipped to 0 and 1."""
    return "#" + "".join(f"{round(255 * min(max(channel, 0.0), 1.0)):02x}" for channel in color)


def linear(channel: float) -> float:
    """The scene-linear value of an sRGB encoded one (IEC 61966-2-1)."""
    return channel / 12.92 if channel <= 0.04045 else ((channel + 0.055) / 1.055) ** 2.4


def encoded(channel: float) -> float:
    """The sRGB encoded value of a scene-linear one, which is clipped to 0 and 1."""
    channel = min(max(channel, 0.0), 1.0)
    return 12.92 * channel if channel <= 0.0031308 else 1.055 * channel ** (1 / 2.4) - 0.055
