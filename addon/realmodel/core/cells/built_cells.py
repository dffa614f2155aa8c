# SPDX-License-Identifier: GPL-3.0-or-later
"""What the native module builds of rock masses: cells, and what is known of them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from .cell_complex import CellComplex


class NativeWarning(NamedTuple):
    """surface: its global index, below 0 where there is none. items: of that surface, as `kind` says."""

    kind: str
    surface: int
    items: tuple[int, ...]
    text: str


@dataclass(frozen=True, eq=False)
class CellParts:
    """Where the cells of a model with structures are. part: (C,) int32, the part of space of each cell.
    own_block: (C,) int32, its block with those of bodies as body_block numbers them. rock: (B,) int32, the
    rock mass of these blocks. divided: (S, B) uint8, whether a structure divides such a block."""

    part: np.ndarray
    own_block: np.ndarray
    rock: np.ndarray
    divided: np.ndarray


@dataclass(frozen=True, eq=False)
class BuiltCells:
    """The cells of all rock masses. Blocks have the numbers of the surfaces above them, those of bodies the
    numbers of their structures, counted after all surfaces; so have faces. volumes: (S,) float64 of these
    blocks. parts: None without structures."""

    complex: CellComplex
    volumes: np.ndarray
    warnings: list[NativeWarning] = field(default_factory=list)
    parts: CellParts | None = None

    @classmethod
    def of(cls, arrays: Mapping[str, Any], cell_kind: str) -> BuiltCells:
        """Of a result of the native module."""
        warnings = [
            NativeWarning(kind, int(surface), tuple(int(item) for item in items), text)
            for kind, surface, items, text in arrays["warnings"]
        ]
        return cls(CellComplex.of(arrays, cell_kind), arrays["volumes"], warnings)
