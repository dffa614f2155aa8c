# SPDX-License-Identifier: GPL-3.0-or-later
"""Scalar fields in space, whose level sets are the surfaces of a series.

Input: a `Lattice` and data of surfaces: contacts, dips, bounds. Output: a `ScalarField`, linear on each
tetrahedron of the lattice, and the level of each surface.
"""

from .lattice import Lattice, ScalarField, rises
from .level_sets import (
    HeldData,
    LevelSolid,
    SharedCorners,
    are_on,
    fields_with_contacts,
    level_solids,
)
from .solve import Anisotropy, FieldDraws, LevelSetData, SlitData, SolvedField, solve_field

__all__ = [
    "Anisotropy",
    "FieldDraws",
    "HeldData",
    "Lattice",
    "LevelSetData",
    "LevelSolid",
    "ScalarField",
    "SharedCorners",
    "SlitData",
    "SolvedField",
    "are_on",
    "fields_with_contacts",
    "level_solids",
    "rises",
    "solve_field",
]
