# SPDX-License-Identifier: GPL-3.0-or-later
"""Faces given by the places of their corners, or numbers of places: equal corners become one vertex, piece
by piece."""

from __future__ import annotations

import numpy as np

from ...base.mapped_arrays import MakeRows, Rows, in_pieces
from .triangle_mesh import MeshRows

_CORNERS_AT_ONCE = 3 << 16
_OF_PART = 1 << 8  # sampled corners of a slice, by which the limits of slices are chosen
_NAMED = np.dtype([("corner", np.int64), ("vertex", np.int64)])


def share_vertices(
    corners: np.ndarray,
    sizes: np.ndarray | None,
    mesh: MeshRows,
    rows: MakeRows,
    places: np.ndarray | None = None,
) -> None:
    """Adds corners (C, 3) of faces to a mesh, each place once, in the order of its coordinates: slice by
    slice of x, and then the faces some at a time. sizes: how many corners each face has, None: three. places
    (P, 3): corners (C,) are numbers of these, and the order is that of the numbers."""
    if not len(corners):
        return
    parts = -(-len(corners) // _CORNERS_AT_ONCE)
    some = np.sort(_first(corners[:: -(-len(corners) // (parts * _OF_PART))]))
    ends = np.unique(some[[len(some) * part // parts for part in range(1, parts)]])
    kind = np.dtype([("place", corners.dtype, corners.shape[1:]), ("corner", np.int64)])
    slices = [rows(np.empty(0, kind)) for _ in range(len(ends) + 1)]
    begin = 0
    for piece in in_pieces(corners):
        placed = np.empty(len(piece), kind)
        placed["place"], placed["corner"] = piece, np.arange(begin, begin + len(piece))
        begin += len(piece)
        _distribute(placed, np.searchsorted(ends, _first(piece), "right"), slices)
    of_corners = [rows(np.empty(0, _NAMED)) for _ in range(parts)]
    for each in slices:
        placed = each.taken()
        found, index = np.unique(placed["place"], axis=0, return_inverse=True)
        named = np.empty(len(placed), _NAMED)
        named["corner"], named["vertex"] = placed["corner"], index.ravel() + mesh.vertices
        mesh.add_vertices(found if places is None else places[found])
        _distribute(named, named["corner"] // _CORNERS_AT_ONCE, of_corners)
    rest, face = np.empty(0, np.int64), 0  # corners of a face that goes on in the next part
    for part, each in enumerate(of_corners):
        named = each.taken()
        index = np.empty(len(named), np.int64)
        index[named["corner"] - part * _CORNERS_AT_ONCE] = named["vertex"]
        index = np.concatenate([rest, index])
        faces, taken = faces_of(index, None if sizes is None else sizes[face : face + len(index) // 3])
        mesh.add_faces(faces)
        rest, face = index[taken:], face + len(faces)


def _first(corners: np.ndarray) -> np.ndarray:
    """x of places; numbers as they are."""
    return corners.reshape(len(corners), -1)[:, 0]


def faces_of(index: np.ndarray, sizes: np.ndarray | None) -> tuple[np.ndarray | list, int]:
    """The faces that corners begin with, and how many corners these have."""
    sizes = np.empty(0, np.int64) if sizes is None else sizes
    size = int(sizes[0]) if len(sizes) else 3
    if size and (sizes == size).all():
        whole = len(index) // size * size
        return index[:whole].reshape(-1, size), whole
    ends = np.cumsum(sizes)
    whole = int(np.searchsorted(ends, len(index), "right"))
    if not whole:
        return [], 0
    parts = np.split(index[: ends[whole - 1]], ends[: whole - 1])
    return [part.tolist() for part in parts], int(ends[whole - 1])


def _distribute(table: np.ndarray, part: np.ndarray, parts: list[Rows]) -> None:
    """part: of each row."""
    if not len(part):
        return
    order = np.argsort(part, kind="stable")
    there, begins = np.unique(part[order], return_index=True)
    for number, which in zip(there.tolist(), np.split(order, begins[1:]), strict=True):
        parts[number].add(table[which])
