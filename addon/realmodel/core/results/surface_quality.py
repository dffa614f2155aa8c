# SPDX-License-Identifier: GPL-3.0-or-later
"""The data by which a surface of a built model is judged: its residuals and its quality."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..base.errors import InputRefused
from ..base.work import Cancel, Progress, Work, run
from ..cells.model_data import ModelData
from ..heights import Task
from ..heights.cross_validation import CrossValidation, distinct_points, validate
from ..plots import smallest_angles
from ..settings.methods import METHODS, checked_options
from ..settings.variogram import NO_DEVIATION, RANGE_BEYOND, Variogram
from ..structures.sheets.points_at_faults import point_sides
from ..surfaces.observed.conformable import alike_of, companions_of
from ..surfaces.rock_structure import sides_of
from ..surfaces.surface_input import by_rock
from .layer_values import at_places

DEFAULT_FOLDS = 10
_ROUNDING = 2.0**-48  # of the largest coordinate: residuals below it are rounding of heights
_OF_VARIANCES = RANGE_BEYOND, NO_DEVIATION


@dataclass(frozen=True, eq=False)
class SurfaceQuality:
    """variogram: that its heights were estimated with, or None. cross_validation: None if there is none, for
    the reason `missing`. angles: (T,) the smallest angles of its triangles in plan, degrees. mean_deviation,
    most_deviation: of the standard deviation of its heights over its area, model units; None where the method
    gives none. remarks: warnings about the fit that concern its variances alone."""

    variogram: Variogram | None
    cross_validation: CrossValidation | None
    missing: str
    angles: np.ndarray
    mean_deviation: float | None
    most_deviation: float | None
    remarks: tuple[str, ...] = ()


def surface_quality(
    model: ModelData,
    number: int,
    threads: int = 0,
    progress: Progress | None = None,
    cancel: Cancel | None = None,
) -> SurfaceQuality:
    """The quality of a surface of a model, by its global index. Raises InputRefused, Cancelled."""

    def task(work: Work) -> SurfaceQuality:
        vertices, triangles = model.surface(number)
        result = model.interpolations[number]
        with work.phase(0.0, 1.0, "cross-validating"):
            validated, missing = _cross_validation(work, model, number)
        mean, most = _deviation(vertices, triangles, model.surface_attributes(number)["variance"])
        return SurfaceQuality(
            result.variogram if result else None,
            validated,
            missing,
            smallest_angles(vertices, triangles),
            mean,
            most,
            tuple(text for text in (result.warnings if result else ()) if text.startswith(_OF_VARIANCES)),
        )

    return run(task, progress, cancel, threads=threads)


def _cross_validation(work: Work, model: ModelData, number: int) -> tuple[CrossValidation | None, str]:
    """Cross-validation by the method of the heights, or the reason why there is none."""
    result = model.interpolations[number]
    if result is None:
        return None, "its shape is a mesh: nothing was interpolated"
    entry, at = by_rock(model.rock_inputs)[number]
    surface, data = entry.rock.surfaces[at], entry.data[at]
    method, settings = surface.method_options()
    if method == "auto":
        method = result.method
        settings = {**checked_options(method, {}), "extrapolate": settings["extrapolate"]}
    others = [
        name
        for name, option in METHODS[method].options.items()
        if option.kind == "surface" and settings.get(name) is not None
    ]
    if others:
        return None, f"its elevations follow another surface ({others[0]})"
    points = data.points
    if len(points) < 2 or len(distinct_points(points)) < 2:
        return None, "it takes two points or more"
    vertices, triangles = model.surface(number)
    on_mesh = METHODS[method].on_mesh
    nodes = np.ascontiguousarray(vertices[:, :2]) if on_mesh else np.empty((0, 2))
    task = Task(
        work,
        points,
        nodes,
        settings,
        triangles if on_mesh else None,
        dips=data.dips,
        bounds=data.bounds,
        error=data.error,
        companions=companions_of(entry.rock, entry.data, at, {}),
        alike=alike_of(entry.rock, entry.data, at, {}),
    )
    try:
        return validate(method, task, DEFAULT_FOLDS), ""
    except InputRefused as error:
        return None, str(error)


def _deviation(
    vertices: np.ndarray, triangles: np.ndarray, variance: np.ndarray
) -> tuple[float | None, float | None]:
    """The mean over the area, and the maximum, of the square root of the variances (V,)."""
    deviation = np.sqrt(np.maximum(variance, 0.0))
    corners = deviation[triangles]
    finite = np.isfinite(corners).all(axis=1)
    if not finite.any():
        return None, None
    a, b, c = (vertices[triangles[finite, k], :2] for k in range(3))
    area = np.abs((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0])
    means = corners[finite].mean(axis=1)
    mean = float(np.average(means, weights=area)) if area.any() else float(means.mean())
    return mean, float(np.nanmax(deviation))


@dataclass(frozen=True, eq=False)
class Residuals:
    """Of one surface: its points (P, 3) float64 where it has an elevation, and point minus surface there,
    (P,), model units, 0 where it is below rounding. outside: how many points are beyond the surface."""

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
                values[np.abs(values) <= _ROUNDING * np.abs(points).max()] = 0.0
                rows.append(Residuals(rock.name, surface.name, points[finite], values, int((~finite).sum())))
            number += 1
    return rows
