# SPDX-License-Identifier: GPL-3.0-or-later
"""The order of surfaces in age, found from their points."""

import itertools
import tomllib
from pathlib import Path

import numpy as np
import pytest
from realmodel.core.surfaces.age_order import _against, age_order, improved

DATA = Path(__file__).resolve().parents[3] / "shared" / "data"


def names_in_order(names, points, holes=None):
    return [names[n] for n in age_order(names, points, holes).order]


def basin(seed=3):
    """Picks of 13 tops in 67 wells, s0 the youngest. They dip by 0.3, and the older a top is, the farther up
    dip it was met: the mean heights of the picks are in another order than the tops."""
    rng = np.random.default_rng(seed)
    wells = np.round(rng.random((67, 2)) * 10_000, 2)
    tops = []
    for number in range(13):
        z = 0.3 * wells[:, 0] - 40.0 * number + 5.0 * rng.standard_normal(67)
        met = wells[:, 0] > 500.0 * number
        tops.append(np.column_stack([wells, z])[met])
    return [f"s{number}" for number in range(13)], tops


def test_shared_wells_decide_not_mean_heights():
    names, tops = basin()
    means = [names[n] for n in np.argsort([top[:, 2].mean() for top in tops])]
    assert means != names[::-1]
    assert names_in_order(names, tops) == names[::-1]
    assert names_in_order(names[::-1], tops[::-1]) == names[::-1]
    shuffled = np.random.default_rng(1).permutation(13)
    assert names_in_order([names[n] for n in shuffled], [tops[n] for n in shuffled]) == names[::-1]


def test_what_contradicts_is_counted():
    names, tops = basin()
    tops[3][:4, 2] -= 60.0  # below s4, not s5
    found = age_order(names, tops)
    assert [names[n] for n in found.order] == names[::-1]
    met = {tuple(place) for place in tops[4][:, :2].tolist()}
    wrong = sum(tuple(place) in met for place in tops[3][:4, :2].tolist())
    assert wrong > 0
    assert found.against == {(4, 3): wrong}
    shared = sum(
        len({*map(tuple, a[:, :2])} & {*map(tuple, b[:, :2])}) for a, b in itertools.combinations(tops, 2)
    )
    assert found.places == shared
    text = found.warning(names)
    assert text.startswith(f"at {wrong} of {shared} places")
    assert f"'s4' above 's3' at {wrong}" in text
    assert age_order(*basin()).warning(names) is None


def test_names_decide_where_points_do_not():
    nowhere = [np.array([[0.0, 0.0, 5.0]])] * 4
    assert names_in_order(["s10", "s2", "s1", "S3"], nowhere) == ["s1", "s2", "S3", "s10"]
    z = {"s1": 9.0, "s2": 5.0, "s3": 5.0, "s10": 1.0}  # they count down
    names = ["s2", "s10", "s3", "s1"]
    assert names_in_order(names, [np.array([[0.0, 0.0, z[n]]]) for n in names]) == ["s10", "s3", "s2", "s1"]


def test_without_shared_places_the_common_dip_is_taken_out():
    """The older surface is known up the dip only: its points lie higher than all of the younger one."""
    x, y = (a.ravel() for a in np.meshgrid(np.arange(20.0), np.arange(10.0)))
    old = np.column_stack([x + 15.0, y, 2.0 * (x + 15.0)])
    young = np.column_stack([x + 0.5, y + 0.5, 2.0 * (x + 0.5) + 1.0])
    assert young[:, 2].mean() < old[:, 2].mean() - 20.0
    assert names_in_order(["young", "old"], [young, old]) == ["old", "young"]
    assert age_order(["young", "old"], [young, old]).against == {}


def test_a_shared_place_counts_more_than_neighbors():
    a = np.array([[0.0, 0.0, 1.0]])
    b = np.array([[0.0, 0.0, 2.0], *([x, 5.0, 0.0] for x in range(1, 9))])
    assert names_in_order(["b", "a"], [b, a]) == ["a", "b"]


def test_picks_of_deviated_holes():
    """In each hole the top is met above the base, but elsewhere in plan, where the next hole has its base
    higher."""
    holes = {
        f"B{n}": (
            (100.0 * n, 0.0, 0.0),
            [("top", (100.0 * n + 49.0, 0, -50.0 * n)), ("base", (100.0 * n, 0, -50.0 * n - 20))],
        )
        for n in range(4)
    }
    points = {
        name: np.array([p for _, picks in holes.values() for s, p in picks if s == name])
        for name in ("top", "base")
    }
    found = age_order(["top", "base"], [points["top"], points["base"]], holes)
    assert (found.order, found.places, found.against) == ((1, 0), 4, {})


def test_a_surface_without_points_keeps_its_place():
    a, b = np.array([[0.0, 0.0, 9.0]]), np.array([[0.0, 0.0, 1.0]])
    assert names_in_order(["flat", "a", "later", "b"], [None, a, np.empty((0, 3)), b]) == [
        "flat",
        "b",
        "later",
        "a",
    ]
    assert age_order([], []).order == ()
    assert age_order(["a"], [a]).order == (0,)


def test_equal_heights_say_nothing():
    a = np.array([[0.0, 0.0, 9.0], [1.0, 0.0, 9.0]])
    b = np.array([[0.0, 0.0, 9.0], [1.0, 0.0, 8.0]])
    found = age_order(["a", "b"], [a, b])
    assert (found.order, found.places, found.against) == ((1, 0), 1, {})


@pytest.mark.parametrize("seed", range(20))
def test_the_fewest_contradictions_of_all_orders(seed):
    """Against every order of six surfaces, where a fifth of the places is wrong."""
    rng = np.random.default_rng(seed)
    tops = [
        np.column_stack([np.arange(30.0), np.zeros(30), k + 0.8 * rng.standard_normal(30)]) for k in range(6)
    ]
    names = [f"n{k}" for k in rng.permutation(6)]
    found = age_order(names, tops)
    below = np.array([[int((a[:, 2] < b[:, 2]).sum()) for b in tops] for a in tops])
    fewest = min(_against(below, order) for order in itertools.permutations(range(6)))
    assert sum(found.against.values()) == fewest == _against(below, found.order)
    assert _against(below, improved(below, list(range(6))[::-1])) == fewest


def test_real_picks():
    """Holes in which each surface is observed where it is there: the mean heights put the basement first."""
    folder = DATA / "field" / "geoinr_observations"
    if not folder.is_dir():
        pytest.skip("the data in ../shared/data are not here")
    surfaces = tomllib.loads((folder / "project.toml").read_text())["rock"][0]["surface"]
    names = [surface["name"] for surface in surfaces]
    points = []
    for surface in surfaces:
        table = np.genfromtxt(folder / surface["points"], delimiter=",", names=True)
        points.append(np.column_stack([table[axis] for axis in "xyz"]))
    assert list(np.argsort([p[:, 2].mean() for p in points])) != list(range(len(names)))
    assert names_in_order(names[::-1], points[::-1]) == names
