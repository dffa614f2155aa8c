# SPDX-License-Identifier: GPL-3.0-or-later
"""The overlay of a view of a model: legend, north arrow, scale bar, and a box of coordinates."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from .charts import (
    TITLE,
    bar_marks,
    color_bar,
    legend,
    legend_size,
    round_length,
    scale_bar,
    tick_texts,
    ticks,
)
from .drawing import BLACK, PAPER, WHITE, Color, Drawing, text_width

SIZE = 9.0  # of texts, points
_MARGIN = 12.0
_PAD = 0.8 * SIZE
_BAR = (12.0, 110.0)  # width, height of a color bar
_LEAST_AXIS = 40.0  # points: an axis that looks shorter has no ticks
_LIFT = 6.0  # of a label over its place, points
_FLATTEST = 0.35  # how flat the north arrow may lie
_FACES = [(axis, end) for axis in range(3) for end in (0, 1)]
_AXIS_NAMES = ("Easting", "Northing", "Elevation")


@dataclass(frozen=True)
class ColorKey:
    """The key to colors: names with colors, the first on top; or a range (low, high) with its colors (N, 3),
    the lowest first, and names of values in it in place of numbers."""

    title: str
    entries: Sequence[tuple[str, Color]] = ()
    limits: tuple[float, float] | None = None
    colors: np.ndarray | None = None
    names: Sequence[tuple[str, float]] = ()


@dataclass(frozen=True)
class Eye:
    """How a picture looks at the world.

    projection: (4, 4) float64, from the world to x, y, z from -1 to 1 in the picture (after division by the
    fourth). back: (4,) float64: toward the eye, (x, y, z, 0), or where it is, (x, y, z, 1). right, up: (3,).
    size: of the picture, in points.
    """

    projection: np.ndarray
    back: np.ndarray
    right: np.ndarray
    up: np.ndarray
    size: tuple[float, float]

    @property
    def is_perspective(self) -> bool:
        return self.back[3] != 0.0

    def at(self, places: ArrayLike) -> np.ndarray:
        """(N, 2): the positions of places of the world (N, 3) in the picture, in points; NaN for places
        behind the eye."""
        places = np.asarray(places, np.float64).reshape(-1, 3)
        projected = np.column_stack([places, np.ones(len(places))]) @ self.projection.T
        ahead = np.where(projected[:, 3:] > 1e-12, projected[:, 3:], np.nan)
        return (projected[:, :2] / ahead + 1.0) / 2.0 * self.size


@dataclass(frozen=True)
class Shown:
    """The model in the picture. low, high: (3,) model coordinates of the box around it. placed: (4, 4), from
    these to the world. unit: of lengths. exaggeration: of the vertical."""

    low: np.ndarray
    high: np.ndarray
    placed: np.ndarray
    unit: str
    exaggeration: float = 1.0

    def world(self, places: ArrayLike) -> np.ndarray:
        places = np.asarray(places, np.float64).reshape(-1, 3)
        return places @ self.placed[:3, :3].T + self.placed[:3, 3]


def draw_overlay(
    eye: Eye,
    shown: Shown,
    keys: Sequence[ColorKey],
    parts: Collection[str],
    margins: tuple[float, float, float] = (0.0, 0.0, 0.0),
    labels: Sequence[tuple[str, tuple[float, float, float]]] = (),
) -> Drawing:
    """A Drawing as large as the picture. keys: its legends. parts: those of "north", "scale" and "axes" that
    it has. margins: what is covered at the left, at the right, and below legends and scale bar, in points.
    labels: texts and their places in model coordinates; of those in each other's way the first is drawn."""
    drawing = Drawing(*eye.size)
    left, right = margins[0] + _MARGIN, drawing.width - margins[1] - _MARGIN
    low = margins[2] + _MARGIN
    if "axes" in parts:
        _axes(drawing, eye, shown)
    _labels(drawing, eye, shown, labels)
    for key in keys:
        left = _legend(drawing, key, left, low)
    if "scale" in parts:
        _scale_bar(drawing, eye, shown, (left, right), low)
    if "north" in parts:
        _north_arrow(drawing, eye, right)
    return drawing


def _labels(
    drawing: Drawing, eye: Eye, shown: Shown, labels: Sequence[tuple[str, tuple[float, float, float]]]
) -> None:
    taken: list[tuple[float, float, float]] = []  # from left to right, and the height
    places = eye.at(shown.world([place for _, place in labels]))
    for (text, _), (x, y) in zip(labels, places.tolist(), strict=True):
        width = text_width(text, SIZE)
        begin, end, low = x - width / 2 - 2, x + width / 2 + 2, y + _LIFT
        is_seen = 0 < x < drawing.width and 0 < y < drawing.height  # also not of places behind the eye
        if not is_seen or any(begin < b and a < end and abs(low - c) < 1.3 * SIZE for a, b, c in taken):
            continue
        taken.append((begin, end, low))
        drawing.rectangle((begin, low - 2, end - begin, 1.25 * SIZE), PAPER, None)
        drawing.text(x, low, text, SIZE, anchor="middle")


def _paper(drawing: Drawing, x: float, y: float, width: float, height: float) -> None:
    drawing.rectangle((x, y, width, height), PAPER, (0.0, 0.0, 0.0, 0.25), 0.6)


def legend_extent(key: ColorKey) -> tuple[float, float]:
    """Width and height of the background of a legend, in points."""
    if key.colors is None or key.limits is None:
        width, height = legend_size(key.title, key.entries, SIZE)
    else:
        marks = bar_marks(key.limits, _BAR[1], key.names, SIZE)
        width, height = (
            _BAR[0] + 6 + max(text_width(text, SIZE) for text, _ in marks),
            _BAR[1] + (TITLE + 0.5) * SIZE,
        )
        width = max(width, text_width(key.title, SIZE))
    return width + 2 * _PAD, height + 2 * _PAD


def _legend(drawing: Drawing, key: ColorKey, left: float, below: float) -> float:
    """Draws the legend with its lower left corner at a place; returns its right end. Entries without room are
    counted in the last line."""
    most = max(int((drawing.height - below - _MARGIN - 4 * SIZE) / (1.5 * SIZE)), 1)
    if len(key.entries) > most:
        more = (f"and {len(key.entries) - most + 1} more", PAPER)
        key = replace(key, entries=[*key.entries[: most - 1], more])
    width, height = legend_extent(key)
    _paper(drawing, left, below, width, height)
    inner, top = left + _PAD, below + height - _PAD
    if key.colors is None or key.limits is None:
        legend(drawing, (inner, top), key.title, key.entries, SIZE)
    else:
        drawing.text(inner, top - SIZE, key.title, SIZE)
        bar = inner, below + _PAD + 0.4 * SIZE, *_BAR
        color_bar(drawing, bar, key.limits, key.colors, key.names, SIZE)
    return left + width + _MARGIN


def _scale_bar(drawing: Drawing, eye: Eye, shown: Shown, ends: tuple[float, float], low: float) -> None:
    """Draws the scale bar at the bottom, between the ends. In perspective it is valid for the center of the
    model, and labeled so."""
    left, right = ends
    middle = shown.world((shown.low + shown.high) / 2)[0]
    step = 1e-3 * float(np.linalg.norm(shown.high - shown.low)) or 1.0
    here, beside = eye.at([middle, middle + step * eye.right])
    scale = float(np.hypot(*(beside - here))) / step
    most = min(160.0, right - left - 8 * _MARGIN)
    if not (np.isfinite(scale) and scale > 0.0 and most > 40.0):
        return
    notes = ["at the center of the model"] if eye.is_perspective else []
    if shown.exaggeration != 1.0:
        notes.append(f"vertical exaggeration {shown.exaggeration:g}\u00d7")
    length = round_length(most / scale)
    end = text_width(f"{tick_texts(np.array([length]))[0]} {shown.unit}", SIZE) / 2
    pad = 0.8 * SIZE
    width = max(length * scale + 2 * end, *(text_width(note, 0.85 * SIZE) for note in notes), 0.0) + 2 * pad
    height = 2.2 * SIZE + 1.3 * SIZE * len(notes) + 1.2 * pad
    _paper(drawing, left, low, width, height)
    base = low + height - 2.6 * SIZE
    scale_bar(drawing, (left + pad + end, base), most, scale, shown.unit, SIZE)
    for number, note in enumerate(notes):
        drawing.text(left + pad, base - (number + 1.2) * 1.3 * SIZE, note, 0.85 * SIZE)


def _north_arrow(drawing: Drawing, eye: Eye, edge: float) -> None:
    """Draws the north arrow in the lower right corner, lying on the ground: it turns with the view."""
    right = np.array(eye.right[:2]) / (np.hypot(*eye.right[:2]) or 1.0)
    ahead = np.array([-right[1], right[0]])
    slope = float(np.dot(eye.up[:2], ahead))
    slope = np.copysign(max(abs(slope), _FLATTEST), slope if slope else 1.0)

    def on_paper(places: ArrayLike) -> np.ndarray:
        places = np.asarray(places, np.float64)
        return np.column_stack([places @ right, slope * (places @ ahead)]) * radius + middle

    radius = 22.0
    middle = np.array([edge - 1.7 * radius, _MARGIN + 1.7 * radius])
    west, south = middle - 1.7 * radius
    _paper(drawing, west, south, 3.4 * radius, 3.4 * radius)
    tip, foot = (0.0, 1.0), (0.0, -0.55)
    for side, fill in ((-0.55, BLACK), (0.55, WHITE)):
        drawing.polygon(on_paper([tip, (side, -0.9), foot]), fill, BLACK, 0.7)
    x, y = on_paper([(0.0, 1.0)])[0] - middle
    away = (np.array([x, y]) / (np.hypot(x, y) or 1.0)) * 0.8 * SIZE + (x, y)
    x, y = middle + away
    drawing.text(x, y - 0.36 * SIZE, "N", SIZE, anchor="middle")


def _axes(drawing: Drawing, eye: Eye, shown: Shown) -> None:
    """The outline of the box around the model, and ticks along one of its edges in each direction. The
    outline never lies before the model."""
    corners = np.array([shown.low, shown.high])
    if not (corners[1] > corners[0]).any():
        return
    places = eye.at(shown.world(corners.mean(axis=0)))
    if not np.isfinite(places).all():
        return
    center = places[0]
    facing = {}
    for axis, end in _FACES:
        middle = corners.mean(axis=0)
        middle[axis] = corners[end][axis]
        world, normal = shown.world(middle)[0], (1 if end else -1) * np.eye(3)[axis]
        towards = eye.back[:3] - world * eye.back[3]
        facing[axis, end] = float(normal @ towards) > 1e-6 * float(np.linalg.norm(towards))
    for axis in range(3):
        others = [other for other in range(3) if other != axis]
        edges = []
        for ends in ((0, 0), (0, 1), (1, 0), (1, 1)):
            if facing[others[0], ends[0]] == facing[others[1], ends[1]]:
                continue
            begin, end = corners[0].copy(), corners[1].copy()
            for other, at in zip(others, ends, strict=True):
                begin[other] = end[other] = corners[at][other]
            seen = eye.at(shown.world([begin, end]))
            if np.isfinite(seen).all():
                edges.append((seen, begin, end))
                drawing.line(seen, (0.35, 0.35, 0.35), 0.7)
        if edges:
            place = 0 if axis == 2 else 1  # heights at the left, the others below
            chosen = min(edges, key=lambda edge: edge[0][:, place].mean())
            _ticks(drawing, eye, shown, axis, chosen, center)


def _ticks(
    drawing: Drawing,
    eye: Eye,
    shown: Shown,
    axis: int,
    edge: tuple[np.ndarray, np.ndarray, np.ndarray],
    center: np.ndarray,
) -> None:
    (start, stop), begin, end = edge
    along = stop - start
    length = float(np.hypot(*along))
    if length < _LEAST_AXIS:
        return
    out = np.array([-along[1], along[0]]) / length
    if out @ ((start + stop) / 2 - center) < 0:
        out = -out
    across = abs(along[0]) / length  # numbers beside each other need more room than below each other
    values = ticks(begin[axis], end[axis], max(2, int(length / ((6.5 * across + 2.0 * (1 - across)) * SIZE))))
    texts = tick_texts(values)
    at = np.repeat(begin[None], len(values), axis=0)
    at[:, axis] = values
    anchor = "middle" if abs(out[0]) < 0.4 else "start" if out[0] > 0 else "end"
    widest = max(text_width(text, SIZE) for text in texts)
    for place, text in zip(eye.at(shown.world(at)), texts, strict=True):
        drawing.line([place, place + 4 * out], (0.35, 0.35, 0.35), 0.7)
        _label(drawing, place + 7 * out + np.array([0.0, (out[1] - 1) * 0.36 * SIZE]), text, anchor)
    name = f"{_AXIS_NAMES[axis]} ({shown.unit})"
    if abs(out[0]) > 0.9:  # beside an upright edge there is little room: above it
        away = max(start, stop, key=lambda place: place[1]) + 7 * out + (0.0, 1.6 * SIZE)
    else:
        away = (start + stop) / 2 + out * (12 + abs(out[0]) * widest + abs(out[1]) * 1.4 * SIZE)
    _label(drawing, away + np.array([0.0, (out[1] - 1) * 0.36 * SIZE]), name, anchor)


def _label(drawing: Drawing, at: np.ndarray, text: str, anchor: str) -> None:
    """Text on a background, readable over any color."""
    x, y = at.tolist()
    width = text_width(text, SIZE)
    left = x - {"start": 0.0, "middle": 0.5, "end": 1.0}[anchor] * width
    drawing.rectangle((left - 1.5, y - 0.25 * SIZE, width + 3, 1.2 * SIZE), (1.0, 1.0, 1.0, 0.7))
    drawing.text(x, y, text, SIZE, anchor=anchor)
