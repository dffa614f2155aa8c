# SPDX-License-Identifier: GPL-3.0-or-later
"""Sheets to print: the geological map and sections at one scale on paper of ISO 216, with legend and title
block."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..base.errors import UsageError
from ..cells.model_data import ModelData
from ..drawing.charts import TITLE, left_margin, legend, legend_size, scale_bar
from ..drawing.drawing import BLACK, WHITE, Color, Drawing, text_width
from .map_plot import CONTOUR, FAULT_WIDTH, HOLE_RADIUS, SECTION_WIDTH, MapPlot, Trace
from .sections.section_data import FenceData, SectionData
from .sections.section_drawing import (
    SCALES,
    SectionPlot,
    flattened,
    is_vertical,
    points_for_unit,
    scale_text,
    subtitle,
)

_PAPERS = {"A4": (297, 210), "A3": (420, 297), "A2": (594, 420), "A1": (841, 594), "A0": (1189, 841)}
_UPRIGHT = "-portrait"
# (width, height) in millimeters
SHEET_SIZES = _PAPERS | {f"{paper}{_UPRIGHT}": (short, long) for paper, (long, short) in _PAPERS.items()}
DEFAULT_SIZE = "A3"
_MM = 72 / 25.4  # points
_MARGIN, _STRIP = 10 * _MM, 58 * _MM  # around the frame; the width of what stands beside maps and sections
_PAD = 4 * _MM  # between the frame and what is in it
_BELOW, _ABOVE, _RIGHT = 30.0, 46.0, 14.0  # around a map or section, for numbers and titles
_SIZE = 8.0
_NAMES = {"contours": "Contour", "faults": "Fault", "holes": "Borehole", "sections": "Line of a section"}
_LEGEND = "Legend"


@dataclass(eq=False)
class _Figure:
    """A map or section. letters: at its ends; none of maps and of sections that are not vertical."""

    plot: MapPlot | SectionPlot
    unit: str
    title: str
    letters: tuple[str, str] = ("", "")

    def margins(self, scale: float) -> tuple[float, float]:
        """What stands left of its frame and above it, in points."""
        width, height = self.plot.extent() * scale
        left = left_margin((self.plot.low[1], self.plot.high[1]), height, _SIZE)
        return left, _ABOVE + (self.plot.height_of_ends(width) if isinstance(self.plot, SectionPlot) else 0.0)

    def extent(self, ratio: float) -> np.ndarray:
        """(2,) float64: what it takes of a sheet at a scale 1 : ratio, in points."""
        scale = points_for_unit(ratio, self.unit)
        if isinstance(self.plot, SectionPlot):
            self.plot.leave_room_for_names(scale)
        left, above = self.margins(scale)
        return self.plot.extent() * scale + (left + _RIGHT, above + _BELOW)

    def fits(self, room: tuple[float, float], ratio: float) -> bool:
        """Whether it has room at a scale 1 : ratio; what is far too large is given no numbers."""
        scale = points_for_unit(ratio, self.unit)
        return bool((self.plot.extent() * scale < room).all() and (self.extent(ratio) <= room).all())

    def draw(self, drawing: Drawing, corner: tuple[float, float], ratio: float) -> None:
        """Draws it below and right of its upper left corner."""
        scale = points_for_unit(ratio, self.unit)
        (left, _), (_, height) = self.margins(scale), self.extent(ratio).tolist()
        x, y = corner[0] + left, corner[1]
        drawing.text(x, y - 1.5 * _SIZE, self.title, _SIZE + 3, layer="Text")
        text = f"Scale {scale_text(ratio)}"
        at = x, y - height + _BELOW
        if isinstance(self.plot, SectionPlot):
            text = subtitle(self.plot.section, ratio, self.plot.exaggeration)
            self.plot.draw(drawing, at, scale, self.letters)
        else:
            self.plot.draw(drawing, at, scale)
        drawing.text(x, y - 3.0 * _SIZE, text, _SIZE, layer="Text")


def draw_sheets(
    model: ModelData,
    sections: Sequence[SectionData] = (),
    size: str = DEFAULT_SIZE,
    scale: float | None = None,
    exaggeration: float = 1.0,
    hole_width: float = 0.0,
    hole_column: str | None = None,
) -> list[Drawing]:
    """The geological map, then sections, below one another on as many sheets as they take.

    size: one of SHEET_SIZES. scale: N of 1 : N; None: the largest of 1, 2, 2.5 and 5 times a power of ten at
    which all fit. exaggeration, hole_width, hole_column: of sections, as of draw_section. Vertical sections
    are lines on the map, with letters at their ends. Raises UsageError for what does not fit, naming a size
    and a scale that do.
    """
    if size not in SHEET_SIZES:
        raise UsageError(f"there is no paper {size!r}; choose from {', '.join(SHEET_SIZES)}")
    if scale is not None and not 0.0 < scale < math.inf:
        raise UsageError(f"a scale 1 : N has a number above 0, not {scale!r}")
    figures = _figures(model, sections, exaggeration, hole_width, hole_column)
    ratio = _least_ratio(figures, size) if scale is None else float(scale)
    if scale is not None and not _fit(figures, size, ratio):
        raise UsageError(_does_not_fit(figures, size, ratio))
    pages = _pages(figures, _room(size), ratio)
    return [_sheet(model, page, size, ratio, (number, len(pages))) for number, page in enumerate(pages, 1)]


def _figures(
    model: ModelData,
    sections: Sequence[SectionData],
    exaggeration: float,
    hole_width: float,
    hole_column: str | None,
) -> list[_Figure]:
    unit = model.project.units
    traces: list[Trace] = []
    figures: list[_Figure] = []
    for section in sections:
        plot = SectionPlot(section, exaggeration, hole_width, hole_column)
        if not is_vertical(section):
            figures.append(_Figure(plot, unit, "Section"))
            continue
        letters = _letters(len(traces))
        traces.append((_line(section), letters))
        figures.append(_Figure(plot, unit, f"Section {'-'.join(letters)}", letters))
    return [_Figure(MapPlot(model, traces), unit, "Geological map"), *figures]


def _letters(number: int) -> tuple[str, str]:
    """A and A', B and B', ...; after Z and Z' A1 and A1'."""
    turn, letter = divmod(number, 26)
    text = chr(ord("A") + letter) + (str(turn) if turn else "")
    return text, f"{text}'"


def _line(section: SectionData) -> np.ndarray:
    """(N, 2) the line of a vertical section in plan, from its left end."""
    if isinstance(section, FenceData):
        return section.polyline
    along = flattened(section)[:, 0]
    return section.vertices[[int(along.argmin()), int(along.argmax())], :2]


def _paper(size: str) -> tuple[float, float]:
    """Width and height in points."""
    width, height = SHEET_SIZES[size]
    return _MM * width, _MM * height


def _room(size: str) -> tuple[float, float]:
    """Width and height that maps and sections have on a sheet, in points."""
    width, height = _paper(size)
    return width - 2 * _MARGIN - _STRIP - 2 * _PAD, height - 2 * _MARGIN - 2 * _PAD


def _fit(figures: list[_Figure], size: str, ratio: float) -> bool:
    return all(figure.fits(_room(size), ratio) for figure in figures)


def _least_ratio(figures: list[_Figure], size: str) -> float:
    """N of the largest round scale 1 : N at which each figure fits a sheet."""
    ratios = (factor * 10.0**power for power in range(-3, 12) for factor in SCALES)
    ratio = next((ratio for ratio in ratios if _fit(figures, size, ratio)), None)
    if ratio is None:
        raise UsageError(f"the drawings fit {size} at no scale: their titles and numbers take more room")
    return ratio


def _does_not_fit(figures: list[_Figure], size: str, ratio: float) -> str:
    figure = next(figure for figure in figures if not figure.fits(_room(size), ratio))
    least = figure.plot.extent() * points_for_unit(ratio, figure.unit)
    needed, room = (np.array(lengths) / _MM for lengths in (least, _room(size)))
    upright = _UPRIGHT if size.endswith(_UPRIGHT) else ""
    larger = next((paper for paper in _PAPERS if _fit(figures, paper + upright, ratio)), None)
    advice = f"the scale {scale_text(_least_ratio(figures, size))}"
    advice = f"{larger}{upright}, or {advice}" if larger else advice
    return (
        f"'{figure.title}' takes {needed[0]:.0f} x {needed[1]:.0f} mm at {scale_text(ratio)} without its "
        f"numbers, and {size} has {room[0]:.0f} x {room[1]:.0f} mm for both; take {advice}"
    )


def _pages(figures: list[_Figure], room: tuple[float, float], ratio: float) -> list[list[_Figure]]:
    """The figures of each sheet, from above: as many as have room below one another."""
    pages: list[list[_Figure]] = []
    left = 0.0
    for figure in figures:
        height = float(figure.extent(ratio)[1])
        if not pages or height > left:
            pages.append([])
            left = room[1]
        pages[-1].append(figure)
        left -= height
    return pages


def _sheet(
    model: ModelData, figures: list[_Figure], size: str, ratio: float, number: tuple[int, int]
) -> Drawing:
    drawing = Drawing(*_paper(size))
    x, y, width, height = _MARGIN, _MARGIN, drawing.width - 2 * _MARGIN, drawing.height - 2 * _MARGIN
    drawing.rectangle((x, y, width, height), stroke=BLACK, line=1.2, layer="Frame")
    (room, _), top = _room(size), y + height - _PAD
    for figure in figures:
        across, down = figure.extent(ratio).tolist()
        figure.draw(drawing, (x + _PAD + (room - across) / 2, top), ratio)
        top -= down
    strip = x + width - _STRIP
    drawing.line([(strip, y), (strip, y + height)], width=0.6, layer="Frame")
    base = _title_block(drawing, (strip, y), model, figures, size, ratio, number)
    scale = points_for_unit(ratio, model.project.units)
    scale_bar(drawing, (strip + _PAD + 3, base + 8), _STRIP - 3 * _PAD, scale, model.project.units, _SIZE)
    drawing.text(strip + _PAD, base + 32, f"Scale {scale_text(ratio)}", _SIZE, layer="Text")
    base += 32 + 2 * _SIZE
    if any(isinstance(figure.plot, MapPlot) for figure in figures):
        _north_arrow(drawing, (strip + _STRIP - _PAD - _SIZE, base))
    base = _curve_key(drawing, figures, (strip + _PAD, base))
    _legend(drawing, figures, (strip + _PAD, y + height - _PAD), y + height - _PAD - base)
    return drawing


def _title_block(
    drawing: Drawing,
    at: tuple[float, float],
    model: ModelData,
    figures: list[_Figure],
    size: str,
    ratio: float,
    number: tuple[int, int],
) -> float:
    """The name of the project, and what the sheet shows; returns how high it reaches."""
    project, inner = model.project, _STRIP - 2 * _PAD
    system = f"{project.crs}, {project.units}" if project.crs else project.units
    lines = [
        ", ".join(figure.title for figure in figures),
        f"Scale {scale_text(ratio)} on {size.removesuffix(_UPRIGHT)}",
        f"Coordinates: {system}",
        f"Sheet {number[0]} of {number[1]}",
    ]
    x, y = at
    height = 2 * _PAD + (1.5 * len(lines) + 1.6) * _SIZE
    drawing.rectangle((x, y, _STRIP, height), stroke=BLACK, line=1.2, layer="Frame")
    base = y + height - _PAD - _SIZE
    for k, text in enumerate((project.name, *lines)):
        largest = _SIZE + 3 if k == 0 else _SIZE
        letters = min(largest, largest * inner / max(text_width(text, largest), 1e-9))
        drawing.text(x + _PAD, base, text, letters, layer="Text")
        base -= (1.8 if k == 0 else 1.5) * _SIZE
    return y + height


def _north_arrow(drawing: Drawing, foot: tuple[float, float]) -> None:
    """An arrow up, where y is, from the middle of its foot."""
    x, y = foot
    half, height = 0.8 * _SIZE, 4.0 * _SIZE
    tip, notch = (x, y + height), (x, y + 0.25 * height)
    drawing.polygon([(x - half, y), notch, tip], BLACK, BLACK, 0.5, layer="Text")
    drawing.polygon([(x + half, y), notch, tip], WHITE, BLACK, 0.5, layer="Text")
    drawing.text(x, y + height + 0.4 * _SIZE, "N", _SIZE + 2, anchor="middle", layer="Text")


def _curve_key(drawing: Drawing, figures: list[_Figure], at: tuple[float, float]) -> float:
    """The color bar of the curves beside boreholes, if there are any; returns how high it reaches."""
    plots = [figure.plot for figure in figures if isinstance(figure.plot, SectionPlot)]
    curves = next((plot.curves for plot in plots if plot.curves is not None), None)
    if curves is None:
        return at[1] + 6 * _SIZE
    height = max(curves.key_size(_SIZE)[1], 6 * _SIZE)
    curves.draw_key(drawing, (at[0], at[1] + height), _SIZE)
    return at[1] + height


def _legend(drawing: Drawing, figures: list[_Figure], at: tuple[float, float], room: float) -> None:
    """Blocks, the youngest first, then the signs of the map; smaller where there are many."""
    blocks: dict[int, tuple[str, Color]] = {}
    signs: list[str] = []
    for figure in figures:
        blocks |= zip(figure.plot.present, figure.plot.entries(), strict=True)
        signs += figure.plot.signs if isinstance(figure.plot, MapPlot) else []
    entries = [blocks[number] for number in sorted(blocks, reverse=True)]
    width, height = legend_size(_LEGEND, [*entries, *((_NAMES[sign], WHITE) for sign in signs)], 1.0)
    size = min(_SIZE, (_STRIP - 2 * _PAD) / width, room / (height + 0.5 * TITLE))
    legend(drawing, at, _LEGEND, entries, size, layer="Legend")
    x, y = at[0], at[1] - legend_size(_LEGEND, entries, size)[1] - 0.5 * size
    for number, sign in enumerate(signs):
        base = y - (number + 1) * 1.5 * size + 0.35 * size
        _sign(drawing, sign, (x, base + 0.35 * size), size)
        drawing.text(x + 2.2 * size, base, _NAMES[sign], size, layer="Legend")


def _sign(drawing: Drawing, sign: str, at: tuple[float, float], size: float) -> None:
    (x, y), layer = at, "Legend"
    if sign == "holes":
        drawing.dots([(x + 0.8 * size, y)], HOLE_RADIUS, BLACK, layer)
        drawing.dots([(x + 0.8 * size, y)], HOLE_RADIUS - 0.8, WHITE, layer)
        return
    color = CONTOUR if sign == "contours" else BLACK
    width = {"contours": 0.5, "faults": FAULT_WIDTH, "sections": SECTION_WIDTH}[sign]
    drawing.line([(x, y), (x + 1.6 * size, y)], color, width, layer=layer)
