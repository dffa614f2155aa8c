# SPDX-License-Identifier: GPL-3.0-or-later
"""The throws of faults: as the surfaces show them, and measured at the cutoff lines of sheets."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from ...base.algebra import dot, norm, principal_axes
from ...base.triangles import Sheet, unit_normals
from ...base.work import Work, native_module, on_threads
from ...surfaces.rock_structure import FaultShape, RockStructure, fault_sides
from ...surfaces.wrong_sides import PlacesOnSheet, heights_at
from .families import CompartmentTest, Family, box_of, parts_of_lines, walls_of
from .tips import crossed_edges, shared

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

    It is the border of what of the sheet's triangles lies on that side. So where the sheet continues beyond
    it in the fault itself, as where it bridges a bay of its own cutoff line, nothing else counts.
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
            assert sheet is not None  # displacements are requested of sheets that are made
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


OWN, FEW, TAKEN, UNKNOWN = range(4)  # what a sheet is made of: enough points, few, or no data; the worse last
_STRETCHES = 8  # of a fault along its strike at most, in each of which the median counts
_IN_EACH = 5  # places at least
_OUTLIERS = 0.05  # of values, at either end, that do not count

# the number of a surface, and places (N, 3) on a fault with its throw (N,) there
Known = tuple[int, np.ndarray, np.ndarray]
Sheets = dict[tuple[int, ...], Sheet]  # of a family, by the sides of faults that die out


class Profile:
    """Values along a fault: between the middles of its stretches linear, beyond them constant."""

    def __init__(self, plan: np.ndarray, values: np.ndarray):
        """plan: (N, 2), values: (N,)."""
        self.plan = plan
        self.origin, self.axis = plan.mean(axis=0), principal_axes(plan)[1][0]
        along = self._along(plan)
        order = np.argsort(along, kind="stable")
        parts = np.array_split(order, min(max(len(plan) // _IN_EACH, 1), _STRETCHES))
        self.along = np.array([along[part].mean() for part in parts])
        self.middles = np.array([plan[part].mean(axis=0) for part in parts])
        self.values = np.array([np.median(values[part]) for part in parts])

    def _along(self, plan: np.ndarray) -> np.ndarray:
        return dot(plan - self.origin, self.axis)

    def at(self, plan: np.ndarray) -> np.ndarray:
        """(N,) at places (N, 2): the same bytes on every system, as those of np.interp are not."""
        along = np.clip(self._along(plan), self.along[0], self.along[-1])
        after = np.clip(np.searchsorted(self.along, along), 1, max(len(self.along) - 1, 1))
        if len(self.along) == 1:
            return np.full(len(plan), self.values[0])
        low, high = self.along[after - 1], self.along[after]
        share = (along - low) / np.where(high > low, high - low, 1.0)
        return (1.0 - share) * self.values[after - 1] + share * self.values[after]


@dataclass(frozen=True)
class Shift:
    """A sum of profiles, each with a factor: heights to be added to a sheet. surfaces: the numbers of those
    whose throw it is; rank: what their sheets are made of."""

    terms: tuple[tuple[float, Profile], ...]
    surfaces: tuple[int, ...]
    rank: int

    def at(self, plan: np.ndarray) -> np.ndarray:
        total = np.zeros(len(plan))
        for factor, profile in self.terms:
            total = total + factor * profile.at(plan)
        return total

    @property
    def places(self) -> np.ndarray:
        """(N, 2) along the fault, at which it was measured."""
        return np.concatenate([profile.plan for _, profile in self.terms])

    @property
    def middles(self) -> np.ndarray:
        """(N, 2) of the stretches in which it was measured."""
        return np.concatenate([profile.middles for _, profile in self.terms])


class Throws:
    """The throws of a rock mass's faults, measured between existing sheets, and given ones. few: the surfaces
    of those that are there which few points show."""

    def __init__(self, work: Work, structure: RockStructure, few: list[int]):
        self.work = work
        self.structure = replace(structure, sheets=[list(sheets) for sheets in structure.sheets])
        is_made = [[sheet is not None for sheet in sheets] for sheets in structure.sheets]
        self.rank = np.where(is_made, OWN, UNKNOWN)
        self.rank[:, few] = FEW
        self._measures: dict[tuple[int, int], Measured] = {}  # by surface and fault
        self._known: dict[tuple, tuple[np.ndarray, np.ndarray] | None] = {}
        self._places: dict[tuple[int, int], PlacesOnSheet] = {}  # of vertices of one surface on another one

    def add(self, number: int, family: Family, sheets: Sheets, rank: int) -> None:
        """The sheets of a surface in a family."""
        for compartment, sides in family.members.items():
            self.structure.sheets[compartment][number] = sheets[sides]
            self.rank[compartment, number] = rank

    @staticmethod
    def fault_between(one: Family, other: Family) -> int | None:
        """The fault on whose two sides two families are, each on one side of every other fault that is on
        both sides of it; None where there is none, or several."""
        apart = [fault for fault, (a, b) in enumerate(zip(one.key, other.key, strict=True)) if a * b == -1]
        return apart[0] if len(apart) == 1 else None

    def shift(self, number: int, fault: int, source: Family, family: Family) -> Shift | None:
        """The shift of a surface from one family to another one across a fault, by the throw of the surfaces
        next in age, older and younger, on which it is known. Between these two it is as the surface lies
        between them, by thickness. None where it is known on none."""
        pairs = self._pairs(fault, source, family)
        for limit in (OWN, FEW, TAKEN):
            youngest = self.structure.faults.youngest[fault]
            older = self._first(range(number - 1, -1, -1), fault, pairs, limit)
            younger = self._first(range(number + 1, youngest + 1), fault, pairs, limit)
            if older is not None or younger is not None:
                break
        else:
            return None
        down = float(source.key[fault])  # throw is how much lower the upper side lies
        neighbors = [neighbor for neighbor in (older, younger) if neighbor is not None]
        shares = [1.0]
        if len(neighbors) == 2:
            share = self._share(source, number, *neighbors)
            shares = [1.0 - share, share]
        profiles = [Profile(places[:, :2], throw) for _, places, throw in neighbors]
        terms = tuple((down * share, profile) for share, profile in zip(shares, profiles, strict=True))
        return Shift(terms, tuple(neighbor[0] for neighbor in neighbors), limit)

    def by_thickness(
        self, number: int, shift: Shift, fault: int, source: Family, family: Family, sheets: Sheets
    ) -> Sheets:
        """Sheets of a surface, as they are in `source`, shifted to be those of a family across a fault: by
        what the surfaces of the shift differ in height on its two sides, everywhere.

        So its thickness from one of these is that of the source; between two it is the share of theirs.
        """
        within = CompartmentTest(self.work, self.structure, number, source)
        pairs = [
            pair if pair[0] in family.members else pair[::-1] for pair in self._pairs(fault, source, family)
        ]
        pairs = [pair for pair in pairs if all(self._has(pair, other) for other in shift.surfaces)]
        laid: Sheets = {}
        for compartment, sides in family.members.items():
            if sides not in laid:
                vertices, triangles = sheets[sides]
                z = vertices[:, 2] + shift.at(vertices[:, :2])
                if pairs:
                    here, across = next((pair for pair in pairs if pair[0] == compartment), pairs[0])
                    laid_on = self._projected(
                        number, vertices, within(vertices), shift.surfaces, here, across
                    )
                    z = np.where(np.isfinite(laid_on), laid_on, z)
                laid[sides] = Sheet(np.column_stack([vertices[:, :2], z]), triangles)
        return shared(laid)

    def heights_at(self, number: int, plan: np.ndarray, other: int, sheet: Sheet) -> np.ndarray:
        """(V,) heights of a sheet of any surface at the vertices of one of surface `number`, whose sheets
        mostly have one plan."""
        places = self._places.get((number, other))
        if places is None or not (sheet.has_plan_of(places.sheet) and np.array_equal(plan, places.plan)):
            places = self._places[number, other] = PlacesOnSheet.of(self.work, sheet, plan)
        return places.heights(sheet)

    def _has(self, pair: tuple[int, int], number: int) -> bool:
        """Whether a surface has sheets in two compartments."""
        return all(self.structure.sheets[compartment][number] is not None for compartment in pair)

    def _projected(
        self,
        number: int,
        vertices: np.ndarray,
        is_known: np.ndarray,
        surfaces: tuple[int, ...],
        here: int,
        across: int,
    ) -> np.ndarray:
        """(V,) the heights of a sheet of a surface in compartment `across`, with vertices (V, 3) that are
        known, (V,) bool, in compartment `here`, where it lies likewise on or between others; NaN where these
        have none."""
        plan, z = np.ascontiguousarray(vertices[:, :2]), vertices[:, 2]
        from_there, from_here = (
            [self.heights_at(number, plan, n, self.structure.sheet(compartment, n)) for n in surfaces]
            for compartment in (across, here)
        )
        if len(from_here) == 1:
            return from_here[0] + _clamped(z - from_there[0], is_known)
        thickness = from_there[1] - from_there[0]
        share = (z - from_there[0]) / np.where(thickness > 0, thickness, np.nan)
        return from_here[0] + np.clip(_clamped(share, is_known), 0.0, 1.0) * (from_here[1] - from_here[0])

    def _pairs(self, fault: int, one: Family, other: Family) -> list[tuple[int, int]]:
        """Compartments of two families below and above a fault, and on one side of each other that is on both
        sides of it."""
        rows, pairs = self.structure.compartments, []
        for pair in ((a, b) for a in one.members for b in other.members):
            a, b = rows[list(pair)]
            same = (a == b) | (a == 0) | (b == 0)
            same[fault] = a[fault] * b[fault] < 0
            if same.all():
                pairs.append(pair if a[fault] < 0 else pair[::-1])
        return pairs

    def _first(
        self, numbers: Iterable[int], fault: int, pairs: list[tuple[int, int]], limit: int
    ) -> Known | None:
        """The number of the first of some surfaces on which a throw is known, and that: places (N, 3) and
        throw (N,). At most one of the two sheets is taken over."""
        for number in numbers:
            usable = []
            for below, above in pairs:
                ranks = sorted(self.rank[[below, above], number].tolist())
                if ranks[1] <= limit and ranks != [TAKEN, TAKEN]:
                    usable.append((below, above))
            key = number, fault, tuple(usable)
            if key not in self._known:
                self._known[key] = self._measured(number, fault, usable)
            measured = self._known[key]
            if measured is not None:
                return number, *measured
        return None

    def _measured(
        self, number: int, fault: int, pairs: Iterable[tuple[int, int]]
    ) -> tuple[np.ndarray, np.ndarray] | None:
        """places (N, 3) and throw (N,) of a surface between compartments; None where there are none."""
        different: dict[tuple[Sheet | None, ...], tuple[int, int]] = {}
        for pair in pairs:
            different.setdefault(
                tuple(self.structure.sheets[compartment][number] for compartment in pair), pair
            )
        if (number, fault) not in self._measures:
            self._measures[number, fault] = Measured(self.work, self.structure, fault, number)
        measure = self._measures[number, fault].between
        parts = [measure(below, above)[:2] for below, above in different.values()]
        parts = [part for part in parts if len(part[0])]
        if not parts:
            return None
        places, throw = (np.concatenate(arrays) for arrays in zip(*parts, strict=True))
        return places, throw

    def _share(self, family: Family, number: int, older: Known, younger: Known) -> float:
        """Where a surface lies between two others along a fault in a family, by thickness: 0 at the older
        one, 1 at the younger one."""
        plan = np.concatenate([older[1], younger[1]])[:, :2]
        for compartment in family.members:
            sheets = [
                self.structure.sheets[compartment][surface] for surface in (older[0], number, younger[0])
            ]
            made = [sheet for sheet in sheets if sheet is not None]
            if len(made) == len(sheets):
                low, middle, high = (heights_at(self.work, sheet, plan) for sheet in made)
                is_thick = (high > low) & np.isfinite(middle)  # not where one of them has no height
                if is_thick.any():
                    share = (middle[is_thick] - low[is_thick]) / (high[is_thick] - low[is_thick])
                    return float(np.clip(np.median(share), 0.0, 1.0))
        return 0.5


def _clamped(values: np.ndarray, is_known: np.ndarray) -> np.ndarray:
    """(V,) values, no farther beyond those that most have where they are known, (V,) bool, than these are
    apart: methods may run away beyond their points."""
    order = np.sort(values[is_known & np.isfinite(values)])
    if not len(order):
        return values
    low, high = order[int(_OUTLIERS * len(order))], order[-1 - int(_OUTLIERS * len(order))]
    values = np.where(np.isfinite(values), values, order[len(order) // 2])
    return np.clip(values, low - (high - low), high + (high - low))
