# SPDX-License-Identifier: GPL-3.0-or-later
"""Colors of units by the rocks that their names say, as geological maps and logs have them."""

from __future__ import annotations

import re
from collections.abc import Sequence

from ..project.library import Library, Property
from ..project.looks import hex_color, rgb
from ..results.automatic_library import palette

# Words with which names begin, English, German, French, Dutch and Spanish; longer words count first.
_COLORS = {
    "#efd36a": ("sand", "dune", "sable", "zand", "arena"),
    "#e2b24c": ("sandstone", "sandstein", "grès", "gres", "arenisca", "arkose"),
    "#8fa08a": ("clay", "ton", "argile", "klei", "arcilla", "lehm", "loam"),
    "#b9a77c": ("silt", "schluff", "limon", "limo", "leem", "loess", "löss", "löß"),
    "#6f9fc4": ("limestone", "kalk", "calcaire", "caliza", "chalk", "kreide", "craie", "krijt", "carbonate"),
    "#7db5c9": ("dolomite", "dolomit", "dolomie", "dolomia"),
    "#7c8088": ("shale", "schiefer", "schist", "slate", "mudstone", "siltstone", "claystone", "tonstein"),
    "#9ab39a": ("marl", "mergel", "marne", "marga"),
    "#d98d45": ("gravel", "kies", "gravier", "grind", "grava", "pebble", "scree", "schotter"),
    "#b5793f": ("conglomerate", "konglomerat", "breccia", "brekzie"),
    "#a8a27e": ("till", "moraine", "moräne", "geschiebe"),
    "#6e4b30": ("soil", "topsoil", "boden", "mutterboden", "oberboden", "humus", "bodem", "suelo"),
    "#9b8f86": ("fill", "made ground", "auffüllung", "remblai", "ophoging", "relleno", "anthropogenic"),
    "#4a3b2c": ("peat", "torf", "tourbe", "veen", "turba"),
    "#33323a": ("coal", "kohle", "charbon", "steenkool", "carbón", "lignite", "braunkohle"),
    "#d77a8c": ("granite", "granit", "granito", "gneiss", "gneis", "diorite", "basement", "grundgebirge"),
    "#4f6b4e": ("basalt", "gabbro", "lava", "andesite", "volcanic", "tuff", "diabas", "dolerite"),
    "#e6b8d8": ("salt", "halite", "gypsum", "gips", "anhydrite", "anhydrit", "sel", "zout"),
    "#a05a52": ("ironstone", "iron formation", "ore", "erz"),
    "#8a8378": ("rock", "bedrock", "fels", "roche", "roca"),
    "#4d86b8": ("water", "wasser", "eau", "lake"),
}


def library_of(units: Sequence[str]) -> Library:
    """A property for each unit, numbered from 1, in the color of its rock, or else in one that differs from
    its neighbors'."""
    others = palette()
    used: set[str] = set()
    entries = []
    for number, unit in enumerate(units, 1):
        color = _color_of(unit) or next((color for color in others if color not in used), _GRAY)
        shades = (hex_color(share * channel for channel in rgb(color)) for share in _SHADES)
        color = next((shade for shade in shades if shade not in used), color)
        used.add(color)
        entries.append(Property(number, unit, color=color))
    return Library(entries)


_GRAY = "#9a9a9a"
_SHADES = (1.0, 0.85, 1.1, 0.72, 0.6)  # of units of one rock


def _color_of(name: str) -> str | None:
    """Of the longest word that the name has, or the last of several as long."""
    matches = [
        (len(word), match.start(), color)
        for color, words in _COLORS.items()
        for word in words
        for match in re.finditer(rf"\b{re.escape(word)}", name.casefold())
    ]
    return max(matches)[2] if matches else None
