#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes addon/realmodel/core/drawing/dejavu_sans.npz, the letters of pictures: outlines of DejaVu Sans, its
curves as polygons, for Latin, Greek, and Cyrillic text.

    python scripts/write_glyphs.py          (needs fontTools and matplotlib, scripts/requirements/test.txt)
"""

from itertools import pairwise
from pathlib import Path

import matplotlib
import numpy as np
from fontTools.pens.recordingPen import DecomposingRecordingPen
from fontTools.ttLib import TTFont

_FONT = Path(matplotlib.__file__).parent / "mpl-data" / "fonts" / "ttf" / "DejaVuSans.ttf"
_TARGET = Path(__file__).resolve().parents[1] / "addon" / "realmodel" / "core" / "drawing" / "dejavu_sans.npz"
_RANGES = ((0x20, 0x7F), (0xA0, 0x180), (0x386, 0x3CF), (0x400, 0x460), (0x2010, 0x2023))
_MORE = "\u2026\u20ac\u2190\u2191\u2192\u2193\u2212\u2264\u2265\u2248\u2260\u221e\u2030\ufffd"
_PIECES = 5  # of each curve


def contours(glyphs, name):
    """The closed polygons of a glyph, in units of the font."""
    pen = DecomposingRecordingPen(glyphs)
    glyphs[name].draw(pen)
    found, points = [], []
    for action, arguments in pen.value:
        if action == "moveTo":
            points = [arguments[0]]
        elif action == "lineTo":
            points.append(arguments[0])
        elif action == "qCurveTo":
            points += quadratic(points, arguments)
        elif action in ("closePath", "endPath") and len(points) > 2:
            found.append(points[:-1] if points[-1] == points[0] else points)
    return found


def quadratic(points, arguments):
    """Points of a chain of quadratic curves; between two control points lies an implied one, and a contour
    without any point of its own (the last argument is None) begins at such a one."""
    controls = list(arguments[:-1])
    if arguments[-1] is None:
        raise ValueError("a contour of control points alone: DejaVu Sans has none of these")
    middles = [tuple((np.add(a, b)) / 2) for a, b in pairwise(controls)]
    found, start = [], points[-1]
    for control, end in zip(controls, [*middles, arguments[-1]], strict=True):
        for t in np.arange(1, _PIECES + 1) / _PIECES:
            found.append(
                tuple(
                    (1 - t) ** 2 * np.array(start)
                    + 2 * t * (1 - t) * np.array(control)
                    + t**2 * np.array(end)
                )
            )
        start = end
    return found


def main():
    font = TTFont(_FONT)
    glyphs, names = font.getGlyphSet(), font.getBestCmap()
    codes = sorted({c for first, last in _RANGES for c in range(first, last)} | set(map(ord, _MORE)))
    codes = [code for code in codes if code in names]
    outlines = [contours(glyphs, names[code]) for code in codes]
    rings = [np.rint(ring).astype(np.int16) for outline in outlines for ring in outline]
    np.savez_compressed(
        _TARGET,
        em=np.int32(font["head"].unitsPerEm),
        codes=np.array(codes, np.int32),
        advances=np.array([glyphs[names[code]].width for code in codes], np.int16),
        glyph_rings=np.cumsum([0, *map(len, outlines)]).astype(np.int32),
        ring_points=np.cumsum([0, *map(len, rings)]).astype(np.int32),
        points=np.concatenate(rings),
    )
    print(f"{len(codes)} letters, {_TARGET.stat().st_size} bytes")


if __name__ == "__main__":
    main()
