# SPDX-License-Identifier: GPL-3.0-or-later
"""Palettes of rocks for beds that nobody has observed."""

from __future__ import annotations

import numpy as np

from ..project.library import Library, Property

# Of each palette: the name of a rock, which its look follows from, and its color.
PALETTES: dict[str, tuple[tuple[str, str], ...]] = {
    "canyon": (
        ("Red Sandstone", "#b5653f"),
        ("Buff Sandstone", "#d6a872"),
        ("Maroon Shale", "#7d4238"),
        ("Cream Limestone", "#dcc9a0"),
        ("Orange Siltstone", "#c98550"),
    ),
    "cliff": (
        ("Chalk", "#e4dfcf"),
        ("Gray Marl", "#9a9c92"),
        ("Limestone", "#cbbf9f"),
        ("Yellow Sandstone", "#cfae6b"),
        ("Dark Shale", "#63666a"),
    ),
    "volcanic": (
        ("Basalt", "#4d4c50"),
        ("Red Tuff", "#8e4a3c"),
        ("Ash Tuff", "#a39a8e"),
        ("Andesite Lava", "#6e6661"),
        ("Ocher Clay", "#b98a4c"),
    ),
    "coal": (
        ("Gray Sandstone", "#a59e8c"),
        ("Coal", "#2e2c30"),
        ("Gray Mudstone", "#77787a"),
        ("Brown Siltstone", "#8c7559"),
        ("Pale Limestone", "#c9c3ac"),
    ),
    "desert": (
        ("Pink Sandstone", "#d59a83"),
        ("White Gypsum", "#e6ded3"),
        ("Green Marl", "#94a184"),
        ("Violet Clay", "#86647a"),
        ("Ocher Sandstone", "#d3a256"),
    ),
}


def rocks_of_beds(count: int, palette: str, seed: int) -> tuple[Library, list[int]]:
    """The library of a palette, and the number in it of each bed's rock: unlike those of the two beds
    beneath."""
    entries = PALETTES[palette]
    library = Library([Property(n, name, color=color) for n, (name, color) in enumerate(entries, 1)])
    numbers: list[int] = []
    for chance in np.random.default_rng(seed).random(count).tolist():
        free = [n for n in range(1, len(entries) + 1) if n not in numbers[-2:]]
        numbers.append(free[int(chance * len(free))])
    return library, numbers
