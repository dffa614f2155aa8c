# SPDX-License-Identifier: GPL-3.0-or-later
"""Wavefront OBJ: triangles, an object and group for each part, a material for each property (in the .mtl
beside it)."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import BinaryIO

from ...base.atomic import Outputs
from ...base.text import Step
from ..encodings.text_rows import write_rows
from .shape_parts import Part, plain_words


def write_obj(parts: Sequence[Part], path: Path, outputs: Outputs, step: Step) -> None:
    """Writes parts, as triangles: programs divide polygons that are not convex in their own ways, and lose
    some. The colors of the materials, where there are any, are in an .mtl file beside it."""
    materials = path.with_suffix(".mtl").name if any(part.material for part in parts) else ""
    if materials:
        with outputs.file(path.with_name(materials)) as file:
            _write_mtl(parts, file)
    with outputs.file(path) as file:
        _write_parts(parts, file, step, materials)


def _write_parts(parts: Sequence[Part], file: BinaryIO, step: Step, materials: str) -> None:
    file.write(b"# RealModel: an object for each part, z upward\n")
    file.write(f"mtllib {materials}\n".encode() if materials else b"")
    first = 1
    words = plain_words([part.name for part in parts])
    for number, (part, word) in enumerate(zip(parts, words, strict=True), 1):
        file.write(f"o {word}\ng {word}\n".encode())
        file.write(f"usemtl {_material(part)}\n".encode() if materials else b"")
        write_rows(file, "v %r %r %r", part.vertices)
        write_rows(file, "f %d %d %d", part.triangles + first)
        first += len(part.vertices)
        step(number / len(parts))
    step(1.0)


def _write_mtl(parts: Sequence[Part], file: BinaryIO) -> None:
    for part in {_material(part): part for part in reversed(parts)}.values():
        red, green, blue = part.color
        file.write(f"newmtl {_material(part)}\nKd {red:.6g} {green:.6g} {blue:.6g}\nillum 1\n\n".encode())


def _material(part: Part) -> str:
    return f"property_{part.property}"
