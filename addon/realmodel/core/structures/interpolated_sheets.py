# SPDX-License-Identifier: GPL-3.0-or-later
"""Sheets of a surface that is interpolated from points, on the planar mesh of its rock mass."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ..build_warning import BuildWarning
from ..errors import place_text
from ..methods import METHODS
from ..mis_ties import contradictions, mean_heights
from ..surface_heights import give_heights, needed_surfaces, where_known
from ..work import Work
from ..wrong_sides import heights_at
from .beyond_faults import beyond_faults
from .families import Family, keys_of
from .lips import Lip, beyond_lips
from .points_at_faults import placed_warning, point_sides
from .rock_structure import Triangulation
from .sides import sides_of
from .tips import shared, trace_of, with_equal_ends
from .triangles import median_edge
from .within import Within

_RAMP = 4.0  # edges of the mesh: so far around its ends a fault that dies out is drawn together


class InterpolatedSurface:
    """One surface of a RockInput whose points lie in compartments. `data`: what its sheets are made of."""

    data = "points"

    def __init__(self, work: Work, entry, number: int, threads: int):
        self.work, self.entry, self.number, self.threads = work, entry, number, threads
        self.surface = entry.rock.surfaces[number]
        self.points = np.asarray(self.surface.points, np.float64).reshape(-1, 3)
        structure = entry.structure
        self.placed = point_sides(work, self.points, entry, number, threads)
        structure.points[number] = self.placed.sides
        names = structure.faults.names
        warning = placed_warning(self.points, self.placed.moved, names, entry.rock.name, self.surface.name)
        if warning is not None:
            structure.warnings.append((list(range(len(structure.compartments))), warning))
        self._leave_out_contradictions()
        self.counts = self._that_count()
        self.keys = keys_of(entry.structure, number, self.placed.sides)
        self.made: dict[
            int, tuple
        ] = {}  # the interpolation and the diagnostics of its vertices, by the id of a sheet
        self.most = (-1, None)

    def _leave_out_contradictions(self) -> None:
        """Leaves out points that others at their place in plan contradict, with a warning."""
        faults = self.entry.structure.faults
        rows = np.where(faults.active(self.number), self.placed.sides, 0)
        beyond = beyond_faults(self.points, rows)
        wrong = contradictions(np.column_stack([self.points, rows])[~beyond])
        left_out = beyond.copy()
        left_out[np.flatnonzero(~beyond)[wrong]] = True
        if left_out.all() or not left_out.any():
            return
        first = self.points[np.flatnonzero(left_out)[0]]
        text = (
            f"{int(left_out.sum())} of its {len(left_out)} points are left out, one at {place_text(first)}: "
            "others straight above or below them fit this side of the faults better; mostly picks of the "
            "other side reach beyond a fault there"
        )
        warning = BuildWarning(text, "points", self.entry.rock.name, self.surface.name)
        every = list(range(len(self.entry.structure.compartments)))
        self.entry.structure.warnings.append((every, warning))
        self.points, self.placed = self.points[~left_out], self.placed.some(~left_out)

    def _that_count(self) -> np.ndarray:
        """(P,) bool: the points that its method takes; one that works on the mesh ignores others."""
        if METHODS[self.surface.method_options()[0]].on_mesh:
            nodes, triangles = self.entry.region
            level = np.column_stack([nodes, np.zeros(len(nodes))])
            over = np.isfinite(heights_at(self.work, (level, triangles), self.points[:, :2], self.threads))
            if over.any():
                self.data = "points on the mesh"
                return over
        return np.ones(len(self.points), bool)

    def own(self, family: Family) -> np.ndarray:
        """(P,) bool: the points in its compartments."""
        return (self.keys == family.key).all(axis=1)

    def count(self, family: Family) -> int:
        return int(self.own(family).sum())

    def has_data(self, family: Family) -> bool:
        return not self.surface.needs_points or bool((self.own(family) & self.counts).any())

    def sheets(self, family: Family) -> dict[tuple[int, ...], Triangulation]:
        """The sheet on each side of the faults that die out here, by sides."""
        own = self.own(family)
        first = next(iter(family.members.values()))
        common = self._interpolated(family, first, own)
        if not own.any() and not needed_surfaces(self.entry.rock, self.number):
            return dict.fromkeys(family.members.values(), common)
        faults = [self.entry.structure.faults.shapes[fault] for fault in family.dying]
        nodes, triangles = self.entry.region
        z = self._on_nodes(common)
        known = np.isfinite(z)
        meshed = np.ascontiguousarray(triangles[known[triangles].all(axis=1)])
        flat = np.column_stack([nodes, np.where(known, z, 0.0)])
        traces = [
            trace_of(self.work, (flat, meshed), fault, self._within(family), self.threads) for fault in faults
        ]
        met = [number for number, trace in enumerate(traces) if len(trace.points)]
        if not met:
            return dict.fromkeys(family.members.values(), common)
        met = family.with_ends(met, self.entry.structure.faults)
        hidden = {
            (number, side): own
            & (self.placed.sides[:, family.dying[number]] == -side)
            & traces[number].beside(self.points[:, :2])
            for number in met
            for side in (-1, 1)
        }
        seen, attributes = {}, {}
        settled = _settled(self.surface, self.made[id(common)][0])
        for sides in sorted({tuple(row[number] for number in met) for row in family.members.values()}):
            away = np.zeros(len(own), bool)
            for number, side in zip(met, sides, strict=True):
                if side:
                    away |= hidden[number, side]
            whole = list(first)
            for number, side in zip(met, sides, strict=True):
                whole[number] = side
            visible = own & ~away
            visible = visible if (visible & self.counts).any() else own
            lips = [
                Lip(faults[number], side, traces[number].beside(self.points[visible, :2]))
                for number, side in zip(met, sides, strict=True)
                if side
            ]
            sheet = self._interpolated(family, tuple(whole), visible, settled, lips)
            seen[sides], attributes[sides] = self._on_nodes(sheet), self.made[id(sheet)][:2]
        found = self._with_equal_ends(family, met, seen, attributes, meshed)
        return {sides: found[tuple(sides[number] for number in met)] for sides in family.members.values()}

    def drawn_together(self, family: Family, sheets: dict) -> dict[tuple[int, ...], Triangulation]:
        """Sheets of another family, by sides, for this one: its faults may die out elsewhere."""
        if len({id(sheet) for sheet in sheets.values()}) == 1:
            return sheets
        _, triangles = self.entry.region
        heights = {sides: self._on_nodes(sheet) for sides, sheet in sheets.items()}
        attributes = {sides: self.made[id(sheet)][:2] for sides, sheet in sheets.items()}
        known = np.isfinite(list(heights.values())).all(axis=0)
        meshed = np.ascontiguousarray(triangles[known[triangles].all(axis=1)])
        return self._with_equal_ends(family, range(len(family.dying)), heights, attributes, meshed)

    def _with_equal_ends(
        self, family: Family, some, heights: dict, attributes: dict, meshed: np.ndarray
    ) -> dict:
        """Sheets with some heights at the nodes, drawn together beyond the ends of some of the faults that
        die out. attributes: interpolation and vertex attributes of these sheets, likewise by sides."""
        nodes, triangles = self.entry.region
        shapes = self.entry.structure.faults.shapes
        faults = [family.dying[number] for number in some]
        ramp = _RAMP * median_edge(nodes, triangles)
        equal = with_equal_ends(
            self.work,
            nodes,
            meshed,
            heights,
            [shapes[fault] for fault in faults],
            self._within(family),
            [0.0 if fault in family.settled else ramp for fault in faults],
            self.threads,
        )
        found = shared({sides: where_known(nodes, triangles, z) for sides, z in equal.items()})
        for sides, sheet in found.items():
            self.made[id(sheet)] = (*attributes[sides], sheet)
        return found

    def _interpolated(
        self,
        family: Family,
        sides: tuple[int, ...],
        own: np.ndarray,
        surface=None,
        lips: Sequence[Lip] = (),
    ) -> Triangulation:
        """The sheet from some points; surfaces that it needs are those on these sides. surface: the same with
        other options. lips: at faults that die out here, of these points. Of heights on several sides of
        faults that die out, at one place, the mean counts."""
        entry = self.entry
        surfaces = list(entry.rock.surfaces)
        points = mean_heights(self.points[own]) if family.dying else self.points[own]
        points = np.concatenate([points, self._beyond(family, own, lips)])
        surfaces[self.number] = replace(surface or self.surface, points=points)
        if self.surface.minimum_thickness is not None:
            surfaces[self.number - 1] = self._with_own_points(family, surfaces[self.number - 1])
        shapes: list[Triangulation | None] = [None] * len(surfaces)
        for other in needed_surfaces(entry.rock, self.number):
            shapes[other] = self._as_seen(family, sides, other)
        one = replace(
            entry,
            rock=replace(entry.rock, surfaces=surfaces),
            surfaces=shapes,
            interpolations=[None] * len(surfaces),
            warnings=[],
            attributes={},
            structure=None,
        )
        give_heights(self.work, one, self.number, self.threads)
        sheet = one.surfaces[self.number]
        result = one.interpolations[self.number]
        # the sheet itself is kept, too: so no other gets its id
        self.made[id(sheet)] = (result, one.attributes[self.number], sheet)
        if own.sum() > self.most[0]:
            self.most = (int(own.sum()), result)
        for warning in one.warnings:
            entry.structure.warn(list(family.members), warning)
        return sheet

    def _beyond(self, family: Family, own: np.ndarray, lips: Sequence[Lip]) -> np.ndarray:
        """(K, 3) points beyond the faults at which the sheet ends, for a method that needs them."""
        points, shapes = self.points[own], self.entry.structure.faults.shapes
        whole = np.ones(len(points), bool)
        parting = [Lip(shapes[n], side, whole) for n, side in enumerate(family.key) if side in (-1, 1)]
        lips, options = [*parting, *lips], self.surface.method_options()
        return beyond_lips(self.work, points, lips, self.placed.reach, *options)

    def _with_own_points(self, family: Family, surface):
        """Another surface with only its points in the family's compartments."""
        if surface.points is None:
            return surface
        points = np.asarray(surface.points, np.float64).reshape(-1, 3)
        placed = point_sides(self.work, points, self.entry, self.number, self.threads)
        return replace(surface, points=points[self._within(family).has(placed.sides)])

    def _as_seen(self, family: Family, sides: tuple[int, ...], other: int) -> Triangulation:
        """Another surface in some compartments. Where faults displace it that this one ignores, each node of
        the planar mesh gets the height of the compartment in which the other surface lies there."""
        structure = self.entry.structure
        members = [each for each, its in family.members.items() if its == sides] or list(family.members)
        different = {id(structure.sheets[each][other]): structure.sheets[each][other] for each in members}
        if len(different) == 1:
            return next(iter(different.values()))
        nodes, triangles = self.entry.region
        chosen = np.full(len(nodes), np.nan)
        total, known = np.zeros(len(nodes)), np.zeros(len(nodes))
        for number, sheet in different.items():
            z = self._on_nodes(sheet)
            there = np.isfinite(z)
            total[there] += z[there]
            known += there
            at = np.column_stack([nodes, np.where(there, z, 0.0)])
            rows = sides_of(self.work, at, structure.faults, self.threads)
            its = [each for each in members if id(structure.sheets[each][other]) == number]
            inside = (rows[:, None] == structure.compartments[its]).all(axis=2).any(axis=1)
            chosen = np.where(there & inside & np.isnan(chosen), z, chosen)
        with np.errstate(invalid="ignore", divide="ignore"):
            heights = np.where(np.isnan(chosen), total / known, chosen)
        return where_known(nodes, triangles, heights)

    def _on_nodes(self, sheet: Triangulation) -> np.ndarray:
        """(N,) heights of a sheet at the nodes of the planar mesh; NaN where it has none."""
        nodes, _ = self.entry.region
        if len(sheet[0]) == len(nodes) and np.array_equal(sheet[0][:, :2], nodes):
            return sheet[0][:, 2]
        return heights_at(self.work, sheet, nodes, self.threads)

    def _within(self, family: Family) -> Within:
        return Within(self.work, self.entry, self.number, family, self.threads)

    def finish(self, sheets: list[Triangulation]) -> None:
        """Sets the RockInput's interpolation, to that of the compartment with most points, and its vertex
        attributes, to those of all sheets."""
        found = [self.made[id(sheet)][1] for sheet in sheets]
        self.entry.interpolations[self.number] = self.most[1]
        self.entry.attributes[self.number] = {
            name: np.concatenate([each[name] for each in found]) for name in ("variance", "distance")
        }


def _settled(surface, found):
    """The surface with the variogram that was found once: so the two sides of a fault have the same."""
    variogram = found.variogram
    if variogram is None or not variogram.fitted:
        return surface
    options = {key: value for key, value in surface.options.items() if key in METHODS[found.method].options}
    options |= {"variogram": variogram.settings(), "neighbours": found.neighbours}
    return replace(surface, method=found.method, options=options)
