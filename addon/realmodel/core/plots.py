# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of interpolation: variograms, cross-validation, maps, the quality of meshes. Needs matplotlib,
which RealModel does without: `pip install matplotlib`.

    from realmodel.core import interpolate, plots
    figure = plots.variogram(interpolate(points, nodes).variogram)
    figure.savefig("variogram.svg")

Where a program imports matplotlib itself, it does so after realmodel has done something: some systems say
"cannot allocate memory in static TLS block" otherwise.

Each function draws into `axes` where they are given, else into a figure of its own, and returns the
matplotlib Figure. Nothing is shown on a screen, and no state of pyplot is touched.
"""

from __future__ import annotations

import numpy as np

from .cross_validation import CrossValidation
from .errors import UsageError
from .variogram import Variogram
from .work import native_module

__all__ = ["cross_validation", "height_map", "mesh_quality", "triangle_quality", "variance_map", "variogram"]

_SIZE = (5.2, 3.9)  # inches
_MANY = 300  # points: of more than these the dots are smaller, so that they leave free what they lie on


def variogram(fitted: Variogram, axes=None):
    """The semivariance over distance: the curve, and where it was fitted to points the experimental values,
    their areas by the number of pairs."""
    figure, axes = _axes(axes)
    longest = 1.5 * fitted.range
    if fitted.lags is not None and len(fitted.lags):
        longest = float(fitted.lags[-1]) * 1.05
        areas = 8 + 60 * np.sqrt(fitted.pairs / fitted.pairs.max())
        axes.scatter(fitted.lags, fitted.gamma, areas, c="tab:blue", label="experimental", zorder=3)
    distance = np.linspace(longest / 2000, longest, 2000)  # not from 0: there a nugget leaps
    name = f"{fitted.model}, range {fitted.range:.4g},\nsill {fitted.sill:.4g}, nugget {fitted.nugget:.3g}"
    axes.plot(distance, fitted.semivariance(distance), c="tab:red", label=name)
    axes.set(xlabel="distance", ylabel="semivariance", xlim=(0, longest))
    axes.set_ylim(bottom=0)
    axes.legend(loc="lower right", fontsize="small")
    return figure


def cross_validation(told: CrossValidation, axes=None):
    """The heights of points as the others tell them over their own; where the method has a variance, in two
    colours, for errors within two deviations and beyond."""
    figure, axes = _axes(axes)
    known = np.isfinite(told.errors)
    given, found = told.points[known, 2], told.z[known]
    beyond = np.zeros(len(given), bool)
    size = 10 * _share_of_many(len(given)) ** 0.5
    if told.standardised is not None:
        beyond = np.abs(told.standardised[known]) > 2
        axes.scatter(given[beyond], found[beyond], size, c="tab:red", label="beyond two deviations", zorder=3)
    axes.scatter(given[~beyond], found[~beyond], size, c="tab:blue", label="points left out")
    low, high = (f(np.concatenate([given, found])) for f in (np.min, np.max)) if len(given) else (0, 1)
    axes.plot([low, high], [low, high], c="0.6", lw=1, zorder=0)
    share = told.within_two_deviations
    honest = "" if share is None else f"\n{100 * share:.1f} % within two deviations"
    axes.set_title(f"{told.method}: root mean square error {told.rmse:.4g}{honest}", fontsize="medium")
    axes.set(xlabel="height of the point", ylabel="as the others tell it")
    axes.locator_params(axis="x", nbins=6)
    axes.legend(loc="upper left", fontsize="small")
    return figure


def height_map(vertices, triangles, points=None, axes=None, limits=None):
    """Heights of a triangulated surface (vertices (V, 3), triangles (T, 3)) as colours in plan with contour
    lines, and the points (P, 2 or 3) that it was made from. limits: (lowest, highest) of the colours."""
    vertices = np.asarray(vertices, np.float64)
    return _map(vertices[:, :2], triangles, vertices[:, 2], points, axes, limits, "height", "viridis")


def variance_map(vertices, triangles, variance, points=None, axes=None, limits=None):
    """The standard deviation of the heights of a surface, the root of variances (V,), as colours in plan, and
    the points."""
    deviation = np.sqrt(np.maximum(np.asarray(variance, np.float64), 0.0))
    plan = np.asarray(vertices, np.float64)[:, :2]
    return _map(plan, triangles, deviation, points, axes, limits, "standard deviation", "cividis")


def triangle_quality(vertices, triangles) -> np.ndarray:
    """(T,) float64 mean ratio quality in plan of triangles (T, 3) of vertices (V, 2 or 3): 4 sqrt(3) area
    over the sum of the squared edges, 1 for an equilateral triangle, 0 for one without area (Liu and Joe
    1994)."""
    a, b, c = (np.asarray(vertices, np.float64)[:, :2][np.asarray(triangles)[:, k]] for k in range(3))
    u, v, w = b - a, c - a, c - b
    area = 0.5 * np.abs(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0])
    squares = (u**2 + v**2 + w**2).sum(axis=1)
    return 4 * np.sqrt(3) * area / np.where(squares > 0, squares, 1.0)


def mesh_quality(vertices, triangles, axes=None):
    """How many triangles of a planar mesh have which mean ratio quality."""
    figure, axes = _axes(axes)
    quality = triangle_quality(vertices, triangles)
    axes.hist(quality, np.linspace(0, 1, 51), color="tab:blue")
    title = f"{len(quality)} triangles, mean {quality.mean():.3f}, least {quality.min():.3f}"
    axes.set_title(title, fontsize="medium")
    axes.set(xlabel="mean ratio quality", ylabel="triangles", xlim=(0, 1), yscale="log")
    return figure


def _axes(axes):
    if axes is not None:
        return axes.figure, axes
    native_module()  # before matplotlib, which on some systems takes the room that its libraries need
    try:
        from matplotlib.figure import Figure
    except ImportError as error:
        raise UsageError("realmodel.core.plots needs matplotlib: pip install matplotlib") from error
    figure = Figure(figsize=_SIZE, layout="constrained")
    return figure, figure.subplots()


def _share_of_many(points: int) -> float:
    """1, or less where there are many points, but never so little that dots vanish."""
    return min(1.0, max(_MANY / max(points, 1), 0.03))


def _map(plan, triangles, values, points, axes, limits, label, colours):
    figure, axes = _axes(axes)
    # matplotlib's own arithmetic has single precision in places: coordinates from the middle
    middle = np.round(plan.mean(axis=0), -2) if np.abs(plan).max() > 1e5 else np.zeros(2)
    x, y = (plan - middle).T
    known = np.isfinite(values)
    shown = np.asarray(triangles)[known[np.asarray(triangles)].all(axis=1)]
    low, high = limits or (values[known].min(), values[known].max())
    from matplotlib.tri import Triangulation

    mesh = Triangulation(x, y, shown)
    filled = np.where(known, values, low)
    drawn = axes.tripcolor(
        mesh, filled, cmap=colours, vmin=low, vmax=high, shading="gouraud", rasterized=True
    )
    if len(shown) and high > low:
        levels = np.linspace(low, high, 12)[1:-1]
        axes.tricontour(mesh, filled, levels=levels, colors="white", linewidths=0.4, alpha=0.6)
    if points is not None:
        px, py = (np.asarray(points, np.float64)[:, :2] - middle).T
        axes.scatter(px, py, 6 * _share_of_many(len(px)), c="black", linewidths=0.0)
    axes.set_aspect("equal")
    if middle.any():
        axes.set(xlabel=f"x - {middle[0]:.0f}", ylabel=f"y - {middle[1]:.0f}")
    figure.colorbar(drawn, ax=axes, label=label, shrink=0.85)
    return figure
