# SPDX-License-Identifier: GPL-3.0-or-later
"""Series of sheets: surfaces that are kriged together, against dense linear algebra and closed forms."""

from dataclasses import replace

import numpy as np
import pytest
from realmodel.core import (
    Dips,
    Fault,
    InputRefused,
    Model,
    Observations,
    Project,
    Rock,
    SpaceDips,
    Surface,
    build,
    load_project,
)
from realmodel.core.base.work import Work, native_module
from realmodel.core.ensembles.realization import Realizer
from realmodel.core.heights.companions import Companions, SheetModel
from realmodel.core.heights.cross_validation import validate
from realmodel.core.heights.from_neighbors import DipUse, KrigingStructure, structure
from realmodel.core.heights.interpolation import Task
from realmodel.core.heights.realizations.sheet_draws import SeriesDraw
from realmodel.core.heights.realizations.turning_bands import FieldArea, GaussianField, Noise
from realmodel.core.project.project_writer import save_project
from realmodel.core.project.series import Series
from realmodel.core.results.surface_quality import surface_quality
from realmodel.core.settings.methods import checked_options
from realmodel.core.settings.variogram import Variogram
from structure_cases import heights_at

RANGE, BASELINE = 400.0, 2.0
VARIOGRAM = {
    "model": "cubic",
    "range": RANGE,
    "sill": 300.0,
    "nugget": 0.0,
    "anisotropy_ratio": 1.0,
    "anisotropy_azimuth": 0.0,
    "further": [],
}
THICKNESS = {**VARIOGRAM, "model": "spherical", "range": 250.0, "sill": 1.0}
VARIANCES = np.array([0.0, 0.1, 0.15])
REGION = np.array([[0.0, 0], [1000, 0], [1000, 1000], [0, 1000]])


def cubic(t):
    return np.where(t < 1, 1 - 7 * t**2 + 8.75 * t**3 - 3.5 * t**5 + 0.75 * t**7, 0.0)


def spherical(t):
    return np.where(t < 1, 1 - 1.5 * t + 0.5 * t**3, 0.0)


def covariance(a, on_a, b, on_b):
    away = np.hypot(*(a[:, None] - b[None]).transpose(2, 0, 1))
    under = np.minimum(VARIANCES[on_a][:, None], VARIANCES[on_b][None])
    return VARIOGRAM["sill"] * (cubic(away / RANGE) + under * spherical(away / 250.0))


def dense(points, sheets, dips, of_dips, nodes, sheet):
    """Ordinary cokriging of a sheet at nodes: heights and variances."""
    places, on = [points[:, :2]], [sheets]
    values = [points[:, 2]]
    for axis in (0, 1):
        half = BASELINE / 2 * np.eye(2)[axis]
        places += [dips.positions + half, dips.positions - half]
        on += [of_dips, of_dips]
        values.append(BASELINE * dips.gradients[:, axis])
    places, on = np.concatenate(places), np.concatenate(on)
    count, slopes = len(points), len(of_dips)
    to_data = np.zeros((count + 2 * slopes, len(places)))
    to_data[:count, :count] = np.eye(count)
    for axis in (0, 1):
        for k in range(slopes):
            row, first = count + axis * slopes + k, count + 2 * axis * slopes
            to_data[row, first + k], to_data[row, first + slopes + k] = 1, -1
    c = to_data @ covariance(places, on, places, on) @ to_data.T
    drift = to_data @ np.ones(len(places))
    system = np.block([[c, drift[:, None]], [drift[None], np.zeros((1, 1))]])
    right = to_data @ covariance(places, on, nodes, np.full(len(nodes), sheet))
    right = np.vstack([right, np.ones(len(nodes))])
    weights = np.linalg.solve(system, right)
    own = VARIOGRAM["sill"] * (1 + VARIANCES[sheet])
    return weights[:-1].T @ np.concatenate(values), own - (weights * right).sum(axis=0)


def joint_data(seed=3):
    random = np.random.default_rng(seed)
    plan = random.uniform(0, 1000, (24, 2))
    plan[12:16] = plan[:4]  # holes that meet two sheets
    sheets = np.repeat([0, 1, 2], [12, 9, 3]).astype(np.int32)
    z = 20 * np.sin(plan[:, 0] / 120) + 15.0 * sheets + random.normal(0, 1, 24)
    dips = Dips(random.uniform(0, 1000, (5, 2)), random.normal(0, 0.1, (5, 2)))
    return np.column_stack([plan, z]), sheets, dips, np.array([0, 2, 1, 2, 0], np.int32)


@pytest.mark.parametrize("sheet", [0, 1, 2])
@pytest.mark.parametrize("neighbors", [0, 24])
def test_cokriging_as_in_the_textbook(sheet, neighbors):
    points, sheets, dips, of_dips = joint_data()
    nodes = np.random.default_rng(9).uniform(0, 1000, (30, 2))
    given = (dips.positions, dips.gradients, BASELINE, 0)
    near = (neighbors, 0, 0.0 if neighbors == 0 else 1e6)  # with a radius systems are made one by one
    joint = (sheets, of_dips, VARIANCES, THICKNESS, sheet)
    z, variance, _ = native_module().krige(points, nodes, VARIOGRAM, near, "constant", given, joint)
    expected = dense(points, sheets, dips, of_dips, nodes, sheet)
    np.testing.assert_allclose(z, expected[0], atol=1e-6)
    np.testing.assert_allclose(variance, expected[1], atol=1e-5)
    own = points[sheets == sheet]
    at, zero, _ = native_module().krige(
        points, np.ascontiguousarray(own[:, :2]), VARIOGRAM, near, "constant", given, joint
    )
    assert np.array_equal(at, own[:, 2])
    assert not zero.any()


@pytest.mark.parametrize("neighbors", [0, 23])
def test_each_point_from_the_others_of_all_sheets(neighbors):
    points, sheets, dips, of_dips = joint_data()
    given = (dips.positions, dips.gradients, BASELINE, 0)
    near = (neighbors, 0, 0.0 if neighbors == 0 else 1e6)
    joint = (sheets, of_dips, VARIANCES, THICKNESS, 0)
    z, variance, _ = native_module().krige_left_out(points, VARIOGRAM, near, "constant", given, joint)
    for row in (0, 5, 13, 22):
        rest = np.arange(len(points)) != row
        expected = dense(points[rest], sheets[rest], dips, of_dips, points[row : row + 1, :2], sheets[row])
        assert z[row] == pytest.approx(expected[0][0], abs=1e-6)
        assert variance[row] == pytest.approx(expected[1][0], abs=1e-5)


def test_sheets_that_make_no_sense_are_refused():
    points, sheets, *_ = joint_data()
    nodes, none = points[:2, :2].copy(), np.zeros(0, np.int32)
    for joint, said in (
        ((sheets[1:], none, VARIANCES, THICKNESS, 0), "each point"),
        ((sheets, none, VARIANCES, THICKNESS, 3), "no such sheet"),
        ((sheets, none, VARIANCES[::-1].copy(), THICKNESS, 0), "ascend"),
    ):
        with pytest.raises(native_module().InputError, match=said):
            native_module().krige(points, nodes, VARIOGRAM, (0, 0, 0.0), "constant", None, joint)


def fold(plan):
    return 60 * np.sin(plan[:, 0] / 75) + 0.05 * plan[:, 1]


THICK = 25.0


def height(k, plan):
    return fold(plan) + k * THICK * (1 + 0.1 * np.sin(plan[:, 1] / 150))


def surfaces_of(counts, seed=1, **more):
    random = np.random.default_rng(seed)
    found = []
    for k, count in enumerate(counts):
        plan = random.uniform(0, 1000, (count, 2))
        points = np.column_stack([plan, height(k, plan)])
        found.append(Surface(f"S{k}", points=points, rule="conformable", series="J", **more))
    return found


def rock_of(surfaces, **more):
    series = [Series("J", "sheets")] if any(each.series for each in surfaces) else []
    given = {"edge_length": 60.0, "base_elevation": -500.0, "series": series, **more}
    return Rock("R", surfaces, REGION, **given)


def error(model, number):
    vertices = model.surface(number)[0]
    return float(np.sqrt(np.mean((vertices[:, 2] - height(number, vertices[:, :2])) ** 2)))


def alone(surfaces):
    return [replace(each, series=None) for each in surfaces]


def test_a_surface_with_two_contacts_follows_its_neighbors():
    surfaces = surfaces_of([40, 2, 40])
    together = build(Project("p", [rock_of(surfaces)]))
    apart = build(Project("p", [rock_of(alone(surfaces))]))
    assert error(apart, 1) > 20
    assert error(together, 1) < 0.4 * error(apart, 1)
    for number in (0, 2):
        assert error(together, number) < 0.3 * error(apart, 1)


def test_dips_of_one_sheet_count_for_all():
    surfaces = surfaces_of([8, 8, 8])
    plan = np.random.default_rng(4).uniform(0, 1000, (40, 2))
    slope = np.column_stack([0.8 * np.cos(plan[:, 0] / 75), np.full(40, 0.05)])
    surfaces[0].dips = Dips(plan, slope)
    together = build(Project("p", [rock_of(surfaces)]))
    surfaces[0].dips = None
    without = build(Project("p", [rock_of(surfaces)]))
    assert error(together, 2) < 4.0 < 0.8 * error(without, 2)


def bedding(count, seed=4):
    """Places and normals measured in the beds, anywhere in the series."""
    plan = np.random.default_rng(seed).uniform(0, 1000, (count, 2))
    slope = np.column_stack([0.8 * np.cos(plan[:, 0] / 75), np.full(count, 0.05)])
    return plan, slope


def test_dips_of_the_series_count_for_all_its_sheets():
    surfaces = surfaces_of([8, 8, 8])
    plan, slope = bedding(40)
    errors = []
    for dips in (
        None,
        Dips(plan, slope),
        SpaceDips(np.column_stack([plan, fold(plan) + 30]), np.column_stack([-2 * slope, np.full(40, 2.0)])),
    ):
        model = build(Project("p", [rock_of(surfaces, series=[Series("J", "sheets", dips)])]))
        errors.append([error(model, number) for number in range(3)])
        given = [data.dips for data in model.rock_inputs[0].data]
        assert [0 if each is None else len(each) for each in given] == [0 if dips is None else 40] * 3
    assert np.allclose(errors[1], errors[2], rtol=1e-9)
    assert max(errors[1]) < 0.6 * min(errors[0])


def test_dips_of_the_series_that_name_a_block_or_a_surface():
    surfaces = [*surfaces_of([8, 8, 8]), Surface("cover", method="constant", options={"value": 400.0})]
    plan, slope = bedding(7)
    names = np.array([["", ""], ["S1", ""], ["", "S1"], ["", "S0"], ["", "cover"], ["cover", ""], ["S1", ""]])
    used = np.arange(7) < 6
    dips = Dips(plan, slope, None, names[:, 0], names[:, 1], used)
    model = build(Project("p", [rock_of(surfaces, series=[Series("J", "sheets", dips)])]))
    given = [data.dips for data in model.rock_inputs[0].data]
    rows = [[0, 2, 3], [0, 1, 2], [0, 4]]  # those over and under the block of S1, the base under that of S0
    for each, expected in zip(given[:3], rows, strict=True):
        assert sorted(each.positions.tolist()) == sorted(plan[expected].tolist())
    assert given[3] is None
    (left_out,) = [each for each in model.rock_inputs[0].left_out if each.kind == "dip_series"]
    assert "'cover'" in left_out.text


def test_dips_of_sheets_are_not_overturned():
    dips = SpaceDips(np.zeros((2, 3)), np.array([[0, 1, 1.0], [1, 0, 0.0]]))
    rock = rock_of(surfaces_of([8, 8]), series=[Series("J", "sheets", dips)])
    with pytest.raises(InputRefused, match=r"series 'J'.*dip 1 is vertical or overturned"):
        build(Project("p", [rock]))


def test_a_project_file_with_dips_of_sheets(tmp_path):
    for k, surface in enumerate(surfaces_of([20, 3])):
        rows = "\n".join(",".join(map(repr, row)) for row in surface.points.tolist())
        (tmp_path / f"p{k}.csv").write_text("x,y,z\n" + rows + "\n")
    (tmp_path / "dips.csv").write_text("x,y,z,dip,dip_direction,unit\n200,300,,20,90,\n600,700,5,10,270,S1\n")
    file = tmp_path / "p.toml"
    file.write_text(PROJECT.format(more='dips = "dips.csv"', first=""))
    project = load_project(file)
    assert tmp_path / "dips.csv" in project.input_files()
    model = build(project)
    assert [len(data.dips) for data in model.rock_inputs[0].data] == [2, 2]
    save_project(model.project, tmp_path / "again.toml")
    model.save(tmp_path / "m.npz")
    for again in (load_project(tmp_path / "again.toml"), Model.load(tmp_path / "m.npz").project):
        rebuilt = build(again)
        assert all(np.array_equal(rebuilt.surface(k)[0], model.surface(k)[0]) for k in (0, 1))
    (tmp_path / "dips.csv").write_text("x,y,z,dip,dip_direction\n200,300,,20,90\n600,700,5,120,270\n")
    with pytest.raises(InputRefused, match="the dip 120 is overturned") as refused:
        build(project)
    assert refused.value.line == 3


def test_thicknesses_are_never_negative_and_contacts_are_met():
    surfaces = surfaces_of([30, 6, 30])
    for k, surface in enumerate(surfaces):
        surface.points[:, 2] -= k * (THICK - 2.0) * (surface.points[:, 0] > 500)  # thin in the east
    model = build(Project("p", [rock_of(surfaces)]))
    sheets = [model.surface(k)[0][:, 2] for k in range(3)]
    assert (np.diff(sheets, axis=0) >= 0).all()
    nodes = model.surface(0)[0][:, :2]
    corner = surfaces_of([30])
    assert len(corner[0].points) == 30
    held = Surface("S1", points=np.array([[*nodes[7], sheets[0][7] + 40.0]]), rule="conformable", series="J")
    again = build(Project("p", [rock_of([surfaces[0], held, surfaces[2]])]))
    assert again.surface(1)[0][7, 2] == pytest.approx(held.points[0, 2], abs=1e-9)


def test_a_sheet_that_is_absent_in_holes_is_nowhere_above_them():
    """Where it would lie below the older one it is raised at nodes: not at those around such a hole."""
    rows = []
    for hole, (x, y) in enumerate(np.random.default_rng(5).uniform(60, 940, (14, 2)).round(2).tolist()):
        low = 20.0 + 0.05 * x
        high = low + max(0.0, 12 * np.sin(x / 160) * np.cos(y / 210))
        for block, ends in (("B2", (120.0, high)), ("B1", (high, low)), ("B0", (low, -60.0))):
            rows += [(x, y, z, block, str(hole)) for z in ends if ends[0] > ends[1]]
    seen = Observations([row[:3] for row in rows], [row[3] for row in rows], [row[4] for row in rows])
    surfaces = [
        *(Surface(f"S{k}", block=f"B{k}", rule="conformable", method="kriging", series="J") for k in (0, 1)),
        Surface("S2", block="B2", method="constant", options={"value": 120.0}),
    ]
    square = [[0, 0], [1000, 0], [1000, 1000], [0, 1000]]
    rock = Rock("R", surfaces, square, edge_length=90.0, base_elevation=-100.0, observations=seen)
    model = build(Project("p", [replace(rock, series=[Series("J", "sheets")])]))
    found = model.observed()
    assert (found.share, found.violated, len(found.contacts)) == (1.0, [], 18)
    assert (model.surface(1)[0][:, 2] >= model.surface(0)[0][:, 2]).all()


def test_contacts_of_others_bound_a_sheet():
    """At a contact of an older sheet, the younger one lies at it or above."""
    surfaces = surfaces_of([25, 25])
    surfaces[1].points[:, 2] = height(0, surfaces[1].points[:, :2]) + 1.0
    model = build(Project("p", [rock_of(surfaces, edge_length=30.0)]))
    z = heights_at(np.ascontiguousarray(surfaces[0].points[:, :2]), *model.surface(1))
    assert (z >= surfaces[0].points[:, 2] - 3.0).all()


def test_variances_know_of_the_other_sheets():
    surfaces = surfaces_of([40, 8, 40])
    together = build(Project("p", [rock_of(surfaces)]))
    apart = build(Project("p", [rock_of(alone(surfaces))]))
    variance = [np.median(model.rock_inputs[0].attributes[1]["variance"]) for model in (together, apart)]
    assert 0 < variance[0] < variance[1]


def test_cross_validation_knows_of_the_other_sheets():
    surfaces = surfaces_of([30, 10, 30])
    points = [surface.points[np.lexsort(surface.points.T[::-1])] for surface in surfaces]  # as they are read
    method, settings = surfaces[1].method_options()
    task = Task(Work(), points[1], np.empty((0, 2)), settings)
    joint = replace(task, companions=Companions(1, points, [None] * 3))
    found, plain = (validate(method, each, 10) for each in (joint, task))
    assert found.rmse < 0.5 * plain.rmse
    model = build(Project("p", [rock_of(surfaces)]))
    assert surface_quality(model, 1).cross_validation.rmse == pytest.approx(found.rmse)


def test_few_contacts_of_parallel_sheets_say_what_these_lie_apart():
    """Together with what all of them show of their folds, which none shows by itself."""
    points = [surface.points for surface in surfaces_of([4, 12, 9], seed=2)]
    for k, each in enumerate(points):
        each[:, 2] = fold(each) + k * THICK
    task = Task(Work(), points[1], np.empty((0, 2)), checked_options("kriging", {}))
    known = {}
    found = structure(replace(task, companions=Companions(1, points, [None] * 3, known)))
    np.testing.assert_allclose(np.diff(found.sheets.offsets), THICK, atol=0.5)
    again = replace(task, points=points[2], companions=Companions(2, points, [None] * 3, known))
    assert structure(again).variogram is not found.variogram
    assert structure(again).variogram == found.variogram
    assert len(known) == 1, "it is fitted once for all sheets"


def test_the_model_of_sheets():
    points = [surface.points for surface in surfaces_of([60, 60, 60])]
    task = Task(Work(), points[2], np.empty((0, 2)), checked_options("kriging", {}))
    found = structure(replace(task, companions=Companions(2, points, [None] * 3)))
    offsets = found.sheets.offsets
    np.testing.assert_allclose(np.diff(offsets), THICK, atol=4)
    assert (np.diff(found.sheets.variances) > 0).all(), "thicknesses vary"
    assert found.sheets.variances[-1] < 0.2, "less than heights"


def test_each_compartment_has_its_sheets():
    surfaces = surfaces_of([40, 6, 40])
    for surface in surfaces:
        surface.points[:, 2] += 80.0 * (surface.points[:, 0] > 500)
    fault = Fault("F", trace=[[500, -100], [500, 1100]], dip=90, elevation=0.0)
    together, apart = (
        build(Project("p", [rock_of(given)], faults=[fault])) for given in (surfaces, alone(surfaces))
    )
    errors = []
    for model in (together, apart):
        divided, off = model.rock_inputs[0].divided(), []
        for name, side, throw in (("below F", -1, 0.0), ("above F", 1, 80.0)):
            vertices = divided.sheets[divided.names.index(name)][1].vertices
            there = vertices[side * (vertices[:, 0] - 500) > 1]  # beyond the fault a sheet does not count
            off.append(there[:, 2] - height(1, there[:, :2]) - throw)
        errors.append(np.sqrt(np.mean(np.concatenate(off) ** 2)))
    assert errors[0] < 8.0 < 0.7 * errors[1]


def test_realizations_go_through_the_contacts():
    surfaces = surfaces_of([30, 5, 30])
    nodes = build(Project("p", [rock_of(surfaces)])).surface(0)[0][:, :2]
    surfaces[1].points = np.column_stack([nodes[[9, 60]], height(1, nodes[[9, 60]])])
    model = build(Project("p", [rock_of(surfaces)]))
    drawn = Realizer(model, seed=5).realization(0)
    assert np.abs(drawn.surface(1)[0][[9, 60], 2] - surfaces[1].points[:, 2]).max() < 1e-6
    assert not np.array_equal(drawn.surface(1)[0], model.surface(1)[0])


@pytest.mark.parametrize("method", ["kriging", "dsi"])
def test_sheets_are_drawn_together(method):
    """Heights that are not certain are so for all sheets together: what these lie apart is known, and thinner
    beds than the errors of heights do not cross."""
    surfaces = surfaces_of([6, 4, 6], method=method)
    for k, surface in enumerate(surfaces):
        surface.points[:, 2] = fold(surface.points) + 6.0 * k
    model = build(Project("p", [rock_of(surfaces)]))
    realizer, apart, errors = Realizer(model, seed=5), [], []
    for number in range(3):
        drawn = realizer.realization(number)
        sheets = np.array([drawn.surface(k)[0][:, 2] for k in range(3)])
        errors.append(sheets - [model.surface(k)[0][:, 2] for k in range(3)])
        apart.append(np.diff(sheets, axis=0))
        assert not [each for each in drawn.warnings if each.kind == "minimum_thickness"]
        for k, surface in enumerate(surfaces):
            z = heights_at(np.ascontiguousarray(surface.points[:, :2]), *drawn.surface(k))
            np.testing.assert_allclose(z, surface.points[:, 2], atol=1e-6)
    assert np.abs(errors).max() > 20
    assert np.abs(np.array(apart) - 6.0).max() < 5.5
    assert (
        np.corrcoef(np.ravel([each[0] for each in errors]), np.ravel([each[2] for each in errors]))[0, 1]
        > 0.99
    )
    again = realizer.realization(1)
    assert np.array_equal(again.surface(2)[0], realizer.realization(1).surface(2)[0])


def test_a_drawn_sheet_is_the_field_in_common_and_the_thicknesses_under_it():
    area = FieldArea(np.zeros(2), np.full(2, 1000.0))
    places = np.array([[100.0, 200], [180, 260], [800, 700]])
    variogram, thickness = Variogram("cubic", RANGE, 300.0), Variogram("spherical", 250.0, 1.0)
    model = SheetModel(np.zeros(3), VARIANCES, thickness)
    found = KrigingStructure(variogram, 0, DipUse(1.0, 0), sheets=model)
    noises = [Noise((7, sheet)) for sheet in range(3)]
    series = SeriesDraw(noises)
    drawn = [series.of(sheet, area, found, None).at(Work(), places) for sheet in (2, 0, 1)]
    fields = [variogram, replace(thickness, sill=30.0), replace(thickness, sill=15.0)]
    parts = [GaussianField(fields[k], None, area, noises[k]).at(Work(), places) for k in range(3)]
    for k, sheet in ((2, 0), (0, 1), (1, 2)):
        np.testing.assert_allclose(drawn[sheet], np.sum(parts[: k + 1], axis=0), rtol=1e-9)
    assert len(series.known) == 3


PROJECT = """format = 1
name = "p"
[[rock]]
name = "R"
region = [[0, 0], [1000, 0], [1000, 1000], [0, 1000]]
edge_length = 100
base_elevation = -500
[[rock.series]]
name = "J"
kind = "sheets"
{more}
[[rock.surface]]
name = "S0"
points = "p0.csv"
series = "J"
{first}
[[rock.surface]]
name = "S1"
points = "p1.csv"
series = "J"
"""


SECOND = 'name = "S"\npoints = "p1.csv"\nseries = "J"\ncorrelation = 0.5'


def test_a_project_file_with_sheets(tmp_path):
    for k, surface in enumerate(surfaces_of([20, 3])):
        rows = "\n".join(",".join(map(repr, row)) for row in surface.points.tolist())
        (tmp_path / f"p{k}.csv").write_text("x,y,z\n" + rows + "\n")
    file = tmp_path / "p.toml"
    file.write_text(PROJECT.format(more="", first=""))
    model = build(load_project(file))
    save_project(model.project, tmp_path / "again.toml")
    again = build(load_project(tmp_path / "again.toml"))
    assert np.array_equal(again.surface(1)[0], model.surface(1)[0])
    for more, first, said in (
        ('dips = "none.csv"', "", "file not found"),
        ("resolution = 5.0", "", "'resolution' has no effect"),
        ('thickness = "parallel"', "", "'thickness' has no effect"),
        ("", 'method = "spline"', "'S0' has method 'spline'"),
        ("", f"[[rock.surface]]\n{SECOND}", "'S' has a correlation"),
    ):
        file.write_text(PROJECT.format(more=more, first=first))
        with pytest.raises(InputRefused, match=said):
            load_project(file)
