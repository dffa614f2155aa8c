# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds faults in the intervals of boreholes, repairs them or leaves the rows out, and lists them."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from ...base.errors import counted
from .hole_data import HoleTables
from .hole_problems import LEFT_OUT, REPAIRED, USED, ProblemList
from .hole_tables import Row
from .holes import end_of
from .unit_names import UnitNames

_ALIKE = 1e-6  # of the largest depth in a hole: depths that are nearer are one, which digits have parted
_OF_HOLE, _OF_INTERVAL = 1e-3, 0.1  # of a hole, and of the thinner interval: so wide gaps are closed
_ABOVE = 0.1  # of the length of a log: so far it may begin above its collar


@dataclass
class _Interval:
    """An interval of a hole: its row, its depths and the unit of its block."""

    row: Row
    begin: float
    end: float
    code: str
    block: str

    def moved(self, begin: float, end: float) -> None:
        """Gives it other depths."""
        changed = {"from": begin} if begin != self.begin else {}
        self.row = self.row.with_values(changed | ({"to": end} if end != self.end else {}))
        self.begin, self.end = begin, end


def repair_intervals(tables: HoleTables, units: UnitNames, problems: ProblemList) -> list[Row]:
    """The intervals that do not overlap, in the order of their table. units: what the names of units mean."""
    rows = tables.intervals or []
    if not rows or not {"from", "to"} <= rows[0].columns.keys():
        return rows
    ends, heights = _collars(tables)
    holes: dict[str, list[_Interval]] = {}
    replaced: dict[int, list[Row]] = {}  # rows by the places of those that they stand for
    places: dict[int, int] = {}
    for n, row in enumerate(rows):
        interval = _interval(row, units, problems) if row.is_used else None
        if interval is not None:
            holes.setdefault(row.text("hole"), []).append(interval)
            places[id(interval)] = n
        elif row.is_used:
            replaced[n] = []  # it has no depth, and is listed
    _as_depths(holes, heights, problems)
    for hole, intervals in holes.items():
        rows_of = _repaired_hole(hole, intervals, tables.boreholes.tolerance, (units, problems))
        for interval in intervals:
            replaced[places[id(interval)]] = rows_of.get(id(interval), [])
        _note_below(intervals, ends.get(hole, np.nan), problems)
    return [new for n, row in enumerate(rows) for new in replaced.get(n, [row])]


def _collars(tables: HoleTables) -> tuple[dict[str, float], dict[str, float]]:
    """The depths at which holes end, and the heights of their collars, as far as they are known."""
    ends = {row.text("hole"): end_of(row) for row in tables.collars or ()}
    with_heights = tables.collars if tables.collars is not None else tables.intervals or ()
    return ends, {row.text("hole"): row.number("z") for row in with_heights if row.has("z")}


def _code(row: Row) -> str:
    return row.text("block") if row.has("block") else ""


def _interval(row: Row, units: UnitNames, problems: ProblemList) -> _Interval | None:
    """The interval of a row that has depths."""
    code = _code(row)
    lacking = [name for name in ("from", "to") if not row.has(name)]
    if not lacking:
        return _Interval(row, row.number("from"), row.number("to"), code, units.block(code) or code)
    if len(row.entries) <= row.columns.get("block", 0):
        problems.note("no_row", LEFT_OUT, row, f"it has {counted(len(row.entries), 'value')}")
    elif "block" not in row.columns or not units.says_nothing(code):
        depth = next((row.number(name) for name in ("from", "to") if row.has(name)), None)
        said = problems.taken(row, *lacking)
        problems.note("no_depth", LEFT_OUT, row, said or f"'{lacking[0]}' has no value", depth, code)
    return None


def _as_depths(holes: dict[str, list[_Interval]], heights: dict[str, float], problems: ProblemList) -> None:
    """Turns heights, and depths with a minus sign, into depths where all intervals of a hole go down so."""
    falling = {}
    for hole, intervals in holes.items():
        thick = [interval for interval in intervals if interval.begin != interval.end]
        if thick and all(interval.begin > interval.end for interval in thick):
            falling[hole] = thick
    several = {hole: thick for hole, thick in falling.items() if len(thick) > 1}
    usual = min(_READINGS, key=lambda kind: _starts(several, heights, kind))
    for hole, thick in falling.items():
        readings = [kind for kind in _READINGS if np.isfinite(_start(thick, heights.get(hole, np.nan), kind))]
        if len(thick) == 1:
            # a single interval may be turned around as well
            alone = abs(thick[0].end) if thick[0].end >= 0 else np.inf
            readings = [kind for kind in readings if _start(thick, heights.get(hole, np.nan), kind) <= alone]
            if not several:
                readings.sort(key=lambda kind: _start(thick, heights.get(hole, np.nan), kind))
        elif _rises(thick):
            readings = []
        if not readings:
            continue
        kind = usual if several and usual in readings else readings[0]
        for interval in holes[hole]:
            if interval.begin == interval.end == 0:
                continue
            what = f"from {interval.begin:.9g} to {interval.end:.9g} are "
            what += f"elevations in a hole from {heights[hole]:.9g}" if kind == "elevations" else "below 0"
            problems.note(kind, REPAIRED, interval.row, what, interval.begin, interval.code)
            top = heights[hole] if kind == "elevations" else 0.0
            interval.moved(top - interval.begin, top - interval.end)


_READINGS = ("minus_sign", "elevations")


def _rises(intervals: list[_Interval]) -> bool:
    """Whether intervals that each fall follow one another upward: they are turned around one by one."""
    begins = [interval.begin for interval in intervals]
    return begins == sorted(begins)


def _start(intervals: list[_Interval], height: float, kind: str) -> float:
    """How deep a log begins by a reading of its depths; infinite where that cannot be."""
    highest = max(interval.begin for interval in intervals)
    length = highest - min(interval.end for interval in intervals)
    start = -highest if kind == "minus_sign" else height - highest
    return float(abs(start)) if start >= -_ABOVE * length else np.inf


def _starts(holes: dict[str, list[_Interval]], heights: dict[str, float], kind: str) -> float:
    return sum(_start(intervals, heights.get(hole, np.nan), kind) for hole, intervals in holes.items())


def _repaired_hole(
    hole: str, intervals: list[_Interval], tolerance: float | None, context: tuple[UnitNames, ProblemList]
) -> dict[int, list[Row]]:
    """The rows that stand for each interval, by its identity; those of doubles, and of what is left out, are
    none. context: what names mean, and the problems, to which those of the hole are added."""
    units, problems = context
    said = [interval for interval in intervals if not _says_nothing(interval, units)]
    others = {id(interval): [interval.row] for interval in intervals if _says_nothing(interval, units)}
    single = _without_doubles(said, problems)
    right = [interval for interval in single if interval.begin <= interval.end]
    for interval in single:
        if min(interval.begin, interval.end) < 0:
            _without_minus(interval, right, problems)
    for interval in single:
        if interval.begin > interval.end:
            if _fits(interval.end, interval.begin, [other for other in right if other is not interval]):
                what = f"from {interval.begin:.9g} is below to {interval.end:.9g}"
                problems.note("reversed", REPAIRED, interval.row, what, interval.end, interval.code)
                interval.moved(interval.end, interval.begin)
                right.append(interval)
            else:
                what = f"from {interval.begin:.9g} is below to {interval.end:.9g}"
                problems.note("from_to", LEFT_OUT, interval.row, what, interval.begin, interval.code)
    known = [interval for interval in right if interval.begin < interval.end and _is_known(interval, units)]
    known.sort(key=lambda interval: (interval.begin, interval.end))
    deepest = max((abs(depth) for i in known for depth in (i.begin, i.end)), default=0.0)
    _close(known, deepest, tolerance, problems)
    pieces = _apart(known, _ALIKE * deepest, problems)
    return others | {id(interval): pieces.get(id(interval), [interval.row]) for interval in right}


def _says_nothing(interval: _Interval, units: UnitNames) -> bool:
    return "block" in interval.row.columns and units.says_nothing(interval.code)


def _is_known(interval: _Interval, units: UnitNames) -> bool:
    """Whether the unit of an interval is one; without a rock mass all are."""
    return not units.surfaces or units.block(interval.code) is not None


def _without_doubles(intervals: list[_Interval], problems: ProblemList) -> list[_Interval]:
    first: dict[tuple, _Interval] = {}
    for interval in intervals:
        entries = (interval.begin, interval.end, *interval.row.entries)
        if entries in first:
            what = f"the interval of {first[entries].row.place} again"
            problems.note("double", REPAIRED, interval.row, what, interval.begin, interval.code)
        else:
            first[entries] = interval
    return list(first.values())


def _fits(begin: float, end: float, others: list[_Interval]) -> bool:
    """Whether an interval overlaps no other one, but for a tenth of the thinner of both."""
    for other in others:
        overlap = min(end, other.end) - max(begin, other.begin)
        if overlap > _OF_INTERVAL * min(end - begin, other.end - other.begin) and other.begin < other.end:
            return False
    return True


def _without_minus(interval: _Interval, right: list[_Interval], problems: ProblemList) -> None:
    """Takes minus signs away from the depths of an interval that then fits between others."""
    begin, end = abs(interval.begin), abs(interval.end)
    if begin < end and _fits(begin, end, [other for other in right if other is not interval]):
        what = f"from {interval.begin:.9g} to {interval.end:.9g}"
        problems.note("minus_sign", REPAIRED, interval.row, what, begin, interval.code)
        interval.moved(begin, end)
        if not any(other is interval for other in right):
            right.append(interval)


def _close(known: list[_Interval], deepest: float, tolerance: float | None, problems: ProblemList) -> None:
    """Closes gaps and overlaps of neighbors up to the tolerance, at their middle."""
    for upper, lower in pairwise(known):
        gap = lower.begin - upper.end
        thinner = min(upper.end - upper.begin, lower.end - lower.begin)
        within = min(_OF_HOLE * deepest, _OF_INTERVAL * thinner)
        within = within if tolerance is None else min(tolerance, 0.5 * thinner)
        if not _ALIKE * deepest < abs(gap) <= within * (1 + 1e-9) or lower.end <= upper.end:
            continue
        middle = 0.5 * (upper.end + lower.begin)
        kind = "gap" if gap > 0 else "overlap"
        doubtful, beside = (upper, lower) if _digits(upper.end) > _digits(lower.begin) else (lower, upper)
        what = f"{kind} of {abs(gap):.6g} beside {beside.row.place}, closed at {middle:.9g}"
        problems.note(kind, REPAIRED, doubtful.row, what, middle, doubtful.code)
        upper.moved(upper.begin, middle)
        lower.moved(middle, lower.end)


def _digits(value: float) -> int:
    return len(repr(value))


def _apart(known: list[_Interval], near: float, problems: ProblemList) -> dict[int, list[Row]]:
    """The rows of intervals that others of another block overlap, without what both claim."""
    claimed: list[tuple[float, float]] = []
    touched: set[int] = set()
    active: list[_Interval] = []
    for interval in known:
        active = [other for other in active if other.end > interval.begin + near]
        for other in active:
            low, high = interval.begin, min(other.end, interval.end)
            if other.block != interval.block and high - low > near:
                names = " and ".join(f"'{name}'" for name in sorted((other.block, interval.block)))
                later, first = sorted((interval, other), key=lambda i: -i.row.line)
                what = f"from {low:.9g} to {high:.9g}: intervals of {names} overlap"
                what += f", {first.row.header.row_name}s {first.row.line} and {later.row.line}"
                problems.note("overlap", LEFT_OUT, later.row, what, low, later.code)
                claimed.append((low, high))
                touched |= {id(other), id(interval)}
        active.append(interval)
    return {id(i): _pieces(i, claimed, near) for i in known if id(i) in touched}


def _pieces(interval: _Interval, claimed: list[tuple[float, float]], near: float) -> list[Row]:
    """The row of an interval, again for each part of it that is not claimed by others."""
    parts, begin = [], interval.begin
    for low, high in sorted(claimed):
        if high <= begin or low >= interval.end:
            continue
        if low - begin > near:
            parts.append((begin, low))
        begin = max(begin, high)
    if interval.end - begin > near:
        parts.append((begin, interval.end))
    return [interval.row.with_values({"from": low, "to": high}) for low, high in parts]


def _note_below(intervals: list[_Interval], end: float, problems: ProblemList) -> None:
    """Lists the deepest interval of a hole that ends above it."""
    lowest = max(intervals, key=lambda interval: interval.end)
    if lowest.end > end * (1 + 1e-6):
        what = f"to {lowest.end:.9g}, and the hole ends at {end:.9g}"
        problems.note("below_end", USED, lowest.row, what, lowest.begin, lowest.code)
