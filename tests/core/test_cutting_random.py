# SPDX-License-Identifier: GPL-3.0-or-later
"""Random stacks cut by planes in every position: through vertices, along edges and faces, anywhere."""

import itertools

import numpy as np
import pytest
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st
from stacks import places
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


def some_cutter(rng, stack, vertices):
    """Rough ground, the faces of a box between two vertices, or one of the surfaces of the stack."""
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    kind = rng.choice(("ground", "box", "own"))
    if kind == "own":
        surface, triangles = rng.choice(stack.surfaces)
        return np.array(surface), np.array(triangles)
    if kind == "box":
        p, q = vertices[rng.randrange(len(vertices))], vertices[rng.randrange(len(vertices))]
        p, q = np.minimum(p, q), np.maximum(p, q)
        q = np.where(q > p, q, p + 0.5 * np.maximum(high - low, 1e-3))
        corners = np.array(list(itertools.product(*zip(p, q, strict=True))))
        quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
        return corners, np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))])
    low, high = low - 0.3 * (high - low) - 0.5, high + 0.3 * (high - low) + 0.5
    nx, ny = rng.randint(1, 4), rng.randint(1, 4)
    x, y = np.meshgrid(
        np.linspace(low[0], high[0], nx + 1), np.linspace(low[1], high[1], ny + 1), indexing="ij"
    )
    z = [vertices[rng.randrange(len(vertices)), 2] for _ in range(x.size)]
    number = np.arange(x.size).reshape(x.shape)
    a, b, c, d = number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]
    triangles = [np.stack(t, -1).reshape(-1, 3) for t in ((a, b, c), (a, c, d))]
    return np.column_stack([x.ravel(), y.ravel(), z]), np.concatenate(triangles)


SOUND = ("shared lattice", "own lattices", "coinciding", "partial", "jumps", "rules", "general", "regions")


@pytest.mark.parametrize("family", SOUND)
def test_halves_by_surfaces_and_blocks_are_models(family):
    """What is not refused is right; and little is: a stack's surface may end inside of the model."""
    made, refused = 0, 0

    @settings(usual, max_examples=10)
    @given(chance)
    def judged(rng):
        nonlocal made, refused
        stack = random_stack(rng, family)
        cells = rng.choice(("columns", "blocks"))
        model = native_arrays(stack, built(stack, cells=cells, threads=1), cells)
        if not len(model["cell_block"]):
            return
        block = int(model["cell_block"][rng.randrange(len(model["cell_block"]))])
        vertices, triangles = some_cutter(rng, stack, model["vertices"])
        other = random_stack(rng, family)
        others = native_arrays(other, built(other, cells=cells, threads=1), cells)
        calls = [
            (native.cut_by_block, model, block),
            (native.cut_by_surface, vertices, triangles.astype(np.int32)),
        ]
        if len(others["cell_block"]):
            calls.append((native.cut_by_block, others, int(others["cell_block"][0])))
        for function, *cutter in calls:
            made += 1
            try:
                cut = function(model, *cutter, 1)
            except native.InputError as error:
                assert error.kind in ("ends_inside", "unresolved"), error
                refused += 1
                continue
            assert cut_failures(model, cut) == [], (function.__name__, cells)

    judged()
    assert refused <= made // 4, (refused, made)


@settings(usual, max_examples=20)
@given(chance)
def test_halves_of_rock_masses_are_models(rng):
    judge(rng, random_rock_masses(rng))
