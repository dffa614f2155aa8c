# SPDX-License-Identifier: GPL-3.0-or-later
"""build_model.py run by a plain python3: exit status, one-line errors, nothing left behind."""

import json
import os
import pty
import random
import resource
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from conftest import ROOT, grid_surface
from realmodel.core import build, load_project
from stacks import places
from stacks.project_files import write_off

SCRIPT = ROOT / "build_model.py"


def command(*arguments):
    return [sys.executable, str(SCRIPT), *map(str, arguments)]


def run(*arguments, cwd=None, **options):
    return subprocess.run(
        command(*arguments), capture_output=True, text=True, cwd=cwd, check=False, **options
    )


def names(folder):
    return sorted(path.name for path in folder.iterdir())


def refused(done, status=1):
    """The one line on standard error."""
    assert done.returncode == status, done.stderr
    lines = done.stderr.splitlines()
    assert len(lines) == 1, done.stderr
    assert lines[0].startswith("build_model.py: ")
    return lines[0].removeprefix("build_model.py: ")


@pytest.fixture
def out(tmp_path):
    folder = tmp_path / "out"
    folder.mkdir()
    return folder


def test_everything_asked_for_is_written(layers, out):
    project = layers([0, 1, 3])
    done = run(
        project,
        "--export",
        out / "m.npz",
        "--export",
        out / "m.vtu",
        "--report",
        out / "r.json",
        "--threads",
        1,
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert names(out) == ["m.npz", "m.vtu", "r.json"]
    lines = done.stdout.splitlines()
    assert (
        lines[0].endswith("reading")
        or lines[0].endswith("assembling the model")
        or "intersecting" in lines[0]
    )
    assert any(line.split()[:2] == ["S2", "block"] and "2.000000" in line for line in lines)
    assert lines[-1].split()[:2] == ["total", "3.000000"]
    assert json.loads((out / "r.json").read_text())["counts"]["blocks"] == 2
    model = build(load_project(project))
    model.save(out / "again.npz")
    assert (out / "again.npz").read_bytes() == (out / "m.npz").read_bytes()


@pytest.mark.skipif(not places.CHECK.is_dir(), reason=places.CHECK_ABSENT)
def test_the_outside_checker_passes_the_export(layers, out):
    project = layers([0, 2, 1], rock_keys="base_elevation = -1.0", surface_keys="property = 3")
    assert run(project, "--export", out / "m.npz", "--quiet").returncode == 0
    check = subprocess.run(
        [sys.executable, places.CHECK / "check_model.py", project, out / "m.npz"],
        capture_output=True,
        text=True,
        check=False,
    )
    assert check.returncode == 0, check.stdout


def test_quiet_prints_nothing(layers):
    done = run(layers([0, 1]), "--quiet")
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


def test_paths_are_relative_to_the_project_file_and_outputs_to_the_folder(layers, out):
    project = layers([0, 1])
    done = run("--", os.path.relpath(project, out), "--export", "m.npz", cwd=out)
    assert done.returncode == 0, done.stderr
    assert names(out) == ["m.npz"]


def test_stage(layers, out):
    project = layers([0, 1, 3])
    assert run(project, "--stage", 1, "--export", out / "m.npz", "--report", out / "r.json").returncode == 0
    with np.load(out / "m.npz") as read:
        assert read["block_names"].tolist() == ["S1 block"]
    assert json.loads((out / "r.json").read_text())["project"]["stage"] == 1
    assert "stage 3 does not exist: stages run from 0 to 2" in refused(run(project, "--stage", 3), 2)


def test_cells_of_blocks(layers, out):
    assert run(layers([0, 1]), "--cells", "blocks", "--export", out / "m.npz").returncode == 0
    with np.load(out / "m.npz") as read:
        assert str(read["cell_kind"]) == "blocks"
        assert len(read["cell_block"]) == 1


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ([], "PROJECT"),
        (["p.toml", "--stage", "-1"], "--stage"),
        (["p.toml", "--stage", "x"], "'x' is not a whole number"),
        (["p.toml", "--threads", "1.5"], "--threads"),
        (["p.toml", "--cells", "cubes"], "--cells"),
        (["p.toml", "--unknown"], "--unknown"),
        (["p.toml", "other.toml"], "other.toml"),
        (["p.toml", "--blend", "m.blend"], "--blend needs Blender; run it as: blender -b"),
        (["p.toml", "--render", "m.png"], "--render needs Blender; run it as: blender -b"),
        (["p.toml", "--blend", "m.png"], ".blend"),
        (["p.toml", "--render", "m.jpg"], ".png"),
        (["p.toml", "--report", "r.txt"], ".json"),
        (["p.toml", "--cell-size", "1,x"], "'x' is not a number above 0"),
        (["p.toml", "--export", "m.xyz"], "'.xyz' are not supported; use one of .npz, .vtu"),
        (["p.toml", "--export", "m"], "no extension"),
        (["p.toml", "--export", "m.npz", "--export", "./m.npz"], "two outputs have this name"),
    ],
)
def test_wrong_usage(out, arguments, words):
    done = run(*arguments, cwd=out)
    assert done.returncode == 2
    assert words in done.stderr
    assert "Traceback" not in done.stderr
    assert names(out) == []


def test_help():
    done = run("--help")
    assert done.returncode == 0
    assert "--stage M" in done.stdout


REGION_TEXT = "region = [[0, 0], [1, 0], [1, 1], [0, 1]]\nedge_length = 0.2\n"
BOW_TIE = "region = [[0, 0], [1, 1], [1, 0], [0, 1]]\nedge_length = 0.2\n"
POINTS = '[[rock.surface]]\nname = "P"\npoints = "p.csv"\n'


@pytest.mark.parametrize(
    ("name", "rock_keys", "files", "words"),
    [
        (
            "unknown key",
            "edge_lenght = 2",
            {},
            "p.toml:5: rock 'rock': unknown key 'edge_lenght'; did you mean",
        ),
        ("missing file", 'region = "r.geojson"', {}, "p.toml:5: rock 'rock': file not found"),
        (
            "broken mesh",
            "",
            {"s1.off": "OFF\n4 2 0\n0 0 0\n"},
            "s1.off:3: rock 'rock', surface 'S1': 4 vertices",
        ),
        ("nan", "", {"s1.off": "OFF\n3 1 0\n0 0 nan\n1 0 0\n0 1 0\n3 0 1 2\n"}, "s1.off:3: "),
        (
            "broken region",
            'region = "r.geojson"',
            {"r.geojson": "{"},
            "r.geojson:1: rock 'rock': not valid JSON",
        ),
        ("base", "base_elevation = 7.0", {}, "p.toml:5: rock 'rock': base_elevation 7 is not below"),
        ("crossing outline", BOW_TIE, {}, "p.toml:5: rock 'rock', region: "),
        (
            "empty points",
            REGION_TEXT + POINTS,
            {"p.csv": "x,y,z\n"},
            "p.csv: rock 'rock', surface 'P': there are no",
        ),
        (
            "bad point",
            REGION_TEXT + POINTS,
            {"p.csv": "0,0,0\n1,0,zero\n"},
            "p.csv:2: rock 'rock', surface 'P': z is",
        ),
    ],
)
def test_refused_input(layers, write, out, name, rock_keys, files, words):
    project = layers([0, 1], name="p.toml", rock_keys=rock_keys)
    for file, text in files.items():
        write(file, text)
    line = refused(run(project, "--export", out / "m.npz", "--report", out / "r.json", "--quiet"))
    assert words in line
    assert names(out) == []


def test_missing_project(out):
    assert "none.toml: cannot be read: No such file" in refused(run("none.toml", cwd=out))


def test_outputs_that_cannot_be_written_are_refused_before_the_build(layers, out):
    project = layers([0, 1])
    assert "there is no folder" in refused(run(project, "--export", out / "none" / "m.npz"))
    folder = out / "m.npz"
    folder.mkdir()
    assert "this is a folder" in refused(run(project, "--export", folder))


def test_inputs_are_not_overwritten(layers, write):
    ring = "[[[0,0],[1,0],[1,1],[0,1],[0,0]]]"
    region = write("r.json", f'{{"type": "Polygon", "coordinates": {ring}}}')
    before = region.read_text()
    project = layers([0, 1], rock_keys='region = "r.json"')
    assert "this is a file that is read" in refused(run(project, "--report", region), 2)
    assert region.read_text() == before


def test_earlier_outputs_stay_when_a_run_fails(layers, out):
    (out / "m.npz").write_text("earlier")
    refused(run(layers([0, 1], rock_keys="base_elevation = 7.0"), "--export", out / "m.npz", "--quiet"))
    assert (out / "m.npz").read_text() == "earlier"


@pytest.fixture(scope="module")
def large(tmp_path_factory):
    """A project that takes a second."""
    folder = tmp_path_factory.mktemp("large")
    lines = ["format = 1", 'name = "large"', "[[rock]]", 'name = "rock"']
    for k in range(6):

        def height(x, y, k=k):
            return 0.1 * k + 0.4 * np.sin(7 * x + k) * np.cos(6 * y - k)

        write_off(folder / f"s{k}.off", *grid_surface(50 + k, height))
        lines += ["[[rock.surface]]", f'name = "S{k}"', f'mesh = "s{k}.off"']
    path = folder / "large.toml"
    path.write_text("\n".join(lines) + "\n")
    return path


def started(project, out, **options):
    return subprocess.Popen(
        command(project, "--export", out / "m.npz", "--export", out / "m.vtu", "--report", out / "r.json"),
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        **options,
    )


def time_of_a_run(project, out):
    began = time.perf_counter()
    process = started(project, out)
    process.communicate()
    assert process.returncode == 0
    taken = time.perf_counter() - began
    for path in out.iterdir():
        path.unlink()
    return taken


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_interrupted_at_any_moment(large, out, number):
    """Exit status 130 (143) and nothing left; too late only when all is there."""
    latest = 0.9 * time_of_a_run(large, out)
    chance = random.Random(3)
    interrupted = trials = 0
    while trials < 3 or interrupted < 2:
        trials += 1
        assert trials < 30, "it cannot be interrupted"
        process = started(large, out)
        process.stdout.readline()  # its handlers stand
        time.sleep(chance.uniform(0.0, latest))
        process.send_signal(number)
        _, errors = process.communicate()
        if process.returncode == 0:
            assert names(out) == ["m.npz", "m.vtu", "r.json"]
            for path in out.iterdir():
                path.unlink()
            latest *= 0.8  # the machine was busier while the run was timed
            continue
        interrupted += 1
        assert process.returncode == (130 if number == signal.SIGINT else 143), errors
        assert errors == (
            "build_model.py: interrupted: nothing was written\n" if number == signal.SIGINT else ""
        )
        assert names(out) == []


def test_killed_at_any_moment(large, out):
    """Whole files or none under the outputs' names."""
    taken = time_of_a_run(large, out)
    chance = random.Random(4)
    sizes = {}
    for _ in range(3):
        process = started(large, out)
        time.sleep(chance.uniform(0.5, 1.1) * taken)
        process.kill()
        process.communicate()
        for path in out.iterdir():
            if path.name.startswith(".realmodel-"):
                shutil.rmtree(path)
                continue
            assert path.name in ("m.npz", "m.vtu", "r.json")
            if path.suffix != ".json":
                assert sizes.setdefault(path.name, path.stat().st_size) == path.stat().st_size
            path.unlink()


def test_a_full_disk(large, out):
    def limit():
        resource.setrlimit(resource.RLIMIT_FSIZE, (300_000, 300_000))

    done = run(large, "--report", out / "r.json", "--export", out / "m.npz", "--quiet", preexec_fn=limit)
    assert "m.npz: cannot be written: File too large; make room or choose another folder" in refused(done)
    assert names(out) == []


def test_nobody_reads_on(layers, out):
    """As with `build_model.py ... | head`: one line, nothing left."""
    reading, writing = os.pipe()
    os.close(reading)
    done = subprocess.run(
        command(layers([0, 1]), "--export", out / "m.npz"),
        stdout=writing,
        stderr=subprocess.PIPE,
        text=True,
        check=False,
    )
    os.close(writing)
    assert "standard output was closed" in refused(done)
    assert names(out) == []


def test_letters_that_the_terminal_lacks(layers):
    project = layers([0, 1], surface_keys='block = "Grès"')
    done = run(project, env={**os.environ, "PYTHONIOENCODING": "ascii"})
    assert (done.returncode, done.stderr) == (0, "")
    assert "Gr?s" in done.stdout


def test_a_bar_on_a_terminal(layers):
    """A terminal sees a bar that is gone at the end, and then the table."""
    leader, follower = pty.openpty()
    process = subprocess.Popen(command(layers([0, 1])), stdout=follower, stderr=follower)
    os.close(follower)
    shown = b""
    while True:
        try:
            piece = os.read(leader, 4096)
        except OSError:  # the other end is closed
            break
        shown += piece
        if not piece:
            break
    os.close(leader)
    assert process.wait() == 0
    assert b"\r[####" in shown
    assert b"100 %" in shown
    assert shown.rstrip().endswith(b"1")
    assert b"\r\n" in shown.split(b"]")[-1]


def test_without_the_native_module(layers, tmp_path):
    """One line says how to get it."""
    copy = tmp_path / "copy"
    (copy / "addon").mkdir(parents=True)
    (copy / "scripts").mkdir()
    (copy / "scripts" / "build.sh").write_text("")
    (copy / "build_model.py").write_text(SCRIPT.read_text())
    package = ROOT / "addon" / "realmodel"
    for path in package.rglob("*.py"):
        target = copy / "addon" / "realmodel" / path.relative_to(package)
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_text(path.read_text())
    done = subprocess.run(
        [sys.executable, copy / "build_model.py", layers([0, 1])], capture_output=True, text=True, check=False
    )
    assert "scripts/build.sh" in refused(done)


def test_it_is_found_from_anywhere():
    assert Path(SCRIPT).read_text().startswith("#!/usr/bin/env python3\n")
    assert os.access(SCRIPT, os.X_OK)


def test_an_estimate_builds_nothing(layers, out):
    project = layers([0, 1, 3])
    done = run(project, "--estimate", cwd=out)
    assert done.returncode == 0, done.stderr
    assert "triangles of all surfaces      6" in done.stdout
    assert "memory while building columns  at most" in done.stdout
    assert "refused" not in done.stdout
    assert not names(out)
    done = run(project, "--estimate", "--cells", "blocks", "--memory", "1e-6")
    assert done.returncode == 0
    assert "memory while building blocks" in done.stdout
    assert "would be refused" in done.stdout
    done = run(ROOT / "blend_samples" / "recumbent_fold" / "project.toml", "--estimate")
    assert "nodes of lattices" in done.stdout


def test_an_estimate_goes_without_outputs(layers, out):
    done = run(layers([0, 1]), "--estimate", "--export", out / "m.npz")
    assert done.returncode == 2
    assert "--estimate goes without" in done.stderr


def test_what_would_not_fit_the_memory_is_refused(layers, out):
    line = refused(run(layers([0, 1, 3]), "--memory", "1e-6", "--export", out / "m.npz"))
    assert "are allowed" in line
    assert not names(out)


@pytest.mark.parametrize("size", ["0", "-1", "much", "nan"])
def test_memory_is_a_number_of_gigabytes(layers, size):
    done = run(layers([0, 1]), "--memory", size)
    assert done.returncode == 2
    assert "gigabytes" in done.stderr
