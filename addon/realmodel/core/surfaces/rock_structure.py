# SPDX-License-Identifier: GPL-3.0-or-later
"""A rock mass with faults: its compartments, the sheets of the surfaces of each, and the sides on which
points lie."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from ..base.errors import BuildWarning
from ..base.triangles import Sheet
from ..base.work import Work, native_module

if TYPE_CHECKING:
    from ..._native import Native


@dataclass(frozen=True, eq=False)
class FaultShape:
    """vertices (V, 3) float64 and triangles (T, 3) int32 of a fault. dies_out, ends, the faults that it ends
    at: how it is continued beyond its border."""

    vertices: np.ndarray
    triangles: np.ndarray
    dies_out: bool = False
    ends: tuple[FaultShape, ...] = ()

    def native(self) -> list[tuple]:
        """The arguments of the native module: the faults, and those at which each ends."""
        arguments = (self.vertices, self.triangles, False, list(range(1, 1 + len(self.ends))), self.dies_out)
        return [
            arguments,
            *((other.vertices, other.triangles, False, [], other.dies_out) for other in self.ends),
        ]

    @cached_property
    def prepared(self) -> Native.PreparedStructure:
        """What is asked for sides, made once."""
        return native_module().PreparedStructure(self.native())

    def __getstate__(self) -> dict[str, object]:
        return {name: value for name, value in vars(self).items() if name != "prepared"}


@dataclass(frozen=True)
class RockFaults:
    """The faults of one rock mass, each with its triangles.

    numbers: of the project's faults. youngest: of each the youngest surface that it displaces. ends: of each
    the faults at which it ends, (number in this list, the side of it that remains). dies_out: (F,) of bool.
    """

    names: list[str]
    shapes: list[FaultShape]
    youngest: list[int]
    dies_out: list[bool] = field(default_factory=list)
    numbers: list[int] = field(default_factory=list)
    ends: list[list[tuple[int, int]]] = field(default_factory=list)

    def __len__(self) -> int:
        return len(self.shapes)

    def order(self) -> list[int]:
        """Each fault after those at which it ends."""
        order: list[int] = []

        def visit(number: int) -> None:
            if number not in order:
                for other, _ in self.ends[number]:
                    visit(other)
                order.append(number)

        for number in range(len(self)):
            visit(number)
        return order

    def without_dropped(self, sides: np.ndarray) -> np.ndarray:
        """Rows (N, F) of sides with 0 where a branch is not there: beyond a fault at which it ends."""
        sides = sides.copy()
        for number in self.order():
            for other, side in self.ends[number]:
                sides[sides[:, other] == -side, number] = 0
        return sides

    def active(self, surface: int) -> np.ndarray:
        """(F,) bool: the faults that displace a surface."""
        return np.array([youngest >= surface for youngest in self.youngest], bool)


def fault_sides(work: Work, points: np.ndarray, shape: FaultShape) -> np.ndarray:
    """(N,) int8: +1 above a fault, -1 below it; beyond its border it is continued as the parts have it."""
    points = np.ascontiguousarray(points, np.float64)
    if not len(points):
        return np.zeros(0, np.int8)
    return work.native(shape.prepared.sides, points)


def sides_of(
    work: Work, points: np.ndarray, faults: RockFaults, asked: list[int] | None = None
) -> np.ndarray:
    """(N, F) int8 sides of all faults; 0 where a branch is not there. asked: only these are used, those at
    which they end among them; points count as above the others."""
    sides = np.ones((len(points), len(faults)), np.int8)
    for fault in range(len(faults)) if asked is None else asked:
        sides[:, fault] = fault_sides(work, points, faults.shapes[fault])
    return faults.without_dropped(sides)


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
