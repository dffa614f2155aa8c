# SPDX-License-Identifier: GPL-3.0-or-later
"""Dips in the interpolation of heights, against dense linear algebra, and from file to model."""

from dataclasses import replace

import numpy as np
import pytest
from dense_functionals import dense_kriging_with_dips
from dense_kriging import SHAPES
from realmodel.core import (
    DipFile,
    Dips,
    Fault,
    InputRefused,
    Model,
    Project,
    Rock,
    Surface,
    build,
    cross_validate,
    interpolate,
    load_project,
    mesh_region,
)
from realmodel.core.base.work import Work, native_module
from realmodel.core.ensembles.realization import Realizer
from realmodel.core.heights.from_neighbors import dip_use, structure
from realmodel.core.heights.interpolation import Task
from realmodel.core.heights.realizations.draws import Draw
from realmodel.core.heights.realizations.turning_bands import FieldArea, Noise
from realmodel.core.project.project_writer import save_project
from realmodel.core.readers import read_dips
from realmodel.core.settings.methods import METHODS, checked_options
from structure_cases import SQUARE, heights_at, plane_fault, prepared

UTM = np.array([431250.0, 5398781.0])


def surface_at(plan):
    x, y = ((plan - UTM) / 1000).T
    return 40 * np.sin(5 * x) * np.cos(4 * y) + 30 * x


def slope_at(plan):
    x, y = ((plan - UTM) / 1000).T
    return np.column_stack(
        [0.2 * np.cos(5 * x) * np.cos(4 * y) + 0.03, -0.16 * np.sin(5 * x) * np.sin(4 * y)]
    )


def places(count, seed):
    return UTM + np.random.default_rng(seed).random((count, 2)) * 1000


def points_at(count, seed=5):
    plan = places(count, seed)
    return np.column_stack([plan, surface_at(plan)])


def dips_at(count, seed=6):
    plan = places(count, seed)
    return Dips(plan, slope_at(plan))


POINTS, DIPS = points_at(25), dips_at(12)
NODES = places(40, 7)
NESTED = {
    "nugget": 0.5,
    "structures": [
        {"model": "cubic", "range": 400.0, "sill": 60.0},
        {"model": "matern32", "range": 900.0, "sill": 150.0, "anisotropy": {"ratio": 3.0, "azimuth": 40.0}},
    ],
}
VARIOGRAMS = {model: {"model": model, "range": 700.0, "sill": 500.0, "nugget": 2.0} for model in SHAPES}
ANISOTROPY = {"ratio": 1.7, "azimuth": 30.0}


def use_of(points, dips, method, **options):
    settings = checked_options(method, options)
    return structure(Task(Work(), points, np.empty((0, 2)), settings, dips=dips)).dips


@pytest.mark.parametrize("name", [*VARIOGRAMS, "nested"])
@pytest.mark.parametrize("drift", ["constant", "linear"])
def test_kriging_with_dips_as_in_the_textbook(name, drift):
    method = "kriging" if drift == "constant" else "universal_kriging"
    variogram = VARIOGRAMS.get(name, NESTED)
    options = {"variogram": variogram, "anisotropy": ANISOTROPY}
    baseline = use_of(POINTS, DIPS, method, neighbours=0, **options).baseline
    result = interpolate(POINTS, NODES, method, neighbours=0, dips=DIPS, **options)
    z, variance = dense_kriging_with_dips(
        POINTS, (DIPS.positions, DIPS.gradients), NODES, variogram, baseline, drift, ANISOTROPY
    )
    np.testing.assert_allclose(result.z, z, atol=2e-6)
    np.testing.assert_allclose(result.variance, variance, atol=1e-5)


def test_near_points_and_dips_alone_count():
    points, dips = points_at(300), dips_at(60)
    variogram = VARIOGRAMS["cubic"]
    use = use_of(points, dips, "kriging", neighbours=10, variogram=variogram)
    assert use.neighbours == 2, "of as many as lie among the nearest points"
    result = interpolate(points, NODES, neighbours=10, dips=dips, variogram=variogram)
    for node, z, variance in zip(NODES[:12], result.z, result.variance, strict=False):
        near = points[np.argsort(np.hypot(*(points[:, :2] - node).T))[:10]]
        chosen = np.argsort(np.hypot(*(dips.positions - node).T))[:2]
        given = dips.positions[chosen], dips.gradients[chosen]
        expected = dense_kriging_with_dips(near, given, node[None], variogram, use.baseline)
        assert (z, variance) == pytest.approx((expected[0][0], expected[1][0]), abs=1e-5)
    within = interpolate(points, NODES, neighbours=10, radius=1e6, dips=dips, variogram=variogram)
    np.testing.assert_allclose(within.z, result.z, atol=1e-9)
    narrow = interpolate(points, NODES, neighbours=10, radius=1.0, dips=dips, variogram=variogram)
    plain = interpolate(points, NODES, neighbours=10, radius=1.0, variogram=variogram)
    assert np.array_equal(narrow.z, plain.z), "dips beyond the radius do not count"


@pytest.mark.parametrize("model", ["gaussian", "cubic", "matern32", "matern52"])
@pytest.mark.parametrize("method", ["kriging", "universal_kriging"])
def test_the_surface_has_its_dips_and_meets_its_points(method, model):
    options = {"variogram": {"model": model, "range": 700.0, "sill": 500.0}, "neighbours": 0, "dips": DIPS}
    step = 0.5
    for axis in (0, 1):
        away = step * np.eye(2)[axis]
        above = interpolate(POINTS, DIPS.positions + away, method, **options).z
        below = interpolate(POINTS, DIPS.positions - away, method, **options).z
        np.testing.assert_allclose((above - below) / (2 * step), DIPS.gradients[:, axis], atol=2e-3)
    assert np.array_equal(interpolate(POINTS, POINTS[:, :2], method, **options).z, POINTS[:, 2])


@pytest.mark.parametrize("model", SHAPES)
def test_dips_help_with_every_model(model):
    points, dips = points_at(30), dips_at(30)
    nodes = places(300, 8)
    variogram = {"model": model, "range": 900.0, "sill": 800.0}

    def error(**more):
        z = interpolate(points, nodes, variogram=variogram, neighbours=0, **more).z
        return np.sqrt(np.mean((z - surface_at(nodes)) ** 2))

    assert error(dips=dips) < 0.85 * error()


@pytest.mark.parametrize("method", ["universal_kriging", "spline"])
@pytest.mark.parametrize("neighbours", [0, 16])
def test_a_plane_of_one_contact_and_dips_is_exact(method, neighbours):
    slope = np.array([0.3, -0.7])
    points = np.array([[*(UTM + 500), 100.0]])
    dips = Dips(DIPS.positions, np.tile(slope, (len(DIPS), 1)))
    options = {"variogram": VARIOGRAMS["matern52"]} if method != "spline" else {}
    z = interpolate(points, NODES, method, neighbours=neighbours, dips=dips, **options).z
    np.testing.assert_allclose(z, 100 + (NODES - UTM - 500) @ slope, atol=1e-6)


@pytest.mark.parametrize("neighbours", [0, 8])
@pytest.mark.parametrize("method", ["kriging", "universal_kriging"])
def test_a_point_that_is_left_out_is_estimated_with_all_dips(method, neighbours):
    variogram = VARIOGRAMS["matern52"]
    found = cross_validate(POINTS, method, neighbours, dips=DIPS, variogram=variogram)
    use = use_of(POINTS, DIPS, method, neighbours=neighbours, variogram=variogram)
    drift = "linear" if method == "universal_kriging" else "constant"
    for out in range(0, len(POINTS), 6):
        others, place = np.delete(POINTS, out, axis=0), POINTS[out : out + 1, :2]
        near, chosen = np.arange(len(others)), np.arange(len(DIPS))
        if neighbours:
            near = np.argsort(np.hypot(*(others[:, :2] - place).T))[:neighbours]
            chosen = np.argsort(np.hypot(*(DIPS.positions - place).T))[: use.neighbours]
        given = DIPS.positions[chosen], DIPS.gradients[chosen]
        z, variance = dense_kriging_with_dips(others[near], given, place, variogram, use.baseline, drift)
        assert found.z[out] == pytest.approx(z[0], abs=1e-5)
        assert found.standardized[out] == pytest.approx(
            (z[0] - POINTS[out, 2]) / np.sqrt(variance[0]), abs=1e-4
        )
    assert cross_validate(POINTS, "spline", 0, dips=DIPS).rmse < cross_validate(POINTS, "spline", 0).rmse


@pytest.mark.parametrize("options", [{}, {"neighbours": 8}, {"octants": 2}, {"neighbours": 0}])
def test_the_same_bytes_for_any_number_of_threads_and_order_of_nodes(options):
    points, dips = points_at(400), dips_at(40)
    one = interpolate(points, NODES, threads=1, dips=dips, variogram=NESTED, **options)
    two = interpolate(points, NODES, threads=2, dips=dips, variogram=NESTED, **options)
    back = interpolate(points, NODES[::-1], threads=2, dips=dips, variogram=NESTED, **options)
    assert one.z.tobytes() == two.z.tobytes()
    assert back.z[::-1].tobytes() == one.z.tobytes()


def test_the_spline_has_its_dips():
    task = Task(Work(), POINTS, NODES, checked_options("spline", {}), dips=DIPS)
    baseline = dip_use(task, None, 0).baseline
    result = []
    for way in np.vstack([np.eye(2), -np.eye(2)]) * baseline / 2:
        result.append(interpolate(POINTS, DIPS.positions + way, "spline", neighbours=0, dips=DIPS).z)
    slopes = np.column_stack([result[0] - result[2], result[1] - result[3]]) / baseline
    np.testing.assert_allclose(slopes, DIPS.gradients, atol=1e-9)
    z = interpolate(POINTS, NODES, "spline", neighbours=0, dips=dips_at(60)).z
    without = interpolate(POINTS, NODES, "spline", neighbours=0).z
    assert abs(z - surface_at(NODES)).mean() < 0.5 * abs(without - surface_at(NODES)).mean()


def test_several_dips_at_one_place_are_their_mean():
    twice = Dips(np.vstack([DIPS.positions, DIPS.positions[:1]]), np.vstack([DIPS.gradients, [[0.5, 0.5]]]))
    once = Dips(DIPS.positions, DIPS.gradients.copy())
    once.gradients[0] = (DIPS.gradients[0] + 0.5) / 2
    options = {"variogram": NESTED}
    result = interpolate(POINTS, NODES, dips=twice, **options)
    assert result.z.tobytes() == interpolate(POINTS, NODES, dips=once, **options).z.tobytes()
    assert any("1 position has several dips" in warning for warning in result.warnings)
    same = Dips(np.vstack([DIPS.positions] * 2), np.vstack([DIPS.gradients] * 2))
    result = interpolate(POINTS, NODES, dips=same, **options)
    assert result.z.tobytes() == interpolate(POINTS, NODES, dips=DIPS, **options).z.tobytes()
    assert result.warnings == ()


def test_methods_that_do_not_use_dips_refuse_them():
    able = {name for name, method in METHODS.items() if method.is_constrained}
    assert {"kriging", "universal_kriging", "spline", "auto"} <= able
    for method in set(METHODS) - able - {"parallel", "dsi"}:
        with pytest.raises(InputRefused, match=f"method '{method}' does not use dips"):
            interpolate(POINTS, NODES, method, dips=DIPS)


def test_an_automatic_method_uses_dips():
    many = interpolate(POINTS, NODES, "auto", dips=DIPS)
    assert METHODS[many.method].is_constrained
    for count in (1, 2, 5):
        few = interpolate(POINTS[:count], NODES, "auto", dips=DIPS)
        assert few.method == "spline"
        assert "uses dips" in few.reason


def test_dips_that_make_no_sense_are_refused():
    for wrong in (
        Dips(DIPS.positions, DIPS.gradients[:-1]),
        Dips(DIPS.positions[:, :1], DIPS.gradients),
        Dips(np.array([[0.0, np.nan]]), np.array([[0.0, 0.0]])),
        Dips(np.array([["a", "b"]]), np.array([[0.0, 0.0]])),
        Dips(DIPS.positions, DIPS.gradients, np.zeros(2)),
    ):
        with pytest.raises(InputRefused, match="dip"):
            interpolate(POINTS, NODES, dips=wrong)


def test_a_baseline_follows_the_data_and_the_model():
    task = Task(Work(), POINTS, NODES, checked_options("kriging", {"variogram": NESTED}), dips=DIPS)
    extent = np.vstack([POINTS[:, :2], DIPS.positions])
    spacing = np.sqrt(np.ptp(extent, axis=0).prod() / len(extent))
    rough = use_of(POINTS, DIPS, "kriging", variogram=VARIOGRAMS["spherical"])
    assert rough.baseline == pytest.approx(spacing)
    smooth = use_of(POINTS, DIPS, "kriging", variogram=VARIOGRAMS["cubic"])
    assert smooth.baseline == pytest.approx(spacing / 64)
    assert dip_use(task, None, 0).baseline == pytest.approx(spacing)
    short = use_of(POINTS, DIPS, "kriging", variogram={"model": "spherical", "range": 50.0, "sill": 9.0})
    assert short.baseline == 50.0
    far = use_of(POINTS, DIPS, "kriging", variogram={"model": "gaussian", "range": 1e5, "sill": 9.0})
    assert far.baseline == 1e5 / 1024


TABLE = """x,y,z,dip,dip_direction
431300,5398800,10,30,90
431400,5398900,,45,180
431500,5399000,12,0,
"""


def write(folder, text, name="dips.csv"):
    (folder / name).write_text(text)
    return folder / name


def rock_of(points, **more):
    low, high = UTM, UTM + 1000
    region = [low, [high[0], low[1]], high, [low[0], high[1]]]
    return Rock("R", [Surface("A", points=points, **more)], region, edge_length=60.0, base_elevation=-500.0)


def read(file, **more):
    return read_dips(DipFile(file, **more))


def test_a_table_of_dips(tmp_path):
    dips = read(write(tmp_path, TABLE))
    np.testing.assert_allclose(dips.gradients, [[-np.tan(np.pi / 6), 0], [0, 1], [0, 0]], atol=1e-15)
    np.testing.assert_array_equal(dips.positions[1], [431400, 5398900])
    assert np.isnan(dips.z[1]) and dips.z[2] == 12
    strike = TABLE.replace("dip_direction", "strike").replace(",90\n", ",0\n").replace(",180\n", ",90\n")
    np.testing.assert_array_equal(read(write(tmp_path, strike)).gradients, dips.gradients)
    other = (
        TABLE.replace("dip_direction", "DipDir (deg)").replace("x,y", "Easting;Northing").replace(",", ";")
    )
    np.testing.assert_array_equal(read(write(tmp_path, other)).gradients, dips.gradients)
    named = TABLE.replace("dip,", "INCL OF BED,")
    found = read(write(tmp_path, named), columns={"dip": "INCL OF BED"})
    np.testing.assert_array_equal(found.gradients, dips.gradients)
    in_feet = read(write(tmp_path, TABLE), units={"xy": "km", "z": "ft"})
    np.testing.assert_allclose(in_feet.positions, 1000 * dips.positions)
    assert in_feet.z[0] == pytest.approx(3.048)


@pytest.mark.parametrize(
    ("row", "said"),
    [
        ("1,2,3,90,10", "the dip 90 is vertical"),
        ("1,2,3,120,10", "the dip 120 is overturned"),
        ("1,2,3,-5,10", "not from 0 to 90"),
        ("1,2,3,five,10", "dip is not a number"),
        ("1,2,3,5,", "the dip has no direction"),
        ("1,,3,5,7", "y is not a number"),
    ],
)
def test_wrong_dips_are_refused_with_their_row(tmp_path, row, said):
    file = write(tmp_path, TABLE + row + "\n")
    with pytest.raises(InputRefused, match=said) as refused:
        read(file)
    assert refused.value.file == file
    assert refused.value.line == 5


def test_overturned_dips_and_missing_columns_are_refused(tmp_path):
    overturned = "x,y,dip,strike,polarity\n1,2,30,40,1\n1,3,30,40,-1\n"
    with pytest.raises(InputRefused, match="the dip is overturned") as refused:
        read(write(tmp_path, overturned))
    assert refused.value.line == 3
    with pytest.raises(InputRefused, match="no column dip_direction or strike"):
        read(write(tmp_path, "x,y,dip\n1,2,30\n"))
    with pytest.raises(InputRefused, match="no column dip"):
        read(write(tmp_path, "x,y,strike\n1,2,30\n"))


PROJECT = """format = 1
name = "Dips"
[[rock]]
name = "R"
region = [[431250, 5398781], [432250, 5398781], [432250, 5399781], [431250, 5399781]]
edge_length = 80
base_elevation = -500
[[rock.surface]]
name = "A"
points = "points.csv"
dips = {dips}
method = "{method}"
"""


def test_a_project_with_dips(tmp_path):
    write(tmp_path, "x,y,z\n431300,5398800,10\n431800,5399300,40\n", "points.csv")
    write(tmp_path, TABLE)
    file = write(tmp_path, PROJECT.format(dips='"dips.csv"', method="universal_kriging"), "p.toml")
    project = load_project(file)
    assert tmp_path / "dips.csv" in project.input_files()
    model = build(project)
    dips = model.project.rocks[0].surfaces[0].dips
    assert len(dips) == 3
    saved = model.project
    written = save_project(saved, tmp_path / "again.toml")
    assert any(path.name.endswith("dips.csv") for path in written)
    again = build(load_project(tmp_path / "again.toml"))
    assert np.array_equal(again.surface(0)[0], model.surface(0)[0])
    model.save(tmp_path / "model.npz")
    kept = Model.load(tmp_path / "model.npz").project.rocks[0].surfaces[0].dips
    assert np.array_equal(kept.gradients, dips.gradients)
    write(tmp_path, PROJECT.format(dips='{ file = "dips.csv", units = "ft" }', method="spline"), "p.toml")
    in_feet = load_project(file).rocks[0].surfaces[0].dips
    assert in_feet.units == "ft"
    for dips, method, said in (
        ('"dips.csv"', "tin", "method 'tin' does not use dips"),
        ('"none.csv"', "spline", "file not found"),
        ('{ file = "dips.csv", where = 1 }', "spline", "where"),
        ('{ file = "dips.csv", columns = { dep = 1 } }', "spline", "unknown column 'dep'"),
        ("7", "spline", "dips"),
    ):
        write(tmp_path, PROJECT.format(dips=dips, method=method), "p.toml")
        with pytest.raises(InputRefused, match=said) as refused:
            load_project(file)
        assert refused.value.line == 11


def test_realizations_have_the_dips():
    options = {"neighbours": 0, "variogram": {"model": "cubic", "range": 700.0, "sill": 500.0}}
    task = Task(Work(), POINTS, NODES, checked_options("kriging", options), dips=DIPS)
    half = use_of(POINTS, DIPS, "kriging", **options).baseline / 2
    ends = np.vstack([DIPS.positions + sign * half * axis for axis in np.eye(2) for sign in (1, -1)])
    drawn = []
    for seed in (1, 2):
        draw = Draw(FieldArea(UTM, UTM + 1000), Noise((seed, 0)), {})
        z = draw.heights("kriging", replace(task, nodes=ends)).z.reshape(4, -1)
        slopes = np.column_stack([z[0] - z[1], z[2] - z[3]]) / (2 * half)
        np.testing.assert_allclose(slopes, DIPS.gradients, atol=1e-6)
        drawn.append(draw.heights("kriging", task).z)
    assert abs(drawn[0] - drawn[1]).max() > 1


def test_realizations_of_a_model_with_dips():
    model = build(Project("P", [rock_of(POINTS, dips=DIPS)]))
    first, second = (Realizer(model, seed=3).realization(number) for number in (0, 1))
    assert not np.array_equal(first.surface(0)[0], second.surface(0)[0])


def test_a_mesh_has_no_dips():
    corners = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]])
    surface = Surface("A", vertices=corners, triangles=np.array([[0, 1, 2]], np.int32), dips=DIPS)
    with pytest.raises(InputRefused, match="'dips' has no effect"):
        build(Project("P", [Rock("R", [surface], base_elevation=-1.0)]))


REGION = UTM + 1000.0 * np.array([[0, 0], [1, 0], [1, 1], [0, 1]])
MESH = mesh_region(REGION, edge_length=60.0)


def on_mesh(points, dips, **options):
    return interpolate(points, MESH[0], "dsi", triangles=MESH[1], dips=dips, **options)


def test_a_plane_of_one_contact_and_dips_is_exact_on_a_mesh():
    slope = np.array([0.3, -0.7])
    points = np.array([[*(UTM + 500), 100.0]])
    dips = Dips(DIPS.positions, np.tile(slope, (len(DIPS), 1)))
    for options in ({}, {"weight": 1.0}):
        z = on_mesh(points, dips, **options).z
        np.testing.assert_allclose(z, 100 + (MESH[0] - UTM - 500) @ slope, atol=1e-8)


def slopes_of_triangles(z, plan):
    nodes, triangles = MESH
    found = []
    for place in plan:
        for triangle in triangles:
            corners = np.column_stack([np.ones(3), nodes[triangle] - place])
            weights = np.linalg.solve(corners.T, [1, 0, 0])
            if (weights >= 0).all():
                found.append(np.linalg.solve(corners, z[triangle])[1:])
                break
    return np.array(found)


def test_triangles_have_their_dips():
    dips = dips_at(10)
    result = on_mesh(POINTS, dips)
    assert result.warnings == ()
    np.testing.assert_allclose(slopes_of_triangles(result.z, dips.positions), dips.gradients, atol=1e-6)
    native = native_module()
    on_points = native.surface_heights(
        np.column_stack([MESH[0], result.z]), MESH[1], np.ascontiguousarray(POINTS[:, :2])
    )
    np.testing.assert_allclose(on_points, POINTS[:, 2], atol=1e-5)
    near = on_mesh(POINTS, dips, weight=0.5)
    off = abs(slopes_of_triangles(near.z, dips.positions) - dips.gradients).max()
    without = abs(
        slopes_of_triangles(on_mesh(POINTS, None, weight=0.5).z, dips.positions) - dips.gradients
    ).max()
    assert 1e-4 < off < without, "with a weight dips are approximate as points are"
    assert on_mesh(POINTS, dips, threads=1).z.tobytes() == result.z.tobytes()


def test_dips_that_the_mesh_cannot_have_are_told():
    far = Dips(np.vstack([DIPS.positions, UTM - 100]), np.vstack([DIPS.gradients, [[1.0, 0]]]))
    assert "left out: 1 dip outside the mesh" in on_mesh(POINTS, far).warnings
    place = MESH[0][MESH[1][40]].mean(axis=0)
    both = Dips(np.array([place, place + 0.1]), np.array([[0.1, 0.0], [0.2, 0.0]]))
    assert any("some dips cannot be honored" in text for text in on_mesh(POINTS, both).warnings)


@pytest.mark.parametrize("method", ["universal_kriging", "dsi"])
@pytest.mark.parametrize("dies_out", [False, True])
def test_dips_count_on_their_side_of_a_fault(method, dies_out):
    """Two planes with opposite dips on the sides of a fault."""
    rng = np.random.default_rng(3)
    plan = rng.uniform(0, 10, (60, 2))
    slope = np.where(plan[:, :1] < 5, [[0.5, 0.0]], [[-0.5, 0.0]])
    heights = np.where(plan[:, 0] < 5, 0.5 * plan[:, 0], 4.5 - 0.5 * plan[:, 0])
    points = np.column_stack([plan, heights])
    dips = Dips(plan + 0.01, slope, heights)
    options = {"variogram": {"model": "matern52", "range": 20.0, "sill": 9.0}} if method != "dsi" else {}
    surface = Surface("A", points=points, dips=dips, method=method, options=options)
    fault = plane_fault(y=(-5.0, 8.0) if dies_out else (-5.0, 15.0))
    faults = [Fault("F", *fault, dies_out=dies_out)]
    rock = Rock("R", [surface], SQUARE, edge_length=0.8, base_elevation=-20.0)
    (entry,) = prepared(Project("P", [rock], faults=faults))
    sheets = {
        int(row[0]): entry.structure.sheet(n, 0)
        for n, row in enumerate(entry.structure.compartments)
        if row[0]
    }
    assert set(sheets) == {-1, 1}

    def slope_of(side, x):
        low, high = heights_at(np.array([[x - 0.5, 2.0], [x + 0.5, 2.0]]), *sheets[side])
        return high - low

    left = min((-1, 1), key=lambda side: abs(slope_of(side, 2.0) - 0.5))
    own = {left: (2.0, 0.5), -left: (8.0, -0.5)}
    for side, (x, expected) in own.items():
        assert slope_of(side, x) == pytest.approx(expected, abs=0.02)
        if not dies_out:
            assert slope_of(side, 10.0 - x) == pytest.approx(expected, abs=0.02), "only its own dips count"
