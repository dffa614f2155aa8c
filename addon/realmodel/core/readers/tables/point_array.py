# SPDX-License-Identifier: GPL-3.0-or-later
"""Points from an array of NumPy (.npy)."""

from __future__ import annotations

import tokenize
import warnings
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from ...base.errors import InputRefused
from ...base.mapped_arrays import JoinPieces, in_pieces

# Errors that NumPy raises for a damaged header, which it parses as Python.
_DAMAGED_ARRAY = (
    *(ValueError, OSError, EOFError, SyntaxError, TypeError),
    *(tokenize.TokenError, OverflowError, MemoryError, RecursionError),
)


def begins_as_array(head: bytes, _size: int = 0) -> bool:
    """Whether a file that begins so is an array of NumPy."""
    return head.startswith(b"\x93NUMPY")


def read_point_array(file: Path, gather: JoinPieces) -> np.ndarray:
    """(P, 3) float64 of an array of NumPy, rows without a height left out. Raises InputRefused."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of headers that Python 2 wrote; they are read right
            array = np.load(file, mmap_mode="r", allow_pickle=False)
    except _DAMAGED_ARRAY as error:
        raise InputRefused(f"a damaged array: {error}", file=file) from error
    if array.ndim != 2 or array.shape[1] != 3 or array.dtype.kind not in "iuf":
        what = f"an array of shape {array.shape} of {array.dtype} is not one of points (x, y, z in a row)"
        raise InputRefused(what, file=file)

    def known() -> Iterator[np.ndarray]:
        for piece in in_pieces(array):
            points = np.array(piece, np.float64)
            if not np.isfinite(points[:, :2]).all():
                raise InputRefused("a place in plan is not finite", file=file)
            yield points[np.isfinite(points[:, 2])]

    points = gather(known(), np.empty((0, 3)))
    if not len(points):
        raise InputRefused("no point of the array has a height", file=file)
    return points
