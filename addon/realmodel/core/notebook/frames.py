# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables as DataFrames of pandas."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

from ..base.packages import extra

if TYPE_CHECKING:
    import pandas


def data_frame(rows: Iterable[dict], columns: Sequence[str] | None = None) -> pandas.DataFrame:
    """A row for each dict. columns: their names in order, also where there are no rows; None: as in the rows.

    Raises UsageError where pandas is missing.
    """
    return extra("pandas", "a table").DataFrame(list(rows), columns=columns)
