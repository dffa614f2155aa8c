# SPDX-License-Identifier: GPL-3.0-or-later
"""Outputs appear whole or not at all, whatever happens to the process or the disk."""

import multiprocessing
import os
import random
import resource
import shutil
import signal
import subprocess
import time
from contextlib import suppress

import pytest
from realmodel.core import OutputFailed
from realmodel.core.base.atomic import Outputs

FORK = multiprocessing.get_context("fork")
SIZE = 300_000


def names(folder):
    return sorted(entry.name for entry in folder.iterdir())


@pytest.fixture
def out(tmp_path):
    folder = tmp_path / "out"
    folder.mkdir()
    return folder


def test_files_appear_together_at_the_end(out):
    (out / "b").write_text("old")
    with Outputs() as outputs:
        with outputs.file(out / "a") as file:
            file.write(b"new a")
        with outputs.file(out / "b") as file:
            file.write(b"-" * 5)
            file.seek(0)
            file.write(b"new b")
        with outputs.path(out / "c.png") as path:
            assert path.suffix == ".png"
            path.write_text("new c")
        assert not (out / "a").exists()
        assert (out / "b").read_text() == "old"
        assert not (out / "c.png").exists()
    assert {name: (out / name).read_text() for name in names(out)} == {
        "a": "new a",
        "b": "new b",
        "c.png": "new c",
    }
    assert os.stat(out / "a").st_mode & 0o777 == 0o666 & ~_umask()


def _umask():
    mask = os.umask(0)
    os.umask(mask)
    return mask


@pytest.mark.parametrize("error", [ValueError, KeyboardInterrupt, SystemExit])
def test_nothing_stays_of_a_run_that_fails(out, error):
    (out / "b").write_text("old")
    with pytest.raises(error), Outputs() as outputs:
        with outputs.file(out / "a") as file:
            file.write(b"a")
        with outputs.path(out / "b") as path:
            path.write_text("b")
        raise error
    assert names(out) == ["b"]
    assert (out / "b").read_text() == "old"


def test_what_was_published_is_taken_back_when_the_next_fails(out):
    with pytest.raises(OutputFailed, match="b: cannot be written"), Outputs() as outputs:
        for name in "ab":
            with outputs.file(out / name) as file:
                file.write(b"x")
        (out / "b").mkdir()  # someone takes the name meanwhile
    assert names(out) == ["b"]


def test_links_are_followed(out):
    (out / "real").write_text("old")
    (out / "link").symlink_to("real")
    with Outputs() as outputs, outputs.file(out / "link") as file:
        file.write(b"new")
    assert (out / "link").is_symlink()
    assert (out / "real").read_text() == "new"


def test_places_that_cannot_be_written_to_are_named(out):
    with pytest.raises(OutputFailed, match="this is a folder"), Outputs() as outputs, outputs.file(out):
        pass
    with (
        pytest.raises(OutputFailed, match="there is no folder"),
        Outputs() as outputs,
        outputs.file(out / "none" / "a"),
    ):
        pass
    with (
        pytest.raises(OutputFailed, match="not an ordinary file"),
        Outputs() as outputs,
        outputs.file("/dev/null"),
    ):
        pass
    with (
        pytest.raises(OutputFailed, match="nothing was written"),
        Outputs() as outputs,
        outputs.path(out / "a.png"),
    ):
        pass
    assert names(out) == []


def _write_once(out, number):
    """Three outputs, each filled with the character of its round."""
    text = bytes([65 + number % 26]) * SIZE
    with Outputs() as outputs:
        with outputs.file(out / f"new{number % 50}") as file:
            file.write(text)
        with outputs.file(out / "same") as file:
            for start in range(0, SIZE, SIZE // 10):
                file.write(text[start : start + SIZE // 10])
        with outputs.path(out / "byname.png") as path:
            path.write_bytes(text)


def _write_for_ever(out, number, ready):
    ready.set()
    while True:
        number += 1
        _write_once(out, number)


def _interrupted(out, ready):
    # a run started in the background ignores the signal, and children inherit that
    signal.signal(signal.SIGINT, signal.default_int_handler)
    with suppress(KeyboardInterrupt):
        _write_for_ever(out, 0, ready)
    os._exit(7)


def test_ctrl_c_at_any_moment_leaves_nothing(out):
    chance = random.Random(2)
    for _ in range(40):
        ready = FORK.Event()
        child = FORK.Process(target=_interrupted, args=(out, ready))
        child.start()
        ready.wait()
        time.sleep(chance.uniform(0.0, 0.02))
        while child.is_alive():  # Python drops a Ctrl-C that comes while it frees an object: pressed again
            os.kill(child.pid, signal.SIGINT)
            child.join(5)
        assert child.exitcode == 7
        assert [name for name in names(out) if name.startswith(".")] == []


def test_ctrl_c_while_folders_are_removed_is_reported_and_they_are_removed(out, monkeypatch):
    rmtree = shutil.rmtree

    def interrupted(folder, ignore_errors):
        monkeypatch.setattr(shutil, "rmtree", rmtree)
        try:
            raise KeyboardInterrupt
        finally:
            os.close(-1)  # as rmtree does, where the first close was done already

    with pytest.raises(KeyboardInterrupt) as held, Outputs() as outputs:  # held: nothing is finalized
        monkeypatch.setattr(shutil, "rmtree", interrupted)
        with outputs.file(out / "a") as file:
            file.write(b"a")
    assert names(out) == ["a"]
    assert held.traceback


def _fill(out, outcome):
    resource.setrlimit(resource.RLIMIT_FSIZE, (100_000, 100_000))
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    _write_too_much(out, outcome)


def _write_too_much(out, outcome):
    for kind in ("file", "path"):
        try:
            with Outputs() as outputs:
                with outputs.file(out / "small") as file:
                    file.write(b"x" * 1000)
                if kind == "file":
                    with outputs.file(out / "large") as file:
                        for _ in range(1000):
                            file.write(b"x" * 1000)
                else:
                    with outputs.path(out / "large") as path:
                        path.write_bytes(b"x" * 1_000_000)
            outcome.put("written")
        except OutputFailed as error:
            outcome.put(str(error))


def outcomes_of(target, *arguments):
    outcome = FORK.Queue()
    child = FORK.Process(target=target, args=(*arguments, outcome))
    child.start()
    found = [outcome.get(timeout=300), outcome.get(timeout=300)]
    child.join()
    return found


def test_a_size_limit_is_reported_in_one_line_and_leaves_nothing(out):
    for message in outcomes_of(_fill, out):
        assert "large: cannot be written: File too large; make room" in message
        assert "\n" not in message
    assert names(out) == []


@pytest.fixture
def small_disk(tmp_path):
    folder = tmp_path / "disk"
    folder.mkdir()
    command = ["mount", "-t", "tmpfs", "-o", "size=256k", "realmodel-test", str(folder)]
    if os.geteuid() != 0 or subprocess.run(command, capture_output=True, check=False).returncode != 0:
        pytest.skip("a small tmpfs can be mounted by root only")
    yield folder
    subprocess.run(["umount", str(folder)], check=True)


def test_a_full_disk_is_reported_in_one_line_and_leaves_nothing(small_disk):
    for message in outcomes_of(_write_too_much, small_disk):
        assert "large: cannot be written: No space left on device; make room" in message
    assert names(small_disk) == []


def test_an_output_beside_another_replaces_no_input_and_no_other_output(out):
    (out / "p.mtl").write_text("read")
    outputs = Outputs([out / "p.mtl"])
    with pytest.raises(OutputFailed, match="a file that is read"), outputs, outputs.file(out / "p.mtl"):
        pass
    assert (out / "p.mtl").read_text() == "read"
    with pytest.raises(OutputFailed, match="two outputs have this name"), Outputs() as outputs:
        for _ in range(2):
            with outputs.file(out / "a") as file:
                file.write(b"new")
    assert names(out) == ["p.mtl"]
