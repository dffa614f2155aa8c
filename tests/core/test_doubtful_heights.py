# SPDX-License-Identifier: GPL-3.0-or-later
"""Warnings about surfaces that miss a point by much, or cut older layers beyond their points."""

import re

import numpy as np
import pytest
from realmodel.core import Boreholes, Fault, Project, Rock, Surface, build

SIZE = 1000.0
REGION = np.array([[0, 0], [SIZE, 0], [SIZE, SIZE], [0, SIZE]], float)


def wells(seed, count=40, low=(0.0, 0.0), high=(SIZE, SIZE)):
    return np.random.default_rng(seed).uniform(low, high, (count, 2))


def on(plan, z):
    return np.column_stack([plan, np.broadcast_to(z, len(plan))])


def of(points, name="S1", **options):
    method = options.pop("method", "kriging")
    rule, tie = options.pop("rule", "erosional"), options.pop("tie", True)
    return Surface(name=name, points=points, method=method, rule=rule, tie=tie, options=options)


def warnings(surfaces, kind, faults=(), **rock):
    rock = Rock(name="r", surfaces=surfaces, region=REGION, edge_length=50.0, **rock)
    model = build(Project(name="p", rocks=[rock], faults=list(faults)))
    return [warning for warning in model.warnings if warning.kind == kind]


SPHERICAL = {"model": "spherical", "range": 600.0, "sill": 400.0, "nugget": 0.0}
NUGGET = {**SPHERICAL, "sill": 1400.0, "nugget": 1000.0}


def layers_with_an_outlier(off, variogram, thickness=200.0, tie=False):
    plan = wells(1)
    z = 20 * np.sin(plan[:, 0] / 200)
    z[7] += off
    older, younger = (on(wells(seed), height) for seed, height in ((2, -thickness), (3, thickness)))
    middle = of(on(plan, z), variogram=variogram, tie=tie)
    return [of(older, "S0"), middle, of(younger, "S2")], on(plan, z)[7]


def test_a_point_that_a_nugget_lets_the_surface_miss_is_named():
    surfaces, point = layers_with_an_outlier(190.0, NUGGET)
    (found,) = warnings(surfaces, "residual")
    assert found.surface == "S1" and found.items == (7,)
    assert f"point 7 at ({point[0]:.9g}, {point[1]:.9g}, {point[2]:.9g})" in found.text
    assert "above it" in found.text and "the nugget (1,000;" in found.text


def test_a_tied_surface_passes_through_a_wrong_pick_and_warns_of_it():
    surfaces, _ = layers_with_an_outlier(190.0, NUGGET, tie=True)
    (found,) = warnings(surfaces, "residual")
    assert found.surface == "S1" and found.items == (7,)
    said = re.fullmatch(
        r"before it is tied it misses point 7 at \(303.194829, 453.497889, 209.969953\), which lies (.*) "
        "above it; the neighboring surfaces are 200 away: check the point, through which the surface makes a "
        "bump",
        found.text,
    )
    assert said and 150 < float(said[1]) < 170
    assert not warnings(layers_with_an_outlier(0.0, NUGGET, tie=True)[0], "residual")
    assert not warnings(layers_with_an_outlier(0.0, SPHERICAL, tie=True)[0], "residual")


def test_below_too():
    surfaces, _ = layers_with_an_outlier(-190.0, NUGGET)
    (found,) = warnings(surfaces, "residual")
    assert "below it" in found.text


def test_honored_points_and_small_misses_are_not_named():
    assert not warnings(layers_with_an_outlier(0.0, SPHERICAL)[0], "residual")
    assert not warnings(layers_with_an_outlier(0.0, NUGGET)[0], "residual")
    assert not warnings(layers_with_an_outlier(190.0, NUGGET, thickness=2000.0)[0], "residual")


def test_a_miss_larger_than_the_layers_is_no_matter_of_how_the_others_fit():
    plan = wells(1, 8)
    bent = of(on(plan, np.where(plan[:, 0] < 500, 0.0, 60.0)), method="plane", tie=False)
    surfaces = [of(bent.points - (0, 0, 5.0), "S0", method="plane", tie=False), bent]
    found = warnings(surfaces, "residual")
    assert len(found) == 2 and "surfaces are 5 away: check the point, the method, and" in found[0].text


def test_the_base_is_a_neighbor():
    surfaces, _ = layers_with_an_outlier(190.0, NUGGET)
    assert not warnings([surfaces[1]], "residual")
    (found,) = warnings([surfaces[1]], "residual", base_elevation=-200.0)
    assert found.items == (7,)


@pytest.mark.parametrize("tie", [False, True])
def test_the_borehole_and_the_depth_are_named(tmp_path, tie):
    surfaces, point = layers_with_an_outlier(190.0, NUGGET)
    points = surfaces[1].points
    (tmp_path / "collars.csv").write_text(
        "hole,x,y,z\n" + "".join(f"W-{n},{x!r},{y!r},1000\n" for n, (x, y, _) in enumerate(points.tolist()))
    )
    (tmp_path / "picks.csv").write_text(
        "hole,depth,surface\n"
        + "".join(f"W-{n},{1000 - z!r},S1\n" for n, z in enumerate(points[:, 2].tolist()))
    )
    surfaces[1] = Surface(name="S1", method="kriging", options={"variogram": NUGGET}, tie=tie)
    holes = Boreholes(collars=tmp_path / "collars.csv", picks=tmp_path / "picks.csv")
    (found,) = warnings(surfaces, "residual", boreholes=holes)
    assert f"of borehole 'W-7' at a depth of {1000 - point[2]:.6g} (picks.csv, line 9)," in found.text
    assert found.text.startswith("before it is tied it misses" if tie else "it misses")


def diving(rule="erosional", **options):
    """Level layers, and a top whose points in the west dip: it dives in the east, where it has none."""
    older = [of(on(wells(n), 50.0 * n), f"S{n}") for n in range(5)]
    west = wells(9, high=(500.0, SIZE))
    top = of(on(west, 400.0 - 0.3 * west[:, 0]), "top", method="plane", rule=rule, **options)
    return [*older, top]


def test_a_top_that_dives_beyond_its_points_is_warned_of():
    surfaces = diving()
    (found,) = warnings(surfaces, "extrapolation")
    assert found.surface == "top"
    for text in ("beyond its points, on ", "it cuts 'S3 block' and 'S4 block'", "deepest by 1", "(1000, "):
        assert text in found.text, (text, found.text)
    share = float(found.text.split("on ")[1].split(" %")[0])
    assert 30 < share < 36  # below 200 from x = 667 on


def test_what_it_cuts_between_its_points_as_well_is_no_news():
    surfaces = diving()
    surfaces[-1] = of(surfaces[-1].points - (0, 0, 250.0), "top", method="plane")
    assert not [w for w in warnings(surfaces, "extrapolation") if "'S4 block'" in w.text]


@pytest.mark.parametrize("rule", ["conformable", "base"])
def test_a_surface_that_does_not_cut_is_not_warned_of(rule):
    assert not warnings(diving(rule), "extrapolation")


def test_a_section_is_known_along_its_line():
    line = np.column_stack([np.linspace(0, SIZE, 21), np.full(21, 500.0)])
    surfaces = [
        of(on(line, 0.0), "S0", method="idw"),
        of(on(line, 100.0), "S1", method="idw"),
        of(on(line, 150.0 - 0.1 * line[:, 0]), "top", method="idw"),
    ]
    assert not warnings(surfaces, "extrapolation")


def test_where_the_surface_ends_at_its_points_nothing_is_extrapolated():
    surfaces = diving()
    surfaces[-1] = of(surfaces[-1].points, "top", method="tin", extrapolate="none")
    assert not warnings(surfaces, "extrapolation")
    surfaces[-1] = of(surfaces[-1].points, "top", method="tin", extrapolate="nearest")
    assert not warnings(surfaces, "extrapolation")


def test_beside_a_fault():
    """Each compartment is asked about its own part alone: the dive is east of the fault."""
    surfaces = diving()
    corners = np.array([[600, -50, -500], [600, 1050, -500], [600, 1050, 900], [600, -50, 900]], float)
    fault = Fault("F", corners, np.array([[0, 1, 2], [0, 2, 3]], np.int32), youngest="S4")
    found = warnings(surfaces, "extrapolation", [fault])
    assert found and all("in compartment" in warning.text for warning in found)
    assert all(float(w.text.split("on ")[1].split(" %")[0]) > 50 for w in found)
    surfaces[-1] = of(on(wells(9), 400.0), "top", method="plane")
    assert not warnings(surfaces, "extrapolation", [fault])


def test_picks_that_contradict_each_other_beside_a_fault_may_have_one_place():
    """They are left out, and do not keep the others from being asked about."""
    surfaces = diving()
    picks = [[450.0, 500.0, 265.0], [450.0, 500.0, 365.0]]
    surfaces[-1].points = np.concatenate([surfaces[-1].points, picks])
    corners = np.array([[200, -50, -500], [200, 1050, -500], [200, 1050, 900], [200, -50, 900]], float)
    fault = Fault("F", corners, np.array([[0, 1, 2], [0, 2, 3]], np.int32))
    (found,) = warnings(surfaces, "extrapolation", [fault])
    assert "it cuts 'S3 block' and 'S4 block'" in found.text
