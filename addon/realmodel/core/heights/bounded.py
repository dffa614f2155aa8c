# SPDX-License-Identifier: GPL-3.0-or-later
"""Inequalities of heights: where the surface would lie beyond a bound, the bound counts as a point.

The bounds that count are those whose dual weights in kriging have the sign of a support (Dubrule and Kostov
1986, "An interpolation method taking into account inequality constraints", Mathematical Geology 18). The dual
weight of a datum is the error of its estimate from the others over the variance of that error (Dubrule 1983):
so a bound supports the surface where the others alone would leave it beyond the bound. That holds for other
methods and for neighborhoods, too.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from ..base.algebra import begins_run
from ..base.errors import InputRefused, place_text
from ..base.work import Work, native_module
from ..readers.tables.observations import Bounds
from ..settings.methods import METHODS
from . import from_neighbors
from .interpolation import Result, Task
from .methods import run_method

TOLERANCE = 1e-9  # of the height range of points and bounds
_MOST_DROPS = 2  # of one bound: so the rounds end
_REACH = 3.0  # cells: so far what a bound changes is looked for first
_MOST_ALONE = 64  # bounds are left out one by one where the method cannot do it; more in so many parts


@dataclass(frozen=True)
class Consistent:
    """Bounds that contradict nothing. positions: (N, 2), no two equal and none of a point; lower, upper:
    (N,), -inf and inf where there is none. left_out: numbers of the bounds that contradict. tolerance: of
    heights."""

    positions: np.ndarray
    lower: np.ndarray
    upper: np.ndarray
    left_out: np.ndarray
    tolerance: float

    def missing(self, numbers: np.ndarray, z: np.ndarray) -> np.ndarray:
        """By how much heights z of some of them lie below the lower bound; above the upper one negative."""
        below, above = self.lower[numbers] - z, z - self.upper[numbers]
        beyond = np.where(below > self.tolerance, below, 0.0)
        return np.where(above > self.tolerance, -above, beyond)


def interpolated(method: str, task: Task) -> Result:
    """run_method, within the bounds of the task."""
    bounds = task.bounds
    free = replace(task, bounds=None)
    if bounds is None or not len(bounds) or not METHODS[method].is_constrained:
        return run_method(method, free)
    limits = consistent(task.points, bounds)
    if METHODS[method].on_mesh:
        mask = np.ones(len(bounds), bool)
        mask[limits.left_out] = False
        result = run_method(method, replace(task, bounds=bounds.some(mask)))
        return replace(result, warnings=[*result.warnings, *contradiction_warnings(bounds, limits.left_out)])
    run = runner(method, task)
    give = MethodHeights(replace(free, left_out=False), run, METHODS[method].leaves_one_out)
    active = active_bounds(task.work, task.points, limits, give)
    result = run(replace(free, points=np.vstack([task.points, active])))
    if task.left_out:  # bounds are not left out
        count = len(task.points)
        variance = None if result.variance is None else result.variance[:count]
        result = replace(result, z=result.z[:count], variance=variance)
    return replace(result, warnings=[*result.warnings, *contradiction_warnings(bounds, limits.left_out)])


@dataclass(frozen=True)
class MethodHeights:
    """Heights of a method from any points. run: the method; leaves_one_out: it estimates each point from the
    others in one run."""

    task: Task
    run: Callable[[Task], Result]
    leaves_one_out: bool

    def at(self, points: np.ndarray, nodes: np.ndarray) -> np.ndarray:
        """(N,) at nodes (N, 2), from points (P, 3)."""
        return self.run(replace(self.task, points=points, nodes=nodes)).z

    def without_each(self, points: np.ndarray, first: int) -> np.ndarray:
        """(P - first,) at each of the points from `first` on, from the others."""
        if len(points) == first:
            return np.zeros(0)
        if self.leaves_one_out:
            task = replace(self.task, points=points, nodes=np.empty((0, 2)), left_out=True)
            return self.run(task).z[first:]
        z, parts = np.empty(len(points) - first), min(_MOST_ALONE, len(points) - first)
        for part in range(parts):
            out = np.zeros(len(points), bool)
            out[first + part :: parts] = True
            z[part::parts] = self.at(points[~out], np.ascontiguousarray(points[out, :2]))
        return z


def holds_bounds(method: str) -> bool:
    """Whether bounds count as points in a method."""
    return METHODS[method].is_constrained and not METHODS[method].on_mesh


def runner(method: str, task: Task) -> Callable[[Task], Result]:
    """The method with what it finds from the points alone, and from whether there are bounds."""
    if "variogram" in task.settings:
        structure = from_neighbors.structure(task)
        return lambda other_task: from_neighbors.krige(other_task, structure)
    if method == "spline":
        spacing = native_module().mean_spacing(task.points)
        return lambda other_task: from_neighbors.thin_plate(other_task, spacing)
    return lambda other_task: run_method(method, other_task)


def consistent(points: np.ndarray, bounds: Bounds) -> Consistent:
    """The bounds at each position together, without those that contradict the point there, or one another: of
    these as few as possible are left out. points: (P, 3), no two at one position."""
    height, is_lower = bounds.places[:, 2], bounds.is_lower
    bad = np.flatnonzero(~np.isfinite(bounds.places).all(axis=1))
    if len(bad):
        raise InputRefused(f"bound {bad[0]} is not finite", item="bounds")
    tolerance = TOLERANCE * float(np.ptp(np.concatenate([points[:, 2], height])))
    every = np.vstack([bounds.places[:, :2], points[:, :2]]) + 0.0
    _, place = np.unique(every, axis=0, return_inverse=True)
    of_bounds, of_points = np.split(place.reshape(-1), [len(bounds)])
    chosen = np.full(len(every), np.nan)  # of the point at each place, or one for bounds that contradict
    chosen[of_points] = points[:, 2]
    has_point = np.isfinite(chosen)
    lower, upper = _extremes(height, is_lower, of_bounds, np.ones(len(bounds), bool), len(every))
    for at in np.flatnonzero(~has_point & (lower > upper + tolerance)):
        chosen[at] = _least_contradicted(height[of_bounds == at], is_lower[of_bounds == at])
    with np.errstate(invalid="ignore"):
        away = np.where(is_lower, height - chosen[of_bounds], chosen[of_bounds] - height)
        wrong = away > tolerance  # not where nothing is chosen, NaN
    lower, upper = _extremes(height, is_lower, of_bounds, ~wrong, len(every))
    usable = np.flatnonzero(~wrong & ~has_point[of_bounds])
    _, first = np.unique(of_bounds[usable], return_index=True)
    numbers = usable[np.sort(first)]
    low, high = lower[of_bounds[numbers]], upper[of_bounds[numbers]]
    crossed = low > high  # by less than the tolerance
    low, high = np.where(crossed, high, low), np.where(crossed, high, high)
    positions = np.ascontiguousarray(bounds.places[numbers, :2])
    return Consistent(positions, low, high, np.flatnonzero(wrong), tolerance)


def _extremes(
    height: np.ndarray, is_lower: np.ndarray, of_bounds: np.ndarray, usable: np.ndarray, count: int
) -> tuple[np.ndarray, np.ndarray]:
    """The highest lower and the lowest upper bound at each of so many places."""
    lower, upper = np.full(count, -np.inf), np.full(count, np.inf)
    np.maximum.at(lower, of_bounds[usable & is_lower], height[usable & is_lower])
    np.minimum.at(upper, of_bounds[usable & ~is_lower], height[usable & ~is_lower])
    return lower, upper


def _least_contradicted(height: np.ndarray, is_lower: np.ndarray) -> float:
    """The height that contradicts the fewest of some bounds at one position; of several the lowest."""
    heights = np.unique(height)
    lower, upper = np.sort(height[is_lower]), np.sort(height[~is_lower])
    held = np.searchsorted(lower, heights, "right") + len(upper) - np.searchsorted(upper, heights, "left")
    return float(heights[np.argmax(held)])


def contradiction_warnings(bounds: Bounds, left_out: np.ndarray) -> list[str]:
    """The warning about bounds that are left out."""
    if not len(left_out):
        return []
    first = int(left_out[0])
    side = "above" if bounds.is_lower[first] else "below"
    place = place_text(bounds.places[first].tolist())
    return [
        f"{len(left_out)} of {len(bounds)} bounds contradict a point or others at the same position and are "
        f"left out: one requires that the surface lies at or {side} {place}"
    ]


def active_bounds(work: Work, points: np.ndarray, bounds: Consistent, give: MethodHeights) -> np.ndarray:
    """(A, 3) the bounds that support the surface, as points.

    In rounds: bounds beyond which the surface lies become points, the worst of each cell of a grid twice as
    wide as the data are apart. Once there are none, those points are dropped that the others keep within
    their bounds, and it begins again. A round adds at least one or drops at least one, and each bound is
    dropped a few times at most: the rounds end, with no bound missed. After each round only bounds near its
    changes are tested, until these hold; then all.
    """
    count = len(bounds.positions)
    active, drops, value = np.zeros(count, bool), np.zeros(count, np.int64), np.zeros(count)
    near = ~active  # that what changed last may concern; the others are examined when these hold
    while True:
        work.check()
        data = np.vstack([points, np.column_stack([bounds.positions[active], value[active]])])
        cell = _cell(data[:, :2])
        asked = np.flatnonzero(near & ~active)
        past = np.zeros(0)
        if len(asked):
            z = give.at(data, np.ascontiguousarray(bounds.positions[asked]))
            past = bounds.missing(asked, z)
            asked, past = asked[past != 0], past[past != 0]
        if len(asked):
            worst = _worst_of_cells(bounds.positions[asked], past, cell)
            changed, past = asked[worst], past[worst]
            value[changed] = np.where(past > 0, bounds.lower[changed], bounds.upper[changed])
            active[changed] = True
        elif not near.all():
            near[:] = True
            continue
        else:
            alone = np.flatnonzero(active)
            past = bounds.missing(alone, give.without_each(data, len(points)))
            supports = (value == bounds.lower)[alone] & (past > 0) | (value == bounds.upper)[alone] & (
                past < 0
            )
            changed = alone[~supports & (drops[alone] < _MOST_DROPS)]
            if not len(changed):
                return data[len(points) :]
            active[changed] = False
            drops[changed] += 1
        at = np.column_stack([bounds.positions[changed], np.zeros(len(changed))])
        near = native_module().nearest_distance(at, bounds.positions) < _REACH * cell


def _cell(plan: np.ndarray) -> float:
    """Twice as far as positions are apart."""
    width, height = np.ptp(plan, axis=0).tolist()
    return 2 * max((width * height / len(plan)) ** 0.5, max(width, height) / len(plan))


def _worst_of_cells(positions: np.ndarray, missing: np.ndarray, cell: float) -> np.ndarray:
    """The number of the one in each cell of a grid that misses its bound most; of equals the first."""
    if not cell > 0:
        return np.array([int(np.abs(missing).argmax())])
    place = np.floor((positions - positions.min(axis=0)) / cell)
    order = np.lexsort([-np.abs(missing), place[:, 1], place[:, 0]])
    return np.sort(order[begins_run(place[order])])
