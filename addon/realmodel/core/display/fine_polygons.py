# SPDX-License-Identifier: GPL-3.0-or-later
"""Polygons of a mesh divided into small triangles, for values that are not linear across them.

Edges that are too long are halved, those first that are the longest of all triangles at them (M.-C. Rivara
1997, "New longest-edge algorithms for the refinement and/or improvement of unstructured triangulations"), so
that slender triangles become few. The mesh stays closed: polygons that are not divided get the new vertices
on their edges as corners.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..base.algebra import norm
from ..base.work import native_module

_HIGH = np.int64(1) << 32  # an edge as one number: its lower vertex times this, plus the higher one; so pairs


@dataclass(frozen=True, eq=False)
class FinePolygons:
    """offsets: (F' + 1,) int32. corners: (C',) int32, vertices. polygon: (F',) int64, the given polygon that
    each is a part of, rising. given: how many vertices there were; new ones are counted on. parents: (N, 2)
    int64, of each new vertex the two that it is halfway between, which come before it."""

    offsets: np.ndarray
    corners: np.ndarray
    polygon: np.ndarray
    given: int
    parents: np.ndarray

    def of_corners(self, offsets: np.ndarray, corners: np.ndarray, values: np.ndarray) -> np.ndarray:
        """Values (C, K) of the corners of the given polygons, as those of the corners (C', K) of the parts,
        of new ones by halves within their polygon."""
        pairs, number = np.unique(_pairs(self.polygon, self.offsets, self.corners), return_inverse=True)
        order = np.argsort(pairs % _HIGH, kind="stable")  # parents come first
        pairs = pairs[order]
        rank = np.argsort(pairs)
        begin = int(np.count_nonzero(pairs % _HIGH < self.given))
        old_pairs, row = np.unique(_pairs(np.arange(len(offsets) - 1), offsets, corners), return_index=True)
        pair_values = np.empty((len(pairs), values.shape[1]), values.dtype)
        pair_values[:begin] = values[row[np.searchsorted(old_pairs, pairs[:begin])]]
        polygon, vertex = pairs[begin:] // _HIGH, pairs[begin:] % _HIGH
        parents = polygon[:, None] * _HIGH + self.parents[vertex - self.given]
        _fill_halves(pair_values, rank[np.searchsorted(pairs, parents, sorter=rank)], begin)
        place = np.empty(len(order), np.int64)
        place[order] = np.arange(len(order))
        return pair_values[place[number.ravel()]]

    def extended(self, values: np.ndarray) -> np.ndarray:
        """Values (V, ...) of the given vertices, and after them those of the new ones, by halves."""
        all_values = np.concatenate([values, np.zeros((len(self.parents), *values.shape[1:]), values.dtype)])
        _fill_halves(all_values, self.parents, len(values))
        return all_values


def fine_polygons(
    positions: np.ndarray, offsets: np.ndarray, corners: np.ndarray, chosen: np.ndarray, longest: float
) -> FinePolygons:
    """Polygons of which some are divided until no edge is longer than a length.

    positions: (V, 3) float64. offsets: (F + 1,), corners: (C,) vertices. chosen: (F,) bool, to be divided."""
    counts = np.diff(offsets)
    rings = np.ascontiguousarray(corners[np.repeat(chosen, counts)], np.int32)
    begins = np.cumsum([0, *counts[chosen]], dtype=np.int64)
    triangles, begins = native_module().triangulate_faces(positions, begins, rings)
    polygon = np.repeat(np.flatnonzero(chosen), np.diff(begins))
    triangles, polygon, parents = _halved(triangles.astype(np.int64), polygon, positions, longest)
    others = np.flatnonzero(~chosen)
    other_corners, of_others = _with_corners(
        corners[np.repeat(~chosen, counts)].astype(np.int64),
        np.repeat(others, counts[others]),
        parents,
        len(positions),
    )
    piece = np.concatenate([others, polygon])
    sizes = np.append(np.bincount(of_others, minlength=len(counts))[others], np.full(len(polygon), 3))
    order = np.argsort(piece, kind="stable")
    ends = np.cumsum(sizes[order])
    shift = (np.cumsum(sizes) - sizes)[order] - (ends - sizes[order])
    rows = np.repeat(shift, sizes[order]) + np.arange(ends[-1] if len(ends) else 0)
    new_corners = np.append(other_corners, triangles.ravel())[rows]
    offsets = np.append(0, ends).astype(np.int32)
    return FinePolygons(offsets, new_corners.astype(np.int32), piece[order], len(positions), parents)


def _halved(
    triangles: np.ndarray, polygon: np.ndarray, positions: np.ndarray, longest: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Triangles without long edges, the polygon of each, and the parents of the new vertices."""
    done, parents = [], []
    while len(triangles):
        lengths = norm(positions[np.roll(triangles, -1, axis=1)] - positions[triangles])
        is_long = lengths.max(axis=1, initial=0.0) > longest
        done.append((triangles[~is_long], polygon[~is_long]))
        triangles, polygon, lengths = triangles[is_long], polygon[is_long], lengths[is_long]
        keys = _keys(triangles, np.roll(triangles, -1, axis=1))
        # of edges of one length the last by its number, so that triangles agree on the order of all
        side = np.lexsort((keys, lengths), axis=1)[:, 2] if len(keys) else np.zeros(0, np.int64)
        rows = np.arange(len(triangles))
        edges, number, times = np.unique(keys, return_inverse=True, return_counts=True)
        number = number.reshape(keys.shape)[rows, side]
        halved = np.bincount(number, minlength=len(edges)) == times
        new = len(positions) - 1 + np.cumsum(halved)
        first, second = edges[halved] // _HIGH, edges[halved] % _HIGH
        parents.append(np.column_stack([first, second]))
        positions = np.concatenate([positions, (positions[first] + positions[second]) / 2])
        a, b, c = (triangles[rows, (side + step) % 3] for step in range(3))
        split, middle = halved[number], new[number]
        a, b, c, middle = (
            np.concatenate([vertices[~split], vertices[split], vertices[split]])
            for vertices in (a, b, c, middle)
        )
        whole, parts = np.count_nonzero(~split), np.count_nonzero(split)
        b[whole : whole + parts] = middle[whole : whole + parts]
        a[whole + parts :] = middle[whole + parts :]
        triangles = np.column_stack([a, b, c])
        polygon = np.concatenate([polygon[~split], polygon[split], polygon[split]])
    empty = np.empty((0, 3), np.int64), np.empty(0, np.int64)
    pieces, of = (np.concatenate(parts) for parts in zip(empty, *done, strict=True))
    return pieces, of, np.concatenate([np.empty((0, 2), np.int64), *parents])


def _with_corners(
    corners: np.ndarray, polygon: np.ndarray, parents: np.ndarray, vertex_count: int
) -> tuple[np.ndarray, np.ndarray]:
    """Rings of corners, the polygon of each corner beside it, with the new vertices on their edges."""
    keys = _keys(parents[:, 0], parents[:, 1])
    order = np.argsort(keys)
    while len(corners):
        last = np.append(polygon[1:] != polygon[:-1], True)
        first = np.flatnonzero(np.append(True, last[:-1]))
        following = np.roll(corners, -1)
        following[last] = corners[first]
        wanted = _keys(corners, following)
        at = np.minimum(np.searchsorted(keys[order], wanted), max(len(keys) - 1, 0))
        is_halved = keys[order][at] == wanted if len(keys) else np.zeros(len(wanted), bool)
        if not is_halved.any():
            break
        after = np.flatnonzero(is_halved) + 1
        corners = np.insert(corners, after, vertex_count + order[at[is_halved]])
        polygon = np.insert(polygon, after, polygon[is_halved])
    return corners, polygon


def _keys(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    return np.minimum(first, second) * _HIGH + np.maximum(first, second)


def _pairs(polygon: np.ndarray, offsets: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """(C,) each corner as one number: the number of its polygon (F,) and its vertex."""
    return np.repeat(polygon, np.diff(offsets)).astype(np.int64) * _HIGH + corners


def _fill_halves(values: np.ndarray, parents: np.ndarray, begin: int) -> None:
    """Sets the values of vertices from `begin` on, wave by wave of those whose parents are known."""
    while begin < len(values):
        pending = parents[len(parents) - (len(values) - begin) :]
        ready = np.append(pending.max(axis=1) >= begin, True).argmax()
        values[begin : begin + ready] = (values[pending[:ready, 0]] + values[pending[:ready, 1]]) / 2
        begin += int(ready)
