# SPDX-License-Identifier: GPL-3.0-or-later
"""The geological map in a frame, at any scale: areas, contours of the ground, faults, boreholes, and lines of
sections."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..base.errors import UsageError
from ..cells.model_data import ModelData
from ..drawing.charts import Axes, tick_texts
from ..drawing.drawing import BLACK, WHITE, Color, Drawing, text_width
from .contours import ground_contours
from .geological_map import fault_lines, geological_map, ground_of
from .sections.section_holes import hole_places

CONTOUR = (0.42, 0.27, 0.13)
FAULT_WIDTH, CONTOUR_WIDTH, SECTION_WIDTH, HOLE_RADIUS = 1.4, 0.3, 0.9, 2.2
_INDEX_WIDTH, _INDEX = 0.6, 5  # of each fifth contour, which has a number
_SIZE, _SMALL = 8.0, 5.5
_AROUND = 0.03  # of the longer side: left free within the frame
_LEAST_LABEL = 5.0  # lengths of its number that a contour has at least to get it
_LAYERS = {"contours": "Contours", "faults": "Faults", "holes": "Boreholes", "sections": "Sections"}

Trace = tuple[np.ndarray, tuple[str, str]]  # a line in plan (N, 2), and the letters at its ends


class MapPlot:
    """What sheets draw of the top of a model.

    low, high: (2,) float64, what it shows. present: the numbers of the blocks that crop out, the youngest
    first. signs: which of "contours", "faults", "holes" and "sections" are there.
    """

    def __init__(self, model: ModelData, traces: Sequence[Trace] = ()):
        """traces: the lines of sections. Raises UsageError where there is no ground, BuildFailed."""
        ground = ground_of(model)
        self._areas, self._traces, self._unit = geological_map(model, ground), traces, model.project.units
        if not self._areas:
            raise UsageError("there is no map to draw: the model has no blocks")
        self._faults = fault_lines(model, ground)
        self._contours = ground_contours(ground)
        self._holes = hole_places(model.project)
        self._names, self._colors = [block.name for block in model.blocks], model.block_colors
        self.present = sorted({area.block for area in self._areas}, reverse=True)
        rings = [polygon[0] for area in self._areas for polygon in area.polygons]
        places = np.concatenate([*rings, *(line for line, _ in traces)])
        self.low, self.high = places.min(axis=0), places.max(axis=0)
        margin = _AROUND * float((self.high - self.low).max())
        self.low, self.high = self.low - margin, self.high + margin
        counts = [len(self._contours), len(self._faults), len(self._holes), len(traces)]
        self.signs = [name for name, count in zip(_LAYERS, counts, strict=True) if count]

    def extent(self) -> np.ndarray:
        """(2,) float64: width and height, model units."""
        return self.high - self.low

    def entries(self) -> list[tuple[str, Color]]:
        """Names and colors of the legend."""
        return [(self._names[block], tuple(self._colors[block])) for block in self.present]

    def draw(self, drawing: Drawing, at: tuple[float, float], scale: float) -> None:
        """Draws it with its lower left corner at a place in points. scale: points for a unit."""
        width, height = (self.extent() * scale).tolist()
        (left, right), (bottom, top) = zip(self.low.tolist(), self.high.tolist(), strict=True)
        axes = Axes(drawing, (*at, width, height), (left, right), (bottom, top), _SIZE)
        for area in self._areas:
            color, name = tuple(self._colors[area.block]), self._names[area.block]
            for polygon in area.polygons:
                drawing.polygon([axes.at(ring) for ring in polygon], color, BLACK, 0.35, layer=name)
        self._draw_contours(axes)
        for _, line in self._faults:
            drawing.line(axes.at(line), BLACK, FAULT_WIDTH, layer=_LAYERS["faults"])
        self._draw_fault_names(axes)
        axes.crosses(layer="Axes")
        for line, letters in self._traces:
            _draw_trace(axes, line, letters)
        self._draw_holes(axes)
        axes.frame(f"East (x) ({self._unit})", f"North (y) ({self._unit})", layer="Axes")

    def _draw_contours(self, axes: Axes) -> None:
        """Lines, each fifth thicker, with its height along it where it is long enough."""
        drawing, layer = axes.drawing, _LAYERS["contours"]
        levels = sorted({line.elevation for line in self._contours})
        step = min(np.diff(levels), default=0.0)
        for line in self._contours:
            is_index = bool(step) and round(line.elevation / step) % _INDEX == 0
            points = axes.at(line.points)
            drawing.line(points, CONTOUR, _INDEX_WIDTH if is_index else CONTOUR_WIDTH, layer=layer)
            text = tick_texts(np.array([line.elevation]))[0]
            if (is_index or len(levels) < _INDEX) and _length(points) > _LEAST_LABEL * text_width(
                text, _SMALL
            ):
                _along(drawing, points, text, layer)

    def _draw_fault_names(self, axes: Axes) -> None:
        """The name of each fault once, along its longest line."""
        longest: dict[str, np.ndarray] = {}
        for name, line in self._faults:
            points = axes.at(line)
            if name not in longest or _length(points) > _length(longest[name]):
                longest[name] = points
        for name, points in longest.items():
            _along(axes.drawing, points, name, _LAYERS["faults"], BLACK, _SIZE - 1, lift=2.5)

    def _draw_holes(self, axes: Axes) -> None:
        """Circles at the collars, with names where there is room."""
        drawing, layer = axes.drawing, _LAYERS["holes"]
        places = np.array([place[:2] for place in self._holes.values()]).reshape(-1, 2)
        inside = ((places >= self.low) & (places <= self.high)).all(axis=1)
        taken: list[tuple[float, float, float]] = []
        for name, (x, y) in zip(np.array(list(self._holes))[inside], axes.at(places[inside]), strict=True):
            drawing.dots([(x, y)], HOLE_RADIUS, BLACK, layer)
            drawing.dots([(x, y)], HOLE_RADIUS - 0.8, WHITE, layer)
            width = text_width(name, _SMALL + 1)
            begin = x + 3.5 if x + 5 + width < axes.box[0] + axes.box[2] else x - 3.5 - width
            end = begin + width
            if not any(begin < b and a < end and abs(y - c) < _SIZE for a, b, c in taken):
                taken.append((begin, end, y))
                drawing.text(begin, y - 2, name, _SMALL + 1, layer=layer)


def _length(points: np.ndarray) -> float:
    return float(np.hypot(*np.diff(points, axis=0).T).sum())


def _along(
    drawing: Drawing,
    points: np.ndarray,
    text: str,
    layer: str,
    color: Color = CONTOUR,
    size: float = _SMALL,
    lift: float = 0.6,
) -> None:
    """A text over the middle of a line (N, 2), turned as this goes, never upside down."""
    at = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])
    half = min(text_width(text, size) / 2, at[-1] / 2)
    ends = [[np.interp(at[-1] / 2 + side, at, points[:, k]) for k in (0, 1)] for side in (-half, half)]
    (x0, y0), (x1, y1) = ends if ends[0][0] <= ends[1][0] else ends[::-1]
    angle = float(np.arctan2(y1 - y0, x1 - x0))
    x, y = (x0 + x1) / 2 - lift * np.sin(angle), (y0 + y1) / 2 + lift * np.cos(angle)
    drawing.text(x, y, text, size, color, "middle", float(np.degrees(angle)), layer)


def _draw_trace(axes: Axes, line: np.ndarray, letters: tuple[str, str]) -> None:
    """The line of a section, with a letter beyond each end."""
    drawing, points, layer = axes.drawing, axes.at(line), _LAYERS["sections"]
    drawing.line(points, WHITE, SECTION_WIDTH + 1.4, layer=layer)
    drawing.line(points, BLACK, SECTION_WIDTH, layer=layer)
    low, high = np.array(axes.box[:2]), np.array(axes.box[:2]) + axes.box[2:]
    for end, before, letter in ((0, 1, letters[0]), (-1, -2, letters[1])):
        way = points[end] - points[before]
        width = text_width(letter, _SIZE + 2)
        x, y = points[end] + way / np.hypot(*way) * (0.8 * _SIZE + width / 2)
        inset = np.array([width / 2 + 2, 0.5 * _SIZE + 2])
        x, y = np.clip([x, y], low + inset, high - inset)
        drawing.rectangle(
            (x - width / 2 - 1.5, y - 0.5 * _SIZE - 1.5, width + 3, _SIZE + 4), WHITE, layer=layer
        )
        drawing.text(x, y - 0.36 * _SIZE, letter, _SIZE + 2, anchor="middle", layer=layer)
