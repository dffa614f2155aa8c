# SPDX-License-Identifier: GPL-3.0-or-later
"""Random stacks cut by planes in every position: through vertices, along edges and faces, anywhere."""

import itertools
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st
from stacks import cut_hunt, places
from stacks.cutters import random_cutter
from stacks.cutting import cut_failures, native_arrays
from stacks.generate import FAMILIES, random_stack
from stacks.model_view import built
from stacks.rock_masses import random_rock_masses

native = places.native()
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


def some_planes(rng, vertices):
    """Planes through vertices and along what is there, and one that is nowhere in particular."""

    def vertex():
        return vertices[rng.randrange(len(vertices))]

    p, q, r = vertex(), vertex(), vertex()
    yield p, [(1, 0, 0), (0, 1, 0), (0, 0, 1)][rng.randrange(3)]
    yield p, np.cross(q - p, r - p)  # through three vertices
    yield p, ((q - p)[1], -(q - p)[0], 0)  # vertical, through two
    yield p, [rng.randint(-2, 2) for _ in range(3)]
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    yield low + np.array([rng.random() for _ in range(3)]) * (high - low), [rng.gauss(0, 1) for _ in range(3)]


def area_of(section):
    """The area of a section; cells that are too thin for doubles may have none of it."""
    total = 0.0
    for begin, end in itertools.pairwise(section["offsets"]):
        corners = section["vertices"][section["polygon_vertices"][begin:end]]
        spokes = corners[1:] - corners[0]
        total += np.linalg.norm(np.cross(spokes[:-1], spokes[1:]).sum(axis=0)) / 2
    return total


def judge(rng, case):
    cells = rng.choice(("columns", "blocks"))
    model = native_arrays(case, built(case, cells=cells, threads=1), cells)
    heights = np.unique(model["vertices"][:, 2])
    if not len(model["cell_block"]) or np.diff(heights).min(initial=1.0) < 1e-300:
        return  # no room between two heights for a part of a cell
    for point, normal in some_planes(rng, model["vertices"]):
        point, normal = [float(x) for x in point], [float(x) for x in normal]
        if not any(normal) or not np.isfinite(normal).all():
            continue
        cut = native.cut_by_plane(model, point, normal, 1)
        assert cut_failures(model, cut) == [], (point, normal, cells)
        section = native.section_by_plane(model, point, normal, 2)
        assert section["polygon_vertices"].max(initial=-1) == len(section["vertices"]) - 1
        if any(np.diff(np.unique(axis)).min(initial=1.0) < 1e-9 for axis in model["vertices"].T):
            continue  # cells as thin as rounding: the section alone does not look at their parts
        areas = [area_of(found) for found in (section, cut["section"])]
        extent = np.ptp(model["vertices"], axis=0).max()
        step = np.spacing(np.abs(model["vertices"]).max())
        assert abs(areas[0] - areas[1]) <= 1e-9 * areas[1] + 1e3 * step * extent


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
