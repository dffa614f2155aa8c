# SPDX-License-Identifier: GPL-3.0-or-later
"""DXF files (AutoCAD's Drawing Exchange Format, release 12, ASCII), which every CAD program reads.

Coordinates are those of the drawn objects, not of the page. A polygon becomes closed polylines in its color,
as this release has no hatching; layers are those of the drawing, their names as this release asks for.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import BinaryIO

import numpy as np
from numpy.typing import ArrayLike

from ..base.text import Step
from .drawing import ANCHORS, BLACK, Color, Drawing, DrawingItem, FilledRings, Line, Text

_LONGEST_NAME = 31
ZERO_LAYER = "0"
_CODE_PAGE = "cp1252"
# AutoCAD's colors with the numbers 10 to 249: hues in steps of 15 degrees, ten of each, from bright to dark.
_HUES, _VALUES = 15.0 * np.arange(24), (1.0, 0.65, 0.5, 0.3, 0.15)


@contextmanager
def entities(file: BinaryIO, bounds: np.ndarray, layers: Mapping[str, Color]) -> Iterator[None]:
    """The entities are written within this context, what comes before and after them by it. bounds: (2, 3),
    the lowest and the highest coordinates. layers: their colors by name."""
    low, high = (list(zip((10, 20, 30), corner, strict=True)) for corner in bounds.tolist())
    head = _text((0, "SECTION"), (2, "HEADER"), (9, "$ACADVER"), (1, "AC1009"))
    head += _text((9, "$DWGCODEPAGE"), (3, "ANSI_1252"), (9, "$EXTMIN"), *low, (9, "$EXTMAX"), *high)
    head += _text((0, "ENDSEC"), (0, "SECTION"), (2, "TABLES"), (0, "TABLE"), (2, "LTYPE"), (70, 1))
    head += _text((0, "LTYPE"), (2, "CONTINUOUS"), (70, 0), (3, "Solid line"), (72, 65), (73, 0), (40, 0.0))
    head += _text((0, "ENDTAB"), (0, "TABLE"), (2, "LAYER"), (70, len(layers)))
    for name, color in layers.items():
        head += _text((0, "LAYER"), (2, name), (70, 0), (62, _color_number(color)), (6, "CONTINUOUS"))
    head += _text((0, "ENDTAB"), (0, "ENDSEC"), (0, "SECTION"), (2, "ENTITIES"))
    file.write(head.encode(_CODE_PAGE))
    yield
    file.write(_text((0, "ENDSEC"), (0, "EOF")).encode())


def _text(*pairs: tuple[int, object]) -> str:
    """Group codes and their values, each on a line."""
    return "".join(f"{code}\n{value}\n" for code, value in pairs)


def write_dxf(drawing: Drawing, file: BinaryIO, _step: Step) -> None:
    layers = {"": ZERO_LAYER}
    for item in drawing.items:
        if item.layer not in layers:
            layers[item.layer] = layer_name(item.layer, layers.values())
    pairs = _Pairs(drawing)
    bounds = np.zeros((2, 3))
    bounds[:, :2] = pairs.places([(0.0, 0.0), (drawing.width, drawing.height)])
    for item in drawing.items:
        pairs.item(item, layers[item.layer])
    colors = {name: _layer_color(drawing, layer) for layer, name in layers.items()}
    with entities(file, bounds, colors):
        file.write("".join(pairs.lines).encode(_CODE_PAGE))


class _Pairs:
    """The lines of the entities of a drawing: group codes and values."""

    def __init__(self, drawing: Drawing):
        self.drawing = drawing
        self.lines: list[str] = []

    def add(self, *pairs: tuple[int, object]) -> None:
        self.lines.append(_text(*pairs))

    def places(self, points: ArrayLike) -> np.ndarray:
        return (np.asarray(points) - self.drawing.origin) / self.drawing.scale

    def place(self, at: Sequence[float]) -> list[tuple[int, float]]:
        return [(10, float(at[0])), (20, float(at[1])), (30, 0.0)]

    def item(self, item: DrawingItem, layer: str) -> None:
        if isinstance(item, FilledRings):
            for ring in item.rings:
                self.polyline(ring, layer, item.fill or item.stroke or BLACK, closed=True)
        elif isinstance(item, Line):
            self.polyline(item.points, layer, item.color, closed=False)
        elif isinstance(item, Text):
            self.text(item, layer)
        else:
            for at, radius in zip(self.places(item.points), item.radii / self.drawing.scale, strict=True):
                color = (62, _color_number(item.color))
                self.add((0, "CIRCLE"), (8, layer), color, *self.place(at), (40, float(radius)))

    def polyline(self, points: np.ndarray, layer: str, color: Color, closed: bool) -> None:
        self.add((0, "POLYLINE"), (8, layer), (62, _color_number(color)), (66, 1), *self.place((0.0, 0.0)))
        self.add((70, int(closed)))
        for at in self.places(points):
            self.add((0, "VERTEX"), (8, layer), *self.place(at))
        self.add((0, "SEQEND"), (8, layer))

    def text(self, item: Text, layer: str) -> None:
        ((x, y),) = self.places([(item.x, item.y)]).tolist()
        height = 0.72 * item.size / self.drawing.scale  # of capital letters
        self.add((0, "TEXT"), (8, layer), (62, _color_number(item.color)), *self.place((x, y)), (40, height))
        self.add((1, _escaped(item.text)), (50, item.angle))
        if ANCHORS[item.anchor]:  # then the second point counts
            self.add((72, round(2 * ANCHORS[item.anchor])), (11, x), (21, y), (31, 0.0))


def _escaped(text: str) -> str:
    """The text with AutoCAD's codes for letters that the file's code page lacks."""
    encodable = text.encode(_CODE_PAGE, "ignore").decode(_CODE_PAGE)
    return "".join(letter if letter in encodable else f"\\U+{ord(letter):04X}" for letter in text)


def layer_name(layer: str, taken: Collection[str]) -> str:
    """A name of capital letters, digits, $, - and _, unlike those that are taken."""
    plain = unicodedata.normalize("NFKD", layer.upper())  # accents become signs of their own
    plain = "".join(letter for letter in plain if not unicodedata.combining(letter))
    name = re.sub(r"[^A-Z0-9$_-]", "_", plain)[:_LONGEST_NAME]
    number = 2
    while name in taken:
        name = f"{name[: _LONGEST_NAME - 4]}_{number}"
        number += 1
    return name


def _layer_color(drawing: Drawing, layer: str) -> Color:
    for item in drawing.items:
        if item.layer == layer:
            return item.fill or item.stroke or BLACK if isinstance(item, FilledRings) else item.color
    return BLACK


def _color_number(color: Color) -> int:
    """The color of AutoCAD that is most like one; 7 is black on white and white on black."""
    shade = np.asarray(color[:3], np.float64)
    if shade.max() < 0.1:
        return 7
    grays = np.array([0.2, 0.36, 0.52, 0.68, 0.84, 1.0])  # numbers 250 to 255
    table = np.concatenate([_TABLE, np.repeat(grays[:, None], 3, axis=1)])
    return 10 + int(np.argmin(((table - shade) ** 2).sum(axis=1)))


def _color_table() -> np.ndarray:
    """(240, 3): the colors 10 to 249."""
    hue = _HUES / 60
    full = np.column_stack([np.abs(hue - 3) - 1, 2 - np.abs(hue - 2), 2 - np.abs(hue - 4)]).clip(0, 1)
    pale = (1 + full) / 2
    return np.concatenate([[v * f, v * p] for f, p in zip(full, pale, strict=True) for v in _VALUES])


_TABLE = _color_table()
