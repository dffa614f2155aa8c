#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The picture of docs/dev/meshing.md: the three meshers on one region, with the quality of the triangles.

    PYTHONPATH=addon python scripts/draw_meshers.py [FOLDER]      (default: docs/images)

Needs the built module and matplotlib with pillow (scripts/requirements/test.txt).
"""

import sys
from pathlib import Path

import numpy as np
from realmodel import _native  # noqa: F401  (before matplotlib: see realmodel.core.plots)
from realmodel.core import mesh_region

from matplotlib.collections import PolyCollection  # isort: skip
from matplotlib.figure import Figure  # isort: skip

from benchmarks.meshing import figures  # isort: skip
from draw_methods import save  # isort: skip

_EDGE = 4.5
_ROWS = 20  # of a histogram
_COLORS = "viridis"


def region():
    """A coast with a narrow inlet, and a lake: the outline (N, 2) and one hole."""
    turn = np.linspace(0, 2 * np.pi, 90, endpoint=False)
    radius = 50 + 6 * np.sin(3 * turn + 1) + 3 * np.cos(7 * turn) + 1.2 * np.sin(19 * turn)
    radius[10:13] -= [14, 24, 14]
    coast = np.column_stack([1.15 * radius * np.cos(turn), radius * np.sin(turn)])
    around = np.linspace(0, 2 * np.pi, 28, endpoint=False)
    lake = np.column_stack([-16 + 12 * np.cos(around), -8 + 7 * np.sin(around) + 3 * np.cos(2 * around)])
    return coast, lake


def mean_ratios(vertices, triangles):
    """(T,), 1 where a triangle is equilateral."""
    corners = vertices[triangles]
    sides = np.roll(corners, -1, axis=1) - corners
    twice = sides[:, 0, 0] * sides[:, 1, 1] - sides[:, 0, 1] * sides[:, 1, 0]
    return 2 * np.sqrt(3) * twice / (sides**2).sum(axis=(1, 2))


def draw(path):
    """Writes the picture of the three meshers."""
    outline, lake = region()
    figure = Figure(figsize=(11, 5.2), layout="constrained")
    axes = figure.subplots(2, 3, height_ratios=[3, 1])
    for column, mesher in enumerate(("delaunay", "frontal", "grid")):
        vertices, triangles = mesh_region(outline, [lake], _EDGE, mesher)
        ratios = mean_ratios(vertices, triangles)
        plan, histogram = axes[:, column]
        colored = plan.add_collection(
            PolyCollection(
                vertices[triangles], array=ratios, cmap=_COLORS, clim=(0.4, 1), edgecolor="k", linewidth=0.3
            )
        )
        plan.autoscale_view()
        plan.set_aspect("equal")
        plan.set_axis_off()
        plan.set_title(f"{mesher}: {len(triangles):,} triangles")
        quality = figures(vertices, triangles, _EDGE, False)
        histogram.hist(
            ratios, bins=np.linspace(0, 1, _ROWS + 1), weights=np.full(len(ratios), 100 / len(ratios))
        )
        histogram.set_xlim(0, 1)
        histogram.set_ylim(0, 100)
        histogram.set_xlabel("mean ratio")
        histogram.text(
            0.03,
            0.9,
            f"mean {quality['mean_ratio']:.3f}\nleast angle {quality['least_angle']:.0f}°\n"
            f"six neighbors {100 * quality['six']:.0f} %",
            transform=histogram.transAxes,
            verticalalignment="top",
        )
    axes[1, 0].set_ylabel("% of triangles")
    figure.colorbar(colored, ax=list(axes[0]), label="mean ratio of a triangle (1: equilateral)", shrink=0.8)
    save(figure, path)


if __name__ == "__main__":
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parents[1] / "docs" / "images"
    draw(folder / "meshers.png")
