# SPDX-License-Identifier: GPL-3.0-or-later
"""Where sheets are looked at beside faults: in every part that other faults leave, however small."""

from collections import Counter

import numpy as np
import pytest
from realmodel.core import Fault, Project, Rock, Surface, build
from realmodel.core.base.triangles import overlapping_pairs
from realmodel.core.base.work import Work, run
from realmodel.core.structures.sheets import interpolated_sheets
from realmodel.core.structures.sheets.between_sheets import common_lines, places_between
from realmodel.core.structures.sheets.families import around_tips, families, parting, parts_of_lines
from realmodel.core.structures.sheets.interpolated_sheets import InterpolatedSurface
from realmodel.core.structures.sheets.tips import _Drawn, _meet_within, _near, _places_of, blended
from realmodel.core.surfaces.rock_structure import RockFaults, RockStructure, sides_of
from structure_cases import SQUARE, plane_fault, prepared


class Between:
    """The compartment between two vertical planes across x."""

    def __init__(self, low, high):
        self.low, self.high = low, high

    def __call__(self, points):
        return (points[:, 0] > self.low) & (points[:, 0] < self.high)

    def walls(self, box):
        planes = (plane_fault(x, z=(-50.0, 50.0), y=(-50.0, 50.0)) for x in (self.low, self.high))
        return np.concatenate([vertices[triangles] for vertices, triangles in planes])


LEVEL = np.array([[0.0, 0, 0], [10, 0, 0], [5, 9, 0]])


@pytest.mark.parametrize(("low", "high"), [(4.0, 4.0001), (1.23456, 1.2346), (9.99444, 20.0)])
def test_triangles_meet_in_a_narrow_compartment(low, high):
    upright = np.array([[[-20.0, 0.01, -30], [40, 0.01, -30], [5, 0.01, 40]]])
    assert _meet_within(LEVEL[None], upright, Between(low, high)).all()
    assert not _meet_within(LEVEL[None], upright + np.array([0, 9, 0]), Between(low, high)).any()


def test_lines_in_the_plane_of_a_triangle_are_divided_where_they_leave_it():
    line, shares = parts_of_lines(np.array([[-1.0, 3, 0]]), np.array([[11.0, 3, 0]]), LEVEL[None])
    assert line.tolist() == [0, 0, 0]
    assert shares.mean(axis=1) == pytest.approx([(8 / 3) / 24, 0.5, 1 - (8 / 3) / 24])


@pytest.mark.parametrize(("height", "is_torn"), [(1.5, True), (0.5, False), (2.5, False)])
def test_what_lies_between_two_sheets_tears_them(height, is_torn):
    """Of three pairs of triangles the last two: it passes beside the first one."""
    low = LEVEL + np.array([[[100.0, 0, 1]], [[0, 0, 1]], [[1, 0, 1]]])
    high = low + np.array([0, 0, 1.0])
    level = np.array([[[-20.0, -20, height], [40, -20, height], [5, 60, height]]])
    for pair in ((low, high), (high, low)):
        number, places = places_between(*pair, level, Between(5.0, 5.001))
        assert set(number.tolist()) == ({1, 2} if is_torn else set())
        assert len(places) == len(number) and (places[:, 2] == height).all()
        assert Between(5.0, 5.001)(places).all()
    assert not len(places_between(low, high, level, Between(11.5, 12.0))[0])


def test_what_only_touches_one_of_two_sheets_lies_not_between_them():
    low = LEVEL[None] + np.array([0, 0, 1.0])
    high = low + np.array([[[0, 0, 1e-12], [0, 0, 1e-12], [0, 0, 1.0]]])
    upright = np.array([[[-20.0, 0.0, -30], [40, 0.0, -30], [5, 0.0, 40]]])
    assert not len(places_between(low, high, upright, Between(-9.0, 19.0))[0])
    number, places = places_between(low, high, upright + np.array([0, 0.1, 0]), Between(-9.0, 19.0))
    assert (number == 0).all() and len(number) and places[:, 1] == pytest.approx(0.1)


@pytest.mark.parametrize(
    ("low", "high", "near"), [(3.5, 5.5, []), (4.5, 4.2, [3, 4, 5, 6]), (3.9, 3.1, [2, 3, 4, 5])]
)
def test_a_sheet_counts_near_places_that_are_on_its_sides_of_all_faults(low, high, near):
    """Below `low` on the side of one fault, beyond `high` on that of another: where some triangle may be on
    both, and beside it. Near each of two places is not near both."""
    x = np.tile(np.arange(9.0), 3)
    at = np.arange(27).reshape(3, 9)
    corners = at[:-1, :-1], at[:-1, 1:], at[1:, 1:], at[1:, :-1]
    a, b, c, d = (each.ravel() for each in corners)
    triangles = np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])])
    found = _near(triangles, [x < low, x > high], [np.zeros(27, bool)] * 2)
    assert sorted(set(x[found].astype(int).tolist())) == near


@pytest.mark.parametrize("near", [True, False])
def test_a_branch_that_passes_between_two_sheets_beyond_a_tip_ends_in_nothing(near):
    """Neither is passed itself: both its nodes are below the branch, both those of the other above."""
    plan = np.array([[0.0, 0.0], [1.0, 0.0]])
    low, high = np.full(2, -1, np.int8), np.full(2, 1, np.int8)
    seen = {(-1, -1): np.array([True, True]), (-1, 1): np.array([near, near])}
    drawn = _Drawn(plan, [0.0, 0.0], [[], [0]], seen, {(-1, -1): {1: low}, (-1, 1): {1: high}})
    drawn.require_equal(0, np.array([[0, 1]]))
    assert drawn.equal[0].tolist() == [True, True]
    assert drawn.equal[1].tolist() == [near, near]


def test_points_that_dsi_ignores_are_no_data_of_a_compartment():
    """Above the fault all points lie outside of the region: the surface goes on as below it."""
    ring = np.array([[0.0, 0], [10, 0], [10, 4], [6, 4], [6, 10], [0, 10]])
    points = np.array([[1.0, 1, 0], [4, 8, 1], [3, 2, 0.5], [8, 9, 3], [9, 8, 4]])
    surface = Surface("S", points=points, method="dsi")
    rock = Rock("r", [surface], region=[ring], edge_length=3.0, base_elevation=-5.0)
    vertices, triangles = plane_fault(6.5)
    model = build(Project("p", [rock], faults=[Fault("F", vertices, triangles)]))
    assert sorted(model.compartment_names) == ["above F", "below F"]
    texts = [warning.text for warning in model.warnings]
    assert any("it has no points on the mesh in compartment" in text for text in texts), texts


def test_triangles_over_one_another_have_a_common_area():
    ulp = np.spacing(1.0)
    one = np.array([[[0.0, 0], [1, 0], [0, 1]]])
    others = np.array(
        [
            [[1.0, 0], [1, 1], [0, 1]],  # along an edge
            [[1.0 - ulp, 0], [1, 1], [0, 1]],  # over it, by less than any tolerance
            [[0.0, 0], [-1, 0], [0, -1]],  # at a corner
            [[0.1, 0.1], [0.1, 0.2], [0.2, 0.1]],  # within, and the other way round
            [[0.0, 0], [0, 1], [1, 0]],  # the same
        ]
    )
    assert sorted(overlapping_pairs(one, others)[:, 1].tolist()) == [1, 3, 4]


def test_lines_between_triangles_are_in_what_they_have_in_common():
    low = np.array([[0.0, 0, 0], [4, 0, 4], [0, 4, 0]])
    high = np.array([[2.0, 0, 9], [2, 6, 9], [-4, 0, 9]])
    apart = high + np.array([20, 0, 0])
    begin, end = common_lines(np.array([low, low]), np.array([apart, high]))
    assert np.array_equal(begin[:, :2], end[:, :2])
    assert np.allclose(begin[:, 2], begin[:, 0])
    assert np.allclose(end[:, 2], 9)
    expected = {(0, 0), (2, 0), (2, 2), (0, 4)}
    assert {tuple(corner) for corner in np.round(begin[:, :2]).astype(int).tolist()} == expected


def structure_of(dies_out, ends, rows):
    count = len(dies_out)
    names = [f"F{n}" for n in range(count)]
    faults = RockFaults(names, [None] * count, [0] * count, dies_out, list(range(count)), ends)
    return RockStructure(faults, np.array(rows, np.int8), names, [[None] for _ in rows])


def test_a_fault_that_dies_out_parts_no_data_where_another_one_does():
    """Where F1 is beyond F0, and F2, which divides the rock, is not there."""
    rows = [[1, 1, 1], [1, 1, -1], [1, -1, 1], [1, -1, -1], [-1, 0, 0]]
    structure = structure_of([True, True, False], [[], [(0, 1)], [(0, 1)]], rows)
    found = {family.key: family.members for family in families(structure, 0)}
    assert found == {
        (2, 2, 1): {0: (1, 1), 2: (1, -1)},
        (2, 2, -1): {1: (1, 1), 3: (1, -1)},
        (2, 2, 0): {4: (-1, 0)},
    }
    (together,) = around_tips(structure, 0, families(structure, 0))
    assert together.branches == (2,) and together.settled == (1,)
    assert sorted(together.members) == [0, 1, 2, 3, 4]


def test_a_fault_that_dies_out_is_not_there_beyond_one_that_does_not():
    structure = structure_of([False, True], [[], [(0, 1)]], [[1, 1], [1, -1], [-1, 0]])
    found = {family.key: family.members for family in families(structure, 0)}
    assert found == {(1, 2): {0: (1,), 1: (-1,)}, (-1, 0): {2: ()}}
    assert around_tips(structure, 0, families(structure, 0)) == []


def test_faults_that_part_no_data_are_not_asked_for():
    """F0 displaces older surfaces only, but F1, at which F2 ends, is there beside it alone."""
    structure = structure_of([False, True, True, True], [[], [(0, 1)], [(1, 1)], []], [[1, 1, 1, 1]])
    structure.faults.youngest[:] = [0, 1, 1, 1]
    assert parting(structure.faults, 0) == [0, 1, 2]
    assert parting(structure.faults, 1) == [0, 1, 2]
    structure.faults.ends[2] = []
    assert parting(structure.faults, 1) == [0, 1]
    structure.faults.ends[1] = []
    assert parting(structure.faults, 1) == []


def test_nodes_have_one_place_for_each_height():
    plan = np.column_stack([np.arange(5000.0), np.zeros(5000)])
    heights = np.random.default_rng(1).integers(0, 3, (600, 5000)).astype(float)
    heights[:, 7] = 1.0
    points, node, number = _places_of(plan, list(heights))
    assert np.array_equal(points[number, 2], heights)
    assert (node[number] == np.arange(5000)).all() and np.array_equal(points[:, 0], node)
    assert len(np.unique(points, axis=0)) == len(points) == 3 * 5000 - 2


def test_heights_are_shared_as_the_weights_say():
    """Where only some faults die out nearby, the others keep their sides apart: to the bit as all of them
    weighed one after another."""
    rng = np.random.default_rng(2)
    rows = [(1, 1, 1), (1, 1, -1), (1, -1, 1), (-1, 0, 1), (-1, 0, -1)]
    heights = {row: rng.normal(size=400) for row in rows}
    near = {row: rng.random(400) < 0.8 for row in rows}
    on_side = {row: [(side == 0) | (rng.random(400) < 0.5) for side in row] for row in rows}
    weights = [np.clip(rng.uniform(-0.5, 2.5, 400), 0.0, 1.0) for _ in range(3)]
    heights[rows[0]][~near[rows[0]]] = np.nan
    found = blended(heights, near, on_side, weights)
    for row in rows:
        total, whole = np.zeros(400), np.zeros(400)
        for other in rows:
            share = near[other].astype(float)
            for n, weight in enumerate(weights):
                alike = row[n] == other[n]
                if not alike and 0 in (row[n], other[n]):
                    alike = on_side[row if row[n] else other][n]
                share = share * np.where(alike, 0.5 + 0.5 * weight, 0.5 - 0.5 * weight)
            total, whole = total + np.where(share == 0, 0, share * heights[other]), whole + share
        expected = np.where(near[row], total / np.where(whole > 0, whole, 1), heights[row])
        assert np.array_equal(found[row], expected, equal_nan=True)


def overlapping(count, method="natural_neighbour"):
    """A project with faults that die out and overlap in plan, each with a throw of its own."""
    plan = np.random.default_rng(4).uniform(0.0, 10.0, (500, 2))
    height, faults = 0.1 * plan[:, 0], []
    for number in range(count):
        x = 3.0 + 0.8 * number
        lean, turn = (0.3, -0.4)[number % 2], 12.0 * (number % 3 - 1)
        faults.append(Fault(f"F{number}", *plane_fault(x, lean, (2.0, 8.0), turn=turn), dies_out=True))
        throw = 0.5 * np.clip(1.0 - np.abs(plan[:, 1] - 5.0) / 3.0, 0.0, None)
        height = height + np.where(plan[:, 0] > x, throw, 0.0)
    surface = Surface("S", points=np.column_stack([plan, height]), method=method)
    rock = Rock("r", [surface], region=[SQUARE], edge_length=0.6, base_elevation=-5.0)
    return Project("p", [rock], faults=faults)


def test_faults_that_die_out_are_asked_for_all_combinations_of_sides_at_once(monkeypatch):
    """With twice as many that overlap in plan there are more than twice as many combinations, and twice as
    many questions to the native module."""
    asked = Counter()
    native = Work.native

    def counted(self, function, *arguments, **options):
        asked[function.__name__] += 1
        return native(self, function, *arguments, **options)

    monkeypatch.setattr(Work, "native", counted)
    found = []
    for count in (3, 6):
        project = overlapping(count)
        asked.clear()
        (entry,) = prepared(project)
        found.append((len(entry.structure.distinct(0)), asked["sides"], asked["structure_beyond"]))
    (sheets, sides, beyond), (more_sheets, more_sides, more_beyond) = found
    assert more_sheets > 2 * sheets
    # finding where rows are, and drawing nearer, may take one turn more
    assert 0 < more_sides <= 2.5 * sides
    assert 0 < more_beyond <= 2.5 * beyond


@pytest.mark.parametrize("method", ["kriging", "natural_neighbour"])
def test_sheets_are_interpolated_where_their_compartments_are(method, monkeypatch):
    """There they are the same to the bit as if they were interpolated everywhere, and twice as many faults
    take about twice as many heights."""
    heights, asked = interpolated_sheets.give_heights, []

    def counted(work, entry, number, *trend):
        asked.append(len(entry.region.vertices))
        heights(work, entry, number, *trend)

    monkeypatch.setattr(interpolated_sheets, "give_heights", counted)
    found = []
    for count in (3, 6):
        asked.clear()
        (entry,) = prepared(overlapping(count, method))
        found.append((len(entry.structure.compartments), sum(asked)))
    (few, of_few), (many, of_many) = found
    assert many >= 3 * few and of_many < 2 * of_few < many * len(entry.region.vertices)
    monkeypatch.setattr(InterpolatedSurface, "_counts_by_node", lambda self, surface, data: False)
    (whole,) = prepared(overlapping(6, method))
    faults, count = whole.structure.faults, 0
    assert np.array_equal(whole.structure.compartments, entry.structure.compartments)
    for row, own, other in zip(
        whole.structure.compartments, entry.structure.sheets, whole.structure.sheets, strict=True
    ):
        sides = run(lambda work, sheet=other[0]: sides_of(work, sheet.vertices, faults))
        is_there = (sides == row).all(axis=1)
        assert np.array_equal(own[0].vertices[is_there], other[0].vertices[is_there])
        count += is_there.sum()
    assert count > 0.9 * len(whole.region.vertices)
