# SPDX-License-Identifier: GPL-3.0-or-later
"""DXF (release 12, text), which every CAD program reads: triangles as 3DFACE, a layer for each part in the
color of its property."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import BinaryIO

import numpy as np

from ...drawing.dxf import CODE_PAGE, color_number, layer_name
from ..encodings.text_rows import write_rows
from .parts import Part

_FACE = "  0\n3DFACE\n  8\n{layer}\n" + "".join(
    f" 1{corner}\n%r\n 2{corner}\n%r\n 3{corner}\n%r\n" for corner in range(4)
)
_HEAD = """0
SECTION
2
HEADER
9
$ACADVER
1
AC1009
9
$DWGCODEPAGE
3
ANSI_1252
9
$EXTMIN
{low}
9
$EXTMAX
{high}
0
ENDSEC
0
SECTION
2
TABLES
0
TABLE
2
LTYPE
70
1
0
LTYPE
2
CONTINUOUS
70
0
3
Solid line
72
65
73
0
40
0.0
0
ENDTAB
0
TABLE
2
LAYER
70
{layers}
"""


def write_dxf(parts: Sequence[Part], file: BinaryIO, step: Callable[[float], None]) -> None:
    """Writes parts."""
    layers: list[str] = []
    for part in parts:
        layers.append(layer_name(part.name, ["0", *layers]))
    low = np.min([part.vertices.min(axis=0) for part in parts], axis=0) if parts else np.zeros(3)
    high = np.max([part.vertices.max(axis=0) for part in parts], axis=0) if parts else np.zeros(3)
    text = _HEAD.format(low=_place(low), high=_place(high), layers=len(parts) + 1)
    for layer, number in [("0", 7), *zip(layers, (color_number(part.color) for part in parts), strict=True)]:
        text += f"0\nLAYER\n2\n{layer}\n70\n0\n62\n{number}\n6\nCONTINUOUS\n"
    text += "0\nENDTAB\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n"
    file.write(text.encode(CODE_PAGE))
    for number, (part, layer) in enumerate(zip(parts, layers, strict=True), 1):
        corners = part.vertices[part.triangles[:, [0, 1, 2, 2]]]  # a triangle repeats its last corner
        write_rows(file, _FACE.format(layer=layer), corners.reshape(-1, 12), ends="")
        step(number / len(parts))
    file.write(b"0\nENDSEC\n0\nEOF\n")
    step(1.0)


def _place(at: np.ndarray) -> str:
    return "\n".join(f"{code}\n{value!r}" for code, value in zip((10, 20, 30), at.tolist(), strict=True))
