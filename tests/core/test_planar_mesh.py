# SPDX-License-Identifier: GPL-3.0-or-later
"""mesh_region: local lengths, constraints, numbers of triangles, and what it refuses."""

import numpy as np
import pytest
from plan_meshes import check_mesh, distances_to_segments, ring_area
from realmodel.core import InputRefused, estimate_mesh, mesh_region

SQUARE = np.array([[0, 0], [100, 0], [100, 100], [0, 100]], float)
HOLE = np.array([[20, 20], [40, 22], [30, 41]], float)
UTM = np.array([431234.56, 5398765.43])


def near(figures, place, distance):
    return figures.lengths[np.hypot(*(figures.centers - place).T) < distance]


@pytest.mark.parametrize("origin", [np.zeros(2), UTM])
def test_shorter_edges_near_a_point(origin):
    place = np.array([70.0, 60.0]) + origin
    size = [{"at": place.tolist(), "length": 0.5, "distance": 5}]
    rings = [SQUARE + origin, HOLE + origin]
    found = check_mesh(*mesh_region(rings[0], rings[1:], 8, size=size), rings)
    assert near(found, place, 4).mean() == pytest.approx(0.5, rel=0.05)
    far = np.hypot(*(found.centers - place).T) > 5 + 8 / 0.25
    assert found.lengths[far].mean() == pytest.approx(8, rel=0.1)
    assert found.least_angle >= 25
    # graded: no edge longer than its distance allows, by half
    distance = np.hypot(*(found.centers - place).T)
    assert (found.lengths.max(axis=1) <= 1.6 * np.minimum(8, 0.5 + 0.25 * np.maximum(0, distance - 4))).all()


def test_shorter_edges_near_outlines_and_lines():
    line = [[10.0, 60.0], [60.0, 90.0], [90.0, 50.0]]
    size = [{"at": "outline", "length": 2, "distance": 0}, {"at": line, "length": 1, "distance": 3}]
    found = check_mesh(*mesh_region(SQUARE, [HOLE], 6, size=size), [SQUARE, HOLE])
    a, b = np.array(line[:-1]), np.array(line[1:])
    at_line = distances_to_segments(found.centers, a, b) < 2
    assert found.lengths[at_line].mean() == pytest.approx(1, rel=0.05)
    assert found.least_angle >= 25
    plain = mesh_region(SQUARE, [HOLE], 6, size=[{"at": "outline", "length": 2, "distance": 0}])
    at_border = (plain[0] == 0).any(axis=1) & (plain[0] < 100).all(axis=1)
    assert at_border.sum() == pytest.approx(100, abs=12)


def test_constraints_are_in_the_mesh():
    river = np.array([[-10, 50], [30, 55], [60, 45], [110, 60]], float)
    fault = np.array([[50, -5], [52, 105]], float)
    wells = np.array([[70.0, 80.0], [71.5, 80.0], [0.0, 33.0], [50.123, 20.0]])
    vertices, triangles = mesh_region(SQUARE, [HOLE], 5, constraints=[river, fault], constraint_points=wells)
    inside = np.clip(river, [0, -np.inf], [100, np.inf])
    inside[0, 1], inside[-1, 1] = 50 + 5 * 10 / 40, 45 + 15 * 40 / 50
    clipped = np.array([[50 + 2 * 5 / 110, 0], [50 + 2 * 105 / 110, 100]])
    found = check_mesh(vertices, triangles, [SQUARE, HOLE], [inside, clipped])
    assert found.least_angle >= 25
    known = {tuple(p) for p in vertices}
    assert all(tuple(well) in known for well in wells)
    assert (30.0, 55.0) in known and (60.0, 45.0) in known
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    for line in (inside, clipped):
        ends = vertices[edges]
        on = [distances_to_segments(p, line[:-1], line[1:]) < 1e-9 for p in (ends[:, 0], ends[:, 1])]
        covered = ends[np.all(on, axis=0) & (edges[:, 0] < edges[:, 1])]
        length = np.hypot(*(covered[:, 0] - covered[:, 1]).T).sum()
        assert length == pytest.approx(np.hypot(*np.diff(line, axis=0).T).sum(), rel=1e-9)


def test_shorter_edges_at_constraints():
    fault = np.array([[20, 60], [80, 70]], float)
    size = [{"at": "constraints", "length": 1, "distance": 2}]
    vertices, triangles = mesh_region(
        SQUARE, edge_length=10, constraints=[fault], constraint_points=[[80.0, 20.0]], size=size
    )
    found = check_mesh(vertices, triangles, [SQUARE], [fault])
    for place in ([50.0, 65.0], [80.0, 20.0]):
        assert near(found, place, 1.5).mean() == pytest.approx(1, rel=0.15)


@pytest.mark.parametrize("wanted", [200, 5000, 60_000])
def test_a_number_of_triangles(wanted):
    vertices, triangles = mesh_region(SQUARE, [HOLE], triangles=wanted)
    assert len(triangles) == pytest.approx(wanted, rel=0.05)
    check_mesh(vertices, triangles, [SQUARE, HOLE])
    size = [{"at": [80.0, 80.0], "length": 1, "distance": 4}]
    if wanted >= 5000:
        assert len(mesh_region(SQUARE, [HOLE], triangles=wanted, size=size)[1]) == pytest.approx(
            wanted, rel=0.05
        )


def test_edges_by_the_density_of_points():
    chance = np.random.default_rng(5)
    dense, sparse = chance.uniform(0, 50, (2000, 2)), chance.uniform(50, 100, (125, 2))
    points = np.concatenate([dense, sparse])
    vertices, triangles = mesh_region(SQUARE, edge_length="auto", points=np.c_[points, points[:, :1]])
    found = check_mesh(vertices, triangles, [SQUARE])
    fine = near(found, [25, 25], 15).mean()
    assert fine == pytest.approx(0.5 * 50 / 2000**0.5, rel=0.35)
    assert near(found, [75, 75], 15).mean() > 2.5 * fine
    assert found.least_angle >= 25
    for wanted in (2000, 20_000):
        made = mesh_region(SQUARE, edge_length="auto", points=points, triangles=wanted)[1]
        assert len(made) == pytest.approx(wanted, rel=0.05)


def test_the_estimate_of_a_mesh():
    estimated = estimate_mesh(SQUARE, [HOLE], 0.5)
    made = mesh_region(SQUARE, [HOLE], 0.5)[1]
    assert estimated.triangles == pytest.approx(len(made), rel=0.05)
    assert estimated.memory > 40 * len(made)
    size = [{"at": [50.0, 50.0], "length": 0.5, "distance": 10}]
    estimated = estimate_mesh(SQUARE, [HOLE], 8, size=size)
    assert estimated.triangles == pytest.approx(len(mesh_region(SQUARE, [HOLE], 8, size=size)[1]), rel=0.15)
    assert estimate_mesh(SQUARE, edge_length=1e-4).memory > 1e11  # meshing would refuse it


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"size": [{"at": "outline", "length": 9, "distance": 1}]}, "shorter than the edge length"),
        ({"size": [{"at": "outline", "length": 0, "distance": 1}]}, "length must be"),
        ({"size": [{"at": "outline", "length": 1, "distance": -1}]}, "distance must be"),
        ({"size": [{"at": "river", "length": 1, "distance": 1}]}, "at must be"),
        ({"size": [{"at": [1, np.nan], "length": 1, "distance": 1}]}, "not finite"),
        ({"size": [{"at": "outline", "length": 1}]}, "needs exactly"),
        ({"size": [{"at": "constraints", "length": 1, "distance": 1}]}, "no constraints"),
        ({"size": [{"at": "outline", "length": 1e-9, "distance": 5}]}, "local lengths"),
        ({"edge_length": "automatic"}, "or 'auto'"),
        ({"edge_length": "auto"}, "needs points"),
        ({"edge_length": "auto", "points": [[1, 2]]}, "needs 2 places"),
        ({"edge_length": "auto", "points": [[1, 2], [1, 2]]}, "two points"),
        ({"triangles": 100}, "cannot both be given"),
        ({"edge_length": None, "triangles": 0}, "whole number"),
        ({"edge_length": None, "triangles": 2.5}, "whole number"),
        ({"edge_length": None}, "must be given"),
        ({"constraint_points": [[50, 50], [150, 50]]}, "constraint point 1 at (150, 50) lies outside"),
        ({"constraint_points": [[30, 30]]}, "lies outside"),  # in the hole
        ({"constraints": [[[1, 1], [np.inf, 2]]]}, "not finite"),
        ({"constraints": [[1, 2]]}, r"(N, 2)"),
    ],
)
def test_refused(options, words):
    with pytest.raises(InputRefused) as raised:
        mesh_region(SQUARE, [HOLE], **{"edge_length": 8, **options})
    assert words in str(raised.value)


def test_constraints_that_touch_and_overlap():
    lines = [
        [[0, 0], [50, 50], [100, 100]],  # from corner to corner
        [[40, 40], [60, 60]],  # along it
        [[50, 50], [50, 0]],  # branches off, ends on the border
        [[0, 30], [0, 70]],  # along the border
        [[60, 60], [60, 60], [70, 20]],  # a repeated corner
        [[200, 200], [300, 300]],  # outside
    ]
    vertices, triangles = mesh_region(SQUARE, edge_length=7, constraints=lines)
    found = check_mesh(vertices, triangles, [SQUARE], lines[:5])
    assert ring_area(SQUARE) == 10_000
    assert found.least_angle >= 20  # beside angles of 45 degrees between constraints
