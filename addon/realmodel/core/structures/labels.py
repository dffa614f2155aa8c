# SPDX-License-Identifier: GPL-3.0-or-later
"""The compartments of a finished model: which one each cell is in, and what there is to tell of them."""

from __future__ import annotations

import numpy as np

from ..build_warning import BuildWarning
from .parts import Structures, compartment_names, compartment_of


def cell_compartments(
    inputs: list, built: dict, structures: Structures | None
) -> tuple[np.ndarray, list[str]]:
    """(C,) int32 the compartment of each cell, and the names of the compartments that have cells.

    A compartment lies on one side of each fault that divides its blocks: where faults die out their two sides
    are one compartment, and what is younger than a fault is not divided by it.
    """
    if structures is None:
        rock_of = np.repeat(np.arange(len(inputs)), [len(entry.surfaces) for entry in inputs])
        rows = rock_of[built["cell_block"]][:, None].astype(np.int32)
    else:
        sides = np.where(_dying(structures), 0, built["cell_sides"])
        rows = np.column_stack([built["cell_rock"], sides]).astype(np.int32)
    distinct, label = np.unique(rows, axis=0, return_inverse=True)
    faults = [] if structures is None else [fault.name for fault in structures.faults]
    names = compartment_names(faults, distinct[:, 1:])
    rocks = [inputs[number].rock.name for number in distinct[:, 0].tolist()]
    if len(inputs) > 1:
        names = [f"{rock}: {name}" if name else rock for rock, name in zip(rocks, names, strict=True)]
    else:
        names = [name or rock for rock, name in zip(rocks, names, strict=True)]
    return label.ravel().astype(np.int32), names


def _dying(structures: Structures) -> np.ndarray:
    return np.array([fault.dies_out for fault in structures.faults], bool)


def warnings_where_rock_is(inputs: list, built: dict, structures: Structures) -> list[BuildWarning]:
    """What there is to tell of compartments that hold rock."""
    found = []
    parts = np.unique(built["cell_part"]).tolist()
    for entry in inputs:
        held = {compartment_of(structures, entry, part) for part in parts}
        found += [warning for members, warning in entry.structure.warnings if held.intersection(members)]
    return found
