# SPDX-License-Identifier: GPL-3.0-or-later
"""Measures throw and heave along faults, at the cutoff lines of sheets: where a fault cuts a sheet off."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from ...base.algebra import dot, norm
from ...base.sheet import Sheet
from ...base.triangles import unit_normals
from ...base.work import Work, native_module, on_threads
from ...surfaces.rock_structure import RockStructure
from ...surfaces.sides import FaultShape, fault_sides
from .tips import crossed_edges
from .within import box_of, parts_of_lines, walls_of

_LEVEL = 1e-9  # of a unit normal: with less of it in plan a fault is level, and dips nowhere
_NOTHING = np.empty((0, 3)), np.empty(0), np.empty(0), np.empty(0)
_AT_ONCE = 1 << 21  # pairs of a place and a segment


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
    on_side = of_corners == side
    some = np.flatnonzero(on_side.any(axis=1))
    corners, on = vertices[crossed.triangles[some]], of_corners[some] == 0
    edges = crossed.edges[crossed.of_triangle[some]]
    begin, end = (vertices[edges[:, :, k]] for k in range(2))
    hits = begin + crossed.share[crossed.of_triangle[some], None] * (end - begin)
    met = np.concatenate([np.where(on[:, :, None], corners, np.nan), hits], axis=1)
    is_met = np.isfinite(met[:, :, 0])
    two = is_met.sum(axis=1) == 2
    ends = met[two][is_met[two]].reshape(-1, 2, 3)
    along = ends[:, 1, :2] - ends[:, 0, :2]
    weight = on_side[some][two]
    middle = (corners[two] * weight[:, :, None]).sum(axis=1) / weight.sum(axis=1)[:, None]
    inward = np.column_stack([-along[:, 1], along[:, 0]])
    facing = dot(inward, middle[:, :2] - ends[:, 0, :2])
    is_kept = facing != 0
    return Cutoff(ends[is_kept], (inward * np.sign(facing)[:, None])[is_kept])


class _Places:
    """The middles of the parts of a cutoff line that other faults leave.

    points: (N, 3); sides: (N, F) int8, of those faults; inward: (N, 2), as of the cutoff; length: (N,);
    across: (N, 2), the level direction in which the fault dips, of length 1."""

    def __init__(self, cutoff: Cutoff, shape: FaultShape, walls: np.ndarray, sides_of: Callable):
        begin, end = cutoff.ends.transpose(1, 0, 2)
        line, shares = parts_of_lines(begin, end, walls)
        along = (end - begin)[line]
        points = begin[line] + shares.mean(axis=1)[:, None] * along
        length = (shares[:, 1] - shares[:, 0]) * norm(along)
        corners = shape.vertices[shape.triangles]
        nearest, _ = native_module().nearest_triangles(corners, points, execution=on_threads(1))
        normals = unit_normals(corners)[nearest]
        level = norm(normals[:, :2])
        steep = level > _LEVEL
        self.points, self.length = points[steep], length[steep]
        self.inward = cutoff.inward[line][steep]
        self.across = normals[steep, :2] / level[steep, None]
        self.sides = sides_of(self.points)


class Measured:
    """Measures the displacement of one surface by one fault."""

    def __init__(self, work: Work, structure: RockStructure, fault: int, surface: int):
        self.work, self.structure, self.fault = work, structure, fault
        active = structure.faults.active(surface)
        self.others = [other for other in np.flatnonzero(active) if other != fault]
        self.rows = np.where(active, structure.compartments, 0)
        self.surface = surface
        self.cutoffs: dict[tuple[Sheet | None, int], Cutoff] = {}
        self.lower: dict[Sheet | None, _Places] = {}

    def everywhere(self) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """places (N, 3), throw, heave and length (N,)."""
        parts = [_NOTHING, *(self.between(*pair) for pair in self._pairs())]
        places, throw, heave, length = (np.concatenate(arrays) for arrays in zip(*parts, strict=True))
        return places, throw, heave, length

    def _pairs(self) -> list[tuple[int, int]]:
        """Compartments on the two sides of the fault, and on one side of each other that is on both sides of
        it; one of those that only faults part which do not displace the surface."""
        rows = self.rows
        pairs: dict[tuple[int, ...], tuple[int, int]] = {}
        for below in np.flatnonzero(rows[:, self.fault] < 0).tolist():
            for above in np.flatnonzero(rows[:, self.fault] > 0).tolist():
                same = (rows[below] == rows[above]) | (rows[below] == 0) | (rows[above] == 0)
                same[self.fault] = True
                if same.all():
                    pairs.setdefault((*rows[below].tolist(), *rows[above].tolist()), (below, above))
        return list(pairs.values())

    def between(self, below: int, above: int) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """As everywhere, of two compartments, whose sheets may be made after the others were measured."""
        upper = self._cutoff(above, 1)
        if not (len(upper.ends) and len(self._cutoff(below, -1).ends)):
            return _NOTHING
        places = self._places(below)
        place, points = _across(places, self._are_within(below, places.sides), upper)
        inside = self._are_within(above, self._sides(points))
        place, points = place[inside], points[inside]
        away = points - places.points[place]
        order = np.lexsort((dot(away, away), place))
        place, away = place[order], away[order]
        is_nearest = np.diff(place, prepend=-1) != 0
        place, away = place[is_nearest], away[is_nearest]
        heave = np.abs(dot(away[:, :2], places.across[place]))
        return places.points[place], -away[:, 2], heave, places.length[place]

    def _sheet(self, compartment: int) -> Sheet | None:
        return self.structure.sheets[compartment][self.surface]

    def _cutoff(self, compartment: int, side: int) -> Cutoff:
        sheet, shape = self._sheet(compartment), self.structure.faults.shapes[self.fault]
        key = sheet, side
        if key not in self.cutoffs:
            assert sheet is not None  # displacements are asked for of sheets that are made
            self.cutoffs[key] = cutoff_of(self.work, sheet, shape, side)
        return self.cutoffs[key]

    def _places(self, compartment: int) -> _Places:
        """On the cutoff line of a sheet below the fault."""
        key = self._sheet(compartment)
        if key not in self.lower:
            shapes, cutoff = self.structure.faults.shapes, self._cutoff(compartment, -1)
            walls = walls_of([shapes[other] for other in self.others], box_of(cutoff.ends))
            self.lower[key] = _Places(cutoff, shapes[self.fault], walls, self._sides)
        return self.lower[key]

    def _sides(self, points: np.ndarray) -> np.ndarray:
        """(N, F) int8 of the other faults."""
        shapes = self.structure.faults.shapes
        sides = [fault_sides(self.work, points, shapes[other]) for other in self.others]
        return np.array(sides, np.int8).reshape(len(self.others), len(points)).T

    def _are_within(self, compartment: int, sides: np.ndarray) -> np.ndarray:
        """(N,) bool of points with these sides of the other faults."""
        wanted = self.rows[compartment, self.others]
        return ((sides == wanted) | (wanted == 0)).all(axis=1)


def _across(places: _Places, some: np.ndarray, upper: Cutoff) -> tuple[np.ndarray, np.ndarray]:
    """Where the vertical planes across the fault, through some places (N,) bool, meet the cutoff line above
    it: the places' numbers (K,) and points (K, 3).

    The sheets on both sides lie on opposite sides of their cutoff lines. So where a fold or a low dip makes
    them meet the fault more than once, these are not taken for one another.
    """
    begin, end = upper.ends.transpose(1, 0, 2)
    numbers, points = [np.empty(0, np.int64)], [np.empty((0, 3))]
    chosen, count = np.flatnonzero(some), max(1, _AT_ONCE // max(1, len(begin)))
    for start in range(0, len(chosen), count):
        part = chosen[start : start + count]
        across = places.across[part]
        along = np.column_stack([-across[:, 1], across[:, 0]])
        offset = dot(along, places.points[part, :2])[:, None]
        first, last = (_products(along, corners) - offset for corners in (begin, end))
        inward = dot(across, places.inward[part])[:, None] * _products(across, upper.inward)
        row, segment = np.nonzero((first * last <= 0) & (first != last) & (inward < 0))
        share = first[row, segment] / (first[row, segment] - last[row, segment])
        numbers.append(part[row])
        points.append(begin[segment] + share[:, None] * (end - begin)[segment])
    return np.concatenate(numbers), np.concatenate(points)


def _products(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """(N, M) of vectors in plan, (N, 2) and (M, 2 or 3)."""
    return one[:, :1] * other[:, 0] + one[:, 1:] * other[:, 1]
