# SPDX-License-Identifier: GPL-3.0-or-later
"""Surfaces without the model: their heights, what is known of their vertices, and their files."""

import json
import subprocess
import sys

import numpy as np
import pytest
from conftest import ROOT, grid_surface
from realmodel.batch.table import surface_table
from realmodel.core import Body, Fault, Project, Rock, Surface, UsageError, build, build_surfaces, interpolate
from structure_cases import plane_fault
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader

RNG = np.random.default_rng(17)
SQUARE = np.array([[0.0, 0.0], [100.0, 0.0], [100.0, 80.0], [0.0, 80.0]])
UTM = np.array([431250.25, 5398781.5])


def points(height, count=60, width=100.0):
    plan = RNG.random((count, 2)) * [width, 80.0]
    return np.column_stack([plan + UTM, height + 3 * np.sin(plan[:, 0] / 20)])


def project():
    ready = np.column_stack([SQUARE + UTM, np.full(4, 30.0)])
    rock = Rock(
        "hill",
        [
            Surface("base", points=points(0.0), method="kriging"),
            Surface("part", points=points(10.0, width=50.0), options={"extrapolate": "none"}),
            Surface("quick", points=points(20.0), method="idw"),
            Surface("ready", vertices=ready, triangles=np.array([[0, 1, 2], [0, 2, 3]])),
        ],
        region=SQUARE + UTM,
        edge_length=6.0,
    )
    return Project("four", [rock])


def test_vertices_know_their_variance_and_distance():
    given = project()
    for surface in given.rocks[0].surfaces[:3]:
        surface.tie = False
    surfaces = build_surfaces(given)
    assert surfaces.surface_names == ["base", "part", "quick", "ready"]
    for number in (0, 1, 2):
        vertices, _ = surfaces.surface(number)
        attributes = surfaces.surface_attributes(number)
        surface = given.rocks[0].surfaces[number]
        method, options = surface.method_options()
        again = interpolate(surface.points, vertices[:, :2], method, **options)
        assert np.array_equal(attributes["height"], vertices[:, 2])
        assert np.array_equal(attributes["height"], again.z)
        if again.variance is None:
            assert np.isnan(attributes["variance"]).all()
        else:
            assert np.array_equal(attributes["variance"], again.variance)
        apart = np.linalg.norm(vertices[:, None, :2] - surface.points[None, :, :2], axis=2).min(axis=1)
        assert attributes["distance"] == pytest.approx(apart, abs=1e-9)
    assert len(surfaces.surface(1)[0]) < len(surfaces.surface(0)[0])
    attributes = surfaces.surface_attributes(3)
    assert np.isnan(attributes["variance"]).all()
    assert np.isnan(attributes["distance"]).all()


def test_the_model_has_the_same():
    given = project()
    model, surfaces = build(given), build_surfaces(given)
    for number in range(4):
        for one, other in zip(model.surface(number), surfaces.surface(number), strict=True):
            assert np.array_equal(one, other)
        for name, values in surfaces.surface_attributes(number).items():
            assert np.array_equal(model.surface_attributes(number)[name], values, equal_nan=True)
    stage = model.stage(1)
    assert np.array_equal(
        stage.surface_attributes(1)["variance"], model.surface_attributes(1)["variance"], equal_nan=True
    )


def test_files(tmp_path):
    surfaces = build_surfaces(project())
    surfaces.save(tmp_path / "s.npz")
    read = np.load(tmp_path / "s.npz")
    assert list(read["surface_names"]) == surfaces.surface_names
    begin, end = read["surface_vertex_offsets"][1:3]
    assert np.array_equal(read["surface_vertices"][begin:end], surfaces.surface(1)[0])
    assert np.array_equal(read["surface_distance"][begin:end], surfaces.surface_attributes(1)["distance"])

    surfaces.save(tmp_path / "s.vtu")
    reader = vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(tmp_path / "s.vtu"))
    reader.Update()
    grid = reader.GetOutput()
    assert np.array_equal(vtk_to_numpy(grid.GetPoints().GetData()), read["surface_vertices"])
    for name in ("height", "variance", "distance"):
        values = vtk_to_numpy(grid.GetPointData().GetArray(name))
        assert np.array_equal(values, read[f"surface_{name}"], equal_nan=True)
    number = vtk_to_numpy(grid.GetCellData().GetArray("surface"))
    assert np.array_equal(np.bincount(number), np.diff(read["surface_triangle_offsets"]))
    corners = vtk_to_numpy(grid.GetCells().GetConnectivityArray()).reshape(-1, 3)
    last = surfaces.surface(3)[1] + read["surface_vertex_offsets"][3]
    assert np.array_equal(corners[-2:], last)

    with pytest.raises(UsageError, match="npz"):
        surfaces.save(tmp_path / "s.foam")
    with pytest.raises(UsageError):
        build_surfaces(project(), stage=9)


TOML = """
format = 1
name = "two"
[[rock]]
name = "hill"
region = [[0, 0], [100, 0], [100, 80], [0, 80]]
edge_length = 10
[[rock.surface]]
name = "low"
points = "low.csv"
[[rock.surface]]
name = "high"
points = "low.csv"
method = "parallel"
to = "low"
thickness = 3
"""


def command(*arguments):
    return subprocess.run(
        [sys.executable, ROOT / "build_model.py", *map(str, arguments)],
        capture_output=True,
        text=True,
        check=False,
        timeout=300,
    )


def test_from_the_command_line(tmp_path, write):
    path = write("p.toml", TOML)
    rows = "\n".join(",".join(f"{v:.3f}" for v in p) for p in points(0.0) - [*UTM, 0.0])
    write("low.csv", f"x,y,z\n{rows}\n")
    npz, vtu, report = (tmp_path / name for name in ("s.npz", "s.vtu", "r.json"))
    run = command(path, "--surfaces-only", "--export", npz, "--export", vtu, "--report", report)
    assert run.returncode == 0, run.stderr
    assert "max deviation" in run.stdout
    assert "universal_kriging" in run.stdout
    assert list(np.load(npz)["surface_names"]) == ["low", "high"]
    content = json.loads(report.read_text())
    assert [entry["method"] for entry in content["surfaces"]] == ["universal_kriging", "parallel"]
    assert content["surfaces"][0]["neighbours"] == 32
    assert vtu.stat().st_size > 0
    one = command(path, "--surfaces-only", "--stage", 0, "--export", npz)
    assert one.returncode == 0, one.stderr
    assert list(np.load(npz)["surface_names"]) == ["low"]
    for wrong in (("--eroded",), ("--check-model",), ("--estimate",), ("--memory", 4)):
        refused = command(path, "--surfaces-only", *wrong)
        assert refused.returncode == 2
        assert "goes without" in refused.stderr and "--surfaces-only" in refused.stderr.splitlines()[-1]
    assert command(path, "--surfaces-only", "--export", tmp_path / "s.foam").returncode == 2


def test_the_sheets_of_a_surface_that_a_fault_displaces(tmp_path):
    levels = [Surface(f"S{k}", *grid_surface(3, lambda x, y, k=k: 2.0 * k + 0 * x)) for k in range(2)]
    fault = Fault("F", *plane_fault(x=0.5), youngest="S0")
    project = Project("p", [Rock("r", levels)], faults=[fault])
    surfaces, model = build_surfaces(project), build(project)
    sheet = surfaces.surface_triangle_sheet
    first = surfaces.surface(0)[1]
    assert set(sheet[: len(first)].tolist()) == {0, 1} and not sheet[len(first) :].any()
    assert np.array_equal(model.surface_triangle_sheet[: len(sheet)], sheet)
    assert not model.surface_triangle_sheet[len(sheet) :].any()
    for number in range(3):
        begin, end = model.surface_triangle_offsets[number : number + 2]
        own = model.surface_triangle_sheet[begin:end]
        of_sheets = model.sheet_triangles(number)
        assert len(of_sheets) == own.max() + 1
        for k, triangles in enumerate(of_sheets):
            assert np.array_equal(triangles, model.surface(number)[1][own == k])
    surfaces.save(tmp_path / "s.npz")
    with np.load(tmp_path / "s.npz") as read:
        assert np.array_equal(read["surface_triangle_sheet"], sheet)


def test_surfaces_of_faults_and_bodies_come_after_those_of_the_rock_masses(tmp_path):
    corners = np.array([[50.0, 40.0, 5.0], [60.0, 40.0, 5.0], [50.0, 50.0, 5.0], [50.0, 40.0, 15.0]])
    faces = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
    sticks = [np.array([[30.0, y, z] for z in (-50.0, 20.0, 90.0)]) for y in (-20.0, 40.0, 100.0)]
    level = Surface("level", points=np.array([[10.0, 10.0, 30.0], [90.0, 60.0, 30.0]]), method="constant")
    given = Project(
        "structures",
        [Rock("hill", [level], region=SQUARE, edge_length=20.0)],
        faults=[Fault("sticks", points=sticks)],
        bodies=[Body("ore", corners, faces)],
    )
    surfaces = build_surfaces(given)
    assert surfaces.surface_names == ["level", "sticks", "ore"]
    assert surfaces.surface_kind.tolist() == [0, 1, 2]
    vertices, triangles = surfaces.surface(1)
    assert np.ptp(vertices[:, 0]) < 1e-9
    assert len(triangles)
    assert np.array_equal(surfaces.surface(2)[0], corners)
    assert len(surfaces.surface_triangle_sheet) == sum(len(surfaces.surface(k)[1]) for k in range(3))
    for name in ("s.npz", "s.vtu", "s.ply"):
        surfaces.save(tmp_path / name)
    arrays = np.load(tmp_path / "s.npz")
    assert arrays["surface_kind"].tolist() == [0, 1, 2]
    assert arrays["surface_names"].tolist() == ["level", "sticks", "ore"]
    assert b"ore" in (tmp_path / "s.ply").read_bytes()
    lines = surface_table(surfaces).splitlines()
    assert [line.split()[:2] for line in lines[2:]] == [
        ["sticks", "fault"],
        ["ore", "body"],
        ["level", "hill"],
    ]
