# SPDX-License-Identifier: GPL-3.0-or-later
"""What runs each method of `settings.methods`."""

from __future__ import annotations

from collections.abc import Callable

from .from_neighbors import inverse_distance, krige, thin_plate
from .interpolation import Result, Task
from .on_mesh import dsi
from .plain import constant, linear, natural_neighbour, parallel, plane
from .regular_grid import bilinear


def run_method(method: str, task: Task) -> Result:
    """Runs a method that is not "auto", which chooses another one."""
    return FUNCTIONS[method](task)


FUNCTIONS: dict[str, Callable[[Task], Result]] = {
    "kriging": krige,
    "universal_kriging": krige,
    "idw": inverse_distance,
    "spline": thin_plate,
    "dsi": dsi,
    "natural_neighbour": natural_neighbour,
    "tin": linear,
    "grid": bilinear,
    "plane": plane,
    "constant": constant,
    "parallel": lambda task: parallel(task, run_method),
}
