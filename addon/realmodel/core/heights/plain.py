# SPDX-License-Identifier: GPL-3.0-or-later
"""Methods for few points and on the triangulation of the points: a constant, a plane, a parallel surface,
linear, natural neighbors."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from itertools import chain

import numpy as np

from ..base.algebra import atan2, cos, sin
from ..base.errors import InputRefused
from ..base.mapped_arrays import in_pieces
from ..base.work import native_module
from ..settings.methods import checked_options
from .from_neighbors import nearest_heights
from .interpolation import Result, Task, heights_of
from .true_thickness import lifted, measured, stretched

# Of the greatest spread of the points: below this they lie in one line, and show no slope across it.
_IN_LINE = 1e-6
# Points within so little lie in one place, and show no slope at all: far from them it would overflow.
_IN_ONE_PLACE = 1e-60


def _total(pieces: Iterable[np.ndarray]) -> float:
    """The sum of numbers that come piece by piece, rounded once: their order does not matter."""
    return math.fsum(chain.from_iterable(piece.tolist() for piece in pieces))


def constant(task: Task) -> Result:
    """`value`, or the mean height of the points."""
    value = task.settings["value"]
    if value is None:
        value = mean_height(np.unique(task.points, axis=0))
    return Result(np.full(len(task.nodes), value))


def mean_height(points: np.ndarray) -> float:
    """The mean height of points (P, 3), no two equal, which may be in a file."""
    base = float(points[:, 2].min())
    return base + _total(piece[:, 2] - base for piece in in_pieces(points)) / len(points)


def plane(task: Task) -> Result:
    """The plane that fits the points best (least squares); its slope given where `dip` is.

    The variance is that of regression, s^2 (1 + f^T (F^T F)^-1 f), where points are more than it takes.
    """
    return fitted_plane(np.unique(task.points, axis=0), task.settings).at(task.nodes)


@dataclass(frozen=True)
class Plane:
    """steepest: a slope that is given, toward the azimuth `dipping`. azimuths: in which others were fitted,
    to distances in `unit`. steps: of each term how much of each one before it is taken out, and its size then
    (modified Gram-Schmidt); coefficients: of them. square: of a residual, where it is known."""

    center: np.ndarray
    base: float
    dipping: float
    steepest: float
    azimuths: tuple[float, ...] = ()
    unit: float = 1.0
    steps: tuple[tuple[tuple[float, ...], float], ...] = ()
    coefficients: tuple[float, ...] = ()
    square: float | None = None

    def at(self, nodes: np.ndarray) -> Result:
        plan = nodes - self.center
        heights, leverage = self.given(plan) + self.base, np.zeros(len(nodes))
        for coefficient, term in zip(self.coefficients, self.terms(plan), strict=True):
            heights = heights + coefficient * term
            leverage += np.square(term)
        return Result(heights, None if self.square is None else self.square * (1 + leverage))

    def given(self, plan: np.ndarray) -> np.ndarray:
        return self.steepest * _along(plan, self.dipping)

    def plain_term(self, plan: np.ndarray, number: int) -> np.ndarray:
        return np.ones(len(plan)) if number == 0 else _along(plan, self.azimuths[number - 1]) / self.unit

    def terms(self, plan: np.ndarray) -> list[np.ndarray]:
        """The terms with known steps, orthonormal over all points."""
        done: list[np.ndarray] = []
        for number, (shares, size) in enumerate(self.steps):
            done.append(_without(self.plain_term(plan, number), shares, done) / size)
        return done

    def residuals(self, plan: np.ndarray, z: np.ndarray) -> np.ndarray:
        z = z - self.given(plan)
        for coefficient, term in zip(self.coefficients, self.terms(plan), strict=False):
            z = z - coefficient * term
        return z


def _without(term: np.ndarray, shares: Iterable[float], others: list[np.ndarray]) -> np.ndarray:
    for share, other in zip(shares, others, strict=False):
        term = term - share * other
    return term


def _along(plan: np.ndarray, azimuth: float) -> np.ndarray:
    """(N,) how far places lie in a direction."""
    return sin(azimuth) * plan[:, 0] + cos(azimuth) * plan[:, 1]


def fitted_plane(points: np.ndarray, settings: dict) -> Plane:
    """To points (P, 3), no two equal, which may be in a file: by sums over pieces."""
    low, base = points[:, :2].min(axis=0), float(points[:, 2].min())
    mean = [_total(piece[:, k] - low[k] for piece in in_pieces(points)) / len(points) for k in (0, 1)]
    center = low + np.array(mean)

    def pieces() -> Iterator[tuple[np.ndarray, np.ndarray]]:
        for piece in in_pieces(points):
            yield piece[:, :2] - center, piece[:, 2] - base

    fit = _directed(center, base, settings, lambda: (plan for plan, _ in pieces()))

    def left(number: int, shares: list[float]) -> Iterator[tuple[np.ndarray, list[np.ndarray]]]:
        """The remainder of a term, piece by piece, and the terms before it."""
        for plan, _ in pieces():
            done = fit.terms(plan)
            yield _without(fit.plain_term(plan, number), shares, done), done

    for number in range(1 + len(fit.azimuths)):
        shares: list[float] = []
        for before in range(number):
            shares.append(_total(done[before] * term for term, done in left(number, shares)))
        size = math.sqrt(_total(np.square(term) for term, _ in left(number, shares)))
        longer = replace(fit, steps=(*fit.steps, (tuple(shares), size)))
        coefficient = _total(longer.terms(plan)[number] * fit.residuals(plan, z) for plan, z in pieces())
        fit = replace(longer, coefficients=(*fit.coefficients, coefficient))
    free = len(points) - len(fit.steps)
    if free <= 0:
        return fit
    squares = (np.square(fit.residuals(plan, z)) for plan, z in pieces())
    return replace(fit, square=_total(squares) / free)


def _directed(center: np.ndarray, base: float, settings: dict, plans: Callable) -> Plane:
    """A plane with the directions in which its slope is given, or to be fitted. plans: gives the pieces."""
    dip = settings["dip"]
    if dip is not None:
        down = math.radians(dip)
        return Plane(center, base, math.radians(settings["dip_direction"] % 360.0), -sin(down) / cos(down))
    xx, xy, yy = (_total(plan[:, a] * plan[:, b] for plan in plans()) for a, b in ((0, 0), (0, 1), (1, 1)))
    azimuth = 0.5 * atan2(2 * xy, yy - xx)  # in which they spread most
    azimuths = azimuth, azimuth + math.pi / 2
    spread = [math.sqrt(_total(np.square(_along(plan, angle)) for plan in plans())) for angle in azimuths]
    shown = (
        angle
        for angle, size in zip(azimuths, spread, strict=True)
        if size > max(_IN_LINE * spread[0], _IN_ONE_PLACE)
    )
    return Plane(center, base, 0.0, 0.0, tuple(shown), spread[0])


def parallel(task: Task, run_method: Callable[[str, Task], Result]) -> Result:
    """The surface `to` and a thickness above it: `thickness`, or where it is not given what the points show,
    spread by `thickness_method`, which run_method runs; upward, or perpendicular to that surface, by the
    task."""
    below = heights_of(task, task.settings["to"], task.nodes, "to")
    thickness = task.settings["thickness"]
    if thickness is not None:
        return Result(lifted(task, below, thickness))
    under = heights_of(task, task.settings["to"], np.ascontiguousarray(task.points[:, :2]), "to")
    finite = np.isfinite(under)
    if not finite.any():
        raise InputRefused(
            "none of its points lies where the surface that it is parallel to has an elevation", item="points"
        )
    points = measured(task, task.points[finite], under[finite])
    method = task.settings["thickness_method"]
    shown = run_method(method, replace(task, points=points, settings=checked_options(method, {})))
    warnings = list(shown.warnings)
    if not finite.all():
        left_out = int((~finite).sum())
        warnings.append(
            f"{left_out} of {len(finite)} points lie where the surface that it is parallel to has no "
            "elevation: they are left out"
        )
    z, variance = lifted(task, below, shown.z), shown.variance
    if task.true_thickness and variance is not None:
        variance = variance * np.square(stretched(below, z, shown.z))
    return Result(z, variance, shown.variogram, warnings)


def outside_hull(task: Task) -> np.ndarray:
    """(N,) bool: the nodes outside the convex hull of the points; its border is inside. Exact."""
    if not len(task.points):
        return np.zeros(len(task.nodes), bool)
    return task.run(native_module().outside_hull, task.points, task.nodes)


def replace_extrapolated(task: Task, result: Result, outside: np.ndarray) -> Result:
    """Replaces the heights of nodes outside the hull by the option `extrapolate`: those of the method, of the
    nearest point, or none (NaN)."""
    wanted = task.settings.get("extrapolate", "method")
    if wanted == "method" or not outside.any():
        return result
    z = result.z.copy()
    variance = None if result.variance is None else result.variance.copy()
    if wanted == "none":
        z[outside] = np.nan
        if variance is not None:
            variance[outside] = np.nan
        return replace(result, z=z, variance=variance)
    nodes = np.ascontiguousarray(task.nodes[outside])
    if result.variogram is not None:
        # Kriging from one point gives its height, with twice the semivariance as variance of the error.
        variogram = result.variogram.native(task.settings["anisotropy"])
        krige = native_module().krige
        z[outside], deviation, _ = task.run(krige, task.points, nodes, variogram, (1, 0, 0.0))
        if variance is not None:
            variance[outside] = deviation
    else:
        z[outside] = nearest_heights(task, nodes)
        if variance is not None:
            variance[outside] = np.nan
    return replace(result, z=z, variance=variance)


def linear(task: Task) -> Result:
    return _inside_hull(task, native_module().tin)


def natural_neighbour(task: Task) -> Result:
    return _inside_hull(task, native_module().natural_neighbour)


def _inside_hull(task: Task, function: Callable) -> Result:
    """Heights of all nodes; only if the method is to extrapolate also outside the hull of the points."""
    if task.settings.get("extrapolate", "method") == "method":
        return Result(task.run(function, task.points, task.nodes))
    outside = outside_hull(task)
    z = np.full(len(task.nodes), np.nan)
    if not outside.all():
        z[~outside] = task.run(function, task.points, np.ascontiguousarray(task.nodes[~outside]))
    return Result(z, outside=outside)
