# SPDX-License-Identifier: GPL-3.0-or-later
"""The meshers on plain and on nasty outlines, and polygons cut into triangles by their ears."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from plan_meshes import check_mesh, ring_area
from realmodel.core import Cancelled, InputRefused, mesh_region, triangulate_polygon
from realmodel.core.settings.meshers import MESHERS

SQUARE = np.array([[0, 0], [100, 0], [100, 100], [0, 100]], float)


def circle(x, y, radius, corners):
    turn = np.arange(corners) * 2 * np.pi / corners
    return np.c_[x + radius * np.cos(turn), y + radius * np.sin(turn)]


TWO_HOLES = [SQUARE, circle(30, 30, 12, 32), circle(65, 70, 15, 7)]


def comb(teeth, width):
    corners = [[0, -1]]
    for i in range(teeth):
        corners += [[i, 0], [i + width / 2, 20], [i + width, 0]]
    return np.array([*corners, [teeth, 0], [teeth, -1]], float)


def spiral(turns, width):
    t = np.linspace(3, turns * 2 * np.pi, 60 * turns)
    arms = [np.c_[r * np.cos(t), r * np.sin(t)] for r in (t, t - width)]
    return np.concatenate([arms[0], arms[1][::-1]])


def star(points, inner):
    turn = np.arange(2 * points) * np.pi / points
    radius = np.where(np.arange(2 * points) % 2, inner, 1) * 50
    return np.c_[radius * np.cos(turn), radius * np.sin(turn)]


NOTCH = [[0, 0], [50, 0], [50, 1e-4], [50 + 1e-4, 1e-4], [50 + 1e-4, 0], [90, 0], [9, 90]]
TOUCHING = [[[0, 50], [30, 40], [30, 60]], [[30, 40], [60, 30], [50, 50]], [[50, 50], [70, 60], [40, 70]]]
NASTY = {
    "comb": ([comb(20, 0.05)], 3),
    "spiral": ([spiral(6, 0.4)], 2),
    "star": ([star(40, 0.1)], 6),
    "star at UTM coordinates": ([star(9, 0.3) + np.array([431234.56, 5398765.43])], 5),
    "corner of one degree": ([np.array([[0, 0], [100, 0], [100, 100 * np.tan(np.radians(1))]])], 3),
    "thin strip": ([np.array([[0, 0], [100, 0], [100, 0.1], [0, 0.1]])], 10),
    "gap of a millionth": ([SQUARE, [[1e-6, 20], [50, 20], [50, 80], [1e-6, 80]]], 8),
    "notch of a millionth": (
        [[[0, 0], [50, 0], [50, 1e-4], [50 + 1e-4, 1e-4], [50 + 1e-4, 0], [90, 0], [9, 90]]],
        8,
    ),
    "holes that touch": ([SQUARE, *TOUCHING], 5),
    "many holes": ([SQUARE, *(circle(x, y, 2, 5) for x in range(5, 100, 10) for y in range(5, 100, 10))], 6),
    "edge longer than the region": ([SQUARE], 1000),
}


@pytest.mark.parametrize("mesher", MESHERS)
@pytest.mark.parametrize("name", NASTY)
def test_nasty_outlines(mesher, name):
    rings, length = NASTY[name]
    rings = [np.array(ring, float) for ring in rings]
    vertices, triangles = mesh_region(rings[0], rings[1:], length, mesher)
    found = check_mesh(vertices, triangles, rings)
    # The comb's tips are finer than a thousandth of the edge: frontal does not grade to that.
    if mesher != "grid" and "millionth" not in name and (name, mesher) != ("comb", "frontal"):
        assert found.least_angle >= 25
    assert len(triangles) < 60_000
    again = mesh_region(rings[0], rings[1:], length, mesher)
    assert vertices.tobytes() == again[0].tobytes() and triangles.tobytes() == again[1].tobytes()


def test_frontal_meshes_are_better():
    length = 1.2
    plain = check_mesh(*mesh_region(TWO_HOLES[0], TWO_HOLES[1:], length), TWO_HOLES)
    better = check_mesh(*mesh_region(TWO_HOLES[0], TWO_HOLES[1:], length, "frontal"), TWO_HOLES)
    assert better.ratios.mean() > max(0.99, plain.ratios.mean())
    assert better.six >= 0.95
    assert better.lengths.mean() == pytest.approx(length, rel=0.05)
    assert better.least_angle >= 25


@pytest.mark.parametrize(
    "size",
    [
        [{"at": [70.0, 30.0], "length": 0.3, "distance": 2}],
        [{"at": [[5.0, 60.0], [50.0, 80.0]], "length": 0.5, "distance": 1}],
        [{"at": "outline", "length": 0.8, "distance": 0}],
    ],
)
def test_graded_frontal_meshes(size):
    vertices, triangles = mesh_region(TWO_HOLES[0], TWO_HOLES[1:], 6, "frontal", size=size)
    found = check_mesh(vertices, triangles, TWO_HOLES)
    assert found.ratios.mean() > 0.95
    assert found.least_angle >= 25


def test_constraints_stay_in_frontal_meshes_and_grids():
    lines = [[[5, 55], [95, 62]], [[50, 2], [52, 50]]]
    wells = np.array([[80.0, 20.0], [80.4, 20.1], [10.0, 90.0]])
    for mesher in ("frontal", "grid"):
        vertices, triangles = mesh_region(
            SQUARE, edge_length=4, mesher=mesher, constraints=lines, constraint_points=wells
        )
        check_mesh(vertices, triangles, [SQUARE], lines)
        known = {tuple(p) for p in vertices}
        assert all(tuple(well) in known for well in wells)


def test_a_grid_is_regular_and_ends_at_the_outline():
    vertices, triangles = mesh_region(TWO_HOLES[0], TWO_HOLES[1:], 2.5, "grid")
    check_mesh(vertices, triangles, TWO_HOLES)
    steps = vertices / 2.5
    on_grid = (np.abs(steps - np.round(steps)) < 1e-9).all(axis=1)
    nodes = {tuple(p) for p in np.round(steps[on_grid]).astype(int)}
    far = [
        (i, j)
        for i in range(41)
        for j in range(41)
        if all(np.hypot(*(np.array([i, j]) * 2.5 - c)) > r + 1.5 for c, r in (((30, 30), 12), ((65, 70), 15)))
    ]
    assert nodes >= set(far)
    rectangle = mesh_region([[3, 4], [13, 4], [13, 10], [3, 10]], edge_length=1, mesher="grid")
    assert (len(rectangle[0]), len(rectangle[1])) == (11 * 7, 2 * 10 * 6)
    assert len(mesh_region(SQUARE, triangles=5000, mesher="grid")[1]) == pytest.approx(5000, rel=0.05)
    with pytest.raises(InputRefused, match="one edge length everywhere"):
        mesh_region(
            SQUARE, edge_length=5, mesher="grid", size=[{"at": "outline", "length": 1, "distance": 1}]
        )


@st.composite
def weird_rings(draw):
    """A star-shaped outline with a scaled one as its hole, at times far from the origin."""
    corners = draw(st.integers(3, 30))
    radius = np.array(draw(st.lists(st.floats(0.05, 1), min_size=corners, max_size=corners)))
    turn = np.arange(corners) * 2 * np.pi / corners
    outline = 100 * radius[:, None] * np.c_[np.cos(turn), np.sin(turn)]
    share = draw(st.sampled_from([0.9, 0.5, 0.01]))
    origin = draw(st.sampled_from([0.0, 1e4, 5e6]))
    return [outline + origin, share * outline + origin]


@settings(deadline=None, max_examples=30)
@given(weird_rings(), st.sampled_from([4.0, 30.0]), st.sampled_from(list(MESHERS)))
def test_weird_outlines(rings, length, mesher):
    try:
        vertices, triangles = mesh_region(rings[0], rings[1:], length, mesher)
    except InputRefused as refused:
        assert any(word in str(refused) for word in ("crosses", "runs along", "collide", "one line"))
        return
    check_mesh(vertices, triangles, rings)


@st.composite
def slits_and_needles(draw):
    """A square that the outside cuts into, or that reaches out, in wedges down to a millionth wide."""
    count = draw(st.integers(1, 8))
    tips = draw(st.lists(st.floats(5, 95), min_size=count, max_size=count))
    width = 10.0 ** draw(st.floats(-6, 0.7))
    slant = draw(st.floats(0, 1))
    side = draw(st.sampled_from([100.0, 2.0]))  # wedges go in, or out
    outline = [[0.0, 0.0], [side, 0.0]]
    for number, tip in enumerate(tips):
        foot = 5 + 90 * number / count
        outline += [[side, foot], [tip, foot + slant * width], [side, foot + width]]
    return np.array([*outline, [side, 100.0], [0.0, 100.0]]) + draw(st.sampled_from([0.0, 5e4]))


@settings(deadline=None, max_examples=25)
@given(slits_and_needles())
def test_vertices_that_slide_stay_on_the_border_and_nothing_turns_over(outline):
    vertices, triangles = mesh_region(outline, edge_length=20.0, mesher="frontal")
    check_mesh(vertices, triangles, [outline])


@pytest.mark.parametrize("mesher", MESHERS)
def test_cancelled_soon(mesher):
    asked, after = [], []

    def cancel():
        asked.append(True)
        return len(asked) > 1

    def progress(fraction, text):
        if len(asked) > 1:
            after.append(fraction)

    with pytest.raises(Cancelled):
        mesh_region(SQUARE, edge_length=0.02, mesher=mesher, progress=progress, cancel=cancel)
    assert len(asked) == 2  # the first yes is enough
    assert len(after) <= 1


def check_polygon(rings):
    """Asserts that triangles cover a polygon with its holes, and nothing else; gives them back."""
    rings = [np.array(ring, float) for ring in rings]
    triangles = triangulate_polygon(rings[0], rings[1:])
    assert triangles.dtype == np.int32
    corners = np.concatenate(rings)[triangles]
    u, v = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    areas = 0.5 * (u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0])
    assert (areas > 0).all()
    assert areas.sum() == pytest.approx(ring_area(rings[0]) - sum(map(ring_area, rings[1:])), rel=1e-9)
    return triangles


def test_polygons_by_their_ears():
    assert len(check_polygon([SQUARE])) == 2
    assert len(check_polygon([SQUARE[::-1]])) == 2
    assert (
        len(check_polygon([[[0, 0], [1, 0], [2, 0], [3, 0], [3, 3], [1.5, 3], [0, 3]]])) == 5
    )  # runs in line
    assert len(check_polygon(TWO_HOLES)) == 4 + 32 + 7 + 2 * 2 - 2
    assert len(check_polygon(NASTY["holes that touch"][0])) > 10
    check_polygon([SQUARE, [[50, 0], [60, 20], [40, 20]]])  # a hole that touches an edge
    chess = [
        [[x, y], [x + 1, y], [x + 1, y + 1], [x, y + 1]]
        for x in range(1, 9)
        for y in range(1, 9)
        if (x + y) % 2
    ]
    check_polygon([[[0, 0], [10, 0], [10, 10], [0, 10]], *chess])  # holes that touch at all corners
    repeated = np.repeat(SQUARE, 2, axis=0)
    assert len(check_polygon([repeated])) == 2
    check_polygon([star(200, 0.3)])
    check_polygon([spiral(20, 0.2)])


def test_edges_are_swapped_to_delaunay():
    thin = [[0, 0], [10, 0], [10, 1], [5, 1.2], [0, 1]]
    triangles = check_polygon([thin])
    assert sorted(map(sorted, triangles.tolist())) == [[0, 1, 3], [0, 3, 4], [1, 2, 3]]


@pytest.mark.parametrize(
    ("rings", "words"),
    [
        ([[[0, 0], [1, 0]]], "three different corners"),
        ([[[0, 0], [1, 0], [2, 0]]], "one line"),
        ([[[0, 0], [1, 0], [1, np.nan]]], "not finite"),
    ],
)
def test_no_polygons(rings, words):
    with pytest.raises(InputRefused, match=words):
        triangulate_polygon(rings[0], rings[1:])


@settings(deadline=None, max_examples=60)
@given(weird_rings())
def test_weird_polygons(rings):
    try:
        mesh_region(rings[0], rings[1:], 1e3)  # refuses crossing rings
    except InputRefused:
        return
    check_polygon(rings)
