# SPDX-License-Identifier: GPL-3.0-or-later
"""Closed polyhedral cells that share their faces, as flat arrays, face by face."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from ..base.work import Work, native_module, on_threads
from .blocks import BlockBoundary

ARRAYS = ("vertices", "face_offsets", "face_vertices", "face_cells", "face_surface", "cell_block")


@dataclass(frozen=True, eq=False)
class CellComplex:
    """The arrays of docs/dev/geometry.md, under the same names.

    vertices (V, 3) float64; face_offsets (F + 1,) int64 and face_vertices int32, the corners of each face;
    face_cells (F, 2) int32, -1 outside; face_surface (F,) int32; cell_block (C,) int32. cell_kind:
    "columns" or "blocks".
    """

    vertices: np.ndarray
    face_offsets: np.ndarray
    face_vertices: np.ndarray
    face_cells: np.ndarray
    face_surface: np.ndarray
    cell_block: np.ndarray
    cell_kind: str

    @classmethod
    def of(cls, arrays: Mapping[str, Any], cell_kind: str) -> CellComplex:
        """Of a result of the native module, or the arrays of a file."""
        return cls(**{name: arrays[name] for name in ARRAYS}, cell_kind=cell_kind)

    @classmethod
    def empty(cls, cell_kind: str) -> CellComplex:
        return cls(
            np.empty((0, 3)),
            np.zeros(1, np.int64),
            np.empty(0, np.int32),
            np.empty((0, 2), np.int32),
            np.empty(0, np.int32),
            np.empty(0, np.int32),
            cell_kind,
        )

    def native(self, blocks: int) -> dict[str, Any]:
        """As functions of the native module take it. blocks: how many there are, also without cells."""
        arrays = {name: getattr(self, name) for name in ARRAYS}
        return arrays | {"blocks": blocks, "cell_kind": self.cell_kind}

    @cached_property
    def face_blocks(self) -> np.ndarray:
        """(F, 2) int32: the block on each side of a face; -1 outside."""
        padded = np.append(self.cell_block, np.int32(-1))
        return padded[self.face_cells]

    @cached_property
    def cell_component(self) -> np.ndarray:
        """(C,) int32: the least cell of the connected component of a block that each cell belongs to."""
        return native_module().cell_components(self.face_cells, self.cell_block)

    def find_components(self, work: Work) -> None:
        """Computes cell_component as a step of some work, which may be canceled."""
        vars(self)["cell_component"] = work.native(  # where cached_property keeps it
            native_module().cell_components, self.face_cells, self.cell_block
        )

    def count_blocks(self, blocks: int) -> tuple[np.ndarray, np.ndarray]:
        """(B,) the cells and the connected components of each block. blocks: how many there are."""
        cells = np.bincount(self.cell_block, minlength=blocks)
        roots = self.cell_component == np.arange(len(self.cell_block))
        return cells, np.bincount(self.cell_block[roots], minlength=blocks)

    def cell_volumes(self, threads: int = 0) -> np.ndarray:
        """(C,) float64: the volume of each cell, model units cubed."""
        return native_module().cell_volumes(
            self.vertices,
            self.face_offsets,
            self.face_vertices,
            self.face_cells,
            len(self.cell_block),
            execution=on_threads(threads),
        )

    def face_corners(self, faces: np.ndarray, turned: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The corners of some faces, one face after the other.

        faces: (N,) numbers of faces. turned: (N,) bool, those that are taken the other way round.
        Returns offsets (N + 1,) int64 and vertex numbers (sum,) as `face_vertices`.
        """
        begin, end = self.face_offsets[faces], self.face_offsets[1:][faces]
        offsets = np.zeros(len(faces) + 1, np.int64)
        np.cumsum(end - begin, out=offsets[1:])
        step = np.where(turned, -1, 1)
        start = np.where(turned, end - 1, begin) - step * offsets[:-1]
        size = np.diff(offsets)
        at = np.repeat(start, size) + np.repeat(step, size) * np.arange(offsets[-1])
        return offsets, self.face_vertices[at]

    def block_boundary(self, block: int) -> BlockBoundary:
        """The closed boundary of one block, all its connected components together."""
        first, second = self.face_blocks[:, 0] == block, self.face_blocks[:, 1] == block
        faces = np.flatnonzero(first != second)
        offsets, corners = self.face_corners(faces, second[faces])
        used, corners = self._renumbered(corners)
        return BlockBoundary(self.vertices[used], offsets, corners, self.face_surface[faces], faces)

    def without_cells(self, dropped: np.ndarray) -> CellComplex:
        """The complex without some cells, (C,) bool."""
        return self._with_cells(np.where(dropped, -1, np.cumsum(~dropped) - 1))

    def one_cell_each(self, joins: np.ndarray) -> tuple[CellComplex, np.ndarray]:
        """The complex with the cells of a block that faces (F,) bool connect as one, without the faces
        between these; and (C,) int32 the new cell of each."""
        connecting = np.where(joins[:, None], self.face_cells, np.int32(-1))
        part = native_module().cell_components(connecting, self.cell_block)
        cell = np.unique(part, return_inverse=True)[1].ravel().astype(np.int32)
        return self._with_cells(cell), cell

    def _with_cells(self, number: np.ndarray) -> CellComplex:
        """The complex with its cells numbered anew (C,), -1: left out; those of one number are one."""
        blocks = int(self.cell_block.max(initial=-1)) + 1
        merged = native_module().merge_cells(self.native(blocks), number.astype(np.int32))
        return CellComplex.of(merged, self.cell_kind)

    def _renumbered(self, corners: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """(V,) bool: the vertices that are corners; and the corners, (N,) int32, counted among these."""
        used = np.zeros(len(self.vertices), bool)
        used[corners] = True
        number = np.cumsum(used, dtype=np.int64) - 1
        return used, number[corners].astype(np.int32)
