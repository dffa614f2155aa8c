# SPDX-License-Identifier: GPL-3.0-or-later
"""What is at a point of a rock mass with faults and bodies."""

import numpy as np
import pytest
from realmodel.core.base.triangles import Sheet
from realmodel.core.base.work import run
from realmodel.core.settings.rules import RULES
from realmodel.core.surfaces.rock_structure import FaultShape, RockFaults, fault_sides
from realmodel.core.validation import closed_form as form
from structure_cases import blocks_at

BOX_TRIANGLES = np.array(
    [
        *([0, 2, 1], [1, 2, 3], [4, 5, 6], [5, 7, 6], [0, 1, 4], [1, 5, 4]),
        *([2, 6, 3], [3, 6, 7], [0, 4, 2], [2, 4, 6], [1, 3, 5], [3, 7, 5]),
    ]
)


def box(low, high):
    corners = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)], float)
    return Sheet(np.asarray(low) + corners * (np.asarray(high, float) - low), BOX_TRIANGLES)


def level(z, low=-10.0, high=10.0):
    plan = np.array([[low, low], [high, low], [high, high], [low, high]])
    vertices = np.column_stack([plan, np.full(4, float(z))])
    return Sheet(vertices, np.array([[0, 1, 2], [0, 2, 3]], np.int32))


NO_FAULTS = RockFaults([], [], [])


def unfaulted(heights, rules, base=None, **more):
    return form.ClosedForm(
        rules,
        NO_FAULTS,
        np.zeros((1, 0), np.int8),
        [[level(z) for z in heights]],
        list(range(len(heights))),
        base,
        **more,
    )


def section_two(heights, rules, base, z):
    """The block at height z by the formulas of design.md section 2 (all surfaces everywhere)."""
    top, floor, tops = heights[0], -np.inf, []
    before = [None]
    if RULES[rules[0]].protects:
        floor = top
    tops.append(top)
    for height, rule in zip(heights[1:], rules[1:], strict=True):
        before.append(top)
        e = height if RULES[rule].cuts else max(height, top)
        top = max(e, floor)
        tops.append(top)
        if RULES[rule].protects:
            floor = top
    for k in range(len(heights)):
        left = min(tops[k:])
        if k == 0 and base is not None and base < z < left:
            return 0
        if k and min(before[k], left) < z < left:
            return k
    return form.AIR


@pytest.mark.parametrize("seed", range(30))
def test_without_structures_it_is_section_two(seed):
    random = np.random.default_rng(seed)
    heights = random.integers(0, 12, 6).astype(float)
    rules = random.choice(list(RULES), 6).tolist()
    base = -1.0 if seed % 2 else None
    places = np.arange(-3, 13) + 0.5
    points = np.column_stack([np.full((len(places), 2), 0.3), places])
    found = blocks_at(unfaulted(heights, rules, base), points)
    assert found.tolist() == [section_two(heights, rules, base, z) for z in places]


def test_a_body_is_eroded_and_buried():
    bodies = [form.BodyOfRock(box([-1, -1, 2], [1, 1, 6]), after=1, block=9)]
    closed = unfaulted([0, 8, 4, 10], ["erosional"] * 4, bodies=bodies)
    points = np.array([[0.2, 0.1, z] for z in (1, 3, 5, 7)])
    assert blocks_at(closed, points).tolist() == [1, 9, 3, 3]


def test_the_later_of_two_bodies_and_voids():
    bodies = [
        form.BodyOfRock(box([-1, -1, -3], [1, 1, 3]), after=1, block=9),
        form.BodyOfRock(box([0, -1, -3], [2, 1, 3]), after=1, block=form.AIR),
    ]
    points = np.array([[-0.5, 0, 1.0], [0.5, 0, 1], [1.5, 0, 1], [2.5, 0, 1], [-0.5, 0, -1]])
    closed = unfaulted([0, 8], ["erosional"] * 2, bodies=bodies)
    assert blocks_at(closed, points).tolist() == [9, form.AIR, form.AIR, 1, form.AIR]
    based = unfaulted([0, 8], ["erosional"] * 2, base=-2.0, bodies=bodies)
    assert blocks_at(based, points).tolist() == [9, form.AIR, form.AIR, 1, 9]


def vertical_fault(x=0.0, low=-20.0, high=20.0):
    vertices = np.array([[x, low, low], [x, high, low], [x, high, high], [x, low, high]], float)
    return vertices, np.array([[0, 1, 2], [0, 2, 3]], np.int32)


def sides_at(points, fault):
    return run(lambda work: fault_sides(work, np.array(points), FaultShape(*fault)))


def test_a_fault_until_an_unconformity():
    faults = RockFaults(["F"], [FaultShape(*vertical_fault())], [1], [False], [0], [[]])
    left, right = [level(0), level(4), level(6)], [level(-2), level(2), level(6)]
    sides = sides_at([[1.0, 0, 0], [-1, 0, 0]], vertical_fault())
    assert sorted(sides.tolist()) == [-1, 1]
    rows = np.array([[sides[1]], [sides[0]]], np.int8)
    closed = form.ClosedForm(["erosional"] * 3, faults, rows, [left, right], [0, 1, 2])
    points = np.array([[x, 0.5, z] for x in (-3, 3) for z in (-1, 1, 3, 5, 7)])
    assert blocks_at(closed, points).tolist() == [-1, 1, 1, 2, -1, 1, 1, 2, 2, -1]


def test_a_branch_is_dropped_beyond():
    main = vertical_fault()
    branch = np.array([[-5, 0, -20], [20, 0, -20], [20, 0, 20], [-5, 0, 20]], float), main[1]
    kept = int(sides_at([[5.0, 3, 0]], main)[0])
    faults = RockFaults(
        ["M", "B"], [FaultShape(*main), FaultShape(*branch)], [1, 1], [False] * 2, [0, 1], [[], [(0, kept)]]
    )
    rows = np.array([[kept, 1], [kept, -1], [-kept, 0]], np.int8)
    closed = form.ClosedForm(["erosional"] * 2, faults, rows, [[level(0), level(1)]] * 3, [0, 1])
    points = np.array([[-3, 2, 0], [-3, -2, 0], [3, 2, 0], [3, -2, 0.0]])
    found = run(lambda work: closed.compartments_of(work, points))
    assert found[0] == found[1] == 2 and sorted(found[2:].tolist()) == [0, 1]
