# SPDX-License-Identifier: GPL-3.0-or-later
"""Methods on the Delaunay triangulation of the points (linear, natural neighbors), and extrapolation: nodes
outside the points' convex hull, and their heights."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ..base.work import native_module
from .from_neighbours import nearest_heights
from .interpolation import Result, Task


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
