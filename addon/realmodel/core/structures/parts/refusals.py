# SPDX-License-Identifier: GPL-3.0-or-later
"""Errors of the native module about faults and bodies, in the user's terms."""

from __future__ import annotations

from collections.abc import Sequence

from ...base.errors import InputRefused, number_list, place_text
from ...base.work import NativeError
from ...project.structure_entries import Body, Fault

_ADVICE = {
    "not_closed": "close its surface: each edge must belong to two triangles",
    "is_closed": "a closed surface is a body: write [[body]]",
    "one_sided": "cut it open where it returns to itself",
    "branching": "make a fault of its own of each branch, and set 'ends_at'",
    "folded": "make a fault of its own of each part of it that lies beside another one",
    "does_not_meet": "extend it to that fault, or take it out of 'ends_at'",
    "equal_halves": "make it longer on the side of that fault on which it is to remain",
    "open_cell": "move the fault or body that cuts there a little",
    "ends_inside": "extend it beyond the rock, set 'dies_out' or 'ends_at', or choose an older 'youngest'",
}


def ends_inside(fault: Fault, place: tuple[float, ...] | None) -> InputRefused:
    """The refusal of a fault whose border is inside the rock at a place; the caller raises it."""
    file, line = fault.shape_source()
    what = "it ends inside the rock that it displaces" + (f" near {place_text(place)}" if place else "")
    advice = _ADVICE["ends_inside"]
    return InputRefused(what, file=file, line=line, item=fault.item, advice=advice, place=place)


def refused_structure(error: NativeError, faults: Sequence[Fault], bodies: Sequence[Body]) -> InputRefused:
    """The refusal for a native InputError about structures; the caller raises it."""
    place = tuple(error.place) if error.place is not None else None
    near = f" near {place_text(place)}" if place else ""
    advice: str | None = _ADVICE.get(error.kind)
    if not 0 <= error.surface < len(faults) + len(bodies):
        return InputRefused(f"{error}{near}", advice=advice, place=place)
    fault = faults[error.surface] if error.surface < len(faults) else None
    entry = fault or bodies[error.surface - len(faults)]
    file, line = entry.shape_source()
    what, items = str(error), [int(number) for number in error.items]
    if error.kind == "does_not_meet" and items:
        what = f"it ends at fault '{faults[items[0]].name}', but does not meet it"
    elif error.kind == "equal_halves" and items:
        what = f"fault '{faults[items[0]].name}', at which it ends, cuts it into two halves of one area"
    elif error.kind == "ends_inside" and fault is not None and fault.dies_out:
        what = "beyond its tip the surfaces differ on its two sides"
        advice = "extend it, or give data beyond the tip that agree"
    elif error.kind == "ends_inside" and fault is not None:
        return ends_inside(fault, place)
    elif items:
        what = f"{what} (triangle{'s' if len(items) > 1 else ''} {number_list(items)})"
    return InputRefused(what + near, file=file, line=line, item=entry.item, advice=advice, place=place)
