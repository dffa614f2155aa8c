# SPDX-License-Identifier: GPL-3.0-or-later
"""Methods whose height at a node comes from the points near it: kriging, inverse distance, splines."""

from __future__ import annotations

import numpy as np

from ..variogram import Variogram, fit_warnings
from ..work import native_module
from .interpolation import Result, Task


def _neighbourhood(settings: dict) -> dict:
    return {
        "neighbours": settings["neighbours"],
        "octants": settings["octants"],
        "radius": settings["radius"] or 0.0,
    }


def krige(task: Task) -> Result:
    """Ordinary kriging; universal kriging where the settings have a drift."""
    native = native_module()
    settings = task.settings
    anisotropy, drift = settings["anisotropy"], settings.get("drift", "constant")
    given = settings["variogram"]
    warnings = []
    if given is None:
        fitted = task.work.native(
            native.fit_variogram,
            task.points,
            drift=drift,
            anisotropy_ratio=anisotropy["ratio"],
            anisotropy_azimuth=anisotropy["azimuth"],
        )
        variogram = Variogram(**fitted)
        warnings = fit_warnings(variogram, task.points)
    else:
        variogram = Variogram.from_settings(given)
    arguments = {**variogram.native(anisotropy), **_neighbourhood(settings), "drift": drift}
    if task.left_out:
        z, variance, alone = task.run(native.krige_left_out, task.points, **arguments)
    else:
        z, variance, alone = task.run(native.krige, task.points, task.nodes, **arguments)
    if alone and len(z):
        warnings.append(
            f"{100 * alone / len(z):.3g} % of the nodes have no point within the radius: there the nearest "
            "point alone counts"
        )
    return Result(z, variance, variogram, warnings)


def nearest_heights(task: Task, nodes: np.ndarray) -> np.ndarray:
    """(N,) heights of the points nearest to nodes."""
    return task.run(native_module().idw, task.points, nodes, neighbours=1)


def inverse_distance(task: Task) -> Result:
    native = native_module()
    arguments = {**_neighbourhood(task.settings), "power": task.settings["power"]}
    if task.left_out:
        return Result(task.run(native.idw_left_out, task.points, **arguments))
    return Result(task.run(native.idw, task.points, task.nodes, **arguments))


def thin_plate(task: Task) -> Result:
    arguments = {**_neighbourhood(task.settings), "smoothing": task.settings["smoothing"]}
    return Result(task.run(native_module().spline, task.points, task.nodes, **arguments))
