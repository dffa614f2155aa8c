#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws the pictures of docs/reference/methods.md: every method on one set of points, made here by formula.

    PYTHONPATH=addon python scripts/draw_methods.py [FOLDER]      (default: docs/images)

Needs the built module and matplotlib with pillow (scripts/requirements/test.txt). Letters and lines come out
as matplotlib draws them, so the pictures of maps are looked at, not compared.
"""

import sys
from pathlib import Path

import numpy as np
from realmodel import _native  # noqa: F401  (before matplotlib, which may take the room of its libraries)
from realmodel.core import cross_validate, interpolate, mesh_region, plots
from realmodel.core.drawing import save_drawing

from matplotlib.figure import Figure  # isort: skip
from matplotlib.tri import Triangulation  # isort: skip
from PIL import Image  # isort: skip

_OUTLINE = [[0, 0], [1000, 0], [1000, 700], [0, 700]]
_LIMITS = (60.0, 145.0)
_COLORS = 96  # of a picture's palette
_MANY = 300  # points, beyond which their dots become smaller


def horizon(x, y):
    """A dome beside a trough on a regional dip, with a flexure across: meters."""
    dome = 45 * np.exp(-((x - 320) ** 2 + (y - 400) ** 2) / 140**2)
    trough = -30 * np.exp(-(((x - 720) / 220) ** 2) - ((y - 250) / 120) ** 2)
    return 85 + 0.03 * x + dome + trough + 12 * np.tanh((y - 0.3 * x - 300) / 60)


def points():
    """Four measured lines and a few wells, with small errors: (P, 3)."""
    own = np.random.default_rng(2014)
    places = []
    for start, end in (
        ((60, 80), (930, 210)),
        ((80, 600), (900, 520)),
        ((250, 30), (380, 670)),
        ((690, 60), (640, 650)),
    ):
        share = np.linspace(0, 1, 15)[:, None]
        places.append(np.array(start) * (1 - share) + np.array(end) * share + own.normal(0, 6, (15, 2)))
    places.append(own.uniform([60, 60], [940, 640], (14, 2)))
    x, y = np.concatenate(places).T
    return np.column_stack([x, y, horizon(x, y) + own.normal(0, 0.5, len(x))])


def neighbour(vertices):
    """A better known surface below, for `parallel`."""
    return horizon(*vertices.T) - 25 - 0.01 * vertices[:, 0]


def save(figure, path):
    """Writes a small PNG: a palette of few colors."""
    figure.savefig(path, dpi=160)
    with Image.open(path) as picture:
        few = picture.convert("RGB").quantize(_COLORS, dither=Image.Dither.NONE)
    few.save(path, optimize=True)


def draw(folder):
    folder.mkdir(parents=True, exist_ok=True)
    given = points()
    vertices, triangles = mesh_region(_OUTLINE, edge_length=14)
    x, y = (a.ravel() for a in np.meshgrid(np.arange(0.0, 1001, 100), np.arange(0.0, 701, 100)))
    raster = np.column_stack([x, y, horizon(x, y)])
    wells = given[[3, 22, 41, 52]]
    below = neighbour(vertices)
    methods = {
        "kriging": (given, {}),
        "universal_kriging": (given, {}),
        "idw": (given, {}),
        "spline": (given, {}),
        "dsi": (given, {"triangles": triangles}),
        "tin": (given, {}),
        "natural_neighbour": (given, {}),
        "grid": (raster, {}),
        "plane": (given, {}),
        "constant": (wells, {}),
        "parallel": (wells, {"to": below, "triangles": triangles}),
        "auto": (given, {}),
    }
    for method, (known, options) in methods.items():
        result = interpolate(known, vertices, method, **options)
        figure = Figure(figsize=(7.6, 2.6), layout="constrained")
        axes, beside = figure.subplots(1, 2, sharey=True)
        shape = np.column_stack([vertices, result.z])
        height_map(shape, triangles, known, axes, limits=_LIMITS)
        axes.set_title(method if method != "auto" else f"auto: {result.method}", fontsize="medium")
        height_map(np.column_stack([vertices, horizon(*vertices.T)]), triangles, None, beside, limits=_LIMITS)
        beside.set_title("the true surface", fontsize="medium")
        save(figure, folder / f"method_{method}.png")
        if method == "kriging":
            figure = Figure(figsize=(4.4, 2.9), layout="constrained")
            axes = figure.subplots()
            variance_map(shape, triangles, result.variance, known, axes)
            axes.set_title("kriging: standard deviation", fontsize="medium")
            save(figure, folder / "method_kriging_deviation.png")
            save_drawing(plots.variogram(result.variogram, "m"), folder / "method_variogram.svg")
    draw_extrapolation(given[-14:], vertices, triangles, folder)
    draw_true_thickness(folder)
    save_drawing(plots.cross_validation(cross_validate(given), "m"), folder / "method_cross_validation.svg")
    save_drawing(
        plots.mesh_quality(plots.smallest_angles(vertices, triangles)), folder / "method_mesh_quality.svg"
    )


def height_map(vertices, triangles, points, axes, limits=None):
    """Heights of a triangulated surface (vertices (V, 3), triangles (T, 3)) as colors in plan with contour
    lines, and the points (P, 2 or 3) that it was made from. limits: (lowest, highest) of the colors."""
    vertices = np.asarray(vertices, np.float64)
    _map(vertices[:, :2], triangles, vertices[:, 2], points, axes, limits, "height", "viridis")


def variance_map(vertices, triangles, variance, points, axes, limits=None):
    """The standard deviation of the heights of a surface, the root of variances (V,), as colors in plan, and
    the points."""
    deviation = np.sqrt(np.maximum(np.asarray(variance, np.float64), 0.0))
    plan = np.asarray(vertices, np.float64)[:, :2]
    _map(plan, triangles, deviation, points, axes, limits, "standard deviation", "cividis")


def _share_of_many(points: int) -> float:
    """1, or less where there are many points, but never so little that dots vanish."""
    return min(1.0, max(_MANY / max(points, 1), 0.03))


def _map(plan, triangles, values, points, axes, limits, label, colors):
    # matplotlib's own arithmetic has single precision in places: coordinates from the middle
    middle = np.round(plan.mean(axis=0), -2) if np.abs(plan).max() > 1e5 else np.zeros(2)
    x, y = (plan - middle).T
    known = np.isfinite(values)
    shown = np.asarray(triangles)[known[np.asarray(triangles)].all(axis=1)]
    low, high = limits or (values[known].min(), values[known].max())
    mesh = Triangulation(x, y, shown)
    filled = np.where(known, values, low)
    drawn = axes.tripcolor(mesh, filled, cmap=colors, vmin=low, vmax=high, shading="gouraud", rasterized=True)
    if len(shown) and high > low:
        levels = np.linspace(low, high, 12)[1:-1]
        axes.tricontour(mesh, filled, levels=levels, colors="white", linewidths=0.4, alpha=0.6)
    if points is not None:
        px, py = (np.asarray(points, np.float64)[:, :2] - middle).T
        axes.scatter(px, py, 6 * _share_of_many(len(px)), c="black", linewidths=0.0)
    axes.set_aspect("equal")
    if middle.any():
        axes.set(xlabel=f"x - {middle[0]:.0f}", ylabel=f"y - {middle[1]:.0f}")
    axes.figure.colorbar(drawn, ax=axes, label=label, shrink=0.85)


def draw_extrapolation(wells, vertices, triangles, folder):
    """Beside each other, what nodes outside the hull of a few wells get."""
    figure = Figure(figsize=(8.8, 2.4), layout="constrained")
    for choice, axes in zip(("method", "nearest", "none"), figure.subplots(1, 3, sharey=True), strict=True):
        z = interpolate(wells, vertices, "universal_kriging", extrapolate=choice).z
        kept = triangles[np.isfinite(z)[triangles].all(axis=1)]
        shape = np.column_stack([vertices, np.nan_to_num(z, nan=_LIMITS[0])])
        height_map(shape, kept, wells, axes, limits=_LIMITS)
        axes.set_title(f'extrapolate = "{choice}"', fontsize="medium")
    save(figure, folder / "method_extrapolate.png")


def draw_true_thickness(folder):
    """Beside each other, a layer of one thickness in a fold, measured vertically and perpendicular to it."""
    plan, triangles = mesh_region([[0, -20], [600, -20], [600, 20], [0, 20]], edge_length=4)
    own = 90 * np.cos(plan[:, 0] / 65)
    line = np.column_stack([np.linspace(1.0, 599.0, 600), np.zeros(600)])
    sheet = (np.column_stack([plan, own]), triangles)
    bottom = interpolate(None, line, "parallel", to=sheet, thickness=0).z
    figure = Figure(figsize=(8.8, 2.6), layout="constrained")
    for true, axes in zip((False, True), figure.subplots(1, 2, sharey=True), strict=True):
        z = interpolate(None, plan, "parallel", triangles, to=sheet, thickness=60.0, true_thickness=true).z
        top = interpolate(None, line, "parallel", to=(np.column_stack([plan, z]), triangles), thickness=0).z
        axes.fill_between(line[:, 0], bottom, top, color="#d8a657", linewidth=0.0)
        for heights in (bottom, top):
            axes.plot(line[:, 0], heights, color="black", linewidth=1.0)
        axes.set_aspect("equal")
        axes.set_title("true_thickness = true" if true else "vertical thickness", fontsize="medium")
    save(figure, folder / "method_true_thickness.png")


if __name__ == "__main__":
    draw(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).resolve().parents[1] / "docs" / "images")
