# SPDX-License-Identifier: GPL-3.0-or-later
"""Wavefront OBJ: polygons, a group for each part, a material for each property (in the .mtl beside it)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import BinaryIO

import numpy as np

from ..encodings.text_rows import write_rows
from .parts import Part, plain_words


def write_obj(
    parts: Sequence[Part], file: BinaryIO, step: Callable[[float], None], materials: str = ""
) -> None:
    """Writes parts. materials: the name of the .mtl file; "" where there is none."""
    file.write(b"# RealModel: a group for each part, z upward\n")
    file.write(f"mtllib {materials}\n".encode() if materials else b"")
    first = 1
    words = plain_words([part.name for part in parts])
    for number, (part, word) in enumerate(zip(parts, words, strict=True), 1):
        file.write(f"g {word}\n".encode())
        file.write(f"usemtl {_material(part)}\n".encode() if materials else b"")
        write_rows(file, "v %r %r %r", part.vertices)
        write_polygons(file, np.diff(part.offsets), part.corners + first)
        first += len(part.vertices)
        step(number / len(parts))
    step(1.0)


def write_polygons(file: BinaryIO, sizes: np.ndarray, corners: np.ndarray) -> None:
    """Writes polygons with so many corners each, numbers of vertices from 1."""
    ends = np.cumsum(sizes)
    starts = np.flatnonzero(np.diff(sizes, prepend=-1))  # of runs of polygons of one size
    for begin, end in zip(starts, [*starts[1:], len(sizes)], strict=True):
        size = int(sizes[begin])
        run = corners[ends[begin] - size : ends[end - 1]].reshape(-1, size)
        write_rows(file, "f" + " %d" * size, run)


def write_mtl(parts: Sequence[Part], file: BinaryIO) -> None:
    """Writes the colors of the materials."""
    for part in {_material(part): part for part in reversed(parts)}.values():
        red, green, blue = part.color
        file.write(f"newmtl {_material(part)}\nKd {red:.6g} {green:.6g} {blue:.6g}\nillum 1\n\n".encode())


def _material(part: Part) -> str:
    return f"property_{part.property}"
