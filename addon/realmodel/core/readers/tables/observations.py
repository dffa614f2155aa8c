# SPDX-License-Identifier: GPL-3.0-or-later
"""Observations of blocks at places, from arrays and tables, and what of them was left out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ...base.algebra import ascending, norm, ranks_in_runs
from ...base.errors import InputRefused, place_text
from ...base.text import Step, no_step
from ...base.units import MODEL_UNIT, factors
from ...notebook import ShortRepr
from ...settings.data_files import ObservationFile
from .hole_problems import LEFT_OUT, HoleProblem
from .hole_tables import OBSERVED, Row, rows_in_one_unit
from .unit_names import UnitNames

# Of the range of heights: so far within its bounds a surface is kept, where there is room. A bound says that
# rock beside the surface is there, not that it ends there: two sheets on one bound would leave none.
BESIDE_BOUND = 1e-6
_ARRAYS = (
    *("places", "blocks", "holes", "depths", "intervals", "used", "on", "height_errors", "thicknesses"),
    "rows",
)


@dataclass(frozen=True, eq=False, repr=False)
class Observations(ShortRepr):
    """Places that are known to lie in a block, or on its boundary.

    places: (N, 3) float64, model units. blocks: (N,) texts, each the name of the surface that the block lies
    beneath, of the block, or of a body. holes: (N,) texts, the borehole of each, "" for none; the places of a
    hole follow one another downward along it. depths: (N,) float64 along the hole, NaN where there is none.
    An interval is at least two places, its ends: a place that two intervals share is on the boundary of both.
    intervals: (N,) int64, equal for the places of one interval, so that two of one block with lost core
    between them are two; without them places of one block that follow one another in a hole are one interval.
    used: (N,) bool, False where one is switched off, which says nothing then; without it all are used.
    on: (N,) texts, the surface on which each was seen, as the ground of a map, by its name, "" for none: it
    passes through the place, too. height_errors: (N,) float64, how far the height of each may be off, as a
    standard deviation in model units; without it heights are exact. thicknesses: (N,) float64, of the block
    there, perpendicular to its beds, in model units, NaN where it is not known, as everywhere without it; a
    field of a series honors them. rows: (N,) int64, the numbers that they had before they were put in order
    (along_holes), for messages; without it these.

    Raises InputRefused for arrays that do not fit together.

    >>> Observations([[0, 0, 5], [0, 0, 2]], ["sand", "clay"]).holes.tolist()
    ['', '']
    """

    places: np.ndarray
    blocks: np.ndarray
    holes: np.ndarray = field(default_factory=lambda: np.empty(0, str))
    depths: np.ndarray = field(default_factory=lambda: np.empty(0))
    intervals: np.ndarray = field(default_factory=lambda: np.empty(0, np.int64))
    used: np.ndarray = field(default_factory=lambda: np.empty(0, bool))
    on: np.ndarray = field(default_factory=lambda: np.empty(0, str))
    height_errors: np.ndarray = field(default_factory=lambda: np.empty(0))
    thicknesses: np.ndarray = field(default_factory=lambda: np.empty(0))
    rows: np.ndarray = field(default_factory=lambda: np.empty(0, np.int64))

    def __post_init__(self) -> None:
        try:
            places = np.ascontiguousarray(self.places, np.float64).reshape(-1, 3)
            depths = np.asarray(self.depths, np.float64).reshape(-1)
        except (TypeError, ValueError) as error:
            raise InputRefused(
                f"not an array of numbers: {error}", item="observations", advice="places are x, y, z"
            ) from error
        count = len(places)
        blocks, holes = (np.asarray(texts, str).reshape(-1) for texts in (self.blocks, self.holes))
        holes = holes if len(holes) else np.full(count, "")
        depths = depths if len(depths) else np.full(count, np.nan)
        if not np.isfinite(places).all():
            bad = int(np.flatnonzero(~np.isfinite(places).all(axis=1))[0])
            raise InputRefused(f"place {bad} is {place_text(places[bad])}, not finite", item="observations")
        if not len(blocks) == len(holes) == len(depths) == count:
            what = f"{count} places have {len(blocks)} blocks, {len(holes)} holes and {len(depths)} depths"
            raise InputRefused(what, item="observations", advice="give each place one of each")
        intervals = np.asarray(self.intervals, np.int64).reshape(-1)
        used = np.asarray(self.used, bool).reshape(-1)
        on = np.asarray(self.on, str).reshape(-1)
        errors = np.asarray(self.height_errors, np.float64).reshape(-1)
        thicknesses = np.asarray(self.thicknesses, np.float64).reshape(-1)
        rows = np.asarray(self.rows, np.int64).reshape(-1)
        optional = {"numbers of intervals": intervals, "of 'used'": used, "of 'on'": on, "errors": errors}
        optional |= {"thicknesses": thicknesses, "numbers of rows": rows}
        for what, values in optional.items():
            if len(values) not in (0, count):
                text = f"{count} places have {len(values)} {what}"
                raise InputRefused(text, item="observations", advice="give each place one, or none of them")
        if not (np.isfinite(errors) & (errors >= 0)).all():
            raise InputRefused("an error of an elevation is negative, or not finite", item="observations")
        if not (np.isnan(thicknesses) | (thicknesses > 0) & (thicknesses < np.inf)).all():
            raise InputRefused("a thickness is not above 0, or not finite", item="observations")
        arrays = places, blocks, holes, depths, intervals, used, on, errors, thicknesses, rows
        for name, value in zip(_ARRAYS, arrays, strict=True):
            object.__setattr__(self, name, value)

    def __len__(self) -> int:
        return len(self.places)

    def some(self, chosen: np.ndarray) -> Observations:
        """Some of them. chosen: (N,) bool, or numbers of rows."""
        arrays = (getattr(self, name) for name in _ARRAYS)
        return Observations(*(array[chosen] if len(array) else array for array in arrays))

    @property
    def in_use(self) -> np.ndarray:
        """(N,) bool: which are not switched off."""
        return self.used if len(self.used) else np.ones(len(self), bool)

    @property
    def seen_on(self) -> np.ndarray:
        """(N,) texts: the surface on which each was seen, "" for none."""
        return self.on if len(self.on) else np.full(len(self), "")

    @property
    def errors(self) -> np.ndarray:
        """(N,) how far the height of each may be off."""
        return self.height_errors if len(self.height_errors) else np.zeros(len(self))

    @property
    def thicknesses_there(self) -> np.ndarray:
        """(N,) the thickness of the block of each there; NaN where it is not known."""
        return self.thicknesses if len(self.thicknesses) else np.full(len(self), np.nan)

    def along_holes(self) -> Observations:
        """The same in an order that the order of rows does not decide: those of no hole by their places, then
        hole by hole, by name, downward along each: by depths, or by heights where some have no depth."""
        names, number = np.unique(self.holes, return_inverse=True)
        number = number.ravel()
        without = np.bincount(number, np.isnan(self.depths), len(names)) > 0
        along = np.where(without[number], -self.places[:, 2], self.depths)
        has_hole = self.holes != ""
        columns = np.where(has_hole, along, 0.0), *self.places.T, self.blocks
        thicknesses = np.nan_to_num(self.thicknesses_there)  # 0 is none of them
        order = ascending(number, *columns, self.seen_on, self.errors, thicknesses, ~self.in_use)
        ordered = replace(self, rows=self.rows if len(self.rows) else np.arange(len(self))).some(order)
        return ordered.some(ordered._continued())

    def _continued(self) -> np.ndarray:
        """(N,) the rows; of two at one depth of a hole, where blocks meet, that of the block above first."""
        rows = list(range(len(self)))
        of = list(zip(self.holes.tolist(), self.blocks.tolist(), self._interval_numbers(), strict=True))
        same = (self.places[1:] == self.places[:-1]).all(axis=1) & (self.holes[1:] != "")
        for row in np.flatnonzero(same & (self.holes[1:] == self.holes[:-1])).tolist():
            if row and of[rows[row + 1]] == of[rows[row - 1]]:
                rows[row], rows[row + 1] = rows[row + 1], rows[row]
        return np.array(rows, np.int64)

    def _interval_numbers(self) -> list[int]:
        return self.intervals.tolist() if len(self.intervals) else [0] * len(self)

    @property
    def goes_on(self) -> np.ndarray:
        """(N,) bool, the places that are in one interval with the one before."""
        same = (self.holes[1:] == self.holes[:-1]) & (self.holes[1:] != "")
        same &= self.blocks[1:] == self.blocks[:-1]
        if len(self.intervals):
            _, number = np.unique(self.intervals, return_inverse=True)
            rows = np.arange(len(self))
            last = np.zeros(number.max() + 1, np.int64)
            last[number] = rows  # of several the last one counts
            same &= np.maximum.accumulate(last[number])[:-1] >= rows[1:]
        return np.append(False, same)[: len(self)]

    def logs(self) -> dict[str, Observations]:
        """The places of intervals of each hole that has some, downward along it."""
        ordered = self.along_holes()
        in_interval = ordered.goes_on
        in_interval[:-1] |= in_interval[1:]
        ordered = ordered.some(in_interval)
        return {
            str(hole): ordered.some(ordered.holes == hole) for hole in dict.fromkeys(ordered.holes.tolist())
        }

    def row(self, number: int) -> int:
        """The number that one of them had before they were put in order."""
        return int(self.rows[number]) if len(self.rows) else number

    def source(self, row: int) -> str:
        """Where one of them comes from, for messages."""
        return source_text(str(self.holes[row]), float(self.depths[row]), self.places[row])

    @classmethod
    def joined(cls, parts: Sequence[Observations]) -> Observations:
        """Several, `parts`, one after another."""
        if not parts:
            return cls(np.empty((0, 3)), np.empty(0, str))
        *arrays, intervals, used, on, errors, thicknesses, _ = (
            [getattr(part, name) for part in parts] for name in _ARRAYS
        )
        if any(map(len, intervals)):
            intervals = [np.cumsum(~part.goes_on) for part in parts]
            firsts = np.cumsum([0, *(int(numbers.max(initial=0)) for numbers in intervals[:-1])])
            intervals = [numbers + first for numbers, first in zip(intervals, firsts.tolist(), strict=True)]
        if any(map(len, used)):
            used = [part.in_use for part in parts]
        if any(map(len, on)):
            on = [part.seen_on for part in parts]
        if any(map(len, errors)):
            errors = [part.errors for part in parts]
        if any(map(len, thicknesses)):
            thicknesses = [part.thicknesses_there for part in parts]
        arrays += [intervals, used, on, errors, thicknesses]
        return cls(*map(np.concatenate, arrays))


def in_one_interval(given: Observations, used: np.ndarray) -> np.ndarray:
    """(R,) bool, the rows that are in one interval with the one before. used: (R,) bool, those that count."""
    follows = given.goes_on & used
    follows[1:] &= used[:-1]
    return follows


def source_text(hole: str, depth: float, place: Sequence[float] | np.ndarray) -> str:
    """The hole with the depth, or the place where there is none: hole 'B1' at 12.5; else the place alone."""
    at = place_text(np.asarray(place).tolist())
    if not hole:
        return at
    return f"hole '{hole}' at {at if np.isnan(depth) else format(depth, '.9g')}"


class Origin(NamedTuple):
    """Where a datum comes from. hole: the borehole, "" for none; depth: along it, model units, None where it
    is not known. file, line: of its row in a table, None and 0 where it has none."""

    hole: str = ""
    depth: float | None = None
    file: Path | None = None
    line: int = 0

    @classmethod
    def of(cls, hole: str, depth: float, file: Path | None = None, line: int = 0) -> Origin:
        """The same of a depth that is NaN where it is not known."""
        return cls(str(hole), None if np.isnan(depth) else float(depth), file, line)


@dataclass(frozen=True)
class LeftOut:
    """An observation that is not used. kind: a word of KINDS, or SWITCHED_OFF. text: what and why. block: its
    name. hole: its name, "" for none. depth: along it, None where there is none. place: (x, y, z) in model
    units, None where it is not known. contradicts: what the others say that it contradicts, which are used;
    each with its hole and depth, or its place."""

    kind: str
    text: str
    block: str = ""
    hole: str = ""
    depth: float | None = None
    place: tuple[float, ...] | None = None
    contradicts: tuple[str, ...] = ()


def unknown_block(
    where: str, code: str, hole: str = "", depth: float | None = None, place: tuple[float, ...] | None = None
) -> LeftOut:
    """What is left out as its name, `code`, means no block. where: it in messages."""
    text = f"{where}: this is no block, surface or body, or several blocks; give its meaning in names"
    return LeftOut("unknown_block", text, code, hole, depth, place)


def left_out_of(problems: Sequence[HoleProblem]) -> list[LeftOut]:
    """The intervals and picks among the problems of tables that are left out."""
    return [
        LeftOut(
            problem.kind,
            problem.text,
            problem.code,
            problem.hole,
            None if np.isnan(problem.depth) else problem.depth,
        )
        for problem in problems
        if problem.code is not None and problem.action == LEFT_OUT
    ]


# Why observations are not used, by the kind of their warning: found in their tables, or from their places.
IN_TABLES = {
    "overlap": "intervals or polygons of different blocks overlap, and what both claim is not used",
    "from_to": "intervals end above where they begin, and are not used",
    "no_depth": "intervals or picks have no depth, or observations no place, and are not used",
    "no_collar": "intervals or picks are of holes whose collars are not known, and are not used",
    "unknown_block": "intervals, observations and polygons are of no known block, and say nothing",
    "dip_unit": "dips are of no surface or block of the rock mass, and are not used: give their meaning",
    "dip_series": "dips of a series are of no surface of it, or of a block beside one, and are not used",
    "dip_surface": "dips count for no surface, as only surfaces that cut them bound their block",
}
SWITCHED_OFF = "switched_off"  # by the user: no warning
KINDS = {
    **IN_TABLES,
    "wrong_order": "observations have an older block above a younger one, or a block twice, and are not used",
    "contradiction": "observations contradict others, of which as few as possible are left out",
    "in_body": "observations contradict a body, and are not used",
    "at_fault": "parts of intervals lie between a fault or a body and another block, and are not used",
    "no_surface": "observations are of blocks that cannot be there, and are not used",
    "not_adjacent": "contacts are between blocks that do not follow one another in a series, and say nothing",
}


@dataclass(frozen=True, eq=False, repr=False)
class Bounds(ShortRepr):
    """Elevations at or above which, or at or below which, a surface lies.

    places: (N, 3) float64, model units; with faults a bound counts in the compartment of its place. is_lower:
    (N,) bool, True where the surface lies at the place or above it, False at it or below; of a level set,
    whether f is at most, or at least, that of the surface. holes, depths: (N,) where each comes from, as
    Observations has them. ends: (N, 3), of a level set: each holds on the way from its place to this one,
    too; None: at its place alone.
    """

    places: np.ndarray
    is_lower: np.ndarray
    holes: np.ndarray
    depths: np.ndarray
    ends: np.ndarray | None = None

    @classmethod
    def at_or_above(cls, places: np.ndarray, is_of_field: bool = False) -> Bounds:
        """Of a surface that lies at places (N, 3) or above, of no holes. is_of_field: it is a level set."""
        count = len(places)
        none = np.full(count, ""), np.full(count, np.nan)
        return cls(places, np.ones(count, bool), *none, places if is_of_field else None)

    @classmethod
    def joined(cls, parts: Sequence[Bounds]) -> Bounds:
        """Several, `parts`, of one surface, one after another."""
        names = ("places", "is_lower", "holes", "depths")
        joined = {name: np.concatenate([getattr(part, name) for part in parts]) for name in names}
        ends = [part.ends for part in parts if part.ends is not None]
        return cls(**joined, ends=np.concatenate(ends) if ends else None)

    def __len__(self) -> int:
        return len(self.places)

    @property
    def lower(self) -> np.ndarray:
        """(L, 3) the places at or above which the surface lies."""
        return self.places[self.is_lower]

    @property
    def upper(self) -> np.ndarray:
        """(U, 3) the places at or below which the surface lies."""
        return self.places[~self.is_lower]

    def some(self, chosen: np.ndarray) -> Bounds:
        """Some of them. chosen: (N,) bool, or numbers of rows."""
        ends = None if self.ends is None else self.ends[chosen]
        return Bounds(
            self.places[chosen], self.is_lower[chosen], self.holes[chosen], self.depths[chosen], ends
        )

    def along(self, step: float) -> tuple[np.ndarray, np.ndarray]:
        """Places (P, 3) at which bounds with ways are tested, at most a step apart, without the ends of a
        way; and (P,) the row of each."""
        if self.ends is None:
            return self.places, np.arange(len(self))
        way = self.ends - self.places
        count = np.maximum(np.ceil(norm(way) / step), 1).astype(np.int64)
        row = np.repeat(np.arange(len(self)), count)
        share = (ranks_in_runs(count) + 0.5) / count[row]
        return self.places[row] + share[:, None] * way[row], row

    def source(self, row: int) -> str:
        """Where one of them comes from, for messages."""
        return source_text(str(self.holes[row]), float(self.depths[row]), self.places[row])

    def beyond(self, z: np.ndarray) -> np.ndarray:
        """(N,) how far a surface with heights z (N,) at the places violates each; 0 where it does not."""
        off = np.where(self.is_lower, self.places[:, 2] - z, z - self.places[:, 2])
        return np.where(off > 0, off, 0.0)  # NaN where the surface has no height: not violated


def along_bounds(bounds: Bounds) -> np.ndarray:
    """(P, 3) points for a surface that no observation is on: one for each hole with bounds, or each position
    in plan of those without a hole, just beside the nearest bound, or halfway between the two. Along an
    inclined hole the other bounds do not ask the surface to follow it down."""
    if not len(bounds):
        return np.empty((0, 3))
    _, column = np.unique(bounds.places[:, :2] + 0.0, axis=0, return_inverse=True)
    _, hole = np.unique(bounds.holes, return_inverse=True)
    group = np.where(bounds.holes == "", -1 - column.ravel(), hole.ravel())
    margin = BESIDE_BOUND * float(np.ptp(bounds.places[:, 2]))
    low, high = _nearest(bounds, group, True), _nearest(bounds, group, False)
    for side, sign in ((low.keys() - high.keys(), 1.0), (high.keys() - low.keys(), -1.0)):
        nearest = low if sign > 0 else high
        for key in side:
            nearest[key] = nearest[key] + np.array([0.0, 0.0, sign * margin])
    points = []
    for key in sorted(low.keys() | high.keys()):
        lower, upper = low.get(key, high.get(key)), high.get(key, low.get(key))
        assert lower is not None and upper is not None
        is_between = lower[2] <= upper[2] or bool((lower[:2] == upper[:2]).all())
        points += [0.5 * (lower + upper)] if is_between else [lower, upper]
    return np.unique(points, axis=0)


def _nearest(bounds: Bounds, group: np.ndarray, is_lower: bool) -> dict[int, np.ndarray]:
    """The highest lower, or the lowest upper bound of each group: its place (3,)."""
    rows = np.flatnonzero(bounds.is_lower == is_lower)
    sign = 1.0 if is_lower else -1.0
    rows = rows[np.argsort(sign * bounds.places[rows, 2], kind="stable")]  # of several the last one counts
    return {int(group[row]): bounds.places[row] for row in rows.tolist()}


def read_observed_places(
    given: ObservationFile, units: UnitNames, model_unit: str = MODEL_UNIT, step: Step = no_step
) -> tuple[Observations, list[LeftOut]]:
    """The places of a table, in the model's unit and in its order, and those that are not used. Raises
    InputRefused naming file and line."""
    plan, height = factors(given.units, model_unit)
    scale = np.array([plan, plan, height])
    places, blocks, holes, depths, used, on, errors, thicknesses = ([] for _ in range(8))
    left_out: list[LeftOut] = []
    count = 0
    needed = ("x", "y", "z", "block")
    for row in rows_in_one_unit(given, Path(given.file), OBSERVED, needed, step, model_unit):
        count += 1
        code = row.text("block")
        if units.says_nothing(code):
            continue
        hole = row.text("hole") if row.has("hole") else ""
        depth = height * row.number("depth") if row.has("depth") else float("nan")
        block = units.block(code)
        where = f"line {row.line}, '{code}'"
        lacking = [axis for axis in "xyz" if not row.has(axis)]
        if lacking:
            left_out.append(LeftOut("no_depth", f"{where}: '{lacking[0]}' has no value", code, hole))
            continue
        place = np.array([row.number(axis) for axis in "xyz"]) * scale
        if block is None:
            left_out.append(unknown_block(where, code, hole, place=tuple(place.tolist())))
            continue
        places.append(place)
        blocks.append(block)
        holes.append(hole)
        depths.append(depth)
        used.append(row.is_used)
        on.append(_surface(row, units))
        errors.append(_height_error(row) * height)
        thicknesses.append(_thickness(row) * height)
    if not count:
        raise InputRefused("there are no observations in it", file=given.file)
    texts = np.array(blocks, str), np.array(holes, str)
    in_use = np.array([] if all(used) else used, bool)
    seen_on = np.array(on if any(on) else [], str)
    observed = Observations(
        np.array(places).reshape(-1, 3),
        *texts,
        np.array(depths),
        used=in_use,
        on=seen_on,
        height_errors=np.array(errors if any(errors) else []),
        thicknesses=np.array([] if np.isnan(thicknesses).all() else thicknesses),
    )
    return observed, left_out


def _height_error(row: Row) -> float:
    error = row.number("error") if row.has("error") else 0.0
    if error < 0:
        raise row.refuse(f"the error of the elevation, {error:g}, is negative", "leave it empty for 0")
    return error


def _thickness(row: Row) -> float:
    thickness = row.number("thickness") if row.has("thickness") else float("nan")
    if thickness <= 0:
        raise row.refuse(f"the thickness, {thickness:g}, is not above 0", "leave it empty if it is not known")
    return thickness


def _surface(row: Row, units: UnitNames) -> str:
    """The surface on which a place was seen; "" for none."""
    code = row.text("on") if row.has("on") else ""
    name = units.surface(code) if code else ""
    if name and name not in units.surfaces:
        raise row.refuse(f"'{code}' is no surface of the rock mass", "leave it empty, or name a surface")
    return name
