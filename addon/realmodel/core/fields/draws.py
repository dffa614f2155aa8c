# SPDX-License-Identifier: GPL-3.0-or-later
"""Fields drawn at random, as their data allow: the realizations of a series in an ensemble."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ..base.work import Work
from .lattice import Lattice
from .solve import FieldDraw, LevelSetData, SolvedField, solve_field

_PARTS = 3  # of the normal numbers of a field: directions, steps, errors of dips


@dataclass(frozen=True)
class FieldDraws:
    """How the fields of a series are drawn. normal: (part, count) gives (count,) independent normal numbers.
    known: the kind of random function by the data that it follows from, filled as they come, the same for
    all realizations. top: an elevation above all rock of the model, of which they are realizations."""

    normal: Callable[[int, int], np.ndarray]
    known: dict[bytes, tuple]
    top: float

    def field(self, lattice: Lattice, data: LevelSetData, work: Work, number: int) -> SolvedField:
        """The field of the data, drawn. number: of the field in its series. Raises as solve_field."""
        digest = hashlib.sha256(repr(lattice).encode())
        for array in (data.contacts, data.dips, data.normals, data.bounds):
            digest.update(np.ascontiguousarray(array))
        key = digest.digest()
        if key not in self.known:
            with work.part(0.0, 0.5):
                self.known[key] = solve_field(lattice, data, work).kind
        parts = iter(range(_PARTS * number, _PARTS * (number + 1)))
        draw = FieldDraw(self.known[key], lambda count: self.normal(next(parts), count))
        with work.part(0.5, 1.0):
            return solve_field(lattice, data, work, draw=draw)
