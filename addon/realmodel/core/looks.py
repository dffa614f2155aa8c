# SPDX-License-Identifier: GPL-3.0-or-later
"""How rock looks in pictures: a recipe for each look, and which look suits a rock by its name."""

from __future__ import annotations

import re
from dataclasses import dataclass


@dataclass(frozen=True)
class Look:
    """Strengths are shares of the brightness of a property's color, sizes are in texture units.

    lamination: of laminae, which follow the layer as it was deposited; lamina: how thick one is. stain,
    grain: of large and of fine mottling; grain_size. clasts: of pebbles or crystals that differ from one
    another; clast_size. bump: how high all that stands out, texture units. roughness: of the surface. top:
    grass grows on faces that are ground, other faces are brown.
    """

    label: str
    words: tuple[str, ...] = ()
    lamination: float = 0.0
    lamina: float = 0.5
    stain: float = 0.12
    grain: float = 0.1
    grain_size: float = 0.05
    clasts: float = 0.0
    clast_size: float = 0.5
    bump: float = 0.0
    roughness: float = 0.9
    top: bool = False


LOOKS = {
    "FLAT": Look("Flat", stain=0.0, grain=0.0, roughness=1.0),
    "SANDSTONE": Look("Sandstone", ("sandstone", "sand stone", "arkose", "grès"), 0.3, 0.45, bump=0.06),
    "LIMESTONE": Look(
        "Limestone",
        ("limestone", "dolomite", "chalk", "marble", "carbonate"),
        0.12,
        1.2,
        bump=0.04,
        grain=0.05,
    ),
    "SHALE": Look(
        "Shale",
        ("shale", "mudstone", "claystone", "siltstone", "slate", "marl", "schist", "phyllite"),
        0.45,
        0.15,
        grain=0.04,
        bump=0.05,
    ),
    "CONGLOMERATE": Look(
        "Conglomerate", ("conglomerate", "breccia"), 0.2, 1.0, clasts=0.2, clast_size=0.6, bump=0.05
    ),
    "GRANITE": Look(
        "Granite",
        ("granite", "gneiss", "diorite", "gabbro", "intrusive", "basement", "pluton"),
        stain=0.1,
        grain=0.12,
        clasts=0.5,
        clast_size=0.18,
        bump=0.02,
        roughness=0.75,
    ),
    "BASALT": Look(
        "Basalt",
        ("basalt", "lava", "andesite", "volcanic", "tuff", "rhyolite"),
        stain=0.25,
        grain=0.2,
        grain_size=0.12,
        bump=0.08,
        roughness=0.7,
    ),
    "GRAVEL": Look(
        "Gravel",
        ("gravel", "pebble", "debris", "scree", "till", "moraine"),
        clasts=0.4,
        clast_size=0.6,
        bump=0.1,
    ),
    "SAND": Look("Sand", ("sand", "dune"), 0.1, 0.3, stain=0.08, grain=0.16, bump=0.02),
    "CLAY": Look("Clay", ("clay", "mud", "silt", "loess", "loam"), 0.08, 0.4, grain=0.04, bump=0.02),
    "COAL": Look("Coal", ("coal", "lignite", "peat"), 0.5, 0.2, grain=0.1, bump=0.04, roughness=0.4),
    "SALT": Look(
        "Salt",
        ("salt", "halite", "gypsum", "anhydrite", "evaporite"),
        0.15,
        0.8,
        clasts=0.1,
        clast_size=0.3,
        roughness=0.35,
    ),
    "SOIL": Look("Soil", ("soil", "humus"), stain=0.3, grain=0.35, grain_size=0.4, bump=0.1),
    "GRASS": Look("Grass", ("grass", "meadow"), stain=0.3, grain=0.45, grain_size=0.3, bump=0.15, top=True),
    "WATER": Look("Water", ("water", "lake", "sea"), stain=0.05, grain=0.0, bump=0.03, roughness=0.05),
}
DEFAULT = "SANDSTONE"


def look_of(*names: str) -> str:
    """The key in LOOKS of the look that suits a rock, by the first of some names - its lithology, then that
    of its property - in which a word of a look begins: of words the longest, then the last, which the others
    say more of. "SANDSTONE" where there is none."""
    for name in names:
        found = [
            (len(word), match.start(), key)
            for key, look in LOOKS.items()
            for word in look.words
            for match in re.finditer(rf"\b{re.escape(word)}", name.casefold())
        ]
        if found:
            return max(found)[2]
    return DEFAULT
