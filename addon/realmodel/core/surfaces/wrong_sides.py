# SPDX-License-Identifier: GPL-3.0-or-later
"""Points of a surface on the wrong side of another one by the rules: usually errors in the data."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from ..base.errors import BuildWarning, number_list, place_text
from ..base.triangles import Sheet
from ..base.work import Work, native_module
from ..settings.rules import RULES, Rule
from .observed.surface_data import SurfaceData
from .rock_input import RockInput
from .shared_places import is_raster, places_of

_TIED = 1e-9  # of the range of its points: how near to them a surface is
_ROUNDING = 1e-15  # of a height
_SURVEY = 50  # points: fewer are contacts, each of which counts
_FEW = 0.02  # of a survey: so few points on the wrong side are errors, as all of them would be


def heights_at(work: Work, shape: Sheet, plan: np.ndarray) -> np.ndarray:
    """(N,) heights of a surface at places (N, 2), NaN where it has none."""
    surface_heights = native_module().surface_heights
    return work.native(surface_heights, *shape.arrays, np.ascontiguousarray(plan))


@dataclass(frozen=True)
class PlacesOnSheet:
    """Where places (N, 2) lie on a sheet, and on all that have its plan. corners: (N, 3) vertices; weights:
    (N, 2), of what the second and the third differ in height from the first; is_beside: (N,) bool."""

    sheet: Sheet
    plan: np.ndarray
    corners: np.ndarray
    weights: np.ndarray
    is_beside: np.ndarray

    @classmethod
    def of(cls, work: Work, sheet: Sheet, plan: np.ndarray) -> PlacesOnSheet:
        triangle, weights = work.native(native_module().surface_places, *sheet.arrays, plan)
        return cls(sheet, plan, sheet.triangles[triangle], weights, triangle < 0)

    def heights(self, sheet: Sheet) -> np.ndarray:
        """(N,) as heights_at has them, of a sheet with the same plan."""
        a, b, c = sheet.vertices[:, 2][self.corners.T]
        z = a + self.weights[:, 0] * (b - a)
        z += self.weights[:, 1] * (c - a)
        z[self.is_beside] = np.nan
        return z


def points_too_low(work: Work, entry: RockInput, numbers: Iterable[int]) -> list[BuildWarning]:
    """The points of surfaces of a RockInput, by their numbers, below what the rule of each keeps it above,
    where heights of all older ones are known. Each older surface is evaluated once for the points of all.

    A surface that does not cut ends on the top that is there, and any surface on one that protects itself; a
    minimum thickness keeps it above the one before it. What an older surface's points do above a younger
    one is no contradiction: there the younger one ends, or has cut.
    """
    surfaces, shapes = entry.rock.surfaces, entry.surfaces
    points = {number: entry.data[number].measured_points for number in numbers if number > 0}
    points = {number: xyz for number, xyz in points.items() if len(xyz)}
    beneath = {number: _Beneath(len(xyz)) for number, xyz in points.items()}
    for older in range(max(points, default=0)):
        shape = shapes[older]
        if shape is None:
            continue
        younger = [number for number in points if number > older]
        z = heights_at(work, shape, np.concatenate([points[n][:, :2] for n in younger]))
        ends = np.cumsum([len(points[number]) for number in younger])
        for number, z_beneath in zip(younger, np.split(z, ends[:-1]), strict=True):
            beneath[number].add(z_beneath, older, RULES[surfaces[older].rule])
    warnings = []
    for number, below in beneath.items():
        floor = below.firm if RULES[surfaces[number].rule].cuts else below.top
        is_kept_off = surfaces[number].minimum_thickness is not None
        if is_kept_off and below.last is not None and shapes[number - 1] is not None:
            floor.raise_to(below.last, number - 1)
        warnings += listed(entry, number, floor.z - points[number][:, 2], "below", floor.surface)
    return warnings


class _Beneath:
    """What there is beneath (N,) points: the top, and what may not be cut; last: the heights of the youngest
    surface of those that were added, oldest first."""

    def __init__(self, count: int):
        self.top, self.firm = _Floor(count), _Floor(count)
        self.last: np.ndarray | None = None

    def add(self, z: np.ndarray, number: int, rule: Rule) -> None:
        floor = _Floor(len(z))
        floor.raise_to(z, number)
        covered = np.isfinite(z)
        if not rule.cuts:
            floor.raise_to(np.where(covered, self.top.z, np.nan), self.top.surface)
        floor.raise_to(np.where(covered, self.firm.z, np.nan), self.firm.surface)
        self.top.take(floor, covered)
        if rule.protects:
            self.firm.take(floor, covered)
        self.last = z


class _Floor:
    """(N,) heights, and the surface that each is of."""

    def __init__(self, count: int):
        self.z = np.full(count, -np.inf)
        self.surface = np.full(count, -1)

    def raise_to(self, z: np.ndarray, surface: int | np.ndarray) -> None:
        higher = z > self.z  # never where NaN
        self.z = np.where(higher, z, self.z)
        self.surface = np.where(higher, surface, self.surface)

    def take(self, other: _Floor, where: np.ndarray) -> None:
        self.z = np.where(where, other.z, self.z)
        self.surface = np.where(where, other.surface, self.surface)


@dataclass(frozen=True)
class WrongPoints:
    """The points of a surface, by their numbers, that lie on the wrong side of others, and these; the
    farthest: its number, place, and how far."""

    items: tuple[int, ...]
    others: tuple[int, ...]
    worst: int
    place: tuple[float, ...]
    by: float

    @classmethod
    def of(
        cls, points: np.ndarray, beyond: np.ndarray, others: int | np.ndarray, numbers: np.ndarray
    ) -> WrongPoints | None:
        """None where all are right, up to the rounding of surfaces that meet at contacts of both. beyond: how
        far each of the points (N, 3) is; others: beyond which surface, one or (N,); numbers: theirs."""
        heights = points[:, 2]
        rounding = _TIED * np.ptp(heights) + _ROUNDING * np.abs(heights).max() if len(points) else 0.0
        wrong = np.flatnonzero(beyond > rounding)
        if not len(wrong):
            return None
        surfaces = np.unique(np.broadcast_to(others, beyond.shape)[wrong])
        worst = wrong[int(beyond[wrong].argmax())]
        return cls(
            tuple(numbers[wrong].tolist()),
            tuple(surfaces.tolist()),
            int(numbers[worst]),
            tuple(points[worst].tolist()),
            float(beyond[worst]),
        )

    def joined(self, other: WrongPoints) -> WrongPoints:
        """The wrong points of two parts of a surface."""
        worst = min((self, other), key=lambda part: (-part.by, part.worst))
        items, others = (
            tuple(sorted({*getattr(self, name), *getattr(other, name)})) for name in ("items", "others")
        )
        return replace(worst, items=items, others=others)

    def rows(self, data: SurfaceData) -> tuple[int, ...]:
        """The numbers that the points had in the table or array that they come from."""
        return tuple(sorted(map(data.row, self.items)))

    def is_part_of_survey(self, count: int) -> bool:
        """Whether they are a part of a survey of so many points, and not errors."""
        return count >= _SURVEY and _FEW < len(self.items) / count < 1 - _FEW

    def warning(self, entry: RockInput, number: int, count: int, side: str) -> BuildWarning:
        """count: of all points of the surface."""
        rock, data = entry.rock, entry.data[number]
        names = " and ".join(f"'{rock.surfaces[other].name}'" for other in self.others)
        surface = rock.surfaces[number]
        ends = side == "below" and not RULES[surface.rule].cuts and surface.minimum_thickness is None
        is_meant = ends and self.is_part_of_survey(count)
        advice = f"; its rule is {surface.rule}: it ends there, and no action is needed" if is_meant else ""
        text = (
            f"{points_that_lie(len(self.items), count)} {side} {names}, the farthest by "
            f"{self.by:.4g}: point {data.row(self.worst)} at {place_text(self.place)}"
            f"{advice or self._of_extrapolated(entry)}"
        )
        kind = "ends" if is_meant else "wrong_side"
        return BuildWarning(text, kind, rock.name, surface.name, self.rows(data))

    def _of_extrapolated(self, entry: RockInput) -> str:
        """What to add where the farthest point is beside the data of surfaces that it lies beyond."""
        place = np.array([self.place[:2]])
        named = []
        for number in self.others:
            points = entry.data[number].measured_points
            if len(points) and native_module().outside_hull(points, place)[0]:
                named.append(f"'{entry.rock.surfaces[number].name}'")
        if not named:
            return ""
        be = "is" if len(named) == 1 else "are"
        return f"; {' and '.join(named)} {be} extrapolated there, and may be wrong instead"


def points_that_lie(some: int, count: int) -> str:
    """'its only point lies', or '2 of its 5 points lie'."""
    return "its only point lies" if count == 1 else f"{some} of its {count} points lie"


def listed(
    entry: RockInput, number: int, beyond: np.ndarray, side: str, others: int | np.ndarray
) -> list[BuildWarning]:
    """The warning about the points of a surface on the wrong side of other surfaces. beyond: (N,) how far;
    others: the numbers of these surfaces, one or (N,)."""
    points = entry.data[number].points
    wrong = WrongPoints.of(points, beyond, others, np.arange(len(points)))
    return [] if wrong is None else [wrong.warning(entry, number, len(points), side)]


_MOST = 20_000  # points that are picked; more are a survey, and may be of another time


def points_above_younger(entry: RockInput, numbers: Collection[int]) -> list[BuildWarning]:
    """The points of surfaces, of these numbers, that contradict the order of a RockInput that is read.

    Two points in one hole contradict it wherever the older one lies higher. Points with
    the same x and y do where most of two surfaces are so: single ones may be of a surface that was continued
    above the ground. Rasters are left out: they may be of one ground at several times.
    """
    surfaces, data = entry.rock.surfaces, entry.data
    checked = [n for n in sorted(numbers) if _may_be_picks(data[n].measured_points)]
    points = {n: data[n].points for n in checked}
    places = dict(zip(checked, places_of(list(points.values())), strict=True)) if checked else {}
    wrong_points: dict[int, WrongPoints] = {}
    holes: dict[int, list[str]] = {}
    for older, younger in combinations(checked, 2):
        if RULES[surfaces[older].rule].protects or not RULES[surfaces[younger].rule].cuts:
            continue  # the points of the younger one are examined instead: wrong_sides
        if younger == older + 1 and surfaces[younger].minimum_thickness is not None:
            continue  # found where this is imposed
        older_rows, younger_rows, names = _in_one_hole(data[older], data[younger])
        if not len(older_rows):
            older_rows, younger_rows = places[older].shared_with(places[younger])
        above = points[older][older_rows]
        beyond = above[:, 2] - points[younger][younger_rows, 2]
        if not names and 2 * (beyond > 0).sum() <= (beyond != 0).sum():
            continue
        by_number = np.argsort(older_rows)
        wrong = WrongPoints.of(above[by_number], beyond[by_number], younger, older_rows[by_number])
        if wrong is not None:
            wrong_points[older] = wrong_points[older].joined(wrong) if older in wrong_points else wrong
            holes.setdefault(older, []).extend(
                name for name, by in zip(names, beyond, strict=False) if by > 0
            )
    return [_warning(entry, older, wrong, holes[older]) for older, wrong in wrong_points.items()]


def _may_be_picks(points: np.ndarray) -> bool:
    return 0 < len(points) <= _MOST and not is_raster(points)


def _warning(entry: RockInput, older: int, wrong: WrongPoints, holes: list[str]) -> BuildWarning:
    rock, data = entry.rock, entry.data[older]
    row = data.row(wrong.worst)
    names = number_list([f"'{rock.surfaces[younger].name}'" for younger in wrong.others])
    text = (
        f"{points_that_lie(len(wrong.items), len(data.points))} above those of {names} at the "
        f"same place, the farthest by {wrong.by:.4g}: point {row} at {place_text(wrong.place)}"
    )
    if holes:
        text += f"; holes {number_list(dict.fromkeys(holes))}"
    text += "; a younger surface removes what is above it: check the order of the surfaces, and these points"
    return BuildWarning(text, "wrong_side", rock.name, rock.surfaces[older].name, wrong.rows(data))


def _in_one_hole(first: SurfaceData, second: SurfaceData) -> tuple[np.ndarray, np.ndarray, list[str]]:
    """The numbers of the points of two surfaces in the holes that meet both, (N,) each, and the holes."""
    first_rows, second_rows = (
        {source.hole: row for row, sources in data.sources.items() for source in sources}
        for data in (first, second)
    )
    holes = sorted(first_rows.keys() & second_rows.keys())
    rows = np.array([(first_rows[hole], second_rows[hole]) for hole in holes], int).reshape(-1, 2)
    return rows[:, 0], rows[:, 1], holes
