# SPDX-License-Identifier: GPL-3.0-or-later
"""What the tables of intervals have in their columns, grades or notes: stored in the row of the rock mass, to
be looked at; a build does not use it."""

import numpy as np

from ...core import RealModelError
from ...core.readers.tables.interval_values import IntervalValues
from ..host import caches
from ..objects import stored_arrays

_known = caches.new(most=8)  # by text
_PLACES = ("begins", "ends", "depths")
_COLUMN = "column:"


def add(row, values):
    """Adds IntervalValues to those of a rock mass, in place of those of the same holes and columns."""
    known = of_rock(row)
    if known is not None:
        again = np.isin(known.holes, values.holes)
        for name in known.columns.keys() - values.columns.keys():  # else it is of another table
            again &= ~known.has(name)
        values = IntervalValues.joined([known.some(~again), values])
    columns = {f"{_COLUMN}{name}": array for name, array in values.columns.items()}
    arrays = {name: getattr(values, name) for name in _PLACES}
    row.interval_values = stored_arrays.pack(holes=values.holes.astype(str), **arrays, **columns)


def of_rock(row):
    """The stored IntervalValues; None where there are none, or damaged text."""
    if not row.interval_values:
        return None
    if row.interval_values not in _known:
        _known[row.interval_values] = _read(row.interval_values)
    return _known[row.interval_values]


def _read(text):
    try:
        arrays = stored_arrays.unpack(text)
        columns = {name.removeprefix(_COLUMN): a for name, a in arrays.items() if name.startswith(_COLUMN)}
        return IntervalValues(arrays["holes"], *(arrays[name] for name in _PLACES), columns)
    except (RealModelError, KeyError):
        return None
