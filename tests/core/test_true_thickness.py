# SPDX-License-Identifier: GPL-3.0-or-later
"""Thicknesses that are perpendicular to the surface beneath, against closed forms and distances."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from realmodel import _native
from realmodel.core import (
    Fault,
    InputRefused,
    Project,
    Rock,
    Surface,
    build,
    interpolate,
    load_project,
    mesh_region,
)
from realmodel.core.base.work import Work
from realmodel.core.ensembles import Realizer
from realmodel.core.project.project_writer import save_project
from realmodel.core.surfaces.local_heights import local_surfaces
from realmodel.core.surfaces.prepare import read_rocks
from structure_cases import plane_fault, prepared

OUTLINE = [[0.0, 0.0], [30.0, 0.0], [30.0, 20.0], [0.0, 20.0]]
PLAN, TRIANGLES = mesh_region(OUTLINE, edge_length=1.0)
STEEP = np.tan(np.radians(60.0))


def offset(z, thickness, plan=PLAN, triangles=TRIANGLES):
    """Heights so far from a sheet, perpendicular to it."""
    sheet = (np.column_stack([plan, z]), triangles)
    return interpolate(
        None, plan, "parallel", triangles, to=sheet, thickness=thickness, true_thickness=True
    ).z


def distances(sheet, points):
    vertices, triangles = sheet
    return _native.nearest_triangles(vertices[triangles], np.ascontiguousarray(points))[1]


def within(margin):
    """(N,) bool: the nodes so far from the border."""
    return (np.minimum(PLAN, np.array([30.0, 20.0]) - PLAN) > margin).all(axis=1)


def rock(*surfaces, **options):
    return Project("p", [Rock("r", list(surfaces), region=OUTLINE, edge_length=1.0, **options)])


@pytest.mark.parametrize("corner", [(0.0, 0.0), (3_512_400.0, 5_401_700.0)])
@pytest.mark.parametrize("thickness", [0.25, 4.0, -4.0, 50.0])
def test_over_a_plane_of_60_degrees_they_are_twice_as_thick_upward(corner, thickness):
    """At the border, too: the plane goes on beyond it."""
    plan = PLAN + corner
    z = STEEP * ((plan - corner) @ [0.6, 0.8]) + 300.0
    assert np.abs(offset(z, thickness, plan) - z - 2 * thickness).max() < 1e-8


def test_over_a_cylinder_they_lie_on_another_one():
    """An anticline with its axis along y: of radius 40, and its layer of 5."""
    axis, radius, thickness = 15.0, 40.0, 5.0
    plan, triangles = mesh_region(OUTLINE, edge_length=0.25)
    off = plan[:, 0] - axis
    z = np.sqrt(radius**2 - off**2)
    sag = 0.25**2 / radius  # of chords; more than any
    above = np.sqrt((radius + thickness) ** 2 - off**2)
    inner = np.abs(off) < 13.0  # beyond its border the cylinder goes on as a plane
    assert np.abs(offset(z, thickness, plan, triangles) - above)[inner].max() < sag
    below = np.sqrt((radius - thickness) ** 2 - off**2)
    assert np.abs(offset(z, -thickness, plan, triangles) - below)[inner].max() < sag


def test_a_valley_has_a_crest_and_a_ridge_is_round():
    plan, triangles = mesh_region(OUTLINE, edge_length=1.0, constraints=[[[15.0, 0.0], [15.0, 20.0]]])
    off, thickness = np.abs(plan[:, 0] - 15.0), 4.0
    valley = offset(off, thickness, plan, triangles)
    assert np.abs(valley - off - thickness * np.sqrt(2)).max() < 1e-12
    limb = off > thickness / np.sqrt(2)
    ridge = offset(-off, thickness, plan, triangles)
    round_part = np.sqrt(np.maximum(thickness**2 - off**2, 0))
    expected = np.where(limb, thickness * np.sqrt(2) - off, round_part)
    assert np.abs(ridge - expected).max() < 1e-12


@settings(deadline=None, max_examples=30)
@given(
    st.integers(0, 10_000),
    st.floats(0.0, 5.0),
    st.floats(0.05, 12.0),
    st.sampled_from([1.0, -1.0]),
)
def test_no_node_is_nearer_than_the_thickness_and_each_is_as_near(seed, roughness, thickness, sign):
    z = np.random.default_rng(seed).uniform(0, roughness, len(PLAN)) + STEEP * PLAN[:, 0] * (seed % 3)
    found = offset(z, sign * thickness)
    away = distances((np.column_stack([PLAN, z]), TRIANGLES), np.column_stack([PLAN, found]))
    slack = 1e-12 * (thickness + np.abs(z).max())
    assert (sign * (found - z) >= thickness - slack).all()
    assert (away >= thickness - slack).all()
    inner = within(thickness)
    assert (away <= thickness + slack)[inner].all()


def test_where_the_other_surface_has_no_height_there_is_none():
    z = np.where(PLAN[:, 0] <= 15.0, 0.5 * PLAN[:, 0], np.nan)
    found = interpolate(None, PLAN, "parallel", TRIANGLES, to=z, thickness=2.0, true_thickness=True).z
    assert np.array_equal(np.isfinite(found), np.isfinite(z))
    known = np.isfinite(z)
    assert np.abs(found - z - 2 * np.sqrt(1.25))[known].max() < 1e-12


def test_a_surface_does_not_go_on_over_itself():
    """Across a slot that is narrower than the thickness: a basin beside a limb that ends there."""
    slot = [[14.0, 3.0], [14.5, 3.0], [14.5, 17.0], [14.0, 17.0]]
    plan, triangles = mesh_region(OUTLINE, holes=[slot], edge_length=1.0)
    z = np.where(plan[:, 0] < 14.25, 2.0 * (plan[:, 0] - 14.0), 0.0)
    found = offset(z, 3.0, plan, triangles)
    far = (plan[:, 0] > 17.6) & (np.abs(plan[:, 1] - 10.0) < 6.0)
    assert np.abs(found[far] - 3.0).max() < 1e-12
    away = distances((np.column_stack([plan, z]), triangles), np.column_stack([plan, found]))
    assert away.min() >= 3.0 - 1e-12


def test_the_thickness_that_points_show_is_spread():
    """Wells on a layer of 3 over a plane of 60 degrees show 6 upward; the layer is honored between them."""
    low = Surface("low", np.column_stack([PLAN, STEEP * PLAN[:, 0]]), TRIANGLES)
    wells = np.array([[4.0, 4.0], [11.0, 16.0], [17.0, 3.0], [22.0, 12.0]])
    points = np.column_stack([wells, STEEP * wells[:, 0] + 6.0])
    high = Surface("high", points=points, method="parallel", options={"to": "low"}, true_thickness=True)
    model = build(rock(low, high))
    vertices, _ = model.surface(1)
    assert np.abs(vertices[:, 2] - STEEP * vertices[:, 0] - 6.0).max() < 1e-9
    by_kriging = {"to": "low", "thickness_method": "kriging"}
    many = np.random.default_rng(1).uniform(1.0, 24.0, (16, 2))  # four show no variogram
    thickness = 6.0 + np.sin(many[:, 0] / 4.0) + np.cos(many[:, 1] / 5.0)
    points = np.column_stack([many, STEEP * many[:, 0] + thickness])
    given = {"points": points, "method": "parallel", "options": by_kriging, "tie": False}
    vertical, true = (
        build(rock(low, Surface("high", true_thickness=true, **given))).interpolations[1].variance
        for true in (False, True)
    )
    known = vertical > 1e-6
    assert np.abs(true / vertical - 1)[known].max() < 1e-6  # of thicknesses half as large


def test_a_minimum_thickness_moves_what_is_nearer_alone():
    """A flat top over a limb of 45 degrees: kept where it is farther than the thickness."""
    low = Surface("low", np.column_stack([PLAN, PLAN[:, 0] - 20.0]), TRIANGLES)
    top = {"points": np.array([[5.0, 5.0, 0.0]]), "method": "constant", "minimum_thickness": 2.0}
    model = build(rock(low, Surface("top", true_thickness=True, **top)))
    vertices, _ = model.surface(1)
    bottom = vertices[:, 0] - 20.0
    assert np.abs(vertices[:, 2] - np.maximum(0.0, bottom + 2 * np.sqrt(2))).max() < 1e-12
    assert distances(model.surface(0), vertices)[vertices[:, 0] < 28.0].min() >= 2.0 - 1e-12
    (warning,) = [each for each in model.warnings if each.kind == "minimum_thickness"]
    assert "to stay 2 above 'low', perpendicular to it, by up to 12.83 at" in warning.text
    vertical = build(rock(low, Surface("top", **top))).surface(1)[0]
    assert np.abs(vertical[:, 2] - np.maximum(0.0, vertical[:, 0] - 18.0)).max() < 1e-12


def test_in_compartments_it_is_measured_from_their_own_sheets():
    plan = np.random.default_rng(2).uniform(0, 10, (300, 2))
    z = 0.75 * plan[:, 1] + np.where(plan[:, 0] < 5, -3.0, 2.0)
    lower = Surface("S0", points=np.column_stack([plan, z]), method="universal_kriging")
    upper = Surface("S1", method="parallel", options={"to": "S0", "thickness": 1.0}, true_thickness=True)
    kept = Surface("S2", method="constant", options={"value": -9.0}, minimum_thickness=2.0)
    kept.true_thickness = True
    square = [[0, 0], [10, 0], [10, 10], [0, 10]]
    mass = Rock("r", [lower, upper, kept], region=square, edge_length=1.0)
    (entry,) = prepared(Project("p", [mass], faults=[Fault("F", *plane_fault())]))
    assert len(entry.structure.sheets) == 2
    for sheets in entry.structure.sheets:
        bottom, middle, top = (sheet.vertices[:, 2] for sheet in sheets)
        assert np.abs(middle - bottom - 1.25).max() < 1e-6
        assert np.abs(top - middle - 2.5).max() < 1e-6


def test_realizations_keep_the_thickness_and_honor_points():
    rng = np.random.default_rng(5)
    points = np.column_stack([rng.uniform(1, 29, 25), rng.uniform(1, 19, 25), rng.normal(0, 2, 25)])
    lower = Surface(
        "low", points=points, options={"variogram": {"model": "spherical", "range": 15, "sill": 4}}
    )
    upper = Surface("high", method="parallel", options={"to": "low", "thickness": 2.0}, true_thickness=True)
    realizer = Realizer(build(rock(lower, upper), cells="blocks"))
    for number in (0, 1):
        model = realizer.realization(number)
        vertices, _ = model.surface(1)
        inner = (vertices[:, 0] > 2) & (vertices[:, 0] < 28) & (vertices[:, 1] > 2) & (vertices[:, 1] < 18)
        assert np.abs(distances(model.surface(0), vertices) - 2.0)[inner].max() < 1e-12
        assert np.abs(vertices[:, 2] - realizer.model.surface(1)[0][:, 2]).max() > 0.1


def test_drawn_thicknesses_are_perpendicular():
    """Over a plane of 60 degrees a thickness that is drawn counts twice upward."""
    low = Surface("low", np.column_stack([PLAN, STEEP * PLAN[:, 0]]), TRIANGLES)
    rng = np.random.default_rng(9)
    wells = PLAN[rng.permutation(len(PLAN))[:15]]
    points = np.column_stack([wells, STEEP * wells[:, 0] + 6.0 + rng.uniform(-1, 1, 15)])
    options = {"to": "low", "thickness_method": "kriging"}
    high = Surface("high", points=points, method="parallel", options=options, true_thickness=True)
    mass = Rock("r", [low, high], region=OUTLINE, edge_length=1.0, constraints=wells.tolist())
    realizer = Realizer(build(Project("p", [mass]), cells="blocks"))
    at = {tuple(place): z for *place, z in realizer.realization(3).surface(1)[0].tolist()}
    assert [at[tuple(well)] for well in wells.tolist()] == pytest.approx(points[:, 2].tolist())
    drawn = realizer.realization(3).surface(1)[0][:, 2]
    assert np.abs(drawn - realizer.model.surface(1)[0][:, 2]).max() > 0.05


def test_a_project_keeps_it(tmp_path, write):
    text = f"""format = 1
name = "p"
[[rock]]
name = "r"
region = {OUTLINE}
edge_length = 2
[[rock.surface]]
name = "low"
method = "plane"
dip = 60
dip_direction = 270
points = "low.csv"
[[rock.surface]]
name = "high"
method = "parallel"
to = "low"
thickness = 3
true_thickness = true
[[rock.surface]]
name = "top"
method = "constant"
value = -100
minimum_thickness = 1
true_thickness = true
"""
    write("low.csv", "x,y,z\n0,0,5\n")
    model = build(load_project(write("p.toml", text)))
    save_project(model.project, tmp_path / "again.toml")
    assert (tmp_path / "again.toml").read_text().count("true_thickness = true\n") == 2
    again = build(load_project(tmp_path / "again.toml"))
    for each in (model, again):
        low, high, top = (each.surface(number)[0][:, 2] for number in range(3))
        assert np.abs(high - low - 6).max() < 1e-9 and np.abs(top - high - 2).max() < 1e-9


@pytest.mark.parametrize(
    ("surface", "words"),
    [
        ({"method": "constant", "options": {"value": 1.0}}, "keeps no thickness above another one"),
        ({"vertices": np.column_stack([PLAN, PLAN[:, 0]]), "triangles": TRIANGLES}, "a mesh is not"),
        (
            {"method": "constant", "options": {"value": 1.0}, "minimum_thickness": 1, "true_thickness": 2},
            "true or",
        ),
    ],
)
def test_where_it_has_no_effect_it_is_refused(surface, words):
    low = Surface("low", method="constant", options={"value": 0.0})
    with pytest.raises(InputRefused, match=words) as raised:
        build(rock(low, Surface("high", **{"true_thickness": True, **surface})))
    assert "true_thickness" in str(raised.value)


def test_the_function_refuses_it_for_other_methods():
    with pytest.raises(InputRefused, match="'true_thickness' has no effect with method 'plane'"):
        interpolate([[0, 0, 1.0]], PLAN, "plane", true_thickness=True)


def test_tiles_leave_it_to_the_lead():
    low = Surface("low", points=np.array([[1.0, 1, 0], [9, 3, 1], [4, 15, 2]]), method="idw")
    for true, expected in ((False, {0, 1}), (True, set())):
        high = Surface(
            "high", method="parallel", options={"to": "low", "thickness": 1.0}, true_thickness=true
        )
        assert local_surfaces(read_rocks(Work(), rock(low, high))[0]) == expected


def test_the_same_for_any_number_of_threads():
    sheet = (np.column_stack([PLAN, np.sin(PLAN[:, 0]) * PLAN[:, 1]]), TRIANGLES)
    one, three = (
        interpolate(None, PLAN, "parallel", to=sheet, thickness=2.0, threads=n, true_thickness=True).z
        for n in (1, 3)
    )
    assert np.array_equal(one, three)
