# SPDX-License-Identifier: GPL-3.0-or-later
"""Layers of series, whose bedding follows the field of the series."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ..base.algebra import norm
from ..fields.series_field import SeriesField

_SAMPLES = 4096  # corners of a layer by which its mean thickness is measured


@dataclass(frozen=True, eq=False)
class SeriesLayer:
    """The layer beneath a surface of a series, or the one on its youngest surface, beneath an unconformity.
    surface: the number in the rock mass of the surface that it lies beneath. local: for each compartment of
    the model its number in the rock mass, -1: none. thickness: its mean, model units. The oldest layer of a
    series begins at the least value of its fields, the one on the youngest surface ends at the largest."""

    own: SeriesField
    surface: int
    local: np.ndarray
    thickness: float

    @staticmethod
    def of(
        own: SeriesField, surface: int, local: np.ndarray, points: np.ndarray, compartment: np.ndarray
    ) -> SeriesLayer:
        """points: (N, 3) of its corners; compartment: (N,) of the model."""
        where = local[compartment]
        layer = SeriesLayer(own, surface, local, 0.0)
        away = layer._away(points, where)
        if np.isnan(away).all():
            return layer
        whole = layer._whole(away, points, where)
        chosen = np.flatnonzero(np.isfinite(away))[:: max(1, len(away) // _SAMPLES)]
        steep = norm(own.slopes(points[chosen], where[chosen])).mean()
        return replace(layer, thickness=float(np.nanmean(whole) / steep) if steep > 0 else 0.0)

    @property
    def has_top(self) -> bool:
        """Whether a surface of the series is its top."""
        return self.surface in self.own.numbers

    @property
    def has_base(self) -> bool:
        """Whether a surface of the series is its base."""
        return self.surface > self.own.first

    @property
    def longest(self) -> float:
        """The longest edge between whose ends bedding may be linear, model units: twice the smallest edge of
        the lattices of its fields."""
        return 2.0 * min(min(field.lattice.spacing) for field in self.own.fields)

    def shares(self, points: np.ndarray, compartment: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """(N,) the shares of the height of the layer at points in compartments of the model, and (N,) bool
        where these are known."""
        where = self.local[compartment]
        away = self._away(points, where)
        whole = self._whole(away, points, where)
        share = away / np.where(whole > 0, whole, np.nan)
        share = np.clip(1.0 - share if self.has_top else share, 0.0, 1.0)
        return share, np.isfinite(share)

    def _away(self, points: np.ndarray, where: np.ndarray) -> np.ndarray:
        """(N,) how much the field changes from the top into the layer; from its base if it has no top."""
        if self.has_top:
            change = -self.own.excess(self.surface, points, where)
        else:
            change = self.own.excess(self.surface - 1, points, where)
        return np.where(np.isfinite(change), change, np.nan)

    def _whole(self, away: np.ndarray, points: np.ndarray, where: np.ndarray) -> np.ndarray:
        """(N,) how much the field rises from the base of the layer to its top."""
        if self.has_top and self.has_base:
            return away + self.own.excess(self.surface - 1, points, where)
        fields = self.own.distinct()
        if self.has_top:
            most = max(field.levels[0] - field.values.min() for field in fields)
        else:
            most = max(field.values.max() - field.levels[self.own.count - 1] for field in fields)
        return np.full(len(away), float(most))
