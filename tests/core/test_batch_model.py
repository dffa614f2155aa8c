# SPDX-License-Identifier: GPL-3.0-or-later
"""build_model.py on a model's file: what it writes is what it writes from the project."""

import json

import pytest
from conftest import ROOT
from test_batch import refused, run

PROJECT = ROOT / "blend_samples" / "two_layers" / "project.toml"
MADE = (
    *("--section", "50,30,0,1,0,0=s.svg", "--fence", "10,10,50,30,90,20=f.csv", "--borehole", "50,30=h.csv"),
    *("--cut", "50,30,0,1,0.2,0=west.npz,east.vtu", "--cut", ":Sand=sand.stl,", "--export", "m.npz"),
    *("--export", "m.obj", "--export", "m.gpkg", "--mesh", "mesh.vtu", "--mesh-edge", "8"),
    *("--report", "r.json", "--eroded", "--check-model"),
)
_OF_THE_RUN = ("timings", "peak_memory", "validation")


@pytest.fixture(scope="module")
def model_file(tmp_path_factory):
    file = tmp_path_factory.mktemp("model") / "built.npz"
    assert run(PROJECT, "--export", file, "--quiet").returncode == 0
    return file


def made(source, folder):
    """{name: bytes} of all that is made of a source, and the printed lines but those of seconds."""
    folder.mkdir()
    done = run(source, *MADE, cwd=folder)
    assert done.returncode == 0, done.stderr
    files = {file.name: file.read_bytes() for file in folder.iterdir()}
    report = json.loads(files.pop("r.json"))
    assert report["validation"]["passed"]
    for key in _OF_THE_RUN:
        del report[key]
    for key in ("file", "library"):
        report["project"][key] = report["project"][key].rpartition("/")[2]
    return files, report, [line for line in done.stdout.splitlines() if " %" not in line and " s" not in line]


def test_all_outputs_of_a_model_are_those_of_its_project(model_file, tmp_path):
    built, loaded = made(PROJECT, tmp_path / "built"), made(model_file, tmp_path / "loaded")
    assert len(built[0]) == 11 and built[2]
    assert built == loaded


def test_a_stage_of_a_model(model_file, tmp_path):
    for source, name in ((PROJECT, "a.npz"), (model_file, "b.npz")):
        assert run(source, "--stage", 0, "--export", tmp_path / name, "--quiet").returncode == 0
    assert (tmp_path / "a.npz").read_bytes() == (tmp_path / "b.npz").read_bytes()


def test_a_block_of_another_model_cuts(tmp_path):
    """Of a project the blocks are built as one cell each."""
    blocks = tmp_path / "blocks.npz"
    assert run(PROJECT, "--cells", "blocks", "--export", blocks, "--quiet").returncode == 0
    for other, name in ((PROJECT, "a.vtu"), (blocks, "b.vtu")):
        done = run(PROJECT, "--cut", f"{other}:Clay={tmp_path / name},", "--quiet")
        assert done.returncode == 0, done.stderr
    assert (tmp_path / "a.vtu").read_bytes() == (tmp_path / "b.vtu").read_bytes()


@pytest.mark.parametrize(
    "option", [("--cells", "blocks"), ("--memory", "1"), ("--estimate",), ("--surfaces-only",)]
)
def test_what_builds_goes_with_a_project(model_file, option):
    done = run(model_file, *option)
    assert done.returncode == 2
    assert f"{option[0]} goes with a project file" in done.stderr


def test_the_model_is_not_overwritten_and_a_damaged_one_is_refused(model_file, tmp_path):
    assert "this is a file that is read" in refused(run(model_file, "--export", model_file), 2)
    damaged = tmp_path / "m.npz"
    damaged.write_bytes(model_file.read_bytes()[:-1000])
    assert f"{damaged}: not an .npz file" in refused(run(damaged, "--export", tmp_path / "n.vtu"))
    assert [path.name for path in tmp_path.iterdir()] == ["m.npz"]
