# SPDX-License-Identifier: GPL-3.0-or-later
"""Files that a vertical borehole is written to."""

from __future__ import annotations

import csv
import io
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import BinaryIO

from ..results.model_boreholes import Interval
from .endings import by_ending


def borehole_writer(path: str | Path) -> Callable[..., None]:
    """The function (model, intervals, file) that writes files of this ending. Raises UsageError."""
    return by_ending(path, {".csv": _write_csv}, "boreholes are not written as {}")


def _write_csv(model, found: Sequence[Interval], file: BinaryIO) -> None:
    """block (number), block_name, property, top and bottom (elevations) of each interval, from above."""
    text = io.StringIO(newline="")
    rows = csv.writer(text, lineterminator="\n")
    rows.writerow(["block", "block_name", "property", "top", "bottom"])
    for each in found:
        block = model.blocks[each.block]
        rows.writerow([each.block, block.name, block.property, repr(each.top), repr(each.bottom)])
    file.write(text.getvalue().encode("utf-8"))
