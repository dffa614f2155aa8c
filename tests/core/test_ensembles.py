# SPDX-License-Identifier: GPL-3.0-or-later
"""Realizations of a model: they honor the data, spread as kriging says, and depend on the seed alone."""

from dataclasses import fields, replace

import numpy as np
import pytest
from dense_kriging import semivariance
from realmodel.core import Project, Rock, Surface, UsageError, build
from realmodel.core.base.work import Work
from realmodel.core.ensembles import Ensemble, Realizer, ensemble
from realmodel.core.ensembles.ensemble import Sums, added
from realmodel.core.heights.realizations.turning_bands import FieldArea, GaussianField, Noise
from realmodel.core.project.project import Fault
from realmodel.core.settings.variogram import VARIOGRAMS, Structure, Variogram
from structure_cases import plane_fault

SQUARE = np.array([[0.0, 0.0], [100.0, 0.0], [100.0, 100.0], [0.0, 100.0]])
POINTS = np.random.default_rng(3).uniform([2, 2, 8], [98, 98, 12], (12, 3))
KRIGING = {"variogram": {"model": "spherical", "range": 60.0, "sill": 4.0, "nugget": 0.0}, "neighbours": 0}


def project(points=POINTS, method="kriging", options=KRIGING, edge=8.0, **keys):
    """A block between a level base and one interpolated surface, on a square of 100 x 100."""
    top = Surface("Top", points=points, method=method, options=dict(options))
    return Project("one", [Rock("rock", [top], region=SQUARE, edge_length=edge, base_elevation=0.0)], **keys)


def drawn(variogram, nodes, seed=1, anisotropy=None, older=None, correlation=0.0):
    noise = Noise((seed,), older, correlation)
    area = FieldArea(np.array([0.0, 0.0]), np.array([1000.0, 1000.0]))
    return GaussianField(variogram, anisotropy, area, noise).at(Work(), nodes)


@pytest.mark.parametrize("model", [model for model in VARIOGRAMS if model != "wave"])
def test_fields_have_the_variogram(model):
    """Pairs all over an area of many ranges, along and across the long axis of an anisotropy."""
    variogram = Variogram(model, 20.0, 3.0)
    base = np.random.default_rng(0).uniform(0, 900, (4000, 2))
    steps = [(0, 0), (0, 4), (0, 10), (0, 30), (5, 0), (15, 0)]
    nodes = np.concatenate([base + step for step in steps])
    fields = drawn(variogram, nodes, anisotropy={"ratio": 2.0, "azimuth": 0.0}).reshape(len(steps), -1)
    assert abs(fields[0].mean()) < 0.15
    assert fields.var() == pytest.approx(3.0, rel=0.06)
    found = ((fields[1:] - fields[0]) ** 2).mean(axis=1) / 2
    expected = variogram.semivariance(np.array([4, 10, 30, 10, 30]))
    assert found == pytest.approx(expected, rel=0.08, abs=0.02)


def test_a_wave_rises_and_falls_across_its_crests():
    """Two crests in a range of 40, along north."""
    crests = {"ratio": 2.0, "azimuth": 0.0}
    wave = Structure("wave", 40.0, 3.0, crests)
    base = np.random.default_rng(0).uniform(0, 900, (4000, 2))
    steps = np.array([(0, 0), (0, 10), (0, 60), (5, 0), (10, 0), (20, 0)])
    nodes = np.concatenate([base + step for step in steps])
    variogram = Variogram("nested", 40.0, 3.0, 0.0, (wave,))
    fields = drawn(variogram, nodes).reshape(len(steps), -1)
    found = ((fields[1:] - fields[0]) ** 2).mean(axis=1) / 2
    h = np.hypot(*steps[1:].T)
    expected = 3 * (1 - np.cos(2 * np.pi * steps[1:, 0] / 20) * np.exp(-3 * h**2 / 1600))
    # some 500 patches vary independently: one standard deviation of a variance is 6 %
    assert found == pytest.approx(expected, rel=0.15, abs=0.03)
    alone = drawn(Variogram("wave", 40.0, 3.0), nodes[:50], anisotropy=crests)
    assert alone == pytest.approx(fields[0, :50])


def test_parts_of_a_nested_variogram_add_up():
    parts = (Structure("spherical", 15.0, 1.0), Structure("cubic", 60.0, 2.0))
    nodes = np.random.default_rng(0).uniform(0, 1000, (6000, 2))
    field = drawn(Variogram("nested", 60.0, 3.5, 0.5, parts), nodes)
    assert field.var() == pytest.approx(3.0, rel=0.15)  # the nugget is not in it


@pytest.mark.parametrize("correlation", [-0.5, 0.8])
def test_fields_are_correlated_as_their_noises(correlation):
    variogram = Variogram("exponential", 20.0, 3.0)
    nodes = np.random.default_rng(0).uniform(0, 1000, (6000, 2))
    first = drawn(variogram, nodes, 1)
    second = drawn(variogram, nodes, 2, older=Noise((1,)), correlation=correlation)
    assert np.corrcoef(first, second)[0, 1] == pytest.approx(correlation, abs=0.05)
    assert second.var() == pytest.approx(3.0, rel=0.08)
    assert abs(np.corrcoef(first, drawn(variogram, nodes, 2))[0, 1]) < 0.05


def heights(model, number=0):
    return model.interpolations[number].z


def errors(base, count, **options):
    """(count, N): by how much the heights of realizations differ from the interpolated ones."""
    realizer = Realizer(base, **options)
    return np.array([heights(realizer.realization(n, threads=1)) - heights(base) for n in range(count)])


@pytest.mark.parametrize("nugget", [0.0, 1.0])
def test_realizations_spread_as_kriging_says(nugget):
    variogram = {**KRIGING["variogram"], "nugget": nugget}
    given = project(options={**KRIGING, "variogram": variogram}, edge=14.0)
    given.rocks[0].surfaces[0].tie = False  # beside points a tie leaves less of a nugget
    base = build(given, cells="blocks")
    found = errors(base, 120)
    expected = base.interpolations[0].variance
    assert (found**2).mean() == pytest.approx(expected.mean(), rel=0.1)
    kept = expected > 0.2 * expected.max()
    assert (found**2).mean(axis=0)[kept] == pytest.approx(expected[kept], rel=0.6)


def test_the_volume_spreads_as_the_covariances_say():
    """The volume is a weighted sum of heights, whose covariance given the points is known."""
    base = build(project(), cells="blocks")
    nodes, triangles = base.rock_inputs[0].region
    corners = nodes[triangles]
    sides = corners[:, 1:] - corners[:, :1]
    area = np.abs(sides[:, 0, 0] * sides[:, 1, 1] - sides[:, 0, 1] * sides[:, 1, 0]) / 2
    weights = np.zeros(len(nodes))
    np.add.at(weights, triangles, area[:, None] / 3)
    one = np.ones((1, len(POINTS)))
    variogram = KRIGING["variogram"]
    left = np.block([[-semivariance(POINTS, POINTS, variogram), one.T], [one, np.zeros((1, 1))]])
    right = np.vstack([-semivariance(POINTS, nodes, variogram), np.ones((1, len(nodes)))])
    given = np.linalg.solve(left, right)
    covariance = -semivariance(nodes, nodes, variogram) - right.T @ given
    expected = weights @ covariance @ weights
    realizer = Realizer(base)
    volumes = [realizer.realization(n, threads=1).blocks[0].volume for n in range(150)]
    assert np.var(volumes) == pytest.approx(expected, rel=0.3)
    assert np.mean(volumes) == pytest.approx(base.blocks[0].volume, abs=4 * np.sqrt(expected / 150))


def two_surfaces(correlation):
    """Both with the same variogram, ten apart."""
    lower = Surface("Lower", points=POINTS, method="kriging", options=dict(KRIGING))
    upper = replace(lower, name="Upper", points=POINTS + np.array([0, 0, 10.0]), correlation=correlation)
    return Project("two", [Rock("rock", [lower, upper], region=SQUARE, edge_length=8.0)])


def test_errors_of_surfaces_are_correlated_as_the_project_says():
    def found(own, others=0.0, count=25):
        realizer = Realizer(build(two_surfaces(own), cells="blocks"), correlation=others)
        base = realizer.model
        models = [realizer.realization(number, threads=1) for number in range(count)]
        return [np.array([heights(m, n) - heights(base, n) for m in models]) for n in (0, 1)]

    lower, upper = found(0.9)
    assert np.corrcoef(lower.ravel(), upper.ravel())[0, 1] == pytest.approx(0.9, abs=0.05)
    assert np.array_equal(found(None, 0.9, 3)[1], upper[:3])
    assert np.array_equal(found(0.9, -0.5, 3)[1], upper[:3])  # what the project says comes first
    assert abs(np.corrcoef(lower.ravel(), found(None)[1].ravel())[0, 1]) < 0.2


METHODS = {
    "kriging": {"variogram": {**KRIGING["variogram"], "nugget": 1.0}},
    "universal_kriging": {},
    "idw": {},
    "natural_neighbour": {"extrapolate": "nearest"},
    "dsi": {},
    "spline": {},
    "auto": {},
}


@pytest.mark.parametrize("method", METHODS)
def test_data_are_honored(method):
    """Nodes that lie on points: the planar mesh contains them."""
    given = project(method=method, options=METHODS[method])
    rock = replace(given.rocks[0], constraints=POINTS[:, :2].tolist())
    base = build(replace(given, rocks=[rock]), cells="blocks")
    nodes = base.rock_inputs[0].region.vertices
    at = [int(np.flatnonzero((nodes == point).all(axis=1))[0]) for point in POINTS[:, :2]]
    found = errors(base, 3)
    assert np.abs(found[:, at]).max() < 1e-6
    assert np.abs(found).max() > 0.1
    assert base.interpolations[0].method != "auto"


def test_bounds_of_dsi_hold():
    lower = Surface("Lower", points=POINTS, method="kriging", options=dict(KRIGING))
    upper = Surface("Upper", points=POINTS + np.array([0, 0, 0.5]), method="dsi", options={"above": "Lower"})
    rock = Rock("rock", [lower, upper], region=SQUARE, edge_length=10.0, base_elevation=0.0)
    realizer = Realizer(build(Project("two", [rock]), cells="blocks"))
    for number in (0, 1):
        model = realizer.realization(number)
        assert (heights(model, 1) >= heights(model, 0)).all()
    first = Realizer(realizer.model).realization(1)  # in another order the same
    assert np.array_equal(first.vertices, model.vertices)


def parallel(points=None, **options):
    """A surface above an interpolated one, parallel to it."""
    lower = Surface("Lower", points=POINTS, method="kriging", options=dict(KRIGING))
    upper = Surface("Upper", points=points, method="parallel", options={"to": "Lower", **options})
    rock = Rock("rock", [lower, upper], region=SQUARE, edge_length=10.0, constraints=POINTS[:, :2].tolist())
    return build(Project("two", [rock]), cells="blocks")


def test_a_surface_parallel_to_a_drawn_one_follows_it():
    realizer = Realizer(parallel(thickness=3.0))
    for number in (0, 1):
        model = realizer.realization(number)
        assert heights(model, 1) == pytest.approx(heights(model, 0) + 3.0)
        assert np.abs(heights(model) - heights(realizer.model)).max() > 0.1


def test_thicknesses_are_drawn_where_points_have_them():
    points = POINTS + np.array([0, 0, 3.0]) + np.random.default_rng(5).uniform(0, 1, (12, 1)) * [[0, 0, 1]]
    base = parallel(points, thickness_method="kriging")
    realizer, nodes = Realizer(base), base.rock_inputs[0].region.vertices
    at = [int(np.flatnonzero((nodes == point).all(axis=1))[0]) for point in POINTS[:, :2]]
    thicknesses = []
    for number in (0, 1):
        model = realizer.realization(number)
        thicknesses.append(heights(model, 1) - heights(model, 0))
        assert heights(model, 1)[at] == pytest.approx(points[:, 2])
    assert np.abs(thicknesses[0] - thicknesses[1]).max() > 0.05


def test_what_is_prepared_changes_nothing():
    first, prepared = (Realizer(parallel(thickness=3.0)) for _ in range(2))
    prepared.prepare()
    second = prepared.realization(4)
    assert np.array_equal(first.realization(4).vertices, second.vertices)


def test_few_points_and_ready_meshes_stay():
    base = build(project(points=POINTS[:2], options={}, method="plane"), cells="blocks")
    assert not errors(base, 2).any()


def test_a_realization_depends_on_seed_and_number_alone():
    base = build(project(), cells="blocks")
    first = Realizer(base, 7).realization(5, threads=1)
    again = Realizer(base, 7)
    again.realization(2)
    assert np.array_equal(again.realization(5, threads=3).vertices, first.vertices)
    assert not np.array_equal(
        Realizer(base, 8).realization(5).vertices[:, 2].sum(), first.vertices[:, 2].sum()
    )


def test_realizations_with_faults_are_valid():
    vertices, triangles = plane_fault(50.0, 0.5, y=(-20.0, 120.0), z=(-30.0, 40.0))
    points = POINTS + np.where(POINTS[:, :1] > 44, [[0, 0, 12]], 0.0)
    given = project(points=points, faults=[Fault("F", vertices=vertices, triangles=triangles)])
    base = build(given, cells="blocks")
    assert len(base.compartment_names) == 2
    realizer = Realizer(base)
    volumes = set()
    for number in range(2):
        model = realizer.realization(number)
        assert model.validate(300).passed
        assert model.compartment_names == base.compartment_names
        volumes.add(model.blocks[0].volume)
    assert len(volumes) == 2


def test_heights_of_surfaces_that_faults_displace():
    """At the vertices of all sheets; a younger surface has one."""
    vertices, triangles = plane_fault(50.0, 0.5, y=(-20.0, 120.0), z=(-30.0, 40.0))
    points = POINTS + np.where(POINTS[:, :1] > 44, [[0, 0, 12]], 0.0)
    given = two_surfaces(0.5)
    given.rocks[0].surfaces[0] = replace(given.rocks[0].surfaces[0], points=points)
    given = replace(given, faults=[Fault("F", vertices=vertices, triangles=triangles, youngest="Lower")])
    found = ensemble(given, 4, seed=3)
    realizer = Realizer(found.model, 3)
    models = [realizer.realization(number) for number in range(4)]
    assert len(found.surface_mean[0]) == 2 * len(found.surface_mean[1])
    for number in (0, 1):
        nodes = found.model.surface(number)[0]
        z = np.array([model.surface(number)[0][:, 2] for model in models])
        assert (models[0].surface(number)[0][:, :2] == nodes[:, :2]).all()
        assert found.surface_mean[number] == pytest.approx(z.mean(axis=0))
        assert found.surface_deviation[number] == pytest.approx(z.std(axis=0, ddof=1), abs=1e-9)
        assert found.surface_deviation[number].max() > 0.3


def test_realizations_that_reach_below_the_base_are_cut_there():
    """Heights that are drawn may reach below a base that is right below the points."""
    low = replace(project().rocks[0], base_elevation=POINTS[:, 2].min() - 1.0)
    assert np.isfinite(ensemble(replace(project(), rocks=[low]), 20).volumes).all()


def test_block_at_points():
    base = build(project(), cells="blocks")
    points = np.array([[50, 50, -1], [50, 50, 1], [50, 50, 100], [500, 50, 1.0]])
    assert base.block_at(points).tolist() == [-1, 0, -1, -1]
    assert base.block_at(np.empty((0, 3))).tolist() == []
    for wrong in (points[0], points[:, :2], [[0.0, 0.0, np.nan]], "here"):
        with pytest.raises(UsageError, match="points must be an array"):
            base.block_at(wrong)
    with pytest.raises(UsageError, match="ask the whole model"):
        base.clip((1, 0, 0), (50, 50, 0)).block_at(points)


def test_an_ensemble_says_what_its_realizations_say():
    places = np.array([[50.0, 50.0, 1.0], [50.0, 50.0, heights(build(project())).mean()], [50.0, 50.0, 50.0]])
    calls = []
    found = ensemble(project(), 20, seed=2, places=places, progress=lambda share, _: calls.append(share))
    assert calls == sorted(calls) and calls[-1] == 1.0
    realizer = Realizer(found.model, 2)
    every = [realizer.realization(n) for n in range(20)]
    assert found.volumes[:, 0].tolist() == [model.blocks[0].volume for model in every]
    z = np.array([heights(model) for model in every])
    assert found.surface_mean[0] == pytest.approx(z.mean(axis=0))
    assert found.surface_deviation[0] == pytest.approx(z.std(axis=0, ddof=1), abs=1e-9)
    assert found.probability[:, 0] == pytest.approx(np.mean([m.block_at(places) == 0 for m in every], axis=0))
    assert found.probability[0, 0] == 1 and found.probability[2, 0] == 0
    assert found.entropy()[[0, 2]].tolist() == [0, 0]
    low, middle, high = found.percentiles()[:, 0]
    assert low < middle < high


def test_entropy_of_known_probabilities():
    base = build(project(), cells="blocks")
    counts = np.array([[8], [4], [2], [0]])
    sums = Sums(np.ones((8, 1)), [None], [None], counts)
    found = Ensemble.of(Realizer(base), sums, np.zeros((4, 3)))
    assert found.entropy() == pytest.approx([0, 1, 0.25 * 2 + 0.75 * np.log2(4 / 3), 0])


def test_sums_keep_their_order():
    parts = [Sums(np.array([[float(n)]]), [None], [None], np.ones((1, 1), np.int64)) for n in range(3)]
    total = added(parts)
    assert total.volumes[:, 0].tolist() == [0, 1, 2] and total.counts[0, 0] == 3


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ({"realizations": 0}, "at least one"),
        ({"seed": -1}, "seed"),
        ({"correlation": 1.5}, "between -1 and 1"),
    ],
)
def test_wrong_requests(arguments, said):
    with pytest.raises(UsageError, match=said):
        ensemble(project(), **arguments)


def test_realizations_are_made_once_for_all_holes(monkeypatch):
    """The next hole meets the same ones: it builds nothing, and says what it would have said first."""
    points = [[0, 0, 1], [4, 0, 2], [4, 4, 2], [0, 4, 1], [2, 2, 3], [1, 3, 2]]
    ground = Surface("ground", points=points, method="kriging", block="soil")
    square = [[0, 0], [4, 0], [4, 4], [0, 4]]
    project = Project("p", [Rock("hill", [ground], region=square, edge_length=1, base_elevation=-9)])
    found = ensemble(project, 3, seed=1)
    fresh = Ensemble(*(getattr(found, each.name) for each in fields(found)))
    expected = fresh.planned_hole((1.5, 1.0, 6.0), length=8.0)
    monkeypatch.setattr(Realizer, "_interpolated", None)
    for hole in (found, fresh, found):
        again = hole.planned_hole((1.5, 1.0, 6.0), length=8.0)
        assert again.contacts == expected.contacts
        assert again.probability.tobytes() == expected.probability.tobytes()
    found.planned_hole((2.5, 1.0, 6.0), length=8.0)
