# SPDX-License-Identifier: GPL-3.0-or-later
"""Observations that contradict one another are listed with the others, and the fewest are left out."""

import numpy as np
from realmodel.core import Observations, Project, Rock, Surface, build

SQUARE = [[0, 0], [100, 0], [100, 100], [0, 100]]


def model_of(rows, points):
    """rows: (x, y, z, block, hole) of places in clay above sand."""
    places = np.array([row[:3] for row in rows], float)
    blocks, holes = (np.array([row[k] for row in rows]) for k in (3, 4))
    depths = 100 - places[:, 2]
    surfaces = [
        Surface("top of sand", block="sand", points=points, method="kriging"),
        Surface("ground", block="clay", points=[[*corner, 90.0] for corner in SQUARE], method="plane"),
    ]
    observations = Observations(places, blocks, holes, depths)
    rock = Rock("r", surfaces, region=SQUARE, edge_length=20.0, base_elevation=0.0, observations=observations)
    return build(Project("p", [rock]))


POINTS = np.array([[10.0, 10, 50], [90, 10, 52], [90, 90, 50], [10, 90, 48], [50, 50, 50]])


def test_a_bound_that_contradicts_a_point_is_listed_with_it():
    # sand at 60 says that its top is above, the point at the same position that it is at 50
    found = model_of([(50, 50, 60, "sand", "A"), (30, 70, 55, "sand", "B")], POINTS).observed()
    ((rock, each),) = found.left_out
    assert (rock, each.kind, each.hole, each.depth) == ("r", "contradiction", "A", 40.0)
    assert each.place == (50.0, 50.0, 60.0)
    assert each.contradicts == ("(50, 50, 50): 'top of sand' lies at 50",)
    assert each.text.startswith(
        "hole 'A' at 40: 'top of sand' lies at or above 60, which contradicts (50, 50, 50)"
    )
    assert "A" not in [violated.hole for violated in found.violated]


def test_of_holes_that_contradict_the_fewest_are_left_out():
    # at one position three holes say that sand ends below 40, one that it reaches 60
    rows = [(30, 70, 40 - k, "clay", name) for k, name in enumerate("ABC")] + [(30, 70, 60, "sand", "D")]
    model = model_of(rows, POINTS)
    found = model.observed()
    ((_, each),) = [pair for pair in found.left_out if pair[1].kind == "contradiction"]
    assert each.hole == "D"
    said = [
        f"hole '{name}' at {60 + k}: 'top of sand' lies at or below {40 - k}" for k, name in enumerate("ABC")
    ]
    assert list(each.contradicts) == said
    assert any(warning.kind == "contradiction" and "hole 'D'" in warning.text for warning in model.warnings)


def test_the_number_counts_and_not_the_side():
    rows = [(30, 70, 60 + k, "sand", name) for k, name in enumerate("ABC")] + [(30, 70, 40, "clay", "D")]
    left_out = [each.hole for _, each in model_of(rows, POINTS).observed().left_out]
    assert left_out == ["D"]


def test_without_contradictions_nothing_is_left_out():
    found = model_of([(30, 70, 40, "sand", "A"), (30, 70, 60, "clay", "B")], POINTS).observed()
    assert found.left_out == []
    assert found.bounds > 0
