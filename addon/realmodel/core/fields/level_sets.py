# SPDX-License-Identifier: GPL-3.0-or-later
"""Level sets of a scalar field, with contacts on them."""

from __future__ import annotations

from dataclasses import replace
from typing import TypeVar

import numpy as np

from ..base.algebra import are_among
from ..base.sheet import Sheet
from ..base.work import Work, native_module
from .lattice import ScalarField

_Field = TypeVar("_Field", bound=ScalarField)
_LOOSE = 1e-6  # of the share of a contact in its tetrahedron: how firmly nodes follow contacts
_ROUNDS = 200
_MET = 1e-12  # of what contacts miss their levels by at first: nothing


def with_contacts(field: _Field, contacts: np.ndarray, surfaces: np.ndarray) -> _Field:
    """The field with contacts (C, 3) as corners of tetrahedra, at which it has the level of their surfaces
    (C,) exactly. Before that its nodes are moved as little as they must be for it to have these levels there
    nearly: a corner alone would be a peak beside its surface where that passes another tetrahedron. Nodes on
    a level but for next to nothing are moved onto it."""
    lattice, _, _ = field.native()
    levels = field.levels[surfaces]
    values = _through(field, contacts, levels)
    return replace(
        field,
        values=native_module().moved_onto_levels(lattice, values, field.levels),
        points=np.ascontiguousarray(contacts, np.float64),
        point_values=levels,
    )


def _through(field: ScalarField, contacts: np.ndarray, levels: np.ndarray) -> np.ndarray:
    """(nodes,) the values nearest to those of a field with which it has levels (C,) at contacts: with the
    weights A of contacts, values + A^T y where (A A^T + loose) y is what they miss their levels by; by
    conjugate gradients (Hestenes and Stiefel 1952)."""
    found, weights = field.lattice.located(contacts)
    used, nodes = np.unique(found, return_inverse=True)
    nodes = nodes.reshape(found.shape)

    def spread(y: np.ndarray) -> np.ndarray:
        return np.bincount(nodes.ravel(), (weights * y[:, None]).ravel(), len(used))

    missed = levels - (field.values[found] * weights).sum(axis=1)
    y, way, rest = np.zeros(len(missed)), missed, missed
    square = first = (rest * rest).sum()
    for _ in range(_ROUNDS):
        if square <= _MET**2 * first:
            break
        ahead = (spread(way)[nodes] * weights).sum(axis=1) + _LOOSE * way
        step = square / (way * ahead).sum()
        y = y + step * way
        rest = rest - step * ahead
        square, before = (rest * rest).sum(), square
        way = rest + square / before * way
    values = field.values.copy()
    values[used] += spread(y)
    return values


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
