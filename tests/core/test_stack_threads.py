# SPDX-License-Identifier: GPL-3.0-or-later
"""Larger stacks: the same bytes for any number of threads and on every run, and as few cells as promised."""

import random

import numpy as np
import pytest
from realmodel._native import Execution, build_stack
from stacks import places
from stacks.case import Stack
from stacks.generate import placement, sine_surface
from stacks.heights import with_jumps
from stacks.model_view import checked_complex, checker_rocks, digest
from stacks.plan import lattice, some_triangles


def sines(seed, surfaces=6, cells=30):
    """Crossing surfaces, each with its own triangulation, 2 cells^2 triangles each."""
    rng = random.Random(seed)
    return Stack([sine_surface(rng, cells, 100.0, 1.2 * k, 1.5) for k in range(surfaces)])


def ties(seed, surfaces=6, cells=24):
    """One integer lattice with heights 0 .. 3, parts left out and jumps: every crossing is a tie."""
    rng = random.Random(seed)
    stack = []
    for k in range(surfaces):
        points, triangles = lattice(rng, cells, "random" if k % 2 else "zigzag")
        vertices = np.array([(x, y, float(rng.randint(0, 3))) for x, y in points])
        if k % 3 == 2:
            triangles = some_triangles(rng, points, triangles)
        triangles = np.array(triangles, np.int32)
        if k % 4 == 3:
            vertices, triangles = with_jumps(rng, vertices, triangles)
        stack.append((vertices, triangles))
    return Stack(stack, base_elevation=-2.0)


def far_away(seed):
    """The ties rotated at UTM-sized coordinates."""
    stack, place = ties(seed), placement(random.Random(seed), "rotated")
    surfaces = [(place(v), t) for v, t in stack.surfaces]
    return Stack(surfaces, base_elevation=float(min(v[:, 2].min() for v, _ in surfaces)) - 1.0)


def many_vertices(seed):
    """Vertices are numbered in ranges of at least 65,536 places in plan: here there are three."""
    return sines(seed, surfaces=2, cells=170)


MAKERS = {"sines": sines, "ties": ties, "far away": far_away, "many vertices": many_vertices}


@pytest.mark.parametrize("cells", ["columns", "blocks"])
@pytest.mark.parametrize("name", MAKERS)
def test_same_bytes(name, cells):
    stack = MAKERS[name](5)
    digests = {
        digest(build_stack(stack.surfaces, None, stack.base_elevation, cells=cells, execution=run))
        for run in map(Execution, (1, 2, 3, 8, 2, 0))
    }
    assert len(digests) == 1


@pytest.mark.skipif(places.checker() is None, reason=places.CHECK_ABSENT)
@pytest.mark.parametrize("cells", ["columns", "blocks"])
@pytest.mark.parametrize("name", MAKERS)
def test_passes_the_outside_check(name, cells):
    stack = MAKERS[name](7)
    result = build_stack(stack.surfaces, None, stack.base_elevation, cells=cells)
    m = checked_complex(stack, result, cells)
    assert places.checker().check_all(m, checker_rocks(stack), 5000) == []
    volumes = places.checker().cell_volumes(m)
    summed = np.bincount(result["cell_block"], weights=volumes, minlength=len(stack.surfaces))
    assert result["volumes"] == pytest.approx(summed, rel=1e-9, abs=1e-9 * summed.max())


def test_about_one_cell_for_each_triangle():
    """Ten crossing surfaces with ten triangulations: not a cell for each piece of an overlay."""
    rng = random.Random(7200)
    surfaces = [sine_surface(rng, 60, 1000.0, 20.0 * k, 10.0) for k in range(10)]
    bounding = sum(len(t) for _, t in surfaces[1:])
    assert len(build_stack(surfaces)["cell_block"]) < 1.4 * bounding
