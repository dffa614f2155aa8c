# SPDX-License-Identifier: GPL-3.0-or-later
"""Random stacks cut by planes in every position: through vertices, along edges and faces, anywhere."""

from pathlib import Path

import pytest
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st
from stacks import cut_hunt, places
from stacks.cutters import random_cutter, some_planes
from stacks.cutting import native_arrays
from stacks.generate import FAMILIES, random_stack
from stacks.model_view import built
from stacks.rock_masses import random_rock_masses

pytestmark = pytest.mark.skipif(places.checker() is None, reason=places.CHECK_ABSENT)

usual = settings(
    derandomize=True,
    deadline=None,
    database=None,
    suppress_health_check=list(HealthCheck),
    phases=[Phase.generate],
)
FOUND = sorted((Path(__file__).parents[1] / "data" / "cuts").glob("*.npz"))
chance = st.randoms(use_true_random=False) | st.randoms(use_true_random=True)


def judge(rng, case):
    cells = rng.choice(("columns", "blocks"))
    model = native_arrays(case, built(case, cells=cells, threads=1), cells)
    if not len(model["cell_block"]) or not cut_hunt.has_room(model):
        return
    for plane in some_planes(rng, model["vertices"]):
        assert cut_hunt.judged(model, "plane", plane) == ([], None), (plane, cells)


@pytest.mark.parametrize("family", sorted(FAMILIES))
def test_halves_are_models(family):
    @settings(usual, max_examples=12)
    @given(chance)
    def judged(rng):
        judge(rng, random_stack(rng, family))

    judged()


@pytest.mark.parametrize("family", sorted(FAMILIES))
def test_halves_by_surfaces_and_blocks_are_models(family):
    """Nothing is refused but surfaces that do end in the model; what is not refused is right."""

    @settings(usual, max_examples=12)
    @given(chance)
    def judged(rng):
        stack = random_stack(rng, family)
        cells = rng.choice(("columns", "blocks"))
        model = native_arrays(stack, built(stack, cells=cells, threads=1), cells)
        if not len(model["cell_block"]):
            return
        found = random_cutter(rng, stack, family, model, cells)
        if found is None:
            return
        kind, cutter = found
        failures, refused = cut_hunt.judged(model, kind, cutter)
        assert failures == [], (kind, cells)
        assert refused is None or (refused == "ends_inside" and kind in ("own", "ends inside"))

    judged()


@pytest.mark.parametrize("path", FOUND, ids=lambda path: path.stem)
def test_what_the_hunt_found(path):
    """Cases of stacks.cut_hunt that were once wrong or refused."""
    kind, model, cutter = cut_hunt.load(path)
    assert cut_hunt.judged(model, kind, cutter) == ([], None)


@settings(usual, max_examples=20)
@given(chance)
def test_halves_of_rock_masses_are_models(rng):
    judge(rng, random_rock_masses(rng))
