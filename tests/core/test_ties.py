# SPDX-License-Identifier: GPL-3.0-or-later
"""Ties: surfaces pass through their contacts and keep their bounds, also within triangles."""

from __future__ import annotations

import numpy as np
import pytest
from realmodel.core import Fault, Observations, Project, Rock, Surface, build, load_project
from realmodel.core.base.triangles import Sheet
from realmodel.core.base.work import run
from realmodel.core.heights.ties import tie_data
from realmodel.core.results.layer_values import at_places
from realmodel.core.results.surface_quality import residuals
from realmodel.core.settings.meshers import MESHERS
from realmodel.core.settings.methods import METHODS
from realmodel.core.surfaces.observed.surface_data import SurfaceData
from realmodel.core.surfaces.planar_mesh import crowded_places
from realmodel.core.surfaces.rock_input import RockInput
from sample_scripts import SAMPLES, built_sample

SIZE = 100.0
REGION = np.array([[0, 0], [SIZE, 0], [SIZE, SIZE], [0, SIZE]], float)
NUGGET = {"variogram": {"model": "spherical", "range": 40.0, "sill": 30.0, "nugget": 15.0}}
OPTIONS = {
    "kriging": NUGGET,
    "universal_kriging": NUGGET,
    "spline": {"smoothing": 1.0},
    "dsi": {"weight": 0.1},
}
TIED = [name for name, method in METHODS.items() if method.has_contacts and name != "parallel"]


def noisy(seed=1, count=60):
    random = np.random.default_rng(seed)
    plan = random.uniform(3, SIZE - 3, (count, 2))
    return np.column_stack([plan, 20 * np.sin(plan[:, 0] / 15) + random.normal(0, 3, count)])


def model_of(points, method="kriging", tie=True, edge_length=5.0, mesher="delaunay", **options):
    surface = Surface("top", points=points, method=method, options=options, tie=tie)
    rock = Rock("r", [surface], region=REGION, edge_length=edge_length, mesher=mesher, base_elevation=-1000.0)
    return build(Project("p", [rock]))


def worst_share(model):
    """Of the height range of a surface's points, how far the farthest of them is from it."""
    return max(float(np.abs(each.values).max() / np.ptp(each.points[:, 2])) for each in residuals(model))


def least_angle(mesh):
    corners = mesh.vertices[mesh.triangles][:, :, :2]
    found = []
    for k in range(3):
        a, b = (corners[:, (k + n) % 3] - corners[:, k] for n in (1, 2))
        cosine = (a * b).sum(axis=1) / np.linalg.norm(a, axis=1) / np.linalg.norm(b, axis=1)
        found.append(np.degrees(np.arccos(cosine)).min())
    return min(found)


@pytest.mark.parametrize("method", TIED)
def test_every_method_passes_through_points_in_triangles(method):
    options = OPTIONS.get(method, {})
    assert worst_share(model_of(noisy(), method, tie=False, **options)) > 1e-6
    assert worst_share(model_of(noisy(), method, **options)) <= 1e-9


@pytest.mark.parametrize("mesher", MESHERS)
def test_points_closer_than_the_mesh_can_tell_become_vertices(mesher):
    points = np.vstack(
        [
            noisy(),
            [
                [50, 50, 9],
                [50.004, 50, -9],
                [50.1, 50.1, 3],
                [20, 20, 5],
                [20, 20.3, 6],
                [0, 30, 3],
                [0, 30.2, 1],
            ],
        ]
    )
    model = model_of(points, edge_length=8.0, mesher=mesher)
    assert worst_share(model) <= 1e-9
    assert least_angle(model.rock_inputs[0].planar_mesh()) >= 20 - 1e-9


def test_fewer_nodes_than_points():
    assert worst_share(model_of(noisy(count=300), edge_length=30.0)) <= 1e-9


def test_a_nugget_makes_no_spikes():
    points = noisy()
    free, tied = (model_of(points, tie=tie, **NUGGET) for tie in (False, True))
    most = np.abs(residuals(free)[0].values).max()
    nodes = tied.surface(0)[0]
    assert np.abs(nodes[:, 2] - at_places(*free.surface(0), nodes[:, :2], 0)).max() < 1.5 * most


def test_a_surface_that_honors_its_points_keeps_its_heights():
    plan = np.array([[x + y / 20, y + x / 30] for x in (15, 50, 85) for y in (17, 52, 81)])
    points = np.column_stack([plan, 0.5 * plan[:, 0] - plan[:, 1]])
    free, tied = (model_of(points, "plane", tie=tie).surface(0)[0] for tie in (False, True))
    assert np.array_equal(free, tied)


def test_without_a_tie_the_planar_mesh_stays_too():
    points = np.vstack([noisy(), [[50, 50, 9], [50.004, 50, -9]]])
    plain = model_of(noisy(), tie=False)
    assert np.array_equal(
        model_of(points, tie=False).rock_inputs[0].planar_mesh().vertices,
        plain.rock_inputs[0].planar_mesh().vertices,
    )


def test_points_that_contradict_at_one_position_are_listed_and_not_fitted():
    points = np.vstack([noisy(), [[50, 50, 40], [50, 50, -40]]])
    model = model_of(points, "plane")
    assert any("2 of its points contradict" in warning.text for warning in model.warnings)
    off = np.abs(residuals(model)[0].values)
    assert (off > 1e-6).sum() == 2


def test_bounds_on_the_surface_itself_leave_its_points_where_they_are():
    """Outcrops on the ground say that it is at their height or above: it is, whatever else its points say."""
    plan = np.array([[x, y] for x in np.arange(-5, 106, 5.0) for y in np.arange(-5, 106, 5.0)])
    seen = np.random.default_rng(2).uniform(3, SIZE - 3, (150, 2))
    ground, at = [np.column_stack([each, 0.1 * each[:, 0]]) for each in (plan, seen)]
    surfaces = [
        Surface("bottom", method="constant", options={"value": -20.0}),
        Surface("ground", points=ground, method="tin", block="rock"),
    ]
    rock = Rock("r", surfaces, region=REGION, edge_length=6.0, observations=Observations(at, ["rock"] * 150))
    model = build(Project("p", [rock]))
    assert worst_share(model) <= 1e-9
    assert not any("cannot be honored" in warning.text for warning in model.warnings)


def observed_model(edge_length=12.0, tie=True):
    """Two layers, and places in them between sparse contacts."""
    random = np.random.default_rng(4)
    plan = random.uniform(4, SIZE - 4, (150, 2))
    at = 8 * np.sin(plan[:, 0] / 9) * np.cos(plan[:, 1] / 11)
    z = at + random.choice([-1, 1], 150) * random.uniform(0.3, 3, 150)
    blocks = np.where(z > at, "upper", "lower")
    contacts = np.column_stack([plan[:25], at[:25]])
    surfaces = [
        Surface("boundary", points=contacts, method="kriging", block="lower", tie=tie),
        Surface("ground", points=None, method="constant", options={"value": 60.0}, block="upper"),
    ]
    observations = Observations(np.column_stack([plan, z])[25:], blocks[25:])
    rock = Rock(
        "r",
        surfaces,
        region=REGION,
        edge_length=edge_length,
        base_elevation=-100.0,
        observations=observations,
    )
    return build(Project("p", [rock]))


def test_bounds_hold_within_triangles():
    assert observed_model(tie=False).observed().share < 1
    assert observed_model().observed().share == 1


@pytest.mark.parametrize("name", ["fault_blocks", "rift_basin"])
def test_sheets_beside_faults_pass_through_their_points(name):
    model = built_sample(name)
    for each in residuals(model):
        off = np.abs(each.values) / np.ptp(each.points[:, 2])
        assert off.max() <= 1e-9


def test_ties_of_rasters_and_surveys_are_not_asked_for():
    grid = np.array([[x, y, np.sin(x)] for x in np.arange(0, 101, 10.0) for y in np.arange(0, 101, 10.0)])
    free, tied = (model_of(grid, "grid", tie=tie).surface(0)[0] for tie in (False, True))
    assert np.array_equal(free, tied)
    many = np.random.default_rng(1).uniform(0, 1, (10_001, 3))
    assert [len(SurfaceData(each, len(each)).tied_points(Surface("top"))) for each in (many, many[1:])] == [
        0,
        10_000,
    ]


def test_data_of_one_position_count_once():
    points = np.array([[0, 0, 1.0], [0, 0, 1.0], [5, 5, 2.0], [5, 5, 90.0], [9, 9, 100.0]])
    data = tie_data(points, None)
    assert data.places.tolist() == [[0, 0], [9, 9]] and data.contacts == 2 and data.left_out == 2


def test_of_close_places_of_several_surfaces_one_becomes_a_vertex_at_a_time():
    hole = np.array([[50.0, 50, 1], [50.2, 50, 9]])
    surfaces = [Surface(name, points=hole + np.array([0.001 * n, 0, n])) for n, name in enumerate("ab")]
    rock = Rock("r", surfaces, region=REGION, edge_length=20.0)
    entry = RockInput(
        rock, [None, None], data=[SurfaceData(each.points, len(each.points)) for each in surfaces]
    )
    mesh = Sheet(np.array([[0.0, 0], [100, 0], [50, 100]]), np.array([[0, 1, 2]], np.int32))
    found = run(lambda work: crowded_places(work, entry, mesh, np.empty((0, 2))))
    assert len(found) == 1


def test_a_vertex_beside_a_contact_that_still_cannot_be_met_is_not_enough():
    plan = np.array([[50.0, 20], [30, 30], [70, 30], [50, 70]])
    surface = Surface("a", points=np.column_stack([plan, [1.0, 2, 3, 9]]))
    rock = Rock("r", [surface], region=REGION, edge_length=20.0)
    entry = RockInput(rock, [None], data=[SurfaceData(surface.points, 4)])
    mesh = Sheet(np.array([[0.0, 0], [100, 0], [50, 100]]), np.array([[0, 1, 2]], np.int32))
    for off in (500.0, 1.0, 0.0):
        known = np.add(plan, [0.0, off])  # of another surface
        found = run(lambda work, known=known: crowded_places(work, entry, mesh, known))
        assert bool(len(found)) == (off > 0)


def rolling(plan):
    x, y = plan[:, 0], plan[:, 1]
    return 6 * np.sin(x / 9) * np.cos(y / 11) + 3 * np.exp(-((x - 50) ** 2 + (y - 50) ** 2) / 30)


@pytest.mark.parametrize("per_edge", [3.0, 2.0, 1.3])
def test_a_survey_denser_than_the_mesh_makes_no_spikes(per_edge):
    edge_length, random = 8.0, np.random.default_rng(0)
    spacing = edge_length / per_edge
    axis = np.linspace(0.5, SIZE - 0.5, int(SIZE / spacing) + 1)
    plan = np.stack(np.meshgrid(axis, axis), axis=-1).reshape(-1, 2)
    plan = np.clip(plan + random.uniform(-0.3, 0.3, plan.shape) * spacing, 0, SIZE)
    points = np.column_stack([plan, rolling(plan)])
    free, tied = (model_of(points, tie=tie, edge_length=edge_length) for tie in (False, True))
    places = random.uniform(1, SIZE - 1, (20_000, 2))
    off_free, off = (np.abs(at_places(*m.surface(0), places, 0) - rolling(places)) for m in (free, tied))
    assert worst_share(tied) <= 1e-9
    assert off.max() <= off_free.max()
    assert np.sqrt((off**2).mean()) <= 0.75 * np.sqrt((off_free**2).mean())


def test_observations_on_a_ground_finer_than_the_mesh_are_in_their_blocks():
    axis = np.arange(0, SIZE + 1, 2.0)
    plan = np.stack(np.meshgrid(axis, axis), axis=-1).reshape(-1, 2)
    ground = np.column_stack([plan, 5 * np.sin(plan[:, 0] / 3) * np.sin(plan[:, 1] / 4)])
    random = np.random.default_rng(5)
    seen = ground[random.choice(len(ground), 150, replace=False)]
    tops = [0.3 * (seen[:, 0] - x) for x in (70, 50, 30)]  # beds, and a height at which each is met
    blocks = np.array(["a", "b", "c", "d"])[(np.array(tops) < seen[:, 2]).sum(axis=0)]
    holes = np.array([[10.0, 50], [30, 20], [60, 80], [90, 40]])
    surfaces = [
        Surface(
            name,
            points=np.column_stack([holes, 0.3 * (holes[:, 0] - x) - 3]),
            method="universal_kriging",
            rule="conformable",
            block=name,
        )
        for name, x in zip("abc", (70, 50, 30), strict=True)
    ]
    surfaces.append(Surface("ground", points=ground, method="grid", block="d"))
    rock = Rock(
        "r",
        surfaces,
        region=REGION,
        edge_length=15.0,
        base_elevation=-100.0,
        observations=Observations(seen, blocks),
    )
    found = build(Project("p", [rock])).observed()
    assert found.bounds > 150 and not found.violated and found.share == 1


MAP = SAMPLES.parent.parent / "shared" / "data" / "field" / "hamersley_map_dips"


@pytest.mark.skipif(not MAP.is_dir(), reason="../shared/data/field/hamersley_map_dips is not there")
def test_a_real_map_is_honored():
    found = build(load_project(MAP / "project.toml")).observed()
    assert found.share == 1 and not found.violated
    assert max(abs(each.residual) for each in found.contacts) < 1e-6


def test_a_survey_is_not_tied_beside_a_fault_that_dies_out(monkeypatch):
    rng = np.random.default_rng(3)
    plan = rng.uniform(0, 10, (60, 2))
    points = np.column_stack([plan, np.sin(2 * plan[:, 0])])
    plane = np.array([[5.0, -1, -9], [5, 4, -9], [5, 4, 9], [5, -1, 9]])
    fault = Fault("F", plane, np.array([[0, 1, 2], [0, 2, 3]]), dies_out=True)
    square = [[0, 0], [10, 0], [10, 10], [0, 10]]

    def residual(most):
        monkeypatch.setattr("realmodel.core.surfaces.observed.surface_data.MOST_CONTACTS", most)
        rock = Rock(
            "r", [Surface("s", points=points, method="idw")], square, edge_length=2.0, base_elevation=-5
        )
        (found,) = residuals(build(Project("p", [rock], faults=[fault])))
        return float(np.abs(found.values).max())

    assert residual(60) < 1e-9
    assert residual(59) > 0.1
