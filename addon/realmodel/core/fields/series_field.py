# SPDX-License-Identifier: GPL-3.0-or-later
"""The field of a series in each compartment of a rock mass."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..base.algebra import norm
from .lattice import ScalarField, rises


@dataclass(eq=False)
class SeriesField:
    """name: of the series. first: the number of its oldest surface in the rock mass. count: of its surfaces,
    which have the first levels of the fields. fields: one for each compartment, the same object where
    compartments share it. top: an elevation above all rock, below which the lattice reaches."""

    name: str
    first: int
    count: int
    fields: list[ScalarField]
    top: float

    @property
    def numbers(self) -> range:
        """The numbers of its surfaces in the rock mass."""
        return range(self.first, self.first + self.count)

    def stage(self, m: int) -> SeriesField | None:
        """With the surfaces up to m of the rock mass; None where there are none."""
        count = min(self.count, m + 1 - self.first)
        return replace(self, count=count) if count > 0 else None

    def within(self, box: np.ndarray, compartments: Sequence[int]) -> SeriesField:
        """The fields of some compartments, by their numbers, around a box (2, 3)."""
        some = {field: field.within(box) for field in {self.fields[number]: None for number in compartments}}
        return replace(self, fields=[some[self.fields[number]] for number in compartments])

    def distinct(self) -> dict[ScalarField, list[int]]:
        """The different fields, with the compartments of each."""
        by_field: dict[ScalarField, list[int]] = {}
        for compartment, field in enumerate(self.fields):
            by_field.setdefault(field, []).append(compartment)
        return by_field

    def excess(self, surface: int, points: np.ndarray, where: np.ndarray) -> np.ndarray:
        """(N,) how much f is above the level of a surface at points (N, 3) in the compartments `where`; NaN
        outside the lattice, or where the compartment is below 0; infinite above all rock."""
        excess = np.full(len(points), np.nan)
        for field, compartments in self.distinct().items():
            here = np.flatnonzero(np.isin(where, compartments))
            if len(here):
                excess[here] = field.at(points[here]) - field.levels[surface - self.first]
        excess[points[:, 2] > self.top] = np.inf
        return excess

    def distances(self, surface: int, points: np.ndarray, where: np.ndarray) -> np.ndarray:
        """(N,) about how far points are from a surface, positive on its younger side; else as `excess`."""
        steep = norm(self.slopes(points, where))
        return self.excess(surface, points, where) / np.where(steep > 0, steep, 1.0)

    def slopes(self, points: np.ndarray, where: np.ndarray) -> np.ndarray:
        """(N, 3) how much f rises along x, y and z at points (N, 3) in the compartments `where`, over a
        spacing of the lattice; 0 where the compartment is below 0."""
        rise = np.zeros((len(points), 3))
        for field, compartments in self.distinct().items():
            here = np.flatnonzero(np.isin(where, compartments))
            change, far = rises(field, points[here])
            rise[here] = change / np.where(far > 0, far, np.inf)
        return rise
