# SPDX-License-Identifier: GPL-3.0-or-later
"""Lines in plan through boreholes, and fences along them."""

import numpy as np
import pytest
from conftest import grid_surface
from object_models import logged_model
from realmodel.core import InputRefused, Observations, Project, Rock, Surface, UsageError, build
from realmodel.core.results.sections.section_holes import hole_places, line_through

PLACES = {name: np.array(place) for name, place in (("A", (0, 0, 9)), ("B", (30, 40, 8)), ("C", (30, 90, 7)))}


def test_the_line_goes_through_holes_in_their_order_and_beyond():
    assert line_through(PLACES, ["A", "B"], 10).tolist() == [[-6, -8], [36, 48]]
    assert np.allclose(line_through(PLACES, ["C", "B", "A"]), [[30, 95], [30, 40], [-3, -4]])
    assert line_through(PLACES, ["A", "C", "C", "A"], 0).tolist() == [[0, 0], [30, 90], [0, 0]]


def test_what_is_no_line_is_refused():
    with pytest.raises(InputRefused, match=r"there is no hole X and Y.*holes: A, B and C"):
        line_through(PLACES, ["A", "X", "Y"])
    with pytest.raises(InputRefused, match="at two places"):
        line_through(PLACES, ["B", "B"])
    with pytest.raises(UsageError, match="0 or more"):
        line_through(PLACES, ["A", "B"], -1)


def test_a_fence_of_a_model_stands_on_its_holes(write):
    model = logged_model(write)
    found = model.fence_through_holes(["L2", "L3", "L1"], extend=5.0)
    assert found.polyline[1].tolist() == [50, 60]
    assert np.linalg.norm(found.polyline[0] - (80, 30)) == pytest.approx(5)
    assert np.linalg.norm(found.polyline[2] - (20, 20)) == pytest.approx(5)
    assert set(found.panel) == {0, 1}
    hole = model.borehole(50, 60)  # the fence has at its bend what the hole meets
    at = np.isclose(found.vertices[:, :2], (50, 60), atol=1e-9).all(axis=1)
    for each in hole:
        assert np.isclose(found.vertices[at, 2], each.top, atol=1e-6).any()
    with pytest.raises(InputRefused, match="no hole L9"):
        model.fence_through_holes(["L1", "L9"])


def test_holes_that_are_only_observed_count():
    flat = [Surface(f"S{k}", *grid_surface(2, lambda x, y, k=k: 4.0 * k + 0 * x, 10.0)) for k in range(2)]
    flat.append(Surface("S2", method="constant", options={"value": 8.0}))
    square = [[0, 0], [10, 0], [10, 10], [0, 10]]
    places = [[2, 2, 8], [2, 2, 4], [7, 5, 8], [7, 5, 4]]
    seen = Observations(places, ["S2"] * 4, ["H1", "H1", "H2", "H2"])
    model = build(Project("x", [Rock("r", flat, square, edge_length=5, observations=seen)]))
    assert {name: place.tolist() for name, place in hole_places(model.project).items()} == {
        "H1": [2, 2, 8],
        "H2": [7, 5, 8],
    }
    assert model.fence_through_holes(["H1", "H2"], 0).length == pytest.approx(np.hypot(5, 3))
