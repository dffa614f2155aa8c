# SPDX-License-Identifier: GPL-3.0-or-later
"""cross_validate against the same points left out by hand."""

import numpy as np
import pytest
from dense_kriging import dense_kriging
from realmodel.core import Cancelled, InputRefused, UsageError, cross_validate, interpolate

RNG = np.random.default_rng(3)
PLAN = RNG.random((70, 2)) * 100
POINTS = np.column_stack([PLAN, 5 * np.sin(PLAN[:, 0] / 20) + 0.1 * PLAN[:, 1]])
SPHERICAL = {"model": "spherical", "range": 60.0, "sill": 9.0, "nugget": 0.1}


@pytest.mark.parametrize("neighbours", [0, 10])
@pytest.mark.parametrize("drift", ["constant", "linear"])
def test_kriging_leaves_one_out(neighbours, drift):
    method, options = ("universal_kriging", {"drift": drift}) if drift != "constant" else ("kriging", {})
    result = cross_validate(POINTS, method, neighbours=neighbours, variogram=SPHERICAL, **options)
    for i in range(0, len(POINTS), 9):
        others = np.delete(POINTS, i, axis=0)
        h = np.hypot(*(others[:, :2] - POINTS[i, :2]).T)
        near = others[np.argsort(h)[: neighbours or None]]
        z, variance = dense_kriging(near, POINTS[i : i + 1], SPHERICAL, drift)
        assert result.z[i] == pytest.approx(z[0])
        assert result.errors[i] == pytest.approx(z[0] - POINTS[i, 2])
        assert result.standardized[i] == pytest.approx((z[0] - POINTS[i, 2]) / np.sqrt(variance[0]))
    assert result.rmse == pytest.approx(np.sqrt((result.errors**2).mean()))
    assert result.within_two_deviations == (abs(result.standardized) <= 2).mean()
    assert (result.method, result.variogram.sill) == (method, 9.0)


def test_inverse_distance_leaves_one_out():
    result = cross_validate(POINTS, "idw", neighbours=8, power=3)
    for i in (0, 33, 69):
        others = np.delete(POINTS, i, axis=0)
        z = interpolate(others, POINTS[i : i + 1, :2], "idw", neighbours=8, power=3).z
        assert result.z[i] == pytest.approx(z[0])
    assert result.standardized is None
    assert result.within_two_deviations is None
    everything = cross_validate(POINTS, "idw", neighbours=0)
    others = POINTS[1:]
    assert everything.z[0] == pytest.approx(interpolate(others, POINTS[:1, :2], "idw", neighbours=0).z[0])


def random_surface(draw, length=250.0):
    """A function of x and y with a deviation of 20 and features about so long: random waves."""
    waves = draw.normal(size=(200, 2)) * 1.2 * np.sqrt(2) / length
    phases = draw.uniform(0, 2 * np.pi, 200)
    return lambda x, y: 2 * np.cos(np.outer(x, waves[:, 0]) + np.outer(y, waves[:, 1]) + phases).sum(axis=1)


def layout(kind, draw):
    """(H, 2) holes in a square of 2 km."""
    plan = draw.uniform(0, 2000, (30, 2))
    if kind == "twins":
        return np.concatenate([plan, plan + draw.normal(0, 5, plan.shape)])
    if kind == "twins of half":
        return np.concatenate([plan, plan[:15] + draw.normal(0, 5, (15, 2))])
    if kind == "pairs 60 apart":
        return np.concatenate([plan, plan + draw.normal(0, 48, plan.shape)])
    return np.concatenate([plan, draw.uniform(0, 2000, (30, 2))])


@pytest.mark.parametrize("kind", ["spread", "twins", "twins of half", "pairs 60 apart"])
def test_the_error_of_holes_is_that_between_them(kind):
    """Also where most have another one beside them: places are left out."""
    said, true, within = [], [], []
    for seed in range(6):
        draw = np.random.default_rng(seed)
        surface, plan = random_surface(draw), layout(kind, draw)
        points = np.column_stack([plan, surface(*plan.T)])
        result = cross_validate(points)
        between = draw.uniform(0, 2000, (400, 2))
        errors = interpolate(points, between).z - surface(*between.T)
        said.append(result.rmse)
        true.append(np.sqrt((errors**2).mean()))
        within.append(result.within_two_deviations)
        assert np.array_equal(result.points, points)
    assert np.mean(said) == pytest.approx(np.mean(true), rel=0.25)
    assert 0.8 < np.mean(within) < 0.97


def test_points_at_one_place_leave_together():
    twice = np.vstack([POINTS, POINTS[:5]])
    result = cross_validate(twice, variogram=SPHERICAL)
    assert np.array_equal(result.points, POINTS)
    assert np.array_equal(result.errors, cross_validate(POINTS, variogram=SPHERICAL).errors)


def test_a_fitted_variogram_has_honest_variances():
    """Errors of a field drawn with a known variogram are as large as their deviations say."""
    plan = RNG.random((400, 2)) * 300
    h = np.hypot(*(plan[:, None] - plan[None]).transpose(2, 0, 1))
    covariance = 4 * np.exp(-3 * h / 80) + 1e-9 * np.eye(400)
    z = np.linalg.cholesky(covariance) @ RNG.normal(size=400)
    result = cross_validate(np.column_stack([plan, z]))
    assert 0.8 <= result.within_two_deviations <= 0.99
    assert 0.7 < result.standardized.std() < 1.3


def test_refused_and_cancelled():
    with pytest.raises(InputRefused, match="at least two points"):
        cross_validate([[0, 0, 1], [0, 0, 1]])
    with pytest.raises(UsageError, match="folds"):
        cross_validate(POINTS, folds=1)
    with pytest.raises(InputRefused, match="belongs to"):
        cross_validate(POINTS, "idw", drift="linear")
    many = np.column_stack([RNG.random((3000, 2)), RNG.random(3000)])
    with pytest.raises(Cancelled):
        cross_validate(many, neighbours=0, variogram=SPHERICAL, cancel=lambda: True)
