# SPDX-License-Identifier: GPL-3.0-or-later
"""Blocks with fewer triangles: closed, as thick as they were, and the same in parts."""

import numpy as np
import pytest
from realmodel.core import Project, Rock, Surface, build
from realmodel.core.display.polygon_mesh import coarsened, joined, of_blocks


def layers(n=40):
    """A thick layer under one that is thin and ends in the middle."""
    x, y = (each.ravel() for each in np.meshgrid(np.arange(n + 1.0), np.arange(n + 1.0)))
    corner = (np.arange(n)[:, None] * (n + 1) + np.arange(n)).ravel()
    triangles = np.concatenate(
        [
            np.column_stack([corner, corner + 1, corner + n + 2]),
            np.column_stack([corner, corner + n + 2, corner + n + 1]),
        ]
    )
    low = np.column_stack([x, y, 3 + np.sin(x / 9)])
    high = np.column_stack([x, y, 3 + np.sin(x / 9) + 0.01 * (20.5 - y)])
    surfaces = [Surface("low", low, triangles), Surface("high", high, triangles, rule="conformable")]
    return build(Project("layers", [Rock("rock", surfaces, base_elevation=0.0)]))


def volume(mesh):
    a, b, c = mesh.coordinates.astype(float)[mesh.corners.reshape(-1, 3)].transpose(1, 0, 2)
    return np.einsum("ij,ij->", a, np.cross(b, c)) / 6


def assert_closed(mesh):
    corners = mesh.corners.reshape(-1, 3)
    steps = np.concatenate([corners[:, [0, 1]], corners[:, [1, 2]], corners[:, [2, 0]]]).astype(np.int64)
    forward, backward = (steps[:, k] << 32 | steps[:, 1 - k] for k in (0, 1))
    assert np.array_equal(np.sort(forward), np.sort(backward))


@pytest.mark.parametrize("size", [1.5, 4.0, 9.0])
def test_coarse_blocks_are_closed_and_keep_their_thickness(size):
    model = layers()
    for block, shape in zip(model.blocks, of_blocks(model, np.zeros(3)), strict=True):
        mesh = coarsened(shape, size)
        assert_closed(mesh)
        assert mesh.polygons < 12 * (40 / size + 2) ** 2
        assert abs(volume(mesh) / block.volume - 1) < 0.4 * size / 9 + 0.1, (block.name, size)
        assert len(np.unique(mesh.corners)) == len(mesh.coordinates)


def test_what_is_smaller_than_a_square_vanishes():
    model = layers(2)
    shape = of_blocks(model, np.zeros(3))[0]
    assert coarsened(shape, 100.0) is None


def test_parts_become_one():
    model = layers()
    one, other = (coarsened(shape, 4.0) for shape in of_blocks(model, np.zeros(3)))
    both = joined([one, other])
    assert both.polygons == one.polygons + other.polygons
    assert np.isclose(volume(both), volume(one) + volume(other))
