# SPDX-License-Identifier: GPL-3.0-or-later
"""Sections and fences as drawings: blocks in their colors at a round scale, with axes, a legend in order of
age, and the coordinates of both ends."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from functools import partial
from itertools import pairwise

import numpy as np

from ...base.errors import UsageError
from ...base.units import METERS
from ...drawing.charts import Axes, legend, legend_size, tick_texts
from ...drawing.drawing import BLACK, WHITE, Color, Drawing, text_width
from .section_curves import HoleCurves, Panel
from .section_data import FenceData, SectionData
from .section_holes import UNKNOWN, HoleLine, parts_near

MOST_EXAGGERATION = 1000.0
SCALES = (1.0, 2.0, 2.5, 5.0)  # round ones, times a power of ten
_POINT = 0.0254 / 72  # meters
_PLOT = (560.0, 360.0)  # maximal size of the section on the page, in points
_LEFT, _BELOW, _ABOVE, _GAP = 62.0, 44.0, 58.0, 16.0  # around it
_SIZE = 8.0
_FAULT_WIDTH, _HOLE_WIDTH = 1.4, 3.0
_HOLES = "Boreholes"  # layer of the drawing
_NAME_ABOVE = 4  # a name over the end of a hole
_HIGHEST_NAME = 6  # lines over the end of a hole, where others have taken those below
_SKY = 0.05  # of the height, left free above vertical sections
_SAME = 1e9  # of the extent of a section: places nearer than one part are the same
_LINE = _SIZE + 3  # height of a line of coordinates
_LEGEND = "Block"  # title of the legend; views have the names of properties
_BEND = 10.0  # degrees by which a fence turns where a line shows its bend: a curve has many small ones
_UPRIGHT = 1e-6  # z of a unit normal below which a plane is vertical


def draw_section(
    section: SectionData,
    exaggeration: float = 1.0,
    title: str | None = None,
    cells: tuple[np.ndarray, np.ndarray] | None = None,
    hole_width: float = 0.0,
    hole_column: str | None = None,
) -> Drawing:
    """The section on a page, in its own coordinates at a scale of 1, 2, 2.5, or 5 times a power of ten.

    exaggeration: of heights, where the section is vertical. The drawing's layers are named after the blocks.
    cells: corners (N, 4, 2), as of `flattened`, and colors (N, 3) of what is drawn below the outlines of the
    blocks, in place of their colors. hole_width: boreholes within this distance of the section are drawn on
    it, with their names; of a fence on the panel beside which they lie. hole_column: of section.hole_values,
    drawn beside the holes as a curve with a color bar.
    Raises UsageError for a section that is empty or not plane, or an exaggeration that is not above 0.
    """
    plot = SectionPlot(section, exaggeration, hole_width, hole_column, cells)
    ratio, scale = page_scale(plot.extent(), section.unit)
    if plot.leave_room_for_names(scale):
        ratio, scale = page_scale(plot.extent(), section.unit)
    width, height = plot.extent() * scale
    entries, curves = plot.entries(), plot.curves
    legend_width, legend_height = legend_size(_LEGEND, entries, _SIZE)
    bar_width, bar_height = (0.0, 0.0) if curves is None else curves.key_size(_SIZE)
    legend_width = max(legend_width, bar_width)
    below_title = subtitle(section, ratio, plot.exaggeration)
    title = title or section.name
    above = _ABOVE + plot.height_of_ends(width)
    page = max(
        _LEFT + width + _GAP + legend_width,
        *(20 + text_width(text, _SIZE + 3) for text in (title, below_title)),
        *(_LEFT + 20 + text_width(text, _SIZE - 1) for text in plot.ends),
    )
    plot_height = max(height, legend_height + bar_height)
    drawing = Drawing(float(page) + 12, float(_BELOW + plot_height + above))
    base = _BELOW + plot_height - height
    drawing.scale, drawing.origin = (
        float(scale),
        (_LEFT - scale * plot.low[0], base - scale * plot.exaggeration * plot.low[1]),
    )
    plot.draw(drawing, (_LEFT, base), scale, ("A", "B"))
    legend(drawing, (_LEFT + width + _GAP, base + height), _LEGEND, entries, _SIZE, layer="Legend")
    if curves is not None:
        curves.draw_key(drawing, (_LEFT + width + _GAP, base + height - legend_height), _SIZE)
    top = drawing.height - 20
    drawing.text(_LEFT, top, title, _SIZE + 3, layer="Text")
    drawing.text(_LEFT, top - 1.6 * _SIZE, below_title, _SIZE, layer="Text")
    return drawing


class SectionPlot:
    """A section in its frame, at any scale: what drawings of sections and sheets share.

    low, high: (2,) float64, what it shows in the plane of the picture. present: the numbers of the blocks in
    it, the youngest first. ends: texts of the places of its ends. curves: those beside the holes, or None.
    """

    def __init__(
        self,
        section: SectionData,
        exaggeration: float = 1.0,
        hole_width: float = 0.0,
        hole_column: str | None = None,
        cells: tuple[np.ndarray, np.ndarray] | None = None,
    ):
        """As of draw_section. Raises UsageError."""
        if not 0 < exaggeration <= MOST_EXAGGERATION:
            raise UsageError(
                f"exaggeration must be above 0 and at most {MOST_EXAGGERATION:g}, not {exaggeration!r}"
            )
        if not len(section):
            raise UsageError("there is nothing to draw: the section does not meet the model")
        self.section, self._cells, self._flat = section, cells, flattened(section)
        self.exaggeration = exaggeration if is_vertical(section) else 1.0
        self.curves = (
            None if hole_column is None else HoleCurves(section.hole_values, hole_column, hole_width)
        )
        self._holes = holes_on(section, hole_width) if hole_width > 0 else []
        shown = [self._flat, *([] if cells is None else [cells[0].reshape(-1, 2)])]
        places = np.concatenate([*shown, *(line for _, line in self._holes)])
        self.low, self.high = places.min(axis=0), places.max(axis=0)
        if isinstance(section, FenceData):
            self.low[0], self.high[0] = 0.0, section.length
        if is_vertical(section):
            self.high[1] += _SKY * (self.high[1] - self.low[1])
        self._top = float(self.high[1])
        self.present = [int(block) for block in np.unique(section.block)[::-1]]
        self.ends = _end_texts(section, self._flat)

    def extent(self) -> np.ndarray:
        """(2,) float64: width and exaggerated height, model units."""
        least = 1e-9 * max(np.abs(self._flat).max(), 1.0)
        return np.maximum(self.high - self.low, least) * (1.0, self.exaggeration)

    def entries(self) -> list[tuple[str, Color]]:
        """Names and colors of the legend."""
        section = self.section
        return [(section.block_names[block], tuple(section.block_colors[block])) for block in self.present]

    def leave_room_for_names(self, scale: float) -> bool:
        """Makes it higher, so that a line of names over the holes is within the frame. scale: points for a
        unit. Returns whether there are holes."""
        if self._holes:
            sky = self._top - max(line[:, 1].max() for _, line in self._holes)
            room = (_NAME_ABOVE + _SIZE) / (scale * self.exaggeration)
            self.high[1] = self._top + max(0.0, room - sky)
        return bool(self._holes)

    def height_of_ends(self, width: float) -> float:
        """What the coordinates of the ends take above a frame of a width, in points: nothing where they are
        beside each other."""
        return 0.0 if self._are_beside(width) else len(self.ends) * _LINE

    def _are_beside(self, width: float) -> bool:
        return width > sum(text_width(text, _SIZE - 1) for text in self.ends) + 40

    def draw(self, drawing: Drawing, at: tuple[float, float], scale: float, letters: tuple[str, str]) -> None:
        """Draws it with its lower left corner at a place in points. scale: points for a unit. letters: over
        its ends, where it is vertical."""
        section = self.section
        width, height = (self.extent() * scale).tolist()
        (left, right), (bottom, top) = zip(self.low.tolist(), self.high.tolist(), strict=True)
        axes = Axes(drawing, (*at, width, height), (left, right), (bottom, top), _SIZE)
        for corners, color in zip(*(self._cells or ((), ())), strict=True):
            drawing.polygon(
                axes.at(corners), tuple(color.tolist()), tuple(color.tolist()), 0.3, layer="Cells"
            )
        for block, (name, color) in zip(self.present, self.entries(), strict=True):
            rings = [axes.at(ring) for ring in block_outlines(section, self._flat, block)]
            drawing.polygon(rings, color if self._cells is None else None, BLACK, 0.35, layer=name)
        _draw_faults(drawing, axes, section)
        if self.curves is not None:
            self.curves.draw(axes, list(panels_of(section)))
        _draw_holes(drawing, axes, section, self._holes)
        axes.frame(*_axis_names(section), layer="Axes")
        _draw_ends(drawing, axes, section, self.ends, self._are_beside(width), letters)


def is_vertical(section: SectionData) -> bool:
    """Whether heights are upright in the picture: of fences and vertical planes."""
    return isinstance(section, FenceData) or abs(_unit_normal(section)[2]) < _UPRIGHT


def flattened(section: SectionData) -> np.ndarray:
    """(V, 2) float64: the vertices in the plane of the picture.

    Of a fence and a vertical plane the distance from its left end and the elevation, of a level plane x and
    y, of others distances along strike and up dip. Planes are seen from where their normal points.
    """
    return section.unrolled() if isinstance(section, FenceData) else flat_of(section, section.vertices)


def flat_of(section: SectionData, points: np.ndarray) -> np.ndarray:
    """(N, 2) points (N, 3) on the plane of a section as it is drawn."""
    right, up = directions(section)
    if right is None or up is None:
        return points[:, :2]
    if is_vertical(section):
        return np.column_stack([points @ right - (section.vertices @ right).min(), points[:, 2]])
    axes = np.column_stack([right, up])
    point, _ = plane_of(section)
    return (points - point) @ axes - ((section.vertices - point) @ axes).min(axis=0)


def holes_on(section: SectionData, width: float) -> list[tuple[HoleLine, np.ndarray]]:
    """The parts of boreholes within a width of a section, moved onto it, and their corners (N, 2) as they are
    drawn."""
    return [
        (part, panel.drawn(part.places))
        for panel in panels_of(section)
        for part in parts_near(section.holes, panel.plane, width, panel.span)
    ]


def panels_of(section: SectionData) -> Iterator[Panel]:
    """The planes of a section: one, or those of the panels of a fence."""
    if not isinstance(section, FenceData):
        yield Panel(plane_of(section), None, partial(flat_of, section))
        return
    for number, (start, end) in enumerate(pairwise(section.polyline)):
        plane = np.append(start, 0.0), np.array([end[1] - start[1], start[0] - end[0], 0.0])
        yield Panel(plane, (start, end), partial(section.along_panels, panel=np.array(number)))


def _draw_holes(
    drawing: Drawing, axes: Axes, section: SectionData, holes: list[tuple[HoleLine, np.ndarray]]
) -> None:
    """Draws boreholes as lines in the colors of the blocks that are known along them, with black borders;
    each name once, over the upper end, where there is room."""
    named, top = set(), axes.box[1] + axes.box[3]
    taken: list[tuple[float, float, float]] = []  # where names are: from left to right, and the height
    for hole, flat in holes:
        points = axes.at(flat)
        drawing.line(points, BLACK, _HOLE_WIDTH + 1.2, layer=_HOLES)
        for k, block in enumerate(hole.blocks.tolist()):
            color = WHITE if block == UNKNOWN else tuple(section.block_colors[block])
            drawing.line(points[k : k + 2], color, _HOLE_WIDTH, layer=_HOLES)
            drawing.dots(points[k + 1 : k + 2], _HOLE_WIDTH / 2, BLACK, layer=_HOLES)
        if hole.name not in named:
            x, y = points[np.argmax(points[:, 1])].tolist()
            half = text_width(hole.name, _SIZE) / 2
            lifted = [(x - half, x + half, y + _NAME_ABOVE + _LINE * k) for k in range(_HIGHEST_NAME)]
            lifted = [span for k, span in enumerate(lifted) if k == 0 or span[2] + _SIZE < top]
            place = next((span for span in lifted if not any(_overlap(span, one) for one in taken)), None)
            if place is not None:
                taken.append(place)
                drawing.text(x, place[2], hole.name, _SIZE, anchor="middle", layer=_HOLES)
        named.add(hole.name)


def _draw_faults(drawing: Drawing, axes: Axes, section: SectionData) -> None:
    """Draws faults as thick lines, with their names beside the lower end, or as low as other names and lines
    of faults allow."""
    lines = []
    for trace in section.faults:
        points = trace.ends.reshape(-1, 3)
        if isinstance(section, FenceData):
            flat = section.along_panels(points, np.repeat(trace.panel, 2))
        else:
            flat = flat_of(section, points)
        lines.append(axes.at(flat).reshape(-1, 2, 2))
    taken: list[tuple[float, float, float]] = []  # where names are: from left to right, and the height
    for trace, fault_lines in zip(section.faults, lines, strict=True):
        for line in fault_lines:
            drawing.line(line, BLACK, _FAULT_WIDTH, layer=trace.name)
        places = _name_places(axes, fault_lines, text_width(trace.name, _SIZE))
        apart = [place for place in places if not any(_overlap(place, other) for other in taken)] or places
        every = np.concatenate(lines)
        begin, end, height = next((place for place in apart if not _is_crossed(place, every)), apart[0])
        taken.append((begin, end, height))
        drawing.text(begin, height, trace.name, _SIZE, layer=trace.name)


def _name_places(axes: Axes, lines: np.ndarray, width: float) -> list[tuple[float, float, float]]:
    """Where a name of a width may stand beside the ends of lines (N, 2, 2), the lowest first: from left to
    right, and the height; at an end right of it where there is room, then left of it."""
    left, right = axes.box[0], axes.box[0] + axes.box[2]
    places, ends = [], lines.reshape(-1, 2)
    for x, y in ends[np.argsort(ends[:, 1], kind="stable")].tolist():
        fits = x + width + 8 < right
        begins = [x + 4] if fits else []
        if not fits or x - 4 - width > left:
            begins.append(x - 4 - width)
        places += [(begin, begin + width, y + 4) for begin in begins]
    return places


def _is_crossed(place: tuple[float, float, float], lines: np.ndarray) -> bool:
    """Whether a line of (N, 2, 2) goes through a name."""
    begin, end, height = place
    start, step = lines[:, 0], lines[:, 1] - lines[:, 0]
    step = np.where(step == 0, np.finfo(float).tiny, step)
    with np.errstate(over="ignore"):
        sides = np.stack(
            [(np.array(side) - start) / step for side in ((begin, height), (end, height + _SIZE))]
        )
    enters, leaves = sides.min(axis=0).max(axis=1), sides.max(axis=0).min(axis=1)
    return bool(((enters <= leaves) & (leaves >= 0) & (enters <= 1)).any())


def _overlap(one: tuple[float, float, float], other: tuple[float, float, float]) -> bool:
    """Whether two names, each from left to right at a height, are in each other's way."""
    return one[0] < other[1] and other[0] < one[1] and abs(one[2] - other[2]) < 1.2 * _SIZE


def block_outlines(section: SectionData, flat: np.ndarray, block: int) -> list[np.ndarray]:
    """The rings (N, 2) around all polygons of a block, joined where they share an edge; holes turn the other
    way.

    flat: (V, 2), where the vertices are drawn.
    """
    return outlines(section, flat, np.flatnonzero(section.block == block))


def outlines(section: SectionData, flat: np.ndarray, chosen: np.ndarray) -> list[np.ndarray]:
    """As block_outlines, of chosen polygons, (N,) their numbers."""
    counts = np.diff(section.offsets)[chosen]
    begins = np.cumsum(counts) - counts
    corner = np.arange(counts.sum()) + np.repeat(section.offsets[chosen] - begins, counts)
    following = corner + 1
    following[begins + counts - 1] = section.offsets[chosen]
    extent = float(np.ptp(flat, axis=0).max()) or 1.0
    places = np.rint(
        (flat - flat.min(axis=0)) * (_SAME / extent)
    )  # the panels of a fence share bends, not vertices
    _, number = np.unique(places, axis=0, return_inverse=True)
    at = number.reshape(-1)[section.polygon_vertices]
    some = np.empty(at.max() + 1, np.int64)
    some[at] = section.polygon_vertices
    # Thin polygons may have an edge several times once their corners are joined: each cancels one only.
    edges = Counter(zip(at[corner].tolist(), at[following].tolist(), strict=True))
    onward: dict[int, list[int]] = {}
    for (a, b), count in edges.items():
        if a != b and count > edges.get((b, a), 0):
            onward.setdefault(a, []).extend([b] * (count - edges.get((b, a), 0)))
    rings = []
    for first in sorted(onward):
        while onward[first]:
            ring, at = [], first
            while onward.get(at):
                ring.append(at)
                at = onward[at].pop()
            rings.append(flat[some[ring]])
    return rings


def plane_of(section: SectionData) -> tuple[np.ndarray, np.ndarray]:
    """The point and the unit normal of the plane of a section. Raises UsageError where it has none."""
    if section.plane is None:
        raise UsageError("only sections by a plane and fences are drawn")
    point, normal = (np.asarray(vector, np.float64) for vector in section.plane)
    return point, normal / np.linalg.norm(normal)


def _unit_normal(section: SectionData) -> np.ndarray:
    return plane_of(section)[1]


def directions(section: SectionData) -> tuple[np.ndarray | None, np.ndarray | None]:
    """Unit vectors to the right and up in the picture; None for a level plane, which is drawn as a map."""
    normal = _unit_normal(section)
    right = np.array([-normal[1], normal[0], 0.0])
    length = np.linalg.norm(right)
    if length < _UPRIGHT:
        return None, None
    right /= length
    return right, np.cross(normal, right)


def points_for_unit(ratio: float, unit: str) -> float:
    """How long a unit is on paper at a scale 1 : ratio, in points."""
    return float(METERS[unit]) / ratio / _POINT


def page_scale(extent: np.ndarray, unit: str) -> tuple[float, float]:
    """The ratio N of a scale 1 : N at which the extent fits the page, and points for a unit."""
    least = float((extent * float(METERS[unit]) / (np.array(_PLOT) * _POINT)).max())
    power = 10.0 ** np.floor(np.log10(least))
    ratio = next(f * power for f in (*SCALES, 10.0) if f * power >= least * (1 - 1e-9))
    return ratio, points_for_unit(ratio, unit)


def scale_text(ratio: float) -> str:
    """The text of a scale."""
    return f"1 : {ratio:,.0f}" if ratio >= 10 else f"1 : {ratio:g}"


def subtitle(section: SectionData, ratio: float, exaggeration: float) -> str:
    """What a section is drawn at: its scale, and its exaggeration or its plane."""
    text = f"Scale {scale_text(ratio)}"
    if is_vertical(section):
        return f"{text}, vertical exaggeration {exaggeration:g}"
    normal = _unit_normal(section)
    if abs(normal[2]) > 1 - _UPRIGHT:
        return f"{text}, map at elevation {tick_texts(section.vertices[:1, 2])[0]} {section.unit}"
    dip = np.degrees(np.arccos(abs(normal[2])))
    azimuth = np.degrees(np.arctan2(*(normal[:2] * np.sign(normal[2])))) % 360
    return f"{text}, plane that dips {dip:.1f}° to azimuth {azimuth:.0f}°"


def _axis_names(section: SectionData) -> tuple[str, str]:
    if is_vertical(section):
        names = ("Distance", "Elevation")
    elif directions(section)[0] is None:
        names = ("East (x)", "North (y)")
    else:
        names = ("Distance along strike", "Distance up dip")
    return f"{names[0]} ({section.unit})", f"{names[1]} ({section.unit})"


def _end_texts(section: SectionData, flat: np.ndarray) -> list[str]:
    """The plan coordinates of the left and the right end of a vertical section; none of others."""
    if not is_vertical(section):
        return []
    if isinstance(section, FenceData):
        ends = section.polyline[[0, -1]]
    else:
        ends = section.vertices[[np.argmin(flat[:, 0]), np.argmax(flat[:, 0])], :2]
    return [f"x {east:,.1f}  y {north:,.1f}" for east, north in ends.tolist()]


def _turns(polyline: np.ndarray) -> np.ndarray:
    """(N - 2,) degrees by which a polyline (N, 2) turns at its points between the ends."""
    x, y = np.diff(polyline, axis=0).T
    across, along = x[:-1] * y[1:] - y[:-1] * x[1:], x[:-1] * x[1:] + y[:-1] * y[1:]
    return np.degrees(np.abs(np.arctan2(across, along)))


def _draw_ends(
    drawing: Drawing,
    axes: Axes,
    section: SectionData,
    ends: list[str],
    are_beside: bool,
    letters: tuple[str, str],
) -> None:
    """Letters and coordinates above the ends of a vertical section, and a line at each bend. are_beside: the
    coordinates are on one line; else they are on their own lines, with their letters."""
    x, y, width, height = axes.box
    if isinstance(section, FenceData):
        for at in section.bends[1:-1][_turns(section.polyline) > _BEND]:
            ((place, _),) = axes.at([(at, axes.y_range[0])]).tolist()
            drawing.line([(place, y), (place, y + height)], BLACK, 0.4, 3.0, layer="Axes")
    sides = ("start", "end")
    if width < sum(text_width(letter, _SIZE + 1) for letter in letters) + _SIZE:
        sides = ("end", "start")  # no room for both over the section
    corners = (x, sides[0], 12), (x + width, sides[1], -12)
    for number, (letter, text, (at, anchor, away)) in enumerate(zip(letters, ends, corners, strict=False)):
        drawing.text(at, y + height + 5, letter, _SIZE + 1, anchor=anchor, layer="Text")
        if are_beside:
            drawing.text(at + away, y + height + 5.5, text, _SIZE - 1, anchor=anchor, layer="Text")
        else:
            over = y + height + 5.5 + (len(ends) - number) * _LINE
            drawing.text(x, over, letter, _SIZE - 1, layer="Text")
            drawing.text(x + 12, over, text, _SIZE - 1, layer="Text")
