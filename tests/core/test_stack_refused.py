# SPDX-License-Identifier: GPL-3.0-or-later
"""Surfaces that cannot be used are refused with the triangles' numbers and the place."""

import math

import numpy as np
import pytest
from realmodel._native import InputError, build_stack
from realmodel.core import InputRefused, Project, Rock, Surface, build
from stacks.case import as_surface

SQUARE = [(0, 1, 2), (0, 2, 3)]


def plane(z=0.0, size=2.0):
    plan = [(0, 0), (size, 0), (size, size), (0, size)]
    return as_surface([(x, y, z) for x, y in plan], SQUARE)


def refused(*surfaces, **options):
    """What build_stack says about the surfaces given."""
    with pytest.raises(InputError) as raised:
        build_stack(list(surfaces), **options)
    return raised.value


def refused_by_the_core(*surfaces, **options):
    """The same through Project and build: the one line that a user reads."""
    named = [Surface(name=f"S{k}", vertices=v, triangles=t) for k, (v, t) in enumerate(surfaces)]
    with pytest.raises(InputRefused) as raised:
        build(Project(name="case", rocks=[Rock(name="rock", surfaces=named, **options)]))
    return str(raised.value)


def vertical():
    """A level square with triangle 2 standing upright on its diagonal."""
    vertices, triangles = plane(1.0)
    return as_surface([*vertices, (1, 1, 5)], [*triangles, (0, 2, 4)])


def overlapping():
    """Triangle 2 covers a corner of triangle 0 from above."""
    vertices, triangles = plane(1.0)
    return as_surface([*vertices, (1, -1, 2), (3, -1, 2), (3, 2, 2)], [*triangles, (4, 5, 6)])


def test_vertical_triangle():
    error = refused(plane(), vertical())
    assert error.kind == "vertical_triangle"
    assert (error.surface, list(error.items)) == (1, [2])
    x, y, z = error.place
    assert x == pytest.approx(y)
    assert 0 <= x <= 2
    assert 1 <= z <= 5
    message = refused_by_the_core(plane(), vertical())
    assert "S1" in message
    assert "2" in message
    assert "vertical" in message


def test_nearly_vertical_triangle_is_fine():
    vertices, _ = vertical()
    vertices[4, :2] = [1, math.nextafter(1, 2)]
    lone = as_surface(vertices[[0, 2, 4]], [(0, 1, 2)])
    assert build_stack([plane(), lone])["volumes"][1] >= 0


def test_double_valued_pair():
    error = refused(plane(), overlapping())
    assert error.kind == "double_valued"
    assert error.surface == 1
    assert sorted(error.items) == [0, 2]
    x, y, _ = error.place
    assert 1 <= x <= 2
    assert 0 <= y <= 0.5
    message = refused_by_the_core(plane(), overlapping())
    assert "S1" in message
    assert "0" in message
    assert "2" in message


def test_the_same_triangle_twice_is_double_valued():
    vertices, triangles = plane(1.0)
    doubled = as_surface(vertices, [*triangles, (2, 1, 0)])
    error = refused(doubled)
    assert error.kind == "double_valued"
    assert sorted(error.items) == [0, 2]


def side_by_side(overlap):
    """Two squares, the second reaching over the border by almost nothing."""
    left, triangles = plane(1.0)
    right = left + np.array([2.0, 0.0, 0.0])
    right[[0, 3], 0] -= overlap
    return as_surface(np.vstack([left, right]), np.vstack([triangles, triangles + 4]))


@pytest.mark.parametrize("overlap", [2.0**-30, 2.0**-40])
def test_overlap_of_a_hair_is_seen(overlap):
    error = refused(plane(), side_by_side(overlap))
    assert error.kind == "double_valued"
    assert all(0 <= i < 4 for i in error.items)


def test_borders_that_overlap_by_rounding_are_taken_as_one():
    result = build_stack([plane(size=4.0), side_by_side(2.0**-52)])
    assert result["volumes"] == pytest.approx([0, 8])
    assert len(result["vertices"]) < 20


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_not_finite(value):
    vertices, triangles = plane(1.0)
    vertices[2, 2] = value
    error = refused(plane(), (vertices, triangles))
    assert error.kind == "not_finite"
    assert error.surface == 1
    assert list(error.items) == [2] or set(error.items) <= {0, 1}
    message = refused_by_the_core(plane(), (vertices, triangles))
    assert "S1" in message


@pytest.mark.parametrize("index", [-1, 4, 2**31 - 1])
def test_bad_index(index):
    vertices, triangles = plane(1.0)
    triangles[1, 1] = index
    error = refused(plane(), (vertices, triangles))
    assert error.kind == "bad_index"
    assert (error.surface, list(error.items)) == (1, [1])
    assert "S1" in refused_by_the_core(plane(), (vertices, triangles))


@pytest.mark.parametrize("base", [0.0, 0.5, 7.0])
def test_base_elevation_not_below(base):
    """The lowest place of all is the corner (2, 2) at 0: equal is not below."""
    vertices, triangles = plane(1.0)
    vertices[2, 2] = 0.0
    error = refused((vertices, triangles), plane(2.0), base_elevation=base)
    assert error.kind == "base_not_below"
    assert error.place == pytest.approx((2, 2, 0))
    if base >= 2.0:  # else the core cuts the surfaces off there
        message = refused_by_the_core((vertices, triangles), plane(2.0), base_elevation=base)
        assert "base_elevation 7 is not below any of the rock mass" in message


def test_base_elevation_just_below_is_fine():
    base = math.nextafter(0.0, -1.0)
    result = build_stack([plane(0.0), plane(2.0)], base_elevation=-1e-300)
    assert result["volumes"][1] == pytest.approx(8)
    assert build_stack([plane(0.0), plane(2.0)], base_elevation=base)["volumes"][1] == pytest.approx(8)


def test_flat_triangles_are_left_out_with_a_warning():
    vertices, triangles = plane(1.0)
    vertices = [*vertices, (1, 1, 1)]
    with_flat = as_surface(vertices, [*triangles, (0, 0, 1), (0, 4, 2)])
    result = build_stack([plane(), with_flat])
    assert result["volumes"][1] == pytest.approx(4)
    warned = [(surface, sorted(items)) for _, surface, items, _ in result["warnings"]]
    assert sorted(i for surface, items in warned if surface == 1 for i in items) == [2, 3]
    assert all(surface == 1 for surface, _ in warned)
    assert all(text for *_, text in result["warnings"])
