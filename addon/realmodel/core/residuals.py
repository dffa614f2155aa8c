# SPDX-License-Identifier: GPL-3.0-or-later
"""How far the points of surfaces are from the surfaces that were interpolated from them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from .layer_values import at_places

if TYPE_CHECKING:
    from .model import Model


@dataclass(frozen=True, eq=False)
class Residuals:
    """Of one surface: its points (P, 3) float64 where it has an elevation, and point minus surface there,
    (P,), model units. outside: how many points are beyond the surface."""

    rock: str
    surface: str
    points: np.ndarray
    values: np.ndarray
    outside: int

    @property
    def mean(self) -> float:
        return float(self.values.mean()) if len(self.values) else 0.0

    @property
    def root_mean_square(self) -> float:
        return float(np.sqrt((self.values**2).mean())) if len(self.values) else 0.0

    @property
    def largest(self) -> float:
        """The one farthest from zero."""
        return float(self.values[np.abs(self.values).argmax()]) if len(self.values) else 0.0


def residuals(model: Model) -> list[Residuals]:
    """Of each surface of a model that was interpolated from points, in the model's order."""
    found, number = [], 0
    for rock in model.project.rocks:
        for surface in rock.surfaces:
            points = surface.points
            if points is not None and len(points) and number < len(model.surface_names):
                there = at_places(*model.surface(number), points[:, :2], model.threads)
                known = np.isfinite(there)
                values = points[known, 2] - there[known]
                found.append(Residuals(rock.name, surface.name, points[known], values, int((~known).sum())))
            number += 1
    return found
