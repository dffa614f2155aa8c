# SPDX-License-Identifier: GPL-3.0-or-later
"""What geologists do with few points: a constant, a plane, a surface parallel to another.

Calculated without NumPy's linear algebra, which gives other last digits on other processors.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from ..elementary import atan2, cos, sin
from ..errors import InputRefused
from ..methods import checked_options
from .interpolation import Result, Task, run_method
from .surface_reference import heights_of

# Of the greatest spread of the points: below this they lie in one line, and show no slope across it.
_IN_LINE = 1e-6
# Points within so little lie in one place, and show no slope at all: far from them it would overflow.
_IN_ONE_PLACE = 1e-60


def constant(task: Task) -> Result:
    """`value`, or the mean height of the points."""
    value = task.settings["value"]
    if value is None:
        places = np.unique(task.points, axis=0)
        base = places[0, 2]
        value = base + float((places[:, 2] - base).mean())
    return Result(np.full(len(task.nodes), value))


def plane(task: Task) -> Result:
    """The plane that fits the points best (least squares); its slope given where `dip` is.

    The variance is that of regression, s^2 (1 + f^T (F^T F)^-1 f), where points are more than it takes.
    """
    points = np.unique(task.points, axis=0)
    base = points[0, 2]
    center = points[0, :2] + (points[:, :2] - points[0, :2]).mean(axis=0)
    plan, z = points[:, :2] - center, points[:, 2] - base
    nodes = task.nodes - center
    dip = task.settings["dip"]
    if dip is not None:
        azimuth = math.radians(task.settings["dip_direction"])
        down = math.radians(dip)
        steepest = -sin(down) / cos(down)
        dipping = _along(plan, azimuth), _along(nodes, azimuth)
        return _with_variance(
            z - steepest * dipping[0], [_ones(plan)], steepest * dipping[1] + base, [_ones(nodes)]
        )
    x, y = plan.T
    azimuth = 0.5 * atan2(2 * (x * y).sum(), (y * y).sum() - (x * x).sum())  # in which they spread most
    azimuths = azimuth, azimuth + math.pi / 2
    spread = [math.sqrt(np.square(_along(plan, each)).sum()) for each in azimuths]
    shown = [
        each
        for each, size in zip(azimuths, spread, strict=True)
        if size > max(_IN_LINE * spread[0], _IN_ONE_PLACE)
    ]
    return _with_variance(
        z,
        [_ones(plan), *(_along(plan, each) / spread[0] for each in shown)],
        np.full(len(nodes), base),
        [_ones(nodes), *(_along(nodes, each) / spread[0] for each in shown)],
    )


def _ones(places: np.ndarray) -> np.ndarray:
    return np.ones(len(places))


def _along(plan: np.ndarray, azimuth: float) -> np.ndarray:
    """(N,) how far places lie in a direction."""
    return sin(azimuth) * plan[:, 0] + cos(azimuth) * plan[:, 1]


def _with_variance(z, terms, start, terms_at_nodes) -> Result:
    """start + the terms that fit z best, with the variance of regression.

    The terms are made orthonormal one by one (modified Gram-Schmidt), those at nodes along with them.
    """
    heights, residual, leverage = start, z, np.zeros(len(start))
    done: list[tuple[np.ndarray, np.ndarray]] = []
    for term, at_nodes in zip(terms, terms_at_nodes, strict=True):
        for before, before_at_nodes in done:
            share = (before * term).sum()
            term, at_nodes = term - share * before, at_nodes - share * before_at_nodes
        size = math.sqrt(np.square(term).sum())
        term, at_nodes = term / size, at_nodes / size
        done.append((term, at_nodes))
        coefficient = (term * residual).sum()
        residual = residual - coefficient * term
        heights = heights + coefficient * at_nodes
        leverage += np.square(at_nodes)
    free = len(z) - len(terms)
    if free <= 0:
        return Result(heights)
    return Result(heights, np.square(residual).sum() / free * (1 + leverage))


def parallel(task: Task) -> Result:
    """The surface `to` and a thickness above it: `thickness`, or where it is not given what the points show,
    spread by `thickness_method`."""
    below = heights_of(task, task.settings["to"], task.nodes, "to")
    thickness = task.settings["thickness"]
    if thickness is not None:
        return Result(below + thickness)
    under = heights_of(task, task.settings["to"], np.ascontiguousarray(task.points[:, :2]), "to")
    known = np.isfinite(under)
    if not known.any():
        raise InputRefused(
            "none of its points lies where the surface that it is parallel to has a height", item="points"
        )
    points = task.points[known].copy()
    points[:, 2] -= under[known]
    method = task.settings["thickness_method"]
    shown = run_method(method, replace(task, points=points, settings=checked_options(method, {})))
    warnings = list(shown.warnings)
    if not known.all():
        left_out = int((~known).sum())
        warnings.append(
            f"{left_out} of {len(known)} points lie where the surface that it is parallel to has no height: "
            "they are left out"
        )
    return Result(below + shown.z, shown.variance, shown.variogram, warnings)
