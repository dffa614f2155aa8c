# SPDX-License-Identifier: GPL-3.0-or-later
"""Files that a vertical borehole, and a planned one, is written to."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from typing import BinaryIO

from ..base.text import Step
from ..cells.model_data import ModelData
from ..results.model_boreholes import Interval
from ..results.planned_holes import COLUMNS, PlannedHoleData, mean_share
from .shapes.parts import distinct_names


def write_borehole(borehole: tuple[ModelData, Sequence[Interval]], file: BinaryIO, _step: Step) -> None:
    """block (number), block_name, property, top and bottom (elevations) of each interval, from above."""
    model, intervals = borehole
    text = io.StringIO(newline="")
    rows = csv.writer(text, lineterminator="\n")
    rows.writerow(["block", "block_name", "property", "top", "bottom"])
    for interval in intervals:
        block = model.blocks[interval.block]
        ends = repr(interval.top), repr(interval.bottom)
        rows.writerow([interval.block, block.name, block.property, *ends])
    file.write(text.getvalue().encode("utf-8"))


def write_planned_hole(hole: PlannedHoleData, file: BinaryIO, _step: Step) -> None:
    """The rows of the hole; what is not known is empty. With an ensemble the probability of each block,
    averaged over the interval."""
    text = io.StringIO(newline="")
    rows = csv.writer(text, lineterminator="\n")
    intervals = hole.rows()
    blocks = [] if hole.probability is None else distinct_names(hole.block_names)
    rows.writerow([*COLUMNS, *(f"probability {name}" for name in blocks)])
    for row in intervals:
        values = [
            "" if value is None else repr(value) if isinstance(value, float) else value
            for value in row.values()
        ]
        if hole.probability is not None and hole.depths is not None:
            ends = row["from"], row["to"]
            values += [f"{mean_share(share, hole.depths, *ends):.9g}" for share in hole.probability.T]
        rows.writerow(values)
    file.write(text.getvalue().encode("utf-8"))
