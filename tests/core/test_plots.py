# SPDX-License-Identifier: GPL-3.0-or-later
"""Charts of variograms, cross-validation, and meshes: what they show is what went in."""

import numpy as np
import pytest
from conftest import grid_surface
from realmodel.core import Project, Rock, Surface, Variogram, build, cross_validate, interpolate, plots
from realmodel.core.drawing.drawing import Dots, FilledRings, Line, Text
from realmodel.core.exporters.report import model_report
from realmodel.core.results.surface_quality import surface_quality
from realmodel.core.results.volumes import volume_deviations
from realmodel.core.settings.methods import DEFAULT_METHOD, DEFAULT_OPTIONS

RNG = np.random.default_rng(3)
PLAN = RNG.random((90, 2)) * 100
POINTS = np.column_stack([PLAN, 5 * np.sin(PLAN[:, 0] / 20) + 0.1 * PLAN[:, 1] + RNG.normal(0, 0.2, 90)])
VERTICES, TRIANGLES = grid_surface(8, lambda x, y: 3 + x * y, 100.0)


def items(drawing, kind):
    return [item for item in drawing.items if isinstance(item, kind)]


def texts(drawing):
    return " | ".join(item.text for item in items(drawing, Text))


def box(drawing):
    """The frame of the axes: lower left and upper right corner."""
    frame = next(item for item in items(drawing, FilledRings) if item.fill is None)
    return frame.rings[0].min(axis=0), frame.rings[0].max(axis=0)


def test_variogram_shows_curve_and_experimental_values():
    fitted = interpolate(POINTS, [[50, 50]]).variogram
    drawing = plots.variogram(fitted, "m")
    low, high = box(drawing)
    (dots,) = items(drawing, Dots)
    curve = next(item.points for item in items(drawing, Line) if len(item.points) == 400)
    assert len(dots.points) == len(fitted.lags)
    for shown, real in ((dots.points, fitted.gamma), (curve, None)):
        assert (shown >= low - 1e-9).all() and (shown <= high + 1e-9).all()
        distance = (shown[:, 0] - low[0]) / (high[0] - low[0]) * fitted.lags[-1] * 1.05
        value = fitted.semivariance(distance) if real is None else real
        assert np.corrcoef(shown[:, 1], value)[0, 1] == pytest.approx(1.0)
    assert dots.radii.argmax() == fitted.pairs.argmax()
    assert f"range {fitted.range:.4g} m, sill {fitted.sill:.4g} m²" in texts(drawing)
    given = plots.variogram(Variogram("spherical", 60.0, 4.0, 1.0))
    assert not items(given, Dots)
    assert "Spherical, given: | range 60, sill 4, nugget 1 |" in texts(given)


def test_cross_validation_sets_errors_beyond_two_deviations_apart():
    result = cross_validate(POINTS)
    drawing = plots.cross_validation(result, "m")
    within, beyond = (len(item.points) for item in items(drawing, Dots))
    assert (beyond, beyond + within) == ((np.abs(result.standardized) > 2).sum(), 90)
    assert f"RMSE {result.rmse:.4g} m" in texts(drawing)
    low, high = box(drawing)
    for item in items(drawing, Dots):
        assert (item.points > low).all() and (item.points < high).all()
    plain = plots.cross_validation(cross_validate(POINTS, "idw"))
    assert len(items(plain, Dots)[0].points) == 90
    assert "standard deviations" not in texts(plain)


def test_figures_of_a_cross_validation():
    result = cross_validate(POINTS, "tin", extrapolate="none")
    known = np.isfinite(result.errors)
    assert not known.all()  # corners of the hull
    errors = result.errors[known]
    assert result.mean_error == pytest.approx(errors.mean())
    assert result.mean_absolute_error == pytest.approx(np.abs(errors).mean())
    assert result.correlation == pytest.approx(np.corrcoef(result.points[known, 2], result.z[known])[0, 1])
    worst = result.worst(5)
    assert np.abs(result.errors[worst]).tolist() == sorted(np.abs(errors))[::-1][:5]
    assert len(result.worst(1000)) == known.sum()
    assert f"({(~known).sum()} more cannot be estimated)" in texts(plots.cross_validation(result))


def test_many_points_are_thinned_out():
    many = np.column_stack([RNG.random((9000, 2)) * 100, RNG.random(9000)])
    crowded, few = (
        items(plots.cross_validation(cross_validate(points, "idw")), Dots)[0] for points in (many, POINTS)
    )
    assert 2000 < len(crowded.points) <= 4000
    assert 0 < crowded.radii[0] < few.radii[0] / 2


def test_quality_of_triangles():
    corners = np.array([[0, 0], [1, 0], [0.5, np.sqrt(0.75)], [0, 1], [2, 0]])
    angles = plots.smallest_angles(corners, np.array([[0, 1, 2], [2, 1, 0], [0, 1, 3], [0, 1, 4]]))
    assert angles == pytest.approx([60, 60, 45, 0])
    drawing = plots.mesh_quality(plots.smallest_angles(VERTICES, TRIANGLES))
    (bar,) = (item for item in items(drawing, FilledRings) if item.fill is not None)
    low, high = box(drawing)
    left, right = ((bar.rings[0][[0, 1], 0] - low[0]) / (high[0] - low[0]) * 60).tolist()
    assert left <= 45 < right
    assert "128 triangles | smallest angle 45.0°, on average 45.0°" in texts(drawing)


def test_quality_of_the_surfaces_of_a_model():
    region = [[0, 0], [100, 0], [100, 100], [0, 100]]
    vertices, triangles = grid_surface(2, lambda x, y: 40 + 0 * x, 100.0)
    rock = Rock(
        "rock",
        [
            Surface("kriged", points=POINTS),
            Surface("smooth", points=POINTS + np.array([0, 0, 10]), method="dsi"),
            Surface("chosen", points=POINTS + np.array([0, 0, 15]), method="auto"),
            Surface(
                "above", points=POINTS[:1] + np.array([0, 0, 25]), method="parallel", options={"to": "chosen"}
            ),
            Surface("one", points=POINTS[:1] + np.array([0, 0, 30]), method="constant"),
            Surface("mesh", vertices, triangles),
        ],
        region=region,
        edge_length=10.0,
    )
    model = build(Project("p", [rock]))
    found = [surface_quality(model, number) for number in range(6)]
    kriged = found[0]
    assert kriged.cross_validation.rmse == pytest.approx(
        cross_validate(POINTS, DEFAULT_METHOD, **DEFAULT_OPTIONS).rmse
    )
    assert kriged.variogram == model.interpolations[0].variogram
    assert 0 < kriged.mean_deviation < kriged.most_deviation
    assert len(kriged.angles) == len(model.surface(0)[1])
    assert found[1].cross_validation.rmse < 1 and found[1].mean_deviation is None
    assert found[2].cross_validation.method == model.interpolations[2].method
    assert [quality.missing for quality in found[3:]] == [
        "its elevations follow another surface (to)",
        "it takes two points or more",
        "its shape is a mesh: nothing was interpolated",
    ]
    assert found[5].angles == pytest.approx(np.full(8, 45.0))


def test_volumes_may_be_off_by_the_standard_deviation_over_their_contacts():
    region = [[0, 0], [100, 0], [100, 100], [0, 100]]
    level, triangles = grid_surface(1, lambda x, y: -50 + 0 * x, 100.0)
    surfaces = [
        Surface("base", level, triangles),
        Surface("kriged", points=POINTS),
        Surface("top", level + np.array([0, 0, 100]), triangles),
    ]
    model = build(Project("p", [Rock("rock", surfaces, region=region, edge_length=5.0)]))
    mean = surface_quality(model, 1).mean_deviation
    assert mean > 0
    found = volume_deviations(model)
    assert found[-2:] == pytest.approx(np.full(2, mean * 100 * 100), rel=1e-3)
    entries = [entry["volume_deviation_at_most"] for entry in model_report(model)["blocks"]]
    assert entries[-2:] == found[-2:].tolist()
    exact = build(Project("p", [Rock("rock", [surfaces[0], surfaces[2]])]))
    assert np.isnan(volume_deviations(exact)).all()
