# SPDX-License-Identifier: GPL-3.0-or-later
"""Locating points in cells where doubles are not precise enough."""

import numpy as np
import pytest
from realmodel.core import Project, Rock, Surface, build
from structure_cases import cells_at

UP = np.nextafter(1.0, 2.0)


def sheet(height):
    nodes = np.array([[x, y, height(x, y)] for x in (0.0, 1.0, 2.0) for y in (0.0, 1.0, 2.0)])
    triangles = [(n, *rest) for n in (0, 1, 3, 4) for rest in ((n + 3, n + 4), (n + 4, n + 1))]
    return {"vertices": nodes, "triangles": np.array(triangles, np.int32)}


@pytest.fixture(scope="module")
def model():
    """S2 is one unit in the last place above S1, at one node."""
    heights = (
        lambda x, y: 0.0,
        lambda x, y: 1.0,
        lambda x, y: UP if x == y == 1.0 else 1.0,
        lambda x, y: 2.0,
    )
    surfaces = [Surface(f"S{k}", **sheet(height)) for k, height in enumerate(heights)]
    return build(Project("p", [Rock("r", surfaces)]))


# within triangles, on edges in plan, at a corner of several cells
PLACES = [(0.25, 0.5), (0.3, 0.9), (1.7, 0.1), (0.5, 0.5), (1.0, 0.5), (0.25, 1.0), (1.0, 1.0)]


@pytest.mark.parametrize("place", PLACES)
def test_above_and_below_a_cell_thinner_than_the_precision_of_doubles(model, place):
    points = np.array([(*place, z) for z in (-0.5, 0.5, 1.5, 2.5)])
    cells = cells_at(model, points)
    assert cells[0] == cells[3] == -1
    names = [model.blocks[block].name for block in model.cell_block[cells[1:3]]]
    assert names == ["S1 block", "S3 block"]


def test_a_point_on_a_face_is_above_it(model):
    points = np.array([(0.25, 0.5, z) for z in (0.0, 1.0, 2.0)])
    cells = cells_at(model, points)
    assert cells[2] == -1
    names = [model.blocks[block].name for block in model.cell_block[cells[:2]]]
    assert names == ["S1 block", "S2 block"]
