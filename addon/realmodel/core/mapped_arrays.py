# SPDX-License-Identifier: GPL-3.0-or-later
"""Arrays in files, of which the system keeps in memory what is used."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import BinaryIO

import numpy as np

from .errors import BuildFailed, OutputFailed

Keep = Callable[[np.ndarray], np.ndarray]  # the same values, kept in another place


def as_it_is(array: np.ndarray) -> np.ndarray:
    """For callers that keep arrays in memory."""
    return array


class MappedArrays:
    """Keeps arrays in files of a folder of their own as long as the `with` block lasts.

    Raises OutputFailed."""

    def __init__(self, folder: Path):
        self._folder = folder
        self._count = 0

    def __enter__(self) -> MappedArrays:
        try:
            self._folder.mkdir(parents=True)
        except OSError as error:
            raise OutputFailed(f"{self._folder}: {error.strerror or error}") from error
        return self

    def __exit__(self, *_) -> None:
        shutil.rmtree(self._folder, ignore_errors=True)

    def keep(self, array: np.ndarray) -> np.ndarray:
        """The array in a file, read-only; itself where it is in one, or empty."""
        if isinstance(array, np.memmap) or not array.size:
            return array
        file = self._folder / f"{self._count}.npy"
        self._count += 1
        try:
            np.save(file, array)
            return np.load(file, mmap_mode="r")
        except OSError as error:
            text = f"{file}: {error.strerror or error}; make room, or choose another folder"
            raise OutputFailed(text) from error


_ALIGNED = 64  # bytes: where an array may begin
_NUMBER = 8  # bytes of the length of the table


def write_mapped(arrays: dict[str, np.ndarray], file: BinaryIO) -> None:
    """Writes arrays so that they need not be read: behind a table of their names, types, shapes and
    places."""
    table, at = {}, 0
    for name, array in arrays.items():
        table[name] = [array.dtype.str, array.shape, at]
        at += _aligned(array.nbytes)
    text = json.dumps(table).encode()
    text += b" " * (_aligned(_NUMBER + len(text)) - _NUMBER - len(text))
    file.write(len(text).to_bytes(_NUMBER, "little") + text)
    for array in arrays.values():
        file.write(np.ascontiguousarray(array))
        file.write(b"\0" * (_aligned(array.nbytes) - array.nbytes))


def _aligned(size: int) -> int:
    return -(-size // _ALIGNED) * _ALIGNED


def read_mapped(path: Path) -> dict[str, np.ndarray]:
    """The arrays of a file of write_mapped; what is written to them stays in memory. Raises BuildFailed."""
    try:
        content = np.memmap(path, np.uint8, "c")
        start = _NUMBER + int.from_bytes(content[:_NUMBER].tobytes(), "little")
        table = json.loads(content[_NUMBER:start].tobytes())
        arrays = {}
        for name, (kind, shape, at) in table.items():
            dtype = np.dtype(kind)
            begin = start + at
            size = dtype.itemsize * int(np.prod(shape))
            arrays[name] = np.asarray(content[begin : begin + size]).view(dtype).reshape(shape)
        return arrays
    except (OSError, ValueError, TypeError) as error:
        raise BuildFailed(f"{path}: cannot be read; delete it and start again") from error
