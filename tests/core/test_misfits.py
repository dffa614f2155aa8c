# SPDX-License-Identifier: GPL-3.0-or-later
"""The list of data that a model does not honor."""

from dataclasses import replace

import numpy as np
from realmodel.core import Dips, Observations, Project, Rock, Series, SpaceDips, Surface, build

SQUARE = [[0, 0], [10, 0], [10, 10], [0, 10]]


def model(observations=None, dips=None, method="plane", picks=None, points=None):
    """A clay below 4 + x / 2, a sand below 10, which need not go through their data: of the clay five points,
    one of them not on the plane."""
    if points is None:
        points = [(x, y, 4 + x / 2) for x in (1, 9) for y in (1, 9)]
    clay = Surface("clay", points=np.array(points, float), method=method, dips=dips, tie=False)
    sand = Surface("sand", method="constant", options={"value": 10.0}, tie=False)
    rock = Rock("rock", [clay, sand], SQUARE, edge_length=2.5, base_elevation=0.0, observations=observations)
    rock.hole_picks = picks or {}
    return build(Project("fit", [rock]))


def test_what_fits_is_not_listed():
    seen = Observations([[2, 2, 3], [2, 2, 8]], ["base block", "sand"])
    assert model(seen).misfits() == []


def test_points_off_their_surface_come_with_their_hole():
    points = [(1, 1, 4), (9, 1, 4), (1, 9, 4), (9, 9, 4), (5, 5, 5)]
    picks = {"B7": (np.array([5.0, 5, 12]), [("clay", np.array([5.0, 5, 5]))])}
    made = model(points=points, picks=picks)
    found = made.misfits()
    assert [each.kind for each in found] == ["point"] * 5
    worst = found[0]
    assert (worst.hole, worst.depth, worst.row, worst.place) == ("B7", 7.0, 4, (5.0, 5.0, 5.0))
    assert (worst.name, worst.says) == ("clay", "5")
    assert np.isclose(worst.by, 0.8) and worst.has == "4.2, 0.8 below"
    assert found[1].has == "4.2, 0.2 above" and found[1].hole == ""
    assert len(made.misfits(tolerance=0.5)) == 1


def test_holes_at_one_place_are_told_apart():
    """Each pick is a point of its own, with its own hole; so is each row of a table."""
    points = [(1, 1, 4), (9, 1, 4), (1, 9, 4), (9, 9, 4), (5, 5, 5), (5, 5, 5)]
    met = [("clay", np.array([5.0, 5, 5]))]
    picks = {"B7": (np.array([5.0, 5, 12]), met), "B8": (np.array([5.0, 5, 13]), met)}
    found = [each for each in model(points=points, picks=picks).misfits() if each.hole]
    assert sorted((each.hole, each.depth, each.row) for each in found) == [("B7", 7.0, 4), ("B8", 8.0, 5)]


def test_bounds_and_blocks():
    seen = Observations([[5, 5, 8.0], [2, 2, 1]], ["base block", "sand"])
    found = model(seen).misfits()
    assert [each.kind for each in found] == ["bound", "bound", "block", "block"]
    assert (found[0].says, found[0].has) == ("clay at or below 1", "4 above")
    assert np.isclose(found[0].by, 4.0) and np.isclose(found[1].by, 1.5)
    first, second = sorted(found[2:], key=lambda each: each.row)
    assert (first.row, first.says, first.has, first.by) == (0, "base block", "sand block", 0.0)
    assert (second.says, second.has) == ("sand", "base block")


def test_intervals_say_how_much_of_them_is_elsewhere():
    seen = Observations(
        [[5, 5, 10], [5, 5, 8.5], [5, 5, 8.5], [5, 5, 2]],
        ["sand", "sand", "clay", "clay"],
        ["B1"] * 4,
        [0, 1.5, 1.5, 8],
    )
    found = [each for each in model(seen).misfits(tolerance=0.5) if each.kind == "block"]
    assert len(found) == 1, found
    only = found[0]
    assert (only.hole, only.depth, only.place) == ("B1", 1.5, (5.0, 5.0, 8.5))
    assert only.end == (5.0, 5.0, 2.0)
    assert only.says == "clay to 8" and only.has.endswith("most in sand block")
    assert abs(only.by - 2.0) < 0.5


def test_dips_are_compared_with_the_surface():
    dips = Dips([[5.0, 5.0], [2.5, 5.0], [9.0, 1.0]], [[0.5, 0.0], [-0.5, 0.0], [0.0, 0.0]]).checked()
    made = model()  # a plane, which takes no dips; beside it these would be honored
    (entry,) = made.rock_inputs
    entry.rock.surfaces[0].dips = dips
    entry.data[0] = replace(entry.data[0], dips=dips)
    found = [each for each in made.misfits(dip_tolerance=1.0) if each.kind == "dip"]
    assert [each.row for each in found] == [1, 2], "the first fits; the second dips to the other side"
    assert (found[0].says, found[0].has) == ("090/27", "270/27, 53° off")
    assert np.isclose(found[0].by, 2 * np.degrees(np.arctan(0.5)), atol=1e-6)
    assert (found[1].says, found[1].has) == ("000/00", "270/27, 27° off")
    assert np.isclose(found[1].place[2], 4 + 9 / 2)
    assert [each for each in made.misfits(dip_tolerance=89.0) if each.kind == "dip"] == []


def test_switched_off_data_are_not_listed_and_what_is_left_out_is():
    seen = Observations([[5, 5, 8.0], [2, 2, 1]], ["base block", "gneiss"], used=[False, True])
    found = model(seen).misfits()
    assert [(each.kind, each.name, each.by) for each in found] == [("left_out", "gneiss", None)]
    assert "no block, surface or body" in found[0].has
    assert found[0].place == (2.0, 2.0, 1.0)


def field_model(last_is_used):
    """Two beds that dip to the west, with dips along them and one across them, which may be switched off."""
    places = np.array([(x, y, 4.0 + x / 2) for x in (1.0, 5, 9) for y in (1.0, 5, 9)])
    normals = np.tile([-0.5, 0.0, 1.0], (len(places), 1))
    dips = SpaceDips(
        np.vstack([places + np.array([0.0, 0.0, 0.5]), (5.0, 5.0, 6.0)]),
        np.vstack([normals, (0.0, 2.0, 1.0)]),
        np.append(np.ones(len(places), bool), last_is_used),
    )
    lower = Surface("lower", points=places, series="beds")
    upper = Surface("upper", points=places + np.array([0.0, 0.0, 2.0]), series="beds")
    ground = Surface("ground", method="constant", options={"value": 10.0})
    rock = Rock("rock", [lower, upper, ground], SQUARE, edge_length=2.5, base_elevation=0.0)
    rock.series = [Series("beds", dips=dips, resolution=1.0)]
    return build(Project("beds", [rock]))


def test_dips_of_a_field():
    assert field_model(False).misfits() == []
    (found,) = field_model(True).misfits(dip_tolerance=20.0)
    assert (found.kind, found.name, found.row, found.place) == ("dip", "beds", 9, (5.0, 5.0, 6.0))
    assert found.says == "000/63" and found.by > 20.0


def test_contacts_off_their_level_set():
    """They were moved after the build."""
    made = field_model(False)
    made.rock_inputs[0].rock.surfaces[0].points[0] += (0.0, 0.0, 0.6)
    (found,) = made.misfits()
    assert (found.kind, found.name, found.row, found.says) == ("point", "lower", 0, "on it")
    assert found.has.endswith("on its younger side")
    assert np.isclose(found.by, 0.6 / np.sqrt(1.25), rtol=0.05)
