# SPDX-License-Identifier: GPL-3.0-or-later
"""Cutoff lines: where a fault cuts a sheet off."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ...base.algebra import dot
from ...base.sheet import Sheet
from ...base.work import Work
from ...surfaces.sides import FaultShape
from .tips import crossed_edges


class Cutoff(NamedTuple):
    """The line along which a fault cuts off the part of a sheet on one side of it. ends: (S, 2, 3) of its
    segments; inward: (S, 2), at right angles to each in plan, into that part."""

    ends: np.ndarray
    inward: np.ndarray


def cutoff_of(work: Work, sheet: Sheet, fault: FaultShape, side: int) -> Cutoff:
    """The cutoff line of a sheet on one side (-1 or +1) of a fault.

    It is the border of what of the sheet's triangles lies on that side. So where the sheet goes on beyond it
    in the fault itself, as where it bridges a bay of its own cutoff line, nothing else counts.
    """
    vertices = sheet.vertices
    crossed = crossed_edges(work, sheet, fault)
    of_corners = crossed.side[crossed.triangles]
    own = of_corners == side
    some = np.flatnonzero(own.any(axis=1))
    corners, on = vertices[crossed.triangles[some]], of_corners[some] == 0
    edges = crossed.edges[crossed.of_triangle[some]]
    begin, end = (vertices[edges[:, :, k]] for k in range(2))
    hits = begin + crossed.share[crossed.of_triangle[some], None] * (end - begin)
    met = np.concatenate([np.where(on[:, :, None], corners, np.nan), hits], axis=1)
    known = np.isfinite(met[:, :, 0])
    two = known.sum(axis=1) == 2
    ends = met[two][known[two]].reshape(-1, 2, 3)
    along = ends[:, 1, :2] - ends[:, 0, :2]
    weight = own[some][two]
    middle = (corners[two] * weight[:, :, None]).sum(axis=1) / weight.sum(axis=1)[:, None]
    inward = np.column_stack([-along[:, 1], along[:, 0]])
    facing = dot(inward, middle[:, :2] - ends[:, 0, :2])
    kept = facing != 0
    return Cutoff(ends[kept], (inward * np.sign(facing)[:, None])[kept])
