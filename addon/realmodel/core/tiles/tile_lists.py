# SPDX-License-Identifier: GPL-3.0-or-later
"""What is divided among tiles, piece by piece."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np

from ..base.atomic import explained

Name = tuple[int, int]  # column and row of a tile


class TileLists:
    """Rows for each tile that come piece by piece, in files of the tiles' folders that are gone in the end.
    empty: without rows, with their type. Raises OutputFailed."""

    def __init__(self, folder_of: Callable[[Name], Path], name: str, empty: np.ndarray):
        self._file_of = lambda tile: folder_of(tile) / f"{name}.rows"
        self._empty = empty
        self._begun: set[Name] = set()

    def __enter__(self) -> TileLists:
        return self

    def __exit__(self, *_: object) -> None:
        for name in self._begun:
            self._file_of(name).unlink(missing_ok=True)

    @property
    def tiles(self) -> list[Name]:
        """Those that have some, column after column."""
        return sorted(self._begun)

    def add(self, name: Name, rows: np.ndarray) -> None:
        path = self._file_of(name)
        with explained(path), path.open("ab" if name in self._begun else "wb") as file:
            self._begun.add(name)
            file.write(np.ascontiguousarray(rows, self._empty.dtype))

    def of(self, name: Name) -> np.ndarray:
        path = self._file_of(name)
        with explained(path):
            return np.fromfile(path, self._empty.dtype).reshape(-1, *self._empty.shape[1:])
