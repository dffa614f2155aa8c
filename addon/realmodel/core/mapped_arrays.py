# SPDX-License-Identifier: GPL-3.0-or-later
"""Arrays in files, of which the system keeps in memory what is used."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np

from .errors import OutputFailed

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
