# SPDX-License-Identifier: GPL-3.0-or-later
"""Units that lie where their age forbids: lenses, which become bodies, and conflicts."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from ..base.algebra import norm
from .logs import HoleLogs, Log, LoggedPart, merged
from .order import UnitOrder

_MOST = 30  # lenses that become bodies: logs with more are not in beds
_REACH = 2.0  # times the distance of neighboring holes: so far apart holes may be in one lens


@dataclass(frozen=True)
class Conflict:
    """Two units in the wrong order in a hole, at a depth below its collar (NaN: not known) and elevation."""

    upper: str
    lower: str
    hole: str
    depth: float
    elevation: float


@dataclass(frozen=True)
class Lens:
    """name: of the body. unit: of the tables. host: the unit that encloses it. parts: of which holes, and
    which of their parts it is."""

    name: str
    unit: str
    host: str
    parts: Sequence[tuple[str, LoggedPart]]


@dataclass(frozen=True)
class Repeat:
    """Several units that come again in a hole, at a depth below its collar: in reverse, as in a fold, or in
    order, as beneath a thrust."""

    hole: str
    depth: float
    units: Sequence[str]
    in_reverse: bool


@dataclass
class Sorted:
    """The logs without what is out of order (lenses are their hosts), the lenses, the conflicts, and where
    several units repeat."""

    logs: list[Log]
    lenses: list[Lens] = field(default_factory=list)
    conflicts: list[Conflict] = field(default_factory=list)
    repeats: list[Repeat] = field(default_factory=list)


def sort_out(data: HoleLogs, order: UnitOrder) -> Sorted:
    """Of each hole the parts in order whose thickness is the greatest stay. Others are lenses where their
    unit, or that around them, repeats in the hole; else, and where several units in a row repeat, they are in
    conflict with their neighbors; so are the thinnest of very many lenses."""
    logs: list[Log] = []
    inside: dict[tuple[str, str], list[tuple[str, LoggedPart]]] = {}
    conflicts: list[Conflict] = []
    repeats: list[Repeat] = []
    for log in data.logs:
        stays = _in_order(log.parts, order)
        in_runs = _runs_out_of_order(log, stays, order, repeats)
        chain: list[LoggedPart] = []
        for number, part in enumerate(log.parts):
            if stays[number]:
                chain.append(part)
                continue
            host = None if number in in_runs else _host(log.parts, stays, number)
            if host is None:
                conflicts += _conflicts(log, stays, number, order)
            else:
                inside.setdefault((part.unit, host), []).append((log.hole, part))
                chain.append(LoggedPart(host, part.top, part.bottom, part.depth, part.end))
        logs.append(Log(log.hole, merged(chain), log.collar))
    plan = {log.hole: log.plan for log in data.logs}
    lenses: list[Lens] = []
    for (unit, host), parts in sorted(inside.items()):
        lenses += [Lens("", unit, host, group) for group in _groups(parts, plan)]
    lenses.sort(key=lambda lens: -sum(part.thickness for _, part in lens.parts))
    for lens in lenses[_MOST:]:
        for hole, part in lens.parts:
            height = float(part.top[2])
            conflicts.append(Conflict(lens.host, lens.unit, hole, part.depth, height))
    return Sorted(logs, _named(lenses[:_MOST], data, logs), conflicts, repeats)


def _in_order(parts: Sequence[LoggedPart], order: UnitOrder) -> list[bool]:
    """Which parts of a hole stay: the thickest chain that never rises to a younger unit."""
    ranks = [order.rank(part.unit) for part in parts]
    best, before = [0.0] * len(parts), [-1] * len(parts)
    for at, part in enumerate(parts):
        for earlier in range(at):
            if ranks[earlier] >= ranks[at] and best[earlier] > best[at]:
                best[at], before[at] = best[earlier], earlier
        best[at] += part.thickness
    stays = [False] * len(parts)
    at = int(np.argmax(best))
    while at >= 0:
        stays[at], at = True, before[at]
    return stays


def _runs_out_of_order(log: Log, stays: Sequence[bool], order: UnitOrder, repeats: list[Repeat]) -> set[int]:
    """The numbers of parts that are out of order several in a row, which are added to the repeats."""
    numbers: set[int] = set()
    run: list[int] = []
    for number, is_right in enumerate([*stays, True]):
        if not is_right:
            run.append(number)
            continue
        units = [log.parts[at].unit for at in run]
        if len(set(units)) > 1:
            first, last = order.rank(units[0]), order.rank(units[-1])
            repeats.append(Repeat(log.hole, log.parts[run[0]].depth, units, first < last))
            numbers |= set(run)
        run = []
    return numbers


def _host(parts: Sequence[LoggedPart], stays: Sequence[bool], number: int) -> str | None:
    """The unit around a part that is out of order, where it is a lens."""
    above = next((parts[at].unit for at in range(number - 1, -1, -1) if stays[at]), None)
    below = next((parts[at].unit for at in range(number + 1, len(parts)) if stays[at]), None)
    if above is not None and above == below:
        return above
    repeats = sum(part.unit == parts[number].unit for part in parts) > 1
    return (above or below) if repeats else None


def _conflicts(log: Log, stays: Sequence[bool], number: int, order: UnitOrder) -> list[Conflict]:
    """What a part that is out of order contradicts: the parts beside it, each pair once."""
    parts = log.parts
    conflicts = []
    for upper, lower in ((number - 1, number), (number, number + 1)):
        if upper < 0 or lower >= len(parts) or (upper < number and not stays[upper]):
            continue
        if order.rank(parts[upper].unit) < order.rank(parts[lower].unit):
            place = parts[lower]
            height = float(place.top[2])
            conflicts.append(Conflict(parts[upper].unit, place.unit, log.hole, place.depth, height))
    return conflicts


def _groups(
    parts: list[tuple[str, LoggedPart]], plan: dict[str, np.ndarray]
) -> list[list[tuple[str, LoggedPart]]]:
    """Parts of neighboring holes at about the same height are one lens."""
    reach = _REACH * spacing(np.array(list(plan.values())))
    groups: list[list[tuple[str, LoggedPart]]] = []
    for hole, part in sorted(parts, key=lambda entry: (entry[0], entry[1].depth)):
        near = [
            group
            for group in groups
            if any(
                hole != other
                and norm(plan[hole] - plan[other]) <= reach
                and abs(part.middle - beside.middle) <= part.thickness + beside.thickness
                for other, beside in group
            )
            and all(hole != other for other, _ in group)
        ]
        joined = [entry for group in near[:1] for entry in group]
        groups = [group for group in groups if not any(group is other for other in near[:1])]
        groups.append([*joined, (hole, part)])
    return groups


def spacing(plan: np.ndarray) -> float:
    """How far holes (N, 2) are from their nearest neighbors, as a median; 0 for one."""
    plan = np.unique(plan, axis=0)
    if len(plan) < 2:
        return 0.0
    nearest = []
    for place in plan:
        apart = np.hypot(*(plan - place).T)
        nearest.append(apart[apart > 0].min())
    return float(np.median(nearest))


def _named(lenses: list[Lens], data: HoleLogs, logs: list[Log]) -> list[Lens]:
    """Each with a unique name: that of its unit where this is nothing else."""
    taken = {part.unit.casefold() for log in logs for part in log.parts}
    taken |= {unit.casefold() for unit in data.units}
    named = []
    for lens in lenses:
        same = [other for other in lenses if other.unit == lens.unit]
        is_all = len(same) == 1 and not any(part.unit == lens.unit for log in logs for part in log.parts)
        name, number = lens.unit if is_all else f"{lens.unit} lens", 1
        while not is_all and (name.casefold() in taken or (len(same) > 1 and number == 1)):
            name = f"{lens.unit} lens {number}"
            if name.casefold() not in taken:
                break
            number += 1
        taken.add(name.casefold())
        named.append(Lens(name, lens.unit, lens.host, lens.parts))
    return named
