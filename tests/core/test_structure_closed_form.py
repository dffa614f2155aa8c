# SPDX-License-Identifier: GPL-3.0-or-later
"""What is at a point of a rock mass with faults and bodies."""

from fractions import Fraction

import numpy as np
import pytest
from realmodel.core.base.exact import orient2d, orient3d
from realmodel.core.base.sheet import Sheet
from realmodel.core.base.triangles import distances_of_pairs
from realmodel.core.proof import closed_form as form
from realmodel.core.settings.rules import RULES
from realmodel.core.surfaces.sides import FaultShape, RockFaults

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
    found = unfaulted(heights, rules, base).blocks_at(points)
    assert found.tolist() == [section_two(heights, rules, base, z) for z in places]


def test_a_body_is_eroded_and_buried():
    bodies = [form.BodyOfRock(box([-1, -1, 2], [1, 1, 6]), after=1, block=9)]
    closed = unfaulted([0, 8, 4, 10], ["erosional"] * 4, bodies=bodies)
    points = np.array([[0.2, 0.1, z] for z in (1, 3, 5, 7)])
    assert closed.blocks_at(points).tolist() == [1, 9, 3, 3]


def test_the_later_of_two_bodies_and_voids():
    bodies = [
        form.BodyOfRock(box([-1, -1, -3], [1, 1, 3]), after=1, block=9),
        form.BodyOfRock(box([0, -1, -3], [2, 1, 3]), after=1, block=form.AIR),
    ]
    points = np.array([[-0.5, 0, 1.0], [0.5, 0, 1], [1.5, 0, 1], [2.5, 0, 1], [-0.5, 0, -1]])
    closed = unfaulted([0, 8], ["erosional"] * 2, bodies=bodies)
    assert closed.blocks_at(points).tolist() == [9, form.AIR, form.AIR, 1, form.AIR]
    based = unfaulted([0, 8], ["erosional"] * 2, base=-2.0, bodies=bodies)
    assert based.blocks_at(points).tolist() == [9, form.AIR, form.AIR, 1, 9]


def vertical_fault(x=0.0, low=-20.0, high=20.0):
    vertices = np.array([[x, low, low], [x, high, low], [x, high, high], [x, low, high]], float)
    return vertices, np.array([[0, 1, 2], [0, 2, 3]], np.int32)


def test_a_fault_until_an_unconformity():
    faults = RockFaults(["F"], [FaultShape(*vertical_fault())], [1], [False], [0], [[]])
    left, right = [level(0), level(4), level(6)], [level(-2), level(2), level(6)]
    sides = form.nearest_side(np.array([[1.0, 0, 0], [-1, 0, 0]]), *vertical_fault())
    assert sorted(sides.tolist()) == [-1, 1]
    rows = np.array([[sides[1]], [sides[0]]], np.int8)
    closed = form.ClosedForm(["erosional"] * 3, faults, rows, [left, right], [0, 1, 2])
    points = np.array([[x, 0.5, z] for x in (-3, 3) for z in (-1, 1, 3, 5, 7)])
    assert closed.blocks_at(points).tolist() == [-1, 1, 1, 2, -1, 1, 1, 2, 2, -1]


def test_a_branch_is_dropped_beyond():
    main = vertical_fault()
    branch = np.array([[-5, 0, -20], [20, 0, -20], [20, 0, 20], [-5, 0, 20]], float), main[1]
    kept = int(form.nearest_side(np.array([[5.0, 3, 0]]), *main)[0])
    faults = RockFaults(
        ["M", "B"], [FaultShape(*main), FaultShape(*branch)], [1, 1], [False] * 2, [0, 1], [[], [(0, kept)]]
    )
    rows = np.array([[kept, 1], [kept, -1], [-kept, 0]], np.int8)
    closed = form.ClosedForm(["erosional"] * 2, faults, rows, [[level(0), level(1)]] * 3, [0, 1])
    found = closed.compartments_of(np.array([[-3, 2, 0], [-3, -2, 0], [3, 2, 0], [3, -2, 0.0]]))
    assert found[0] == found[1] == 2 and sorted(found[2:].tolist()) == [0, 1]


def test_sides_beyond_the_border_and_at_a_bend():
    bent = np.array([[0, 0, 0], [0, 9, 0], [5, 0, -5], [5, 9, -5], [20, 0, -6], [20, 9, -6]], float)
    triangles = np.array([[0, 1, 2], [2, 1, 3], [2, 3, 4], [4, 3, 5]])
    points = np.array([[3, 4, 2], [3, 4, -8], [-4, 4, 8], [-9, 4, 1], [30, 4, -9], [30, 30, 5.0]])
    sides = form.nearest_side(points, bent, triangles)
    assert (sides == np.array([1, -1, 1, -1, -1, 1]) * sides[0]).all()


def test_winding_numbers_in_degenerate_positions():
    vertices, triangles = box([0, 0, 0], [2, 2, 2])
    grid = np.stack(np.meshgrid(*[np.arange(-1, 7) / 2.0] * 3, indexing="ij"), -1).reshape(-1, 3)
    inside = ((grid > 0) & (grid < 2)).all(axis=1)
    outside = ((grid < 0) | (grid > 2)).any(axis=1)
    found = form.winding_numbers(grid, vertices, triangles)
    assert (found[inside] == 1).all() and (found[outside] == 0).all()
    twice = np.concatenate([triangles, triangles])
    assert (form.winding_numbers(grid[inside], vertices, twice) == 2).all()


def test_heights_where_triangles_overlap_in_box_only():
    random = np.random.default_rng(4)
    n = 12
    x, y = np.meshgrid(np.arange(n + 1.0), np.arange(n + 1.0), indexing="ij")
    vertices = np.column_stack([x.ravel(), y.ravel(), 3 * x.ravel() - y.ravel()])
    first = (np.arange(n)[:, None] * (n + 1) + np.arange(n)).ravel()
    triangles = np.concatenate(
        [
            np.column_stack([first, first + n + 1, first + n + 2]),
            np.column_stack([first, first + n + 2, first + 1]),
        ]
    )
    plan = np.concatenate([random.uniform(-2, n + 2, (500, 2)), vertices[:, :2]])
    heights = form.heights_at(plan, vertices, triangles)
    within = ((plan >= 0) & (plan <= n)).all(axis=1)
    assert np.isnan(heights[~within]).all()
    assert np.abs(heights[within] - (3 * plan[within, 0] - plan[within, 1])).max() < 1e-12


def test_signs_are_exact():
    random = np.random.default_rng(9)
    a = random.uniform(0, 1, (300, 3))
    b = a + random.uniform(-1, 1, (300, 3))
    c = a + random.uniform(-1, 1, (300, 3))
    share = random.uniform(0, 1, (300, 1))
    p = np.nextafter(a + share * (b - a) + (1 - share) * (c - a), random.choice([-9.0, 9.0], (300, 3)))

    def exact(n):
        rows = [[Fraction(corner[n, k]) - Fraction(a[n, k]) for k in range(3)] for corner in (b, c, p)]
        (u, v, w), (d, e, f), (g, h, i) = rows
        value = u * (e * i - f * h) - v * (d * i - f * g) + w * (d * h - e * g)
        return (value > 0) - (value < 0)

    assert orient3d(a, b, c, p).tolist() == [exact(n) for n in range(300)]
    flat = [points[:, :2] for points in (a, b, c)]
    on = orient2d(flat[0], flat[1], flat[0] / 2 + flat[1] / 2)

    def exact_2d(n):
        (ax, ay), (bx, by) = ([Fraction(float(value)) for value in points[n]] for points in flat[:2])
        x, y = (Fraction(float(value)) for value in flat[0][n] / 2 + flat[1][n] / 2)
        value = (ax - x) * (by - y) - (ay - y) * (bx - x)
        return (value > 0) - (value < 0)

    assert on.tolist() == [exact_2d(n) for n in range(300)]


def test_places_on_a_long_triangle_are_on_it():
    """A fault reaches far beyond the model: the length of its triangles does not count."""
    needle = np.array([[-10.4, -13.6, 77.6], [5.05, 5.6, -3.5], [4.78, 5.8, -3.5]])
    places = np.random.default_rng(1).dirichlet((1, 30, 30), 200) @ needle
    away = distances_of_pairs(places, np.broadcast_to(needle, (200, 3, 3)))
    assert away.max() <= 8 * np.spacing(np.abs(places).max())
