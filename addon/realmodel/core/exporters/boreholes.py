# SPDX-License-Identifier: GPL-3.0-or-later
"""Files that a vertical borehole, and a planned one, is written to."""

from __future__ import annotations

import csv
import io
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import BinaryIO

from ..cells.model_data import ModelData
from ..results.model_boreholes import Interval
from ..results.planned_holes import COLUMNS, PlannedHoleData, mean_share
from .endings import by_ending
from .shapes.parts import distinct_names


def borehole_writer(path: str | Path) -> Callable[..., None]:
    """The function (model, intervals, file) that writes files of this ending. Raises UsageError."""
    return by_ending(path, {".csv": _write_csv}, "boreholes are not written as {}")


def _write_csv(model: ModelData, found: Sequence[Interval], file: BinaryIO) -> None:
    """block (number), block_name, property, top and bottom (elevations) of each interval, from above."""
    text = io.StringIO(newline="")
    rows = csv.writer(text, lineterminator="\n")
    rows.writerow(["block", "block_name", "property", "top", "bottom"])
    for each in found:
        block = model.blocks[each.block]
        rows.writerow([each.block, block.name, block.property, repr(each.top), repr(each.bottom)])
    file.write(text.getvalue().encode("utf-8"))


def planned_hole_writer(path: str | Path) -> Callable[..., None]:
    """The function (hole, file) that writes files of this ending. Raises UsageError."""
    return by_ending(path, {".csv": _write_planned}, "planned holes are not written as {}")


def _write_planned(hole: PlannedHoleData, file: BinaryIO) -> None:
    """The rows of the hole; what is not known is empty. With an ensemble the probability of each block,
    averaged over the interval."""
    text = io.StringIO(newline="")
    rows = csv.writer(text, lineterminator="\n")
    found = hole.rows()
    blocks = [] if hole.probability is None else distinct_names(hole.block_names)
    rows.writerow([*COLUMNS, *(f"probability {name}" for name in blocks)])
    for row in found:
        values = [
            "" if value is None else repr(value) if isinstance(value, float) else value
            for value in row.values()
        ]
        if hole.probability is not None and hole.depths is not None:
            ends = row["from"], row["to"]
            values += [f"{mean_share(share, hole.depths, *ends):.9g}" for share in hole.probability.T]
        rows.writerow(values)
    file.write(text.getvalue().encode("utf-8"))
