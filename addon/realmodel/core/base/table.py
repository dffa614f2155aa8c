# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables of data that were read: arrays by the names of columns."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from .packages import extra

if TYPE_CHECKING:
    import pandas


class Table(Mapping[str, np.ndarray]):
    """(N,) arrays of numbers or texts by the names of columns: table["hole"]. Its length is that of its
    columns. Numbers that are not known are NaN, texts "".

    Raises ValueError where the columns have different lengths.
    """

    def __init__(self, columns: Mapping[str, ArrayLike]):
        self._columns = {name: np.asarray(values) for name, values in columns.items()}
        lengths = {len(values) for values in self._columns.values()}
        if len(lengths) > 1:
            raise ValueError(f"columns of different lengths: {sorted(lengths)}")
        self._length = lengths.pop() if lengths else 0

    def __getitem__(self, name: str) -> np.ndarray:
        return self._columns[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._columns)

    def __len__(self) -> int:
        return self._length

    def __bool__(self) -> bool:
        return self._length > 0

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Table):
            return NotImplemented
        return list(self) == list(other) and all(
            np.array_equal(self[name], other[name], equal_nan=self[name].dtype.kind == "f") for name in self
        )

    __hash__ = None  # type: ignore[assignment]  # its arrays can change

    def __repr__(self) -> str:
        return f"<Table: {len(self)} rows of {', '.join(self)}>"

    def some(self, chosen: np.ndarray) -> Table:
        """Some of the rows. chosen: (N,) bool, or numbers of rows."""
        return Table({name: values[chosen] for name, values in self._columns.items()})

    def to_pandas(self) -> pandas.DataFrame:
        """A DataFrame. Raises UsageError where pandas is missing."""
        return extra("pandas", "a table").DataFrame(self._columns)
