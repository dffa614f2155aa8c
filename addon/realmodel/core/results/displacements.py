# SPDX-License-Identifier: GPL-3.0-or-later
"""Throw and heave: the displacement of surfaces along each fault."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..base.work import Work, run
from ..cells.model_data import ModelData
from ..structures.sheets.throws import Measured
from ..surfaces.rock_structure import RockStructure


@dataclass(frozen=True)
class Displacement:
    """Of one surface along one fault, at places (N, 3) on the cutoff line of its sheet below the fault: throw
    and heave (N,), model units. Throw is how much lower the upper side lies: positive at a normal fault,
    negative at a reverse one. Heave is how far its edge is from that of the lower side in plan. Both are
    measured across the fault: in the vertical plane through the place and the direction in which the fault
    dips there. length: (N,) of the part of the cutoff line that each place is the middle of. deviation: the
    standard deviation of the throw that contacts on both sides show together, None if each side was made
    separately. is_found: no if the throw is smaller than that; the surface then crosses the fault."""

    fault: str
    rock: str
    surface: str
    places: np.ndarray
    throw: np.ndarray
    heave: np.ndarray
    length: np.ndarray
    deviation: float | None = None
    is_found: bool = True

    @property
    def mean_throw(self) -> float:
        """Along the cutoff line."""
        return _mean(self.throw, self.length)

    @property
    def mean_heave(self) -> float:
        """Along the cutoff line."""
        return _mean(self.heave, self.length)


def _fitted(structure: RockStructure, surface: int, fault: int) -> tuple[float | None, bool]:
    """deviation and is_found of a Displacement."""
    steps = (structure.steps or {}).get(surface)
    if steps is None or np.isnan(steps.heights[fault]):
        return None, True
    return float(steps.deviations[fault]), bool(steps.heights[fault] != 0.0)


def _mean(values: np.ndarray, length: np.ndarray) -> float:
    return float((values * length).sum() / length.sum())


def displacements(model: ModelData, only: str | None = None) -> list[Displacement]:
    """The displacements of each fault of a model, or of the one of a name, for each surface that it displaces
    where it meets it."""
    return run(lambda work: _displacements(work, model, only), threads=model.threads)


def _displacements(work: Work, model: ModelData, only: str | None) -> list[Displacement]:
    measurements = []
    for number, fault in enumerate(model.structures.faults):
        if only not in (None, fault.name):
            continue
        for entry in model.rock_inputs:
            structure = entry.structure
            if structure is None or number not in structure.faults.numbers:
                continue
            at = structure.faults.numbers.index(number)
            for k in range(min(structure.faults.youngest[at], len(entry.surfaces) - 1) + 1):
                measured = Measured(work, structure, at, k).everywhere()
                if len(measured[0]):
                    name = entry.rock.surfaces[k].name
                    fitted = _fitted(structure, k, at)
                    measurements.append(Displacement(fault.name, entry.rock.name, name, *measured, *fitted))
    return measurements
