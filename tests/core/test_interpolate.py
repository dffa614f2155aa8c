# SPDX-License-Identifier: GPL-3.0-or-later
"""interpolate and mesh_region as users call them, and surfaces interpolated in projects."""

import json
import subprocess
import sys

import numpy as np
import pytest
from dense_kriging import dense_kriging, distances
from realmodel.core import (
    InputRefused,
    Project,
    Rock,
    Structure,
    Surface,
    UsageError,
    Variogram,
    build,
    interpolate,
    load_project,
    mesh_region,
)
from stacks import places

RNG = np.random.default_rng(5)
PLAN = RNG.random((60, 2)) * 100
POINTS = np.column_stack([PLAN, 5 * np.sin(PLAN[:, 0] / 20) + 0.1 * PLAN[:, 1]])
NODES = RNG.random((40, 2)) * 100
SETTINGS = {"model": "spherical", "range": 60.0, "sill": 9.0, "nugget": 0.5}


@pytest.mark.parametrize("model", ["spherical", "exponential", "gaussian"])
@pytest.mark.parametrize("anisotropy", [{}, {"ratio": 2.5, "azimuth": 30.0}])
def test_kriging_as_in_the_textbook(model, anisotropy):
    settings = {**SETTINGS, "model": model}
    z, variance = dense_kriging(POINTS, NODES, settings, anisotropy=anisotropy)
    result = interpolate(POINTS, NODES, neighbours=0, variogram=settings, anisotropy=anisotropy or None)
    assert result.z == pytest.approx(z, abs=1e-8)
    assert result.variance == pytest.approx(variance, abs=1e-8)
    assert (result.method, result.variogram) == ("kriging", Variogram(**settings))
    assert not result.variogram.fitted


def test_kriging_honors_the_points_and_uses_neighbours():
    result = interpolate(POINTS, POINTS[:, :2], variogram={**SETTINGS, "nugget": 0.0}, neighbours=8)
    assert result.z == pytest.approx(POINTS[:, 2])
    assert result.variance == pytest.approx(np.zeros(len(POINTS)), abs=1e-9)
    near = np.argsort(distances(POINTS, NODES), axis=0)[:8, 0]
    z, _ = dense_kriging(POINTS[near], NODES[:1], SETTINGS)
    assert interpolate(POINTS, NODES, variogram=SETTINGS, neighbours=8).z[0] == pytest.approx(z[0])


def test_a_fitted_variogram_comes_with_what_it_was_fitted_to():
    result = interpolate(POINTS, NODES)
    variogram = result.variogram
    assert variogram.fitted
    assert len(variogram.lags) == len(variogram.gamma) == len(variogram.pairs) > 3
    assert variogram.range > 0
    assert 0 <= variogram.nugget <= variogram.sill
    again = interpolate(POINTS, NODES, variogram=variogram, neighbours=result.neighbours)
    assert np.array_equal(again.z, result.z)
    assert again.variogram == variogram


def test_idw_by_its_formula():
    d = distances(POINTS, NODES)
    weights = d**-3.0
    expected = (weights * POINTS[:, 2:]).sum(axis=0) / weights.sum(axis=0)
    result = interpolate(POINTS, NODES, method="idw", neighbours=0, power=3)
    assert result.z == pytest.approx(expected)
    assert (result.variance, result.method, result.variogram) == (None, "idw", None)


def test_the_number_of_threads_changes_no_bit():
    one, two = (interpolate(POINTS, NODES, threads=threads) for threads in (1, 2))
    assert np.array_equal(one.z, two.z)
    assert np.array_equal(one.variance, two.variance)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"method": "magic"}, "unknown method"),
        ({"power": 2}, "'power' belongs to idw, not to kriging"),
        ({"method": "idw", "variogram": SETTINGS}, "'variogram' belongs to kriging"),
        ({"raduis": 2}, "'raduis' is not an option of any method"),
        ({"neighbours": -1}, "'neighbours' must be a whole number from 0"),
        ({"neighbours": 2.5}, "'neighbours' must be a whole number from 0"),
        ({"method": "idw", "power": 0}, "'power' must be more than 0"),
        ({"variogram": {**SETTINGS, "sill": "4"}}, "'sill' must be a finite number"),
        ({"variogram": {**SETTINGS, "sill": 0.1}}, "more than the sill"),
        ({"anisotropy": {"ratio": 2}}, "lacks 'azimuth'"),
        ({"points": np.zeros((0, 3))}, "there are no points"),
        ({"points": np.zeros((3, 2))}, "must be an array (N, 3)"),
        ({"points": [[0, 0, np.nan]]}, "point 0 is (0, 0, nan), not finite"),
        ({"points": [[0, 0, 1], [0, 0, 2]]}, "two points have the same position in plan (0, 0)"),
        ({"points": "many"}, "not an array of numbers"),
        ({"nodes": [[0, np.inf]]}, "node 0 is not finite"),
        ({"nodes": [0, 1]}, "must be an array (N, 2)"),
    ],
)
def test_refused(arguments, words):
    with pytest.raises(InputRefused) as raised:
        interpolate(**{"points": POINTS, "nodes": NODES, **arguments})
    assert words in str(raised.value)


def test_wrong_calls():
    with pytest.raises(UsageError, match="threads"):
        interpolate(POINTS, NODES, threads=-1)
    with pytest.raises(UsageError, match="triangles"):
        interpolate(POINTS, NODES, triangles=[0, 1, 2])
    with pytest.raises(UsageError, match="mesher"):
        mesh_region([[0, 0], [1, 0], [0, 1]], edge_length=1, mesher="fast")
    with pytest.raises(InputRefused, match="edge_length"):
        mesh_region([[0, 0], [1, 0], [0, 1]])


OUTLINE = [[0, 0], [10, 0], [10, 8], [6, 8], [6, 4], [0, 4]]
HOLE = [[7, 1], [8, 1], [8, 2], [7, 2]]


def plan_areas(vertices, triangles):
    a, b, c = (vertices[triangles[:, i]] for i in range(3))
    return ((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]) / 2


def test_mesh_region():
    steps = []
    vertices, triangles = mesh_region(
        OUTLINE, holes=[HOLE], edge_length=0.25, progress=lambda fraction, text: steps.append(fraction)
    )
    assert (vertices.dtype, triangles.dtype) == (np.float64, np.int32)
    areas = plan_areas(vertices, triangles)
    assert (areas > 0).all()
    assert areas.sum() == pytest.approx(10 * 8 - 6 * 4 - 1)
    edges = np.concatenate([vertices[triangles] - vertices[np.roll(triangles, 1, axis=1)]]).reshape(-1, 2)
    assert np.hypot(*edges.T).mean() == pytest.approx(0.25, rel=0.3)
    assert steps[-1] == 1.0
    closed, turned = mesh_region([*OUTLINE, OUTLINE[0]][::-1], holes=[HOLE], edge_length=0.25)
    assert plan_areas(closed, turned).sum() == pytest.approx(areas.sum())


@pytest.mark.parametrize(
    ("outline", "options", "words"),
    [
        ([[0, 0], [1, 1], [1, 0], [0, 1]], {}, "crosses"),
        ([[0, 0], [1, 0], [2, 0]], {}, "one line"),
        ([[0, 0], [1, 0], [1, 1]], {"edge_length": 1e-9}, "would need"),
        ([[0, 0], [1, 0], [1, 1]], {"edge_length": 0}, "above 0"),
        ([[0, 0], [1, 0], [1, 1]], {"edge_length": "2"}, "above 0"),
        ([[0, 0], [1, 0], [1, 1]], {"holes": [[[0.5, 0.2], [3, 0.2], [3, 0.3]]]}, "crosses"),
        ([[0, 0], [1, 0], [1, np.nan]], {}, "corner 2"),
    ],
)
def test_regions_refused(outline, options, words):
    with pytest.raises(InputRefused) as raised:
        mesh_region(outline, **{"edge_length": 0.1, **options})
    assert words in str(raised.value)


@pytest.fixture
def basin(write):
    """A project with two interpolated surfaces, a ready mesh between them, and a region with a hole."""

    def put(edge_length=1.0, region='"region.geojson"'):
        x, y = (g.ravel() for g in np.meshgrid(np.linspace(-1, 11, 13), np.linspace(-1, 9, 11)))
        for name, z in (("floor", 0.02 * (x - 5) ** 2), ("top", 3 + 0.1 * np.sin(y))):
            write(
                f"{name}.csv", "x,y,z\n" + "\n".join(f"{a},{b},{c}" for a, b, c in zip(x, y, z, strict=True))
            )
        write("middle.off", "OFF\n4 1 0\n-5 -5 1\n20 -5 1\n20 20 1.5\n-5 20 1.5\n4 0 1 2 3\n")
        rings = [[*OUTLINE, OUTLINE[0]], [*HOLE, HOLE[0]]]
        write("region.geojson", f'{{"type": "Polygon", "coordinates": {rings}}}')
        return write(
            "basin.toml",
            f"""format = 1
name = "basin"
[[rock]]
name = "basin"
region = {region}
edge_length = {edge_length}
base_elevation = -2.0
[[rock.surface]]
name = "floor"
points = "floor.csv"
method = "idw"
power = 3
[[rock.surface]]
name = "middle"
mesh = "middle.off"
[[rock.surface]]
name = "top"
points = "top.csv"
variogram = {{model = "gaussian", range = 8, sill = 0.5}}
""",
        )

    return put


def test_surfaces_interpolated_on_one_mesh(basin, tmp_path):
    path = basin()
    model = build(load_project(path))
    floor, top = model.surface(0), model.surface(2)
    assert np.array_equal(floor[1], top[1])
    assert np.array_equal(floor[0][:, :2], top[0][:, :2])
    assert model.surface(1)[0].shape == (4, 3)
    methods = [result.method if result else None for result in model.interpolations]
    assert methods == ["idw", None, "universal_kriging"]
    assert model.interpolations[2].variogram == Variogram("gaussian", 8.0, 0.5)
    # the region is 55 in area; the ready mesh is clipped by it
    thickness = model.volume / 55.0
    assert 4.9 < thickness < 5.2
    assert [block.name for block in model.blocks] == ["base block", "middle block", "top block"]
    if places.CHECK.is_dir():
        model.save(tmp_path / "m.npz")
        check = subprocess.run(
            [sys.executable, places.CHECK / "check_model.py", path, tmp_path / "m.npz"],
            capture_output=True,
            text=True,
            check=False,
        )
        assert check.returncode == 0, check.stdout
    staged = model.stage(1)
    assert staged.volume < model.volume
    assert np.array_equal(staged.surface(0)[0], floor[0])
    assert np.array_equal(build(load_project(path), stage=1).vertices, staged.vertices)


def test_a_ready_mesh_is_clipped_by_a_region_without_a_mesh():
    triangles = np.array([[0, 1, 2], [0, 2, 3]])
    plan = np.array([[-5, -5], [20, -5], [20, 20], [-5, 20.0]])
    surfaces = [Surface(f"S{k}", np.column_stack([plan, np.full(4, float(k))]), triangles) for k in range(2)]
    model = build(Project("x", [Rock("r", surfaces, region=OUTLINE, holes=[HOLE])]))
    assert model.volume == pytest.approx(55.0)


def test_huge_meshes_are_refused_at_the_line_of_the_edge_length(basin):
    path = basin(edge_length=1e-7)
    with pytest.raises(InputRefused) as raised:
        build(load_project(path))
    message = str(raised.value)
    assert (raised.value.file, raised.value.line) == (path, 6)
    assert "edge length 1e-07 would need" in message
    assert "use an edge length of at least" in message


def test_outlines_that_cross_are_refused_at_their_place(basin):
    path = basin(region="[[0, 0], [9, 9], [9, 0], [0, 9]]")
    with pytest.raises(InputRefused) as raised:
        build(load_project(path))
    assert (raised.value.file, raised.value.line) == (path, 5)
    assert raised.value.place == (4.5, 4.5)
    assert "crosses" in str(raised.value)


def test_mis_ties_are_averaged_with_a_warning(basin, write):
    path = basin()
    build(load_project(path))
    write("top.csv", "0,0,1\n10,8,3\n0,0,1.06\n5,5,2\n5,5,2\n")
    model = build(load_project(path))
    # The diagonal of middle.off runs through nodes of the mesh, up to rounding: a warning, too.
    (warning,) = (w for w in model.warnings if w.kind != "joined")
    assert (warning.kind, warning.rock, warning.surface) == ("points", "basin", "top")
    assert "1 position has several elevations, up to 0.06 apart (at (0, 0)): their mean is used" in str(
        warning
    )
    vertices, _ = model.surface(2)
    corner = (vertices[:, :2] == 0).all(axis=1)
    assert vertices[corner, 2] == pytest.approx([1.03])
    assert len(model.project.rocks[0].surfaces[2].points) == 5, "the project keeps what was given"
    assert model.stage(2) is model
    assert [w for w in model.stage(1).warnings if w.kind != "joined"] == []


def test_contradicting_points_are_named(basin, write):
    path = basin()
    write("top.csv", "0,0,1\n5,5,2\n0,0,3\n")
    with pytest.raises(InputRefused) as raised:
        build(load_project(path))
    assert "top.csv: rock 'basin', surface 'top', points: two points have the same position" in str(
        raised.value
    )


def test_a_surface_ends_with_its_points_where_no_extrapolation_is_wanted(basin, write):
    path = basin()
    write("top.csv", "2,1,3\n8,1,3\n8,5,3.5\n2,3,3.5\n")
    path.write_text(path.read_text() + 'extrapolate = "none"\n')
    model = build(load_project(path))
    whole, part = model.surface(0), model.surface(2)
    assert 0 < len(part[1]) < len(whole[1])
    assert np.isfinite(part[0]).all()
    x, y = part[0][:, :2].T
    assert (y >= 1).all()
    assert (x >= 2).all()
    assert (x <= 8).all()
    share = model.interpolations[2].extrapolated
    nodes = whole[0][:, :2]
    inside = (nodes[:, 1] >= 1) & (nodes[:, 0] >= 2) & (nodes[:, 0] <= 8)
    inside &= nodes[:, 1] <= 3 + (nodes[:, 0] - 2) / 3 + 1e-12
    assert share == pytest.approx(1 - inside.mean())
    write("top.csv", "20,20,3\n28,20,3\n24,25,3.5\n")
    with pytest.raises(InputRefused, match="no triangle of the region's mesh has elevations"):
        build(load_project(path))


def field_along(azimuth, count=900):
    """(P, 3) points of a surface whose heights differ three times as fast across an azimuth as along it."""
    own = np.random.default_rng(4)
    plan = own.uniform(0, 1000, (count, 2))
    turn = np.radians(azimuth)
    along, across = plan @ [np.sin(turn), np.cos(turn)], 3 * (plan @ [np.cos(turn), -np.sin(turn)])
    waves = own.normal(size=(40, 4))
    z = sum(np.sin((a * along + b * across) / 150 + 6 * c) / (a * a + b * b + 0.3) for a, b, c, _ in waves)
    return np.column_stack([plan, z])


def test_an_anisotropy_is_found_and_can_be_given_again():
    points = field_along(35)
    others, places = points[:-100], points[-100:, :2]
    found = interpolate(others, places)
    anisotropy = found.variogram.anisotropy
    assert 1.6 < anisotropy["ratio"] < 3.5
    assert anisotropy["azimuth"] == pytest.approx(35, abs=10)
    without = interpolate(others, places, anisotropy={"ratio": 1, "azimuth": 0})
    assert without.variogram.anisotropy is None
    error, error_without = (np.sqrt(np.mean((r.z - points[-100:, 2]) ** 2)) for r in (found, without))
    assert error < 0.8 * error_without
    # As a report writes it, and a project file reads it.
    settings = json.loads(json.dumps(found.variogram.settings()))
    for given in (settings, found.variogram):
        again = interpolate(others, places, variogram=given, neighbours=32)
        np.testing.assert_allclose(again.z, found.z, rtol=0, atol=1e-9)
        np.testing.assert_allclose(again.variance, found.variance, rtol=1e-6, atol=1e-12)


def test_a_second_structure_is_drawn_and_written_as_a_sum():
    own = np.random.default_rng(0)
    plan = own.uniform(0, 200, (900, 2))
    parts = Structure("matern52", 300.0, 20.0), Structure("exponential", 300.0, 0.6)
    truth = Variogram("nested", 300.0, 20.6, 0.0, parts)
    distance = np.hypot(*(plan[:, None] - plan[None]).transpose(2, 0, 1))
    factor = np.linalg.cholesky(truth.sill - truth.semivariance(distance) + 1e-9 * np.eye(len(plan)))
    variogram = interpolate(
        np.column_stack([plan, factor @ own.normal(size=len(plan))]), plan[:3] + 0.1
    ).variogram
    assert variogram.model == "nested"
    assert len(variogram.structures) == 2
    assert variogram.sill == pytest.approx(sum(part.sill for part in variogram.structures) + variogram.nugget)
    assert variogram.range == max(part.range for part in variogram.structures)
    for h in (2.0, 5.0, 15.0):
        assert variogram.semivariance(h) == pytest.approx(truth.semivariance(h), rel=0.4)
    assert len(variogram.settings()["structures"]) == 2


def test_contacts_along_lines_of_a_map_do_not_follow_the_ground():
    """Lines are drawn within some meters: near each, contacts lie on the ground, whose slope is another."""
    ground = lambda x, y: 300 + 80 * np.sin(x / 900) * np.cos(y / 700) + 40 * np.sin(x / 311 + y / 417)  # noqa: E731
    contact = lambda x: 200 + 0.03 * x  # noqa: E731
    x, y = np.random.default_rng(3).uniform(0, 7000, (2, 40000))
    near = np.abs(ground(x, y) - contact(x)) < 2
    points = np.column_stack([x, y, ground(x, y)])[near]
    _, one = np.unique(np.floor(points[:, :2] / 60), axis=0, return_index=True)
    nodes = np.column_stack([each.ravel() for each in np.mgrid[500:6500:20j, 500:6500:20j]])
    for method, most in (("kriging", 5.0), ("universal_kriging", 1.0), ("auto", 1.0)):
        found = interpolate(points[one], nodes, method=method)
        assert np.median(np.abs(found.z - contact(nodes[:, 0]))) < most, method
