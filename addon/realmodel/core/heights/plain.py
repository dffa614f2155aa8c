# SPDX-License-Identifier: GPL-3.0-or-later
"""What geologists do with few points: a constant, a plane, a surface parallel to another."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

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
        slope = -math.tan(math.radians(dip)) * np.array([math.sin(azimuth), math.cos(azimuth)])
        return _with_variance(z - plan @ slope, np.ones((len(plan), 1)), base + nodes @ slope, _ones(nodes))
    _, spread, axes = np.linalg.svd(plan, full_matrices=False)
    shown = spread > max(_IN_LINE * spread[0], _IN_ONE_PLACE)
    scale = spread[0] if shown.any() else 1.0
    axes = axes[shown]
    return _with_variance(
        z,
        np.column_stack([_ones(plan), plan @ axes.T / scale]),
        np.full(len(nodes), base),
        np.column_stack([_ones(nodes), nodes @ axes.T / scale]),
    )


def _ones(places: np.ndarray) -> np.ndarray:
    return np.ones((len(places), 1))


def _with_variance(z, terms, start, terms_at_nodes) -> Result:
    """start + the terms that fit z best, with the variance of regression."""
    q, r = np.linalg.qr(terms)
    coefficients = np.linalg.solve(r, q.T @ z)
    heights = start + terms_at_nodes @ coefficients
    free = len(z) - terms.shape[1]
    if free <= 0:
        return Result(heights)
    residual = z - terms @ coefficients
    leverage = np.square(np.linalg.solve(r.T, terms_at_nodes.T)).sum(axis=0)
    return Result(heights, residual @ residual / free * (1 + leverage))


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
