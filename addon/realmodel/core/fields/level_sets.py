# SPDX-License-Identifier: GPL-3.0-or-later
"""Level sets of a scalar field, with contacts on them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..base.sheet import Sheet
from ..base.work import Work, native_module
from .lattice import ScalarField


def with_contacts(field: ScalarField, contacts: np.ndarray, surfaces: np.ndarray) -> ScalarField:
    """The field with contacts (C, 3) as corners of tetrahedra, at which it has the level of their surfaces
    (C,) exactly; and with nodes on a level that are next to nothing beside it."""
    lattice, values, _ = field.native()
    return replace(
        field,
        values=native_module().moved_onto_levels(lattice, values, field.levels),
        points=np.ascontiguousarray(contacts, np.float64),
        point_values=field.levels[surfaces],
    )


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
