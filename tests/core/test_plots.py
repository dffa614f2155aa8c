# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of interpolation: what they show is what went in. Skipped where matplotlib is absent."""

import io
import subprocess
import sys

import numpy as np
import pytest
from conftest import ROOT, grid_surface
from realmodel.core import Variogram, cross_validate, interpolate, plots

RNG = np.random.default_rng(3)
PLAN = RNG.random((90, 2)) * 100
POINTS = np.column_stack([PLAN, 5 * np.sin(PLAN[:, 0] / 20) + 0.1 * PLAN[:, 1] + RNG.normal(0, 0.2, 90)])
VERTICES, TRIANGLES = grid_surface(8, lambda x, y: 3 + x * y, 100.0)


def drawn(figure):
    """The axes, once the figure could be drawn to its end."""
    pytest.importorskip("matplotlib", reason="matplotlib is not installed")
    file = io.BytesIO()
    figure.savefig(file, format="png", dpi=40)
    assert file.getvalue().startswith(b"\x89PNG")
    return figure.axes[0]


@pytest.fixture(autouse=True)
def _matplotlib():
    pytest.importorskip("matplotlib", reason="matplotlib is not installed")


def test_variogram_shows_curve_and_experimental_values():
    fitted = interpolate(POINTS, [[50, 50]]).variogram
    axes = drawn(plots.variogram(fitted))
    (curve,) = axes.lines
    x, y = curve.get_data()
    assert y == pytest.approx(fitted.semivariance(x))
    shown = axes.collections[0].get_offsets()
    assert np.asarray(shown) == pytest.approx(np.column_stack([fitted.lags, fitted.gamma]))
    given = drawn(plots.variogram(Variogram("spherical", 60.0, 4.0, 1.0)))
    assert not given.collections
    assert given.lines[0].get_xdata()[-1] == pytest.approx(90)


def test_cross_validation_sets_errors_beyond_two_deviations_apart():
    told = cross_validate(POINTS)
    axes = drawn(plots.cross_validation(told))
    beyond, within = (len(c.get_offsets()) for c in axes.collections)
    assert (beyond, beyond + within) == ((np.abs(told.standardised) > 2).sum(), 90)
    assert f"{told.rmse:.4g}" in axes.get_title()
    (only,) = drawn(plots.cross_validation(cross_validate(POINTS, "idw"))).collections
    assert len(only.get_offsets()) == 90


def test_maps_show_heights_deviations_and_points():
    away = np.array([431250.0, 5398781.0, 0.0])
    figure = plots.height_map(VERTICES + away, TRIANGLES, POINTS + away)
    axes = drawn(figure)
    mesh = axes.collections[0]
    assert (mesh.norm.vmin, mesh.norm.vmax) == (VERTICES[:, 2].min(), VERTICES[:, 2].max())
    shown = np.asarray(axes.collections[-1].get_offsets())
    assert np.ptp(shown, axis=0) == pytest.approx(np.ptp(PLAN, axis=0))
    assert "431" in axes.get_xlabel()
    variance = np.full(len(VERTICES), 4.0)
    variance[0], variance[1] = np.nan, 9.0
    mesh = drawn(plots.variance_map(VERTICES, TRIANGLES, variance)).collections[0]
    assert (mesh.norm.vmin, mesh.norm.vmax) == (2.0, 3.0)


def test_quality_of_triangles():
    corners = np.array([[0, 0], [1, 0], [0.5, np.sqrt(0.75)], [0, 1], [2, 0]])
    quality = plots.triangle_quality(corners, np.array([[0, 1, 2], [0, 1, 3], [0, 1, 4]]))
    assert quality == pytest.approx([1.0, np.sqrt(0.75), 0.0])
    axes = drawn(plots.mesh_quality(VERTICES, TRIANGLES))
    assert sum(bar.get_height() for bar in axes.patches) == len(TRIANGLES)


def test_axes_of_ones_own():
    from matplotlib.figure import Figure

    figure = Figure()
    left, right = figure.subplots(1, 2)
    assert plots.mesh_quality(VERTICES, TRIANGLES, axes=left) is figure
    assert plots.height_map(VERTICES, TRIANGLES, axes=right) is figure
    drawn(figure)


def test_without_matplotlib_it_says_what_to_do():
    code = (
        "import sys; sys.modules['matplotlib'] = None\n"
        "from realmodel.core import UsageError, Variogram, plots\n"
        "try:\n    plots.variogram(Variogram('spherical', 1.0, 1.0))\n"
        "except UsageError as error:\n    print(error)\n"
    )
    run = subprocess.run(
        [sys.executable, "-c", code],
        env={"PYTHONPATH": str(ROOT / "addon")},
        capture_output=True,
        text=True,
        check=False,
    )
    assert "needs matplotlib" in run.stdout, run.stderr


def test_many_points_are_smaller_dots():
    """5000 points would hide a map otherwise, and their errors one another."""
    many = np.column_stack([RNG.random((5000, 2)) * 100, np.zeros(5000)])
    few, crowded = (
        drawn(plots.height_map(VERTICES, TRIANGLES, points)).collections[-1] for points in (POINTS, many)
    )
    assert len(crowded.get_offsets()) == 5000
    assert 0 < crowded.get_sizes()[0] < few.get_sizes()[0] / 10
