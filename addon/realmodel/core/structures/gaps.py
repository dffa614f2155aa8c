# SPDX-License-Identifier: GPL-3.0-or-later
"""Faults whose borders all but reach where the rock ends that they displace: they are continued to it, or
refused where they end inside."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from ..base.algebra import dot, norm, principal_axes, ranks_in_runs
from ..base.errors import BuildWarning, InputRefused, place_text
from ..base.triangles import Sheet, edge_lengths
from ..base.work import Work, native_module
from ..project.project import Rock
from ..project.structure_entries import Fault
from ..settings.rules import RULES
from ..surfaces.planar_mesh import triangulate_rings
from ..surfaces.rock_input import RockInput
from ..surfaces.rock_structure import FaultShape, fault_sides, sides_of
from ..surfaces.surface_heights import needed_surfaces
from ..surfaces.wrong_sides import heights_at
from .parts.part_models import level
from .parts.parts import Structures, ends_inside
from .shapes.continued import Border, border_of, connected, continued
from .shapes.fitted import plane_axes
from .shapes.reading import nearest_to_meet, require_meeting

_GAP = 0.25  # of an edge length: a narrower gap is closed
_SHARE = 0.5  # of the part of a side of the border that is in the rock: with so much near its end, it reaches
_SAMPLES = (4, 256)  # of an edge: so many at least and at most, about two in the width of a gap
_HALVINGS = 30  # of that width: how precisely a gap is measured
_MARGIN = 0.25  # of the range of a surface's points: how far beyond it the surface may be
_MEASURED = 100_000  # triangles of a mesh, for the length of its edges
_STEPS = 50  # in which the directions of a border are smoothed, at most


class _Samples(NamedTuple):
    """Places on a border: points (N, 3); edge (N,) the number of the edge of each; weight (N,) the length
    that it stands for; way (N, 3) in which the border is continued there; side (N,) the number of the side of
    the border; inside (N,) bool, whether it is in the rock, near (N,) bool, also near where that ends."""

    points: np.ndarray
    edge: np.ndarray
    weight: np.ndarray
    way: np.ndarray
    side: np.ndarray
    inside: np.ndarray
    near: np.ndarray

    def some(self, chosen: np.ndarray) -> _Samples:
        """Some of them, (N,) bool."""
        return _Samples(*(column[chosen] for column in self))


# whether points (N, 3) are in the rock, as far as one thing tells that ends it, by what it is called
_Conditions = dict[str, Callable[[np.ndarray], np.ndarray]]


def gap_widths(structures: Structures, inputs: list[RockInput]) -> dict[int, float]:
    """How wide the gaps are that close_gaps closes, for each rock mass (RockInput) that faults displace."""
    displaced = sorted({rock for rocks in structures.displaced for rock in rocks})
    return {rock: _GAP * edge_length(inputs[rock]) for rock in displaced}


def edge_length(entry: RockInput) -> float:
    """The median edge of the planar mesh of a RockInput, but for what contacts make it finer; where it has
    none, of its surfaces, in plan."""
    if entry.edge is not None:
        return entry.edge
    meshes = [entry.region] if entry.region is not None and entry.rock.interpolates else []
    meshes = meshes or [shape for shape in entry.surfaces if shape is not None]
    lengths = []
    for vertices, triangles in meshes:
        some = triangles[:: max(1, len(triangles) // _MEASURED)]
        lengths.append(edge_lengths(vertices[:, :2], some))
    return float(np.median(np.concatenate(lengths))) if lengths else 0.0


def close_gaps(
    work: Work,
    structures: Structures,
    inputs: list[RockInput],
    box: np.ndarray,
    widths: dict[int, float],
    has_sheets: bool = False,
) -> tuple[list[Fault], list[BuildWarning]]:
    """The faults of some structures, with arrays, continued where their borders end short of the wall of a
    rock mass (RockInput), of its base, of a fault at which they end, or, where the sheets are known, of the
    youngest surface that they displace and of those that cut it; and a warning for each such end.

    box: around all rock, (2, 3). widths: as of gap_widths. Raises InputRefused for a fault whose border is
    inside the rock, as far as that is certain.
    """
    faults, warnings = list(structures.faults), []
    number_of = {fault.name: number for number, fault in enumerate(faults)}
    waiting = list(range(len(faults)))
    while waiting:  # each after those at which it ends
        number = next(n for n in waiting if not any(number_of[name] in waiting for name in faults[n].ends_at))
        waiting.remove(number)
        ends = [faults[number_of[name]] for name in faults[number].ends_at]
        around = [
            _Around(work, structures, inputs[rock], (number, last), widths[rock])
            for rock, last in structures.displaced[number].items()
            if not has_sheets or inputs[rock].divided().is_made(last)
        ]
        if not len(_outer_border(faults[number]).edges):
            continue
        for surrounding in around:
            faults[number], more = surrounding.closed(faults[number], ends, box, has_sheets)
            warnings += more
        for name in faults[number].ends_at if around else ():
            other = number_of[name]
            faults[other], more = around[0].with_tip_at(faults[number], faults[other])
            warnings += more
        ends = [faults[number_of[name]] for name in faults[number].ends_at]
        require_meeting(faults[number], ends)
        for surrounding in around:
            surrounding.require_end(faults[number], ends, box, has_sheets)
    return faults, warnings


def tops_of_faults(structures: Structures, number: int, rock: Rock) -> set[int]:
    """Of one rock mass the surfaces whose sheets are made before close_gaps looks at them: the youngest ones
    that faults displace, those that cut them later, the oldest one where it is the base, what these need, and
    ready meshes."""
    youngest = [displaced[number] for displaced in structures.displaced if number in displaced]
    cutting = [n for n, surface in enumerate(rock.surfaces) if n >= min(youngest, default=n + 1)]
    tops = {n for n in cutting if n in youngest or RULES[rock.surfaces[n].rule].cuts}
    tops |= {n for n, surface in enumerate(rock.surfaces) if not rock.is_interpolated(surface)}
    tops |= {0} if rock.base_elevation is None and youngest else set()
    waiting = list(tops)
    while waiting:
        more = set(needed_surfaces(rock, waiting.pop())) - tops
        tops |= more
        waiting += more
    return tops


class _Around:
    """A fault in one rock mass. of: its number, and the youngest surface of the rock mass that it displaces.
    width: of the gaps that are closed."""

    def __init__(
        self, work: Work, structures: Structures, entry: RockInput, of: tuple[int, int], width: float
    ):
        self.work, self.structures, self.entry, self.width = work, structures, entry, width
        self.number, self.last = of
        self.looked_at: tuple[Fault, _Samples] | None = None  # the last fault, and the places on its border

    def closed(
        self, fault: Fault, ends: list[Fault], box: np.ndarray, has_sheets: bool
    ) -> tuple[Fault, list[BuildWarning]]:
        """The fault, continued where its border all but reaches the end of the rock, and warnings."""
        if fault.dies_out and not ends:
            return fault, []
        border, conditions = _outer_border(fault), self._conditions(fault, ends, has_sheets)
        samples = self._looked_at(fault, border, conditions, box, ends)
        side = np.full(len(border.edges), -1)
        side[samples.edge] = samples.side
        samples = samples.some(samples.near)
        if not len(samples.points):
            return fault, []
        chosen = np.zeros(len(border.edges), bool)
        chosen[samples.edge] = True
        # also those beside them on a side: where they cross the end of the rock near a vertex no place may
        # show it
        beside = np.isin(border.edges, border.edges[chosen]).any(axis=1)
        chosen |= beside & np.isin(side, side[chosen])
        try:
            vertices, triangles = continued(*fault.triangulation(), border.some(chosen), self.width)
        except InputRefused:  # it is not known where to: it ends where it ends
            return fault, []
        return replace(fault, vertices=vertices, triangles=triangles), self._warnings(
            fault, conditions, samples
        )

    def with_tip_at(self, branch: Fault, other: Fault) -> tuple[Fault, list[BuildWarning]]:
        """Another fault at whose border this one all but ends, continued to it, and a warning."""
        if nearest_to_meet(branch, other) is None:
            return other, []
        border, (vertices, triangles) = _outer_border(other), branch.triangulation()
        points, edge, _ = _spread(other.triangulation()[0], border, self.width)
        nearest = native_module().nearest_triangles
        _, away = self.work.native(nearest, vertices[triangles], points)
        chosen = np.isin(np.arange(len(border.edges)), edge[away < self.width])
        try:
            mesh = continued(*other.triangulation(), border.some(chosen), self.width)
        except InputRefused:
            return other, []
        longer = replace(other, vertices=mesh.vertices, triangles=mesh.triangles)
        if nearest_to_meet(branch, longer) is not None:
            return other, []
        text = (
            f"{other.item}: its border ends {away.min():.4g} before {branch.item}, which ends at it, near "
            f"{place_text(points[int(away.argmin())])}: it is continued to it"
        )
        return longer, [BuildWarning(text, "fault", self.entry.rock.name)]

    def _looked_at(
        self, fault: Fault, border: Border, conditions: _Conditions, box: np.ndarray, ends: list[Fault]
    ) -> _Samples:
        """Places on the border. A side of it is near the end of the rock if most of what it has inside is. A
        fault that dies out may end near walls and surfaces: it only reaches those at which it ends."""
        if self.looked_at is not None and self.looked_at[0] is fault:
            return self.looked_at[1]
        ending = conditions
        if fault.dies_out:
            ending = {other.item: conditions[other.item] for other in ends}
        vertices, _ = fault.triangulation()
        ways = _smoothed(vertices, border, self.width)
        points, edge, weight = _spread(vertices, border, self.width)
        way, side = ways[edge], _sides_of_border(vertices, border, ways)[edge]
        z = points[:, 2]
        inside = (z > box[0, 2]) & (z < box[1, 2])
        inside[inside] = _in_all(conditions, points[inside])
        near = inside.copy()
        near[inside] = ~_in_all(ending, points[inside] + self.width * way[inside])
        of_side, of_near = (np.bincount(side, weight * mask) for mask in (inside, near))
        near &= (of_near >= _SHARE * of_side)[side]
        samples = _Samples(points, edge, weight, way, side, inside, near)
        self.looked_at = fault, samples
        return samples

    def _conditions(self, fault: Fault, ends: list[Fault], has_sheets: bool) -> _Conditions:
        conditions = self._walls() | {other.item: self._side_of(fault, other) for other in ends}
        conditions |= self._base(has_sheets)
        return conditions | self._tops() if has_sheets else conditions

    def _base(self, has_sheets: bool) -> _Conditions:
        """Whether points are above the base of the rock mass; without one above its oldest surface, once that
        is made."""
        base = self.entry.rock.base_elevation
        if base is not None:
            return {"the base": lambda points: points[:, 2] > base}
        if has_sheets and self.entry.divided().is_made(0):
            return {"the base": lambda points: ~(points[:, 2] < self.sheets_at(0, points)[0])}
        return {}

    def _walls(self) -> _Conditions:
        """Whether points are over the rock in plan, as far as the displaced surfaces reach."""
        entry, shapes = self.entry, []
        surfaces = entry.surfaces[: self.last + 1]
        if entry.region is not None:
            shapes = [level(Sheet(*triangulate_rings(entry.rock.rings())), 0.0)]
        made = [surface for surface in surfaces if surface is not None]
        covers = made if len(made) == len(surfaces) else []

        def over(points: np.ndarray) -> np.ndarray:
            is_over = np.ones(len(points), bool)
            for some in (shapes, covers):
                left = np.arange(len(points)) if some else np.empty(0, np.int64)
                for shape in some:
                    left = left[np.isnan(self._heights(shape, points[left]))] if len(left) else left
                is_over[left] = False
            return is_over

        return {"the wall": over}

    def _side_of(self, fault: Fault, other: Fault) -> Callable[[np.ndarray], np.ndarray]:
        """Whether points are on the side of another fault on which the larger part of this one is."""
        shape = FaultShape(*other.triangulation(), other.dies_out)
        vertices, triangles = fault.triangulation()
        a, b, c = vertices[triangles].transpose(1, 0, 2)
        area = norm(np.cross(b - a, c - a))
        is_positive = dot(fault_sides(self.work, (a + b + c) / 3, shape), area) > 0

        def beside(points: np.ndarray) -> np.ndarray:
            return (fault_sides(self.work, points, shape) > 0) == is_positive

        return beside

    def _tops(self) -> _Conditions:
        """Whether points are below the youngest surface that is displaced, if it ends what was there, and
        below those that cut it later."""
        rules = [surface.rule for surface in self.entry.rock.surfaces]
        numbers = [n for n in range(self.last, len(rules)) if RULES[rules[n]].cuts]
        return {
            f"surface '{self.entry.rock.surfaces[n].name}'": self._below(n)
            for n in numbers
            if self.entry.divided().is_made(n)
        }

    def _below(self, surface: int) -> Callable[[np.ndarray], np.ndarray]:
        def below(points: np.ndarray) -> np.ndarray:
            _, high = self.sheets_at(surface, points)
            return ~(points[:, 2] > high)

        return below

    def sheets_at(self, surface: int, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """(N,) the heights of the lower and the higher sheet of a surface on the two sides of this fault, at
        points (N, 3); NaN where there is none."""
        structure = self.entry.divided()
        low, high = np.full(len(points), np.nan), np.full(len(points), np.nan)
        active = structure.faults.active(surface)
        if self.number in structure.faults.numbers:
            active[structure.faults.numbers.index(self.number)] = False
        sides = sides_of(self.work, points, structure.faults, np.flatnonzero(active).tolist())
        for sheet in structure.distinct(surface):
            compartments = [n for n, sheets in enumerate(structure.sheets) if sheets[surface] is sheet]
            rows = np.unique(structure.compartments[compartments][:, active], axis=0)
            is_inside = (sides[:, None, active] == rows).all(axis=2).any(axis=1)
            if not is_inside.any():
                continue
            z = self._heights(sheet, points[is_inside])
            low[is_inside], high[is_inside] = np.fmin(low[is_inside], z), np.fmax(high[is_inside], z)
        return low, high

    def _heights(self, sheet: Sheet, points: np.ndarray) -> np.ndarray:
        return heights_at(self.work, sheet, points[:, :2])

    def require_end(self, fault: Fault, ends: list[Fault], box: np.ndarray, has_sheets: bool) -> None:
        """Refuses a fault whose border certainly ends inside the rock. Raises InputRefused."""
        if fault.dies_out or self.structures.bodies:  # it may end inside a body
            return
        conditions = self._conditions(fault, ends, has_sheets)
        samples = self._looked_at(fault, _outer_border(fault), conditions, box, ends)
        if has_sheets:  # between the two sheets there is different rock on its two sides
            is_end = samples.inside.copy()
            points = samples.points[is_end]
            low, high = self.sheets_at(self.last, points)
            is_end[is_end] = (low < points[:, 2]) & (points[:, 2] < high)
        else:
            is_end = self._passing(fault, samples)
        if is_end.any():
            raise ends_inside(fault, tuple(samples.points[int(is_end.argmax())].tolist()))

    def _passing(self, fault: Fault, samples: _Samples) -> np.ndarray:
        """(N,) bool: of places on the border those of a side of it that is inside the rock from below all
        points of a surface, some of which are on either side of the fault, to above them."""
        shape = FaultShape(*fault.triangulation(), fault.dies_out)
        z, passing = samples.points[:, 2], np.zeros(len(samples.points), bool)
        rock = self.entry.rock
        for surface, data in zip(rock.surfaces[: self.last + 1], self.entry.data, strict=False):
            if not rock.is_interpolated(surface) or surface.method_options()[1].get("extrapolate") == "none":
                continue
            points = data.points
            sides = fault_sides(self.work, points, shape)
            if not ((sides > 0).any() and (sides < 0).any()):
                continue
            low, high = points[:, 2].min(), points[:, 2].max()
            low, high = low - _MARGIN * (high - low), high + _MARGIN * (high - low)
            for number in np.unique(samples.side[samples.inside]):
                on_side = samples.side == number
                between = on_side & (z >= low) & (z <= high)
                passes = (samples.inside & on_side & (z < low)).any() and (on_side & (z > high)).any()
                if passes and between.any() and samples.inside[between].all():
                    passing |= between
        return passing

    def _warnings(self, fault: Fault, conditions: _Conditions, samples: _Samples) -> list[BuildWarning]:
        """One for each thing that the border did not reach, with the widest gap. samples: where it does
        not."""
        points, way = samples.points, samples.way
        low, high = np.zeros(len(points)), np.full(len(points), self.width)
        for _ in range(_HALVINGS):
            middle = (low + high) / 2
            inside = _in_all(conditions, points + middle[:, None] * way)
            low, high = np.where(inside, middle, low), np.where(inside, high, middle)
        warnings = []
        for name, is_inside in conditions.items():
            rows = np.flatnonzero(~is_inside(points + high[:, None] * way))
            if len(rows):
                widest = rows[int(high[rows].argmax())]
                text = (
                    f"{fault.item}: its border ends up to {high[widest]:.4g} before {name}, near "
                    f"{place_text(points[widest])}: it is continued to it"
                )
                warnings.append(BuildWarning(text, "fault", self.entry.rock.name))
        return warnings


def _in_all(conditions: _Conditions, points: np.ndarray) -> np.ndarray:
    """(N,) bool: the points that meet all conditions."""
    meets = np.ones(len(points), bool)
    for holds in conditions.values():
        if meets.any():
            meets[meets] = holds(points[meets])
    return meets


def _smoothed(vertices: np.ndarray, border: Border, width: float) -> np.ndarray:
    """(E, 3) the directions in which edges are continued, as their mean over about a width: ragged borders go
    to and fro."""
    a, b = border.edges.T
    size = norm(vertices[b] - vertices[a])
    way = border.away
    for _ in range(min(_STEPS, int(np.ceil((width / np.median(size)) ** 2)))):
        total = np.zeros((len(vertices), 3))
        for vertex in (a, b):
            np.add.at(total, vertex, size[:, None] * way)
        way = total[a] + total[b]
        way /= np.maximum(norm(way), np.finfo(float).tiny)[:, None]
    return way


def _spread(vertices: np.ndarray, border: Border, width: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Points (N, 3) on a border, the number (N,) of the edge of each, and the length (N,) that it stands
    for."""
    begin, end = vertices[border.edges].transpose(1, 0, 2)
    size = norm(end - begin)
    count = np.clip(np.ceil(2 * size / width), *_SAMPLES).astype(np.int64)
    edge = np.repeat(np.arange(len(size)), count)
    share = (ranks_in_runs(count) + 0.5) / count[edge]
    return begin[edge] + share[:, None] * (end - begin)[edge], edge, (size / count)[edge]


def _outer_border(fault: Fault) -> Border:
    border = border_of(*fault.triangulation())
    return border.some(border.is_outer)


def _sides_of_border(vertices: np.ndarray, border: Border, ways: np.ndarray) -> np.ndarray:
    """(E,) the number of the side of the border that each edge is of: edges that are connected, and all
    continued upward, downward, or to one end."""
    along, down, _ = plane_axes(principal_axes(vertices[np.unique(border.edges)])[1][2])
    shares = np.column_stack([sign * dot(ways, axis) for axis in (along, down) for sign in (-1, 1)])
    kind, sides, count = shares.argmax(axis=1), np.zeros(len(ways), np.int64), 0
    for number in range(4):
        edges = np.flatnonzero(kind == number)
        if len(edges):
            sides[edges] = connected(border.edges[edges]) + count
            count = int(sides[edges].max()) + 1
    return sides
