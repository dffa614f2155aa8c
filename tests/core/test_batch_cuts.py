# SPDX-License-Identifier: GPL-3.0-or-later
"""build_model.py --section, --fence and --cut: files, and what is wrong said before anything is built."""

import csv
import re

import numpy as np
import pytest
from conftest import grid_surface
from realmodel.batch.cuts import read_polyline
from realmodel.batch.options import parse
from realmodel.core import InputRefused, load_project
from stacks.project_files import write_off
from test_batch import names, out, refused, run  # noqa: F401 - out is a fixture


def arrays(path):
    with np.load(path) as data:
        return {name: data[name] for name in data.files}


def test_sections_fences_and_halves_are_written(layers, out):  # noqa: F811
    project = layers([0, 1, 3])
    (out.parent / "line.csv").write_text("x,y\n-1,0.5\n0.5,0.5\n0.5,9 # beyond\n")
    done = run(
        project,
        *("--section", f"0.5,0.5,0,1,0,0={out / 's.csv'}"),
        *("--section", f"0,0,2,0,0,1={out / 'level.npz'}"),
        *("--fence", f"{out.parent / 'line.csv'}={out / 'f.csv'}"),
        *("--borehole", f"0.5,0.25={out / 'b.csv'}"),
        *("--cut", f"0,0,2,0,0,1={out / 'below.npz'},{out / 'above.npz'}"),
        *("--cut", f":1={out / 'inside.npz'},"),
        *("--cut", f"{project}:1=,{out / 'outside.npz'}"),
    )
    assert done.returncode == 0, done.stderr
    assert names(out) == [
        *("above.npz", "b.csv", "below.npz", "f.csv", "inside.npz", "level.npz", "outside.npz", "s.csv")
    ]
    last = done.stdout.splitlines()[-7:]
    assert last[0].startswith("section s.csv: ") and last[2].startswith("fence f.csv: ")
    assert last[3] == "borehole b.csv: 2 intervals, 3.00 of rock"
    assert last[4].startswith("cut by the plane: volume ")
    with (out / "b.csv").open() as file:
        found = [(row["block"], float(row["top"]), float(row["bottom"])) for row in csv.DictReader(file)]
    assert found == [("1", 3, 1), ("0", 1, 0)]
    whole = sum(arrays(out / f"{half}.npz")["block_volume"].sum() for half in ("below", "above"))
    assert arrays(out / "inside.npz")["block_volume"][0] == 0
    parts = sum(arrays(out / f"{half}.npz")["block_volume"].sum() for half in ("inside", "outside"))
    assert whole == pytest.approx(parts)
    assert (arrays(out / "level.npz")["block"] == 1).all()
    with (out / "f.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert {row["panel"] for row in rows} == {"0", "1"}
    assert {row["block_name"] for row in rows} == set(arrays(out / "below.npz")["block_names"])


def test_a_planned_hole_is_written(layers, out):  # noqa: F811
    """Toward the east at 45 degrees from above the layers, and straight up from beneath them."""
    project = layers([0, 1, 3])
    done = run(
        project,
        *("--borehole", f"0.1,0.5,3.2,90,45,1={out / 'inclined.csv'}"),
        *("--borehole", f"0.5,0.5,-1,0,-90,2.5={out / 'up.csv'}"),
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines()[-2] == "borehole inclined.csv: 1 interval, 0.72 of rock"
    with (out / "inclined.csv").open() as file:
        (row,) = list(csv.DictReader(file))
    assert row["block"] == "1"
    assert float(row["from"]) == pytest.approx(0.2 * np.sqrt(2)) and float(row["to"]) == pytest.approx(1)
    assert float(row["vertical_from"]) == pytest.approx(0.2)
    with (out / "up.csv").open() as file:
        rows = [(row["block"], float(row["from"]), float(row["to"])) for row in csv.DictReader(file)]
    assert [row[0] for row in rows] == ["0", "1"]
    assert np.array(rows)[:, 1:].astype(float) == pytest.approx(np.array([[1.0, 2.0], [2.0, 2.5]]))


def test_halves_are_cleaned_and_take_the_size_of_cells(layers, out):  # noqa: F811
    project, cut = layers([0, 1, 3]), "0,0,1.02,0.002,0,1"
    done = run(project, "--cut", f"{cut}={out / 'exact.vtu'},{out / 'a.npz'}")
    assert done.returncode == 0, done.stderr
    tolerance = ("--cell-tolerance", 0.1, "--cell-size", 0.5)
    done = run(project, "--cut", f"{cut}={out / 'clean.vtu'},{out / 'grid.csv'}", *tolerance)
    assert done.returncode == 0, done.stderr
    assert "clean.vtu: cells cleaned to 0.1: " in done.stdout and "grid.csv: cells" not in done.stdout
    exact, clean = (cells_of(out / f"{name}.vtu") for name in ("exact", "clean"))
    assert 0 < clean < exact
    with (out / "grid.csv").open() as file:
        assert {float(row["dx"]) for row in csv.DictReader(file)} == {0.5}


def cells_of(file):
    return int(re.search(rb'NumberOfCells="(\d+)"', file.read_bytes())[1])


def test_the_unit_of_a_cutter_counts_and_its_content_says_what_it_is(layers, out):  # noqa: F811
    corners = "".join(
        f"<P id='{k}'>{y} {x} 200</P>" for k, (x, y) in enumerate([(-1e3, -1e3), (9e3, -1e3), (-1e3, 9e3)])
    )
    surface = f"<Surface name='a'><Pnts>{corners}</Pnts><Faces><F>0 1 2</F></Faces></Surface>"
    units = "<Units><Metric linearUnit='centimeter'/></Units>"
    (out.parent / "plane.surface").write_text(f"<LandXML>{units}<Surfaces>{surface}</Surfaces></LandXML>")
    done = run(layers([0, 1, 3]), "--cut", f"{out.parent / 'plane.surface'}={out / 'b.npz'},{out / 'a.npz'}")
    assert done.returncode == 0, done.stderr
    assert "the header says cm for 'x and y' and 'z', converted to m" in done.stdout
    below = arrays(out / "b.npz")
    assert below["vertices"][:, 2].max() == pytest.approx(2.0)


def test_a_model_is_cut_by_a_surface_from_a_file(layers, out):  # noqa: F811
    vertices, triangles = grid_surface(2, lambda x, y: 2 + 0.5 * x, 20.0)
    write_off(out.parent / "fault.off", vertices - [5, 5, 0], triangles)
    done = run(layers([0, 1, 3]), "--cut", f"{out.parent / 'fault.off'}={out / 'b.vtu'},{out / 'a.vtu'}")
    assert done.returncode == 0, done.stderr
    assert names(out) == ["a.vtu", "b.vtu"]
    small, triangles = grid_surface(2, lambda x, y: 2 + 0 * x, 0.25)
    write_off(out.parent / "small.off", small, triangles)
    done = run(layers([0, 1, 3]), "--cut", f"{out.parent / 'small.off'}={out / 'c.npz'}")
    assert "small.off" in refused(done) and "ends inside of it near" in done.stderr
    assert names(out) == ["a.vtu", "b.vtu"]


def test_vtu_and_obj_know_block_and_property(layers, out, tmp_path):  # noqa: F811
    vtk = pytest.importorskip("vtk", reason="SKIPPED: VTK is not installed; it reads the .vtu back")
    from vtk.util.numpy_support import vtk_to_numpy

    plane = "0.5,0.5,0,1,0.2,0"
    kinds = ("vtu", "obj", "npz")
    done = run(layers([0, 1, 3]), *(a for k in kinds for a in ("--section", f"{plane}={out}/s.{k}")))
    assert done.returncode == 0, done.stderr
    section = arrays(out / "s.npz")
    reader = vtk.vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(out / "s.vtu"))
    reader.Update()
    grid = reader.GetOutput()
    assert grid.GetNumberOfCells() == len(section["block"])
    for name in ("block", "property", "cells"):
        assert (vtk_to_numpy(grid.GetCellData().GetArray(name)) == section[name]).all()
    corners = [
        [grid.GetCell(k).GetPointId(i) for i in range(grid.GetCell(k).GetNumberOfPoints())]
        for k in range(grid.GetNumberOfCells())
    ]
    assert np.concatenate(corners).tolist() == section["polygon_vertices"].tolist()
    lines = (out / "s.obj").read_text().splitlines()
    assert sum(line.startswith("v ") for line in lines) == len(section["vertices"])
    triangles = len(section["polygon_vertices"]) - 2 * len(section["block"])
    assert sum(line.startswith("f ") for line in lines) == triangles
    groups = [line for line in lines if line.startswith("g ")]
    assert len(groups) == len(set(section["block"].tolist()))
    assert groups[0] == f"g block_0_{str(section['block_names'][0]).replace(' ', '_')}"


@pytest.mark.parametrize(
    "arguments, words",
    [
        (("--section", "1,2,3=s.vtu"), "a plane is six numbers"),
        (("--section", "0,0,0,0,0,0=s.vtu"), "the normal must not be zero"),
        (("--section", "0,0,0,1,0,0"), "expected --section X,Y,Z,NX,NY,NZ=FILE"),
        (("--section", "0,0,0,1,0,nan=s.vtu"), "a plane is six numbers"),
        (("--section", "0,0,0,1,0,0=s.step"), "use one of .vtu, .obj, .ply, .stl, .glb, .ts, .csv, .npz"),
        (("--fence", "0,0,1=f.vtu"), "at least two points"),
        (("--borehole", "0,0,1=b.csv"), "two numbers, X,Y, and a planned hole six"),
        (("--borehole", "0,0,1,0,91,5=b.csv"), "the dip must lie between -90 and 90 degrees"),
        (("--borehole", "0,0,1,0,45,0=b.csv"), "the length must be above 0"),
        (("--borehole", "0,0=b.vtu"), "boreholes are not written as '.vtu'"),
        (("--fence", "0,0,0,0,1,1=f.vtu"), "two consecutive points are equal"),
        (("--cut", "0,0,0,1,0,0=,"), "one of them may be left out"),
        (("--cut", "0,0,0,1,0,0=a.npz,b.npz,c.npz"), "expected "),
        (("--cut", "0,0,0,1,0,0=a.xyz"), "use one of .npz, .vtu"),
        (("--cut", "fault.unknown=a.npz"), "is not a cutter"),
        (("--cut", "other.toml:=a.npz"), "the block is missing"),
        (("--cut", ":chalk=a.npz"), "no block named 'chalk'"),
        (("--cut", ":1=a.npz", "--export", "a.npz"), "two outputs have this name"),
        (("--cut", ":1=a.npz", "--estimate"), "goes without"),
    ],
)
def test_wrong_usage(layers, out, arguments, words):  # noqa: F811
    done = run(layers([0, 1, 3]), *arguments, cwd=out)
    assert done.returncode == 2, done.stderr
    assert words in done.stderr.splitlines()[-1]
    assert names(out) == []


def test_what_is_read_is_not_overwritten(layers, out):  # noqa: F811
    line = out.parent / "line.csv"
    line.write_text("0 0\n1 1\n")
    done = run(layers([0, 1]), "--fence", f"{line}={line}")
    assert "choose another name" in refused(done, 2)
    assert line.read_text() == "0 0\n1 1\n"


@pytest.mark.parametrize(
    "text, words",
    [
        ("x,y\n1,2\n", "at least two points"),
        ("1,2\n3\n", ":2: each line must have two numbers"),
        ("1,2\n3,four\n", ":2: each line must have two numbers"),
        ("1,2\n1,2\n3,4\n", "two consecutive points are equal"),
        ("", "at least two points"),
    ],
)
def test_a_file_that_is_no_polyline(tmp_path, text, words):
    (tmp_path / "line.csv").write_text(text)
    with pytest.raises(InputRefused, match=words):
        read_polyline(tmp_path / "line.csv")


def test_a_missing_cutter_is_refused_before_the_build(layers, out):  # noqa: F811
    project = layers([0, 1])
    assert "gone.off" in refused(run(project, "--cut", f"gone.off={out / 'a.npz'}"))
    assert "gone.csv" in refused(run(project, "--fence", f"gone.csv={out / 'a.csv'}"))
    assert load_project(project).rocks and names(out) == []


@pytest.mark.parametrize(
    ("given", "name"),
    [(("--section", "-5,0.5,0,1,0,0=s.svg"), "section"), (("--borehole", "-.5,0=b.csv"), "borehole")],
)
def test_values_may_begin_with_a_negative_number(given, name):
    """argparse alone takes them for options."""
    option, value = given
    for arguments in (given, (f"{option}={value}",)):
        assert getattr(parse(["p.toml", *arguments]), name) == [value]
    assert getattr(parse([option, value, "p.toml"]), name) == [value]
