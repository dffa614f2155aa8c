# SPDX-License-Identifier: GPL-3.0-or-later
"""Points on faults or next to them belong to the side whose other points they agree with."""

import displaced_surfaces as surfaces
import numpy as np
import pytest
from displaced_surfaces import Displacing, dome, height, leaning, level, points_and_sides
from displaced_surfaces import built as built_with
from realmodel.core import Fault, Project, Rock, Surface, build
from realmodel.core.base.work import run
from realmodel.core.results.displacements import displacements
from realmodel.core.results.surface_quality import residuals
from realmodel.core.structures.sheets.points_at_faults import point_sides
from structure_cases import plane_fault

METHODS = ("kriging", "natural_neighbour", "dsi", "universal_kriging", "idw", "spline", "tin", "auto")


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
    assert len(found.throw) > 10
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


@pytest.mark.parametrize("method", METHODS[:3])
@pytest.mark.parametrize(
    ("shape", "lean", "throw", "expected"),
    [
        (level, 0.0, 1.0, 1.0),  # both lips are at one place in plan
        (level, -0.5, 1.0, -1.0),  # reverse: the upper side is in the west
        (level, 2.0, 1.0, 1.0),
        (level, 0.5, -1.0, -1.0),
        (surfaces.tilted, 0.5, 1.0, 1 / 1.15),  # the lips are apart along the dip, too
        (dome, 0.5, 1.0, 1.0),
        (dome, 0.5, 0.3, 0.3),
    ],
)
def test_lips_of_other_faults_and_shapes(shape, lean, throw, expected, method):
    model = built(horizon(shape, "both", 0.0, lean, throw), method, lean)
    # natural neighbors bend at each point, by as much whatever the throw
    least = 1.0 if method == "natural_neighbour" else 0.5
    assert throws(model) == pytest.approx(expected, abs=0.06 * max(abs(expected), least))


def are_wrong(faults, points, sides):
    """(P, F) bool: the points that are not taken for their side of a fault, -1 west or 1 east."""
    model = built_with(faults, Surface("top", points=points, method="idw"))
    found = run(lambda work: point_sides(work, points, model.rock_inputs[0], 0)).sides
    west_is_below = [fault.at(0.0, 1.0) <= fault.at(0.0, 0.0) for fault in faults]
    return found * np.where(west_is_below, 1, -1) != sides


@pytest.mark.parametrize("shift", [0.0, 1e-9, 0.01, -0.01])
@pytest.mark.parametrize("shape", [level, surfaces.tilted, dome, surfaces.folded])
@pytest.mark.parametrize(
    "faults",
    [
        [Displacing("F", leaning())],
        [Displacing("F", leaning()), Displacing("G", leaning(lean=0.3, turn=0.8), 0.6)],  # they cross
        [Displacing("F", leaning(3.5)), Displacing("G", leaning(6.5, lean=-0.5), -1.0)],  # a graben
        [Displacing("F", lambda y, z: 5 - 0.5 * z + 0.4 * np.sin(y), lines=(61, 2))],
    ],
)
def test_lips_are_of_the_side_that_they_agree_with(faults, shape, shift):
    """Also where the sheet is folded, so that no plane lets expect it."""
    steps = (0.25, 0.25) if shape is surfaces.folded else (0.75, 1.0)
    assert not are_wrong(faults, *points_and_sides(shape, faults, 0.5, shift, steps)).any()


@pytest.mark.parametrize("shift", [0.0, 0.02, -0.02])
@pytest.mark.parametrize(("lips", "steps"), [(0.01, (0.75, 1.0)), (0.02, (2.5, 2.5)), (0.1, (2.5, 2.5))])
def test_lips_much_denser_than_the_other_points(lips, steps, shift):
    """Their own spacing is no measure of how far they may be from the fault."""
    faults = [Displacing("F", leaning())]
    assert not are_wrong(faults, *points_and_sides(dome, faults, lips, shift, steps)).any()


@pytest.mark.parametrize("shape", [level, surfaces.tilted, dome])
@pytest.mark.parametrize("shift", [0.0, 0.02, -0.02])
def test_a_graben_of_which_only_the_lips_are_known(shift, shape):
    faults = [Displacing("F", leaning(4.6)), Displacing("G", leaning(5.6, lean=0.2), -1.0)]
    points, sides = points_and_sides(shape, faults, lips=0.5)
    x, y, z = points.T
    off = np.array([x - fault.at(y, z) for fault in faults])
    is_lip = (np.abs(off) < 1e-6).any(axis=0)
    points[is_lip, 0] += shift
    given = is_lip | (off[0] < 0) | (off[1] > 0)
    assert not are_wrong(faults, points[given], sides[given]).any()


def test_points_beyond_a_fault_do_not_decide_about_those_near_it():
    """Picks of both sides overlap there, as in real data; lips are of the side that the others know."""
    faults = [Displacing("F", leaning())]
    points, sides = points_and_sides(dome, faults, lips=0.25, steps=(0.25, 0.25))
    x, y, z = points.T
    some = np.random.default_rng(1).random(len(x)) < 0.5
    over = [np.column_stack([x, y, height(dome, faults, [side], x, y)])[some] for side in (-1, 1)]
    over = [each[np.abs(each[:, 0] - leaning()(each[:, 1], each[:, 2])) < 0.6] for each in over]
    every = np.concatenate([points, *over])
    wrong = are_wrong(
        faults, every, np.concatenate([sides[:, 0], np.zeros(len(every) - len(points))])[:, None]
    )
    is_lip = np.abs(x - leaning()(y, z)) < 1e-6
    assert is_lip.sum() > 60 and wrong[: len(points), 0][is_lip].mean() < 0.1


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
