# SPDX-License-Identifier: GPL-3.0-or-later
"""Lattices in space and the tetrahedra that their cells are divided into."""

import numpy as np
import pytest
from realmodel.core.fields import Lattice, ScalarField

LATTICE = Lattice((-1.0, 2.0, 10.0), (0.5, 1.0, 2.0), (4, 3, 5))
RNG = np.random.default_rng(4)


def _points(count):
    low, high = LATTICE.corners
    return RNG.uniform(low, high, (count, 3))


def test_nodes_are_numbered_along_x_first():
    positions = LATTICE.positions()
    assert positions.shape == (LATTICE.nodes, 3)
    i, j, k = 2, 1, 3
    np.testing.assert_array_equal(positions[i + 4 * (j + 3 * k)], [0.0, 3.0, 16.0])
    np.testing.assert_array_equal(positions[LATTICE.strides.sum()], [-0.5, 3.0, 12.0])


def test_tetrahedra_have_positive_volumes_that_fill_the_box():
    corners = LATTICE.positions()[LATTICE.tetrahedra()]
    volumes = np.linalg.det(corners[:, 1:] - corners[:, :1]) / 6
    assert volumes.min() > 0
    low, high = LATTICE.corners
    assert volumes.sum() == pytest.approx(np.prod(high - low))


def test_neighbors_share_whole_faces():
    tetrahedra = np.sort(LATTICE.tetrahedra(), axis=1)
    faces = np.concatenate([np.delete(tetrahedra, k, axis=1) for k in range(4)])
    unique, counts = np.unique(faces, axis=0, return_counts=True)
    assert set(counts) == {1, 2}
    # those of one tetrahedron only lie on the box
    corners = LATTICE.positions()[unique[counts == 1]]
    low, high = LATTICE.corners
    flat = (corners == low).all(axis=1) | (corners == high).all(axis=1)
    assert flat.any(axis=1).all()


def test_points_lie_in_the_tetrahedra_that_are_found():
    points = np.concatenate([_points(200), LATTICE.positions()])
    nodes, weights = LATTICE.located(points)
    assert weights.min() >= 0
    np.testing.assert_allclose(weights.sum(axis=1), 1)
    np.testing.assert_allclose((LATTICE.positions()[nodes] * weights[..., None]).sum(axis=1), points)
    known = {tuple(row) for row in np.sort(LATTICE.tetrahedra(), axis=1)}
    assert {tuple(row) for row in np.sort(nodes, axis=1)} <= known


def test_a_linear_function_is_reproduced_and_unknown_outside():
    values = LATTICE.positions() @ [1.0, -2.0, 0.5] + 3
    field = ScalarField(LATTICE, values, np.array([0.0]))
    points = _points(100)
    np.testing.assert_allclose(field.at(points), points @ [1.0, -2.0, 0.5] + 3)
    low, high = LATTICE.corners
    outside = np.array([low - 1e-6, high + 1e-6, [np.nan, 2.5, 11.0]])
    assert np.isnan(field.at(outside)).all()


def test_values_at_nodes_are_exact():
    values = RNG.normal(size=LATTICE.nodes)
    np.testing.assert_array_equal(ScalarField(LATTICE, values, np.zeros(1)).at(LATTICE.positions()), values)
