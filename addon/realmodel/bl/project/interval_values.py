# SPDX-License-Identifier: GPL-3.0-or-later
"""What the tables of intervals have in their columns, grades or notes: stored in the row of the rock mass, to
be looked at; a build does not use it."""

import numpy as np

from ...core import RealModelError
from ...core.readers.tables.interval_values import IntervalValues
from ..host import caches

_known = caches.new(most=8)  # by digest
_PLACES = ("begins", "ends", "depths")
_COLUMN = "column"  # and its number: names of properties are short


def add(row, values):
    """Adds IntervalValues to those of a rock mass, in place of those of the same holes and columns."""
    earlier = of_rock(row)
    if earlier is not None:
        again = np.isin(earlier.holes, values.holes)
        for name in earlier.columns.keys() - values.columns.keys():  # else it is of another table
            again &= ~earlier.has(name)
        values = IntervalValues.joined([earlier.some(~again), values])
    row.interval_values = {
        "holes": values.holes.astype(str),
        **{name: getattr(values, name) for name in _PLACES},
        "columns": np.array(list(values.columns), str),
        **{f"{_COLUMN}{number}": array for number, array in enumerate(values.columns.values())},
    }


def of_rock(row):
    """The stored IntervalValues; None where there are none, or damaged arrays."""
    if not row.interval_values:
        return None
    digest = row.interval_values.digest
    if digest not in _known:
        _known[digest] = _read(row.interval_values)
    return _known[digest]


def of_scene(scene):
    """Those of all rock masses of a scene; None where there are none."""
    parts = [values for rock in scene.realmodel.rocks if (values := of_rock(rock)) is not None]
    return IntervalValues.joined(parts) if parts else None


def _read(arrays):
    try:
        names = arrays["columns"].tolist()
        columns = {name: arrays[f"{_COLUMN}{number}"] for number, name in enumerate(names)}
        return IntervalValues(arrays["holes"], *(arrays[name] for name in _PLACES), columns)
    except (RealModelError, KeyError):
        return None
