# SPDX-License-Identifier: GPL-3.0-or-later
"""build_model.py --mesh: the file, the report, and what is wrong usage."""

import json
import subprocess
import sys
from pathlib import Path

import pytest
from realmodel.core.readers import read_mesh

ROOT = Path(__file__).parents[2]
PROJECT = ROOT / "blend_samples" / "two_layers" / "project.toml"


def run(*arguments):
    return subprocess.run(
        [sys.executable, ROOT / "build_model.py", PROJECT, *map(str, arguments)],
        capture_output=True,
        text=True,
        check=False,
    )


def test_a_mesh_and_its_report(tmp_path):
    mesh, report = tmp_path / "mesh.msh", tmp_path / "report.json"
    options = ("--mesh-edge", 4, "--mesh-thickness", 0.7, "--mesh-layer-thickness", 2)
    done = run("--mesh", mesh, *options, "--report", report)
    assert done.returncode == 0, done.stderr
    assert "prisms; volumes differ" in done.stdout
    assert mesh.stat().st_size > 10_000
    entry = json.loads(report.read_text())["mesh"]
    assert set(entry["elements"]) == {"tetrahedron", "pyramid", "prism"}
    for block in entry["blocks"]:
        assert block["volume"] == pytest.approx(block["exact_volume"], rel=0.01)


def test_two_files_of_one_mesh(tmp_path):
    one, two = tmp_path / "mesh.msh", tmp_path / "mesh.vtu"
    done = run("--mesh", one, "--mesh", two, "--mesh-edge", 8)
    assert done.returncode == 0, done.stderr
    assert f"{one}: " in done.stdout and f"{two}: " in done.stdout
    assert one.is_file() and two.is_file()
    done = run("--mesh", one, "--mesh", one)
    assert done.returncode == 2
    assert "two outputs have this name" in done.stderr


def test_shapes_that_count_from_an_origin(tmp_path):
    plain, near = tmp_path / "a.ply", tmp_path / "b.ply"
    for path, more in ((plain, []), (near, ["--origin", "-1e3,2000,0.5"])):
        done = run("--export", path, *more)
        assert done.returncode == 0, done.stderr
    assert f"{near}: coordinates are relative to -1000.0, 2000.0, 0.5" in done.stdout
    one, two = (read_mesh(path).vertices for path in (plain, near))
    assert two == pytest.approx(one - (-1000, 2000, 0.5), abs=1e-9)
    done = run("--export", tmp_path / "m.vtu", "--origin", "0,0,0")
    assert done.returncode == 2
    assert "--origin goes with --export of blocks to .obj" in done.stderr


def test_defaults_and_tetrahedra(tmp_path):
    done = run("--mesh", tmp_path / "mesh.foam", "--mesh-elements", "tetrahedra", "--mesh-layers", 2)
    assert done.returncode == 0, done.stderr
    assert "tetrahedra; volumes" in done.stdout
    assert "prisms" not in done.stdout
    assert (tmp_path / "mesh.foam" / "constant" / "polyMesh" / "owner").is_file()


def test_cleaned_cells_and_their_report(tmp_path):
    report = tmp_path / "report.json"
    done = run("--export", tmp_path / "m.foam", "--cell-tolerance", 0.5, "--report", report)
    assert done.returncode == 0, done.stderr
    assert "cells cleaned to 0.5: " in done.stdout
    assert " cells removed" in done.stdout
    assert (tmp_path / "m.foam" / "constant" / "polyMesh" / "owner").is_file()
    entry = json.loads(report.read_text())["cleaned_cells"]
    assert entry["tolerance"] == 0.5
    assert entry["removed"]["edges"] > entry["removed"]["cells"] > 0
    assert entry["largest_move"] <= 0.5
    for block in entry["blocks"]:
        assert block["volume"] == pytest.approx(block["exact_volume"], rel=0.01)
        assert block["volume"] != block["exact_volume"]


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (("--mesh", "m.xyz"), "meshes are not written as '.xyz'"),
        (("--mesh-edge", 4), "--mesh-edge goes with --mesh"),
        (("--mesh", "m.vtu", "--mesh-edge", -1), "not a length above 0"),
        (("--cell-tolerance", 1), "--cell-tolerance goes with --export or --cut to a file with cells"),
        (("--cell-tolerance", 1, "--export", "m.obj"), "--cell-tolerance goes with --export or --cut to a"),
        (("--cell-tolerance", 0, "--export", "m.vtu"), "'0' is not a length above 0"),
        (("--mesh", "m.vtu", "--estimate"), "--estimate goes without --mesh"),
        (("--mesh", "m.vtu", "--surfaces-only"), "--surfaces-only goes without --mesh"),
        (("--mesh", "m.vtu", "--export", "m.vtu"), "two outputs have this name"),
        (("--mesh", "m.vtu", "--mesh-layers", 0), "layers must be whole numbers from 1"),
    ],
)
def test_wrong_usage(tmp_path, monkeypatch, options, message):
    monkeypatch.chdir(tmp_path)
    done = run(*options)
    assert done.returncode == 2
    assert message in done.stderr
    assert not any(tmp_path.iterdir())
