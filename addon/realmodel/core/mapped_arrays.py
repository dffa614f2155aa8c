# SPDX-License-Identifier: GPL-3.0-or-later
"""Arrays in files, of which the system keeps in memory what is used; and arrays that come piece by piece."""

from __future__ import annotations

import json
import secrets
import shutil
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO

import numpy as np

from .errors import BuildFailed, OutputFailed

Keep = Callable[[np.ndarray], np.ndarray]  # the same values, kept in another place
# One array of pieces, one after another; the second is empty, and has the type and the columns of all.
Gather = Callable[[Iterable[np.ndarray], np.ndarray], np.ndarray]

ROWS_AT_ONCE = 1 << 16  # of an array that is taken piece by piece
_HEADER = 128  # bytes before an array in a file of NumPy


def as_it_is(array: np.ndarray) -> np.ndarray:
    """For callers that keep arrays in memory."""
    return array


def in_memory(pieces: Iterable[np.ndarray], empty: np.ndarray) -> np.ndarray:
    """Gathers pieces for callers that keep arrays in memory."""
    return np.concatenate([empty, *pieces])


def in_pieces(array: np.ndarray) -> Iterator[np.ndarray]:
    """Rows of an array one after another, few at once."""
    for first in range(0, len(array), ROWS_AT_ONCE):
        yield array[first : first + ROWS_AT_ONCE]


class MappedArrays:
    """Keeps arrays in files of a folder, which lasts as long as the `with` block. Other processes may keep
    theirs in the folder, too.

    Raises OutputFailed."""

    def __init__(self, folder: Path):
        self.folder = folder
        self._files: dict[int, tuple[np.ndarray, Path]] = {}  # by the id of the array

    def __enter__(self) -> MappedArrays:
        try:
            self.folder.mkdir(parents=True)
        except OSError as error:
            raise OutputFailed(f"{self.folder}: {error.strerror or error}") from error
        return self

    def __exit__(self, *_) -> None:
        self._files.clear()
        shutil.rmtree(self.folder, ignore_errors=True)

    def keep(self, array: np.ndarray) -> np.ndarray:
        """The array in a file, read-only; itself where it is in one, or empty."""
        if id(array) in self._files or not array.size:
            return array
        file = self._new_file()
        with _told_of(file):
            np.save(file, array)
            return self.opened(file)

    def gather(self, pieces: Iterable[np.ndarray], empty: np.ndarray) -> np.ndarray:
        """Gathers pieces in a file, read-only; one of them at a time is in memory."""
        file, rows = self._new_file(), 0
        with _told_of(file):
            out = file.open("wb")
        with out:
            out.seek(_HEADER)
            for piece in pieces:
                rows += len(piece)
                with _told_of(file):
                    out.write(np.ascontiguousarray(piece, empty.dtype))
            with _told_of(file):
                out.seek(0)
                out.write(_header(empty.dtype, (rows, *empty.shape[1:])))
                out.flush()
        return self.opened(file) if rows else empty

    def _new_file(self) -> Path:
        return self.folder / f"{secrets.token_hex(8)}.npy"

    def place(self, array: np.ndarray) -> Path | np.ndarray:
        """What tells another process of an array: its file, or itself where it is empty."""
        kept = self.keep(array)
        return self._files[id(kept)][1] if kept.size else kept

    def opened(self, place: Path | np.ndarray) -> np.ndarray:
        """The array that was told of by its place."""
        if isinstance(place, np.ndarray):
            return place
        array = np.load(place, mmap_mode="r")
        self._files[id(array)] = array, place
        return array


@contextmanager
def _told_of(file: Path) -> Iterator[None]:
    """Tells in one line what keeps an array from being written."""
    try:
        yield
    except OSError as error:
        text = f"{file}: {error.strerror or error}; make room, or choose another folder"
        raise OutputFailed(text) from error


def _header(dtype: np.dtype, shape: tuple[int, ...]) -> bytes:
    """What stands before an array in a file of NumPy, format 1.0, in _HEADER bytes."""
    begin = np.lib.format.magic(1, 0) + (_HEADER - 10).to_bytes(2, "little")
    text = repr({"descr": dtype.str, "fortran_order": False, "shape": shape})
    return begin + text.ljust(_HEADER - len(begin) - 1).encode() + b"\n"


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
