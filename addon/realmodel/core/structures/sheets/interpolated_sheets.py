# SPDX-License-Identifier: GPL-3.0-or-later
"""Sheets of a surface that is interpolated from points, on the planar mesh of its rock mass."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from copy import copy
from dataclasses import replace

import numpy as np

from ...base.algebra import are_among, dot
from ...base.errors import BuildWarning, number_list, place_text
from ...base.triangles import Sheet
from ...base.work import Work
from ...heights import Interpolation
from ...heights.mis_ties import SortedPoints
from ...heights.on_mesh import BOUNDS
from ...heights.run import few_points, runs_away
from ...project.project import Surface
from ...settings.dips import Dips
from ...settings.methods import METHODS
from ...settings.variogram import lacks_deviation
from ...surfaces.observed.conformable import conformable_run, sheets_beside
from ...surfaces.observed.surface_data import SurfaceData
from ...surfaces.rock_input import RockInput
from ...surfaces.rock_structure import fault_sides, sides_of
from ...surfaces.surface_heights import (
    Trend,
    counts_by_node,
    give_heights,
    needed_surfaces,
    used_vertices,
    where_known,
)
from ...surfaces.wrong_sides import heights_at
from .borrowed import as_at_fault, sheet_runs_away
from .families import CompartmentTest, Family, keys_of
from .few_points import are_few, of_residuals
from .near_rows import near_rows
from .points_at_faults import at_height, contradicting, placed_warning, point_sides, sided_dips
from .throws import Sheets
from .tied_sheets import data_of_sheets, sides_of_sheets, tied_sheets, weights_of_sheets
from .tips import Lip, beyond_lips, shared, trace_of, with_equal_ends

_RAMP = 4.0  # edges of the mesh: so far around its ends a fault that dies out is drawn together


class InterpolatedSurface:
    """One surface of a RockInput whose points lie in compartments. `data`: what its sheets are made of."""

    data = "points"

    def __init__(self, work: Work, entry: RockInput, number: int):
        self.work, self.entry, self.number = work, entry, number
        self.surface, self.known = entry.rock.surfaces[number], entry.data[number]
        self.points = self.known.points
        structure = entry.divided()
        self.placed = point_sides(work, self.points, entry, number)
        structure.points[number] = self.placed.sides
        names = structure.faults.names
        warning = placed_warning(self.points, self.placed.moved, names, entry.rock.name, self.surface.name)
        if warning is not None:
            structure.warnings.append((list(range(len(structure.compartments))), warning))
        self._leave_out_contradictions()
        self._sorted = SortedPoints(self.points)
        self.steps = (structure.steps or {}).get(number)
        self._warn_of_no_throws()
        self.counts = self._usable_points()
        self.keys = keys_of(entry.divided(), number, self.placed.sides)
        self.dips, self.dip_sides = sided_dips(work, self.known, entry)
        self.bounds = self.known.bounds
        self.bound_sides = sides_of(work, self.bounds.places, structure.faults)
        # of a sheet its interpolation, and the diagnostics of its vertices
        self.made: dict[Sheet, tuple[Interpolation, dict[str, np.ndarray]]] = {}
        self.most: tuple[int, Interpolation | None] = (-1, None)

    def _leave_out_contradictions(self) -> None:
        """Leaves out points that others at their place in plan contradict, with a warning."""
        faults = self.entry.divided().faults
        rows = np.where(faults.active(self.number), self.placed.sides, 0)
        left_out = contradicting(self.points, rows, self.known.contacts)
        if not left_out.any():
            return
        first = self.points[np.flatnonzero(left_out)[0]]
        text = (
            f"{int(left_out.sum())} of its {len(left_out)} points are left out, one at {place_text(first)}: "
            "others straight above or below them fit this side of the faults better; mostly picks of the "
            "other side reach beyond a fault there"
        )
        warning = BuildWarning(text, "points", self.entry.rock.name, self.surface.name)
        every = list(range(len(self.entry.divided().compartments)))
        self.entry.divided().warnings.append((every, warning))
        self.points, self.placed = self.points[~left_out], self.placed.some(~left_out)

    def _warn_of_no_throws(self) -> None:
        """Warns of the faults of which no throw is found."""
        structure = self.entry.divided()
        if self.steps is None:
            return
        for fault in np.flatnonzero(self.steps.heights == 0.0).tolist():
            below, above = ((self.placed.sides[:, fault] == side).sum() for side in (-1, 1))
            text = (
                f"no throw of fault '{structure.faults.names[fault]}' is found, from {below} contacts below "
                f"and {above} above it: it is smaller than its standard deviation, "
                f"{self.steps.deviations[fault]:.3g}; the surface continues across the fault"
            )
            warning = BuildWarning(text, "throw", self.entry.rock.name, self.surface.name)
            structure.warnings.append((list(range(len(structure.compartments))), warning))

    def _warn_of_no_points(self, family: Family) -> None:
        """Warns that points of other families alone say how a surface lies in one."""
        assert self.steps is not None
        structure = self.entry.divided()
        here, names = structure.names[next(iter(family.members))], structure.faults.names
        throws = [
            f"{-self.steps.heights[fault]:.4g} of fault '{names[fault]}'"
            for fault in np.flatnonzero(family.key).tolist()
        ]
        text = (
            f"it has no points in compartment '{here}': there it continues from the others, by the throws "
            f"that these show, {number_list(throws)}"
        )
        warning = BuildWarning(text, "compartment", self.entry.rock.name, self.surface.name)
        structure.warnings.append((list(family.members), warning))

    def _usable_points(self) -> np.ndarray:
        """(P,) bool: the points that its method takes; one that works on the mesh ignores others."""
        if METHODS[self.surface.method_options()[0]].on_mesh:
            nodes, triangles = self.entry.planar_mesh()
            level = np.column_stack([nodes, np.zeros(len(nodes))])
            over = np.isfinite(heights_at(self.work, Sheet(level, triangles), self.points[:, :2]))
            if over.any():
                self.data = "points on the mesh"
                return over
        return np.ones(len(self.points), bool)

    def own(self, family: Family) -> np.ndarray:
        """(P,) bool: the points in its compartments."""
        return (self.keys == family.key).all(axis=1)

    def count(self, family: Family) -> int:
        return int(self._certain(family).sum())

    def has_data(self, family: Family) -> bool:
        has_own = bool((self.own(family) & self.counts).any())
        return not self.surface.needs_points or has_own or self._is_fitted(family)

    def _is_fitted(self, family: Family) -> bool:
        """Whether the throws of all faults beside a family are fitted: points of others count for it."""
        return self.steps is not None and bool(np.isfinite(self.steps.heights[np.abs(family.key) == 1]).all())

    def has_few_data(self, family: Family) -> bool:
        """Whether its points do not show its shape there."""
        if not self.surface.needs_points:
            return False
        points = self.points[self._certain(family)]
        if not len(points) or self.steps is not None:
            return not (len(points) or self._is_fitted(family))
        dips = self._own_dips(family)
        shown = points if dips is None else np.concatenate([points, at_height(dips, points[0, 2])])
        shown = np.concatenate([shown, *self._beside_points(family)])
        return are_few(self.surface, shown, self.entry.planar_mesh().vertices, self._within(family))

    def _beside_points(self, family: Family) -> list[np.ndarray]:
        """(P, 3) the points in its compartments of each of the sheets that it is interpolated with."""
        others = [other for other in sheets_beside(self.entry.rock, self.number) if other != self.number]
        return [self._with_own_points(family, other).points for other in others]

    def _own_dips(self, family: Family) -> Dips | None:
        return None if self.dips is None else self.dips.some(self._within(family).has(self.dip_sides))

    def _constrained(self, family: Family, beside: Sequence[tuple] = ()) -> SurfaceData:
        """Its data with the dips and bounds in a family's compartments. beside: faults that die out there,
        the side of each that is requested, and its trace: what lies beside that on the other side does not
        count."""
        dips = self.dips
        if dips is not None:
            dips = dips.some(self._constraining_sheets(family, dips.positions, self.dip_sides, beside))
        plan = np.ascontiguousarray(self.bounds.places[:, :2])
        bounds = self.bounds.some(self._constraining_sheets(family, plan, self.bound_sides, beside))
        return replace(self.known, dips=dips, bounds=bounds)

    def _constraining_sheets(
        self, family: Family, plan: np.ndarray, sides: np.ndarray, beside: Sequence[tuple]
    ) -> np.ndarray:
        constrains = self._within(family).has(sides)
        for fault, side, trace in beside:
            constrains &= (sides[:, fault] != -side) | ~trace.beside(plan)
        return constrains

    def _certain(self, family: Family) -> np.ndarray:
        """(P,) bool: the points that count and lie in its compartments themselves: few do not say which
        points of the other side are theirs."""
        return self.own(family) & self.counts & ~self.placed.moved.any(axis=1)

    def without_thickness(self) -> InterpolatedSurface:
        """The same surface without its minimum thickness, for which the older one need not be known."""
        other = copy(self)
        other.surface = replace(self.surface, minimum_thickness=None)
        surfaces = list(self.entry.rock.surfaces)
        surfaces[self.number] = other.surface
        other.entry = replace(self.entry, rock=replace(self.entry.rock, surfaces=surfaces))
        return other

    def continued(self, sheets: Sheets, family: Family, source: Family, fault: int) -> Sheets:
        """Sheets of another family, across a fault, for this one: as its method continues them, or with the
        heights that they have at the fault, where they would run away, or the points of this family agree
        better with that."""
        shape, side = self.entry.divided().faults.shapes[fault], source.key[fault]
        within, points = self._within(family), self.points[self._certain(family)]
        chosen: dict[Sheet, Sheet] = {}
        for sheet in sheets.values():
            if sheet in chosen:
                continue
            chosen[sheet] = sheet
            level = as_at_fault(self.work, sheet, shape, side)
            if level is None:
                continue
            if len(points):
                is_level = self._spread(points, level) < self._spread(points, sheet)
            else:
                is_known = fault_sides(self.work, sheet.vertices, shape) == side
                is_level = sheet_runs_away(sheet, is_known, within)
            if is_level:
                chosen[sheet] = level
        return {sides: chosen[sheet] for sides, sheet in sheets.items()}

    def _spread(self, points: np.ndarray, sheet: Sheet) -> float:
        """How different the heights of points (P, 3) above a sheet are."""
        off = points[:, 2] - heights_at(self.work, sheet, points[:, :2])
        off = off[np.isfinite(off)]
        return float(off.std()) if len(off) else 0.0

    def adopt(self, sheets: Sheets, others: Sheets) -> None:
        """Takes sheets that were made of its own, for which what is known of these holds, too."""
        for sides, sheet in sheets.items():
            self.made[sheet] = self.made[others[sides]]

    def sheets(self, family: Family, trends: Sheets | None = None) -> Sheets:
        """The sheet on each side of the faults that die out here, by sides. trends: of each side, where its
        points are few or none."""
        own_points = self.own(family) if trends is None else self._certain(family)
        if self.steps is not None and trends is None:
            if not own_points.any():
                self._warn_of_no_points(family)
            own_points = np.ones(len(own_points), bool)
        if trends is not None and not own_points.any():
            return self._within_bounds(family, trends)
        first = next(iter(family.members.values()))
        trend = None if trends is None else trends[first]
        constrained = self._constrained(family)
        common = self._interpolated(family, first, own_points, self.surface, constrained, trend)
        if not own_points.any() and not needed_surfaces(self.entry.rock, self.number):
            return dict.fromkeys(family.members.values(), common)
        faults = [self.entry.divided().faults.shapes[fault] for fault in family.dying]
        nodes, triangles = self.entry.planar_mesh()
        z = self._on_nodes(common)
        is_known = np.isfinite(z)
        meshed = np.ascontiguousarray(triangles[is_known[triangles].all(axis=1)])
        flat = Sheet(np.column_stack([nodes, np.where(is_known, z, 0.0)]), meshed)
        traces = [trace_of(self.work, flat, fault, self._within(family)) for fault in faults]
        met = [number for number, trace in enumerate(traces) if len(trace.points)]
        if not met:
            return dict.fromkeys(family.members.values(), common)
        met = family.with_ends(met, self.entry.divided().faults)
        beside_trace = {number: traces[number].beside(self.points[:, :2]) for number in met}
        hidden = {
            (number, side): own_points
            & (self.placed.sides[:, family.dying[number]] == -side)
            & beside_trace[number]
            for number in met
            for side in (-1, 1)
        }
        of_members = {tuple(row[number] for number in met): row for row in family.members.values()}
        settled = _settled(self.surface, self.made[common][0])
        shows_none = bool(lacks_deviation(self.made[common][0].warnings))
        counts_by_node = trends is None and self._counts_by_node(settled, constrained) and is_known.all()
        whole_of: dict[tuple[int, ...], np.ndarray] = {}

        def values_of(sides: tuple[int, ...], some: np.ndarray) -> np.ndarray:
            values = heights_of(sides, some)
            if shows_none:  # the variogram that is settled counts as given
                values[:, 1] = np.nan
            return values

        def heights_of(sides: tuple[int, ...], some: np.ndarray) -> np.ndarray:
            away = np.zeros(len(own_points), bool)
            for number, side in zip(met, sides, strict=True):
                if side:
                    away |= hidden[number, side]
            visible = own_points & ~away
            visible = visible if (visible & self.counts).any() else own_points
            beside = [
                (family.dying[number], side, traces[number])
                for number, side in zip(met, sides, strict=True)
                if side
            ]
            data = self._constrained(family, beside)
            lips = [
                self._lip(family.dying[number], side, visible, beside_trace[number])
                for number, side in zip(met, sides, strict=True)
                if side
            ]
            if counts_by_node:
                own_data = data.through(self._points(family, visible, lips))
                return self._values_at(family, settled, own_data, nodes[some])
            if sides not in whole_of:
                whole = list(first)
                for number, side in zip(met, sides, strict=True):
                    whole[number] = side
                trend = None if trends is None else trends[of_members[sides]]
                sheet = self._interpolated(family, tuple(whole), visible, settled, data, trend, lips)
                whole_of[sides] = self._values_on_nodes(sheet)
            return whole_of[sides][some]

        values = near_rows(
            self.work,
            Sheet(nodes, meshed),
            self._values_on_nodes(common),
            [faults[number] for number in met],
            sorted(of_members),
            values_of,
        )
        drawn = self._with_equal_ends(family, met, values, meshed, self.made[common][0])
        return {sides: drawn[tuple(sides[number] for number in met)] for sides in family.members.values()}

    def _within_bounds(self, family: Family, trends: Sheets) -> Sheets:
        """Sheets without points, within the bounds of the surface."""
        settings = self.surface.method_options()[1]
        is_bounded = any(settings.get(option) is not None for option in BOUNDS)
        surface, data = self.surface, self._constrained(family)
        if surface.minimum_thickness is None and not is_bounded and not len(data.bounds):
            return trends
        none = np.zeros(len(self.points), bool)
        return shared(
            {s: self._interpolated(family, s, none, surface, data, trend) for s, trend in trends.items()}
        )

    def drawn_together(self, family: Family, sheets: dict) -> Sheets:
        """Sheets of another family, by sides, for this one: its faults may die out elsewhere."""
        if len(set(sheets.values())) == 1:
            return sheets
        _, triangles = self.entry.planar_mesh()
        values = {sides: self._values_on_nodes(sheet) for sides, sheet in sheets.items()}
        is_known = np.logical_and.reduce([np.isfinite(of[:, 0]) for of in values.values()])
        meshed = np.ascontiguousarray(triangles[is_known[triangles].all(axis=1)])
        result = self.made[next(iter(sheets.values()))][0]
        return self._with_equal_ends(family, range(len(family.dying)), values, meshed, result)

    def _with_equal_ends(
        self, family: Family, some: Iterable[int], values: dict, meshed: np.ndarray, result: Interpolation
    ) -> Sheets:
        """Sheets with some values at the nodes, as _values_on_nodes has them, drawn together beyond the ends
        of some of the faults that die out. result: the interpolation that is known of them."""
        nodes, triangles = self.entry.planar_mesh()
        shapes = self.entry.divided().faults.shapes
        faults = [family.dying[number] for number in some]
        ramp = _RAMP * self.entry.median_edge()
        equal = with_equal_ends(
            self.work,
            nodes,
            meshed,
            {sides: np.ascontiguousarray(of[:, 0]) for sides, of in values.items()},
            [(shapes[fault], 0.0 if fault in family.settled else ramp) for fault in faults],
            self._within(family),
        )
        drawn = shared({sides: where_known(nodes, triangles, z) for sides, z in equal.items()})
        for sides, sheet in drawn.items():
            is_known = np.isfinite(equal[sides])[triangles].all(axis=1)
            its = values[sides][used_vertices(nodes, triangles[is_known])]
            self.made[sheet] = result, {"variance": its[:, 1], "distance": its[:, 2]}
        return drawn

    def _interpolated(
        self,
        family: Family,
        sides: tuple[int, ...],
        chosen: np.ndarray,
        surface: Surface,
        data: SurfaceData,
        trend: Sheet | None = None,
        lips: Sequence[Lip] = (),
    ) -> Sheet:
        """The sheet from some points; surfaces that it needs are those on these sides. surface: the same with
        other options; data: in the compartments. trend: a sheet that was made here, on which the points are
        interpolated. lips: at faults that die out here, of these points."""
        data = data.through(self._points(family, chosen, None if trend is not None else lips))
        one = self._from_points(family, sides, surface, data, self.entry.region, trend)
        sheet = one.surface(self.number)
        result = one.interpolation(self.number)
        self.made[sheet] = result, one.attributes[self.number]
        if trend is None and chosen.sum() > self.most[0]:
            self.most = (int(chosen.sum()), result)
        for warning in one.warnings:
            self.entry.divided().warn(list(family.members), warning)
        return sheet

    def _points(self, family: Family, chosen: np.ndarray, lips: Sequence[Lip] | None) -> np.ndarray:
        """(P, 3) some points as they count: the mean of heights on several sides of faults that die out, at
        one place; and others beyond the faults at which the sheet ends, for a method that needs them. lips:
        as of _interpolated; None: without those beyond."""
        if self.steps is not None and chosen.all():
            return self._restored(family)
        points = self._sorted.mean_heights(chosen) if family.dying else self.points[chosen]
        return points if lips is None else np.concatenate([points, self._beyond(family, chosen, lips)])

    def _restored(self, family: Family) -> np.ndarray:
        """(P, 3) the points of all families as high as they would lie in one, but none of others at the place
        of its own."""
        assert self.steps is not None
        steps, points = np.nan_to_num(self.steps.heights), self.points.copy()
        points[:, 2] += dot(np.array(family.key) - self.keys, steps) / 2.0
        own_points = self.own(family)
        return points[own_points | ~are_among(points[:, :2], points[own_points, :2])]

    def _from_points(
        self,
        family: Family,
        sides: tuple[int, ...],
        surface: Surface,
        data: SurfaceData,
        region: Sheet | None,
        trend: Sheet | None = None,
    ) -> RockInput:
        """The RockInput with the surface from its data on the mesh of a region, and warnings."""
        entry = self.entry
        surfaces, every = list(entry.rock.surfaces), list(entry.data)
        surfaces[self.number] = replace(surface, tie=surface.tie and not self.ties_at_end)
        every[self.number] = data
        below = [self.number - 1] if self.surface.minimum_thickness is not None else []
        for other in {*below, *self._supporting_surfaces()} - {self.number}:
            every[other] = self._with_own_points(family, other)
        shapes: list[Sheet | None] = [None] * len(surfaces)
        for other in needed_surfaces(entry.rock, self.number):
            shapes[other] = self._as_seen(family, sides, other)
        one = replace(
            entry,
            rock=replace(entry.rock, surfaces=surfaces),
            region=region,
            surfaces=shapes,
            interpolations=[None] * len(surfaces),
            warnings=[],
            attributes={},
            structure=None,
            data=every,
        )
        give_heights(self.work, one, self.number, None if trend is None else self._trend(trend))
        return one

    def _supporting_surfaces(self) -> list[int]:
        """The surfaces whose data count for it, itself included."""
        rock = self.entry.rock
        beside = sheets_beside(rock, self.number)
        return beside or conformable_run(rock, self.entry.data, self.number)

    def _counts_by_node(self, surface: Surface, data: SurfaceData) -> bool:
        """Whether heights at some nodes do not depend on others, so that these need not be found."""
        return self.entry.draws is None and counts_by_node(self.entry.rock, self.number, surface, data)

    def _values_at(
        self, family: Family, surface: Surface, data: SurfaceData, nodes: np.ndarray
    ) -> np.ndarray:
        """As _values_on_nodes, at some nodes alone, of a surface that counts by node."""
        region = Sheet(np.ascontiguousarray(nodes), np.empty((0, 3), np.int32))
        one = self._from_points(family, (), surface, data, region)
        points = data.points
        result = one.interpolation(self.number)
        method, z = result.method, result.z
        for text in (*few_points(points, method, z), *runs_away(points, z, method)):
            warning = BuildWarning(text, "points", self.entry.rock.name, self.surface.name)
            self.entry.divided().warn(list(family.members), warning)
        return np.column_stack([result.z, *one.attributes[self.number].values()])

    def _values_on_nodes(self, sheet: Sheet) -> np.ndarray:
        """(N, 3) height, variance and distance of a sheet at the nodes of the planar mesh, NaN where it has
        none."""
        z = self._on_nodes(sheet)
        values = np.full((len(z), 3), np.nan)
        values[:, 0] = z
        attributes = self.made[sheet][1]
        values[np.isfinite(z), 1:] = np.column_stack([attributes["variance"], attributes["distance"]])
        return values

    def _trend(self, sheet: Sheet) -> Trend:
        interpolation, attributes = self.made[sheet]
        by = of_residuals(self.surface)
        return Trend(sheet, self._on_nodes(sheet), interpolation, attributes, *by)

    def _beyond(self, family: Family, chosen: np.ndarray, lips: Sequence[Lip]) -> np.ndarray:
        """(K, 3) points beyond the faults at which the sheet ends, for a method that needs them."""
        parting = [self._lip(n, side, chosen) for n, side in enumerate(family.key) if side in (-1, 1)]
        lips, options = [*parting, *lips], self.surface.method_options()
        return beyond_lips(self.work, self.points[chosen], lips, self.placed.reach, *options)

    def _lip(self, fault: int, side: int, chosen: np.ndarray, beside: np.ndarray | None = None) -> Lip:
        """The lip at a fault of a sheet on a side of it. chosen: (P,) bool, the points that it is made of;
        beside: those that may lie on its cutoff line."""
        of_chosen = chosen if beside is None else beside
        shape = self.entry.divided().faults.shapes[fault]
        return Lip(shape, side, of_chosen[chosen], self.placed.nearest[chosen, fault])

    def _with_own_points(self, family: Family, other: int) -> SurfaceData:
        """The data of another surface with only its points and dips in the family's compartments."""
        data = self.entry.data[other]
        if not self.entry.rock.surfaces[other].has_points:
            return data
        dips, sides = sided_dips(self.work, data, self.entry)
        if dips is not None:
            dips = dips.some(self._within(family).has(sides))
        placed = point_sides(self.work, data.points, self.entry, self.number)
        return replace(data, dips=dips).some(self._within(family).has(placed.sides))

    def _as_seen(self, family: Family, sides: tuple[int, ...], other: int) -> Sheet:
        """Another surface in some compartments. Where faults displace it that this one ignores, each node of
        the planar mesh gets the height of the compartment in which the other surface lies there."""
        structure = self.entry.divided()
        members = [n for n, its in family.members.items() if its == sides] or list(family.members)
        different = list(dict.fromkeys(structure.sheet(compartment, other) for compartment in members))
        if len(different) == 1:
            return different[0]
        nodes, triangles = self.entry.planar_mesh()
        chosen = np.full(len(nodes), np.nan)
        total, count = np.zeros(len(nodes)), np.zeros(len(nodes))
        for sheet in different:
            z = self._on_nodes(sheet)
            has_height = np.isfinite(z)
            total[has_height] += z[has_height]
            count += has_height
            at = np.column_stack([nodes, np.where(has_height, z, 0.0)])
            rows = sides_of(self.work, at, structure.faults)
            its = [compartment for compartment in members if structure.sheets[compartment][other] is sheet]
            inside = (rows[:, None] == structure.compartments[its]).all(axis=2).any(axis=1)
            chosen = np.where(has_height & inside & np.isnan(chosen), z, chosen)
        with np.errstate(invalid="ignore", divide="ignore"):
            heights = np.where(np.isnan(chosen), total / count, chosen)
        return where_known(nodes, triangles, heights)

    def _on_nodes(self, sheet: Sheet) -> np.ndarray:
        """(N,) heights of a sheet at the nodes of the planar mesh; NaN where it has none."""
        nodes, _ = self.entry.planar_mesh()
        if len(sheet.vertices) == len(nodes) and np.array_equal(sheet.vertices[:, :2], nodes):
            return sheet.vertices[:, 2]
        return heights_at(self.work, sheet, nodes)

    def _within(self, family: Family) -> CompartmentTest:
        return CompartmentTest(self.work, self.entry.divided(), self.number, family)

    @property
    def ties_at_end(self) -> bool:
        """Whether its sheets are tied to their data together, once all are made: where sheets on the two
        sides of a fault are one beyond its ends. What keeps it off other surfaces comes before its points."""
        faults, settings = self.entry.divided().faults, self.surface.method_options()[1]
        is_free = self.surface.minimum_thickness is None and all(
            settings.get(option) is None for option in BOUNDS
        )
        dies_out = faults.active(self.number) & np.array(faults.dies_out, bool)
        is_divided = self.steps is not None or bool(dies_out.any())
        return self.surface.tie and is_free and is_divided

    def tied(self, sheets: list[Sheet]) -> tuple[list[Sheet], list[BuildWarning]]:
        """Its different sheets, tied to the data in their compartments; the same objects where they were. And
        warnings about data that they do not honor."""
        structure, mesh = self.entry.divided(), self.entry.planar_mesh()
        active = structure.faults.active(self.number)
        numbers = [sheets.index(structure.sheet(n, self.number)) for n in range(len(structure.sheets))]

        def sheet_of(sides: np.ndarray) -> np.ndarray:
            sheet_numbers = np.full(len(sides), -1)
            for row, number in zip(structure.compartments, numbers, strict=True):
                sheet_numbers[((sides == row) | ~active).all(axis=1)] = number
            return sheet_numbers

        z = np.array([self._on_nodes(sheet) for sheet in sheets])
        sides = sides_of_sheets(structure, self.number, sheets)
        of_points = sheet_of(self.placed.sides)
        certain = self.counts & ~self.placed.moved.any(axis=1)
        # As in _certain: what lies on the other side alone does not show a sheet.
        is_tied = (
            self.counts
            & np.isin(of_points, of_points[certain])
            & (len(self.known.tied_points(self.surface)) > 0)
        )
        of_points = np.where(is_tied, of_points, -1)
        data = data_of_sheets(self.points, self.bounds, of_points, sheet_of(self.bound_sides), len(sheets))
        sided = sides, weights_of_sheets(structure, mesh, z, sides)
        tied, texts = tied_sheets(self.work, mesh, z, sided, data)
        name, rock = self.surface.name, self.entry.rock.name
        new_sheets = []
        for sheet, before, after in zip(sheets, z, tied, strict=True):
            new = (
                sheet
                if np.array_equal(before, after, equal_nan=True)
                else where_known(mesh.vertices, mesh.triangles, after)
            )
            self.made[new] = self.made[sheet]
            if new is not sheet and self.entry.draws is None:
                self.entry.untied[new] = self.entry.untied.get(sheet, sheet)
            new_sheets.append(new)
        return new_sheets, [BuildWarning(text, "points", rock, name) for text in texts]

    def finish(self, sheets: list[Sheet]) -> None:
        """Sets the RockInput's interpolation, to that of the compartment with most points, and its vertex
        attributes, to those of all sheets."""
        attributes = [self.made[sheet][1] for sheet in sheets]
        self.entry.interpolations[self.number] = self.most[1]
        self.entry.attributes[self.number] = {
            name: np.concatenate([of_sheet[name] for of_sheet in attributes])
            for name in ("variance", "distance")
        }


def _settled(surface: Surface, interpolation: Interpolation) -> Surface:
    """The surface with the variogram that was found once: so the two sides of a fault have the same."""
    variogram = interpolation.variogram
    if variogram is None or not variogram.fitted:
        return surface
    options = {
        key: value for key, value in surface.options.items() if key in METHODS[interpolation.method].options
    }
    options |= {"variogram": variogram.settings(), "neighbours": interpolation.neighbours}
    return replace(surface, method=surface.method and interpolation.method, options=options)
