# SPDX-License-Identifier: GPL-3.0-or-later
"""The distances of points from the surfaces that were interpolated from them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..base.work import Work, run
from ..cells.model_data import ModelData
from ..structures.sheets.points_at_faults import point_sides
from ..surfaces.sides import sides_of
from .layer_values import at_places


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


def heights_of_points(
    model: ModelData, number: int, at: int, rock: int, points: np.ndarray, are_bounds: bool = False
) -> np.ndarray:
    """(P,) the heights of a surface at points (P, 3); with faults those of its sheet in the compartment that
    each counts for, which is the one that it lies in where they are bounds. Those of a level set, which may
    have several over a place, are as far beneath each point as this is from it, about. number: of the surface
    in the model, at: in its rock mass, rock: of that."""
    entry = model.rock_inputs[rock]
    own_field = entry.field_of(at)
    if not model.structures.is_divided and own_field is None:
        return at_places(*model.surface(number), points[:, :2], model.threads)
    structure = entry.divided()

    def task(work: Work) -> np.ndarray:
        if own_field is None and not are_bounds:
            sides = point_sides(work, points, entry, at).sides
        else:
            sides = sides_of(work, points, structure.faults)
        active = structure.faults.active(at)
        heights = np.full(len(points), np.nan)
        for compartment, row in enumerate(structure.compartments):
            inside = ((sides == row) | ~active).all(axis=1)
            if inside.any() and own_field is not None:
                where = np.full(int(inside.sum()), compartment)
                heights[inside] = points[inside, 2] - own_field.distances(at, points[inside], where)
            elif inside.any():
                vertices, triangles = structure.sheet(compartment, at)
                heights[inside] = at_places(vertices, triangles, points[inside, :2], model.threads)
        return heights

    return run(task, threads=model.threads)


def residuals(model: ModelData) -> list[Residuals]:
    """The residuals of each surface of a model that was interpolated from points, in the model's order."""
    model.require_project("a residual")
    rows, number = [], 0
    for r, entry in enumerate(model.rock_inputs):
        rock = entry.rock
        for at, surface in enumerate(rock.surfaces):
            points = entry.data[at].points
            if len(points) and number < len(model.surface_names):
                heights = heights_of_points(model, number, at, r, points)
                finite = np.isfinite(heights)
                values = points[finite, 2] - heights[finite]
                rows.append(Residuals(rock.name, surface.name, points[finite], values, int((~finite).sum())))
            number += 1
    return rows
