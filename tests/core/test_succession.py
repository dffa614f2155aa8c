# SPDX-License-Identifier: GPL-3.0-or-later
"""What places in blocks say of surfaces, against the closed form of the replay on random histories."""

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from realmodel.core import Rock, Surface
from realmodel.core.readers.tables.observations import Observations
from realmodel.core.settings.rules import RULES
from realmodel.core.surfaces.observed.columns import Succession
from realmodel.core.surfaces.observed.derived import PlaceContext, derive

HISTORIES = st.lists(st.tuples(st.sampled_from(list(RULES)), st.integers(0, 12)), min_size=1, max_size=8)


def blocks_of(rules, heights, z):
    """The block at each height z, by the closed form of docs/dev/geometry.md; -1 for air."""
    tops, top, firm = [], -np.inf, -np.inf
    ends = []
    for rule, height in zip(rules, heights, strict=True):
        before = top
        end = height if RULES[rule].cuts else max(height, top)
        end = max(end, firm)
        tops.append(before)
        ends.append(end)
        top = end
        firm = end if RULES[rule].protects else firm
    surviving = [min(ends[number:]) for number in range(len(ends))]
    found = []
    for each in z:
        there = [
            number
            for number in range(len(rules))
            if min(tops[number], surviving[number]) < each < surviving[number]
        ]
        assert len(there) <= 1
        found.append(there[0] if there else -1)
    return found


def logged(rules, heights, low=-1):
    """(top, bottom, block) of all blocks of a history at one position, from above downward."""
    ends = sorted({low, *heights})
    middle = [(a + b) / 2 for a, b in itertools.pairwise(ends)]
    rows = []
    for block, bottom, top in reversed(
        list(zip(blocks_of(rules, heights, middle), ends, ends[1:], strict=False))
    ):
        if block < 0:
            continue
        if rows and rows[-1][2] == block and rows[-1][1] == top:
            rows[-1] = (rows[-1][0], bottom, block)
        else:
            rows.append((top, bottom, block))
    return rows


def rock_of(rules):
    return Rock("r", [Surface(f"S{number}", rule=rule, points=[]) for number, rule in enumerate(rules)])


def seen(rows, x=0.0, hole=""):
    """Observations of intervals: both ends of each."""
    places = [[x, 0.0, z] for top, bottom, _ in rows for z in (top, bottom)]
    blocks = [f"S{block}" for *_, block in rows for _ in range(2)]
    places = np.array(places).reshape(-1, 3)
    return Observations(places, blocks, [hole] * len(blocks), 100.0 - places[:, 2])


def satisfies(derived, heights):
    """Whether heights at one position are what contacts and bounds say."""
    return all(
        (derived.contacts[number][:, 2] == height).all()
        and (derived.bounds[number].lower[:, 2] <= height).all()
        and (derived.bounds[number].upper[:, 2] >= height).all()
        for number, height in enumerate(heights)
    )


@settings(max_examples=300, derandomize=True, deadline=None)
@given(HISTORIES, st.data())
def test_true_heights_satisfy_what_follows_from_their_logs(history, data):
    rules, heights = zip(*history, strict=True)
    rows = logged(rules, heights)
    keep = data.draw(st.lists(st.booleans(), min_size=len(rows), max_size=len(rows)))
    rows = [row for row, kept in zip(rows, keep, strict=True) if kept]
    derived = derive(rock_of(rules), seen(rows))
    assert not derived.left_out
    assert satisfies(derived, heights)
    for (_, bottom, older), (top, _, younger) in zip(rows[1:], rows, strict=False):
        meet = bottom == top
        assert not meet or older != younger
    # each pair of intervals that meet has one contact, on one surface
    meeting = sum(first[1] == second[0] for first, second in itertools.pairwise(rows))
    assert sum(map(len, derived.contacts)) == meeting


@settings(max_examples=500, derandomize=True, deadline=None)
@given(HISTORIES, st.lists(st.integers(0, 12), min_size=8, max_size=8), st.data())
def test_whatever_satisfies_them_replays_to_the_observed_blocks(history, others, data):
    """Other heights are drawn and moved to the bounds: what is within all of them has the same blocks."""
    rules, heights = zip(*history, strict=True)
    rows = logged(rules, heights)
    derived = derive(rock_of(rules), seen(rows))
    moved = []
    for number, height in enumerate(others[: len(rules)]):
        contact = derived.contacts[number][:, 2]
        lower, upper = derived.bounds[number].lower[:, 2], derived.bounds[number].upper[:, 2]
        height = max([height, *lower])
        height = min([height, *upper])
        moved.append(contact[0] if len(contact) else height)
    assert satisfies(derived, moved)
    samples = [
        (bottom + share * (top - bottom), block)
        for top, bottom, block in rows
        for share in (0.001, data.draw(st.floats(0.01, 0.99)), 0.999)
    ]
    found = blocks_of(rules, moved, [z for z, _ in samples])
    assert found == [block for _, block in samples]


@settings(max_examples=300, derandomize=True, deadline=None)
@given(HISTORIES, st.data())
def test_statements_of_a_place_are_exact(history, data):
    """A place is in a block exactly if the surfaces lie where the block says."""
    rules, heights = zip(*history, strict=True)
    z = data.draw(st.integers(-1, 12)) + 0.5
    succession = Succession(rules)
    (block,) = blocks_of(rules, heights, [z])
    at = np.array(heights)
    says = [
        number
        for number in range(len(rules))
        if (at[succession.at_or_above[number]] > z).all() and (at[succession.at_or_below[number]] < z).all()
    ]
    assert says == ([] if block < 0 else [block])


@pytest.mark.parametrize(
    ("rules", "older", "younger", "surface"),
    [
        # the youngest that cuts; where none does the oldest
        (["erosional"] * 4, 0, 3, 2),
        (["erosional", "erosional", "conformable", "erosional"], 0, 3, 1),
        (["erosional", "conformable", "conformable", "erosional"], 0, 3, 0),
        (["conformable", "conformable", "conformable", "conformable"], 1, 3, 1),
        # none younger than the oldest that protects itself
        (["erosional", "discontinuous", "erosional", "erosional"], 0, 3, 1),
        (["erosional", "base", "erosional", "erosional"], 0, 3, 0),
        (["base", "erosional", "erosional", "erosional"], 0, 3, 0),
    ],
)
def test_contact(rules, older, younger, surface):
    assert Succession(rules).contacts([older, younger]) == [surface]


def test_bodies_say_which_later_surfaces_did_not_remove_them():
    rules = ["erosional", "erosional", "conformable", "erosional"]
    succession = Succession(rules, [1])
    assert succession.at_or_above[4].tolist() == [False, False, False, True]
    assert not succession.at_or_below[4].any()
    assert not Succession(["base", *rules], [2]).at_or_above[5].any()
    # the body is gone where a younger surface has cut it, and the block came later
    assert not succession.removes(3, 1)
    assert Succession([*rules, "erosional"], [1]).removes(4, 1)


def test_a_surface_that_is_not_there_changes_nothing():
    rock = rock_of(["erosional"] * 4)
    covered = np.tile([True, False, True, True], (4, 1))
    derived = derive(rock, seen([(9, 5, 3), (5, 0, 2)]), PlaceContext(covered=covered))
    assert derived.contacts[2].tolist() == [[0.0, 0.0, 5.0]]
    assert [len(bounds) for bounds in derived.bounds] == [1, 0, 0, 1]
    derived = derive(rock, seen([(9, 5, 3), (5, 0, 1)]), PlaceContext(covered=covered))
    assert [each.kind for each in derived.left_out] == ["no_surface"] * 2
    assert not len(derived.contacts[1])


def test_places_on_one_place_are_a_contact_as_ends_of_intervals_are():
    """As along the border of two polygons of a map."""
    given = Observations([[1, 1, 4], [1, 1, 4]], ["S2", "S1"])
    derived = derive(rock_of(["erosional"] * 3), given)
    assert derived.contacts[1].tolist() == [[1.0, 1.0, 4.0]]


def test_wrong_order_is_left_out_and_listed():
    rock = rock_of(["erosional"] * 4)
    rows = [(100, 90, 3), (90, 89, 1), (89, 60, 2), (60, 59, 3), (59, 0, 1)]
    derived = derive(rock, seen(rows, hole="B1"))
    assert [(each.kind, each.block, each.hole) for each in derived.left_out] == [
        ("wrong_order", "S1", "B1"),
        ("wrong_order", "S3", "B1"),
    ]
    assert sum(map(len, derived.contacts)) == 0  # what is left does not meet
    derived = derive(rock, seen([(100, 90, 3), (90, 60, 2), (60, 0, 3)], hole="B1"))
    assert [(each.block, each.depth) for each in derived.left_out] == [("S2", 10.0)]


def test_a_flat_hole_may_cross_a_surface_upward():
    places = [[0, 0, 10], [50, 0, 9], [50, 0, 9], [100, 0, 8]]
    given = Observations(places, ["S1", "S1", "S2", "S2"], ["B1"] * 4)
    derived = derive(rock_of(["erosional"] * 3), given)
    assert not derived.left_out
    assert derived.contacts[1].tolist() == [[50.0, 0.0, 9.0]]


def test_across_a_fault_there_is_no_order():
    rows = [(100, 60, 1), (60, 0, 2)]
    rock = rock_of(["erosional"] * 3)
    assert derive(rock, seen(rows, hole="B1")).left_out
    sides = np.array([[1], [1], [-1], [-1]], np.int8)
    derived = derive(rock, seen(rows, hole="B1"), PlaceContext(sides=sides))
    assert not derived.left_out
    assert sum(map(len, derived.contacts)) == 0
    assert {len(bounds) for bounds in derived.bounds} == {1, 2}


def test_observations_that_contradict_bodies():
    rock = rock_of(["erosional", "erosional", "conformable"])
    inside = np.array([[True], [False]])
    situation = PlaceContext(inside=inside, after=[1], bodies=["salt"], voids=[False])
    given = Observations([[0, 0, 5], [9, 9, 5]], ["S1", "salt"])
    assert [each.kind for each in derive(rock, given, situation).left_out] == ["in_body", "in_body"]
    given = Observations([[0, 0, 5], [9, 9, 5]], ["salt", "S1"])
    assert not derive(rock, given, situation).left_out
    # what fills a void lies below the surfaces that it was dug through
    void = PlaceContext(inside=inside, after=[1], bodies=["pit"], voids=[True])
    derived = derive(rock, Observations([[0, 0, 5], [9, 9, 5]], ["S2", "S2"]), void)
    assert [bounds.places[:, 0].tolist() for bounds in derived.bounds] == [[], [9.0], [0.0, 9.0]]
