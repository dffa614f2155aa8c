# SPDX-License-Identifier: GPL-3.0-or-later
"""Memory-mapped arrays in files, and arrays that are assembled from pieces."""

from __future__ import annotations

import errno
import json
import os
import secrets
import shutil
import threading
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO

import numpy as np
from numpy.typing import DTypeLike

from .algebra import ascending, ranks_in_runs
from .errors import BuildFailed, OutputFailed

StoreArray = Callable[[np.ndarray], np.ndarray]  # the same values, kept in another place
# One array of pieces, one after another; the second is empty, and has the type and the columns of all.
JoinPieces = Callable[[Iterable[np.ndarray], np.ndarray], np.ndarray]

ROWS_AT_ONCE = 1 << 16  # of an array that is taken piece by piece
_SAMPLE = 64  # rows of each part that say where it begins
_HEADER = 128  # bytes before an array in a file of NumPy
# NumPy reads headers with ast.literal_eval, in which threads disturb each other before CPython 3.11.5 (its
# issue 106905: "AST constructor recursion depth mismatch").
_READING_A_HEADER = threading.Lock()


def unchanged(array: np.ndarray) -> np.ndarray:
    """For callers that keep arrays in memory."""
    return array


class Rows:
    """An array that comes piece by piece. empty: without rows, with the type and the columns of all."""

    def __init__(self, empty: np.ndarray):
        self._empty = empty
        self._pieces: list[np.ndarray] = []

    def add(self, piece: np.ndarray) -> None:
        if len(piece):
            self._pieces.append(np.asarray(piece, self._empty.dtype))

    def array(self) -> np.ndarray:
        """All pieces, one after another."""
        pieces = self._pieces or [self._empty]
        return np.ascontiguousarray(pieces[0]) if len(pieces) == 1 else np.concatenate(pieces)


MakeRows = Callable[[np.ndarray], Rows]


def in_memory(pieces: Iterable[np.ndarray], empty: np.ndarray) -> np.ndarray:
    """Gathers pieces for callers that keep arrays in memory."""
    return _gathered(Rows(empty), pieces)


def _gathered(rows: Rows, pieces: Iterable[np.ndarray]) -> np.ndarray:
    for piece in pieces:
        rows.add(piece)
    return rows.array()


def in_pieces(array: np.ndarray) -> Iterator[np.ndarray]:
    """Rows of an array in pieces."""
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

    def __exit__(self, *_: object) -> None:
        self._files.clear()
        shutil.rmtree(self.folder, ignore_errors=True)

    def keep(self, array: np.ndarray) -> np.ndarray:
        """The array in a file, read-only; itself where it is in one, or empty."""
        if id(array) in self._files or not array.size:
            return array
        file = self._new_file()
        with _disk_errors(file):
            np.save(file, array)
            return self.opened(file)

    def rows(self, empty: np.ndarray) -> Rows:
        """Rows in a file, read-only in the end; the piece that comes is in memory."""
        return _MappedRows(empty, self._new_file(), self.opened)

    def gather(self, pieces: Iterable[np.ndarray], empty: np.ndarray) -> np.ndarray:
        """Gathers pieces in a file, read-only."""
        return _gathered(self.rows(empty), pieces)

    def ascending(self, rows: np.ndarray) -> np.ndarray:
        """(N,) the numbers of rows (N, K) in ascending order, as of algebra.ascending, in a file: they go
        into parts by their first columns, each of which is sorted in memory."""
        if len(rows) <= ROWS_AT_ONCE:
            return ascending(*rows.T)
        sample = np.sort(rows[:: ROWS_AT_ONCE // _SAMPLE, 0])
        bounds = np.unique(sample[_SAMPLE // 2 :: _SAMPLE])
        sizes = np.zeros(len(bounds) + 1, np.int64)
        for piece in in_pieces(rows):
            sizes += np.bincount(np.searchsorted(bounds, piece[:, 0], "right"), minlength=len(sizes))
        order, ends = self.zeros((len(rows),), np.int64), np.cumsum(sizes)
        free, first = ends - sizes, 0
        for piece in in_pieces(rows):
            part = np.searchsorted(bounds, piece[:, 0], "right")
            into = np.argsort(part, kind="stable")
            count = np.bincount(part, minlength=len(sizes))
            order[np.repeat(free, count) + ranks_in_runs(count)] = first + into
            free, first = free + count, first + len(piece)
        for begin, end in zip(ends - sizes, ends, strict=True):
            numbers = order[begin:end]
            order[begin:end] = numbers[ascending(*rows[numbers].T)]
        return order

    def zeros(self, shape: tuple[int, ...], dtype: DTypeLike) -> np.ndarray:
        """Zeros in a file, for the caller to change."""
        file = self._new_file()
        with _disk_errors(file):
            array = np.lib.format.open_memmap(file, "w+", dtype, shape)
            _reserve(file)
            return array

    def _new_file(self) -> Path:
        return self.folder / f"{secrets.token_hex(8)}.npy"

    def place(self, array: np.ndarray) -> Path | np.ndarray:
        """A reference to an array for other processes: its file, or the array itself where it is empty."""
        stored = self.keep(array)
        return self._files[id(stored)][1] if stored.size else stored

    def opened(self, place: Path | np.ndarray) -> np.ndarray:
        """The array of such a reference."""
        if isinstance(place, np.ndarray):
            return place
        with _READING_A_HEADER:
            array = np.load(place, mmap_mode="r")
        self._files[id(array)] = array, place
        return array


class _MappedRows(Rows):
    """Rows in a file."""

    def __init__(self, empty: np.ndarray, file: Path, opened: Callable[[Path], np.ndarray]):
        super().__init__(empty)
        self._file, self._opened, self._count = file, opened, 0
        self._write(_header(empty.dtype, (0, *empty.shape[1:])), "wb")

    def add(self, piece: np.ndarray) -> None:
        if len(piece):
            self._count += len(piece)
            self._write(np.ascontiguousarray(piece, self._empty.dtype), "ab")

    def array(self) -> np.ndarray:
        self._write(_header(self._empty.dtype, (self._count, *self._empty.shape[1:])), "r+b")
        if self._count:
            return self._opened(self._file)
        with _disk_errors(self._file):
            self._file.unlink()
        return self._empty

    def _write(self, content: bytes | np.ndarray, mode: str) -> None:
        with _disk_errors(self._file), self._file.open(mode) as out:
            out.write(content)


@contextmanager
def _disk_errors(file: Path) -> Iterator[None]:
    """Raises OutputFailed, in one line, where the file of an array cannot be written or read."""
    try:
        yield
    except OutputFailed:
        raise
    except OSError as error:
        text = f"{file}: {error.strerror or error}; make room, or choose another folder"
        raise OutputFailed(text) from error


def _reserve(file: Path) -> None:
    """Allocates a file's space on the disk, so that a full disk is an error now. Later, when the mapped
    memory is written, it would be a fatal signal. Does nothing where the system or the disk cannot
    allocate."""
    if not hasattr(os, "posix_fallocate"):
        return
    with file.open("r+b") as opened:
        try:
            os.posix_fallocate(opened.fileno(), 0, file.stat().st_size)
        except OSError as error:
            if error.errno not in (errno.EINVAL, errno.ENOSYS, errno.EOPNOTSUPP):
                raise


def _header(dtype: np.dtype, shape: tuple[int, ...]) -> bytes:
    """The header of an array in a file of NumPy, format 1.0, padded to _HEADER bytes."""
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
    """The arrays of a file of write_mapped; changes of them stay in memory. Raises BuildFailed."""
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
