# SPDX-License-Identifier: GPL-3.0-or-later
"""Thin plate splines, and the choice of a method."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from realmodel.core import InputRefused, cross_validate, interpolate
from scipy.interpolate import RBFInterpolator

RNG = np.random.default_rng(31)
UTM = np.array([431250.25, 5398781.5])
PLAN = UTM + RNG.random((120, 2)) * 1000
NODES = UTM + RNG.random((80, 2)) * 1100 - 50


def wavy(plan):
    return 300 + 20 * np.sin((plan[:, 0] - UTM[0]) / 150) * np.cos((plan[:, 1] - UTM[1]) / 200)


POINTS = np.column_stack([PLAN, wavy(PLAN)])


@pytest.mark.parametrize("neighbours", [0, 20])
@pytest.mark.parametrize("smoothing", [0.0, 0.3])
def test_as_scipy(neighbours, smoothing):
    extent = np.ptp(PLAN, axis=0)
    spacing = np.sqrt(extent.prod() / len(PLAN))
    expected = RBFInterpolator(
        (PLAN - UTM) / spacing,
        POINTS[:, 2],
        neighbors=neighbours or None,
        kernel="thin_plate_spline",
        smoothing=smoothing,
    )((NODES - UTM) / spacing)
    result = interpolate(POINTS, NODES, "spline", neighbours=neighbours, smoothing=smoothing)
    assert result.z == pytest.approx(expected, abs=1e-7)
    assert (result.method, result.variance) == ("spline", None)


def test_a_plane_comes_out_as_a_plane():
    plane = np.column_stack([PLAN, 0.3 * (PLAN - UTM).sum(axis=1)])
    for options in ({}, {"neighbours": 0}, {"smoothing": 2.0}, {"octants": 2}, {"radius": 400.0}):
        z = interpolate(plane, NODES, "spline", **options).z
        assert z == pytest.approx(0.3 * (NODES - UTM).sum(axis=1), abs=1e-7)


def test_points_hold_or_are_smoothed():
    noisy = POINTS.copy()
    noisy[:, 2] += RNG.normal(0, 3, len(noisy))
    assert np.array_equal(interpolate(noisy, PLAN, "spline").z, noisy[:, 2])
    rough, smooth = (
        np.sqrt(
            np.mean((interpolate(noisy, NODES, "spline", neighbours=0, smoothing=s).z - wavy(NODES)) ** 2)
        )
        for s in (0.0, 0.5)
    )
    assert smooth < rough


def test_few_points_and_lines():
    assert interpolate([[0, 0, 7]], [[3, 4]], "spline").z == pytest.approx([7])
    assert interpolate([[0, 0, 0], [2, 0, 4]], [[1, 5], [4, 0]], "spline").z == pytest.approx([2, 8])
    line = np.array([[k, 2 * k, np.sin(k / 2)] for k in range(8)], float)
    z = interpolate(line, [[2, 4], [2.5, 5], [2.5 + 2, 5 - 1]], "spline", neighbours=0).z
    assert z[0] == np.sin(1)
    assert z[1] == pytest.approx(np.sin(1.25), abs=0.05)


def test_threads_and_refusals():
    one, two = (interpolate(POINTS, NODES, "spline", threads=t).z for t in (1, 2))
    assert np.array_equal(one, two)
    with pytest.raises(InputRefused, match="'smoothing' must be at least 0"):
        interpolate(POINTS, NODES, "spline", smoothing=-1)


COORDINATE = st.one_of(st.integers(-3, 3), st.floats(-1e3, 1e3))
SETS = st.lists(st.tuples(COORDINATE, COORDINATE, st.floats(-100, 100)), min_size=1, max_size=20)


@settings(max_examples=60, deadline=None)
@given(SETS, st.sampled_from(["spline", "auto"]))
def test_any_points_give_heights_or_are_refused(points, method):
    nodes = [[0, 0], [0.5, -1], [1e3, 1e3], [1e-9, 0]]
    try:
        result = interpolate(np.array(points, float), nodes, method)
    except InputRefused as error:
        assert "the same position in plan" in str(error)
        return
    assert np.isfinite(result.z).all()


def test_auto_says_what_and_why():
    result = interpolate(POINTS, NODES, "auto")
    assert result.method in ("kriging", "universal_kriging", "spline", "natural_neighbour")
    assert "root mean square errors of left-out ones" in result.reason
    errors = {
        m: cross_validate(POINTS, m, neighbours=32).rmse for m in ("kriging", "spline", "universal_kriging")
    }
    chosen = cross_validate(POINTS, "auto").rmse
    assert chosen <= errors["spline"]
    again = interpolate(POINTS, NODES, "auto", threads=1)
    assert (again.method, again.reason) == (result.method, result.reason)
    assert np.array_equal(again.z, result.z)


def test_auto_by_number_and_spread():
    one = interpolate([[1, 2, 3]], NODES, "auto")
    assert (one.method, one.reason) == ("constant", "only one point")
    two = interpolate([[0, 0, 0], [1, 0, 1]], [[2, 0]], "auto")
    assert (two.method, two.z.tolist()) == ("plane", pytest.approx([2]))
    line = interpolate([[0, 0, 0], [1, 1, 1], [2, 2, 2.5], [3, 3, 3]], NODES, "auto")
    assert line.method == "plane"
    assert "nearly in one line" in line.reason
    tilted = np.column_stack([PLAN[:7], 0.1 * (PLAN[:7] - UTM)[:, 0]])
    assert interpolate(tilted, NODES, "auto").method == "plane"


def test_auto_names_points_that_contradict_one_another_by_their_place():
    points = [[0, 0, 1], [9, 0, 2], [0, 0, 1], [0, 9, 3], [5, 5, 0], [5, 5, 9.0]]
    with pytest.raises(InputRefused, match=r"two points have .* in plan \(5, 5\) but the values 0 and 9"):
        interpolate(points, [[1.0, 1.0]], method="auto")


def test_auto_keeps_extrapolate_and_takes_no_option_of_others():
    result = interpolate(POINTS, NODES, "auto", extrapolate="none")
    assert np.isnan(result.z).mean() == result.extrapolated > 0
    with pytest.raises(InputRefused, match="'neighbours' belongs to kriging, not to auto"):
        interpolate(POINTS, NODES, "auto", neighbours=4)


@pytest.mark.parametrize("seed", range(8))
def test_a_spline_that_swings_beside_a_line_of_points_warns(seed):
    """Its errors have no bound there; what lies on the line, or rises evenly along it, is no reason."""
    own = np.random.default_rng(seed)
    turn, along = own.uniform(0, np.pi), np.linspace(0, 10, 62)
    axis, across = np.array([np.cos(turn), np.sin(turn)]), np.array([-np.sin(turn), np.cos(turn)])
    plan = 1000 + along[:, None] * axis
    beside = (plan[:, None] + np.linspace(-5, 5, 11)[:, None] * across).reshape(-1, 2)
    points = np.column_stack([plan, own.uniform(800, 4300, 62)])
    assert any("lie on a line" in text for text in interpolate(points, beside, "spline").warnings)
    assert not any("beyond" in text for text in interpolate(points, plan, "spline").warnings)
    even = np.column_stack([plan, 3 * along])
    assert not any("beyond" in text for text in interpolate(even, beside, "spline").warnings)
