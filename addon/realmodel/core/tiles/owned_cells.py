# SPDX-License-Identifier: GPL-3.0-or-later
"""Which tile each cell of a model with faults or bodies belongs to, and what tiles have in common then.

Such models are not cut at the lines between tiles. A cell belongs to the tile in which its first corner lies,
by x, then y, then z: whoever sees the cell finds the same. Cells that cannot be parted are taken as one.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..base.work import native_module
from ..cells.cell_complex import CellComplex
from .grid import TileGrid


def inseparable(whole: CellComplex) -> np.ndarray:
    """(C,) the first of the cells that a cell cannot be parted from: those on the two sides of a face whose
    corners are those of another face, too. Between two such faces there are only cells without extent, where
    vertices one unit in the last place apart were kept; without these both would be borders in one place."""
    _, number, count = np.unique(_corner_sums(whole), return_inverse=True, return_counts=True)
    twice = count[number] > 1
    connecting = np.where(twice[:, None], whole.face_cells, np.int32(-1))
    return native_module().cell_components(connecting, np.zeros_like(whole.cell_block))


def owners(whole: CellComplex, grid: TileGrid, together: np.ndarray) -> np.ndarray:
    """(C, 2) int64: column and row of the tile that each cell belongs to. together: as `inseparable` has
    it."""
    order = np.lexsort(whole.vertices.T[::-1])
    rank = np.empty(len(order), np.int64)
    rank[order] = np.arange(len(order))
    size = np.diff(whole.face_offsets)
    lowest = np.full(len(size), len(order), np.int64)
    np.minimum.at(lowest, np.repeat(np.arange(len(size)), size), rank[whole.face_vertices])
    first = np.full(len(whole.cell_block), len(order), np.int64)
    for side in range(2):
        has_cell = whole.face_cells[:, side] >= 0
        np.minimum.at(first, together[whole.face_cells[has_cell, side]], lowest[has_cell])
    first = first[together]
    places = whole.vertices[order[first]]
    lines = (grid.x, grid.y)
    at = [
        (np.searchsorted(line, places[:, axis], "right") - 1).clip(0, len(line) - 2)
        for axis, line in enumerate(lines)
    ]
    return np.column_stack(at)


def reach_of(whole: CellComplex, mine: np.ndarray, together: np.ndarray) -> tuple[float, float, float, float]:
    """A box in plan around some cells, (C,) bool, and those that share a face with one or cannot be parted
    from one that does. together: as `inseparable` has it."""
    faces = np.append(mine, False)[whole.face_cells].any(axis=1)
    near = np.zeros(len(mine) + 1, bool)
    near[whole.face_cells[faces]] = True
    near[-1] = False
    near[:-1] = np.isin(together, together[near[:-1]])
    faces = near[whole.face_cells].any(axis=1)
    corners = whole.face_vertices[np.repeat(faces, np.diff(whole.face_offsets))]
    plan = whole.vertices[corners, :2]
    x, y = plan.T  # min(axis=0) would take several times as long
    return float(x.min()), float(y.min()), float(x.max()), float(y.max())


@dataclass(frozen=True)
class Seam:
    """The faces between cells of a tile and those of another, in order of their keys.

    key: (F,) the same for the same polygon on the same surface. part: (F, 2) of the tile's cell, the
    connected component of its block, and the cell of a model of blocks. block: (F, 2) the tile's first.
    is_one: (F,) bool, whether both cells are one of a model of blocks. place: (F, 3) a corner."""

    key: np.ndarray
    part: np.ndarray
    block: np.ndarray
    is_one: np.ndarray
    place: np.ndarray

    @classmethod
    def of(
        cls, whole: CellComplex, faces: np.ndarray, own: np.ndarray, part: np.ndarray, is_one: np.ndarray
    ) -> Seam:
        """faces: some of the whole; own: (F,) which of the two cells of each is the tile's. part, is_one: of
        both cells."""
        key = face_keys(whole, faces)
        order = np.argsort(key, kind="stable")
        faces, own = faces[order], own[order]
        cells = whole.face_cells[faces]
        rows = np.arange(len(faces))
        block = np.column_stack([whole.cell_block[cells[rows, side]] for side in (own, 1 - own)])
        first = whole.face_vertices[whole.face_offsets[faces]]
        return cls(
            key[order],
            part[order].astype(np.int32),
            block.astype(np.int32).reshape(-1, 2),
            is_one[order],
            whole.vertices[first].reshape(-1, 3),
        )

    def arrays(self, prefix: str) -> dict[str, np.ndarray]:
        """By name, as of_arrays takes them."""
        return {f"{prefix}_{name}": array for name, array in vars(self).items()}

    @classmethod
    def of_arrays(cls, arrays: dict[str, np.ndarray], prefix: str) -> Seam:
        if f"{prefix}_key" not in arrays:
            none = np.empty((0, 2), np.int32)
            return cls(np.empty(0, np.uint64), none, none, np.empty(0, bool), np.empty((0, 3)))
        return cls(*(arrays[f"{prefix}_{name}"] for name in cls.__dataclass_fields__))

    def matches(self, other: Seam) -> bool:
        """Whether two tiles have the same faces between them, with the same blocks on both sides."""
        return np.array_equal(self.key, other.key) and np.array_equal(self.block, other.block[:, ::-1])

    def first_difference(self, other: Seam) -> tuple[float, float, float]:
        """A place where they do not match."""
        ours, theirs = set(self.key.tolist()), set(other.key.tolist())
        for seam, keys in ((self, theirs), (other, ours)):
            for key, place in zip(seam.key.tolist(), seam.place.tolist(), strict=True):
                if key not in keys:
                    return tuple(place)
        return tuple(self.place[0].tolist())


def face_keys(whole: CellComplex, faces: np.ndarray) -> np.ndarray:
    """(F,) uint64: the same for the same polygon on the same surface, whichever cell it is seen from. A sum
    of hashes of its corners does not depend on their order."""
    offsets, corners = whole.face_corners(faces, np.zeros(len(faces), bool))
    hashed = np.zeros(len(corners), np.uint64)
    for coordinates in (whole.vertices[corners] + 0.0).T:  # -0.0 is 0.0
        hashed = _mixed(hashed ^ np.ascontiguousarray(coordinates).view(np.uint64))
    sums = np.add.reduceat(hashed, offsets[:-1]) if len(faces) else hashed
    return _mixed(sums ^ whole.face_surface[faces].astype(np.uint64))


def _corner_sums(whole: CellComplex) -> np.ndarray:
    """(F,) uint64: of each face a sum of hashes of its vertices, which does not depend on their order."""
    hashed = _mixed(np.arange(len(whole.vertices), dtype=np.uint64))[whole.face_vertices]
    return np.add.reduceat(hashed, whole.face_offsets[:-1]) if len(whole.face_surface) else hashed


def _mixed(values: np.ndarray) -> np.ndarray:
    """64 bits that differ in about half of them where values do in one (S. Vigna, splitmix64, 2015)."""
    values = values + np.uint64(0x9E3779B97F4A7C15)
    values = (values ^ (values >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    values = (values ^ (values >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return values ^ (values >> np.uint64(31))
