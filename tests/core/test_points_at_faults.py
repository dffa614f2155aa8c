# SPDX-License-Identifier: GPL-3.0-or-later
"""Points on faults or next to them belong to the side whose other points they agree with."""

import numpy as np
import pytest
from realmodel.core import Fault, Project, Rock, Surface, build
from realmodel.core.residuals import residuals
from realmodel.core.structures.displacement import displacements
from realmodel.core.structures.points_at_faults import point_sides
from realmodel.core.work import run
from structure_cases import plane_fault

METHODS = ("kriging", "natural_neighbour", "dsi")


def level(x, y):
    return 0.0 * x


def tilted(x, y):
    return 0.3 * x + 0.2 * y


def dome(x, y):
    return np.cos((x - 5) / 3) * np.cos((y - 5) / 3)


def horizon(shape=level, lips="both", shift=0.0, lean=0.5, throw=1.0):
    """Points of a horizon that a fault x = 5 - lean * z displaces, 0.25 and more away from it, and of its
    lips, `shift` away from the fault along x."""
    points = []
    for x in np.arange(0, 10.01, 0.75):
        for y in np.arange(0, 10.01, 1.0):
            for side, z in ((-1, shape(x, y)), (1, shape(x, y) - throw)):
                if side * (x - (5 - lean * z)) >= 0.25:
                    points.append((x, y, z))
    for y in np.arange(0, 10.01, 1.0):
        for name, down in (("lower", 0.0), ("upper", throw)):
            if lips in ("both", name):
                x = 5.0
                for _ in range(60):  # the fixed point of the two equations
                    x = 5 - lean * (shape(x, y) - down)
                points.append((x + shift, y, shape(x, y) - down))
    return np.array(points)


def built(points, method="kriging", lean=0.5):
    surface = Surface("top", points=points, method=method)
    region = [[0, 0], [10, 0], [10, 10], [0, 10]]
    rock = Rock("r", [surface], region=region, edge_length=0.8, base_elevation=-5.0)
    return build(Project("p", [rock], faults=[Fault("F", *plane_fault(lean=lean, z=(-9.0, 9.0)))]))


def throws(model):
    (found,) = displacements(model)
    assert len(found.throw) > 20
    return found.throw


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize(
    ("lips", "shift"),
    [
        ("both", 0.0),
        ("lower", 0.0),
        ("upper", 0.0),
        ("both", 1e-9),
        ("both", -1e-9),
        ("both", 0.02),
        ("lower", -0.02),
    ],
)
def test_lips_do_not_change_the_throw(lips, shift, method):
    model = built(horizon(lips=lips, shift=shift), method)
    assert throws(model) == pytest.approx(1.0, abs=0.05)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize(
    ("shape", "lean", "throw", "expected"),
    [
        (level, 0.0, 1.0, 1.0),  # both lips are at one place in plan
        (level, -0.5, 1.0, -1.0),  # reverse: the upper side is in the west
        (level, 2.0, 1.0, 1.0),
        (level, 0.5, -1.0, -1.0),
        (tilted, 0.5, 1.0, 1 / 1.15),  # the lips are apart along the dip, too
        (dome, 0.5, 1.0, 1.0),
        (dome, 0.5, 0.3, 0.3),
    ],
)
def test_lips_of_other_faults_and_shapes(shape, lean, throw, expected, method):
    model = built(horizon(shape, "both", 0.0, lean, throw), method, lean)
    assert throws(model) == pytest.approx(expected, abs=0.05 * max(abs(expected), 0.5))


def test_points_that_are_not_on_their_side_are_counted():
    model = built(horizon(shift=0.02))
    (text,) = [warning.text for warning in model.warnings if "just beyond" in warning.text]
    assert text.startswith("11 of its ") and "fault 'F'" in text and "(5.02, 0, 0)" in text
    assert not [warning for warning in built(horizon(lips="none")).warnings if "just beyond" in warning.text]


def test_residuals_take_the_same_sides():
    (found,) = residuals(built(horizon(shift=0.02)))
    assert np.abs(found.values).max() < 1e-6


def test_position_decides_where_only_one_side_has_points():
    points = horizon(lips="none")
    west = points[points[:, 0] < 5]
    alone = np.array([[5.01, 3.0, 0.0], [5.01, 6.0, 0.0]])
    model = built(np.concatenate([west, alone]))
    assert not [warning for warning in model.warnings if "just beyond" in warning.text]


def test_the_order_of_points_does_not_count():
    """The heights of kriging depend on it where neighbors are equally near; the sides do not."""
    points = horizon(dome, "both", 1e-9)
    order = np.random.default_rng(3).permutation(len(points))
    (entry,) = built(points).rock_inputs
    first, second = (
        run(lambda work, own=own: point_sides(work, own, entry, 0)) for own in (points, points[order])
    )
    assert first.moved.any() and first.reach == second.reach
    for one, other in zip(first[:2], second[:2], strict=True):
        np.testing.assert_array_equal(one[order], other)
