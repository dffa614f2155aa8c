# SPDX-License-Identifier: GPL-3.0-or-later
"""The log of one borehole as a drawing: intervals in their colors by depth, picks, and curves beside them."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from ..drawing.charts import tick_texts, ticks
from ..drawing.drawing import BLACK, GRAY, PAPER, Color, Drawing, text_width
from ..readers.tables.interval_values import IntervalValues
from .sections.hole_curves import limits_of, seen_values, shares_of

_SIZE = 8.0
_PAD, _GAP = 8.0, 6.0
_COLUMN, _TRACK = 22.0, 48.0  # width of the intervals, and of a curve
_HEAD = 3.4 * _SIZE  # room over the depths, for the names
_MOST_CURVES = 4
_CURVE = (0.1, 0.25, 0.6)


class LogPart(NamedTuple):
    """An interval from a depth to a deeper one, with the name of what is there and its color."""

    top: float
    bottom: float
    name: str
    color: Color


@dataclass(frozen=True, eq=False)
class HoleLog:
    """What is known along a borehole. picks: depth and name of each surface that it met. values: of this
    hole; their columns of numbers are curves. Depths are along the hole, in a unit."""

    name: str
    unit: str
    parts: list[LogPart] = field(default_factory=list)
    picks: list[tuple[float, str]] = field(default_factory=list)
    values: IntervalValues | None = None

    def depths(self) -> tuple[float, float]:
        """The depths from which to which something is known."""
        known = [depth for part in self.parts for depth in part[:2]] + [depth for depth, _ in self.picks]
        known += [] if self.values is None else self.values.depths.ravel().tolist()
        return (min(0.0, *known), max(known)) if known else (0.0, 0.0)

    def curves(self) -> list[str]:
        """The columns of numbers that are drawn."""
        columns = {} if self.values is None else self.values.columns
        numbers = (name for name, array in columns.items() if array.dtype.kind == "f")
        return [name for name in numbers if np.isfinite(columns[name]).any()][:_MOST_CURVES]


def draw_hole_log(drawing: Drawing, log: HoleLog, box: tuple[float, float, float]) -> None:
    """Draws a log on a separate paper, whose right border is at x, from its foot up. box: (x, foot,
    height), in points."""
    x, foot, height = box
    low, high = log.depths()
    if not high > low:
        return
    marks = ticks(low, high, max(2, int(height / (4 * _SIZE))))
    texts = tick_texts(marks)
    before = max(text_width(text, _SIZE) for text in texts) + _GAP
    names = [*(part.name for part in log.parts), *(name for _, name in log.picks)]
    beside = max((text_width(name, _SIZE) for name in names), default=0.0) + 2 * _GAP
    tracks = log.curves()
    inner = max(before + _COLUMN + beside + len(tracks) * (_TRACK + _GAP), text_width(log.name, _SIZE + 2))
    left = x - inner - 2 * _PAD
    drawing.rectangle((left, foot, inner + 2 * _PAD, height), PAPER, GRAY, 0.6)
    top, base = foot + height - _PAD - _HEAD, foot + _PAD
    scale = (top - base) / (high - low)
    drawing.text(left + _PAD, foot + height - _PAD - _SIZE, f"{log.name} ({log.unit})", _SIZE + 2)
    start = left + _PAD + before
    for mark, text in zip(marks.tolist(), texts, strict=True):
        y = top - (mark - low) * scale
        drawing.line([(start - 3, y), (start, y)], width=0.6)
        drawing.text(start - 5, y - 0.36 * _SIZE, text, _SIZE, anchor="end")
    for part in log.parts:
        y = top - (part.bottom - low) * scale
        drawing.rectangle((start, y, _COLUMN, (part.bottom - part.top) * scale), part.color, BLACK, 0.4)
    _names(drawing, log, start + _COLUMN, (low, top, scale))
    for number, name in enumerate(tracks):
        _curve(drawing, log, name, start + _COLUMN + beside + number * (_TRACK + _GAP), (low, top, scale))


def _names(drawing: Drawing, log: HoleLog, x: float, at: tuple[float, float, float]) -> None:
    """Names of picks at their depths, and of intervals in their middles, where there is room between them."""
    low, top, scale = at
    wanted = [(depth, name, True) for depth, name in log.picks]
    wanted += [(0.5 * (part.top + part.bottom), part.name, False) for part in log.parts]
    taken: list[float] = []
    for depth, name, is_pick in wanted:
        y = top - (depth - low) * scale
        if is_pick:
            drawing.line([(x - _COLUMN, y), (x + _GAP, y)], width=1.4)
        if all(abs(y - other) > 1.1 * _SIZE for other in taken):
            taken.append(y)
            drawing.text(x + _GAP + 2, y - 0.36 * _SIZE, name, _SIZE)


def _curve(drawing: Drawing, log: HoleLog, name: str, x: float, at: tuple[float, float, float]) -> None:
    """A column of numbers as a line from its lowest value, at the left, to its highest."""
    assert log.values is not None
    low, top, scale = at
    values = seen_values(log.values, name)
    array = values.columns[name]
    limits = limits_of(array)
    across = x + _TRACK * shares_of(array, limits)
    y = top - (values.depths - low) * scale
    foot = top - (log.depths()[1] - low) * scale
    drawing.rectangle((x, foot, _TRACK, top - foot), None, GRAY, 0.4)
    gaps = np.flatnonzero(np.diff(values.depths.ravel()[1:-1].reshape(-1, 2), axis=1)[:, 0] > 1e-9) + 1
    for run in np.split(np.arange(len(array)), gaps):
        line = np.column_stack([np.repeat(across[run], 2), y[run].ravel()])
        drawing.line(line, _CURVE, 0.7)
    size = min(_SIZE, _SIZE * _TRACK / max(text_width(name, _SIZE), 1e-9))
    drawing.text(x + _TRACK / 2, top + 1.4 * _SIZE, name, size, anchor="middle")
    for at_x, value, anchor in ((x, limits[0], "start"), (x + _TRACK, limits[1], "end")):
        drawing.text(at_x, top + 3, f"{value:.4g}", _SIZE - 2, anchor=anchor)
