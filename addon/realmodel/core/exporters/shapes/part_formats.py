# SPDX-License-Identifier: GPL-3.0-or-later
"""The formats of shapes that are one file: functions (parts, file, step) by ending."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, BinaryIO

from .dxf import write_dxf
from .gltf import write_glb
from .obj import write_obj
from .ply import write_ply
from .stl import write_stl
from .tsurf import write_tsurf

PART_WRITERS: dict[str, Callable[..., None]] = {
    ".obj": write_obj,
    ".ply": write_ply,
    ".stl": write_stl,
    ".glb": write_glb,
    ".dxf": write_dxf,
    ".ts": write_tsurf,
}


def part_writers(parts_of: Callable, unit_of: Callable[..., str]) -> dict[str, Callable[..., None]]:
    """Functions (item, file) by ending that write parts_of(item). unit_of(item): of its lengths."""

    def writer(write: Callable[..., None]) -> Callable[..., None]:
        def write_it(item: Any, file: BinaryIO) -> None:
            unit = {"unit": unit_of(item)} if write is write_tsurf else {}
            write(parts_of(item), file, lambda _: None, **unit)

        return write_it

    return {ending: writer(write) for ending, write in PART_WRITERS.items()}
