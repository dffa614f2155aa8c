# SPDX-License-Identifier: GPL-3.0-or-later
"""Hundreds of random stacks, each judged by check_model's tests and by exact volumes.

The same stacks on every run. To look further than these, and to make a failing one small:
python -m tests.core.stacks.hunt SECONDS SEED [--stack FILE]
"""

from random import Random

import numpy as np
import pytest
from hypothesis import HealthCheck, Phase, assume, given, settings
from hypothesis import strategies as st
from stacks import places
from stacks.case import Stack, save_stack
from stacks.generate import FAMILIES, random_stack
from stacks.heights import disordered
from stacks.judge import failures_of, volume_allowance
from stacks.model_view import built
from stacks.rock_masses import random_rock_masses

EXAMPLES = 24  # of each family

usual = settings(
    derandomize=True,
    deadline=None,
    database=None,
    suppress_health_check=list(HealthCheck),
    phases=[Phase.generate],  # the hunt's own minimizer makes failures small, in far less time
)
# numbers that Hypothesis chooses, which like to repeat, and a seed that it chooses
chance = st.randoms(use_true_random=False) | st.randoms(use_true_random=True)


@pytest.mark.skipif(places.checker() is None, reason=places.CHECK_ABSENT)
@pytest.mark.parametrize("family", sorted(FAMILIES))
def test_every_oracle_agrees(family, tmp_path):
    @settings(usual, max_examples=EXAMPLES)
    @given(chance)
    def judged(rng):
        stack = random_stack(rng, family)
        failures = failures_of(stack)
        if failures:
            save_stack(stack, tmp_path / "failing.json", "; ".join(failures))
        assert failures == [], f"the stack is kept in {tmp_path / 'failing.json'}"

    judged()


@pytest.mark.skipif(places.checker() is None, reason=places.CHECK_ABSENT)
@settings(usual, max_examples=40)
@given(chance)
def test_rock_masses_that_share_borders(rng):
    """Two to four rock masses: every oracle agrees, and each has the volumes that it has alone."""
    masses = random_rock_masses(rng)
    assert failures_of(masses) == []
    alone = np.concatenate([built(stack)["volumes"] for stack in masses])
    together = built(masses)["volumes"]
    assert (np.abs(alone - together) <= volume_allowance(masses, alone)).all()


@settings(usual, max_examples=40)
@given(st.sampled_from(sorted(FAMILIES)), chance)
def test_order_and_orientation_do_not_matter(family, rng):
    """Vertices and triangles in another order, turned round: the same volumes."""
    stack = random_stack(rng, family)
    other = Stack(
        [disordered(rng, *s) for s in stack.surfaces], stack.region, stack.base_elevation, stack.rules
    )
    volumes = built(stack)["volumes"]
    changed = built(other)["volumes"]
    allowed = volume_allowance(stack, volumes)
    assert (np.abs(volumes - changed) <= allowed).all(), (volumes, changed)


def test_a_surface_without_triangles_stays_one_when_it_is_disordered():
    vertices, triangles = disordered(Random(1), np.zeros((3, 3)), np.empty((0, 3), np.int32))
    assert vertices.shape[1] == 3 and triangles.shape == (0, 3)


@settings(usual, max_examples=40)
@given(st.sampled_from(sorted(FAMILIES)), chance, st.integers(0, 5))
def test_a_surface_that_comes_twice_changes_nothing(family, rng, position):
    """The second of two equal surfaces deposits nothing and removes nothing."""
    stack = random_stack(rng, family)
    k = position % len(stack.surfaces)
    twice = [*stack.surfaces[: k + 1], stack.surfaces[k], *stack.surfaces[k + 1 :]]
    once = built(stack)
    rules = stack.all_rules()
    rules.insert(k, rules[k])
    result = built(Stack(twice, stack.region, stack.base_elevation, rules))
    assert not (result["cell_block"] == k + 1).any()
    assert result["volumes"][k + 1] == 0
    rest = np.delete(result["volumes"], k + 1)
    assert (np.abs(rest - once["volumes"]) <= volume_allowance(stack, once["volumes"])).all()


@settings(usual, max_examples=40)
@given(st.sampled_from(sorted(FAMILIES)), chance)
def test_the_youngest_surface_below_all_removes_all(family, rng):
    stack = random_stack(rng, family)
    own = np.concatenate([v for v, _ in stack.surfaces])
    low, high = own[:, :2].min(axis=0) - 1, own[:, :2].max(axis=0) + 1
    below = own[:, 2].min() - 1.0
    plan = [low, (high[0], low[1]), high, (low[0], high[1])]
    cut = np.array([(*p, below) for p in plan]), np.array([(0, 1, 2), (0, 2, 3)], np.int32)
    assume(below < own[:, 2].min())
    result = built(Stack([*stack.surfaces, cut], stack.region))
    assert not len(result["cell_block"])
    assert not result["volumes"].any()


@settings(usual, max_examples=30)
@given(st.sampled_from(["shared lattice", "own lattices", "partial", "regions", "T-junctions"]), chance)
def test_powers_of_two_scale_exactly(family, rng):
    """Coordinates times powers of two: every volume scales without any error."""
    stack = random_stack(rng, family)
    size = np.array([4.0, 0.5, 2.0])
    region = None if stack.region is None else (stack.region[0] * size[:2], stack.region[1])
    base = None if stack.base_elevation is None else stack.base_elevation * size[2]
    scaled = Stack([(v * size, t) for v, t in stack.surfaces], region, base, stack.rules)
    volumes = built(stack)["volumes"]
    assert built(scaled)["volumes"] == pytest.approx(volumes * size.prod(), rel=1e-12)
