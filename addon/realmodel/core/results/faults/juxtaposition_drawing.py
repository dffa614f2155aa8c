# SPDX-License-Identifier: GPL-3.0-or-later
"""Juxtaposition diagrams as drawings: the footwall filled, the hanging wall hatched, and the throw below."""

from __future__ import annotations

import numpy as np

from ...base.algebra import dot
from ...base.errors import UsageError
from ...drawing.charts import Axes, legend, legend_size
from ...drawing.drawing import GRAY, Color, Drawing, text_width
from ..sections.section_drawing import MOST_EXAGGERATION, outlines, page_scale
from .juxtaposition import FOOTWALL, HANGING_WALL, SIDES, JuxtapositionData

_SIZE = 8.0
_LEFT, _BELOW, _GAP, _ABOVE = 62.0, 44.0, 16.0, 62.0
_PROFILE = 90.0  # height of the throw profile
_HATCH = 5.0  # points from line to line
_DASH = 3.0
_SHADE = 0.55  # of the color of a block, in which it is hatched
_NONE = (0.94, 0.94, 0.94)  # where there is no rock in the footwall
_LINES = ((0.10, 0.10, 0.10), (0.80, 0.20, 0.15), (0.12, 0.42, 0.70), (0.15, 0.55, 0.25), (0.55, 0.25, 0.65))
_ROOM = 1.1  # of the range of throws


def draw_juxtaposition(fault: JuxtapositionData, exaggeration: float = 1.0) -> Drawing:
    """The fault unrolled along its strike, seen from the hanging wall, over the throws of its surfaces.

    exaggeration: of elevations. Areas in the picture are those of the fault on a vertical surface; its true
    ones are `areas`. Raises UsageError for a fault that has no height in the model, or an exaggeration that
    is not above 0.
    """
    if not 0 < exaggeration <= MOST_EXAGGERATION:
        raise UsageError(
            f"exaggeration must be above 0 and at most {MOST_EXAGGERATION:g}, not {exaggeration!r}"
        )
    flat = fault.unrolled()
    if not len(fault) or not (np.ptp(flat, axis=0) > 0).all():
        raise UsageError(f"nothing to draw: fault '{fault.fault}' has no vertical extent in the model")
    low, high = flat.min(axis=0), flat.max(axis=0)
    extent = (high - low) * (1.0, exaggeration)
    ratio, scale = page_scale(extent, fault.unit)
    width, height = extent * scale
    present = [block for block in np.unique(fault.blocks)[::-1].tolist() if block >= 0]
    entries = [(fault.block_names[block], tuple(fault.block_colors[block])) for block in present]
    surfaces = list(dict.fromkeys(line.surface for line in fault.cutoffs))
    colors = [(name, _LINES[k % len(_LINES)]) for k, name in enumerate(surfaces)]
    keys = (("Block", entries), ("Cutoff line, throw", colors))
    key_width = max(legend_size(title, entry, _SIZE)[0] for title, entry in keys)
    key_height = sum(legend_size(title, entry, _SIZE)[1] + _SIZE for title, entry in keys)
    texts = (
        f"Scale 1 : {ratio:,.0f}, vertical exaggeration {exaggeration:g}, seen from the hanging wall",
        "Footwall: filled, solid cutoff lines. Hanging wall: hatched, dashed cutoff lines.",
    )
    page = max(_LEFT + width + _GAP + key_width, *(_LEFT + text_width(text, _SIZE) for text in texts)) + 12
    base = _BELOW + _PROFILE + _BELOW
    upper = max(height, key_height - base)  # the keys stand beside both diagrams
    drawing = Drawing(float(page), float(base + upper + _ABOVE))
    base += upper - height
    drawing.scale = float(scale)
    drawing.origin = (_LEFT - scale * low[0], base - scale * exaggeration * low[1])
    axes = Axes(drawing, (_LEFT, base, width, height), (low[0], high[0]), (low[1], high[1]), _SIZE)
    _draw_blocks(axes, fault, flat)
    _draw_cutoffs(axes, fault, dict(colors))
    axes.frame("", f"Elevation ({fault.unit})", layer="Axes")
    _draw_ends(axes, fault)
    _draw_throws(axes, fault, dict(colors))
    top = base + height
    for title, entry in keys:
        legend(drawing, (_LEFT + width + _GAP, top), title, entry, _SIZE, layer="Legend")
        top -= legend_size(title, entry, _SIZE)[1] + _SIZE
    top = drawing.height - 20
    drawing.text(_LEFT, top, f"{fault.name}: {fault.fault}", _SIZE + 3, layer="Text")
    for number, text in enumerate(texts, 1):
        drawing.text(_LEFT, top - 1.5 * _SIZE * number, text, _SIZE, layer="Text")
    return drawing


def _draw_blocks(axes: Axes, fault: JuxtapositionData, flat: np.ndarray) -> None:
    for side in (FOOTWALL, HANGING_WALL):
        for block in np.unique(fault.blocks[:, side]).tolist():
            chosen = np.flatnonzero(fault.blocks[:, side] == block)
            rings = [axes.at(ring) for ring in outlines(fault, flat, chosen)]
            color = tuple(fault.block_colors[block]) if block >= 0 else _NONE
            name = fault.block_names[block] if block >= 0 else "no rock"
            layer = f"{SIDES[side]} {name}"
            if side == FOOTWALL:
                axes.drawing.polygon(rings, color, GRAY, 0.3, layer=layer)
            elif block >= 0:
                dark = tuple(_SHADE * part for part in color)
                for line in hatched(rings, _HATCH, block):
                    axes.drawing.line(line, dark, 0.7, layer=layer)
                axes.drawing.polygon(rings, None, dark, 0.5, layer=layer)


def hatched(rings: list[np.ndarray], step: float, number: int = 0) -> list[np.ndarray]:
    """Parallel lines (2, 2), so far apart, within rings that count even-odd; they rise at an even number, and
    fall at an odd one."""
    turn = np.sqrt(0.5) * np.array([[1.0, 1.0], [-1.0, 1.0]])  # rows: along and across
    turn = turn * (1.0, -1.0) if number % 2 else turn
    begin = dot(np.concatenate(rings)[:, None], turn)
    end = dot(np.concatenate([np.roll(ring, -1, axis=0) for ring in rings])[:, None], turn)
    lines = []
    first, last = np.ceil(begin[:, 1].min() / step), np.floor(begin[:, 1].max() / step)
    for across in step * np.arange(first, last + 1):
        cut = (begin[:, 1] <= across) != (end[:, 1] <= across)
        share = (across - begin[cut, 1]) / (end[cut, 1] - begin[cut, 1])
        along = np.sort(begin[cut, 0] + share * (end[cut, 0] - begin[cut, 0]))
        ends = np.stack([along, np.full(len(along), across)], axis=1)
        lines += list(dot(ends[:, None], turn.T).reshape(-1, 2, 2))
    return lines


def _draw_cutoffs(axes: Axes, fault: JuxtapositionData, colors: dict[str, Color]) -> None:
    for cutoff in fault.cutoffs:
        dash = None if cutoff.side == SIDES[FOOTWALL] else _DASH
        for line in cutoff.lines:
            points = axes.at(fault.unrolled(line))
            layer = f"{cutoff.side} {cutoff.surface}"
            axes.drawing.line(points, colors[cutoff.surface], 1.3, dash, layer=layer)


def _draw_ends(axes: Axes, fault: JuxtapositionData) -> None:
    """The plan coordinates of both ends of the strike line."""
    x, y, width, height = axes.box
    for (east, north), at, anchor in zip(
        fault.strike.at(list(axes.x_range)).tolist(), (x, x + width), ("start", "end"), strict=True
    ):
        text = f"x {east:,.1f}  y {north:,.1f}"
        axes.drawing.text(at, y + height + 5, text, _SIZE - 1, anchor=anchor, layer="Text")


def _draw_throws(axes: Axes, fault: JuxtapositionData, colors: dict[str, Color]) -> None:
    profiles = {name: fault.throw_profile(name) for name in colors}
    values = np.concatenate([np.zeros(1), *(rows[:, 1] for rows in profiles.values())])
    low, high = _ROOM * float(values.min()), _ROOM * float(values.max())
    box = (axes.box[0], _BELOW, axes.box[2], _PROFILE)
    below = Axes(axes.drawing, box, axes.x_range, (low, high if high > low else low + 1.0), _SIZE)
    below.drawing.line(below.at([(axes.x_range[0], 0.0), (axes.x_range[1], 0.0)]), GRAY, 0.5, layer="Axes")
    for name, rows in profiles.items():
        inside = (rows[:, 0] >= axes.x_range[0]) & (rows[:, 0] <= axes.x_range[1])
        if inside.sum() > 1:
            below.drawing.line(below.at(rows[inside]), colors[name], 1.2, layer=f"throw {name}")
    below.frame(f"Distance along strike ({fault.unit})", f"Throw ({fault.unit})", layer="Axes")
