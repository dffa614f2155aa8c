# SPDX-License-Identifier: GPL-3.0-or-later
"""Values for other processes, their large arrays in files."""

from __future__ import annotations

import functools
import io
import pickle
from pathlib import Path
from typing import Any

import numpy as np

from ..core.base.mapped_arrays import MappedArrays

_LARGE = 1 << 16  # bytes of an array that goes as a file


def packed(value: object, arrays: MappedArrays) -> bytes:
    """A value with the files of large arrays instead of these. Raises OutputFailed."""
    content = io.BytesIO()
    _Packer(content, arrays).dump(value)
    return content.getvalue()


def unpacked(content: bytes, folder: Path) -> Any:
    """The value that was packed; its large arrays are read-only. folder: of the MappedArrays."""
    return _Unpacker(io.BytesIO(content), MappedArrays(folder)).load()


class _Packer(pickle.Pickler):
    def __init__(self, file: io.BytesIO, arrays: MappedArrays):
        super().__init__(file, pickle.HIGHEST_PROTOCOL)
        self._arrays = arrays

    def persistent_id(self, value: object) -> Path | np.ndarray | None:
        if not isinstance(value, np.ndarray) or value.nbytes < _LARGE or value.dtype.hasobject:
            return None
        return self._arrays.place(value)


class _Unpacker(pickle.Unpickler):
    def __init__(self, file: io.BytesIO, arrays: MappedArrays):
        super().__init__(file)
        self._opened = functools.cache(arrays.opened)

    def persistent_load(self, place: Path) -> np.ndarray:
        return self._opened(place)
