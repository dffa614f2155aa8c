# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs that build models in tiles: stopped, done again, refused, on a full disk; what they keep and leave."""

import shutil

import numpy as np
import pytest
from realmodel.core import (
    InputRefused,
    OutputFailed,
    Surface,
    UsageError,
    build,
    open_tiles,
)
from realmodel.core.tiles.windows import Windows
from realmodel.distributed import build as build_tiles
from realmodel.distributed import run_folder, tile_folder
from tiled_models import (
    OUTLINE,
    assert_same_blocks,
    ready,
    sample,
)

pytestmark = pytest.mark.usefixtures("tiles_in_this_process")


def test_a_stopped_run_goes_on(monkeypatch, tmp_path):
    project, calls, built = ready(OUTLINE), [], []
    real, build_one = tile_folder._join, tile_folder._build

    def stops(shared, name):
        calls.append(name)
        if len(calls) == 3:
            raise KeyboardInterrupt
        return real(shared, name)

    monkeypatch.setattr(tile_folder, "_join", stops)
    with pytest.raises(KeyboardInterrupt):
        build_tiles(project, tmp_path / "t", (40, 40))
    with pytest.raises(InputRefused, match="unfinished"):
        open_tiles(tmp_path / "t")
    assert {path.name for path in (tmp_path / "t" / "run").glob("joined-*")} == {
        f"joined-{tile}.json" for tile in ("0000-0000", "0001-0000")
    }
    run = tmp_path / "t" / "run"
    left = {path.stem for path in run.glob("built-*.arrays")}
    assert left == {"built-0002-0000", "built-0000-0001", "built-0001-0001", "built-0002-0001"}
    assert len(list(run.glob("built-*.json"))) == 6  # a tile is joined as soon as those around it are built
    monkeypatch.setattr(
        tile_folder, "_build", lambda shared, name: built.append(name) or build_one(shared, name)
    )
    tiled = build_tiles(project, tmp_path / "t", (40, 40))
    assert len(calls) == 3 + len(tiled.tiles) - 2
    assert built == [(0, 2), (1, 2), (2, 2)]
    assert_same_blocks(tiled, build(project))
    assert not (tmp_path / "t" / "run").exists()
    monkeypatch.setattr(tile_folder, "_join", None)
    again = build_tiles(project, tmp_path / "t", (40, 40))
    assert again.blocks == tiled.blocks


def test_tasks_are_done_twice(monkeypatch, tmp_path):
    """As Dask does those of a worker that is lost before their results are fetched."""
    real = tile_folder._step

    def twice(shared, task):
        real(shared, task)
        real(shared, task)

    monkeypatch.setattr(tile_folder, "_step", twice)
    project = sample("two_layers")
    assert_same_blocks(build_tiles(project, tmp_path / "t", (40, 40)), build(project))


def test_surfaces_are_kept_in_files(monkeypatch, tmp_path):
    """Read, interpolated or given: one is in memory at a time, and the files are gone at the end."""
    ready_one = sample("two_layers")
    vertices, triangles = build(ready_one).surface(0)
    ready_one.rocks[0].surfaces[0] = Surface("given", vertices, triangles)
    found = []

    def look(self, work, inputs, *rest):
        meshes = [mesh for entry in inputs for mesh in (*entry.surfaces, entry.region) if mesh is not None]
        found.extend(isinstance(each, np.memmap) for mesh in meshes for each in mesh)
        assert len(list((tmp_path / "t" / "run").glob("inputs-*"))) == 1
        real(self, work, inputs, *rest)

    real = Windows.__init__
    monkeypatch.setattr(Windows, "__init__", look)
    for project in (sample("haut_barr"), ready_one):
        build_tiles(project, tmp_path / "t", (1e6, 1e6))
        assert found and all(found)
        assert not list((tmp_path / "t").rglob("inputs-*"))
        shutil.rmtree(tmp_path / "t")


def test_nothing_is_left_of_a_model_that_is_refused(tmp_path):
    project = sample("two_layers")
    project.rocks[0].surfaces[1].points = tmp_path / "missing.csv"
    for folder in (tmp_path / "new", tmp_path / "there"):
        (tmp_path / "there").mkdir(exist_ok=True)
        with pytest.raises(InputRefused, match=r"missing\.csv"):
            build_tiles(project, folder, (37, 23))
    assert not (tmp_path / "new").exists()
    assert not list((tmp_path / "there").iterdir())


def test_the_same_bytes_again(tmp_path):
    project = ready(OUTLINE)
    for folder in ("a", "b"):
        build_tiles(project, tmp_path / folder, (60, 60))
    names = sorted(path.relative_to(tmp_path / "a") for path in (tmp_path / "a").rglob("*.*"))
    assert len(names) == 2 * 4 + 2
    for name in names:
        assert (tmp_path / "a" / name).read_bytes() == (tmp_path / "b" / name).read_bytes(), name


def test_the_folder_of_another_model_is_refused(monkeypatch, tmp_path):
    build_tiles(ready(), tmp_path / "t", (60, 60))
    with pytest.raises(UsageError, match="another project, tile size or kind of cells"):
        build_tiles(ready(), tmp_path / "t", (60, 60), cells="blocks")

    def full(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(tile_folder, "_build", full)
    with pytest.raises(KeyboardInterrupt):
        build_tiles(ready(), tmp_path / "u", (60, 60))
    with pytest.raises(UsageError, match="another project"):
        build_tiles(ready(), tmp_path / "u", (50, 60))
    (tmp_path / "v").mkdir()
    (tmp_path / "v" / "notes.txt").write_text("mine")
    with pytest.raises(UsageError, match="other content"):
        build_tiles(ready(), tmp_path / "v", (50, 60))


def test_a_full_disk_stops_it_in_one_line(monkeypatch, tmp_path):
    project = ready()
    real = run_folder.write_vtu

    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(run_folder, "write_vtu", full)
    with pytest.raises(OutputFailed, match="No space left on device; make room") as failed:
        build_tiles(project, tmp_path / "t", (60, 60))
    assert "\n" not in str(failed.value)
    assert not list((tmp_path / "t" / "tiles").iterdir())[1:]  # one .npz, its .vtu is missing
    monkeypatch.setattr(run_folder, "write_vtu", real)
    assert_same_blocks(build_tiles(project, tmp_path / "t", (60, 60)), build(project))


def test_a_tile_that_was_changed_is_refused(tmp_path):
    tiled = build_tiles(ready(), tmp_path / "t", (60, 60))
    file = tiled.tiles[1].file
    file.write_bytes(file.read_bytes()[:-7] + b"changed")
    with pytest.raises(InputRefused, match="has changed"):
        tiled.tiles[1].model()
    file.unlink()
    with pytest.raises(InputRefused, match="cannot be read"):
        tiled.tiles[1].model()
    catalog = tmp_path / "t" / "tiles.toml"
    catalog.write_text(catalog.read_text().replace("digest", "digits"))
    with pytest.raises(InputRefused, match="damaged"):
        open_tiles(tmp_path / "t")
