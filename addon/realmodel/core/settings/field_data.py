# SPDX-License-Identifier: GPL-3.0-or-later
"""What is known of a surface beside points on it: dips, and heights that it lies above or below."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..base.errors import InputRefused, place_text


@dataclass(frozen=True, eq=False)
class Dips:
    """Dips of a surface. positions: (D, 2) float64 x, y. gradients: (D, 2) float64, its slope along x and
    along y. z: (D,) float64 heights of the positions, NaN where they are not known, or None: a height only
    says on which side of a fault a dip is."""

    positions: np.ndarray
    gradients: np.ndarray
    z: np.ndarray | None = None

    def __len__(self) -> int:
        return len(self.positions)

    def some(self, kept: np.ndarray) -> Dips:
        """Some of them. kept: (D,) bool, or their numbers."""
        z = None if self.z is None else self.z[kept]
        return Dips(self.positions[kept], self.gradients[kept], z)

    def checked(self) -> Dips:
        """The same as arrays of float64. Raises InputRefused."""
        positions, gradients = (
            _floats(values, (len(self.positions), 2), f"{name} of dips")
            for name, values in (("positions", self.positions), ("gradients", self.gradients))
        )
        z = None if self.z is None else _floats(self.z, (len(positions),), "z of dips")
        bad = np.flatnonzero(~np.isfinite(np.column_stack([positions, gradients])).all(axis=1))
        if len(bad):
            raise InputRefused(f"dip {bad[0]} is not finite", item="dips")
        return Dips(positions, gradients, z)

    def merged(self) -> tuple[Dips, str | None]:
        """One dip at each position, the mean of those there, and a warning where they differ."""
        places, place = np.unique(self.positions + 0.0, axis=0, return_inverse=True)
        if len(places) == len(self):
            return self, None
        place = place.reshape(-1)
        first = np.full(len(places), len(self))
        np.minimum.at(first, place, np.arange(len(self)))
        count = np.bincount(place)
        means = np.column_stack([np.bincount(place, weights=axis) / count for axis in self.gradients.T])
        apart = np.abs(self.gradients - means[place]).max(axis=1)
        differ = np.unique(place[apart > 1e-12 * (1 + np.abs(means[place]).max(axis=1))])
        order = np.argsort(first)
        kept = self.some(first[order])
        kept = Dips(kept.positions, np.ascontiguousarray(means[order]), kept.z)
        if not len(differ):
            return kept, None
        where = place_text(tuple(places[differ[0]].tolist()))
        many = "1 position has" if len(differ) == 1 else f"{len(differ)} positions have"
        return kept, f"{many} several dips, one at {where}: their mean slope is used"


@dataclass(frozen=True, eq=False)
class Bounds:
    """Inequalities of a surface's heights. positions: (N, 2) float64 x, y; lower, upper: (N,) float64: the
    surface lies at or above, and at or below these heights there; -inf and inf where there is no bound."""

    positions: np.ndarray
    lower: np.ndarray
    upper: np.ndarray

    def __len__(self) -> int:
        return len(self.positions)

    def some(self, kept: np.ndarray) -> Bounds:
        """Some of them. kept: (N,) bool, or their numbers."""
        return Bounds(self.positions[kept], self.lower[kept], self.upper[kept])

    def checked(self) -> Bounds:
        """The same as arrays of float64. Raises InputRefused."""
        count = len(self.positions)
        positions = _floats(self.positions, (count, 2), "positions of bounds")
        lower, upper = (
            _floats(values, (count,), f"{name} of bounds")
            for name, values in (("lower", self.lower), ("upper", self.upper))
        )
        wrong = ~np.isfinite(positions).all(axis=1) | ~(lower <= upper) | (lower == np.inf)
        bad = np.flatnonzero(wrong | (upper == -np.inf))
        if len(bad):
            raise InputRefused(
                f"bound {bad[0]} at {place_text(positions[bad[0]])} is from {lower[bad[0]]:g} to "
                f"{upper[bad[0]]:g}, which no height is",
                item="bounds",
            )
        return Bounds(positions, lower, upper)


def _floats(values, shape: tuple[int, ...], item: str) -> np.ndarray:
    try:
        array = np.ascontiguousarray(values, np.float64)
    except (TypeError, ValueError) as error:
        raise InputRefused("not an array of numbers", item=item) from error
    if array.shape != shape:
        raise InputRefused(f"must be an array {shape}, not {array.shape}", item=item)
    return array
