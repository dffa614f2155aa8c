# SPDX-License-Identifier: GPL-3.0-or-later
"""Level sets of a scalar field, with contacts on them."""

from __future__ import annotations

from dataclasses import replace
from typing import TypeVar

import numpy as np

from ..base.algebra import are_among, norm
from ..base.sheet import Sheet
from ..base.work import Work, native_module
from .lattice import ScalarField

_Field = TypeVar("_Field", bound=ScalarField)
_LOOSE = 1e-2  # of the share of a contact in its tetrahedron: where they share corners, none moves far
_SHARED = 0.1  # of what contacts miss their levels by: where more is left at first they share corners
_ROUNDS = 10  # in which what is left is made less
_STEPS = 200  # of each solution
_MET = 1e-12  # of what contacts miss their levels by at first: nothing
_REFINEMENTS = 40  # times that tetrahedra are halved
_LEAST = 2.0**-10  # of the edges of the lattice: shorter ones are not halved
_BESIDE = 0.01  # of the range of f in its tetrahedron: what a contact may miss its level by


def with_contacts(work: Work, field: _Field, contacts: np.ndarray, surfaces: np.ndarray) -> _Field:
    """The field with contacts (C, 3) as corners of tetrahedra, at which it has the level of their surfaces
    (C,) exactly. Before that its values are moved as little as they must be for it to have these levels there
    nearly: a corner alone would be a peak beside its surface where that passes another tetrahedron. Where
    contacts are denser than nodes, so that it cannot have them all, tetrahedra are halved along their longest
    edges (M. C. Rivara 1984) until it can. Nodes on a level but for next to nothing are moved onto it."""
    levels = field.levels[surfaces]
    contacts = np.ascontiguousarray(contacts, np.float64)
    middles, at_middles = np.empty((0, 3)), np.empty(0)
    for left in reversed(range(_REFINEMENTS)):
        given = np.concatenate([field.values, at_middles])
        lattice, values, own = replace(field, points=middles, point_values=at_middles).native()
        corners, weights = work.native(native_module().tetrahedra_at, lattice, values, own, contacts)
        missed = [np.abs(_through(given, corners, weights, levels, rounds)[1]) for rounds in (0, 1)]
        off = (missed[1] > _BESIDE * np.ptp(given[corners], axis=1)) & (missed[1] > _SHARED * missed[0])
        ends = _halved(field, middles, corners[off])
        if not len(ends):
            found, _ = _through(given, corners, weights, levels, _ROUNDS)
            made = _as_corners(field, found, np.concatenate([middles, contacts]), levels)
            lattice, values, own = made.native()
            passed = work.native(native_module().points_between, lattice, values, own)
            ends = _halved(field, middles, corners[passed[len(middles) :] == 0])
        places = np.concatenate([middles, _positions(field, middles, ends).mean(axis=1)])
        new = np.sort(np.unique(places, axis=0, return_index=True)[1])
        if left == 0 or len(new) == len(middles):
            break
        middles, at_middles = places[new], np.concatenate([at_middles, given[ends].mean(axis=1)])[new]
    found, _ = _through(given, corners, weights, levels, _ROUNDS)
    return _as_corners(field, found, np.concatenate([middles, contacts]), levels)


def _as_corners(field: _Field, values: np.ndarray, points: np.ndarray, levels: np.ndarray) -> _Field:
    """A field with values at nodes, then at the first of some points, and levels at the others."""
    lattice, _, _ = field.native()
    nodes, own = np.split(values, [len(field.values)])
    nodes = native_module().moved_onto_levels(lattice, nodes, field.levels)
    return replace(field, values=nodes, points=points, point_values=np.concatenate([own, levels]))


def _positions(field: ScalarField, points: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """(..., 3) of corners: nodes, and points (P, 3) counted after all nodes."""
    lattice = field.lattice
    steps = np.stack(
        [corners // stride % count for stride, count in zip(lattice.strides, lattice.counts, strict=True)], -1
    )
    found = lattice.origin + np.multiply(lattice.spacing, steps)
    is_point = corners >= lattice.nodes
    found[is_point] = points[corners[is_point] - lattice.nodes]
    return found


def _halved(field: ScalarField, points: np.ndarray, tetrahedra: np.ndarray) -> np.ndarray:
    """(N, 2) the ends of the longest edges of tetrahedra (T, 4), each once, but of those that are small."""
    edges = tetrahedra[:, [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]]]
    ends = _positions(field, points, edges)
    length = norm(ends[:, :, 1] - ends[:, :, 0])
    longest = edges[np.arange(len(edges)), length.argmax(axis=1)]
    large = length.max(axis=1, initial=0.0) > _LEAST * max(field.lattice.spacing)
    return np.unique(np.sort(longest[large], axis=1), axis=0)


def _through(
    given: np.ndarray, corners: np.ndarray, weights: np.ndarray, levels: np.ndarray, rounds: int
) -> tuple[np.ndarray, np.ndarray]:
    """(N,) values near those given with which a field has levels (C,) at contacts, as far as these do not
    pull at the same corners, by the corners (C, 4) of their tetrahedra and the weights A of these: in rounds
    A^T y is added where (A A^T + loose) y is what they miss their levels by (iterated regularization of A. N.
    Tikhonov; H. W. Engl 1987), by conjugate gradients (Hestenes and Stiefel 1952). And (C,) what they still
    miss."""
    used, at = np.unique(corners, return_inverse=True)
    at = at.reshape(corners.shape)

    def spread(y: np.ndarray) -> np.ndarray:
        return np.bincount(at.ravel(), (weights * y[:, None]).ravel(), len(used))

    values = given.copy()
    missed = levels - (given[corners] * weights).sum(axis=1)
    least = _MET**2 * (missed * missed).sum()
    for _ in range(rounds):
        y, way, rest = np.zeros(len(missed)), missed, missed
        square = (rest * rest).sum()
        for _ in range(_STEPS):
            if square <= least:
                break
            ahead = (spread(way)[at] * weights).sum(axis=1) + _LOOSE * way
            step = square / (way * ahead).sum()
            y = y + step * way
            rest = rest - step * ahead
            square, before = (rest * rest).sum(), square
            way = rest + square / before * way
        values[used] += spread(y)
        missed = levels - (values[corners] * weights).sum(axis=1)
    return values, missed


def are_on(contacts: np.ndarray, level_set: Sheet) -> np.ndarray:
    """(C,) bool: which contacts (C, 3) are vertices of a level set."""
    return are_among(contacts, level_set.vertices)


def level_solids(work: Work, field: ScalarField) -> list[Sheet]:
    """Of each level the closed boundary of where the field is at most that: in the lattice the level set,
    around the lattice what closes it. No two of them cross. Triangles turn counter-clockwise seen from where
    the field is greater. Raises native InputError."""
    lattice, values, points = field.native()
    found = work.native(native_module().level_sets, lattice, values, points, field.levels)
    return [Sheet(vertices, triangles) for vertices, triangles in found]


def within_lattice(field: ScalarField, solid: Sheet) -> Sheet:
    """The part of a level_solid in the lattice: the level set."""
    low, high = field.lattice.corners
    vertices = solid.vertices
    inside = np.all((vertices >= low) & (vertices <= high), axis=1)
    part = solid.some(np.all(inside[solid.triangles], axis=1))
    return Sheet(part.vertices, part.triangles)
