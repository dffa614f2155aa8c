# SPDX-License-Identifier: GPL-3.0-or-later
"""Curves beside the boreholes of a drawn section, with the bar of their colors."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from ...base.algebra import begins_run, norm
from ...base.errors import UsageError, number_list
from ...drawing.charts import TITLE, Axes, color_bar, tick_texts
from ...drawing.color_scale import colors
from ...drawing.drawing import BLACK, GRAY, Drawing, text_width
from ...readers.tables.interval_values import IntervalValues
from .hole_curves import bars, limits_of, seen_values, shares_of, sides_of
from .section_holes import near_panel

_GAP, _WIDTH = 4.0, 36.0  # from the middle of a hole to the lowest value, and on to the highest, in points
_OF_DISTANCE, _LEAST_WIDTH = 0.4, 10.0  # of the distance of the nearest holes; in points
_OF_LENGTH = 1.0  # values for a point of the longest hole
_LINE = 0.35
_BAR = (10.0, 80.0)  # width and height of the color bar
_STEPS = 32  # of it
_LAYER = "Curves"


class Panel(NamedTuple):
    """A plane of a section, as point and normal. span: as of near_panel. drawn(places): (N, 2) where places
    (N, 3) on it are drawn."""

    plane: tuple[np.ndarray, np.ndarray]
    span: tuple[np.ndarray, np.ndarray] | None
    drawn: Callable[[np.ndarray], np.ndarray]


class HoleCurves:
    """A column of values along boreholes, drawn beside those within a width of a section."""

    def __init__(self, values: IntervalValues | None, column: str, width: float):
        """column: its name, with or without its unit. Raises UsageError where there is no such column of
        numbers, or no width."""
        if not width > 0:
            raise UsageError("a curve is drawn beside boreholes: give hole_width, too")
        self.name = _column_of(values, column)
        assert values is not None
        self._width = width
        self._values = seen_values(values, self.name)
        self._limits = limits_of(self._values.columns[self.name])

    def draw(self, axes: Axes, panels: Sequence[Panel]) -> None:
        """Draws the curves of panels: right of the holes or, where there is no room, left of them; narrower
        where holes are near each other, and with no more values than can be seen."""
        drawn = [self._on(axes, panel, self._values) for panel in panels]
        longest, places = 0.0, []
        for values, begin, end in drawn:
            for hole in dict.fromkeys(values.holes.tolist()):
                of_hole = values.holes == hole
                longest = max(longest, float(norm(end[of_hole][-1] - begin[of_hole][0])))
                places.append((begin[of_hole][0, 0], end[of_hole][-1, 0]))
        apart = np.abs(np.diff(np.array(sorted(places)).reshape(-1, 2), axis=0))
        width = float(np.clip(_OF_DISTANCE * apart.min(initial=np.inf), _LEAST_WIDTH, _WIDTH))
        seen = seen_values(self._values, self.name, max(int(_OF_LENGTH * longest), 2))
        for panel in panels:
            self._draw_panel(axes, *self._on(axes, panel, seen), width)

    def _on(
        self, axes: Axes, panel: Panel, values: IntervalValues
    ) -> tuple[IntervalValues, np.ndarray, np.ndarray]:
        """Values near a panel, and both ends (N, 2) of their intervals as they are drawn."""
        numbers, begin, end = near_panel(values.begins, values.ends, panel.plane, self._width, panel.span)
        return values.some(numbers), axes.at(panel.drawn(begin)), axes.at(panel.drawn(end))

    def _draw_panel(
        self, axes: Axes, values: IntervalValues, begin: np.ndarray, end: np.ndarray, width: float
    ) -> None:
        if not len(values.holes):
            return
        array = values.columns[self.name]
        sides = sides_of(values.holes, begin, end, np.array([1.0, 0.0]), np.array([0.0, 1.0]))
        right = axes.box[0] + axes.box[2] - _GAP - width
        for hole in dict.fromkeys(values.holes.tolist()):
            of_hole = values.holes == hole
            if (np.maximum(begin, end)[of_hole, 0] > right).any():
                sides[of_hole, 0] *= -1.0
        corners = bars(begin, end, sides, shares_of(array, self._limits), _GAP, width)
        fills = colors(array, self._limits)[:, :3].tolist()
        for bar, fill in zip(corners, fills, strict=True):
            axes.drawing.polygon(bar, tuple(fill), tuple(fill), 0.2, layer=_LAYER)
        for run in np.split(np.arange(len(array)), self._ends_of_runs(values)):
            axes.drawing.line(corners[run][:, [3, 2]].reshape(-1, 2), BLACK, _LINE, layer=_LAYER)
            for side in (_GAP, _GAP + width):  # at the low and the high
                along = np.concatenate([begin[run], end[run[-1:]]]) + side * sides[run[0]]
                axes.drawing.line(along, GRAY, _LINE, layer=_LAYER)

    @staticmethod
    def _ends_of_runs(values: IntervalValues) -> np.ndarray:
        """Before which intervals there is a gap, or another hole begins."""
        is_new = begins_run(values.holes[:, None])
        is_new[1:] |= values.depths[1:, 0] > values.depths[:-1, 1]
        return np.flatnonzero(is_new)[1:]

    def key_size(self, size: float) -> tuple[float, float]:
        """Width and height of the color bar with its texts, in points."""
        widest = max(text_width(text, size) for text, _ in self._marks())
        width = max(_BAR[0] + 6 + widest, text_width(self.name, size))
        return width, (2 * TITLE + 0.5) * size + _BAR[1]

    def draw_key(self, drawing: Drawing, at: tuple[float, float], size: float) -> None:
        """Draws the color bar: the name with the unit, the low and the high. at: its upper left corner."""
        x, y = at[0], at[1] - TITLE * size
        drawing.text(x, y - size, self.name, size, layer="Legend")
        bar = x, y - TITLE * size - _BAR[1], *_BAR
        low, high = self._limits
        shades = colors(np.linspace(low, high, _STEPS), self._limits)[:, :3]
        color_bar(drawing, bar, self._limits, shades, self._marks(), size)

    def _marks(self) -> list[tuple[str, float]]:
        low, high = self._limits
        return list(zip(_texts(low, high), (low, high), strict=True))


def _texts(low: float, high: float) -> list[str]:
    """The low and the high with three digits of their difference."""
    step = (high - low) / 1000 or abs(high) / 1000 or 1.0
    power = 10.0 ** np.floor(np.log10(step))
    return [text for value in (low, high) for text in tick_texts(np.array([value, value + power]))[:1]]


def _column_of(values: IntervalValues | None, column: str) -> str:
    names = [] if values is None else [n for n, array in values.columns.items() if array.dtype.kind == "f"]
    if column in names:
        return column
    wanted = column.casefold()
    alike = [name for name in names if wanted in (name.casefold(), name.rpartition(" (")[0].casefold())]
    if len(alike) != 1:
        choices = number_list(names) if names else "there are none; give logs = ... in boreholes"
        raise UsageError(f"there is no column '{column}' of numbers along the boreholes: {choices}")
    return alike[0]
