# SPDX-License-Identifier: GPL-3.0-or-later
"""Arrays in files: the same values, and nothing left behind."""

import io

import numpy as np
import pytest
from realmodel.core import BuildFailed, OutputFailed
from realmodel.core.base.mapped_arrays import MappedArrays, read_mapped, write_mapped


def test_what_is_kept_is_in_a_file_until_the_end(tmp_path):
    given = np.arange(12.0).reshape(4, 3)
    with MappedArrays(tmp_path / "run" / "inputs") as arrays:
        kept = arrays.keep(given)
        assert isinstance(kept, np.memmap) and kept.dtype == given.dtype and np.array_equal(kept, given)
        with pytest.raises(ValueError, match="read-only"):
            kept[0] = 1
        assert arrays.keep(kept) is kept
        empty = np.empty((0, 3))
        assert arrays.keep(empty) is empty  # an empty file cannot be mapped
        assert len(list((tmp_path / "run" / "inputs").iterdir())) == 1
        del kept
    assert not (tmp_path / "run" / "inputs").exists()


def test_a_full_disk_is_reported_in_one_line(monkeypatch, tmp_path):
    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(np, "save", full)
    with (
        pytest.raises(OutputFailed, match="No space left on device; make room"),
        MappedArrays(tmp_path / "a") as arrays,
    ):
        arrays.keep(np.ones(3))
    (tmp_path / "file").touch()
    with pytest.raises(OutputFailed), MappedArrays(tmp_path / "file" / "a"):
        pass


def written(arrays, path):
    with path.open("wb") as file:
        write_mapped(arrays, file)
    return path


def test_arrays_come_back_from_a_file_that_is_not_read(tmp_path):
    given = {
        "places": np.random.default_rng(1).normal(size=(5, 3)),
        "none": np.empty((0, 3), np.int32),
        "one": np.array("columns"),
        "texts": np.array(["clay", "übergang"]),
        "numbers": np.arange(7, dtype=np.int32)[::2],
        "flags": np.array([True, False]),
    }
    path = written(given, tmp_path / "a")
    before = path.read_bytes()
    arrays = read_mapped(path)
    assert list(arrays) == list(given)
    for name, array in arrays.items():
        assert array.dtype == given[name].dtype and array.shape == given[name].shape
        assert np.array_equal(array, given[name])
    arrays["places"][0] = 0  # stays in memory
    assert path.read_bytes() == before
    again = io.BytesIO()
    write_mapped(given, again)
    assert again.getvalue() == before


@pytest.mark.parametrize("kept", [0, 5, 40, -1])
def test_a_damaged_file_is_refused(kept, tmp_path):
    path = written({"a": np.ones(8)}, tmp_path / "a")
    path.write_bytes(path.read_bytes()[:kept])
    with pytest.raises(BuildFailed, match="cannot be read; delete it"):
        read_mapped(path)
    with pytest.raises(BuildFailed, match="cannot be read"):
        read_mapped(tmp_path / "missing")
