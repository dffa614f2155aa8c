# SPDX-License-Identifier: GPL-3.0-or-later
"""Rows of numbers as text, many at a time."""

from __future__ import annotations

from collections.abc import Callable
from typing import BinaryIO

import numpy as np

_AT_ONCE = 50_000


def write_rows(
    file: BinaryIO,
    form: str,
    *columns: np.ndarray,
    ends: str = "\n",
    step: Callable[[float], None] | None = None,
) -> None:
    """Writes a line a row. form: of the whole row, as of the operator %, "%r" for the shortest number that is
    the same float64. columns: arrays (N,) or (N, K), side by side. step(share) is called now and then, last
    with 1."""
    count = len(columns[0])
    line = form + ends
    for begin in range(0, count, _AT_ONCE):
        cells = []
        for column in columns:
            values = column[begin : begin + _AT_ONCE]
            cells += [values.tolist()] if values.ndim == 1 else [part.tolist() for part in values.T]
        rows = min(_AT_ONCE, count - begin)
        flat = [None] * (rows * len(cells))
        for place, values in enumerate(cells):
            flat[place :: len(cells)] = values
        file.write((line * rows % tuple(flat)).encode("utf-8"))
        if step is not None:
            step((begin + rows) / count)


def write_wrapped(file: BinaryIO, form: str, values: np.ndarray, a_line: int) -> None:
    """Writes values (N,), so many on a line. form: of each."""
    whole = len(values) // a_line * a_line
    write_rows(file, form * a_line, values[:whole].reshape(-1, a_line))
    if whole < len(values):
        write_rows(file, form * (len(values) - whole), values[None, whole:])
