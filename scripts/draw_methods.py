#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws the pictures of docs/reference/methods.md: every method on one set of points, made here by formula.

    PYTHONPATH=addon python scripts/draw_methods.py [FOLDER]      (default: docs/images)

Needs the built module and matplotlib with pillow (scripts/requirements/test.txt). Letters and lines come out
as matplotlib draws them, so the pictures are looked at, not compared.
"""

import sys
from pathlib import Path

import numpy as np
from realmodel import _native  # noqa: F401  (before matplotlib: see realmodel.core.plots)
from realmodel.core import cross_validate, interpolate, mesh_region, plots

from matplotlib.figure import Figure  # isort: skip
from PIL import Image  # isort: skip

_OUTLINE = [[0, 0], [1000, 0], [1000, 700], [0, 700]]
_LIMITS = (60.0, 145.0)
_COLOURS = 96  # of a picture's palette


def horizon(x, y):
    """A dome beside a trough on a regional dip, with a flexure across: metres."""
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
    """Writes a small PNG: a palette of few colours."""
    figure.savefig(path, dpi=100)
    with Image.open(path) as picture:
        few = picture.convert("RGB").quantize(_COLOURS, dither=Image.Dither.NONE)
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
        figure = Figure(figsize=(4.4, 2.9), layout="constrained")
        axes = figure.subplots()
        shape = np.column_stack([vertices, result.z])
        plots.height_map(shape, triangles, known, axes=axes, limits=_LIMITS)
        axes.set_title(method if method != "auto" else f"auto: {result.method}", fontsize="medium")
        save(figure, folder / f"method_{method}.png")
        if method == "kriging":
            figure = Figure(figsize=(4.4, 2.9), layout="constrained")
            axes = figure.subplots()
            plots.variance_map(shape, triangles, result.variance, known, axes=axes)
            axes.set_title("kriging: how sure", fontsize="medium")
            save(figure, folder / "method_kriging_deviation.png")
            figure = Figure(figsize=(4.4, 2.9), layout="constrained")
            plots.variogram(result.variogram, figure.subplots())
            save(figure, folder / "method_variogram.png")
    draw_extrapolation(given[-14:], vertices, triangles, folder)
    figure = Figure(figsize=(4.4, 3.4), layout="constrained")
    plots.cross_validation(cross_validate(given), figure.subplots())
    save(figure, folder / "method_cross_validation.png")
    figure = Figure(figsize=(4.4, 2.9), layout="constrained")
    plots.mesh_quality(vertices, triangles, figure.subplots())
    save(figure, folder / "method_mesh_quality.png")


def draw_extrapolation(wells, vertices, triangles, folder):
    """Beside each other, what nodes outside the hull of a few wells get."""
    figure = Figure(figsize=(8.8, 2.4), layout="constrained")
    for choice, axes in zip(("method", "nearest", "none"), figure.subplots(1, 3, sharey=True), strict=True):
        z = interpolate(wells, vertices, "universal_kriging", extrapolate=choice).z
        kept = triangles[np.isfinite(z)[triangles].all(axis=1)]
        shape = np.column_stack([vertices, np.nan_to_num(z, nan=_LIMITS[0])])
        plots.height_map(shape, kept, wells, axes=axes, limits=_LIMITS)
        axes.set_title(f'extrapolate = "{choice}"', fontsize="medium")
    save(figure, folder / "method_extrapolate.png")


if __name__ == "__main__":
    draw(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).resolve().parents[1] / "docs" / "images")
