# SPDX-License-Identifier: GPL-3.0-or-later
"""The compartments of a finished model: the one of each cell, and the warnings about them."""

from __future__ import annotations

import numpy as np

from ..base.errors import BuildWarning
from ..structures.parts.parts import Structures, compartment_names, compartment_of
from .built_cells import BuiltCells, CellParts


def compartments(
    inputs: list, own: CellParts, structures: Structures
) -> tuple[np.ndarray, list[str], np.ndarray]:
    """Of cells in parts (C,) int32 the compartment of each, the names of the compartments that have cells,
    and (N, F) int8 the side of each fault that they lie on, 0 where it does not divide them.

    A compartment lies on one side of each fault that divides its blocks: where faults die out their two sides
    are one compartment, and what is younger than a fault is not divided by it.
    """
    rock_of, block, part = own.rock, own.own_block, own.part
    parts = len(structures.sides)
    kind = block.astype(np.int64) * parts + part
    has_cells = np.bincount(kind, minlength=1) > 0
    kinds = np.flatnonzero(has_cells)
    block, part = kinds // parts, kinds % parts
    count = len(structures.faults)
    divides = own.divided[:count].astype(bool) & ~_dying(structures)[:, None]
    sides = np.where(divides.T[block], structures.sides[part, :count], 0)
    rows = np.column_stack([rock_of[block], sides]).astype(np.int32)
    distinct, label = np.unique(rows, axis=0, return_inverse=True)
    label = label.ravel()[(np.cumsum(has_cells) - 1)[kind]]
    names = compartment_names([fault.name for fault in structures.faults], distinct[:, 1:])
    rocks = [inputs[number].rock.name for number in distinct[:, 0].tolist()]
    if len(inputs) > 1:
        names = [f"{rock}: {name}" if name else rock for rock, name in zip(rocks, names, strict=True)]
    else:
        names = [name or rock for rock, name in zip(rocks, names, strict=True)]
    return label.astype(np.int32), names, distinct[:, 1:].astype(np.int8)


def _dying(structures: Structures) -> np.ndarray:
    return np.array([fault.dies_out for fault in structures.faults], bool)


def warnings_where_rock_is(inputs: list, built: BuiltCells, structures: Structures) -> list[BuildWarning]:
    """The warnings about compartments that hold rock."""
    warnings = []
    for entry in (entry for entry in inputs if entry.divided().warnings):
        parts = np.unique(built.parts.part).tolist()
        held = {compartment_of(structures, entry, part) for part in parts}
        warnings += [warning for members, warning in entry.divided().warnings if held.intersection(members)]
    return warnings
