# SPDX-License-Identifier: GPL-3.0-or-later
"""Throw and heave along faults, compared with surfaces in closed form."""

from dataclasses import replace

import numpy as np
import pytest
from displaced_surfaces import (
    Displacing,
    basin,
    built,
    dome,
    expected,
    folded,
    leaning,
    level,
    mesh_of,
    points_of,
    tilted,
)
from realmodel.core import Fault, Project, Rock, Surface, build
from realmodel.core.base.work import run
from realmodel.core.exporters.report import model_report
from realmodel.core.results.displacements import displacements
from realmodel.core.structures.sheets.tips import Lip, beyond_lips
from realmodel.core.surfaces.rock_structure import FaultShape
from structure_cases import SQUARE, plane_fault


def wavy(y, z):
    return 5.0 - 0.5 * z + 0.4 * np.sin(y)


def listric(y, z):
    return 4.5 - 1.2 * z + 0.15 * z * z


def assert_right(model, shape, faults, tolerance=0.05, length=10.0):
    """Throw and heave are those of the closed form at places all along the faults."""
    found = {each.fault: each for each in displacements(model)}
    assert set(found) == {fault.name for fault in faults}
    for number, fault in enumerate(faults):
        own = found[fault.name]
        throw, heave = expected(shape, faults, number, own.places)
        assert np.abs(own.throw - throw).max() < tolerance * np.abs(throw).max()
        assert np.abs(own.heave - heave).max() < tolerance * max(1.0, np.abs(throw).max())
        assert own.length.sum() > 0.98 * length
        y = np.sort(own.places[:, 1])
        assert np.diff([0.0, *y, length]).max() < 1.0


@pytest.mark.parametrize("shape", [level, tilted, dome, basin, folded])
@pytest.mark.parametrize("at", [leaning(), leaning(lean=-0.5), leaning(lean=0.0), leaning(lean=2.0), listric])
def test_ready_meshes_with_lips_on_the_fault(at, shape):
    faults = [
        Displacing("F", at, drop=0.5 if at(0, -1) > 6.5 else 1.0, lines=(2, 41 if at is listric else 2))
    ]
    assert_right(built(faults, Surface("top", *mesh_of(shape, faults, count=(41, 12)))), shape, faults)


@pytest.mark.parametrize("shape", [level, dome])
@pytest.mark.parametrize("shift", [1e-9, -1e-9, 0.02, -0.02])
def test_ready_meshes_with_lips_beside_the_fault(shift, shape):
    faults = [Displacing("F", leaning())]
    assert_right(built(faults, Surface("top", *mesh_of(shape, faults, shift))), shape, faults)


@pytest.mark.parametrize("shape", [level, tilted, dome, folded])
def test_ready_meshes_at_a_fault_whose_triangles_miss_the_lips(shape):
    faults = [Displacing("F", wavy, lines=(61, 2))]
    assert_right(built(faults, Surface("top", *mesh_of(shape, faults))), shape, faults)


def test_a_ready_mesh_with_a_hole_at_the_fault():
    faults = [Displacing("F", leaning())]
    vertices, triangles = mesh_of(dome, faults)
    x, y, _ = vertices[triangles].mean(axis=1).T
    model = built(faults, Surface("top", vertices, triangles[~((x > 3) & (x < 6) & (abs(y - 5) < 1.2))]))
    (found,) = displacements(model)
    assert np.abs(found.throw - expected(dome, faults, 0, found.places)[0]).max() < 0.05


@pytest.mark.parametrize("shape", [level, dome, basin])
@pytest.mark.parametrize("extrapolate", ["method", "nearest"])
@pytest.mark.parametrize("method", ["natural_neighbour", "tin"])
def test_bays_of_lips_among_points(method, extrapolate, shape):
    faults = [Displacing("F", leaning())]
    options = {"extrapolate": extrapolate}
    surface = Surface("top", points=points_of(shape, faults), method=method, options=options)
    assert_right(built(faults, surface), shape, faults)


@pytest.mark.parametrize("method", ["kriging", "natural_neighbour", "dsi"])
def test_three_faults_and_compartments_without_points(method):
    faults = [
        Displacing("F1", lambda y, z: 7.0 + z / 2, -1.0),
        Displacing("F2", leaning(2.0), 0.5),
        Displacing("F3", leaning(4.0), 0.5),
    ]
    points = [(x, y, z) for x, z in ((1, 0), (3, -0.5), (5.5, -1.0), (8.5, 0)) for y in (2.0, 8.0)]
    model = built(faults, Surface("top", points=points, method=method))
    assert_right(model, level, faults)
    assert {each.fault: pytest.approx(each.mean_throw) for each in displacements(model)} == {
        "F1": 1.0,
        "F2": 0.5,
        "F3": 0.5,
    }


@pytest.mark.parametrize("shape", [level, tilted, dome])
@pytest.mark.parametrize(
    "faults",
    [
        [Displacing("F", leaning()), Displacing("G", leaning(lean=0.3, turn=0.8), 0.6)],  # they cross in plan
        [Displacing("F", leaning(4.0)), Displacing("G", leaning(6.0, lean=-0.5), 0.6)],
        [Displacing("F", leaning(4.6)), Displacing("G", leaning(5.4, lean=0.2), -1.0)],  # narrower than edges
    ],
)
def test_two_faults(faults, shape):
    surface = Surface("top", points=points_of(shape, faults, lips=0.5), method="dsi")
    assert_right(built(faults, surface), shape, faults)


def test_a_surface_that_meets_a_low_fault_several_times():
    """What lies on the same side of its cutoff line is not taken for the other side of the fault."""

    def waves(x, y):
        return np.sin(1.5 * x) + 0.0 * y

    fault = Displacing("F", leaning(lean=3.0), 0.3)
    points = points_of(waves, [fault], lips=None, steps=(0.15, 1.0), gap=0.25)
    (found,) = displacements(built([fault], Surface("top", points=points, method="kriging"), 0.25))
    lines = {4.34: 4.51, 6.68: 6.39, 7.65: 7.89}  # where the sheets meet the fault, below and above it
    for below, above in lines.items():
        near = np.abs(found.places[:, 0] - below) < 0.2
        assert found.length[near].sum() == pytest.approx(10.0, abs=0.1)
        assert found.throw[near] == pytest.approx((above - below) / 3, abs=0.015)
    assert len(found.throw) == sum((np.abs(found.places[:, 0] - below) < 0.2).sum() for below in lines)


@pytest.mark.parametrize("method", ["natural_neighbour", "dsi"])
@pytest.mark.parametrize("lean", [0.5, 0.0, -0.5])
def test_a_fault_that_dies_out(lean, method):
    faults = [Displacing("F", leaning(lean=lean), lambda y: np.clip((7 - y) / 5, 0, 1) ** 1.5, tip=7.0)]
    points = points_of(dome, faults, lips=0.25)
    model = built(faults, Surface("top", points=points, method=method), edge_length=0.5)
    assert_right(model, dome, faults, tolerance=0.07, length=6.9)
    (found,) = displacements(model)
    last = found.places[:, 1].argmax()
    assert found.places[last, 1] > 6.4 and abs(found.throw[last]) < 0.05


def test_a_branch_displaces_where_the_other_fault_has_two_blocks():
    """The main fault has another throw on each side of the branch, and is measured beside it on both."""
    main = Fault("F", *plane_fault(lean=0.5, z=(-9.0, 9.0)))
    corners = np.array([[-5, 8.6, -9], [10.5, 8.6, -9], [5.5, 1.4, 9], [-5, 1.4, 9]])
    branch = Fault("B", corners, np.array([[0, 1, 2], [0, 2, 3]], np.int32), ends_at=("F",))
    points = []
    for x, y in np.argwhere(np.ones((21, 21))) / 2.0:
        for z, inside in (
            (0.0, x < 5 and y < 5),
            (-0.6, x < 5.3 and y > 5.24),
            (-1.0, x > 5.5),
        ):
            points += [(x, y, z)] if inside else []
    surface = Surface("top", points=np.array(points), method="natural_neighbour")
    rock = Rock("r", [surface], region=SQUARE, edge_length=0.8, base_elevation=-8.0)
    found = {each.fault: each for each in displacements(build(Project("p", [rock], faults=[main, branch])))}
    throw = np.where(found["F"].places[:, 1] < 5.1, 1.0, 0.4)
    assert found["F"].throw == pytest.approx(throw, abs=0.01)
    assert found["F"].length.sum() == pytest.approx(9.76, abs=0.02)
    assert found["B"].throw == pytest.approx(0.6, abs=0.01)
    assert found["B"].length.sum() == pytest.approx(5.0, abs=0.02)


def test_a_fault_that_a_surface_does_not_meet():
    """One that ends below it, and one that dies out beside it."""
    deep = Fault("deep", *plane_fault(lean=0.5, z=(-9.0, -4.0)))
    beside = Fault("beside", *plane_fault(x=14.0, z=(-9.0, 9.0)))
    surfaces = [
        Surface(name, points=[(1, 1, z), (9, 1, z), (5, 9, z)]) for name, z in (("S0", -2.0), ("S1", 0.0))
    ]
    rock = Rock("r", surfaces, region=SQUARE, edge_length=1.0, base_elevation=-8.0)
    faults = [replace(deep, dies_out=True), replace(beside, dies_out=True)]
    assert displacements(build(Project("p", [rock], faults=faults))) == []


def test_means_in_the_report_are_those_along_the_line():
    faults = [Displacing("F", leaning(), drop=lambda y: 0.1 * y)]
    vertices, triangles = mesh_of(level, faults, count=(11, 12))
    middles = vertices[triangles].mean(axis=1)
    finer = mesh_of(level, faults, count=(81, 12))
    near = finer[0][finer[1]].mean(axis=1)[:, 1] < 3  # eight times as many places where the throw is small
    far = middles[:, 1] > 3
    vertices = np.concatenate([vertices, finer[0]])
    triangles = np.concatenate([triangles[far], finer[1][near] + len(vertices) - len(finer[0])])
    model = built(faults, Surface("top", vertices, triangles))
    (found,) = displacements(model)
    assert found.throw.mean() < 0.4
    (entry,) = model_report(model)["faults"][0]["surfaces"]
    assert entry["throw"]["mean"] == pytest.approx(0.5, abs=0.01)
    assert entry["heave"]["mean"] == pytest.approx(0.25, abs=0.01)
    assert entry["length"] == pytest.approx(np.hypot(10, 0.0), abs=0.05)


def test_lips_are_not_continued_to_where_another_point_is():
    """On a lattice one edge beyond a lip is the next point."""
    points = np.array([(x, y, 0.0) for x in range(5) for y in range(5)], float)
    points[points[:, 0] < 2, 2] = 0.5
    fault = FaultShape(*plane_fault(x=2.0))
    lip = Lip(fault, -1, points[:, 0] == 2)
    settings = {"extrapolate": "nearest"}
    found = run(lambda work: beyond_lips(work, points, [lip], 0.25, "natural_neighbour", settings))
    assert len(found) == 0
    found = run(lambda work: beyond_lips(work, points, [lip], 0.2, "natural_neighbour", settings))
    assert sorted(map(tuple, found.tolist())) == [(pytest.approx(2.8), float(y), 0.0) for y in range(5)]
