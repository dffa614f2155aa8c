# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes of faults, continued in their own plane beyond their borders."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...base.algebra import dot, norm, principal_axes
from ...base.errors import InputRefused, place_text
from ...base.triangles import Sheet, cross, edge_numbers, edges_of, welded
from .fitted import plane_axes

_MITRE = 0.5  # a vertex continues at most by twice the length
_ALONG = 1e-3  # of a squared edge: what continues it is at least as long, or it would fold over
_RISES = 0.05  # of the length: so far each edge continues at least, or it would fold back
_PARALLEL = 0.99  # cosine between two directions: where they are as near, their lines meet far away


@dataclass(frozen=True)
class Border:
    """The border of a mesh: edges (E, 2) int64, as their triangles run, of vertices at one position the
    least; away (E, 3), of length 1: the directions in which they are continued in the planes of their
    triangles; is_outer (E,) bool: not around a hole."""

    edges: np.ndarray
    away: np.ndarray
    is_outer: np.ndarray

    def some(self, chosen: np.ndarray) -> Border:
        """Some of the edges, (E,) bool."""
        return Border(self.edges[chosen], self.away[chosen], self.is_outer[chosen])


def border_of(vertices: np.ndarray, triangles: np.ndarray) -> Border:
    """The border of a mesh: vertices (V, 3), triangles (T, 3), turned alike and each with an area."""
    corners = welded(vertices)[triangles]
    edges, apex = edges_of(corners), np.concatenate([corners[:, k] for k in (2, 0, 1)])
    _, number, count = np.unique(edge_numbers(edges, len(vertices)), return_inverse=True, return_counts=True)
    is_open = count[number.ravel()] % 2 == 1
    edges, apex = edges[is_open].astype(np.int64), apex[is_open]
    begin, end = vertices[edges[:, 0]], vertices[edges[:, 1]]
    along, inward = end - begin, vertices[apex] - begin
    share = dot(inward, along) / dot(along, along)
    away = _units(share[:, None] * along - inward)
    return Border(edges, away, _are_outer(vertices, triangles, edges))


def _are_outer(vertices: np.ndarray, triangles: np.ndarray, edges: np.ndarray) -> np.ndarray:
    """(E,) bool: the edges of rings that turn as the triangles do; those around holes turn the other way."""
    part = connected(edges)
    origin = vertices[triangles].mean(axis=(0, 1))
    a, b, c = (vertices[triangles] - origin).transpose(1, 0, 2)
    facing = cross(b - a, c - a).sum(axis=0)
    turns = dot(cross(vertices[edges[:, 0]] - origin, vertices[edges[:, 1]] - origin), facing)
    return np.bincount(part, turns)[part] > 0


def connected(edges: np.ndarray) -> np.ndarray:
    """(E,) the number of the connected component, from 0, that each edge is in."""
    _, ends = np.unique(edges, return_inverse=True)
    ends = ends.reshape(-1, 2)
    count = ends.max(initial=-1) + 1
    vertex, other = ends.ravel("F"), ends[:, ::-1].ravel("F")
    order = np.argsort(vertex, kind="stable")
    begin, other = np.searchsorted(vertex[order], np.arange(count)), other[order]
    least = np.arange(count)
    while len(least):
        before = least
        least = np.minimum(least, np.minimum.reduceat(least[other], begin))
        least = least[least]
        if np.array_equal(least, before):
            break
    return np.unique(least[ends[:, 0]], return_inverse=True)[1].ravel()


def extended(vertices: np.ndarray, triangles: np.ndarray, by: float, sideways: bool = True) -> Sheet:
    """A mesh, continued by a length beyond its outer borders; holes stay. With sideways False up and down the
    dip of its mean plane only. Raises InputRefused."""
    border = border_of(vertices, triangles)
    chosen = border.is_outer
    if not sideways:
        along, down, _ = plane_axes(principal_axes(vertices[np.unique(triangles)])[1][2])
        chosen &= np.abs(dot(border.away, down)) >= np.abs(dot(border.away, along))
    return continued(vertices, triangles, border.some(chosen), by)


def continued(vertices: np.ndarray, triangles: np.ndarray, border: Border, by: float) -> Sheet:
    """A mesh with a strip of a given width beyond some edges of its border, in the planes of their triangles.
    At bays, where it would overlap itself, edges meet at one vertex. Raises InputRefused where the border
    turns back on itself."""
    if not len(border.edges):
        return Sheet(vertices, triangles)
    # where two rings touch, each has a vertex of its own beyond
    keys = np.concatenate([_ranked(border.edges[:, end]) for end in range(2)])
    keys, ends = np.unique(keys, axis=0, return_inverse=True)
    ends = ends.reshape(2, -1).T
    places, target = _beyond(vertices[keys[:, 0]], ends, border.away, by)
    a, b = border.edges.T
    far_a, far_b = len(vertices) + target[ends].T
    strip = [np.column_stack([b, a, far_a]), np.column_stack([b, far_a, far_b])[far_a != far_b]]
    return Sheet(np.concatenate([vertices, places]), np.concatenate([triangles, *strip]).astype(np.int32))


def _ranked(nodes: np.ndarray) -> np.ndarray:
    """(E, 2) each of some numbers, and how often it was there before."""
    order = np.argsort(nodes, kind="stable")
    rank = np.empty(len(nodes), np.int64)
    rank[order] = np.arange(len(nodes)) - np.searchsorted(nodes[order], nodes[order])
    return np.column_stack([nodes, rank])


def _beyond(
    places: np.ndarray, ends: np.ndarray, away: np.ndarray, by: float
) -> tuple[np.ndarray, np.ndarray]:
    """The vertices (K, 3) beyond those (N, 3) of some edges (E, 2), and for each of the latter which it is
    (N,): so far that each edge continues by a length in its direction, away (E, 3). Raises InputRefused."""
    along = places[ends[:, 1]] - places[ends[:, 0]]
    least = _ALONG * dot(along, along)
    group = np.arange(len(places))
    while True:
        group = np.unique(group, return_inverse=True)[1].ravel()
        beyond = _corners(places, ends, away, group, by)
        first, last = group[ends].T
        folded = (dot(beyond[last] - beyond[first], along) <= least) & (first != last)
        if not folded.any():
            break
        for one, other in ends[folded].tolist():
            group[group == group[other]] = group[one]
    rise = np.min([dot(beyond[group[corner]] - places[corner], away) for corner in ends.T], axis=0)
    if (rise <= _RISES * by).any():
        place = places[ends[int(rise.argmin()), 0]]
        raise InputRefused(
            f"it cannot be extended: its border turns back on itself near {place_text(place)}",
            advice="smooth its border there, or extend the mesh itself",
            place=tuple(place.tolist()),
        )
    return beyond, group


def _corners(
    places: np.ndarray, ends: np.ndarray, away: np.ndarray, group: np.ndarray, by: float
) -> np.ndarray:
    """(K, 3) where the lines meet into which the edges before and after each group of vertices continue."""
    count = int(group.max()) + 1
    size = np.bincount(group, minlength=count)[:, None]
    middle = np.zeros((count, 3))
    np.add.at(middle, group, places)
    middle /= size
    around = np.zeros(count)
    np.maximum.at(around, group, norm(places - middle[group]))
    # of the edges that arrive at a group and that leave it: their directions, and how far these go
    ways, lengths = np.zeros((2, count, 3)), np.zeros((2, count))
    is_between = group[ends[:, 0]] != group[ends[:, 1]]
    for number, end in enumerate((1, 0)):
        at = group[ends[is_between, end]]
        ways[number, at] = away[is_between]
        lengths[number, at] = by - dot(middle[at] - places[ends[is_between, end]], away[is_between])
    is_alone = (ways == 0).all(axis=2)
    for number, across in ((0, 1), (1, 0)):
        ways[number, is_alone[number]] = ways[across, is_alone[number]]
        lengths[number, is_alone[number]] = lengths[across, is_alone[number]]
    (one, other), (to_one, to_other) = ways, lengths
    alike = dot(one, other)
    apart = np.abs(alike) < _PARALLEL
    whole = np.where(apart, 1 - alike * alike, 1.0)
    mean = (to_one + to_other) / 2 / np.maximum(1 + alike, 1 - _PARALLEL)
    share = np.where(apart, (to_one - alike * to_other) / whole, mean)
    other_share = np.where(apart, (to_other - alike * to_one) / whole, mean)
    step = share[:, None] * one + other_share[:, None] * other
    longest = by / _MITRE + around
    return middle + step * np.minimum(1.0, longest / np.maximum(norm(step), longest))[:, None]


def _units(vectors: np.ndarray) -> np.ndarray:
    """(N, 3) of length 1; 0 stays 0."""
    size = norm(vectors)
    return vectors / np.where(size > 0, size, 1.0)[:, None]
