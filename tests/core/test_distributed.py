# SPDX-License-Identifier: GPL-3.0-or-later
"""Ensembles on workers of Dask: the same result as in one process, resumed, in spite of killed workers."""

import csv
import json
import os
import re
import sys
from concurrent.futures import CancelledError, Future

import numpy as np
import pytest
from dask_workers import PROJECT, KillsOne, batch, local_client, processes_of_cluster
from realmodel.batch.terminal import TimeLeft
from realmodel.core import Cancelled, OutputFailed, UsageError, load_project
from realmodel.core import ensembles as core_ensembles
from realmodel.distributed.workers import Workers, require_this_version, workers_of

pytest.importorskip("distributed", reason="Dask is not installed")


@pytest.fixture(scope="module")
def client():
    with local_client(2) as made:
        yield made


def run(folder, client, realizations=12, seed=3, **options):
    from realmodel.distributed import ensemble

    return ensemble(load_project(PROJECT), realizations, folder, seed, client, **options)


@pytest.fixture(scope="module")
def alone():
    """The same ensemble in this process."""
    places = np.random.default_rng(0).uniform([0, 0, -20], [100, 50, 60], (50, 3))
    return core_ensembles.ensemble(load_project(PROJECT), 20, 3, places=places)


def assert_same(found, expected):
    assert np.array_equal(found.volumes, expected.volumes)
    assert np.array_equal(found.probability, expected.probability)
    for name in ("surface_mean", "surface_deviation"):
        for one, other in zip(getattr(found, name), getattr(expected, name), strict=True):
            assert np.array_equal(one, other)


def test_the_same_as_in_one_process(client, alone, tmp_path, capsys):
    pytest.importorskip("tqdm", reason="tqdm is not installed")
    folder = tmp_path / "e"
    found = run(folder, client, 20, places=alone.places, progress=True)
    assert "20 of 20 realizations: 100%" in capsys.readouterr().err
    assert_same(found, alone)
    assert sorted(path.name for path in folder.iterdir()) == ["ensemble.json", "ensemble.npz", "volumes.csv"]
    report = json.loads((folder / "ensemble.json").read_text())
    assert report["realizations"] == 20 and report["seed"] == 3
    assert [block["name"] for block in report["blocks"]] == ["Clay", "Sand"]
    assert report["blocks"][0]["p50"] == np.percentile(alone.volumes[:, 0], 50)
    assert sum(report["blocks"][1]["histogram"]["counts"]) == 20
    rows = list(csv.reader((folder / "volumes.csv").read_text().splitlines()))
    assert rows[0] == ["realization", "Clay", "Sand"]
    assert np.array_equal(np.array(rows[1:], float)[:, 1:], alone.volumes)
    with np.load(folder / "ensemble.npz") as arrays:
        assert np.array_equal(arrays["probability"], alone.probability)
        assert np.array_equal(arrays["surface_deviation_1"], alone.surface_deviation[1])


def test_a_stopped_run_goes_on(client, alone, tmp_path):
    """The second run does only what the first has not done."""
    files = []

    def stop():
        files[:] = list(tmp_path.glob("batches/*.npz"))
        return bool(files)

    with pytest.raises(Cancelled):
        run(tmp_path, client, 20, places=alone.places, cancel=stop)
    assert not (tmp_path / "ensemble.json").exists()
    before = {file: file.stat().st_mtime_ns for file in tmp_path.glob("batches/*.npz")}
    assert before
    kept = []

    def watch(_share, _text):
        kept[:] = [file for file in before if file.exists() and file.stat().st_mtime_ns == before[file]]

    found = run(tmp_path, client, 20, places=alone.places, progress=watch)
    assert len(kept) == len(before)
    assert_same(found, alone)


def test_the_folder_of_another_ensemble_is_refused(client, tmp_path):
    with pytest.raises(Cancelled):
        run(tmp_path, client, cancel=lambda: bool(list(tmp_path.glob("batches/*.npz"))))
    with pytest.raises(UsageError, match="another project, seed, correlation or places"):
        run(tmp_path, client, seed=4)


def test_a_folder_that_cannot_be(client, tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(OutputFailed):
        run(tmp_path / "file", client)


def test_a_killed_worker_does_not_stop_it(client, alone, tmp_path):
    kills = KillsOne(client, "of 20 realizations")
    found = run(tmp_path, client, 20, places=alone.places, progress=kills)
    assert kills.killed
    assert_same(found, alone)


def test_the_command_line(client, tmp_path):
    address = client.scheduler.address
    done = batch("--ensemble", 3, "--out", tmp_path / "e", "--scheduler", address, "--seed", 5)
    assert done.returncode == 0, done.stderr
    assert "interpolated" in done.stdout and "P90" in done.stdout and "Sand" in done.stdout
    report = json.loads((tmp_path / "e" / "ensemble.json").read_text())
    assert report["realizations"] == 3 and report["seed"] == 5


def test_probabilities_on_the_command_line(client, tmp_path):
    """Files in the folder of the ensemble, the same as what Python says."""
    out, line = tmp_path / "e", "5,5,50,25,95,45"
    arguments = (
        *("--ensemble", 4, "--seed", 5, "--out", out, "--scheduler", client.scheduler.address),
        *("--section", f"50,25,20,0,1,0={out / 'section.png'}", "--fence", f"{line}={out / 'fence.csv'}"),
        *("--borehole", f"50,25={out / 'hole.csv'}", "--export", out / "grid.npz", "--cell-size", "10,1"),
    )
    done = batch(*arguments)
    assert done.returncode == 0, done.stderr
    files = {"section.png", "fence.csv", "hole.csv", "grid.npz"}
    found = {path.name for path in out.iterdir()}
    assert found == files | {"ensemble.json", "ensemble.npz", "volumes.csv"}
    project = load_project(PROJECT)
    with np.load(out / "grid.npz") as arrays:
        alone = core_ensembles.ensemble(project, 4, 5, places=arrays["places"])
        assert np.array_equal(arrays["probability"], alone.probability)
    rows = list(csv.DictReader((out / "hole.csv").read_text().splitlines()))
    places = np.array([[float(row[axis]) for axis in "xyz"] for row in rows])
    alone = core_ensembles.ensemble(project, 4, 5, places=places)
    clay = [float(row["probability Clay"]) for row in rows]
    assert clay == pytest.approx(alone.probability[:, 0])
    assert clay[0] < clay[-1] == 1


def test_a_section_beside_the_model_is_refused(client, tmp_path):
    section = f"500,500,0,0,1,0={tmp_path / 's.csv'}"
    done = batch("--ensemble", 4, "--out", tmp_path, "--section", section)
    assert done.returncode == 2
    assert "the section does not meet the model" in done.stderr
    assert not list(tmp_path.iterdir())


def test_the_time_that_is_left():
    left = TimeLeft()
    assert left(0.1, 0.0) == "" and left(0.105, 10.0) == "" and left(0.3, 1.0) == ""
    assert left(0.2, 10.0) == ", 80 s left"
    assert left(0.2, 100.0) == ", 13 min left"
    assert left(0.15, 1000.0) == ", 5 h left"
    assert left(1.0, 50.0) == ""


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--ensemble", 3], "--ensemble needs --out"),
        (["--out", "e"], "--out goes with --ensemble or --tiles"),
        (["--ensemble", 3, "--out", "e", "--report", "m.json"], "--ensemble goes without --report"),
        (["--ensemble", 3, "--out", "e", "--export", "m.obj"], "of a grid are not written as '.obj'"),
        (["--ensemble", 3, "--out", "e", "--borehole", "1=b.csv"], "a position in plan is two numbers"),
        (["--ensemble", 3, "--out", "e", "--correlation", 2], "from -1 to 1"),
        (["--ensemble", 0, "--out", "e"], "at least one realization"),
    ],
)
def test_wrong_usage(arguments, said, tmp_path):
    done = batch(*arguments, cwd=tmp_path)
    assert done.returncode == 2
    assert said in done.stderr
    assert not list(tmp_path.iterdir())


def test_a_scheduler_that_does_not_answer(tmp_path):
    """In a process of its own: what Dask leaves of a client that was not there stops the next one's start."""
    done = batch("--ensemble", 2, "--out", "e", "--scheduler", "nowhere", cwd=tmp_path)
    assert done.returncode == 2
    assert done.stderr == "build_model.py: no scheduler of Dask answers at nowhere\n"


def test_without_dask(monkeypatch, tmp_path):
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(UsageError, match="pip install"):
        run(tmp_path, None)


def test_clusters_of_one_machine_stand_beside_each_other(monkeypatch):
    """No port is asked for: a second one would warn of the first one's."""
    # Dask leaves it in this process, too, after any cluster, and what is there counts
    monkeypatch.delenv("MALLOC_TRIM_THRESHOLD_", raising=False)
    with workers_of(None, 1) as one, workers_of(None, 1) as other:
        addresses = {workers.client.scheduler.address for workers in (one, other)}
        assert len(addresses) == 2
        assert all(address.startswith("tcp://127.0.0.1:") for address in addresses)
        environments = one.client.run(lambda: dict(os.environ)).values()
        assert [each["OMP_NUM_THREADS"] for each in environments] == ["1"]
        assert [each["MALLOC_TRIM_THRESHOLD_"] for each in environments] == [str(1 << 28)]


class Fake:
    """A client, or the future of a task."""

    def __init__(self, **has):
        self.__dict__.update({"status": "running", "release": lambda: None, **has})


def raising(error):
    def call(*_, **__):
        raise error

    return call


def lost():
    """The future of a task that was given up."""
    return Fake(done=lambda: True, add_done_callback=lambda call: None, result=raising(CancelledError()))


def never_done():
    return Fake(done=lambda: False, add_done_callback=lambda call: None)


@pytest.mark.parametrize(
    "client",
    [
        Fake(submit=lambda *_, **__: lost()),
        Fake(submit=lambda *_, **__: never_done(), status="closed"),
        Fake(submit=raising(Exception("Client is closed")), status="closed"),
        Fake(submit=raising(OSError("no connection"))),
    ],
)
def test_a_client_that_is_closed_meanwhile(client):
    starting = Future()
    starting.set_result(client)
    with pytest.raises(UsageError, match="the scheduler or its workers were lost; start again"):
        list(Workers(starting).in_any_order(print, None, [1, 2]))


def test_an_error_of_dask_stays_what_it_is():
    starting = Future()
    starting.set_result(Fake(submit=raising(TypeError("of Dask"))))
    with pytest.raises(TypeError, match="of Dask"):
        list(Workers(starting).in_any_order(print, None, [1, 2]))


@pytest.mark.parametrize("part", ["scheduler", "worker"])
def test_realmodel_is_missing_on_a_cluster(part, tmp_path):
    """Dask would say so in pages, or in the logs of its workers only, which it loses one after another."""
    with processes_of_cluster(tmp_path, **{part: tmp_path}) as address:
        done = batch("--ensemble", 2, "--out", "e", "--scheduler", address, cwd=tmp_path)
    assert done.returncode == 2
    said = (
        rf"build_model.py: the {part} .*lacks RealModel .*No module named 'realmodel'.*: install it there\n"
    )
    assert re.fullmatch(said, done.stderr)
    assert not (tmp_path / "e").exists()


def test_a_cluster_as_a_user_starts_it(tmp_path):
    with processes_of_cluster(tmp_path) as address:
        done = batch("--ensemble", 2, "--out", "e", "--scheduler", address, cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    assert (tmp_path / "e" / "ensemble.json").exists()


def test_a_worker_with_another_version():
    answers = {"tcp://one": OSError("lost meanwhile"), "tcp://two": "0.0.1"}
    client = Fake(run_on_scheduler=lambda _: None, run=lambda *_, **__: answers)
    with pytest.raises(UsageError, match=r"worker tcp://two has RealModel 0\.0\.1: install .* there"):
        require_this_version(client)
