# SPDX-License-Identifier: GPL-3.0-or-later
"""Intervals of inclined holes between the places of their ends: where they cross edges of the planar mesh."""

import numpy as np
from realmodel.core import Observations, Project, Rock, Surface, build
from realmodel.core.base.triangles import Sheet
from realmodel.core.results.surface_quality import heights_of_points
from realmodel.core.surfaces.observed.edge_crossings import with_crossings

SQUARE = [[0, 0], [10, 0], [10, 10], [0, 10]]
NODES = np.array([[0, 0], [4, 0], [4, 4], [0, 4.0]])
MESH = Sheet(NODES, np.array([[0, 1, 2], [0, 2, 3]], np.int32))


def seen(places, holes, **more):
    depths = np.arange(len(places), dtype=float)
    return Observations(places, ["sand"] * len(places), holes, depths, **more)


def test_an_interval_gets_a_place_at_each_edge_that_it_crosses():
    given = seen([[-1, 1, 4], [3, 1, 0], [3, 1, -9], [3, 3, -9]], ["B1", "B1", "B2", "B2"])
    found, is_given = with_crossings(given, MESH)
    assert is_given.tolist() == [True, False, False, True, True, True]  # B2 ends on the edge between
    assert found.holes.tolist() == ["B1"] * 4 + ["B2"] * 2
    np.testing.assert_allclose(found.places[1:3], [[0, 1, 3], [1, 1, 2]], atol=1e-8)
    np.testing.assert_allclose(found.depths[1:3], [0.25, 0.5], atol=1e-8)
    assert 0 < found.places[1, 0] < 1e-8  # inside, whatever is rounded
    again, is_given = with_crossings(found, MESH)
    assert is_given.all() and len(again) == len(found)


def test_what_is_vertical_switched_off_or_of_two_intervals_gets_none():
    places = [[3, 1, 4], [3, 1, 0], [0, 2, 0], [2, 0, 0], [0, 2, 1], [2, 0, 1]]
    holes = ["B1", "B1", "B2", "B2", "B3", "B3"]
    found, _ = with_crossings(
        seen(places, holes, intervals=[0, 0, 1, 2, 3, 3], used=[True] * 4 + [False] * 2), MESH
    )
    assert found.places.tolist() == places
    assert len(with_crossings(seen(places, holes, intervals=[0, 0, 1, 2, 3, 3]), MESH)[0]) == 7


def test_a_surface_keeps_off_the_whole_of_an_inclined_hole():
    """A hole passes a valley of the top of the clay: at its ends alone the hole would leave it by 2.4."""
    ends = np.array([[1.0, 4.3, 5.0], [9.0, 5.2, 5.6]])
    hole = Observations(ends, ["clay"] * 2, ["B1"] * 2, [0.0, 9.0])
    points = [[0, 0, 7], [10, 0, 7], [0, 10, 7], [10, 10, 7], [5, 2, 3], [5, 8, 3], [0, 5, 7], [10, 5, 7]]
    top = Surface("S1", points=points, method="spline", block="clay")
    low = Surface("S0", method="constant", options={"value": 0.0})
    rock = Rock("r", [low, top], region=SQUARE, edge_length=1.0, base_elevation=-5.0, observations=hole)
    model = build(Project("p", [rock]))
    assert len(model.project.rocks[0].observed) == 2
    share = np.linspace(0, 1, 5001)[:, None]
    way = (1 - share) * ends[0] + share * ends[1]
    above = heights_of_points(model, 1, 1, 0, way) - way[:, 2]
    assert -1e-8 < above.min() < 1e-4
    assert not model.observed().violated
