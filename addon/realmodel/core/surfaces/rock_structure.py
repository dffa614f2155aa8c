# SPDX-License-Identifier: GPL-3.0-or-later
"""A rock mass with faults: its compartments, and of each the sheets of the surfaces."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from ..base.build_warning import BuildWarning
from ..base.sheet import Sheet
from .sides import RockFaults


@dataclass(frozen=True)
class Steps:
    """Of a surface whose compartments differ by steps alone: heights (F,), by how much it lies higher above
    each fault than below it, 0 where no step is found, NaN where its data do not show one; deviations: (F,)
    their standard deviations."""

    heights: np.ndarray
    deviations: np.ndarray


@dataclass
class RockStructure:
    """compartments: (C, F) int8, the side of each fault, 0 where a branch is not there; names: of the
    compartments. sheets: for each compartment one triangulation of each surface, the same object where
    compartments share it; None until it is made. warnings: (compartments, warning); reported if one of the
    compartments holds rock. few: the surfaces of which no compartment has enough points. points: of
    interpolated surfaces (P, F) int8, the sides of their points. steps: of surfaces that are fitted on both
    sides of faults together; None until they are."""

    faults: RockFaults
    compartments: np.ndarray
    names: list[str]
    sheets: list[list[Sheet | None]]
    warnings: list[tuple[list[int], BuildWarning]] = field(default_factory=list)
    few: list[int] = field(default_factory=list)
    points: dict[int, np.ndarray] = field(default_factory=dict)
    steps: dict[int, Steps] | None = None

    def sheet(self, compartment: int, surface: int) -> Sheet:
        """The sheet of a surface in a compartment, once it is made."""
        sheet = self.sheets[compartment][surface]
        assert sheet is not None
        return sheet

    def of_compartment(self, compartment: int) -> list[Sheet]:
        """The sheets of all surfaces in a compartment, once they are made."""
        return [self.sheet(compartment, number) for number in range(len(self.sheets[compartment]))]

    def is_made(self, surface: int) -> bool:
        """Whether a surface has all its sheets; no for one younger than the stage."""
        return all(sheets[surface] is not None for sheets in self.sheets)

    def distinct(self, surface: int) -> list[Sheet]:
        """The different sheets of a surface that is made, in the order of the compartments that they first
        serve."""
        sheets = (self.sheet(compartment, surface) for compartment in range(len(self.sheets)))
        return list(dict.fromkeys(sheets))

    def warn(self, compartments: list[int], warning: BuildWarning) -> None:
        """Adds a warning about some compartments, unless it is there already."""
        name = self.names[compartments[0]]
        text = f"in compartment '{name}': {warning.text}" if name else warning.text
        warning = replace(warning, text=text)
        if all(warning != other for _, other in self.warnings):
            self.warnings.append((compartments, warning))

    def stage(self, m: int) -> RockStructure:
        """The structure with the surfaces up to m."""
        return replace(
            self,
            sheets=[sheets[: m + 1] for sheets in self.sheets],
            faults=replace(self.faults, youngest=[min(youngest, m) for youngest in self.faults.youngest]),
        )


def joined(sheets: list[Sheet]) -> Sheet:
    """Sheets as one triangulation: their vertices one after another, and their triangles."""
    if len(sheets) == 1:
        return sheets[0]
    first = np.cumsum([0, *(len(vertices) for vertices, _ in sheets[:-1])], dtype=np.int32)
    return Sheet(
        np.concatenate([vertices for vertices, _ in sheets]),
        np.concatenate([triangles + begin for (_, triangles), begin in zip(sheets, first, strict=True)]),
    )
