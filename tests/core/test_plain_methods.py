# SPDX-License-Identifier: GPL-3.0-or-later
"""Methods for few points, for triangulations of points, and for grids."""

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from realmodel.core import InputRefused, Project, Rock, Surface, build, cross_validate, interpolate
from scipy.interpolate import LinearNDInterpolator

RNG = np.random.default_rng(17)
UTM = np.array([431250.25, 5398781.5])
PLAN = UTM + RNG.random((200, 2)) * 1000
NODES = UTM + RNG.random((300, 2)) * 1000


def tilted(plan):
    return 300 + 0.1 * (plan[:, 0] - UTM[0]) - 0.25 * (plan[:, 1] - UTM[1])


def wavy(plan):
    return 300 + 20 * np.sin((plan[:, 0] - UTM[0]) / 150) * np.cos((plan[:, 1] - UTM[1]) / 200)


ON_PLANE = np.column_stack([PLAN, tilted(PLAN)])
WAVY = np.column_stack([PLAN, wavy(PLAN)])


@pytest.mark.parametrize("method", ["tin", "natural_neighbour", "plane"])
def test_a_plane_comes_out_as_a_plane(method):
    result = interpolate(ON_PLANE, NODES, method, extrapolate="none")
    known = np.isfinite(result.z)
    assert known.mean() > 0.9
    assert result.extrapolated == (~known).mean()
    assert result.z[known] == pytest.approx(tilted(NODES)[known], abs=1e-9)


@pytest.mark.parametrize("method", ["tin", "natural_neighbour"])
def test_points_are_honored_and_heights_stay_between(method):
    assert np.array_equal(interpolate(WAVY, PLAN, method).z, WAVY[:, 2])
    far = np.vstack([NODES, UTM + RNG.normal(0, 3000, (200, 2))])
    one, two = (interpolate(WAVY, far, method, threads=threads).z for threads in (1, 2))
    assert np.array_equal(one, two)
    assert WAVY[:, 2].min() <= one.min()
    assert one.max() <= WAVY[:, 2].max()
    shuffled = RNG.permutation(len(far))
    assert np.array_equal(interpolate(WAVY, far[shuffled], method).z, one[shuffled])


def test_tin_as_scipy():
    expected = LinearNDInterpolator(PLAN - UTM, WAVY[:, 2])(NODES - UTM)
    result = interpolate(WAVY, NODES, "tin", extrapolate="none")
    assert np.array_equal(np.isnan(result.z), np.isnan(expected))
    known = np.isfinite(expected)
    assert result.z[known] == pytest.approx(expected[known], abs=1e-9)


def test_natural_neighbours_by_counting_stolen_area():
    """Sibson's weights are the shares of the node's own Voronoi cell that belonged to each point before."""
    few = WAVY[:40]
    node = UTM + np.array([480.0, 510.0])
    side = np.linspace(-400, 400, 801)
    x, y = (g.ravel() for g in np.meshgrid(side + 480, side + 510))
    squared = [(x - p[0]) ** 2 + (y - p[1]) ** 2 for p in few[:, :2] - UTM]
    owner = np.argmin(squared, axis=0)
    taken = (x - 480) ** 2 + (y - 510) ** 2 < np.min(squared, axis=0)
    assert not taken.reshape(801, 801)[[0, -1]].any(), "the node's cell lies inside what is counted"
    shares = np.bincount(owner[taken], minlength=40) / taken.sum()
    z = interpolate(few, node[None], "natural_neighbour").z[0]
    assert z == pytest.approx(shares @ few[:, 2], abs=5e-3)


@pytest.mark.parametrize("method", ["tin", "natural_neighbour"])
def test_outside_the_hull_the_nearest_place_of_its_border(method):
    square = np.array([[0, 0, 0], [10, 0, 10], [10, 10, 30], [0, 10, 4.0]])
    nodes = np.array([[-5, 5], [4, -3], [20, 20], [10, 5], [12, 5]])
    assert interpolate(square, nodes, method).z.tolist() == [2, 4, 30, 20, 20]
    line = np.array([[0, 0, 0], [1, 1, 1], [4, 4, 7.0]])
    assert interpolate(line, [[2, 3], [9, 9], [-1, 0]], method).z == pytest.approx([4, 7, 0])
    assert interpolate(line[:1], [[2, 3]], method).z.tolist() == [0]


def test_natural_neighbours_on_a_lattice_and_near_its_border():
    """All its circles are through four points, and areas near the border are nearly rounding."""
    x, y = (g.ravel() for g in np.meshgrid(np.arange(30.0), np.arange(20.0)))
    points = np.column_stack([x + UTM[0], y + UTM[1], 2 * x - y])
    nodes = UTM + np.column_stack([RNG.random(400) * 29, RNG.choice([1e-12, 1e-7, 1e-3, 5, 19 - 1e-9], 400)])
    result = interpolate(points, nodes, "natural_neighbour")
    assert result.z == pytest.approx(2 * (nodes[:, 0] - UTM[0]) - (nodes[:, 1] - UTM[1]), abs=1e-6)


def test_plane_as_least_squares():
    noisy = ON_PLANE.copy()
    noisy[:, 2] += RNG.normal(0, 2, len(noisy))
    terms = np.column_stack([np.ones(len(PLAN)), PLAN - UTM])
    coefficients, residual, *_ = np.linalg.lstsq(terms, noisy[:, 2], rcond=None)
    at = np.column_stack([np.ones(len(NODES)), NODES - UTM])
    s2 = residual[0] / (len(PLAN) - 3)
    leverage = np.einsum("ij,jk,ik->i", at, np.linalg.inv(terms.T @ terms), at)
    result = interpolate(noisy, NODES, "plane")
    assert result.z == pytest.approx(at @ coefficients)
    assert result.variance == pytest.approx(s2 * (1 + leverage))


def test_planes_through_few_points():
    nodes = np.array([[1, 0], [0, 1], [3, 3.0]])
    two = interpolate([[0, 0, 5], [2, 0, 9]], nodes, "plane")
    assert two.z == pytest.approx([7, 5, 11])
    assert two.variance is None
    assert "two points only" in two.warnings[0]
    assert interpolate([[0, 0, 5]], nodes, "plane").z.tolist() == [5, 5, 5]
    line = np.array([[0, 0, 0], [1, 1, 2], [2, 2, 4.0]])
    assert interpolate(line, nodes, "plane").z == pytest.approx([1, 1, 6])


def test_plane_of_a_given_dip():
    """Dipping 45 degrees to the east through one well."""
    east = interpolate([[10, 10, 100]], [[10, 50], [15, 0], [0, 0]], "plane", dip=45, dip_direction=90)
    assert east.z == pytest.approx([100, 95, 110])
    both = interpolate([[0, 0, 10], [0, 10, 20]], [[0, 0]], "plane", dip=45, dip_direction=180)
    assert both.z == pytest.approx([10])
    assert both.variance == pytest.approx([0], abs=1e-20)


def test_constant():
    assert interpolate(None, NODES, "constant", value=12).z.tolist() == [12] * len(NODES)
    points = [[0, 0, 1e6], [1, 0, 1e6 + 3], [0, 0, 1e6]]
    assert interpolate(points, NODES[:1], "constant").z.tolist() == [1e6 + 1.5]
    with pytest.raises(InputRefused, match="points: must be an array"):
        interpolate(None, NODES, "constant")


SQUARE = np.array([[0, 0, 0], [1000, 0, 0], [1000, 1000, 0], [0, 1000, 0.0]])
SQUARE[:, :2] += UTM
TRIANGLES = np.array([[0, 1, 2], [0, 2, 3]])


def test_parallel_to_another_surface():
    top = SQUARE.copy()
    top[:, 2] = tilted(SQUARE)
    plan = NODES[:50]
    result = interpolate(None, plan, "parallel", to=(top, TRIANGLES), thickness=-30)
    assert result.z == pytest.approx(tilted(plan) - 30)
    wells = np.column_stack([PLAN[:2], tilted(PLAN[:2]) - [30, 34]])
    shown = interpolate(wells, plan, "parallel", to=(top, TRIANGLES))
    expected = interpolate(np.column_stack([PLAN[:2], [-30, -34]]), plan, "idw").z
    assert shown.z == pytest.approx(tilted(plan) + expected)
    assert interpolate(wells, plan, "parallel", to=50, thickness=2.5).z.tolist() == [52.5] * 50
    nodes_and = np.column_stack([SQUARE[:, :2]])
    heights = np.array([1.0, 2, 3, 4])
    of_array = interpolate(None, nodes_and, "parallel", to=heights, thickness=1)
    assert of_array.z.tolist() == [2, 3, 4, 5]
    inside = np.array([[UTM[0] + 500, UTM[1] + 500, 12.0]])
    on_nodes = interpolate(inside, nodes_and, "parallel", triangles=TRIANGLES, to=heights)
    assert on_nodes.z == pytest.approx(heights + 10)


def test_parallel_where_the_other_surface_has_no_height():
    half = (SQUARE, TRIANGLES[:1])
    nodes = UTM + np.array([[600.0, 300], [300, 600]])
    assert np.isnan(interpolate(None, nodes, "parallel", to=half, thickness=1).z).tolist() == [False, True]
    wells = np.column_stack([nodes, [3.0, 4]])
    result = interpolate(wells, nodes[:1], "parallel", to=half)
    assert result.z == pytest.approx([3])
    assert "1 of 2 points lie where" in result.warnings[0]
    with pytest.raises(InputRefused, match="none of its points"):
        interpolate(wells[1:], nodes, "parallel", to=half)


def grid_points(angle=0.3, shape=(14, 9), steps=(25.0, 40.0)):
    i, j = (g.ravel() for g in np.meshgrid(*(np.arange(n) for n in shape), indexing="ij"))
    c, s = np.cos(angle), np.sin(angle)
    x, y = i * steps[0], j * steps[1]
    return np.column_stack([UTM[0] + c * x - s * y, UTM[1] + s * x + c * y, np.zeros(len(i))]), i, j


@pytest.mark.parametrize("angle", [0.0, 0.3, np.pi / 6, 2.0])
@pytest.mark.parametrize("steps", [(25.0, 25.0), (25.0, 90.0)])
def test_grid_is_bilinear(angle, steps):
    points, i, j = grid_points(angle, steps=steps)
    points[:, 2] = 3 + i - 2 * j + 0.5 * i * j
    points = points[RNG.permutation(len(points))].round(3)
    u, v = RNG.random((2, 200)) * [[13], [8]]
    c, s = np.cos(angle), np.sin(angle)
    nodes = UTM + np.column_stack([c * u * steps[0] - s * v * steps[1], s * u * steps[0] + c * v * steps[1]])
    result = interpolate(points, nodes, "grid")
    assert result.z == pytest.approx(3 + u - 2 * v + 0.5 * u * v, abs=2e-3)
    assert result.extrapolated == 0
    assert interpolate(points, points[:, :2], "grid").z == pytest.approx(points[:, 2], abs=2e-3)


def test_grid_beyond_its_border_and_in_its_gaps():
    points, i, j = grid_points(0.0)
    points[:, 2] = 2.0 * i
    points = points[~((i == 5) & (j == 4))]
    nodes = UTM + np.array([[25 * 5.4, 40 * 4.3], [25 * 20.0, 40], [25 * 6.5, 40 * 2.5], [25 * 6, 40 * 4.0]])
    result = interpolate(points, nodes, "grid")
    # in the gap the nearest point, outside the border straight on; a node on a point needs no other corner
    assert result.z == pytest.approx([12, 26, 13, 12])
    assert result.extrapolated == 0.5
    assert np.isnan(interpolate(points, nodes, "grid", extrapolate="none").z).tolist() == [
        True,
        True,
        False,
        False,
    ]


def test_grids_refused():
    points, *_ = grid_points()
    points[17, :2] += 3
    with pytest.raises(InputRefused, match=r"cells off.*use method"):
        interpolate(points, NODES, "grid")
    with pytest.raises(InputRefused, match="not a regular grid"):
        interpolate(WAVY, NODES, "grid")
    with pytest.raises(InputRefused, match="four points"):
        interpolate(WAVY[:3], NODES, "grid")
    row = np.column_stack([np.arange(9.0), np.zeros(9), np.zeros(9)])
    with pytest.raises(InputRefused, match="one row"):
        interpolate(row, NODES, "grid")


@pytest.mark.parametrize(
    ("method", "options", "words"),
    [
        ("plane", {"dip": 90}, "'dip' must be below 90"),
        ("plane", {"dip": -1}, "'dip' must be at least 0"),
        ("parallel", {"thickness": 3}, "'to' is missing"),
        ("parallel", {"to": "S0", "thickness": 3}, "'to' names surface 'S0', which does not exist"),
        ("parallel", {"to": [1.0, 2], "thickness": 3}, "'to' has 2 elevations for 300 nodes"),
        ("parallel", {"to": (np.zeros((3, 2)), TRIANGLES), "thickness": 3}, "'to' must be vertices (V, 3)"),
        ("parallel", {"to": 0, "thickness_method": "dsi"}, "'thickness_method' cannot be 'dsi'"),
        ("tin", {"neighbours": 4}, "'neighbours' belongs to kriging, not to tin"),
        ("constant", {"value": "low"}, "'value' must be a finite number"),
    ],
)
def test_options_refused(method, options, words):
    with pytest.raises(InputRefused) as raised:
        interpolate(WAVY, NODES, method, **options)
    assert words in str(raised.value)


def test_cross_validation_in_folds():
    result = cross_validate(WAVY, "natural_neighbour", folds=5)
    out = np.empty(len(WAVY), bool)
    out[np.lexsort(PLAN.T[::-1])] = np.arange(len(WAVY)) % 5 == 2  # every fifth in ascending order
    expected = interpolate(WAVY[~out], PLAN[out], "natural_neighbour").z
    assert np.array_equal(result.z[out], expected)
    assert result.rmse == pytest.approx(np.sqrt(np.mean((result.z - WAVY[:, 2]) ** 2)))
    assert cross_validate(WAVY, "natural_neighbour").rmse < cross_validate(WAVY, "plane").rmse
    inside = cross_validate(WAVY, "tin", extrapolate="none")
    assert np.isnan(inside.errors).any()
    assert np.isfinite(inside.rmse)


COORDINATE = st.one_of(st.integers(-2, 2), st.floats(-1e3, 1e3))
SETS = st.lists(st.tuples(COORDINATE, COORDINATE, st.floats(-100, 100)), min_size=1, max_size=20)


@example([(0, 0, 0.0), (0, 1e-308, 1.0), (1e-308, 0, 2.0)], "plane")
@settings(max_examples=80, deadline=None)
@given(SETS, st.sampled_from(["tin", "natural_neighbour", "plane", "constant"]))
def test_any_points_give_heights_or_are_refused_as_contradicting(points, method):
    points = np.array(points, float)
    nodes = np.vstack([[[0, 0], [0.5, -1], [1e3, 1e3], [1e-9, 0]], points[:, :2]])
    try:
        z = interpolate(points, nodes, method).z
    except InputRefused as error:
        assert "the same position in plan" in str(error)
        return
    assert np.isfinite(z).all()
    if method in ("tin", "natural_neighbour"):
        assert points[:, 2].min() - 1e-6 <= z.min()
        assert z.max() <= points[:, 2].max() + 1e-6


@pytest.mark.parametrize("method", ["idw", "spline", "kriging"])
def test_nodes_without_a_point_within_the_radius_are_a_warning(method):
    points = np.array([[0.0, 0, 1], [2, 0, 2], [0, 2, 3], [2, 2, 2], [1, 1, 2], [1, 0, 1]])
    nodes = [[1.0, 0.5], [2.0, 1.0], [9.0, 9.0], [2.5, 40.0]]
    variogram = {"variogram": {"model": "spherical", "range": 5, "sill": 1}} if method == "kriging" else {}
    result = interpolate(points, nodes, method, radius=3.0, **variogram)
    assert result.warnings == (
        "50 % of the nodes have no point within the radius: there only the nearest point is used",
    )
    assert result.z[2:] == pytest.approx([2, 2])
    assert interpolate(points, nodes[:2], method, radius=3.0, **variogram).warnings == ()


def test_points_elsewhere_are_a_warning():
    """Other coordinates or units: all is extrapolated, and nothing that comes out means anything."""
    (warning,) = interpolate(WAVY, NODES * 3.28, "tin").warnings
    assert warning.startswith("no point lies in the area of the mesh: x of the points is 431250.")
    assert interpolate(WAVY, NODES + 900, "tin").warnings == ()


@pytest.mark.parametrize("seed", range(4))
def test_a_kriged_thickness_goes_to_its_mean_where_another_surface_is_the_trend(seed):
    """Two planes of their own, of noisy points in the middle, part toward the border."""
    random = np.random.default_rng(seed)
    below, above = random.uniform(1600, 2400, (2, 8, 3))
    below[:, 2] = 0.1 * below[:, 0] + random.normal(0, 10, 8)
    above[:, 2] = 0.1 * above[:, 0] + random.normal(200, 10, 8)
    axis = np.linspace(0, 4000, 9)
    nodes = np.stack(np.meshgrid(axis, axis), axis=-1).reshape(-1, 2)
    low = interpolate(below, nodes, method="plane").z
    corners = np.array([[0.0, 0, 0], [4000, 0, 0], [4000, 4000, 0], [0, 4000, 0]])
    corners[:, 2] = interpolate(below, corners[:, :2], method="plane").z
    trend = corners, np.array([[0, 1, 2], [0, 2, 3]], np.int32)
    by_trend = interpolate(above, nodes, method="parallel", to=trend, thickness_method="kriging").z - low
    alone = interpolate(above, nodes, method="universal_kriging").z - low
    known = above[:, 2] - interpolate(below, above[:, :2], method="plane").z
    assert known.min() - 1e-6 < by_trend.min() and by_trend.max() < known.max() + 1e-6
    assert np.ptp(by_trend) < np.ptp(alone)


@pytest.mark.parametrize("method", ["grid", "natural_neighbour", "tin", "kriging", "idw"])
def test_a_raster_with_a_gap_may_begin_in_the_north_or_the_south(method):
    """The points of files in any order give the same model to the last bit."""
    rows, columns = np.mgrid[:9, :12]
    is_known = (abs(rows - 4) > 1) | (abs(columns - 5) > 2)
    height = 300 + 10 * np.sin(columns / 3) + 5 * np.cos(rows / 2)
    points = np.column_stack(
        [4e5 + 10.0 * columns[is_known], 5.4e6 - 10.0 * rows[is_known], height[is_known]]
    )
    region = points[0, :2] + np.array([(3.0, -77.0), (97.0, -79.0), (103.0, -3.0), (5.0, -4.0)])
    orders = [slice(None), slice(None, None, -1), np.random.default_rng(0).permutation(len(points))]
    built = []
    for order in orders:
        surface = Surface("top", points=points[order].copy(), method=method)
        rock = Rock("r", [surface], region=region, edge_length=12.0, base_elevation=200.0)
        built.append(build(Project("p", [rock])).vertices.tobytes())
    assert built[0] == built[1] == built[2]
