# SPDX-License-Identifier: GPL-3.0-or-later
"""The rational oracle against volumes computed by hand, and against sampling of the closed form."""

import random
from fractions import Fraction

import numpy as np
import pytest
from stacks import places
from stacks.generate import FAMILIES, RULES, random_stack
from stacks.rational import block_volumes, double_valued_pairs, flat_triangles

SQUARE = [(0, 1, 2), (0, 2, 3)]
OTHER_DIAGONAL = [(0, 1, 3), (1, 2, 3)]


def square(*heights, size=2.0):
    """A square with corner heights, counter-clockwise from the origin."""
    plan = [(0.0, 0.0), (size, 0.0), (size, size), (0.0, size)]
    return np.array([(*p, z) for p, z in zip(plan, heights, strict=True)])


def test_one_layer_between_two_planes():
    assert block_volumes([(square(0, 0, 0, 0), SQUARE), (square(1, 1, 1, 1), OTHER_DIAGONAL)]) == [0, 4]


def test_crossing_planes_leave_half_a_wedge():
    """z = x - 1 over [0, 2]^2 against z = 0: a triangle of area 1/2 along a length of 2."""
    level, tilted = (square(0, 0, 0, 0), SQUARE), (square(-1, 1, 1, -1), SQUARE)
    assert block_volumes([level, tilted]) == [0, 1]
    assert block_volumes([tilted, level]) == [0, 1]
    assert block_volumes([level, tilted], ["erosional", "conformable"]) == [0, 1]
    assert block_volumes([level, tilted], base_elevation=-2) == [8 - 1, 1]


def test_rules_decide_what_is_cut():
    """Ground at 0, a layer to 2, then a surface at -1: it cuts, or only what nobody protects."""
    stack = [(square(*[z] * 4), SQUARE) for z in (0, 2, -1)]
    assert block_volumes(stack) == [0, 0, 0]
    assert block_volumes(stack, base_elevation=-5) == [16, 0, 0]
    assert block_volumes(stack, ["base", "erosional", "erosional"]) == [0, 0, 0]
    assert block_volumes(stack, ["base", "erosional", "erosional"], base_elevation=-5) == [20, 0, 0]
    assert block_volumes(stack, ["erosional", "discontinuous", "erosional"]) == [0, 8, 0]
    assert block_volumes(stack, ["erosional", "erosional", "conformable"]) == [0, 8, 0]


def test_onlap_fills_only_what_lies_below():
    """A conformable level at 0 over z = x - 1 fills the low half: volume 1."""
    stack = [(square(-1, 1, 1, -1), SQUARE), (square(0, 0, 0, 0), OTHER_DIAGONAL)]
    assert block_volumes(stack, ["erosional", "conformable"]) == [0, 1]
    assert block_volumes(stack, ["erosional", "conformable"], base_elevation=-1) == [4, 1]


def test_partial_coverage_hole_and_jump():
    level = (square(0, 0, 0, 0), SQUARE)
    half = (square(1, 1, 1, 1), [(0, 1, 2)])
    above = (square(3, 3, 3, 3), OTHER_DIAGONAL)
    assert block_volumes([level, half]) == [0, 2]
    assert block_volumes([level, half, above]) == [0, 2, 10]
    jump = (np.vstack([square(1, 1, 1, 1), square(2, 2, 2, 2)]), [(0, 1, 2), (4, 6, 7)])
    assert block_volumes([level, jump]) == [0, 6]


def test_region_clips_and_older_gap_forms_no_block():
    level, above = (square(0, 0, 0, 0), SQUARE), (square(1, 1, 1, 1), SQUARE)
    region = (np.array([(0.5, -1.0), (1.5, -1.0), (1.0, 3.0)]), [(0, 1, 2)])
    # the triangle is 1/2 (3 - y) / 2 ... wide: its part with 0 < y < 2 has the width (3 - y) / 4 at y
    assert block_volumes([level, above], region=region) == [0, 1]
    assert block_volumes([(square(0, 0, 0, 0), [(0, 1, 2)]), above]) == [0, 2]


def test_cone_on_a_square():
    """A pyramid of height 1 over [0, 2]^2 has the volume 4/3; cut off at 1/2 it loses an eighth of that."""
    cone = (np.vstack([square(0, 0, 0, 0), [(1, 1, 1)]]), [(0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)])
    level = (square(0, 0, 0, 0), SQUARE)
    cut = (square(0.5, 0.5, 0.5, 0.5), OTHER_DIAGONAL)
    volumes = block_volumes([level, cone, cut])
    assert volumes[1] == Fraction(4, 3) * Fraction(7, 8)
    assert volumes[2] == 2 - volumes[1]


def test_one_unit_in_the_last_place_is_seen():
    z = float(np.nextafter(1.0, 2.0))
    assert block_volumes([(square(1, 1, 1, 1), SQUARE), (square(z, z, z, z), SQUARE)]) == [
        0,
        Fraction(4, 2**52),
    ]


def test_single_valuedness_and_flat_triangles():
    vertices = square(0, 0, 0, 0)
    assert double_valued_pairs(vertices, SQUARE) == []
    assert double_valued_pairs(vertices, [(0, 1, 2), (1, 3, 2)]) == [(0, 1)]
    assert double_valued_pairs(vertices, [(0, 1, 2), (0, 1, 2)]) == [(0, 1)]
    assert flat_triangles(vertices, [(0, 1, 2), (0, 0, 1)]) == [1]
    assert flat_triangles([(0, 0, 0), (1, 1, 0), (3, 3, 9)], [(0, 1, 2)]) == [0]


@pytest.mark.skipif(places.closed_form() is None, reason=places.CHECK_ABSENT)
@pytest.mark.parametrize("rules", ["its own", "mixed"])
@pytest.mark.parametrize("family", sorted(FAMILIES))
def test_sampled_closed_form_agrees(family, rules):
    """Mean thickness at random plan points times the area, within five standard errors."""
    form = places.closed_form()
    rng = random.Random(f"{family} {rules}")
    points_rng = np.random.default_rng(11)
    for _ in range(3):
        stack = random_stack(rng, family)
        if rules == "mixed":
            stack.rules = [rng.choice(RULES) for _ in stack.surfaces]
        exact = block_volumes(stack.surfaces, stack.rules, stack.region, stack.base_elevation)
        surfaces = [form.Surface(v, t) for v, t in stack.surfaces]
        own = np.concatenate([v[np.unique(t), :2] for v, t in stack.surfaces])
        low, high = own.min(axis=0), own.max(axis=0)
        points = low + points_rng.random((4000, 2)) * (high - low)
        heights = form.heights_of(surfaces, range(len(surfaces)), stack.region_rings(), points)
        lower, upper = form.columns(heights, stack.all_rules(), stack.base_elevation)
        thickness = np.where(np.isnan(lower), 0.0, upper - lower)
        area = float(np.prod(high - low))
        error = area * thickness.std(axis=1) / np.sqrt(len(points))
        rounding = area * (
            1e-3 * np.abs(thickness).max() + 64 * np.spacing(np.nanmax(np.abs(heights), initial=0.0))
        )
        for k, volume in enumerate(exact):
            assert abs(float(volume) - area * thickness[k].mean()) <= 5 * error[k] + rounding, (family, k)
