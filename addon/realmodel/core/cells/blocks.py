# SPDX-License-Identifier: GPL-3.0-or-later
"""The blocks of a model."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ..base.named import NamedList
from ..notebook import ShortRepr, polygon_mesh

if TYPE_CHECKING:
    import pyvista


@dataclass(frozen=True)
class Block:
    """One layer's block, with its `name`. `rock` is the index of its rock mass, `surface` the global index of
    the surface that it was deposited beneath (block 0: of the oldest surface), `property` the library id (0:
    none). volume is in model units cubed; cells counts its cells, components its connected components."""

    name: str
    rock: int
    surface: int
    property: int
    volume: float
    cells: int
    components: int


def named_blocks(blocks: Sequence[Block]) -> NamedList[Block]:
    """The blocks of a model, which are found by their names, too."""
    return NamedList(blocks, (block.name for block in blocks), "block")


def blocks_of_arrays(arrays: Mapping[str, np.ndarray]) -> NamedList[Block]:
    """The blocks of a file, by its arrays `block_...`."""
    keys = ("names", "rock", "surface", "property", "volume", "cells", "components")
    rows = zip(*(arrays[f"block_{key}"].tolist() for key in keys), strict=True)
    return named_blocks([Block(*row) for row in rows])


@dataclass(frozen=True, repr=False)
class BlockBoundary(ShortRepr):
    """The closed boundary of a block: faces counter-clockwise seen from outside the block.

    vertices (V, 3) float64, face_offsets (F+1,) int64, face_vertices int32 into `vertices`,
    face_surface (F,) int32 as in the model, faces (F,) int64 the model's numbers of these faces.
    """

    vertices: np.ndarray
    face_offsets: np.ndarray
    face_vertices: np.ndarray
    face_surface: np.ndarray
    faces: np.ndarray

    def to_pyvista(self) -> pyvista.PolyData:
        """The boundary as a closed mesh of PyVista, with the cell data `surface` (face_surface).

        Raises UsageError where PyVista is missing.
        """
        data = {"surface": self.face_surface}
        return polygon_mesh(self.vertices, self.face_offsets, self.face_vertices, data)
