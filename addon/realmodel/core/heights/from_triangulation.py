# SPDX-License-Identifier: GPL-3.0-or-later
"""Methods on the Delaunay triangulation of the points: linear, natural neighbours."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ..base.work import native_module
from .extrapolation import outside_hull
from .interpolation import Result, Task


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
