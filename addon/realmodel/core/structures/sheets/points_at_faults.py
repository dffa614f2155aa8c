# SPDX-License-Identifier: GPL-3.0-or-later
"""The sides of points that lie on a fault, near it or beyond it: those whose other points they agree with."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ...base.algebra import are_among
from ...base.errors import BuildWarning, place_text
from ...base.work import Work, native_module, on_threads
from ...heights.mis_ties import (
    LARGEST_SHARE,
    contradictions,
    first_at_each_place,
    heights_apart,
)
from ...settings.dips import Dips
from ...surfaces.observed.surface_data import SurfaceData
from ...surfaces.rock_input import RockInput
from ...surfaces.rock_structure import FaultShape, sides_of

if TYPE_CHECKING:
    from ...._native import Native

_NEAR = 0.25  # of an edge length: nearer to a fault, the position does not decide
_EXPECTED_BY = 16  # points: so many predict a height
_PLANE = 1e6  # a spline so smooth is a plane
_LEAST = 1e-3  # of the range of heights: nearer to what is expected, a point agrees
_SURE = 0.25  # of the distance from what another side predicts: so near, a point counts for its side
_PASSES = 40  # times that points which count predict more
_FEW = 0.01  # of the points: so few predict nothing more
_SHIFTS = np.array([[[0.0, 0.0]], [[1.0, 0.0]], [[0.0, 1.0]]])


class PointSides(NamedTuple):
    """Of points and faults: sides (P, F) int8, to which the points belong; moved (P, F) bool, where these are
    not the sides on which they lie; reach: as distances gives it, and of points nearer than that to a fault
    that displaces the surface its nearest triangle (P, F), else -1."""

    sides: np.ndarray
    moved: np.ndarray
    reach: float
    nearest: np.ndarray

    def some(self, chosen: np.ndarray) -> PointSides:
        """Of some of the points, (P,) bool."""
        return PointSides(self.sides[chosen], self.moved[chosen], self.reach, self.nearest[chosen])


def point_sides(work: Work, points: np.ndarray, entry: RockInput, number: int) -> PointSides:
    """The sides of the faults that points (P, 3) of surface `number` of a RockInput belong to.

    A point that is near a fault that displaces the surface (distances) gets the sides of those points, beside
    no fault, that predict a height nearest to its own. Where only one side has such points, its position
    decides, unless some of the points near the fault agree with them and others do not: these are of the
    other side. Contacts that follow from observations stay where they lie: so do the bounds that do, and what
    meets at a fault is no contact.
    """
    structure = entry.divided()
    faults = structure.faults
    sides = sides_of(work, points, faults)
    active = faults.active(number)
    away, nearest = np.full(sides.shape, np.inf), np.full(sides.shape, -1, np.int32)
    shapes = [faults.shapes[fault] for fault in np.flatnonzero(active)]
    reach, away[:, active], nearest[:, active] = distances(points, entry.median_edge(), shapes)
    near, beside = away < reach, np.isfinite(away)
    nearest[~near] = -1
    near &= ~are_among(points, entry.data[number].contacts)[:, None]
    agreement = _Agreement(
        work=work,
        points=points,
        rows=np.where(active, sides, 0),
        compartments=np.unique(np.where(active, structure.compartments, 0), axis=0),
        # far from one that dies out its sides are one
        matters=active & (beside | ~np.array(faults.dies_out, bool)),
        counts=~beside.any(axis=1),
        reach=reach,
    )
    agreement.place(near, beside)
    placed = np.where(active, agreement.rows, sides)
    return PointSides(placed, placed != sides, reach, nearest)


class _Choice(NamedTuple):
    """Of some points (N,), by number, for which the same faults matter, (F,) bool: rows (C, F) of sides that
    compartments have, 0 for other faults; possible (N, C) bool, those that each may belong to; own (N, C)
    bool, where it lies. reach: how far they may be from their place on a fault."""

    points: np.ndarray
    matters: np.ndarray
    rows: np.ndarray
    possible: np.ndarray
    own: np.ndarray
    reach: float


@dataclass
class _Agreement:
    """Points (P, 3), and the sides of faults that they agree with.

    rows: (P, F) int8, their sides, changed; matters: (P, F) bool, of which faults these count; compartments:
    (C, F), the rows that there are; counts: (P,) bool, the points whose sides are known, changed.
    """

    work: Work
    points: np.ndarray
    rows: np.ndarray
    compartments: np.ndarray
    matters: np.ndarray
    counts: np.ndarray
    reach: float

    @cached_property
    def _splines(self) -> Native.SplinesOfSome:
        return native_module().SplinesOfSome(self.points)

    def place(self, near: np.ndarray, beside: np.ndarray) -> None:
        """Gives points near faults the sides that they agree with. Points beside faults keep theirs, but do
        not count where they agree with another: a horizon may reach beyond its fault. near, beside: (P, F)
        bool. Points that clearly agree with a side count from then on, for what the others may
        expect."""
        is_near = near.any(axis=1)
        places = self._choices(np.flatnonzero(is_near), near, self.reach)
        others = self._choices(np.flatnonzero(beside.any(axis=1) & ~is_near), beside, 0.0)
        for _ in range(_PASSES):
            if not (self._count_some(others) or self._place_some(places) or self._count_some(others, True)):
                break
        for choice in places:
            left = ~self.counts[choice.points]
            best = _best(choice, *self._off(choice))
            self._give(choice, left & (best >= 0), best)

    def _place_some(self, choices: list[_Choice]) -> bool:
        """Places those that clearly agree with one side; whether there were any."""
        new = 0
        for choice in choices:
            off, tolerated = self._off(choice)
            sure = _are_sure(off, tolerated)
            self._give(choice, sure, off.argmin(axis=1))
            self.counts[choice.points[sure]] = True
            new += int(sure.sum())
        return new > _FEW * sum(len(choice.points) for choice in choices)

    def _count_some(self, choices: list[_Choice], doubtful: bool = False) -> bool:
        """Lets those count that clearly agree with their own side; doubtful: those that agree with it at all,
        or of whose own side nothing is known. Whether there were any."""
        new = 0
        for choice in choices:
            off, tolerated = self._off(choice)
            own_off = np.where(choice.own, off, np.inf).min(axis=1)
            other = np.where(choice.own, np.inf, off).min(axis=1)
            agree = (
                (own_off <= other) | np.isinf(own_off)
                if doubtful
                else _are_sure(off, tolerated) & (own_off < other)
            )
            agree &= ~self.counts[choice.points]
            self.counts[choice.points[agree]] = True
            new += int(agree.sum())
        return new > _FEW * sum(len(choice.points) for choice in choices)

    def _give(self, choice: _Choice, some: np.ndarray, best: np.ndarray) -> None:
        points = choice.points[some]
        self.rows[points] = np.where(choice.matters, choice.rows[best[some]], self.rows[points])

    def _choices(self, some: np.ndarray, unclear: np.ndarray, reach: float) -> list[_Choice]:
        """unclear: (P, F) bool, the faults whose sides are to be chosen."""
        choices = []
        patterns, which = np.unique(self.matters[some], axis=0, return_inverse=True)
        for number, matters in enumerate(patterns):
            points = some[which.ravel() == number]
            rows = np.unique(np.where(matters, self.compartments, 0), axis=0)
            own_rows = np.where(matters, self.rows[points], 0)[:, None]
            alike = (rows == own_rows) | (rows == 0) | (own_rows == 0) | unclear[points, None]
            is_own = (rows == own_rows).all(axis=2)
            choices.append(_Choice(points, matters, rows, alike.all(axis=2), is_own, reach))
        return choices

    def _off(self, choice: _Choice) -> tuple[np.ndarray, np.ndarray]:
        """(N, C) how far the points are from what those that count predict, infinite where these say
        nothing and for points that count themselves; and how far they may be and agree: what a place within
        reach would change, or a plane instead of a spline."""
        off, tolerated = np.full(choice.possible.shape, np.inf), np.zeros(choice.possible.shape)
        least = _LEAST * float(np.ptp(self.points[:, 2]))
        asked = choice.possible & ~self.counts[choice.points, None]
        shifts = choice.reach * _SHIFTS[: 3 if choice.reach else 1]
        for number in np.flatnonzero(asked.any(axis=0)).tolist():
            counts = self._points_on_sides(choice, number)
            if counts.any():
                some = asked[:, number]
                plan, z = self.points[choice.points[some], :2], self.points[choice.points[some], 2]
                around = (plan + shifts).reshape(-1, 2)
                heights = self.work.native(self._splines.heights, counts, around, (0.0, _PLANE), _EXPECTED_BY)
                (expected, *_), planes = heights.reshape(2, -1, len(plan))
                rise = np.abs(planes[1:] - planes[0]).sum(axis=0)
                off[some, number] = np.abs(expected - z)
                tolerated[some, number] = np.abs(expected - planes[0]) + rise + least
        return off, tolerated

    def _points_on_sides(self, choice: _Choice, number: int) -> np.ndarray:
        """(P,) bool: those that count, on these sides of the faults that matter."""
        counts = self.counts.copy()
        for fault in np.flatnonzero(choice.matters):
            counts &= self.rows[:, fault] == choice.rows[number, fault]
        return counts


def _are_sure(off: np.ndarray, tolerated: np.ndarray) -> np.ndarray:
    """(N,) bool: the points that clearly agree with one side: they are far from others, farther than it is
    known what to expect."""
    if off.shape[1] < 2:
        return np.zeros(len(off), bool)
    order = np.argsort(off, axis=1)[:, :2]
    (best, second), tolerances = (np.take_along_axis(values, order, axis=1).T for values in (off, tolerated))
    return np.isfinite(second) & (best <= _SURE * second) & (second > tolerances.sum(axis=0))


def _best(choice: _Choice, off: np.ndarray, tolerated: np.ndarray) -> np.ndarray:
    """(N,) the row of sides that each point belongs to; -1 where it stays where it is."""
    best = off.argmin(axis=1)
    is_known = np.isfinite(off.min(axis=1))
    of_own = np.where(choice.own, off, np.inf).min(axis=1)
    placed = np.where(is_known & (np.isfinite(of_own) | ~choice.own.any(axis=1)), best, -1)
    agrees = is_known & (off <= tolerated).any(axis=1)
    for other in np.flatnonzero(np.isinf(off).all(axis=0)):  # no points that count
        strange = choice.possible[:, other] & is_known & ~agrees
        if strange.any():
            placed[strange & (choice.own[:, other] | np.isfinite(of_own))] = other
            placed[agrees & choice.own[:, other]] = best[agrees & choice.own[:, other]]
    return placed


def placed_warning(
    points: np.ndarray, moved: np.ndarray, names: list[str], rock: str, surface: str
) -> BuildWarning | None:
    """The warning about points that are not on the side on which they lie; None where there are none."""
    count = int(moved.any(axis=1).sum())
    if not count:
        return None
    of = [f"'{names[fault]}'" for fault in np.flatnonzero(moved.any(axis=0))]
    first = points[int(moved.any(axis=1).argmax())]
    text = (
        f"{count} of its {len(points)} points, one at {place_text(first)}, lie on or just beyond fault"
        f"{'s' if len(of) > 1 else ''} {', '.join(of)}, and are assigned to the side that they fit best"
    )
    return BuildWarning(text, "points", rock, surface)


def expected_heights(work: Work, points: np.ndarray, plan: np.ndarray) -> np.ndarray:
    """(N,) the heights at plan points (N, 2) of splines through the nearest of points (P, 3), no two of which
    are at one place."""
    spline, near = native_module().spline, (_EXPECTED_BY, 0, 0.0)
    return work.native(spline, points, np.ascontiguousarray(plan), neighborhood=near)


def distances(
    points: np.ndarray, length: float, shapes: list[FaultShape]
) -> tuple[float, np.ndarray, np.ndarray]:
    """How near to a fault points (P, 3) may be on its cutoff line; (P, F) how far they are from faults, if
    less than an edge length, else infinite; and (P, F) the nearest triangle of each fault, else -1.

    That near is a quarter of an edge length, or of the mean spacing of the points farther away, where it is
    less. Cutoff lines may have many points, and say nothing of that spacing.
    """
    away = np.full((len(points), len(shapes)), np.inf)
    triangle = np.full(away.shape, -1, np.int32)
    nearest = native_module().nearest_triangles
    for fault, shape in enumerate(shapes):
        corners = shape.vertices[shape.triangles]
        triangle[:, fault], away[:, fault] = nearest(corners, points, length, execution=on_threads(1))
    ordinary = points[(away >= _NEAR * length).all(axis=1)]
    spacing = _spacing(ordinary) if len(ordinary) > 1 else np.inf
    return _NEAR * min(length, spacing), away, triangle


def _spacing(points: np.ndarray) -> float:
    """The mean spacing in plan; of points on a line that along it."""
    along = float(np.ptp(points[:, :2], axis=0).max()) / len(points)
    return max(float(native_module().mean_spacing(np.ascontiguousarray(points), are_apart=True)), along)


def at_height(dips: Dips, height: float | np.ndarray) -> np.ndarray:
    """(D, 3) the places of dips; heights, or one, of those that have none."""
    return np.column_stack([dips.positions, np.where(np.isfinite(dips.heights), dips.heights, height)])


def sided_dips(work: Work, data: SurfaceData, entry: RockInput) -> tuple[Dips | None, np.ndarray]:
    """The dips of a surface and, for each, its sides (D, F) of the faults. A dip without a height has that of
    the nearest point of the surface."""
    dips, faults = data.dips, entry.divided().faults
    if dips is None or not len(dips):
        return None, np.zeros((0, len(faults)), np.int8)
    height = np.zeros(len(dips))
    points = data.points
    if len(points):
        nearest = (1, 0, 0.0)
        positions = np.ascontiguousarray(dips.positions)
        distinct = first_at_each_place(points)
        height = work.native(native_module().idw, distinct, positions, neighborhood=nearest)
    return dips, sides_of(work, at_height(dips, height), faults)


_LOOKED_AT = 16  # nearest points, whose sides are considered
_COUNTED = 4  # points of each side, whose mean height is the expected one
_BETTER = 2.0  # times nearer: a point alone at its place must fit other sides so much better


def contradicting(points: np.ndarray, rows: np.ndarray, contacts: np.ndarray) -> np.ndarray:
    """(P,) bool: of points (P, 3) those that others at their place in plan contradict; none where these are
    all. Of a hole that passes a fault, contacts (C, 3) that follow from observations are on their sides."""
    contradicted = beyond_faults(points, rows) & ~are_among(points, contacts)
    left = np.flatnonzero(~contradicted)
    contradicted[left[contradictions(np.column_stack([points, rows])[left])]] = True
    return contradicted & ~contradicted.all()


def beyond_faults(points: np.ndarray, rows: np.ndarray) -> np.ndarray:
    """(P,) bool: of points (P, 3) at places with several heights those that are on the wrong side of a fault,
    and those beside them that are.

    rows: (P, F) their sides. A point is on the wrong side where its height is nearer to that of its neighbors
    on other sides than to that of those on its own. Neighbors are points that are alone at their place.
    """
    is_beyond = np.zeros(len(points), bool)
    several = heights_apart(points) > 0
    if not several.any() or several.all():
        return is_beyond
    _, row = np.unique(rows, axis=0, return_inverse=True)
    row = row.ravel()
    tolerated = LARGEST_SHARE * np.ptp(points[:, 2])
    tried = np.flatnonzero(several)
    while len(tried):
        references = np.flatnonzero(~several & ~is_beyond)
        if not len(references):
            break
        find = native_module().nearest_points
        found, _ = find(points[references, :2], points[tried, :2], _LOOKED_AT + 1, execution=on_threads(1))
        near = np.where(found >= 0, references[found], len(points))
        last = 2 * (near == len(points)) + (near == tried[:, None])  # none, and before these the point itself
        near = np.take_along_axis(near, np.argsort(last, axis=1, kind="stable"), axis=1)[:, :_LOOKED_AT]
        own_off, other = _off(points, row, near, tried)
        wrong = own_off > np.where(several[tried], other, np.maximum(tolerated, _BETTER * other))
        is_beyond[tried[wrong]] = True
        beside = np.unique(near[wrong])
        beside = beside[beside < len(points)]
        tried = beside[~is_beyond[beside]]
    return is_beyond


def _off(
    points: np.ndarray, row: np.ndarray, near: np.ndarray, tried: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """(N,) the differences of the heights of points, by number, from their neighbors on their own side, and
    from those on the other side that fits best; 0 and infinite where there are none. near: (N, K) their
    neighbors, nearest first; as many as there are points: none."""
    z, side = np.append(points[:, 2], 0.0)[near], np.append(row, -1)[near]
    own_off, other = np.zeros(len(tried)), np.full(len(tried), np.inf)
    for its in np.unique(side[side >= 0]):
        counted = side == its
        counted &= counted.cumsum(axis=1) <= _COUNTED
        some = counted.any(axis=1)
        total = np.zeros(len(tried))
        # one by one: the order says how it is rounded
        for heights, counts in zip(z.T, counted.T, strict=True):
            total[counts] += heights[counts]
        off = np.abs(total[some] / counted[some].sum(axis=1) - points[tried[some], 2])
        is_own = row[tried[some]] == its
        own_off[some] = np.where(is_own, off, own_off[some])
        other[some] = np.where(is_own, other[some], np.minimum(off, other[some]))
    return own_off, other
