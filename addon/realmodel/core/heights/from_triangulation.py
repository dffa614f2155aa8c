# SPDX-License-Identifier: GPL-3.0-or-later
"""Methods on the Delaunay triangulation of the points: linear, natural neighbours."""

from __future__ import annotations

from ..work import native_module
from .interpolation import Result, Task


def linear(task: Task) -> Result:
    return Result(task.run(native_module().tin, task.points, task.nodes))


def natural_neighbour(task: Task) -> Result:
    return Result(task.run(native_module().natural_neighbour, task.points, task.nodes))
