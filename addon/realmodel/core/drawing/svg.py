# SPDX-License-Identifier: GPL-3.0-or-later
"""SVG files (Scalable Vector Graphics 1.1)."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby
from pathlib import Path
from typing import BinaryIO
from xml.sax.saxutils import escape

import numpy as np

from ..base.atomic import Outputs
from ..base.errors import UsageError
from ..base.text import Step, no_step
from .drawing import Color, Drawing, DrawingItem, FilledRings, Line, Text

EACH_SHEET = "{sheet}"  # in a file's name: a file for each, numbered from 1


def write_svg_sheets(drawings: Sequence[Drawing], path: Path, outputs: Outputs, step: Step = no_step) -> None:
    """A file for each drawing: SVG has no pages. Raises UsageError for several drawings and one name."""
    if len(drawings) > 1 and EACH_SHEET not in path.name:
        raise UsageError(
            f"{path}: an SVG file has one sheet, and there are {len(drawings)}: put {EACH_SHEET} into its "
            "name, which becomes a file for each, take larger paper, or write a .pdf"
        )
    for number, drawing in enumerate(drawings, 1):
        with outputs.file(path.with_name(path.name.replace(EACH_SHEET, str(number)))) as file:
            write_svg(drawing, file)
        step(number / len(drawings))


def write_svg(drawing: Drawing, file: BinaryIO, _step: Step = no_step) -> None:
    """Items of one layer after another become a group that has the layer's name as its title."""
    width, height = (f"{value:.2f}" for value in (drawing.width, drawing.height))
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}pt" height="{height}pt" '
        f'viewBox="0 0 {width} {height}" font-family="DejaVu Sans, Verdana, Helvetica, sans-serif">',
        f'<rect width="{width}" height="{height}" fill="white"/>',
    ]
    for layer, items in groupby(drawing.items, key=lambda item: item.layer):
        lines.append(f"<g><title>{escape(layer)}</title>" if layer else "<g>")
        for item in items:
            lines += _elements(item, drawing.height)
        lines.append("</g>")
    file.write("\n".join([*lines, "</svg>", ""]).encode())


def _elements(item: DrawingItem, height: float) -> list[str]:
    if isinstance(item, FilledRings):
        path = " ".join(f"M{_places(ring, height)}Z" for ring in item.rings)
        stroke = f' stroke-width="{item.width:g}"' if item.stroke else ""
        colors = f"{_color('fill', item.fill)}{_color('stroke', item.stroke)}"
        return [f'<path d="{path}" fill-rule="nonzero"{colors}{stroke}/>']
    if isinstance(item, Line):
        dash = f' stroke-dasharray="{item.dash:g}"' if item.dash else ""
        return [
            f'<polyline points="{_places(item.points, height)}" fill="none"{_color("stroke", item.color)} '
            f'stroke-width="{item.width:g}"{dash}/>'
        ]
    if isinstance(item, Text):
        x, y = f"{item.x:.2f}", f"{height - item.y:.2f}"
        turn = f' transform="rotate({-item.angle:g} {x} {y})"' if item.angle else ""
        return [
            f'<text x="{x}" y="{y}" font-size="{item.size:g}" text-anchor="{item.anchor}"'
            f"{_color('fill', item.color)}{turn}>{escape(item.text)}</text>"
        ]
    return [
        f'<circle cx="{x:.2f}" cy="{height - y:.2f}" r="{radius:.2f}"{_color("fill", item.color)}/>'
        for (x, y), radius in zip(item.points.tolist(), item.radii.tolist(), strict=True)
    ]


def _places(points: np.ndarray, height: float) -> str:
    return " ".join(f"{x:.2f},{height - y:.2f}" for x, y in points.tolist())


def _color(attribute: str, color: Color | None) -> str:
    if color is None:
        return f' {attribute}="none"'
    code = "".join(f"{round(255 * min(max(part, 0.0), 1.0)):02x}" for part in color[:3])
    opacity = f' {attribute}-opacity="{color[3]:g}"' if len(color) > 3 and color[3] < 1 else ""
    return f' {attribute}="#{code}"{opacity}'
