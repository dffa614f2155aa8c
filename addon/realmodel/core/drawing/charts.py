# SPDX-License-Identifier: GPL-3.0-or-later
"""Common parts of charts, sections, and legends."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from .drawing import BLACK, GRAY, Color, Drawing, text_width

TITLE = 1.8  # height of the title of a legend, in sizes of the text
LINE = 1.5  # from baseline to baseline, in sizes of the text
_TICK = 3.0  # points


def ticks(low: float, high: float, most: int = 6) -> np.ndarray:
    """Round numbers from low to high, `most` or fewer, in steps of 1, 2, or 5 times a power of ten."""
    if not high > low:
        return np.array([low])
    power = 10.0 ** np.floor(np.log10((high - low) / most))
    for step in (1 * power, 2 * power, 5 * power, 10 * power, 20 * power):
        first, last = np.ceil(low / step - 1e-9), np.floor(high / step + 1e-9)
        if last - first < most:
            break
    return step * np.arange(first, last + 1) if last >= first else np.array([low])


def round_length(most: float) -> float:
    """The largest of 1, 2, or 5 times a power of ten that is not above `most`."""
    power = 10.0 ** np.floor(np.log10(most))
    return next(factor * power for factor in (5.0, 2.0, 1.0) if factor * power <= most * (1 + 1e-9))


def tick_texts(values: np.ndarray) -> list[str]:
    """The labels of an axis: as many decimals as make them distinct, thousands separated by commas."""
    step = float(np.diff(values).min()) if len(values) > 1 else abs(float(values[0])) or 1.0
    largest = float(np.abs(values).max())
    if largest >= 1e9 or step < 1e-6:
        return [f"{value:.3g}" for value in values]
    decimals = max(0, int(-np.floor(np.log10(step) + 1e-9)))
    return [f"{round(value, decimals) + 0.0:,.{decimals}f}".replace("-", "\u2212") for value in values]


@dataclass
class Axes:
    """A frame on a drawing: box (x, y, width, height) in points, and the ranges (low, high) that it shows."""

    drawing: Drawing
    box: tuple[float, float, float, float]
    x_range: tuple[float, float]
    y_range: tuple[float, float]
    size: float = 8.0  # of texts

    def at(self, points: ArrayLike) -> np.ndarray:
        """(N, 2) positions in points of x and y (N, 2)."""
        low = np.array([self.x_range[0], self.y_range[0]])
        extent = np.array([self.x_range[1], self.y_range[1]]) - low
        x, y, width, height = self.box
        share = (np.asarray(points, np.float64).reshape(-1, 2) - low) / np.where(extent > 0, extent, 1.0)
        return share * (width, height) + (x, y)

    def frame(self, x_label: str = "", y_label: str = "", layer: str = "") -> None:
        """The box, ticks with their numbers, and the names of the axes."""
        x, y, width, height = self.box
        size, drawing = self.size, self.drawing
        drawing.rectangle((x, y, width, height), stroke=BLACK, line=0.6, layer=layer)
        values, texts, widest = _y_ticks(self.y_range, height, size)
        for value, text in zip(values, texts, strict=True):
            ((_, at),) = self.at([(self.x_range[0], value)]).tolist()
            drawing.line([(x - _TICK, at), (x, at)], width=0.6, layer=layer)
            drawing.text(x - _TICK - 2, at - 0.36 * size, text, size, anchor="end", layer=layer)
        values, texts = self._x_ticks()
        for value, text in zip(values, texts, strict=True):
            ((at, _),) = self.at([(value, self.y_range[0])]).tolist()
            drawing.line([(at, y - _TICK), (at, y)], width=0.6, layer=layer)
            drawing.text(at, y - _TICK - 1.1 * size, text, size, anchor="middle", layer=layer)
        if x_label:
            drawing.text(x + width / 2, y - _TICK - 2.6 * size, x_label, size, anchor="middle", layer=layer)
        if y_label:
            left = x - _TICK - 2 - widest - 0.8 * size
            drawing.text(left, y + height / 2, y_label, size, anchor="middle", angle=90, layer=layer)

    def crosses(self, layer: str = "") -> None:
        """A small cross where the ticks of both axes meet."""
        x, _ = self._x_ticks()
        y, _, _ = _y_ticks(self.y_range, self.box[3], self.size)
        for east, north in self.at([(a, b) for a in x for b in y]).tolist():
            drawing, reach = self.drawing, 0.8 * _TICK
            drawing.line([(east - reach, north), (east + reach, north)], width=0.3, layer=layer)
            drawing.line([(east, north - reach), (east, north + reach)], width=0.3, layer=layer)

    def _x_ticks(self) -> tuple[np.ndarray, list[str]]:
        """As many ticks as there is room for; the first one at least."""
        for most in range(9, 1, -1):
            values = ticks(*self.x_range, most)
            texts = tick_texts(values)
            if sum(text_width(text, self.size) + self.size for text in texts) < self.box[2]:
                return values, texts
        return values[:1], texts[:1]


def _y_ticks(y_range: tuple[float, float], height: float, size: float) -> tuple[np.ndarray, list[str], float]:
    """Values and texts of the ticks of an upright axis, and how wide the widest text is."""
    values = ticks(*y_range, max(1, int(height / (2.6 * size))))
    texts = tick_texts(values)
    return values, texts, max(text_width(text, size) for text in texts)


def left_margin(y_range: tuple[float, float], height: float, size: float) -> float:
    """The width that the numbers and the name of an upright axis take."""
    return _TICK + 2 + _y_ticks(y_range, height, size)[2] + 1.8 * size


def legend(
    drawing: Drawing,
    at: tuple[float, float],
    title: str,
    entries: Sequence[tuple[str, Color]],
    size: float = 8.0,
    layer: str = "",
) -> None:
    """A title, then boxes of color with their names, the first on top. at: the upper left corner."""
    x, y = at
    drawing.text(x, y - size, title, size, layer=layer)
    y -= TITLE * size
    for number, (name, color) in enumerate(entries):
        base = y - (number + 1) * LINE * size + 0.35 * size
        drawing.rectangle((x, base - 0.2 * size, 1.6 * size, 1.1 * size), color, GRAY, 0.4, layer)
        drawing.text(x + 2.2 * size, base, name, size, layer=layer)


def legend_size(title: str, entries: Sequence[tuple[str, Color]], size: float = 8.0) -> tuple[float, float]:
    """The width and height of a legend in points."""
    widest = max((text_width(name, size) for name, _ in entries), default=0.0)
    return max(2.2 * size + widest, text_width(title, size)), (TITLE + len(entries) * LINE) * size


def color_bar(
    drawing: Drawing,
    box: tuple[float, float, float, float],
    limits: tuple[float, float],
    colors: np.ndarray,
    names: Sequence[tuple[str, float]] = (),
    size: float = 8.0,
) -> None:
    """An upright bar of colors (N, 3), the lowest first, in a box (x, y, width, height), with numbers beside
    it. names: of values, in place of the numbers."""
    x, y, width, height = box
    step = height / len(colors)
    for number, color in enumerate(np.asarray(colors)[:, :3].tolist()):
        drawing.rectangle((x, y + number * step, width, height - number * step), tuple(color))
    drawing.rectangle(box, stroke=BLACK, line=0.6)
    marks = bar_marks(limits, height, names, size)
    levels = [y + height * ((value - limits[0]) / ((limits[1] - limits[0]) or 1.0)) for _, value in marks]
    for (text, _), at, base in zip(marks, levels, _apart(levels, 1.1 * size), strict=True):
        drawing.line([(x + width, at), (x + width + _TICK, base)], width=0.6)
        drawing.text(x + width + _TICK + 2, base - 0.36 * size, text, size)


def bar_marks(
    limits: tuple[float, float], height: float, names: Sequence[tuple[str, float]] = (), size: float = 8.0
) -> list[tuple[str, float]]:
    """What stands beside a bar of colors of a height: texts, and the values that they are at, rising."""
    if len(names):
        return sorted(names, key=lambda mark: mark[1])
    values = ticks(*limits, max(3, int(height / (2.5 * size))))
    return list(zip(tick_texts(values), values.tolist(), strict=True))


def _apart(levels: list[float], least: float) -> list[float]:
    """Rising levels moved as little as lets texts there not overlap: runs of them keep their middle."""
    runs: list[tuple[float, int]] = []  # the middle of each, and how many there are
    for level in levels:
        runs.append((level, 1))
        while len(runs) > 1 and runs[-1][0] - runs[-2][0] < 0.5 * least * (runs[-1][1] + runs[-2][1]):
            (high, many), (low, few) = runs.pop(), runs.pop()
            runs.append(((high * many + low * few) / (many + few), many + few))
    return [middle + least * (k - 0.5 * (count - 1)) for middle, count in runs for k in range(count)]


def scale_bar(
    drawing: Drawing, at: tuple[float, float], most: float, scale: float, unit: str, size: float = 8.0
) -> None:
    """A bar of a round length, at most `most` points long, from a place to the right. scale: points for one
    unit."""
    x, y = at
    length = round_length(most / scale)
    step = length * scale / 2
    drawing.rectangle((x, y, step, 0.5 * size), BLACK)
    drawing.rectangle((x, y, 2 * step, 0.5 * size), stroke=BLACK)
    for share, text in ((0.0, "0"), (1.0, f"{tick_texts(np.array([length]))[0]} {unit}")):
        drawing.text(x + 2 * step * share, y + 0.8 * size, text, size, anchor="middle")
