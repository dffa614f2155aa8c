# SPDX-License-Identifier: GPL-3.0-or-later
"""Nodes outside the convex hull of the points, and what they get."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..work import native_module
from .from_neighbours import nearest_heights
from .interpolation import Result, Task


def outside_hull(task: Task) -> np.ndarray:
    """(N,) bool: the nodes outside the convex hull of the points; its border is inside. Exact."""
    if not len(task.points):
        return np.zeros(len(task.nodes), bool)
    return task.run(native_module().outside_hull, task.points, task.nodes)


def replace_extrapolated(task: Task, result: Result, outside: np.ndarray) -> Result:
    """Heights of nodes outside the hull as the option `extrapolate` wants them: those of the method, of the
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
        arguments = result.variogram.native(task.settings["anisotropy"])
        krige = native_module().krige
        z[outside], variance[outside], _ = task.run(krige, task.points, nodes, **arguments, neighbours=1)
    else:
        z[outside] = nearest_heights(task, nodes)
        if variance is not None:
            variance[outside] = np.nan
    return replace(result, z=z, variance=variance)
