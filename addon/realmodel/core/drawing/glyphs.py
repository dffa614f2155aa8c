# SPDX-License-Identifier: GPL-3.0-or-later
"""Letters as polygons (DejaVu Sans), so that pictures need neither a window nor a graphics card."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np

_FILE = Path(__file__).with_name("dejavu_sans.npz")  # by scripts/write_glyphs.py
_UNKNOWN = "\ufffd"  # a sign in place of a letter that the file does not have


def text_width(text: str, size: float) -> float:
    """The width of a line of text in points."""
    return size * sum(_glyph(letter)[0] for letter in text)


def text_rings(text: str, size: float) -> list[np.ndarray]:
    """Closed polygons (N, 2) of a line of text that begins at 0, 0; holes turn the other way."""
    rings, x = [], 0.0
    for letter in text:
        advance, outline = _glyph(letter)
        rings += [size * (ring + np.array([x, 0.0])) for ring in outline]
        x += advance
    return rings


@cache
def _glyph(letter: str) -> tuple[float, list[np.ndarray]]:
    """Advance and outline of a letter of size 1."""
    font = _font()
    number = font["number"].get(ord(letter), font["number"][ord(_UNKNOWN)])
    first, last = font["glyph_rings"][number : number + 2]
    ends = font["ring_points"]
    outline = [font["points"][ends[k] : ends[k + 1]] / font["em"] for k in range(first, last)]
    return float(font["advances"][number] / font["em"]), outline


@cache
def _font() -> dict:
    with np.load(_FILE) as file:
        font = {name: file[name] for name in file.files}
    font["number"] = {int(code): number for number, code in enumerate(font["codes"])}
    return font
