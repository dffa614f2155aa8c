# SPDX-License-Identifier: GPL-3.0-or-later
"""Cross-validation: the height of each point, estimated from the others."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..base.algebra import ascending
from ..base.errors import InputRefused, UsageError
from ..base.named import keyword_only
from ..base.work import Cancel, Progress, Work, native_module, run
from ..notebook import ShortRepr
from ..settings.dips import Dips
from ..settings.method_options import check_threads
from ..settings.methods import METHODS
from ..settings.variogram import Variogram
from . import Task, left_out_heights
from .from_neighbors import krige, structure
from .interpolate import checked_nodes, checked_points, checked_triangles, method_settings
from .interpolation import Result
from .left_out_places import in_turn, places_of
from .mis_ties import without_mis_ties
from .run import heights, with_dips

DEFAULT_FOLDS = 10
_MOST_PLACES = 60  # that are left out one by one


@dataclass(frozen=True, repr=False)
class CrossValidation(ShortRepr):
    """points (P, 3), no two at one position in plan; z (P,), estimated from the other points;
    errors (P,), z minus the points' heights; standardized (P,), errors divided by the kriging standard
    deviation, None where the method gives no variance; rmse, the root mean square error; the method, and the
    variogram used.

    Where a point cannot be estimated (a method that gives no height outside the hull of the other points),
    its z and error are NaN; rmse is of the others.
    """

    points: np.ndarray
    z: np.ndarray
    errors: np.ndarray
    standardized: np.ndarray | None
    rmse: float
    method: str
    variogram: Variogram | None = None

    @property
    def mean_error(self) -> float:
        """The mean error of the estimated points: above 0 where estimates are too high. NaN where there are
        none."""
        return float(self.errors[self.known].mean()) if self.known.any() else float("nan")

    @property
    def mean_absolute_error(self) -> float:
        """The mean of the absolute errors, model units."""
        return float(np.abs(self.errors[self.known]).mean()) if self.known.any() else float("nan")

    @property
    def correlation(self) -> float:
        """The correlation of measured and estimated heights (Pearson's); NaN where one of them is
        constant."""
        measured, estimated = self.points[self.known, 2], self.z[self.known]
        if len(measured) < 2 or not np.ptp(measured) or not np.ptp(estimated):
            return float("nan")
        return float(np.corrcoef(measured, estimated)[0, 1])

    @property
    def known(self) -> np.ndarray:
        """(P,) bool: the points that are estimated."""
        return np.isfinite(self.errors)

    def in_order_of(self, points: np.ndarray) -> CrossValidation:
        """The same in the order in which its places come first among points (P, 3)."""
        _, first = np.unique(points[:, :2] + 0.0, axis=0, return_index=True)
        order = np.argsort(first)
        standardized = None if self.standardized is None else self.standardized[order]
        of_points = self.points[order], self.z[order], self.errors[order], standardized
        return CrossValidation(*of_points, self.rmse, self.method, self.variogram)

    def worst(self, number: int) -> np.ndarray:
        """The indices of the points with the largest errors, the largest first; number: how many, at most."""
        order = np.argsort(-np.abs(self.errors), kind="stable")  # NaN last
        return order[: min(number, int(self.known.sum()))]

    @property
    def within_two_deviations(self) -> float | None:
        """The share of errors below twice their deviation: about 0.95 where variances are realistic."""
        if self.standardized is None:
            return None
        finite = np.isfinite(self.standardized)
        return float((np.abs(self.standardized[finite]) <= 2).mean()) if finite.any() else None


@keyword_only
def cross_validate(
    points: ArrayLike,
    method: str = "kriging",
    neighbours: int | None = None,
    *,
    threads: int = 0,
    folds: int = DEFAULT_FOLDS,
    mesh: Sequence[ArrayLike] | None = None,
    dips: Dips | None = None,
    progress: Progress | None = None,
    cancel: Cancel | None = None,
    **options: Any,
) -> CrossValidation:
    """Estimates the height of each point from the others by a method.

    points: (P, 3), at least 2 positions in plan; points at one position count once. Kriging and inverse
    distance leave the points out one by one, with the variogram fitted to all of them (where all points are
    neighbors, by the identities of Dubrule 1983, Mathematical Geology 15, from one factor). The other
    methods are run `folds` times, each time without every folds-th point. Where points are clustered, as in
    twin holes and along survey lines, all methods are run, for places and not for points (places_of): of
    kriging and inverse distance up to 60 times. mesh: (nodes (N, 2), triangles (T,
    3)), for a method that works on a mesh. dips, options: as for `interpolate`; dips are never left out.

    Raises InputRefused, UsageError, Cancelled.

    >>> x, y = np.mgrid[:5, :5].reshape(2, -1)
    >>> result = cross_validate(np.column_stack([x, y, 2 * x + y]), "universal_kriging")
    >>> result.rmse < 1e-6
    True
    """
    points = checked_points(points)
    settings = method_settings(method, neighbours, options)
    threads = check_threads(threads)
    slopes = None if dips is None else dips.checked()
    if isinstance(folds, bool) or not hasattr(folds, "__index__") or int(folds) < 2:
        raise UsageError(f"folds must be a whole number from 2, not {folds!r}")
    if (mesh is None) == METHODS[method].on_mesh:
        needs = "needs mesh = (nodes, triangles)" if mesh is None else "does not use a mesh"
        raise UsageError(f"method '{method}' {needs}")
    nodes, triangles = np.empty((0, 2)), None
    if mesh is not None:
        nodes = checked_nodes(mesh[0])
        triangles = checked_triangles(mesh[1], len(nodes))

    def task(work: Work) -> CrossValidation:
        with work.phase(0.0, 1.0, "cross-validating"):
            result = validate(method, Task(work, points, nodes, settings, triangles, dips=slopes), int(folds))
            return result.in_order_of(points)

    return run(task, progress, cancel, threads=threads)


def validate(method: str, task: Task, folds: int) -> CrossValidation:
    """cross_validate within a work that is already running. task: with the nodes and triangles of a mesh for
    a method that works on one."""
    points = distinct_points(task.points)
    task, _ = with_dips(method, replace(task, points=points))
    if len(points) < 2:
        raise InputRefused("cross-validation needs at least two points", item="points")
    places = places_of(task.work, points[:, :2])
    if METHODS[method].leaves_one_out and places is None:
        result = left_out_heights(method, task)
    else:
        most = max(folds, _MOST_PLACES) if METHODS[method].leaves_one_out else folds
        numbers = np.arange(len(points)) if places is None else places
        result = _in_folds(method, task, in_turn(numbers, most))
    z, variance, variogram = result.z, result.variance, result.variogram
    errors = z - points[:, 2]
    standardized = None
    if variance is not None:
        with np.errstate(divide="ignore", invalid="ignore"):
            standardized = np.where(errors == 0, 0.0, errors / np.sqrt(variance))
    finite = np.isfinite(errors)
    rmse = float(np.sqrt(np.mean(errors[finite] ** 2))) if finite.any() else float("nan")
    return CrossValidation(points, z, errors, standardized, rmse, method, variogram)


def distinct_points(points: np.ndarray) -> np.ndarray:
    """The points in ascending order, without those that repeat another; heights that differ a little are
    averaged."""
    points, _ = without_mis_ties(points[ascending(*points.T)])
    return np.unique(points, axis=0)


def _in_folds(method: str, task: Task, left_out: list[np.ndarray]) -> Result:
    """The heights of points that are left out together. left_out: (P,) bool, which at a time."""
    points, kriging, variogram = task.points, None, None
    z, variance = np.empty(len(points)), np.full(len(points), np.nan)
    if METHODS[method].leaves_one_out and METHODS[method].may_be_kriged:
        kriging = structure(task)
        variogram = kriging.variogram
    for fold, out in enumerate(left_out):
        task.work.step(fold / len(left_out))
        places, others = np.ascontiguousarray(points[out, :2]), np.ascontiguousarray(points[~out])
        if kriging is not None:
            result = krige(replace(task, points=others, nodes=places), kriging)
            z[out], variance[out] = result.z, result.variance
        elif task.triangles is None:
            z[out] = heights(method, replace(task, points=others, nodes=places)).z
        else:
            shape = np.column_stack([task.nodes, heights(method, replace(task, points=others)).z])
            z[out] = task.run(native_module().surface_heights, shape, task.triangles, places)
    return Result(z, variance if np.isfinite(variance).any() else None, variogram)
