# SPDX-License-Identifier: GPL-3.0-or-later
"""Logged intervals of boreholes, which block is where along a hole, and their other columns such as
grades."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from functools import cache
from itertools import pairwise

import numpy as np

from ...base.algebra import norm
from ...base.errors import InputRefused
from .hole_tables import Row
from .holes import Holes
from .observations import LeftOut, Observations, unknown_block
from .unit_names import UnitNames

_ALIKE = 1e-6  # of the largest depth in a hole: depths that are nearer are one, which digits have parted
_MOST_BETWEEN = 100  # places between the ends of an interval of an inclined hole
_STRAIGHT = 1e-3  # of the step between these: so far a hole may bend away from the ways between them
_STEPS = 200  # in which the area of all holes is crossed, where no other step is given


@dataclass
class _Hole:
    """A hole: a row of it, its collar, and (from, to, block) of its intervals as they are in the table, those
    that are switched off apart."""

    row: Row
    begin: np.ndarray
    intervals: list[tuple[float, float, str]] = field(default_factory=list)
    switched_off: list[tuple[float, float, str]] = field(default_factory=list)


@dataclass
class Intervals:
    """observations: the ends of the intervals, and places between them where holes are inclined. holes: as of
    Picks, the tops of the intervals. left_out: intervals that are not used. ends: as of Picks."""

    observations: Observations
    holes: dict[str, tuple[np.ndarray, list[tuple[str, np.ndarray]]]]
    left_out: list[LeftOut]
    ends: dict[str, np.ndarray] = field(default_factory=dict)


def read_intervals(
    rows: list[Row], holes: Holes, units: UnitNames, scale: np.ndarray, plan_step: float | None
) -> Intervals:
    """The intervals of the rows of a table of some boreholes.

    scale: (3,) from the units of the tables to that of the model. plan_step: how far places along inclined
    intervals are apart in plan at most, model units; None: by the area of the holes. Depths that differ by
    rounding are one; intervals of one block that meet are one. Raises InputRefused naming file and line.
    """
    logs: dict[str, _Hole] = {}
    left_out: list[LeftOut] = []
    for row in rows:
        name, code = row.text("hole"), row.text("block")
        hole = logs.get(name)
        if hole is None:
            hole = logs[name] = _Hole(row, holes.begin_of(row))
        interval = _interval(row, name, code, units, left_out)
        if interval is not None:
            (hole.intervals if row.is_used else hole.switched_off).append(interval)
    if not logs:
        raise InputRefused("there are no intervals in it", file=holes.given.intervals)
    if plan_step is None:
        plan = np.array([hole.begin[:2] for hole in logs.values()]) * scale[:2]
        plan_step = _plan_step_of(plan)
    parts, tops, ends = [], {}, {}
    for name, hole in logs.items():

        def place(depth: float, hole: _Hole = hole) -> np.ndarray:
            return holes.place(hole.row, depth, scale)

        parts.append(_observed_intervals(name, hole.intervals, place, plan_step, left_out, hole.switched_off))
        tops[name] = hole.begin * scale, _tops_of(parts[-1].some(parts[-1].in_use))
        if name in holes.ends:
            ends[name] = place(holes.ends[name])
    return Intervals(Observations.joined(parts), tops, left_out, ends)


def _plan_step_of(plan: np.ndarray) -> float:
    """How far places along inclined intervals are apart in plan, for holes at (N, 2)."""
    return float(np.ptp(plan, axis=0).max()) / _STEPS


def _interval(
    row: Row, hole: str, code: str, units: UnitNames, left_out: list[LeftOut]
) -> tuple[float, float, str] | None:
    """(from, to, block) of a row; None if it is empty or cannot be used."""
    if units.says_nothing(code) or not (row.has("from") and row.has("to")):
        return None
    begin, end = row.number("from"), row.number("to")
    where = f"{row.place}, hole '{hole}' at {begin:.9g}, '{code}'"
    if begin > end:
        text = f"{where}: from {begin:.9g} is below to {end:.9g}"
        left_out.append(LeftOut("from_to", text, code, hole, begin))
        return None
    block = units.block(code)
    if block is None:
        left_out.append(unknown_block(where, code, hole, begin))
        return None
    return (begin, end, block) if begin < end else None  # of no thickness: the unit is absent


def _observed_intervals(
    name: str,
    intervals: Iterable[tuple[float, float, str]],
    place: Callable[[float], np.ndarray],
    plan_step: float,
    left_out: list[LeftOut],
    switched_off: Sequence[tuple[float, float, str]] = (),
) -> Observations:
    """What the intervals (from, to, block) of one hole say, from above downward. place(depth): where it
    is. switched_off: intervals that are kept, and not used, where no others are."""
    places: list[np.ndarray] = []
    depths: list[float] = []
    blocks: list[str] = []
    numbers: list[int] = []
    used: list[bool] = []
    place = cache(place)
    for number, (begin, end, block, is_used) in enumerate(_divided(intervals, name, left_out, switched_off)):
        for depth in _depths_along(place, begin, end, plan_step):
            places.append(place(depth))
            depths.append(depth)
            blocks.append(block)
            numbers.append(number)
            used.append(is_used)
    return Observations(
        np.array(places).reshape(-1, 3),
        np.array(blocks, str),
        np.full(len(places), name),
        np.array(depths),
        np.array(numbers, np.int64),
        np.array([] if all(used) else used, bool),
    )


def _depths_along(
    place: Callable[[float], np.ndarray], begin: float, end: float, plan_step: float
) -> list[float]:
    """The depths of the places of an interval: its ends, and between them so many that these are a step apart
    in plan at most, and that straight ways between them hardly leave a hole that bends."""
    count = 1
    if plan_step > 0:
        across = norm((place(end) - place(begin))[:2])
        count = min(max(int(np.ceil(across / plan_step)), 1), _MOST_BETWEEN + 1)
        depths = np.linspace(begin, end, 2 * count + 1).tolist()
        ways = zip(depths[:-2:2], depths[1::2], depths[2::2], strict=True)
        off = max(float(norm(place(b) - 0.5 * (place(a) + place(c)))) for a, b, c in ways)
        finer = int(np.ceil((off / (_STRAIGHT * plan_step)) ** 0.5))  # an arc's height goes with its square
        count = min(count * max(finer, 1), _MOST_BETWEEN + 1)
    return [begin, *np.linspace(begin, end, count + 1)[1:-1].tolist(), end]


def _divided(
    intervals: Iterable[tuple[float, float, str]],
    hole: str,
    left_out: list[LeftOut],
    switched_off: Sequence[tuple[float, float, str]],
) -> list[tuple[float, float, str, bool]]:
    """Intervals (from, to, block, whether it is used) that do not overlap, downward; what several blocks
    claim is left out, or the first of them where they are switched off."""
    claims = [
        *((*interval, True) for interval in intervals),
        *((*interval, False) for interval in switched_off),
    ]
    alike = _alike([depth for begin, end, *_ in claims for depth in (begin, end)])
    claims = [(alike[begin], alike[end], block, is_used) for begin, end, block, is_used in claims]
    divided: list[tuple[float, float, str, bool]] = []
    for begin, end in pairwise(sorted(set(alike.values()))):
        present = [(block, is_used) for low, high, block, is_used in claims if low <= begin and end <= high]
        is_used = any(used for _, used in present)
        claimed = sorted({block for block, used in present if used == is_used})
        if len(claimed) > 1 and is_used:
            names = " and ".join(f"'{block}'" for block in claimed)
            text = f"hole '{hole}' from {begin:.9g} to {end:.9g}: intervals of {names} overlap"
            left_out.append(LeftOut("overlap", text, claimed[0], hole, begin))
            continue
        for block in claimed[:1]:
            if divided and divided[-1][1:] == (begin, block, is_used):
                divided[-1] = (divided[-1][0], end, block, is_used)
            else:
                divided.append((begin, end, block, is_used))
    return divided


def _alike(depths: list[float]) -> dict[float, float]:
    """For each depth the one that it counts as: the least of those that only rounding parts."""
    near = _ALIKE * max(map(abs, depths), default=0.0)
    alike: dict[float, float] = {}
    last = -np.inf
    for depth in sorted(set(depths)):
        if depth - last > near:
            last = depth
        alike[depth] = last
    return alike


def _tops_of(observations: Observations) -> list[tuple[str, np.ndarray]]:
    """(surface, place) where the blocks of a hole begin."""
    blocks = observations.blocks
    first = [row for row in range(len(blocks)) if row == 0 or blocks[row] != blocks[row - 1]]
    return [(str(blocks[row]), observations.places[row]) for row in first]
