# SPDX-License-Identifier: GPL-3.0-or-later
"""Tiles on workers of Dask: killed workers, another scheduler, the command line."""

import os
import re
import subprocess
import sys
import threading
import time

import pytest
from dask_workers import PROJECT, ROOT, KillsOne, batch, local_client
from realmodel.core import Cancelled, UsageError, build, load_project, open_tiles
from realmodel.distributed import workers

pytest.importorskip("distributed", reason="Dask is not installed")


@pytest.fixture(scope="module")
def client():
    with local_client(2) as made:
        yield made


def run(folder, client, **options):
    from realmodel.distributed import build as build_tiles

    return build_tiles(load_project(PROJECT), folder, (35, 30), client, **options)


def assert_whole(tiled):
    whole = build(load_project(PROJECT), cells=tiled.cell_kind)
    for one, other in zip(tiled.blocks, whole.blocks, strict=True):
        assert one.components == other.components
        assert abs(one.volume - other.volume) <= 1e-12 * other.volume
    assert tiled.unequal == 0


def test_a_killed_worker_does_not_stop_it(client, tmp_path):
    kills = KillsOne(client, "of 6 tiles built")
    tiled = run(tmp_path / "t", client, progress=kills)
    assert kills.killed
    assert len(tiled.tiles) == 6
    assert_whole(tiled)


def test_the_only_worker_is_killed(tmp_path):
    """The one that replaces it has nothing of this run."""
    with local_client(1) as client:
        kills = KillsOne(client, "of 6 tiles built")
        tiled = run(tmp_path / "t", client, progress=kills)
    assert kills.killed
    assert_whole(tiled)


def test_no_workers_are_left(monkeypatch, tmp_path):
    monkeypatch.setattr(workers, "_WITHOUT_RESULT", 0.5)
    with local_client(0) as client, pytest.raises(UsageError, match="no workers left; start again"):
        run(tmp_path / "t", client)


FAULTED = ROOT / "blend_samples" / "rift_basin" / "project.toml"


def faulted(folder, client, **options):
    from realmodel.distributed import build as build_tiles

    return build_tiles(load_project(FAULTED), folder, (2600, 3000), client, **options)


def assert_whole_with_faults(tiled):
    for one, other in zip(tiled.blocks, build(load_project(FAULTED)).blocks, strict=True):
        assert (one.cells, one.components) == (other.cells, other.components)
        assert abs(one.volume - other.volume) <= 1e-12 * other.volume
    assert tiled.unequal == 0


def test_a_killed_worker_does_not_stop_a_model_with_faults(client, tmp_path):
    kills = KillsOne(client, "tiles built")
    tiled = faulted(tmp_path / "t", client, progress=kills)
    assert kills.killed
    assert len(tiled.tiles) > 4
    assert_whole_with_faults(tiled)


def test_a_stopped_run_with_faults_goes_on(client, tmp_path):
    with pytest.raises(Cancelled):
        faulted(tmp_path / "t", client, cancel=lambda: bool(list(tmp_path.glob("t/run/joined-*.json"))))
    before = {file: file.stat().st_mtime_ns for file in tmp_path.glob("t/tiles/*.vtu")}
    assert before and not (tmp_path / "t" / "tiles.toml").exists()
    done = {file for file in before if (tmp_path / "t" / "run" / f"joined-{file.stem}.json").exists()}
    assert_whole_with_faults(faulted(tmp_path / "t", client))
    assert all(file.stat().st_mtime_ns == before[file] for file in done)


def test_a_stopped_run_goes_on_in_another_cluster(client, tmp_path):
    with pytest.raises(Cancelled):
        run(tmp_path / "t", client, cancel=lambda: bool(list(tmp_path.glob("t/run/built-*.json"))))
    before = {file: file.stat().st_mtime_ns for file in tmp_path.glob("t/run/built-*.json")}
    assert before
    kept = []

    def watch(_share, _text):
        kept[:] = [file for file in before if file.exists() and file.stat().st_mtime_ns == before[file]]

    with local_client(1) as other:
        tiled = run(tmp_path / "t", other, progress=watch)
    assert len(kept) == len(before)
    assert_whole(tiled)


def test_a_bar_and_tables(client, tmp_path, capsys):
    pytest.importorskip("tqdm", reason="tqdm is not installed")
    tiled = run(tmp_path / "t", client, progress=True, cells="blocks")
    assert ": 100%" in capsys.readouterr().err
    whole = build(load_project(PROJECT), cells="blocks")
    names = ["name", "rock", "surface", "property", "property_name", "components"]
    assert tiled.block_table()[names].equals(whole.block_table()[names])
    columns = ["block", "name", "property"]
    assert tiled.borehole_table(40, 25)[columns].equals(whole.borehole_table(40, 25)[columns])


def test_what_a_worker_finds_wrong_comes_back(client, tmp_path):
    from realmodel.core import InputRefused, Surface
    from realmodel.distributed import build as build_tiles

    project = load_project(PROJECT)
    corners = [[0.0, 0.0, 90.0], [80.0, 0.0, 90.0], [0.0, 50.0, 90.0]]
    project.rocks[0].surfaces.append(Surface("twice", corners, [[0, 1, 2], [0, 1, 2]]))
    with pytest.raises(InputRefused, match=r"twice.*triangles 0 and 1 overlap"):
        build_tiles(project, tmp_path / "t", (35, 30), client)


def test_the_command_line(client, tmp_path):
    address = client.scheduler.address
    asked = ["--tiles", "60,30", "--out", tmp_path / "t", "--scheduler", address, "--cells", "blocks"]
    done = batch(*asked)
    assert done.returncode == 0, done.stderr
    assert "Sand" in done.stdout and "4 tiles, each validated" in done.stdout
    assert_whole(open_tiles(tmp_path / "t"))


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--tiles", "5,5"], "--tiles needs --out"),
        (["--tiles", "5", "--out", "t"], "not two lengths above 0"),
        (["--tiles", "5,5", "--out", "t", "--seed", 3], "--seed goes with --ensemble"),
        (["--tiles", "5,5", "--out", "t", "--report", "r.json"], "--tiles goes without --report"),
    ],
)
def test_wrong_usage(arguments, said, tmp_path):
    done = batch(*arguments, cwd=tmp_path)
    assert done.returncode == 2
    assert said in done.stderr
    assert not list(tmp_path.iterdir())


def test_what_a_worker_refuses_is_one_line(tmp_path):
    for name in ("project.toml", "library.toml", "clay.csv", "ground.csv"):
        (tmp_path / name).write_text((PROJECT.parent / name).read_text())
    (tmp_path / "clay.csv").write_text("x,y,z\n1,2,three\n")
    done = batch("--tiles", "35,30", "--out", tmp_path / "t", project=tmp_path / "project.toml")
    assert done.returncode == 1
    assert re.fullmatch(r"build_model.py: .*clay\.csv:2: .*: z is not a number: 'three'\n", done.stderr)


GONE = """
import sys
import distributed
from realmodel.core import UsageError, load_project
from realmodel.distributed import build

if __name__ == "__main__":
    project, folder = sys.argv[1:]
    cluster = distributed.LocalCluster(n_workers=1, processes=True, dashboard_address=":0")
    client = distributed.Client(cluster)

    def close(_share, text):
        if "1 of 6 tiles built" in text:
            client.shutdown()

    for _ in range(2):
        try:
            build(load_project(project), folder, (35, 30), client, progress=close)
        except UsageError as error:
            print(error, flush=True)
"""


def test_a_scheduler_that_goes_away(tmp_path):
    """During a run, and before the next. In a process of its own: a cluster that ends like this leaves
    sockets."""
    (tmp_path / "gone.py").write_text(GONE)
    command = [sys.executable, tmp_path / "gone.py", PROJECT, tmp_path / "t"]
    paths = {"PYTHONPATH": str(ROOT / "addon")}
    done = subprocess.run(
        command, capture_output=True, text=True, check=False, timeout=60, env=os.environ | paths
    )
    said = "the scheduler or its workers were lost; start again: finished steps are kept"
    assert done.stdout.splitlines() == [said, said], done.stderr


def test_a_cancelled_run_has_ended(client, monkeypatch, tmp_path):
    """Nothing uses the client or the folder any more, though what reads is between two looks at `cancel`."""
    reading = threading.Event()

    def slow(*_):
        reading.set()
        time.sleep(0.5)

    monkeypatch.setattr(client, "replicate", slow)
    with pytest.raises(Cancelled):
        run(tmp_path / "t", client, cancel=reading.is_set)
    assert "realmodel work" not in [thread.name for thread in threading.enumerate()]
    assert not (tmp_path / "t").exists()


def test_files_are_read_by_workers(client, tmp_path):
    """A worker refuses a bad file with the same message as a build without workers."""
    from realmodel.core import InputRefused
    from realmodel.distributed import build as build_tiles

    project = load_project(PROJECT)
    (tmp_path / "bad.csv").write_text("x,y,z\n1,2,three\n")
    project.rocks[0].surfaces[1].points = tmp_path / "bad.csv"
    with pytest.raises(InputRefused, match=r"bad\.csv.*surface 'ground'") as refused:
        build_tiles(project, tmp_path / "t", (35, 30), client)
    with pytest.raises(InputRefused) as here:
        build(project)
    assert str(refused.value) == str(here.value)
    assert not (tmp_path / "t").exists()
