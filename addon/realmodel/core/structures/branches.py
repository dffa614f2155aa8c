# SPDX-License-Identifier: GPL-3.0-or-later
"""Faults that end at others: which side remains, and whether they meet."""

from __future__ import annotations

import numpy as np

from ..errors import InputRefused, place_text
from ..work import Work
from .entries import Fault, fault_item
from .history import displaced_surfaces
from .sides import RockFaults, fault_sides
from .triangles import distances, divided, meet, open_edges

_TOUCHES = 1e-6  # of the extent of both faults: a border so near another fault reaches it
_PARTS = 40  # along the longer side of a fault, where its area is summed


def faults_of_rock(work: Work, project, faults: list[Fault], rock: int, threads: int = 0) -> RockFaults:
    """The faults that act in a rock mass. faults: those of the project, with arrays. Raises InputRefused for
    one that ends at a fault that it does not meet."""
    numbers = [n for n, fault in enumerate(faults) if rock in displaced_surfaces(project, fault)]
    here = [faults[n] for n in numbers]
    at = {fault.name: n for n, fault in enumerate(here)}
    ends = [
        [
            (at[name], _side_that_remains(work, fault, here[at[name]], threads))
            for name in fault.ends_at
            if name in at
        ]
        for fault in here
    ]
    return RockFaults(
        [fault.name for fault in here],
        [(fault.vertices, fault.triangles) for fault in here],
        [displaced_surfaces(project, fault)[rock] for fault in here],
        [fault.dies_out for fault in here],
        numbers,
        ends,
    )


def _side_that_remains(work: Work, branch: Fault, other: Fault, threads: int) -> int:
    """The side of `other` on which the larger part of the branch's area lies."""
    low = np.minimum(branch.vertices.min(axis=0), other.vertices.min(axis=0))
    high = np.maximum(branch.vertices.max(axis=0), other.vertices.max(axis=0))
    _require_meeting(branch, other, _TOUCHES * float(np.linalg.norm(high - low)))
    extent = np.ptp(branch.vertices[np.unique(branch.triangles)], axis=0).max()
    pieces = divided(branch.vertices, branch.triangles, extent / _PARTS)
    area = np.linalg.norm(np.cross(pieces[:, 1] - pieces[:, 0], pieces[:, 2] - pieces[:, 0]), axis=1)
    side = fault_sides(work, pieces.mean(axis=1), (other.vertices, other.triangles), threads)
    return 1 if area[side > 0].sum() >= area[side < 0].sum() else -1


def _require_meeting(branch: Fault, other: Fault, near: float) -> None:
    corners, others = branch.vertices[branch.triangles], other.vertices[other.triangles]
    if meet(corners, others).any():
        return
    border = np.unique(open_edges(branch.vertices, branch.triangles))
    places = branch.vertices[border] if len(border) else branch.vertices
    away = distances(places, other.vertices, other.triangles)
    if away.min() <= near:
        return
    place = places[int(away.argmin())]
    source = branch.source
    raise InputRefused(
        f"it ends at fault '{other.name}', but does not meet it: the nearest it comes is {away.min():.6g} at "
        f"{place_text(place)}",
        file=source.document.file if source else branch.shape_file,
        line=source.line("ends_at") if source else None,
        item=fault_item(branch),
        advice="extend it to that fault, or take it out of 'ends_at'",
        place=tuple(place.tolist()),
    )
