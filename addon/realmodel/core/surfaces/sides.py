# SPDX-License-Identifier: GPL-3.0-or-later
"""The sides of the faults of a rock mass on which points lie, and the faults that exist there."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from ..base.work import Work, native_module


class FaultShape(NamedTuple):
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
    return work.native(native_module().structure_sides, shape.native(), points)


def sides_of(
    work: Work, points: np.ndarray, faults: RockFaults, asked: list[int] | None = None
) -> np.ndarray:
    """(N, F) int8 sides of all faults; 0 where a branch is not there. asked: only these are looked at, those
    at which they end among them; points count as above the others."""
    sides = np.ones((len(points), len(faults)), np.int8)
    for fault in range(len(faults)) if asked is None else asked:
        sides[:, fault] = fault_sides(work, points, faults.shapes[fault])
    return faults.without_dropped(sides)
