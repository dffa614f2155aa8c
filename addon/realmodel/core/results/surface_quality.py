# SPDX-License-Identifier: GPL-3.0-or-later
"""The data by which a surface of a built model is judged."""

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
from ..surfaces.observed.conformable import alike_of
from ..surfaces.observed.sheet_series import companions_of
from ..surfaces.surface_arrays import by_rock

DEFAULT_FOLDS = 10
_OF_VARIANCES = RANGE_BEYOND, NO_DEVIATION


@dataclass(frozen=True, eq=False)
class SurfaceQuality:
    """variogram: that its heights were estimated with, or None. cross_validation: None where there is none,
    then `missing` says why. angles: (T,) the smallest angles of its triangles in plan, degrees.
    mean_deviation, most_deviation: of the standard deviation of its heights over its area, model units; None
    where the method gives none. remarks: warnings about the fit that concern its variances alone."""

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
        return None, f"its heights follow another surface ({others[0]})"
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
    mean = (
        float(np.average(corners[finite].mean(axis=1), weights=area)) if area.any() else float(corners.mean())
    )
    return mean, float(np.nanmax(deviation))
