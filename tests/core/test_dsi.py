# SPDX-License-Identifier: GPL-3.0-or-later
"""Discrete smooth interpolation against its definition, solved densely."""

from collections import defaultdict

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from realmodel.core import Cancelled, InputRefused, UsageError, cross_validate, interpolate, mesh_region
from realmodel.core.base.errors import place_text

RNG = np.random.default_rng(23)
UTM = np.array([431250.37, 5398781.81])


def utm(*places):
    return np.array(places, float) + UTM


OUTLINE = utm([0, 0], [100, 0], [100, 80], [40, 80], [40, 50], [0, 50])
HOLE = utm([70, 20], [80, 20], [80, 30], [70, 30])
NODES, TRIANGLES = mesh_region(OUTLINE, holes=[HOLE], edge_length=8)


def inside(count, rng=RNG):
    """Places in the triangles."""
    weights = rng.dirichlet([1, 1, 1], count)
    corners = NODES[TRIANGLES[rng.integers(0, len(TRIANGLES), count)]]
    return np.einsum("pk,pkx->px", weights, corners)


def wavy(plan):
    return 300 + 5 * np.sin((plan[:, 0] - UTM[0]) / 15) * np.cos((plan[:, 1] - UTM[1]) / 20)


PLAN = inside(15)
POINTS = np.column_stack([PLAN, wavy(PLAN)])


def slopes_change(nodes, triangles):
    """(E, N): for each inner edge the jump of the slope across it, times L / sqrt(A + B)."""
    sides = defaultdict(list)
    for triangle in triangles:
        for k in range(3):
            sides[frozenset((triangle[k], triangle[(k + 1) % 3]))].append(triangle)
    rows = []
    for edge, both in sides.items():
        if len(both) < 2:
            continue
        a, b = edge
        along = (nodes[b] - nodes[a]) / np.linalg.norm(nodes[b] - nodes[a])
        across = np.array([-along[1], along[0]])
        row, areas = np.zeros(len(nodes)), 0.0
        for sign, triangle in zip((1, -1), both, strict=True):
            edges = np.vstack(
                [nodes[triangle[1]] - nodes[triangle[0]], nodes[triangle[2]] - nodes[triangle[0]]]
            )
            gradient = np.linalg.inv(edges) @ [[-1, 1, 0], [-1, 0, 1]]  # (2, 3), of heights at the corners
            row[triangle] += sign * across @ gradient
            areas += abs(np.linalg.det(edges)) / 2
        rows.append(row * np.linalg.norm(nodes[b] - nodes[a]) / np.sqrt(areas))
    return np.array(rows)


def weights_of(points, nodes, triangles):
    """(P, N): what gives the height at each point."""
    rows = np.zeros((len(points), len(nodes)))
    for row, point in zip(rows, points, strict=True):
        for triangle in triangles:
            corners = np.vstack([(nodes[triangle] - point[:2]).T, np.ones(3)])
            weights = np.linalg.solve(corners, [0, 0, 1])
            if weights.min() > -1e-9:
                row[triangle] = weights
                break
    return rows


CHANGES = slopes_change(NODES, TRIANGLES)
ROUGHNESS = CHANGES.T @ CHANGES


def held(rows, heights):
    """The smoothest heights with rows @ z == heights, by Lagrange's multipliers."""
    n = len(rows)
    system = np.block([[ROUGHNESS, rows.T], [rows, np.zeros((n, n))]])
    return np.linalg.lstsq(system, np.concatenate([np.zeros(len(NODES)), heights]), rcond=1e-13)[0][
        : len(NODES)
    ]


def dsi(points, **options):
    return interpolate(points, NODES, "dsi", triangles=TRIANGLES, **options)


def test_points_hold_as_in_dense_algebra():
    rows = weights_of(POINTS, NODES, TRIANGLES)
    result = dsi(POINTS)
    assert result.z == pytest.approx(held(rows, POINTS[:, 2] - 300) + 300, abs=1e-5)
    assert rows @ result.z == pytest.approx(POINTS[:, 2], abs=1e-6)
    assert (result.method, result.variance, result.warnings) == ("dsi", None, ())


@pytest.mark.parametrize("weight", [0.01, 1.0, 50.0])
def test_weighted_points_as_in_dense_algebra(weight):
    rows = weights_of(POINTS, NODES, TRIANGLES)
    diagonal = np.array([ROUGHNESS.diagonal()[row != 0].mean() for row in rows])
    pull = rows.T * (weight * diagonal)
    expected = np.linalg.solve(ROUGHNESS + pull @ rows, pull @ (POINTS[:, 2] - 300)) + 300
    assert dsi(POINTS, weight=weight).z == pytest.approx(expected, abs=1e-5)


def test_a_plane_comes_out_as_a_plane():
    plan = inside(9)
    slope = np.array([0.3, -0.7])
    points = np.column_stack([plan, 40 + (plan - UTM) @ slope])
    for options in ({}, {"weight": 0.1}):
        assert dsi(points, **options).z == pytest.approx(40 + (NODES - UTM) @ slope, abs=1e-9)


def test_few_points():
    one = dsi(POINTS[:1])
    assert one.z == pytest.approx(np.full(len(NODES), POINTS[0, 2]), abs=1e-9)
    assert "only one point" in one.warnings[0]
    a, b = utm([20, 20], [60, 20])
    two = dsi([[*a, 10], [*b, 20]])
    assert two.z == pytest.approx(10 + (NODES[:, 0] - a[0]) / 4, abs=1e-6)


def test_points_in_one_line_bend_along_it_and_do_not_tilt():
    x = np.linspace(5, 95, 12)
    y = np.full(12, 15.0)
    z = 300 + np.sin(x / 15)
    result = dsi(np.column_stack([UTM + np.column_stack([x, y]), z]))
    assert np.isfinite(result.z).all()
    assert np.abs(result.z - 300).max() < 10
    rows = weights_of(np.column_stack([UTM + np.column_stack([x, y]), z]), NODES, TRIANGLES)
    assert rows @ result.z == pytest.approx(z, abs=1e-5)


def test_a_fixed_border():
    border = np.zeros(len(NODES), bool)
    edges = np.sort(np.concatenate([TRIANGLES[:, [k, (k + 1) % 3]] for k in range(3)]), axis=1)
    pairs, count = np.unique(edges, axis=0, return_counts=True)
    border[pairs[count == 1]] = True
    rows = weights_of(POINTS, NODES, TRIANGLES)
    points = POINTS[(rows[:, border] > 0).sum(axis=1) < 2][:4]  # where the mesh can meet both
    assert len(points) == 4
    result = dsi(points, border=290)
    assert (result.z[border] == 290).all()
    rows = np.vstack([weights_of(points, NODES, TRIANGLES), np.eye(len(NODES))[border]])
    heights = np.concatenate([points[:, 2], np.full(border.sum(), 290)])
    expected = held(rows, heights - 290) + 290
    assert result.warnings == ()
    assert result.z == pytest.approx(expected, abs=1e-4)


@pytest.mark.parametrize("option", ["above", "below"])
def test_bounds_hold_and_push_only_where_they_touch(option):
    sign = 1 if option == "above" else -1
    bound = 300 + sign * 2.0
    # a slope that goes on beyond the bound where there are no points
    heights = bound + sign * np.array([3.0, 3.0, 0.5])
    points = np.column_stack([utm([52, 55], [75, 58], [45, 35]), heights])
    free, result = dsi(points).z, dsi(points, **{option: bound}).z
    assert (sign * (free - bound)).min() < -0.5, "without the bound it is passed"
    assert (sign * (result - bound)).min() >= 0
    rows = weights_of(points, NODES, TRIANGLES)
    assert rows @ result == pytest.approx(points[:, 2], abs=1e-5)
    force = ROUGHNESS @ (result - bound)
    # what pushes: nothing but the points' triangles and, in one direction only, the bound where it touches
    elsewhere = (rows != 0).any(axis=0)
    touching = np.abs(result - bound) < 1e-7
    scale = np.abs(force).max()
    assert force[~elsewhere & ~touching] == pytest.approx(0, abs=1e-4 * scale)
    assert (sign * force[touching & ~elsewhere] > -1e-4 * scale).all()
    assert touching.any()


def test_bounds_from_surfaces():
    low = np.column_stack([OUTLINE[[0, 1, 2]], [295, 299, 299.0]])
    result = dsi(POINTS[:3], above=(low, [[0, 1, 2]]), below=np.full(len(NODES), 310.0))
    bound = interpolate(None, NODES, "parallel", to=(low, [[0, 1, 2]]), thickness=0).z
    known = np.isfinite(bound)
    assert 0 < known.sum() < len(NODES)
    assert (result.z[known] >= bound[known]).all()
    assert (result.z <= 310).all()
    with pytest.raises(InputRefused, match="above = 305 is 5 higher than below = 300 at"):
        dsi(POINTS, above=305, below=300)
    with pytest.raises(InputRefused, match="above = 305 is 3 higher than border = 302 at"):
        dsi(POINTS, above=305, border=302)


def test_points_beyond_a_bound_are_a_warning():
    """The bound goes before them; those outside the mesh never counted."""
    points = np.vstack([POINTS, [[*(UTM - 10), 200.0]]])
    wrong = POINTS[:, 2] < 298
    assert 0 < wrong.sum() < len(POINTS)
    result = dsi(points, above=298)
    worst = int(POINTS[:, 2].argmin())
    warnings = [text for text in result.warnings if "lie below 298, but the surface is kept above it" in text]
    assert len(warnings) == 1 and warnings[0].startswith(f"{wrong.sum()} of 16 points")
    assert f"the point at {place_text(POINTS[worst])}" in warnings[0]
    assert not any("cannot all be honored" in text for text in result.warnings)
    assert result.z.min() == 298
    assert dsi(POINTS, above=POINTS[:, 2].min() - 50).warnings == ()


def test_heights_far_beyond_the_points_are_a_warning():
    """Three points of a triangle that differ by chance make a slope that goes on to the border."""
    middle = NODES[TRIANGLES[7]].mean(axis=0)
    plan = np.add(middle, [[0, 0], [0.2, 0.1], [0.1, 0.2]])
    points = np.column_stack([plan, [10.0, 13.0, 11.0]])
    warnings = dsi(points).warnings
    assert any("go far beyond those of its points, 10 to 13; " in text for text in warnings)
    assert not any("far beyond" in text for text in dsi(points, border=0).warnings)
    assert not any("far beyond" in text for text in dsi(POINTS).warnings)


def test_constraints_that_cannot_be_met_are_a_warning():
    corner = NODES[TRIANGLES[0]].mean(axis=0)
    cluster = np.column_stack([corner + RNG.normal(0, 0.2, (8, 2)), RNG.normal(300, 1, 8)])
    result = dsi(np.vstack([POINTS, cluster]))
    assert "cannot all be honored" in result.warnings[0]
    assert np.isfinite(result.z).all()
    outside = np.vstack([POINTS, [[*(UTM - 10), 0]]])
    beyond = dsi(outside)
    assert "1 of 16 points lie outside the mesh" in beyond.warnings[0]
    assert beyond.z == pytest.approx(dsi(POINTS).z, abs=1e-6)
    with pytest.raises(InputRefused, match="no point lies on the mesh"):
        dsi([[0, 0, 1]])


def test_the_number_of_threads_changes_no_bit():
    nodes, triangles = mesh_region(OUTLINE, edge_length=0.3)
    assert len(nodes) > 66000
    plan = inside(300)
    points = np.column_stack([plan, wavy(plan)])
    one, three = (interpolate(points, nodes, "dsi", triangles=triangles, threads=t).z for t in (1, 3))
    assert np.array_equal(one, three)
    assert np.sqrt(np.mean((one - wavy(nodes)) ** 2)) < 0.3


def test_unused_nodes_and_parts_without_points_follow_the_plane():
    nodes = np.vstack([NODES, utm([300, 0], [310, 0], [300, 10], [200, 200])])
    triangles = np.vstack([TRIANGLES, [[len(NODES), len(NODES) + 1, len(NODES) + 2]]])
    plan = inside(9)
    points = np.column_stack([plan, 40 + (plan - UTM) @ [0.3, -0.7] + RNG.normal(0, 0.1, 9)])
    z = interpolate(points, nodes, "dsi", triangles=triangles).z
    assert z[-4:] == pytest.approx(40 + (nodes[-4:] - UTM) @ [0.3, -0.7], abs=3)


def test_cross_validation_and_refusals():
    found = cross_validate(POINTS, "dsi", folds=5, mesh=(NODES, TRIANGLES))
    out = np.zeros(15, bool)
    out[np.lexsort(POINTS.T[::-1])[1::5]] = True  # every fifth in the order of their places
    z = dsi(POINTS[~out]).z
    expected = interpolate(
        None, PLAN[out], "parallel", to=(np.column_stack([NODES, z]), TRIANGLES), thickness=0
    ).z
    assert found.z[out] == pytest.approx(expected)
    with pytest.raises(UsageError, match="give the triangles"):
        interpolate(POINTS, NODES, "dsi")
    with pytest.raises(UsageError, match="needs mesh"):
        cross_validate(POINTS, "dsi")
    with pytest.raises(UsageError, match="does not use a mesh"):
        cross_validate(POINTS, "idw", mesh=(NODES, TRIANGLES))
    with pytest.raises(InputRefused, match="'weight' must be more than 0"):
        dsi(POINTS, weight=0)
    with pytest.raises(Cancelled):
        dsi(POINTS, cancel=lambda: True) if False else interpolate(POINTS, *_large(), cancel=lambda: True)


def _large():
    nodes, triangles = mesh_region(OUTLINE, edge_length=0.3)
    return nodes, "dsi", triangles


COORDINATE = st.one_of(st.integers(0, 10).map(lambda i: 10.0 * i), st.floats(0, 100))
SETS = st.lists(st.tuples(COORDINATE, COORDINATE, st.floats(-100, 100)), min_size=1, max_size=12)


@settings(max_examples=30, deadline=None)
@given(SETS, st.sampled_from([None, 1.0]))
def test_any_points_give_heights_or_are_refused(points, weight):
    points = np.array(points) + np.append(UTM, 0)
    try:
        z = dsi(points, weight=weight).z
    except InputRefused as error:
        assert "the same position in plan" in str(error) or "no point lies on the mesh" in str(error)
        return
    assert np.isfinite(z).all()


def test_a_single_triangle_and_islands_without_inner_edges_take_points():
    nodes = utm([0, 0], [10, 0], [0, 10], [30, 0], [40, 0], [30, 10], [40, 10])
    triangles = np.array([[0, 1, 2], [3, 4, 5], [4, 6, 5]])
    points = np.column_stack([utm([2, 2], [6, 2], [2, 6], [33, 3], [38, 4], [36, 9]), [1, 4, 9, 2, 3, 7.0]])
    result = interpolate(points, nodes, "dsi", triangles)
    corners = nodes[triangles[0]]
    weights = np.linalg.solve(np.vstack([corners.T, np.ones(3)]), np.vstack([points[:3, :2].T, np.ones(3)]))
    assert np.allclose(weights.T @ result.z[:3], points[:3, 2], atol=1e-5)
    assert np.isfinite(result.z).all()
