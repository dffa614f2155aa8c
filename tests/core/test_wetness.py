# SPDX-License-Identifier: GPL-3.0-or-later
"""Wetness: low places and hollows that face north."""

import numpy as np
from realmodel.core.display import polygon_mesh
from realmodel.core.display.wetness import wetness


def wall(north, bump):
    """A vertical wall of 4 x 4 squares that faces north or south, of which the middle is moved outward."""
    x, z = (part.ravel() for part in np.meshgrid(np.arange(5.0), np.arange(5.0)))
    y = np.where((x == 2) & (z == 2), bump if north else -bump, 0.0)
    a = (np.arange(4)[:, None] * 5 + np.arange(4)).ravel()
    triangles = np.concatenate([np.column_stack([a, a + 1, a + 6]), np.column_stack([a, a + 6, a + 5])])
    triangles = triangles[:, ::-1] if north else triangles
    return polygon_mesh.of_triangles(
        np.column_stack([x, y, z]).astype(np.float32), triangles.astype(np.int32)
    )


def of(shape, low=0.0, high=4.0):
    return wetness(shape.coordinates, shape.offsets, shape.corners, shape.edges, low, high)


def test_a_plain_wall_is_wet_below_and_dry_above():
    values = of(wall(True, 0.0)).reshape(5, 5)
    np.testing.assert_allclose(values, (np.square(1 - np.arange(5) / 4))[:, None] * np.ones(5), atol=1e-6)


def test_a_hollow_is_wet_where_it_faces_north():
    middle = 12
    assert of(wall(True, -0.5))[middle] > 0.9
    assert of(wall(True, 0.5))[middle] == of(wall(True, 0.0))[middle]
    assert of(wall(False, -0.5))[middle] < of(wall(False, 0.0))[middle] + 1e-6


def test_values_are_from_0_to_1():
    for north in (True, False):
        values = of(wall(north, -3.0), low=1.0, high=2.0)
        assert values.min() >= 0.0
        assert values.max() <= 1.0
