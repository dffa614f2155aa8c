# SPDX-License-Identifier: GPL-3.0-or-later
"""Kriging with a drift, nested variograms, octants and radius, against dense linear algebra."""

import numpy as np
import pytest
from dense_kriging import SHAPES, dense_kriging, distances, semivariance
from hypothesis import example, given, settings
from hypothesis import strategies as st
from realmodel.core import InputRefused, Structure, Variogram, interpolate

RNG = np.random.default_rng(11)
UTM = np.array([431250.37, 5398781.81])
PLAN = UTM + RNG.random((150, 2)) * 1000
POINTS = np.column_stack([PLAN, 30 * np.sin(PLAN[:, 0] / 150) + (PLAN[:, 1] - UTM[1]) / 10])
NODES = UTM + RNG.random((60, 2)) * 1200 - 100
SPHERICAL = {"model": "spherical", "range": 500.0, "sill": 25.0, "nugget": 1.0}
NESTED = {
    "nugget": 0.5,
    "structures": [
        {"model": "spherical", "range": 300.0, "sill": 6.0},
        {"model": "matern32", "range": 900.0, "sill": 15.0, "anisotropy": {"ratio": 3.0, "azimuth": 40.0}},
    ],
}
ANISOTROPY = {"ratio": 2.5, "azimuth": 30.0}


@pytest.mark.parametrize("drift", ["linear", "quadratic"])
@pytest.mark.parametrize("variogram", [SPHERICAL, NESTED], ids=["spherical", "nested"])
@pytest.mark.parametrize("neighbours", [0, 18])
def test_universal_kriging_as_in_the_textbook(drift, variogram, neighbours):
    options = {"variogram": variogram, "anisotropy": ANISOTROPY, "drift": drift}
    result = interpolate(POINTS, NODES, "universal_kriging", neighbours=neighbours, **options)
    for i, node in enumerate(NODES[:20]):
        near = POINTS[np.argsort(distances(POINTS, node[None]), axis=0)[: neighbours or None, 0]]
        z, variance = dense_kriging(near, node[None], variogram, drift, ANISOTROPY)
        assert result.z[i] == pytest.approx(z[0], abs=1e-9 * 25)
        assert result.variance[i] == pytest.approx(variance[0], abs=1e-9 * 25)
    assert result.method == "universal_kriging"


@pytest.mark.parametrize("neighbours", [0, 12])
def test_nested_variogram_in_ordinary_kriging(neighbours):
    result = interpolate(POINTS, NODES, neighbours=neighbours, variogram=NESTED)
    near = distances(POINTS, NODES).argsort(axis=0)[: neighbours or None]
    for i in range(20):
        z, variance = dense_kriging(POINTS[near[:, i]], NODES[i : i + 1], NESTED)
        assert result.z[i] == pytest.approx(z[0], abs=1e-8)
        assert result.variance[i] == pytest.approx(variance[0], abs=1e-8)
    variogram = result.variogram
    assert (variogram.model, variogram.range, variogram.sill) == ("nested", 900.0, 21.5)
    assert variogram.structures[0] == Structure("spherical", 300.0, 6.0)
    again = interpolate(POINTS, NODES, neighbours=neighbours, variogram=variogram)
    assert np.array_equal(again.z, result.z)
    assert again.variogram == variogram


def test_octants_and_radius():
    options = {"variogram": SPHERICAL, "neighbours": 12, "octants": 2, "radius": 220.0}
    result = interpolate(POINTS, NODES, **options)
    d = POINTS[:, None, :2] - NODES[None]
    octant = (np.arctan2(d[..., 1], d[..., 0]) // (np.pi / 4)).astype(int)
    for i in range(len(NODES)):
        h, taken, chosen = np.hypot(*d[:, i].T), {}, []
        for p in np.argsort(h):
            count = taken.get(octant[p, i], 0)
            if h[p] <= 220 and count < 2 and len(chosen) < 12:
                chosen.append(p)
                taken[octant[p, i]] = count + 1
        chosen = chosen or [h.argmin()]
        z, variance = dense_kriging(POINTS[chosen], NODES[i : i + 1], SPHERICAL)
        assert result.z[i] == pytest.approx(z[0])
        assert result.variance[i] == pytest.approx(variance[0])
    idw = interpolate(POINTS, NODES[:1], "idw", radius=220.0, neighbours=0)
    h = distances(POINTS, NODES[:1])[:, 0]
    weight = np.where(h <= 220, h**-2.0, 0)
    assert idw.z[0] == pytest.approx((weight * POINTS[:, 2]).sum() / weight.sum())


def test_nodes_without_a_point_within_the_radius_are_a_warning():
    far = np.vstack([NODES, UTM - 5000])
    result = interpolate(POINTS, far, variogram=SPHERICAL, radius=300.0)
    (warning,) = result.warnings
    assert "have no point within the radius" in warning
    nearest = distances(POINTS, far[-1:])[:, 0].argmin()
    assert result.z[-1] == POINTS[nearest, 2]


def test_a_drift_wins_where_heights_follow_a_trend():
    """A slope continues beyond the points, where ordinary kriging falls back to the mean."""
    plan = RNG.random((80, 2)) * [400, 1000]
    points = np.column_stack([plan, 0.5 * plan[:, 0] + RNG.normal(0, 1, 80)])
    nodes = np.column_stack([np.full(20, 700.0), np.linspace(100, 900, 20)])
    ordinary = interpolate(points, nodes, variogram={**SPHERICAL, "range": 200.0})
    universal = interpolate(points, nodes, "universal_kriging", neighbours=0)
    assert abs(ordinary.z - 350).mean() > 100
    assert abs(universal.z - 350).mean() < 5
    assert universal.variogram.fitted
    assert universal.variogram.sill < 10


@pytest.mark.parametrize("method", ["kriging", "universal_kriging"])
def test_fits_that_mean_nothing_warn(method):
    own = np.random.default_rng(8)
    noise = np.column_stack([own.random((1500, 2)) * 100, own.normal(0, 1, 1500)])
    warnings = interpolate(noise, NODES[:1], method).warnings
    assert any("pure nugget" in w for w in warnings), warnings
    few = interpolate(noise[:4], NODES[:1], method).warnings
    assert any("pairs of points, so elevations far from them" in w for w in few)
    x = np.linspace(0, 100, 60)
    trend = np.column_stack([x, own.random(60) * 100, 3 * x + own.normal(0, 1, 60)])
    assert any("far exceeds the extent" in w for w in interpolate(trend, NODES[:1]).warnings)
    well = np.column_stack([noise[:, :2], np.sin(noise[:, 0] / 5)])
    assert interpolate(well, [[50.0, 50.0]], method).warnings == ()
    far = interpolate(well, NODES[:1], "universal_kriging").warnings
    assert any("go far beyond those of its points" in w for w in far), "its drift goes on for kilometers"


def test_points_that_differ_by_rounding_are_level():
    level = np.column_stack([np.random.default_rng(3).random((30, 2)) * 100, np.full(30, 4900.0)])
    level[::3, 2] = np.nextafter(4900.0, 5000.0)
    warnings = interpolate(level, np.array([[500.0, 500.0], [-400.0, 50.0]]), "universal_kriging").warnings
    assert not any("far beyond" in text for text in warnings), warnings


def test_semivariance_of_a_variogram():
    h = np.array([0.0, 10.0, 200.0, 5000.0])
    for variogram in (SPHERICAL, NESTED, *({**SPHERICAL, "model": m} for m in SHAPES)):
        of = Variogram.from_settings(variogram)
        plain = {**variogram}
        if "structures" in plain:
            plain["structures"] = [{**part, "anisotropy": None} for part in plain["structures"]]
        places = np.column_stack([h, np.zeros(4)])
        assert of.semivariance(h) == pytest.approx(semivariance(places, places[:1], plain)[:, 0])


def test_one_and_two_points_warn():
    one = interpolate([[0, 0, 3]], [[5, 5], [0, 1]], variogram=SPHERICAL)
    assert (one.z == 3).all()
    assert "only one point" in one.warnings[0]
    two = interpolate([[0, 0, 3], [2, 0, 4]], [[4, 0]], "universal_kriging", variogram=SPHERICAL)
    assert two.z == pytest.approx([5])
    assert "two points only" in two.warnings[0]


def test_extrapolation_is_a_choice_and_reported():
    points = np.array([[0, 0, 1], [10, 0, 2], [10, 10, 5], [0, 10, 3.0], [5, 5, 2]])
    nodes = np.array([[5, 5], [0, 0], [5, 0], [12, 0], [-3, 11.0]])
    variogram = {"model": "spherical", "range": 20.0, "sill": 4.0}
    options = {"method": "kriging", "variogram": variogram}
    plain = interpolate(points, nodes, **options)
    assert plain.extrapolated == 0.4
    nearest = interpolate(points, nodes, **options, extrapolate="nearest")
    assert np.array_equal(nearest.z[:3], plain.z[:3])
    assert nearest.z[3:].tolist() == [2, 3]
    gamma = 4 * (1.5 * 0.1 - 0.5 * 0.1**3)
    assert nearest.variance[3] == pytest.approx(2 * gamma)
    none = interpolate(points, nodes, **options, extrapolate="none")
    assert np.isnan(none.z).tolist() == np.isnan(none.variance).tolist() == [False] * 3 + [True] * 2
    assert np.array_equal(none.z[:3], plain.z[:3])
    idw = interpolate(points, nodes, "idw", extrapolate="nearest")
    assert idw.z[3:].tolist() == [2, 3]
    with pytest.raises(InputRefused, match="'extrapolate' cannot be 'always'"):
        interpolate(points, nodes, extrapolate="always")


@pytest.mark.parametrize(
    ("variogram", "words"),
    [
        ({"structures": []}, "must be a list of tables"),
        ({"structures": [{"model": "spherical", "range": 3}]}, "lacks 'sill'"),
        ({"structures": [{"model": "linear", "range": 3, "sill": 1}]}, "'model' cannot be 'linear'"),
        ({"structures": [{"model": "cubic", "range": 0, "sill": 1}]}, "'range' must be more than 0"),
        ({"structures": [{"model": "cubic", "range": 1, "sill": 1, "nugget": 1}]}, "unknown key 'nugget'"),
        ({**SPHERICAL, "structures": NESTED["structures"]}, "unknown key 'model'"),
        ({"structures": NESTED["structures"], "nugget": -1}, "'nugget' must be at least 0"),
    ],
)
def test_nested_variograms_refused(variogram, words):
    with pytest.raises(InputRefused) as raised:
        interpolate(POINTS, NODES, variogram=variogram)
    assert words in str(raised.value)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"drift": "cubic"}, "'drift' cannot be 'cubic'"),
        ({"octants": -1}, "'octants' must be a whole number"),
        ({"radius": 0}, "'radius' must be more than 0"),
        ({"power": 2}, "'power' belongs to idw, not to universal_kriging"),
    ],
)
def test_options_refused(options, words):
    with pytest.raises(InputRefused) as raised:
        interpolate(POINTS, NODES, "universal_kriging", **options)
    assert words in str(raised.value)


COORDINATE = st.one_of(st.integers(-3, 3), st.floats(-1e3, 1e3))
SETS = st.lists(st.tuples(COORDINATE, COORDINATE, st.floats(-100, 100)), min_size=1, max_size=25)


@example([(0, 0, 0.0), (0, 5e-324, 0.0)], "linear", 0)
@example([(k * 1e-155, k * k * 1e-155, k % 2) for k in range(9)], "quadratic", 0)
@settings(max_examples=60, deadline=None)
@given(SETS, st.sampled_from(["constant", "linear", "quadratic"]), st.sampled_from([0, 5]))
def test_any_points_give_heights_or_are_refused_as_contradicting(points, drift, neighbours):
    method = "kriging" if drift == "constant" else "universal_kriging"
    options = {} if drift == "constant" else {"drift": drift}
    nodes = np.array([[0, 0], [0.5, -1], [1e3, 1e3], [1e-9, 0]])
    try:
        result = interpolate(np.array(points, float), nodes, method, neighbours=neighbours, **options)
    except InputRefused as error:
        assert "the same position in plan" in str(error)
        return
    assert np.isfinite(result.z).all()
    assert result.variance is None or (result.variance >= 0).all()  # few or equal points show none
    assert isinstance(result.variogram, Variogram)


def test_a_trend_that_the_method_lacks_is_a_warning():
    steep = np.column_stack([PLAN, PLAN[:, 0] - UTM[0] + RNG.normal(0, 30, len(PLAN))])
    warnings = interpolate(steep, NODES).warnings
    assert len(warnings) == 1
    assert "far exceeds the extent of the points" in warnings[0]
    assert "universal kriging" in warnings[0]
    warnings = interpolate(steep, NODES, method="universal_kriging").warnings
    assert not any("range" in text for text in warnings)
