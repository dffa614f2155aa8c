# SPDX-License-Identifier: GPL-3.0-or-later
"""Positions that only rounding keeps apart are one, in shapes as in maps."""

import numpy as np
import pytest
from realmodel.core.cells.joining import apart, near_positions
from realmodel.core.exporters.shapes.shape_parts import FaceTriangles, _once_each, model_parts
from sample_scripts import built_sample


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("dimensions", [1, 2, 3])
def test_those_that_are_near_are_one(seed, dimensions):
    chance = np.random.default_rng(seed)
    places = chance.uniform(4e5, 5e6, (60, dimensions))
    near = apart(places)
    beside = places[chance.integers(60, size=90)] + chance.uniform(-0.5, 0.5, (90, dimensions)) * near
    positions = chance.permutation(np.concatenate([places, beside]))
    first = near_positions(positions)
    assert (first[first] == first).all()
    assert (first <= np.arange(len(positions))).all()
    far = np.abs(positions[:, None] - positions[None]).max(axis=2)
    is_one = first[:, None] == first[None]
    assert is_one[far < near].all()
    assert not is_one[far > 4.0 * near].any()


def test_no_positions():
    assert len(near_positions(np.empty((0, 3)))) == 0


def test_a_bed_that_rounding_closes_is_not_between():
    """Two triangles with one bed between them, in any order of corners, become one between its neighbors;
    all around a block cancel."""
    corners = np.array([[0, 1, 2], [2, 1, 0], [3, 4, 5], [4, 5, 3], [6, 7, 8]], np.int32)
    blocks = np.array([[0, 1], [2, 1], [3, -1], [-1, 3], [0, 1]])
    found, face, sides = _once_each(corners, np.arange(5), blocks)
    assert found.tolist() == [[0, 1, 2], [6, 7, 8]]
    assert face.tolist() == [0, 4]
    assert sides.tolist() == [[0, 2], [0, 1]]


@pytest.mark.parametrize("name", ["haut_barr", "fault_blocks"])
def test_blocks_have_no_vertices_that_only_rounding_keeps_apart(name):
    model = built_sample(name)
    triangles = FaceTriangles.of(model)
    used = np.unique(triangles.corners)
    assert (near_positions(model.vertices[used]) == np.arange(len(used))).all()
    parts = model_parts(model, triangles)
    existing = [block for block in model.blocks if block.cells]
    for part, block in zip(parts, existing, strict=True):
        edges = np.concatenate([part.triangles[:, [i, (i + 1) % 3]] for i in range(3)])
        forth, times = np.unique(edges, axis=0, return_counts=True)
        back, times_back = np.unique(edges[:, ::-1], axis=0, return_counts=True)
        assert np.array_equal(forth, back)
        assert np.array_equal(times, times_back)
        a, b, c = (part.vertices[part.triangles] - part.vertices[0]).transpose(1, 0, 2)
        assert np.einsum("ij,ij->", a, np.cross(b, c)) / 6 == pytest.approx(block.volume, rel=1e-6)
