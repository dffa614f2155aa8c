# SPDX-License-Identifier: GPL-3.0-or-later
"""PDF files (Portable Document Format 1.7, ISO 32000-1), written by the library pydyf.

Texts can be selected and searched. Their letters are embedded as Type 3 fonts (ISO 32000-1, 9.6.5), which are
made of the outlines that pictures are drawn with: so all files of a drawing have the same letters.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any, BinaryIO

import numpy as np

from ..base.packages import vendored
from ..base.text import Step, no_step
from .drawing import (
    ANCHORS,
    Color,
    Drawing,
    DrawingItem,
    FilledRings,
    Line,
    Text,
    text_rings,
    text_width,
)

_EM = 1000  # units of a font for the size of a letter
_MOST_LETTERS = 256  # of a font: codes are bytes
_CIRCLE = 0.5522847498  # of the radius: how far the control points of a quarter of a circle are away
_UNICODE = """/CIDInit /ProcSet findresource begin
12 dict begin begincmap
/CMapName /Letters def /CMapType 2 def
1 begincodespacerange <00> <ff> endcodespacerange
{} endcmap end end"""
_MOST_NAMED = 100  # codes in one list of a map to Unicode


def write_pdf(drawing: Drawing, file: BinaryIO, step: Step = no_step) -> None:
    """A file of one page."""
    write_pages([drawing], file, step)


def write_pages(drawings: Sequence[Drawing], file: BinaryIO, step: Step = no_step) -> None:
    """A file with a page for each drawing, of its size. It names no date: the same drawings give the same
    bytes. Raises BuildFailed where pydyf is missing."""
    pydyf = vendored("pydyf", "pydyf", "writing PDF")
    pdf, words = pydyf.PDF(), _Words()
    streams = []
    for number, drawing in enumerate(drawings, 1):
        content = [part for item in drawing.items for part in _operators(item, words)]
        streams.append(pydyf.Stream(["1 j", *content], compress=True))
        step(0.9 * number / len(drawings))
    resources = words.resources(pydyf, pdf)
    for drawing, stream in zip(drawings, streams, strict=True):
        pdf.add_object(stream)
        page = {"Type": "/Page", "Parent": pdf.pages.reference, "Contents": stream.reference}
        page["MediaBox"] = pydyf.Array([0, 0, float(drawing.width), float(drawing.height)])
        pdf.add_page(pydyf.Dictionary(page | {"Resources": resources}))
    pdf.write(file)
    step(1.0)


class _Words:
    """What the pages of a file name: letters, by font and code, and states of transparency."""

    def __init__(self) -> None:
        self._letters: dict[str, int] = {}
        self._alphas: dict[float, str] = {}

    def codes(self, text: str) -> Iterator[tuple[str, str]]:
        """The name of the font and the code of each letter of a text."""
        for letter in text:
            font, code = divmod(self._letters.setdefault(letter, len(self._letters)), _MOST_LETTERS)
            yield f"/F{font}", f"{code:02x}"

    def state(self, color: Color) -> str:
        """The name of the state that draws as transparent as a color is."""
        alpha = color[3] if len(color) > 3 else 1.0
        return self._alphas.setdefault(round(float(alpha), 3), f"/A{len(self._alphas)}")

    def resources(self, pydyf: Any, pdf: Any) -> Any:
        """The dictionary that pages find them in."""
        fonts, states, letters = pydyf.Dictionary(), pydyf.Dictionary(), list(self._letters)
        for first in range(0, len(letters), _MOST_LETTERS):
            font = _font(pydyf, pdf, letters[first : first + _MOST_LETTERS])
            fonts[f"F{first // _MOST_LETTERS}"] = font.reference
        for alpha, name in self._alphas.items():
            states[name[1:]] = pydyf.Dictionary({"ca": alpha, "CA": alpha})
        return pydyf.Dictionary({"Font": fonts, "ExtGState": states})


def _font(pydyf: Any, pdf: Any, letters: list[str]) -> Any:
    """The Type 3 font of letters, whose codes are their places in the list."""
    glyphs, widths, boxes = pydyf.Dictionary(), [], [np.zeros((1, 2))]
    for code, letter in enumerate(letters):
        rings, width = text_rings(letter, _EM), round(text_width(letter, _EM))
        outline = np.concatenate([np.zeros((1, 2)), *rings])
        (left, low), (right, high) = np.floor(outline.min(axis=0)), np.ceil(outline.max(axis=0))
        head = f"{width} 0 {left:.0f} {low:.0f} {right:.0f} {high:.0f} d1"
        glyph = pydyf.Stream([head, *(f"{_path(ring)} h" for ring in rings), "f"], compress=True)
        pdf.add_object(glyph)
        glyphs[f"g{code}"] = glyph.reference
        widths.append(width)
        boxes.append(outline)
    names = [f"<{code:02x}> <{letter.encode('utf-16-be').hex()}>" for code, letter in enumerate(letters)]
    lists = [names[k : k + _MOST_NAMED] for k in range(0, len(names), _MOST_NAMED)]
    mapped = "\n".join(f"{len(some)} beginbfchar\n" + "\n".join(some) + "\nendbfchar" for some in lists)
    unicode = pydyf.Stream([_UNICODE.format(mapped)], compress=True)
    pdf.add_object(unicode)
    every = np.concatenate(boxes)
    box = [*np.floor(every.min(axis=0)).tolist(), *np.ceil(every.max(axis=0)).tolist()]
    named = pydyf.Array([0, *(f"/g{code}" for code in range(len(letters)))])
    font = pydyf.Dictionary(
        {
            "Type": "/Font",
            "Subtype": "/Type3",
            "Name": "/DejaVuSans",
            "FontBBox": pydyf.Array(box),
            "FontMatrix": pydyf.Array([1 / _EM, 0, 0, 1 / _EM, 0, 0]),
            "CharProcs": glyphs,
            "Encoding": pydyf.Dictionary({"Type": "/Encoding", "Differences": named}),
            "FirstChar": 0,
            "LastChar": len(letters) - 1,
            "Widths": pydyf.Array(widths),
            "ToUnicode": unicode.reference,
            "Resources": pydyf.Dictionary(),
        }
    )
    pdf.add_object(font)
    return font


def _operators(item: DrawingItem, words: _Words) -> Iterator[str]:
    """What draws an item."""
    if isinstance(item, FilledRings):
        rings = [f"{_path(ring)} h" for ring in item.rings]
        for color, operator in ((item.fill, "f"), (item.stroke, "S")):
            if color is not None:
                yield f"{_color(color, words)} {item.width:g} w [] 0 d"
                yield from (*rings, operator)
    elif isinstance(item, Line):
        dash = "" if item.dash is None else f"{item.dash:g}"
        yield f"{_color(item.color, words)} {item.width:g} w [{dash}] 0 d {_path(item.points)} S"
    elif isinstance(item, Text):
        yield _text(item, words)
    else:
        yield _color(item.color, words)
        for (x, y), radius in zip(item.points.tolist(), item.radii.tolist(), strict=True):
            yield _circle(x, y, radius)
        yield "f"


def _text(item: Text, words: _Words) -> str:
    angle = np.radians(item.angle)
    c, s = float(np.cos(angle)), float(np.sin(angle))
    back = ANCHORS[item.anchor] * text_width(item.text, item.size)
    shown: list[str] = []
    font = ""
    for name, code in words.codes(item.text):
        if name != font:
            shown.append(f"{'> Tj ' if shown else ''}{name} {item.size:g} Tf <")
            font = name
        shown.append(code)
    if not shown:
        return ""
    at = f"{c:.6f} {s:.6f} {-s:.6f} {c:.6f} {item.x - back * c:.3f} {item.y - back * s:.3f} Tm"
    return f"BT {_color(item.color, words)} {at} {''.join(shown)}> Tj ET"


def _path(points: np.ndarray) -> str:
    """A path through points (N, 2), open."""
    first, *rest = [f"{x:.3f} {y:.3f}" for x, y in points.tolist()]
    return " ".join([f"{first} m", *(f"{place} l" for place in rest)])


def _circle(x: float, y: float, r: float) -> str:
    k = _CIRCLE * r
    quarters = [
        ((x + r, y + k), (x + k, y + r), (x, y + r)),
        ((x - k, y + r), (x - r, y + k), (x - r, y)),
        ((x - r, y - k), (x - k, y - r), (x, y - r)),
        ((x + k, y - r), (x + r, y - k), (x + r, y)),
    ]
    curves = (" ".join(f"{a:.3f} {b:.3f}" for a, b in quarter) + " c" for quarter in quarters)
    return f"{x + r:.3f} {y:.3f} m {' '.join(curves)}"


def _color(color: Color, words: _Words) -> str:
    """Sets the color of fills, strokes and letters, and how transparent they are."""
    rgb = " ".join(f"{min(max(part, 0.0), 1.0):.4g}" for part in color[:3])
    return f"{words.state(color)} gs {rgb} rg {rgb} RG"
