#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws the pictures of docs/reference/methods.md: every method on one set of points, made here by formula.

    PYTHONPATH=addon python scripts/draw_methods.py [FOLDER]      (default: docs/images)

Needs the built module and matplotlib with pillow (scripts/requirements/test.txt). Letters and lines come out
as matplotlib draws them, so the pictures of maps are looked at, not compared.
"""

import sys
from pathlib import Path
from typing import NamedTuple

import numpy as np
from realmodel import _native  # noqa: F401  (before matplotlib, which may take the room of its libraries)
from realmodel.core import cross_validate, interpolate, mesh_region, plots
from realmodel.core.drawing import save_drawing

from matplotlib.figure import Figure  # isort: skip
from matplotlib.tri import Triangulation  # isort: skip

_OUTLINE = [[0, 0], [1000, 0], [1000, 700], [0, 700]]


class Bands(NamedTuple):
    """The colors of a map, one between two levels, and the label of their bar."""

    label: str
    levels: np.ndarray
    colors: str
    extend: str = "both"


_ELEVATIONS = Bands("elevation (m)", np.arange(60.0, 146.0, 5.0), "viridis")
_FOLLOWED = Bands("surface followed (m)", np.arange(30.0, 116.0, 5.0), "viridis")
_ERRORS = Bands("error (m)", np.arange(-20.0, 20.5, 2.5), "RdBu_r")
_DEVIATIONS = Bands("standard deviation (m)", np.arange(0.0, 21.0, 1.0), "cividis", "max")
_DISTANCES = Bands("size of the error (m)", np.arange(0.0, 21.0, 1.0), "cividis", "max")


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
    """Writes a PNG of few plain colors, which needs no palette to be small."""
    figure.savefig(path, dpi=130, pil_kwargs={"optimize": True})


def draw(folder):
    folder.mkdir(parents=True, exist_ok=True)
    known = points()
    vertices, triangles = mesh_region(_OUTLINE, edge_length=14)
    x, y = (a.ravel() for a in np.meshgrid(np.arange(0.0, 1001, 100), np.arange(0.0, 701, 100)))
    raster = np.column_stack([x, y, horizon(x, y)])
    wells = known[[3, 22, 41, 52]]
    below = neighbour(vertices)
    true = horizon(*vertices.T)
    mesh = Triangulation(*vertices.T, triangles)
    methods = {
        "kriging": (known, {}),
        "universal_kriging": (known, {}),
        "idw": (known, {}),
        "spline": (known, {"neighbours": 0}),
        "dsi": (known, {"triangles": triangles}),
        "tin": (known, {}),
        "natural_neighbour": (known, {}),
        "grid": (raster, {}),
        "plane": (known, {}),
        "parallel": (wells, {"to": below, "triangles": triangles}),
        "auto": (known, {}),
    }
    draw_maps([(mesh, true, known, _ELEVATIONS)], folder / "method_true.png")
    for method, (data, options) in methods.items():
        result = interpolate(data, vertices, method, **options)
        first = (mesh, below, None, _FOLLOWED) if method == "parallel" else None
        maps = [(mesh, result.z, data, _ELEVATIONS), (mesh, result.z - true, data, _ERRORS)]
        draw_maps([first, *maps] if first else maps, folder / f"method_{method}.png")
        if method == "kriging":
            deviation = np.sqrt(np.maximum(result.variance, 0.0))
            maps = [(mesh, deviation, data, _DEVIATIONS), (mesh, abs(result.z - true), data, _DISTANCES)]
            draw_maps(maps, folder / "method_kriging_deviation.png")
            save_drawing(plots.variogram(result.variogram, "m"), folder / "method_variogram.svg")
    draw_extrapolation(known[-14:], folder)
    draw_true_thickness(folder)
    save_drawing(plots.cross_validation(cross_validate(known), "m"), folder / "method_cross_validation.svg")


def draw_maps(maps, path, titles=()):
    """Maps beside each other, each (mesh, values of its nodes, points or None, bands of color), and a color
    bar for each kind of values."""
    figure = Figure(figsize=(0.8 + 3.6 * len(maps), 2.6), layout="constrained")
    all_axes = figure.subplots(1, len(maps), sharey=True, squeeze=False)[0]
    for n, (axes, (mesh, values, data, bands)) in enumerate(zip(all_axes, maps, strict=True)):
        drawn = axes.tricontourf(mesh, values, bands.levels, cmap=bands.colors, extend=bands.extend)
        axes.tricontour(mesh, values, bands.levels[1:-1], colors="black", linewidths=0.3, alpha=0.5)
        if data is not None:
            axes.scatter(*data.T[:2], 6, c="black", edgecolors="white", linewidths=0.3)
        axes.set(aspect="equal", xlabel="x (m)", xlim=(0, 1000), ylim=(0, 700))
        if n + 1 == len(maps) or maps[n + 1][3] is not bands:
            figure.colorbar(drawn, ax=axes, label=bands.label, ticks=bands.levels[::4], shrink=0.95)
    for axes, title in zip(all_axes, titles, strict=False):
        axes.set_title(title, fontsize="medium")
    all_axes[0].set_ylabel("y (m)")
    save(figure, path)


def draw_extrapolation(wells, folder):
    """Beside each other, what nodes outside the hull of a few wells get."""
    maps, choices = [], ("method", "nearest", "none")
    plan, triangles = mesh_region(_OUTLINE, edge_length=5)  # so small that the edge of the hull has no steps
    for choice in choices:
        z = interpolate(wells, plan, "universal_kriging", extrapolate=choice).z
        inside = Triangulation(*plan.T, triangles[np.isfinite(z)[triangles].all(axis=1)])
        maps.append((inside, np.nan_to_num(z, nan=_ELEVATIONS.levels[0]), wells, _ELEVATIONS))
    titles = [f'extrapolate = "{choice}"' for choice in choices]
    draw_maps(maps, folder / "method_extrapolate.png", titles)


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
        axes.set(aspect="equal", xlabel="x (m)", ylabel="" if true else "elevation (m)")
        axes.set_title("true_thickness = true" if true else "vertical thickness", fontsize="medium")
    save(figure, folder / "method_true_thickness.png")


if __name__ == "__main__":
    draw(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).resolve().parents[1] / "docs" / "images")
