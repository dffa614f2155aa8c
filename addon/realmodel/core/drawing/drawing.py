# SPDX-License-Identifier: GPL-3.0-or-later
"""A drawing: polygons, lines, dots, and texts in points, before it is known what file it becomes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

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


Color = tuple[float, ...]  # red, green, blue, and where it is not opaque alpha: sRGB from 0 to 1
BLACK, GRAY, WHITE = (0.0, 0.0, 0.0), (0.55, 0.55, 0.55), (1.0, 1.0, 1.0)
PAPER = (1.0, 1.0, 1.0, 0.9)  # behind what is drawn over a picture
ANCHORS = {"start": 0.0, "middle": 0.5, "end": 1.0}


@dataclass(frozen=True, eq=False)
class FilledRings:
    """Closed rings (N, 2); holes turn the other way. fill, stroke: None for none."""

    rings: list[np.ndarray]
    fill: Color | None
    stroke: Color | None
    width: float
    layer: str


@dataclass(frozen=True, eq=False)
class Line:
    points: np.ndarray  # (N, 2)
    color: Color
    width: float
    dash: float | None  # length of a dash and of the gap after it
    layer: str


@dataclass(frozen=True, eq=False)
class Dots:
    points: np.ndarray  # (N, 2)
    radii: np.ndarray  # (N,)
    color: Color
    layer: str


@dataclass(frozen=True, eq=False)
class Text:
    x: float
    y: float  # of the baseline
    text: str
    size: float
    color: Color
    anchor: str
    angle: float  # degrees, counter-clockwise
    layer: str


DrawingItem = FilledRings | Line | Dots | Text


@dataclass(eq=False)
class Drawing:
    """Items from the first, below, to the last, above.

    width, height: of the page, in points (1/72 inch); the origin is the lower left corner. scale, origin:
    points for one unit of what is drawn, and where its zero is; formats without a page (DXF) are in those
    units. Colors are red, green, blue from 0 to 1, widths and sizes points; what has the name of a `layer`
    becomes a layer of a DXF file, a group of an SVG file. items: what was drawn.
    """

    width: float
    height: float
    scale: float = 1.0
    origin: tuple[float, float] = (0.0, 0.0)
    items: list[DrawingItem] = field(default_factory=list)

    def polygon(
        self,
        rings: Sequence | np.ndarray,
        fill: Color | None = None,
        stroke: Color | None = None,
        width: float = 0.5,
        layer: str = "",
    ) -> None:
        """rings: (N, 2), or a list of them. fill, stroke: colors, None for none; width: of the stroke."""
        single = np.ndim(rings[0][0]) == 0
        arrays = [np.asarray(ring, np.float64) for ring in ([rings] if single else rings)]
        self.items.append(FilledRings(arrays, fill, stroke, width, layer))

    def rectangle(
        self,
        box: Sequence[float],
        fill: Color | None = None,
        stroke: Color | None = None,
        line: float = 0.5,
        layer: str = "",
    ) -> None:
        """box: x, y, width, height. fill, stroke: as of polygon; line: the width of the stroke."""
        x, y, width, height = box
        corners = [(x, y), (x + width, y), (x + width, y + height), (x, y + height)]
        self.polygon(corners, fill, stroke, line, layer)

    def line(
        self,
        points: ArrayLike,
        color: Color = BLACK,
        width: float = 0.75,
        dash: float | None = None,
        layer: str = "",
    ) -> None:
        """A line through points (N, 2), with a color and a width. dash: the length of its dashes and gaps;
        None: a solid line."""
        self.items.append(Line(np.asarray(points, np.float64), color, width, dash, layer))

    def dots(self, points: ArrayLike, radii: ArrayLike, color: Color = BLACK, layer: str = "") -> None:
        """Filled circles of one color at points (N, 2). radii: one number, or one for each point."""
        points = np.asarray(points, np.float64).reshape(-1, 2)
        radii = np.broadcast_to(np.asarray(radii, np.float64), len(points))
        self.items.append(Dots(points, radii, color, layer))

    def text(
        self,
        x: float,
        y: float,
        text: str,
        size: float = 9.0,
        color: Color = BLACK,
        anchor: str = "start",
        angle: float = 0.0,
        layer: str = "",
    ) -> None:
        """One line of text from the baseline at (x, y), with a size and a color. anchor: "start", "middle",
        or "end". angle: degrees, counter-clockwise."""
        self.items.append(Text(float(x), float(y), str(text), size, color, anchor, angle, layer))
