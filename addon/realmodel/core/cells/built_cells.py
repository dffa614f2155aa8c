# SPDX-License-Identifier: GPL-3.0-or-later
"""What the native module builds of rock masses: cells, and what is known of them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

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
    """Where cells are. part: (C,) int32, the part of space of each cell.
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
    blocks."""

    complex: CellComplex
    volumes: np.ndarray
    parts: CellParts
    warnings: list[NativeWarning]
