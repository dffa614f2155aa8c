# SPDX-License-Identifier: GPL-3.0-or-later
"""A method on one set of points, and what all methods have in common: mis-ties, extrapolation, warnings."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..base.algebra import norm, principal_axes
from ..base.errors import InputRefused
from ..base.mapped_arrays import in_pieces
from ..base.work import NativeError, refused_as
from ..settings.methods import METHODS, SURFACE_OPTIONS, check_uses_dips, checked_options
from . import automatic, bounded, from_neighbors
from .interpolation import Interpolation, Result, Task
from .mis_ties import without_mis_ties
from .plain import outside_hull, replace_extrapolated

_SAME_HEIGHT = 1e-9  # of a height
_FAR, _FAR_OF_LINE = 2.0, 0.5  # of the range of heights of points, of points on a line
_LINE = 0.01  # of their spread: that across a line


def heights(method: str, task: Task) -> Interpolation:
    """interpolate within a work that is already running. Points may contradict one another."""
    settings, nodes = task.settings, task.nodes
    if not len(task.points) and METHODS[method].needs_points(settings):
        raise InputRefused("there are no points", item="points")
    points, mis_ties = without_mis_ties(task.points)
    task, of_dips = with_dips(method, replace(task, points=points))
    reason = ""
    with refused_as(refused_points):
        few = replace(task, points=from_neighbors.thinned(method, task, points))
        if method == "auto":
            method, reason, result = automatic.automatic(few)
            settings = {**checked_options(method, {}), "extrapolate": settings["extrapolate"]}
            task = replace(task, settings=settings)
        else:
            result = bounded.interpolated(method, few)
        outside = result.outside if result.outside is not None else outside_hull(task)
        result = replace_extrapolated(task, result, outside)
    warnings = [*([mis_ties] if mis_ties else []), *of_dips]
    if task.dips is None and task.companions is None:
        warnings += few_points(points, method, result.z)
    warnings += elsewhere(points, nodes)
    warnings += result.warnings
    if not any(settings.get(option) is not None for option in SURFACE_OPTIONS):
        warnings += runs_away(points, result.z, method, _rise(task))
    share = float(outside.mean()) if len(outside) else 0.0
    return Interpolation(
        result.z,
        result.variance,
        method,
        result.variogram,
        tuple(warnings),
        share,
        reason,
        result.neighbours,
    )


def with_dips(method: str, task: Task) -> tuple[Task, list[str]]:
    """The task with one dip at each position, or None where there are none, and a warning. Raises
    OptionRefused where the method does not use dips."""
    if task.dips is None or not len(task.dips):
        return replace(task, dips=None), []
    check_uses_dips(method)
    dips, warning = task.dips.merged()
    return replace(task, dips=dips), [warning] if warning else []


def refused_points(error: NativeError) -> InputRefused:
    """The refusal of points that the native part found fault with."""
    return InputRefused(str(error), item="points", place=error.place)


def few_points(points: np.ndarray, method: str, z: np.ndarray) -> list[str]:
    """A warning if the points are too few for the method (Method.has_shape). z: the heights that it gave,
    which may follow other data, too."""
    if not METHODS[method].has_shape:
        return []
    if not len(points):
        return []
    other = None
    for piece in in_pieces(points):
        plan = piece[(piece[:, :2] != points[0, :2]).any(axis=1), :2]
        if len(plan) and other is None:
            other = plan[0]
        if len(plan) and (plan != other).any():
            return []
    if other is None:
        off = np.abs(z[np.isfinite(z)] - points[0, 2])
        if off.max(initial=0.0) > _SAME_HEIGHT * max(1.0, abs(points[0, 2])):
            return []
        return ["only one point: the surface is horizontal"]
    return ["there are two points only: they do not show the slope across their line"]


def elsewhere(points: np.ndarray, nodes: np.ndarray) -> list[str]:
    """A warning if the points lie elsewhere than the nodes: mostly wrong coordinates or units."""
    if not len(points) or not len(nodes):
        return []
    for axis, name in enumerate("xy"):
        low, high = points[:, axis].min(), points[:, axis].max()
        lowest, highest = nodes[:, axis].min(), nodes[:, axis].max()
        if high < lowest or highest < low:
            return [
                f"no point lies in the area of the mesh: {name} of the points is {low:.9g} to {high:.9g}, "
                f"of the mesh {lowest:.9g} to {highest:.9g}; check their coordinates and units"
            ]
    return []


def _rise(task: Task) -> float:
    """How far a surface rises over points and nodes that has the steepest dip of a task everywhere; 0 without
    dips."""
    if task.dips is None:
        return 0.0
    plan = np.concatenate([task.points[:, :2], task.nodes])
    return float(norm(task.dips.gradients).max() * norm(np.ptp(plan, axis=0)))


def runs_away(points: np.ndarray, z: np.ndarray, method: str, rise: float = 0.0) -> list[str]:
    """A warning if heights go far beyond those of the points, by more than twice their range and the rise
    that dips predict; by half of it where points lie on a line, which say nothing of what is beside it.
    Points that differ by rounding alone are level, and have none."""
    tamed_by = METHODS[method].tamed_by
    if tamed_by is None or not len(points) or not np.isfinite(z).any():
        return []
    low, high = points[:, 2].min(), points[:, 2].max()
    lowest, highest = np.nanmin(z), np.nanmax(z)
    beyond, rounding = max(low - lowest, highest - high) - rise, 1e-12 * max(abs(low), abs(high))
    if not beyond > _FAR_OF_LINE * (high - low) or not 2 * (high - low) > rounding:
        return []
    along, across = principal_axes(points[:, :2])[0]
    if across > _LINE * along:
        if not beyond > _FAR * (high - low):
            return []
        where = ""
    else:
        where = "its points lie on a line; "
    theirs = f"those of its points, {low:.6g} to {high:.6g}"
    return [f"{where}its elevations, {lowest:.6g} to {highest:.6g}, go far beyond {theirs}; {tamed_by}"]


def left_out_heights(method: str, task: Task) -> Result:
    """The height of each point, estimated from the others by a method that leaves one out."""
    with refused_as(refused_points):
        return bounded.interpolated(method, replace(task, nodes=np.empty((0, 2)), left_out=True))
