# SPDX-License-Identifier: GPL-3.0-or-later
"""Inequalities of heights, against quadratic programs solved by brute force."""

import itertools
from dataclasses import replace

import numpy as np
import pytest
from dense_kriging import semivariance
from realmodel.core import (
    Bounds,
    Dips,
    Fault,
    InputRefused,
    Project,
    Rock,
    Surface,
    interpolate,
    mesh_region,
)
from realmodel.core.base.work import Work, native_module
from realmodel.core.heights.bounded import TOLERANCE, consistent
from realmodel.core.heights.interpolation import Task
from realmodel.core.heights.realizations.draws import Draw
from realmodel.core.heights.realizations.turning_bands import FieldArea, Noise
from realmodel.core.settings.methods import checked_options
from realmodel.core.structures.setup import make_structures, mesh_inputs, read_inputs
from structure_cases import heights_at, plane_fault

VARIOGRAM = {"model": "matern52", "range": 60.0, "sill": 40.0}


def plan(count, seed):
    return np.random.default_rng(seed).random((count, 2)) * 100


def wavy(places):
    return 5 * np.sin(places[:, 0] / 12) * np.cos(places[:, 1] / 15)


def bounds_of(places, is_lower):
    count = len(places)
    return Bounds(
        np.asarray(places, float), np.asarray(is_lower, bool), np.full(count, ""), np.full(count, np.nan)
    )


POINTS = np.column_stack([plan(12, 1), wavy(plan(12, 1))])
NODES = plan(50, 2)


def random_bounds(count, seed):
    """Above or below a surface that the points do not show."""
    places = plan(count, seed)
    is_lower = np.arange(count) % 2 == 0
    return bounds_of(np.column_stack([places, wavy(places) + np.where(is_lower, -0.3, 0.3)]), is_lower)


def missed(z, bounds):
    below = np.where(bounds.is_lower, bounds.places[:, 2] - z, z - bounds.places[:, 2])
    return float(below.max())


def height_range(bounds):
    return float(np.ptp(np.concatenate([POINTS[:, 2], bounds.places[:, 2]])))


@pytest.mark.parametrize("method", ["kriging", "universal_kriging", "spline"])
@pytest.mark.parametrize("neighbours", [0, 8])
def test_every_bound_holds(method, neighbours):
    bounds = random_bounds(200, 3)
    positions = np.ascontiguousarray(bounds.places[:, :2])
    options = {} if method == "spline" else {"variogram": VARIOGRAM}
    free = interpolate(POINTS, positions, method, neighbours=neighbours, **options)
    assert missed(free.z, bounds) > 1
    result = interpolate(POINTS, positions, method, neighbours=neighbours, bounds=bounds, **options)
    assert missed(result.z, bounds) <= TOLERANCE * height_range(bounds)
    at_points = interpolate(POINTS, POINTS[:, :2], method, neighbours=neighbours, bounds=bounds, **options)
    assert np.array_equal(at_points.z, POINTS[:, 2])
    one = interpolate(POINTS, NODES, method, neighbours=neighbours, bounds=bounds, threads=1, **options)
    two = interpolate(POINTS, NODES, method, neighbours=neighbours, bounds=bounds, threads=2, **options)
    assert one.z.tobytes() == two.z.tobytes()
    assert (
        abs(one.z - wavy(NODES)).mean()
        < 0.5
        * abs(interpolate(POINTS, NODES, method, neighbours=neighbours, **options).z - wavy(NODES)).mean()
    )


def smoothest(points, bounds):
    """(A, 3) of all sets of active bounds the one of least energy that keeps them all: kriging's quadratic
    program by brute force."""
    best, least = None, np.inf
    for size in range(len(bounds) + 1):
        for some in itertools.combinations(range(len(bounds)), size):
            data = np.vstack([points, bounds.places[list(some)]])
            n = len(data)
            system = np.ones((n + 1, n + 1))
            system[:n, :n] = VARIOGRAM["sill"] - semivariance(data, data, VARIOGRAM)
            system[n, n] = 0
            dual = np.linalg.solve(system, np.append(data[:, 2], 0))
            c = VARIOGRAM["sill"] - semivariance(bounds.places, data, VARIOGRAM)
            z = c @ dual[:n] + dual[n]
            energy = dual[:n] @ data[:, 2]
            if missed(z, bounds) <= 1e-9 and energy < least:
                best, least = bounds.places[list(some)], energy
    return best


@pytest.mark.parametrize("seed", range(12))
def test_the_surface_is_the_smoothest_that_keeps_the_bounds(seed):
    bounds = random_bounds(8, 100 + seed)
    expected = smoothest(POINTS, bounds)
    result = interpolate(POINTS, NODES, neighbours=0, variogram=VARIOGRAM, bounds=bounds)
    as_points = interpolate(np.vstack([POINTS, expected]), NODES, neighbours=0, variogram=VARIOGRAM)
    np.testing.assert_allclose(result.z, as_points.z, atol=1e-7)
    np.testing.assert_allclose(result.variance, as_points.variance, atol=1e-7)


def test_bounds_that_the_surface_keeps_anyway_change_no_byte():
    far = random_bounds(40, 7)
    far = bounds_of(far.places + np.where(far.is_lower, -50, 50)[:, None] * [0, 0, 1], far.is_lower)
    options = {"variogram": VARIOGRAM, "neighbours": 8}
    plain = interpolate(POINTS, NODES, **options)
    assert interpolate(POINTS, NODES, bounds=far, **options).z.tobytes() == plain.z.tobytes()


def test_the_fewest_of_contradicting_bounds_are_left_out():
    at = [50.0, 50.0]
    places = [[*at, 3.0], [*at, 4.0], [*at, 1.0], [*POINTS[0, :2], POINTS[0, 2] + 1], [*POINTS[1, :2], 99.0]]
    bounds = bounds_of(places, [True, True, False, True, False])
    found = consistent(POINTS, bounds)
    assert found.left_out.tolist() == [2, 3]
    assert (found.lower.tolist(), found.upper.tolist()) == ([4.0], [np.inf])
    result = interpolate(POINTS, [at], variogram=VARIOGRAM, bounds=bounds)
    assert result.z[0] >= 4
    (warning,) = result.warnings
    assert "2 of 5 bounds contradict" in warning and "at or below" in warning
    other = consistent(POINTS, bounds_of([[*at, 3.0], [*at, 1.0], [*at, 2.0]], [True, False, False]))
    assert other.left_out.tolist() == [0]
    equal = consistent(POINTS, bounds_of([[*at, 3.0], [*at, 3.0]], [True, False]))
    assert not len(equal.left_out) and equal.lower[0] == equal.upper[0] == 3


def test_bounds_and_dips_together():
    bounds = random_bounds(60, 9)
    places = plan(10, 11)
    slopes = np.column_stack(
        [
            5 / 12 * np.cos(places[:, 0] / 12) * np.cos(places[:, 1] / 15),
            -5 / 15 * np.sin(places[:, 0] / 12) * np.sin(places[:, 1] / 15),
        ]
    )
    options = {"variogram": VARIOGRAM, "neighbours": 0, "dips": Dips(places, slopes), "bounds": bounds}
    z = interpolate(POINTS, np.ascontiguousarray(bounds.places[:, :2]), **options).z
    assert missed(z, bounds) <= TOLERANCE * height_range(bounds)
    ends = [
        interpolate(POINTS, places + way, **options).z for way in np.vstack([np.eye(2), -np.eye(2)]) * 0.05
    ]
    found = np.column_stack([ends[0] - ends[2], ends[1] - ends[3]]) / 0.1
    np.testing.assert_allclose(found, slopes, atol=5e-3)


def test_bounds_that_are_not_finite_are_refused():
    with pytest.raises(InputRefused, match="bound 1 is not finite"):
        interpolate(POINTS, NODES, bounds=bounds_of([[0, 0, 0], [0, np.nan, 1]], [True, True]))


def test_an_automatic_method_keeps_bounds():
    bounds = random_bounds(50, 13)
    result = interpolate(POINTS, np.ascontiguousarray(bounds.places[:, :2]), "auto", bounds=bounds)
    if result.method != "natural_neighbour":
        assert missed(result.z, bounds) <= TOLERANCE * height_range(bounds)


@pytest.mark.parametrize("method", ["universal_kriging", "dsi"])
def test_bounds_count_on_their_side_of_a_fault(method):
    """A level surface that bounds lift on one side."""
    points = np.column_stack([np.random.default_rng(3).uniform(0, 10, (60, 2)), np.zeros(60)])
    points = points[(points[:, 0] < 3) | (points[:, 0] > 5)]
    places = np.array([[4.0, 2.0, 1.0], [4.0, 8.0, 1.0], [9.0, 5.0, 0.5]])
    bounds = bounds_of(places, [True, True, False])
    surface = Surface("A", points=points, method=method)
    rock = Rock("R", [surface], SQUARE / 10, edge_length=0.4, base_elevation=-20.0)
    project = Project("P", [rock], faults=[Fault("F", *plane_fault())])
    inputs, known = read_inputs(Work(), project)
    (entry,) = inputs
    entry.data[0] = replace(entry.data[0], bounds=bounds)
    mesh_inputs(Work(), inputs)
    make_structures(Work(), known, inputs, None)
    sheets = [entry.structure.sheet(number, 0) for number in range(len(entry.structure.compartments))]
    at = np.array([[4.5, 5.0], [9.0, 5.0]])
    lifted, level = sorted((heights_at(at, *sheet) for sheet in sheets), key=lambda z: -z[0])
    assert lifted[0] > 0.3
    np.testing.assert_allclose(level, 0, atol=1e-6)


def test_ten_thousand_bounds_are_affordable():
    points = np.column_stack([plan(400, 20), wavy(plan(400, 20))])
    bounds = random_bounds(10_000, 21)
    z = interpolate(points, np.ascontiguousarray(bounds.places[:, :2]), variogram=VARIOGRAM, bounds=bounds).z
    assert missed(z, bounds) <= TOLERANCE * height_range(bounds)


@pytest.mark.parametrize("nugget", [0.0, 1.0])
def test_realizations_keep_bounds(nugget):
    bounds = random_bounds(60, 15)
    settings = checked_options("kriging", {"variogram": {**VARIOGRAM, "nugget": nugget}, "neighbours": 8})
    places = np.ascontiguousarray(bounds.places[:, :2])
    task = Task(Work(), POINTS, places, settings, bounds=bounds)
    drawn = []
    for seed in (1, 2):
        draw = Draw(FieldArea(np.zeros(2), np.full(2, 100.0)), Noise((seed, 0)), {})
        drawn.append(draw.heights("kriging", task).z)
        if not nugget:
            assert missed(drawn[-1], bounds) <= 1e-7
        free = Draw(FieldArea(np.zeros(2), np.full(2, 100.0)), Noise((seed, 0)), {})
        assert missed(free.heights("kriging", replace(task, bounds=None)).z, bounds) > 1
        at_points = draw.heights("kriging", replace(task, nodes=np.ascontiguousarray(POINTS[:, :2])))
        np.testing.assert_allclose(at_points.z, POINTS[:, 2], atol=1e-9)
    assert abs(drawn[0] - drawn[1]).max() > 0.1


SQUARE = np.array([[0.0, 0.0], [100.0, 0.0], [100.0, 100.0], [0.0, 100.0]])


def on_mesh(bounds, edge_length=4.0, **options):
    """The heights of dsi at the bounds, and the warnings."""
    nodes, triangles = mesh_region(SQUARE, edge_length=edge_length)
    result = interpolate(POINTS, nodes, "dsi", triangles=triangles, bounds=bounds, **options)
    vertices, places = np.column_stack([nodes, result.z]), np.ascontiguousarray(bounds.places[:, :2])
    return native_module().surface_heights(vertices, triangles, places), result.warnings


def test_a_mesh_keeps_bounds_within_its_triangles():
    bounds = random_bounds(60, 3)
    nodes, triangles = mesh_region(SQUARE, edge_length=4.0)
    plain = interpolate(POINTS, nodes, "dsi", triangles=triangles)
    places = np.ascontiguousarray(bounds.places[:, :2])
    z = native_module().surface_heights(np.column_stack([nodes, plain.z]), triangles, places)
    assert missed(z, bounds) > 1
    z, warnings = on_mesh(bounds)
    assert missed(z, bounds) <= TOLERANCE * height_range(bounds)
    assert warnings == ()
    assert on_mesh(bounds, threads=1)[0].tobytes() == z.tobytes()
    assert missed(on_mesh(bounds, weight=1.0)[0], bounds) <= TOLERANCE * height_range(bounds)


def test_bounds_that_a_mesh_cannot_keep_are_told():
    nodes, triangles = mesh_region(SQUARE, edge_length=40.0)
    middle = nodes[triangles[0]].mean(axis=0)
    bounds = bounds_of([[*middle, 0.0], [*(middle + 0.01), 5.0]], [False, True])
    points = np.column_stack([nodes[triangles[0]], np.zeros(3)])
    result = interpolate(points, nodes, "dsi", triangles=triangles, bounds=bounds)
    assert any("bounds cannot be kept on this mesh" in text for text in result.warnings)
    contradicting = bounds_of([[*points[0, :2], 9.0]], [True])
    result = interpolate(points, nodes, "dsi", triangles=triangles, bounds=contradicting)
    assert any("1 of 1 bounds contradict" in text for text in result.warnings)


@pytest.mark.parametrize(
    ("point", "lower", "upper"),
    [
        (
            [40.8, 85.4, -0.2],
            [[83.8, 27.1, 1.4], [17.8, 34.6, -11.9], [41.8, 64.2, -3.6], [89.1, 24.5, 2.1]],
            [],
        ),
        (
            [59.5, 68.9, 1.7],
            [[65.8, 22.7, 3.5], [65.5, 94.3, -4.3], [23.9, 81.8, 1.0], [67.9, 25.0, 1.3]],
            [[15.1, 91.2, 3.0], [21.6, 90.9, 1.1], [35.6, 44.7, 3.9]],
        ),
    ],
)
def test_bounds_of_dsi_hold_where_points_leave_a_tilt_open(point, lower, upper):
    """A plane satisfies all of them. The set of bounds that counted ran in circles."""
    along = np.linspace(0, 100, 9)
    nodes = np.array([(x, y) for y in along for x in along])
    first = np.array([9 * row + column for row in range(8) for column in range(8)])[:, None]
    triangles = np.concatenate([first + np.array(each) for each in ([0, 1, 10], [0, 10, 9])]).astype(np.int32)
    given = bounds_of([*lower, *upper], [True] * len(lower) + [False] * len(upper))
    result = interpolate([point], nodes, "dsi", triangles=triangles, bounds=given)
    assert not [text for text in result.warnings if "cannot" in text]
    assert np.ptp(result.z) < 40.0
