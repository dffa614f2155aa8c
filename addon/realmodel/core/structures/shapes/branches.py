# SPDX-License-Identifier: GPL-3.0-or-later
"""Faults that end at other faults, and the check that they meet them."""

from __future__ import annotations

import numpy as np

from ...base.algebra import norm
from ...base.errors import InputRefused, place_text
from ...base.triangles import meet, open_edges
from ...base.work import native_module, on_threads
from ...project.structure_entries import Fault

_TOUCHES = 1e-6  # of the extent of both faults: a border so near another fault reaches it


def require_meeting(fault: Fault, ends: list[Fault]) -> None:
    """Refuses a fault that does not meet those at which it ends. All have arrays. Raises InputRefused."""
    for other in ends:
        nearest = nearest_to_meet(fault, other)
        if nearest is not None:
            raise _does_not_meet(fault, other, *nearest)


def nearest_to_meet(branch: Fault, other: Fault) -> tuple[np.ndarray, float] | None:
    """Where the border of a fault comes nearest to another one, and how near; None where they meet."""
    (vertices, triangles), (of_other, others) = branch.triangulation(), other.triangulation()
    if meet(vertices[triangles], of_other[others]).any():
        return None
    border = np.unique(open_edges(vertices, triangles))
    places = vertices[border] if len(border) else vertices
    _, away = native_module().nearest_triangles(of_other[others], places, execution=on_threads(1))
    nearest = int(away.argmin())
    near = _TOUCHES * float(norm(np.ptp(np.concatenate([vertices, of_other]), axis=0)))
    return None if away[nearest] <= near else (places[nearest], float(away[nearest]))


def _does_not_meet(branch: Fault, other: Fault, place: np.ndarray, away: float) -> InputRefused:
    source = branch.source
    return InputRefused(
        f"it ends at fault '{other.name}', but does not meet it: the nearest it comes is {away:.6g} at "
        f"{place_text(place)}",
        file=source.document.file if source else branch.shape_file,
        line=source.line("ends_at") if source else None,
        item=branch.item,
        advice="extend it to that fault, or take it out of 'ends_at'",
        place=tuple(place.tolist()),
    )
